//! Where particles are: bodies, lattices, shells.

pub mod domain;
pub mod lattice;
pub mod random_field;
pub mod segment;
pub mod symmetry;
pub mod volumes;
pub mod wall;
