//! What particles exchange beside heat.

pub mod groundwater;
pub mod heated;
mod row;
pub mod solute;
