//! Steps of a lattice in bands, one for each thread.

use crate::kernels::around::Around;
use crate::kernels::sweep::{Band, Frame, sweep};
use crate::kernels::target::Target;
use crate::physics::laws::Laws;
use crate::team::Team;

/// Particles that each thread must have to itself: a step of fewer is over before they are shared.
const PARTICLES_PER_THREAD: usize = 16_384;

/// Takes the first of some particles from the front of a column, of which the rest is left.
#[inline(always)]
pub(super) fn take_some<'a>(column: &mut &'a mut [f64], count: usize) -> &'a mut [f64] {
    let (own, rest) = std::mem::take(column).split_at_mut(count);
    *column = rest;
    own
}

/// The same of one that is read.
#[inline(always)]
pub(super) fn read_some<'a>(column: &mut &'a [f64], count: usize) -> &'a [f64] {
    let (own, rest) = column.split_at(count);
    *column = rest;
    own
}

/// A sweep of all bands, each by a thread; `target` is asked for that of each, in their order, by how many particles it has.
pub(super) fn share<L: Laws, T: Target + Send>(
    team: &Team,
    frame: &Frame<'_, L, Around<L>>,
    bands: &mut [Band],
    mut target: impl FnMut(usize) -> T,
    row_patches: &mut [[f64; 4]],
) {
    let mut rest = row_patches;
    let parts = bands.iter_mut().map(|band| {
        let (first, end) = band.rows;
        let (patches, later) = std::mem::take(&mut rest).split_at_mut(end - first);
        rest = later;
        let target = target(frame.lattice.start(end) - frame.lattice.start(first));
        (band, target, patches)
    });
    team.share(parts, |(band, mut target, patches)| sweep(frame, band, &mut target, patches));
}

/// Threads that a step of a lattice is worth.
pub(super) fn threads<L>(team: &Option<Team>, around: &Around<L>) -> usize {
    let (lattice, shape) = (&around.lattice, around.shape);
    let threads = team.as_ref().map_or(1, Team::threads);
    let most = (lattice.len() / PARTICLES_PER_THREAD).min(lattice.rows / (4 * shape.reach_rows).max(1));
    if lattice.rows == 1 { 1 } else { threads.min(most).max(1) }
}
