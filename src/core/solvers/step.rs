//! A step: where it stands, how long it may be, and why it could not be made.

use frazil_record::plain;

use crate::balances::groundwater::error::GroundwaterError;

/// Where a run stands in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Time at the start of the step (s).
    pub time: f64,
    /// Length of the step (s).
    pub step: f64,
    /// Number of steps made before this one.
    pub index: u64,
    /// Whether walls, pipes or what flows may have jumped since the last step.
    pub turned: bool,
}

/// The explicit limit of a step, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// Longest step (s) that keeps the maximum principle.
    pub step: f64,
    /// How many times as long a step is linearly stable, as far as is known: stages of a chain need no more.
    pub slack: f64,
    /// What sets the step, in words, with the particle.
    pub cause: String,
}

impl Bound {
    /// A limit beyond which nothing is known.
    pub fn strict(step: f64, cause: impl Into<String>) -> Self {
        Bound { step, slack: 1.0, cause: cause.into() }
    }

    /// Longest step (s) that is linearly stable, as far as is known.
    pub fn linear_step(&self) -> f64 {
        self.slack * self.step
    }
}

/// A step that could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The shortest step of those by error (s) gives numbers that are none.
    #[error("a step of {} s gives values that are not finite", plain(*.0, 6))]
    NotFinite(f64),
    /// What is carried would need far more steps within one (s) of what carries it than it was to make.
    #[error(
        "the solute needs {needed:.1e} substeps within a water step of {} s, its step bound is {} s: {}",
        plain(*.step, 6), plain(.bound.step, 6), .bound.cause
    )]
    Passenger {
        /// The step of water.
        step: f64,
        /// How many it needs.
        needed: f64,
        /// What bounds them.
        bound: Bound,
    },
    /// Water does not flow any further.
    #[error(transparent)]
    Groundwater(#[from] GroundwaterError),
    /// A method's own step, and what went wrong in it.
    #[error("{0}")]
    Own(String),
}
