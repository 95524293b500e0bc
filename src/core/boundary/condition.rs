//! What happens at walls.

use crate::physics::film::FilmKind;
use crate::series::Series;

/// What happens at a wall.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// No heat crosses: a mirror plane.
    Symmetry,
    /// The body goes on at the opposite wall.
    Periodic,
    /// The wall has this temperature.
    Temperature(Series),
    /// This heat flux enters the body (W/m2; negative when it leaves).
    Flux(Series),
    /// The wall exchanges heat with surroundings by its own temperature.
    Film {
        /// By what.
        kind: FilmKind,
        /// How strongly, as its kind counts it.
        strength: Series,
        /// Temperature of the surroundings.
        ambient: Series,
    },
    /// Unsaturated water enters as fast as it rains, while the head at the wall is below the greatest; what the ground does not
    /// take then runs off, and without rain water only leaves.
    Runoff {
        /// Rain (m/s).
        rain: Series,
        /// The greatest head, as a place on the scale of heads.
        ponding: Series,
    },
    /// Unsaturated water leaves as fast as its weight alone drives it.
    FreeDrainage,
    /// The wall has the temperature of the scene's exact solution at its position: a finite stand-in for an
    /// infinite body.
    Exact,
}

impl Condition {
    /// The temperature that the wall has, or its surroundings have, where the scene says one.
    pub fn temperature(&self) -> Option<&Series> {
        match self {
            Condition::Temperature(series)
            | Condition::Film { ambient: series, .. }
            | Condition::Runoff { ponding: series, .. } => Some(series),
            Condition::Symmetry
            | Condition::Periodic
            | Condition::Flux(_)
            | Condition::FreeDrainage
            | Condition::Exact => None,
        }
    }

    /// All numbers of it that the scene says.
    pub fn series(&self) -> impl Iterator<Item = &Series> {
        let other = match self {
            Condition::Flux(series)
            | Condition::Film { strength: series, .. }
            | Condition::Runoff { rain: series, .. } => Some(series),
            Condition::Symmetry
            | Condition::Periodic
            | Condition::Temperature(_)
            | Condition::FreeDrainage
            | Condition::Exact => None,
        };
        self.temperature().into_iter().chain(other)
    }

    /// Whether heat comes in by a flux, given or by one that follows the wall.
    pub fn brings_heat(&self) -> bool {
        matches!(self, Condition::Flux(_) | Condition::Film { .. } | Condition::Runoff { .. })
    }
}
