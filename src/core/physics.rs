//! Functions of one particle's content.

pub mod blend;
mod columns;
pub mod curve;
pub mod curved;
pub mod film;
pub mod freezing_curve;
pub mod integral;
pub mod latent_heat;
pub mod laws;
pub mod material;
pub mod mixing;
pub mod potential;
pub mod retention;
pub(crate) mod root;
mod sharp_stretches;
pub mod solute_material;
pub mod sub_cell;
pub mod thermal;
