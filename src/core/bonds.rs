//! Bonds and their geometric weights.

pub mod exchange;
pub mod pair_list;
pub mod stencil;
pub mod weight;
