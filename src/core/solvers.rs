//! How time advances.

pub mod assembly;
pub mod band;
pub mod control;
pub mod euler;
pub mod implicit;
pub mod krylov;
pub mod method;
pub mod moving;
pub mod newton;
pub mod operator;
pub mod rkl2;
pub mod sharp;
pub mod step;
