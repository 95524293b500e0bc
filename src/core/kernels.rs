//! Exchange through bonds, in the form that a body allows.

pub mod corner;
pub mod lattice;
pub mod rows;
pub mod sweep;
