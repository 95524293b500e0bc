//! What a sweep does with the rates that it finds.

use crate::solvers::balance::{Stage, StageColumns};

/// Where a band reads enthalpies and leaves what it finds. Ranges count from the band's first particle.
pub trait Target {
    /// Enthalpies of a range of particles.
    fn enthalpy(&self, range: std::ops::Range<usize>) -> &[f64];
    /// Where the rates of a range of particles go, and how.
    fn slots(&mut self, range: std::ops::Range<usize>) -> Slots<'_>;
}

/// Where rates go.
pub struct Slots<'a> {
    /// A slot for each rate.
    pub rates: &'a mut [f64],
    /// The enthalpies that rates are of, unless these are the slots themselves.
    pub enthalpy: Option<&'a [f64]>,
    /// How slots take them.
    pub taken: Taken<'a>,
}

/// How slots take rates.
pub enum Taken<'a> {
    /// In the place of what they hold.
    Replacing,
    /// Added to what they hold, by a step (s).
    Adding(f64),
    /// The same, with what rounding keeps from them added at the next step.
    Keeping {
        /// The step (s).
        step: f64,
        /// What rounding has kept from each slot so far.
        lost: &'a mut [f64],
    },
}

/// Adds `step` times the rate to the enthalpies themselves: explicit Euler.
pub struct InPlace<'a> {
    /// Enthalpies of the band.
    pub enthalpy: &'a mut [f64],
    /// Length of the step (s).
    pub step: f64,
}

impl Target for InPlace<'_> {
    #[inline(always)]
    fn enthalpy(&self, range: std::ops::Range<usize>) -> &[f64] {
        &self.enthalpy[range]
    }

    #[inline(always)]
    fn slots(&mut self, range: std::ops::Range<usize>) -> Slots<'_> {
        Slots { rates: &mut self.enthalpy[range], enthalpy: None, taken: Taken::Adding(self.step) }
    }
}

/// The same, with what rounding takes from a step kept for the next.
pub struct Kept<'a> {
    /// Enthalpies of the band.
    pub enthalpy: &'a mut [f64],
    /// What rounding has kept from them so far.
    pub lost: &'a mut [f64],
    /// Length of the step (s).
    pub step: f64,
}

impl Target for Kept<'_> {
    #[inline(always)]
    fn enthalpy(&self, range: std::ops::Range<usize>) -> &[f64] {
        &self.enthalpy[range]
    }

    #[inline(always)]
    fn slots(&mut self, range: std::ops::Range<usize>) -> Slots<'_> {
        let lost = &mut self.lost[range.clone()];
        Slots { rates: &mut self.enthalpy[range], enthalpy: None, taken: Taken::Keeping { step: self.step, lost } }
    }
}

/// Writes the rates beside the enthalpies.
pub struct Beside<'a> {
    /// Enthalpies of the band.
    pub enthalpy: &'a [f64],
    /// Rates of the band.
    pub rate: &'a mut [f64],
}

impl Target for Beside<'_> {
    #[inline(always)]
    fn enthalpy(&self, range: std::ops::Range<usize>) -> &[f64] {
        &self.enthalpy[range]
    }

    #[inline(always)]
    fn slots(&mut self, range: std::ops::Range<usize>) -> Slots<'_> {
        let enthalpy = Some(&self.enthalpy[range.clone()]);
        Slots { rates: &mut self.rate[range], enthalpy, taken: Taken::Replacing }
    }
}

/// One stage of a Runge-Kutta chain, in place of the state two stages back.
pub struct Chained<'a> {
    /// Coefficients.
    pub stage: Stage,
    /// Columns of the band.
    pub columns: StageColumns<'a>,
}

impl Target for Chained<'_> {
    #[inline(always)]
    fn enthalpy(&self, range: std::ops::Range<usize>) -> &[f64] {
        &self.columns.newest[range]
    }

    /// All of the stage but its rate, which is added on top: the slots are asked for once.
    #[inline(always)]
    fn slots(&mut self, range: std::ops::Range<usize>) -> Slots<'_> {
        let stage = self.stage;
        let StageColumns { newest: new, oldest: slots, start: begun, first: first_rate } = &mut self.columns;
        let states = new[range.clone()].iter().zip(&begun[range.clone()]);
        let states = states.zip(&first_rate[range.clone()]);
        for (out, ((new, begun), first_rate)) in slots[range.clone()].iter_mut().zip(states) {
            *out = stage.without_rate((*new, *out, *begun), *first_rate);
        }
        let enthalpy = Some(&new[range.clone()]);
        Slots { rates: &mut slots[range], enthalpy, taken: Taken::Adding(stage.rate) }
    }
}
