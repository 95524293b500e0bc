//! Passes over columns of all particles, in parts that threads share.

use crate::team::{Team, share};

/// Particles of a part; fixed, so that sums do not depend on the number of threads. Five columns of as many stay in the second cache of
/// a core, so that what a pass does with them in turn reads them from memory once.
pub const PART: usize = 1 << 14;

/// Does all parts of a pass over so many particles, side by side if they are several.
pub fn in_parts<P: Send>(team: Option<&Team>, count: usize, parts: impl Iterator<Item = P>, one: impl Fn(P) + Sync) {
    share(team.filter(|_| count > PART), parts, one);
}
