//! How time advances.

pub mod assembly;
pub mod assessment;
pub mod balance;
pub mod band;
pub mod control;
pub mod euler;
pub mod heun;
pub mod implicit;
pub mod kept;
pub mod krylov;
pub mod moving;
pub mod newton;
pub mod passenger;
pub mod rkl2;
pub mod sharp;
pub mod solver;
pub mod step;
pub mod transport;
