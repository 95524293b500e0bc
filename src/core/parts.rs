//! Passes over columns of all particles, in parts that threads share.

use crate::side_by_side::MinMax;
use crate::team::{Team, share};

/// Particles of a part; fixed, so that sums do not depend on the number of threads. Five columns of as many stay in the second cache of
/// a core, so that what a pass does with them in turn reads them from memory once.
pub const PART: usize = 1 << 14;

/// Does all parts of a pass over so many particles, side by side if they are several.
pub fn in_parts<P: Send>(team: Option<&Team>, count: usize, parts: impl Iterator<Item = P>, one: impl Fn(P) + Sync) {
    share(team.filter(|_| count > PART), parts, one);
}

/// The least and the greatest of a column but those at some places, which come in order; `found` is room for those of parts.
pub fn extremes(team: Option<&Team>, values: &[f64], places: &[u32], found: &mut Vec<MinMax>) -> MinMax {
    found.resize(values.len().div_ceil(PART), MinMax::NONE);
    in_parts(team, values.len(), found.iter_mut().zip(values.chunks(PART)).enumerate(), |(number, (found, part))| {
        *found = MinMax::without(part, (number * PART, places));
    });
    found.iter().fold(MinMax::NONE, |all, part| all.and(part))
}
