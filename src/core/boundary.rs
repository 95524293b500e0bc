//! How anything outside acts on particles.

pub mod condition;
pub mod curved_wall;
pub mod ghosts;
pub mod green;
pub mod interface;
pub mod patch;
pub mod pipe;
pub mod runoff;
pub mod shells;
pub mod wall_ends;
pub mod wall_layers;
