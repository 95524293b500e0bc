//! Which pairs, ghosts and walls of a scene see several materials.

mod build;
mod ground;

pub use build::{Seen, chains};
pub use ground::Ground;
