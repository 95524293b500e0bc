//! What every particle method of frazil shares.
//!
//! A method is a weight for each pair; the physics is one function of a particle's enthalpy. For every
//! deterministic method the heat balance of particle i reads
//! `V_i dH_i/dt = sum_j w_ij (U_j - U_i) + sources`, with the enthalpy `H` (J/m3), the conduction potential
//! `U(H) = integral of k dT` (W/m) and symmetric geometric weights `w_ij >= 0` (m^(d-2)).

pub mod balances;
pub mod bonds;
pub mod boundary;
pub mod breakage;
pub mod compiled;
pub mod formula;
pub mod instruction_set;
pub mod kernels;
pub mod ledger;
pub mod memory;
pub mod neighbours;
pub mod noise;
pub mod particles;
pub mod parts;
pub mod physics;
pub mod saved;
pub mod series;
pub mod side_by_side;
pub mod solvers;
pub mod space;
pub mod statistics;
pub mod team;
