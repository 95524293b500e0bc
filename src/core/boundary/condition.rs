//! What happens at walls.

use crate::series::Series;

/// What happens at a wall.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// No heat crosses: a mirror plane.
    Symmetry,
    /// The wall has this temperature.
    Temperature(Series),
    /// This heat flux enters the body (W/m2; negative when it leaves).
    Flux(Series),
    /// The wall exchanges heat with surroundings at a temperature through a film coefficient.
    Convection {
        /// Film coefficient (W/m2K).
        coefficient: Series,
        /// Temperature of the surroundings.
        ambient: Series,
    },
    /// The wall has the temperature of the scene's exact solution at its position: a finite stand-in for an
    /// infinite body.
    Exact,
}
