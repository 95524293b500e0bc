//! Closed forms and similarity solutions for water in unsaturated soil and for what it carries, from numbers of the soil
//! alone and independent of the engine's own laws.

mod graded;
pub mod ogata_banks;
pub mod philip;
pub mod soil;
pub mod srivastava_yeh;

/// Why a problem of unsaturated soil has no solution here.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unsolvable {
    /// A number is out of range.
    #[error("{what} is {found}, it must be {allowed}")]
    OutOfRange {
        /// What it is.
        what: &'static str,
        /// What it was.
        found: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// The fixed point of the absorption was not reached.
    #[error("the iteration for absorption still changes by {change:.1e}, it must fall below {limit:.0e}")]
    NotSettled {
        /// Greatest relative change of the last round.
        change: f64,
        /// What it must fall below.
        limit: f64,
    },
}

/// That a number is as it must be.
fn require(is_allowed: bool, what: &'static str, found: f64, allowed: &'static str) -> Result<(), Unsolvable> {
    if is_allowed && found.is_finite() { Ok(()) } else { Err(Unsolvable::OutOfRange { what, found, allowed }) }
}

/// That a soil can hold and conduct water.
fn require_soil(residual: f64, saturated: f64, conductivity: f64) -> Result<(), Unsolvable> {
    require(residual >= 0.0, "the residual water content", residual, "at least 0")?;
    let is_content = saturated > residual && saturated <= 1.0;
    require(is_content, "the saturated water content", saturated, "above the residual one and at most 1")?;
    require(conductivity > 0.0, "the saturated conductivity", conductivity, "above 0 m/s")
}
