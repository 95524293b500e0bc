//! A scene becomes particles, bonds and walls, runs, and leaves tables.

mod checkpoint;
pub mod closing;
mod cut_cells;
mod interface;
mod layers;
pub mod march;
pub mod measure;
mod monotonicity;
pub mod observers;
mod open_volumes;
pub mod plan;
pub mod predict;
mod recorded;
pub mod reduce;
pub mod reference;
mod refused;
pub mod start;
pub mod stream;
pub mod terms;
mod walls;
