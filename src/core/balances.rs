//! What particles exchange beside heat.

pub mod groundwater;
pub mod solute;
