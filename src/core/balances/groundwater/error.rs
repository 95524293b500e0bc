//! Why water cannot flow.

use crate::space::wall::WallId;

/// Why water cannot flow through a body, or not any further.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GroundwaterError {
    /// A pressure is given at a wall that the body has not.
    #[error("the body has no wall \"{0}\" for water")]
    NoWall(WallId),
    /// A ghost stands for several particles.
    #[error("water needs mirrored walls")]
    FittedWall,
    /// A particle sees another that does not see it.
    #[error("water would flow through a pair in one direction only")]
    OneWay,
    /// A material, by its name, holds no water.
    #[error("\"{0}\" has no pores")]
    NoPores(String),
    /// A material, by its name, lets none through.
    #[error("\"{0}\" has no permeability")]
    NoPermeability(String),
    /// Conjugate gradients did not come to an end within so many iterations.
    #[error("the pressure was not found within {0} iterations")]
    NotFound(usize),
    /// Conductivities or pressures are no numbers.
    #[error("the pressure is not finite")]
    NotFinite,
}
