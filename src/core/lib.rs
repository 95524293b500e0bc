//! What every particle method of frazil shares.
//!
//! A method is a weight for each pair; the physics is what a particle makes of its enthalpy. For every
//! deterministic method the heat balance of particle i reads
//! `V_i dH_i/dt = sum_j w_ij (U_j - U_i) + sources`, with the enthalpy `H` (J/m3), the conduction potential
//! `U(H) = integral of k dT` (W/m) and symmetric geometric weights `w_ij >= 0` (m^(d-2)).

pub mod blend;
pub mod boundary;
pub mod closing;
pub mod corner;
pub mod crack;
pub mod curved_wall;
mod excavation;
pub mod flow;
pub mod ghosts;
pub mod green;
pub mod integrate;
pub mod interface;
pub mod lattice;
pub mod lattice_operator;
mod layers;
pub mod ledger;
pub mod list_operator;
pub mod march;
pub mod material;
pub mod measure;
pub mod memory;
pub mod method;
pub mod moving;
pub mod neighbours;
pub mod noise;
pub mod one_way;
pub mod operator;
pub mod particles;
pub mod pipe;
pub mod plan;
pub mod potential;
pub mod predict;
pub mod reduce;
pub mod reference;
pub mod scene;
pub mod segment;
pub mod start;
pub mod statistics;
pub mod stencil;
pub mod stream;
pub mod sub_cell;
pub mod sweep;
pub mod symmetry;
pub mod terms;
pub mod uptake;
pub mod wall_ends;
pub mod wall_layers;
pub mod watch;
