//! What particles exchange beside heat.

pub mod groundwater;
mod row;
pub mod solute;
