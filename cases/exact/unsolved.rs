//! Why a scene has no exact solution.

use frazil_core::space::wall::WallId;

/// Why a scene, or a material between two temperatures, has no exact solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unsolved {
    /// A body of this kind has none.
    #[error("{0} has no exact solution")]
    Body(&'static str),
    /// There is nothing to solve for.
    #[error("the scene has no material")]
    NoMaterial,
    /// This wall does not set the solution.
    #[error("the {0} wall has no constant temperature")]
    WallChanges(WallId),
    /// Nothing happens.
    #[error("no wall differs from the initial temperature")]
    NothingDrives,
    /// Two walls do not share one half space.
    #[error("both the {0} and the {1} wall drive heat: no exact solution")]
    TwoDrive(WallId, WallId),
    /// Heat flows across.
    #[error("the {0} wall is not insulated, so heat does not flow along one line")]
    NotInsulated(WallId),
    /// The body is no half space.
    #[error(
        "the far wall affects the solution: at {length} m the half space changes by {change:.1e} of the range of temperatures before the \
         end (limit {limit:.0e}); lengthen the body, shorten the run or let the far wall follow the exact solution"
    )]
    FarWallFelt {
        /// Where it stands (m).
        length: f64,
        /// What changes there, over the range of temperatures.
        change: f64,
        /// What may.
        limit: f64,
    },
    /// Water flows along lines alone.
    #[error("only water along a line has an exact solution")]
    NotALine,
    /// No water flows.
    #[error("no water flows")]
    NoWater,
    /// Water flows through several materials.
    #[error("the body is not of one material")]
    SeveralMaterials,
    /// Water has no way.
    #[error("the material has no pores")]
    NoPores,
    /// Water has no way.
    #[error("the material has no permeability")]
    NoPermeability,
    /// Nothing drives water.
    #[error("no pressure at the {0} wall")]
    NoPressure(WallId),
    /// Water does not flow steadily.
    #[error("the pressure at the {0} wall changes")]
    PressureChanges(WallId),
    /// Ice would change how water flows.
    #[error("the ground freezes")]
    Freezes,
    /// The column of water is no half space.
    #[error("the far wall affects the solution: the half space changes by {0:.1e} there")]
    ColumnEnds(f64),
    /// Latent heat is released along a curve.
    #[error("{0} does not freeze at one temperature")]
    Curved(String),
    /// Wall and body have the same temperature, or one that is no number.
    #[error("a wall at {wall} does not change a body at {initial}")]
    Unchanged {
        /// Temperature of the wall.
        wall: f64,
        /// Temperature of the body.
        initial: f64,
    },
    /// No front balances heat.
    #[error("{material} has no front between {wall} and {initial}")]
    NoFront {
        /// The material.
        material: String,
        /// Temperature of the wall.
        wall: f64,
        /// Temperature of the body.
        initial: f64,
    },
    /// The curve of this material is of another kind.
    #[error("the similarity solution is not made for the way in which {0} freezes")]
    UnknownCurve(String),
    /// Shooting misses.
    #[error("the similarity solution of {material} does not reach {initial}; its curve may be too narrow")]
    Missed {
        /// The material.
        material: String,
        /// Temperature of the body.
        initial: f64,
    },
    /// No flux lets the trajectory fall short.
    #[error("no wall flux is small enough")]
    FluxTooLarge,
    /// No flux lets the trajectory overshoot.
    #[error("no wall flux is large enough")]
    FluxTooSmall,
    /// The trajectory never settles.
    #[error("the similarity solution has no end")]
    NoEnd,
    /// The trajectory takes too long.
    #[error("the similarity solution takes too many steps")]
    TooManySteps,
}
