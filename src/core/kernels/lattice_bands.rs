//! Steps of a lattice in bands, one for each thread.

use crate::kernels::around::Around;
use crate::kernels::lattice::LatticeBalance;
use crate::kernels::sweep::{Band, Frame, sweep};
use crate::kernels::target::{Beside, Chained, InPlace, Kept, Target};
use crate::physics::laws::Laws;
use crate::solvers::balance::{Stage, StageColumns};
use crate::team::Team;

/// Particles that each thread must have to itself: a step of fewer is over before they are shared.
const PARTICLES_PER_THREAD: usize = 16_384;

impl<L: Laws> LatticeBalance<L> {
    /// The sweep of a step of explicit Euler over several bands.
    pub(super) fn euler_in_bands(&mut self, enthalpy: &mut [f64], step: f64) {
        let mut targets: Vec<InPlace<'_>> = Vec::with_capacity(self.bands.len());
        let mut rest = &mut enthalpy[..];
        for band in &self.bands {
            let count = self.around.lattice.start(band.rows.1) - self.around.lattice.start(band.rows.0);
            let (own, later) = rest.split_at_mut(count);
            targets.push(InPlace { enthalpy: own, step });
            rest = later;
        }
        self.sweep(&mut targets);
    }

    /// The same with what rounding takes from it kept.
    pub(super) fn keeping_in_bands(&mut self, enthalpy: &mut [f64], lost: &mut [f64], step: f64) {
        let mut targets: Vec<Kept<'_>> = Vec::with_capacity(self.bands.len());
        let (mut rest, mut rest_lost) = (&mut enthalpy[..], &mut lost[..]);
        for band in &self.bands {
            let count = self.around.lattice.start(band.rows.1) - self.around.lattice.start(band.rows.0);
            let (own, later) = rest.split_at_mut(count);
            let (own_lost, later_lost) = rest_lost.split_at_mut(count);
            targets.push(Kept { enthalpy: own, lost: own_lost, step });
            (rest, rest_lost) = (later, later_lost);
        }
        self.sweep(&mut targets);
    }

    /// The sweep of a stage over several bands.
    pub(super) fn stage_in_bands(&mut self, stage: &Stage, columns: &mut StageColumns<'_>) {
        let mut targets: Vec<Chained<'_>> = Vec::with_capacity(self.bands.len());
        let (mut newest, mut start, mut first) = (columns.newest, columns.start, columns.first);
        let mut oldest = &mut columns.oldest[..];
        for band in &self.bands {
            let count = self.around.lattice.start(band.rows.1) - self.around.lattice.start(band.rows.0);
            let (own_newest, own_start, own_first);
            (own_newest, newest) = newest.split_at(count);
            (own_start, start) = start.split_at(count);
            (own_first, first) = first.split_at(count);
            let (own_oldest, later) = oldest.split_at_mut(count);
            oldest = later;
            let columns = StageColumns { newest: own_newest, oldest: own_oldest, start: own_start, first: own_first };
            targets.push(Chained { stage: *stage, columns });
        }
        self.sweep(&mut targets);
    }

    /// The sweep of the rates over several bands.
    pub(super) fn rates_in_bands(&mut self, enthalpy: &[f64], rate: &mut [f64]) {
        let mut targets: Vec<Beside<'_>> = Vec::with_capacity(self.bands.len());
        let (mut from, mut into) = (enthalpy, &mut rate[..]);
        for band in &self.bands {
            let count = self.around.lattice.start(band.rows.1) - self.around.lattice.start(band.rows.0);
            let (own, later) = from.split_at(count);
            let (own_rate, later_rate) = into.split_at_mut(count);
            targets.push(Beside { enthalpy: own, rate: own_rate });
            (from, into) = (later, later_rate);
        }
        self.sweep(&mut targets);
    }
}

/// A sweep of all bands, each by a thread.
pub(super) fn share<L: Laws, T: Target + Send>(
    team: &Team,
    frame: &Frame<'_, L, Around<L>>,
    bands: &mut [Band],
    targets: &mut [T],
    row_patches: &mut [[f64; 4]],
) {
    let mut rest = row_patches;
    let of_band = |(band, target)| {
        let band: &mut Band = band;
        let (patches, later) = std::mem::take(&mut rest).split_at_mut(band.rows.1 - band.rows.0);
        rest = later;
        (band, target, patches)
    };
    let parts: Vec<(&mut Band, &mut T, &mut [[f64; 4]])> = bands.iter_mut().zip(targets).map(of_band).collect();
    team.share(parts.into_iter(), |(band, target, patches)| sweep(frame, band, target, patches));
}

/// Threads that a step of a lattice is worth.
pub(super) fn threads<L>(team: &Option<Team>, around: &Around<L>) -> usize {
    let (lattice, shape) = (&around.lattice, around.shape);
    let threads = team.as_ref().map_or(1, Team::threads);
    let most = (lattice.len() / PARTICLES_PER_THREAD).min(lattice.rows / (4 * shape.reach_rows).max(1));
    if lattice.rows == 1 { 1 } else { threads.min(most).max(1) }
}
