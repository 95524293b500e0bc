//! What goes wrong with fluids.

use frazil_core::memory::{self, Allowed};

/// Why there is no such fluid, or why it goes on no longer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FluidError {
    /// A constant, by its key, that must be above zero.
    #[error("{0}: found {1}, must be above 0")]
    NotPositive(&'static str, f64),
    /// A constant, by its key, that must not be below zero.
    #[error("{0}: found {1}, must be at least 0")]
    Negative(&'static str, f64),
    /// The table of exponents is empty or does not grow.
    #[error("exponent: the rows must have increasing temperatures, and there must be one")]
    Rows,
    /// An exponent that must not be below zero.
    #[error("exponent: found {0}, must be at least 0: friction would grow towards the cut-off")]
    Exponent(f64),
    /// A box that is narrower than three cells.
    #[error(
        "a periodic box of length {length} is too small: it must be at least {least} long, three times the cut-off radius \
         and the skin around it"
    )]
    Narrow {
        /// What it is long.
        length: f64,
        /// What it must be long.
        least: f64,
    },
    /// More particles than memory holds.
    #[error(
        "{count:.1e} particles that move need at least {}, and a run may take {allowed}: a larger spacing, or on a line a \
         lesser strip_width",
        memory::words(*.needed)
    )]
    Large {
        /// How many.
        count: f64,
        /// What they need (bytes).
        needed: f64,
        /// What is allowed.
        allowed: Allowed,
    },
    /// Particles that crowd together or leave the numbers.
    #[error(
        "step {number}: a particle moved by {way:.3} within a few steps, farther than pairs reach: the time step {step} is too \
         long"
    )]
    TooLong {
        /// Steps before.
        number: u64,
        /// How far the particle moved.
        way: f64,
        /// The time step.
        step: f64,
    },
    /// What was watched has left the numbers.
    #[error("displacements that are not finite")]
    NoNumbers,
}
