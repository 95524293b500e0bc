//! The semi-discrete heat balance: the seam between what particles exchange and how time advances.

use crate::method::Bound;

/// `dH/dt` of all particles as a function of their enthalpies and time, with the heat through each door.
pub trait Operator: Send {
    /// Rates (W/m3) of all particles at a state and time (s); `doors` takes the heat in through each door (W).
    fn rate(&mut self, enthalpy: &[f64], time: f64, rate: &mut [f64], doors: &mut [f64]);
    /// One step of explicit Euler in place.
    fn euler(&mut self, enthalpy: &mut [f64], time: f64, step: f64, doors: &mut [f64]);
    /// Longest explicit step that keeps the maximum principle, by the row sums of the actual pairs.
    fn bound(&self) -> Bound;
    /// Names of the doors: walls, then pipe rings.
    fn doors(&self) -> Vec<String>;
    /// Pairs that one evaluation visits.
    fn pairs(&self) -> u64;
    /// Bytes that the operator holds on the heap; what particles hold is theirs.
    fn held(&self) -> usize;
}
