//! What every particle method of frazil shares.
//!
//! A method is a weight for each pair; the physics is what a particle makes of its enthalpy. For every
//! deterministic method the heat balance of particle i reads
//! `V_i dH_i/dt = sum_j w_ij (U_j - U_i) + sources`, with the enthalpy `H` (J/m3), the conduction potential
//! `U(H) = integral of k dT` (W/m) and symmetric geometric weights `w_ij >= 0` (m^(d-2)).

pub mod assembly;
pub mod blend;
pub mod boundary;
pub mod condition;
pub mod corner;
pub mod crack;
pub mod curved_wall;
pub mod domain;
pub mod excavation;
pub mod exchange;
pub mod flow;
pub mod ghosts;
pub mod green;
pub mod integrate;
pub mod interface;
pub mod lattice;
pub mod lattice_operator;
pub mod ledger;
pub mod list_operator;
pub mod material;
pub mod memory;
pub mod method;
pub mod moving;
pub mod neighbours;
pub mod noise;
pub mod operator;
pub mod particles;
pub mod pipe;
pub mod potential;
pub mod segment;
pub mod series;
pub mod statistics;
pub mod stencil;
pub mod sub_cell;
pub mod sweep;
pub mod symmetry;
pub mod uptake;
pub mod wall_ends;
pub mod wall_layers;
