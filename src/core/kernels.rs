//! Exchange through bonds, in the form that a body allows.

pub mod around;
pub mod conducted;
pub mod corner;
pub mod crossing;
pub mod diagonal_pairs;
pub mod enthalpy_rows;
pub mod exterior;
pub mod flows;
mod gravity;
pub mod irregular;
pub mod lattice;
mod lattice_bands;
pub mod lattice_parts;
mod lattice_tangent;
pub mod list_parts;
mod mean_tangent;
pub mod rows;
mod rows_tangent;
pub mod runs;
pub mod sweep;
pub mod target;
pub mod term;
mod varied;
