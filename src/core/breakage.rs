//! What cuts bonds.

pub mod crack;
pub mod cuts;
pub mod excavation;
mod strength;
