//! What cuts bonds.

pub mod crack;
pub mod excavation;
