//! How much more the pairs carry that are left beside what cuts the others.
//!
//! Ground beside a crack, or beside a part that nothing enters, conducts along it as it does elsewhere; a sum over the pairs that
//! are left would lose what the others carried. A pair of i and j whose weight is w by volume of whole cells has `w (s_i + s_j) / 2` in
//! its place, and particle i, of volume V_i in cells, gains this over V_i. In the sum of `(s_i + s_j) / 2 w (U_j - U_i)^2 / 2` over all
//! pairs, the energy that the exchange descends, a particle then stands with s_i times half of its own row. Where U is linear along the
//! edge that is the energy of the ground in V_i if
//!
//! `s_i = V_i m / m'`,
//!
//! where m and m' are the greatest second moments of its row in any direction, of all pairs and of those that are left: beside an edge
//! that is along it. Across the edge nothing flows.

use glam::DVec2;

use crate::bonds::pair_list::PairList;
use crate::boundary::ghosts::Ghosts;
use crate::space::volumes::Volumes;

/// Strengths of all particles, by time.
pub(super) struct Strengths {
    /// For each particle from when (s) on it has which, in order; none where no pair of it is ever cut.
    steps: Vec<Vec<(f64, f64)>>,
    /// Volumes in cells.
    volumes: Volumes,
}

impl Strengths {
    /// Strengths of particles whose pairs are cut at these times (s); `arm` is the way (m) of a pair.
    pub(super) fn new(pairs: &PairList, times: &[f64], volumes: &Volumes, arm: impl Fn(usize, usize) -> DVec2) -> Self {
        let of = |i: usize| {
            let row = pairs.starts[i]..pairs.starts[i + 1];
            let mut instants: Vec<f64> = row.clone().map(|k| times[k].max(0.0)).filter(|t| t.is_finite()).collect();
            if instants.is_empty() {
                return Vec::new();
            }
            instants.push(0.0);
            instants.sort_unstable_by(f64::total_cmp);
            instants.dedup();
            let after = |time: f64| {
                let left = row.clone().filter(|k| times[*k] > time);
                greatest_moment(left.map(|k| (pairs.weights[k], arm(i, pairs.partners[k] as usize))))
            };
            let whole = after(f64::NEG_INFINITY);
            let strength = |moment: f64| volumes.share(i) * if moment > 0.0 { whole / moment } else { 1.0 };
            instants.into_iter().map(|time| (time, strength(after(time)))).collect()
        };
        let rows = pairs.starts.len() - 1;
        Strengths { steps: (0..rows).map(of).collect(), volumes: volumes.clone() }
    }

    /// Factor of the weight of a pair in the row of its first particle, at a time (s).
    pub(super) fn of_pair(&self, i: usize, j: usize, time: f64) -> f64 {
        0.5 * (self.at(i, time) + self.at(j, time)) / self.volumes.share(i)
    }

    /// Instants (s) after the start at which that factor changes, in order.
    pub(super) fn instants(&self, i: usize, j: usize) -> impl Iterator<Item = f64> {
        let of = |particle: usize| self.steps[particle].iter().skip(1).map(|step| step.0);
        let mut found: Vec<f64> = of(i).chain(of(j)).collect();
        found.sort_unstable_by(f64::total_cmp);
        found.dedup();
        found.into_iter()
    }

    fn at(&self, particle: usize, time: f64) -> f64 {
        let steps = &self.steps[particle];
        let last = steps.partition_point(|step| step.0 <= time).checked_sub(1);
        last.map_or_else(|| self.volumes.share(particle), |last| steps[last].1)
    }
}

/// The way (m) from a particle to a partner, which may be a ghost.
pub(super) fn arm(positions: &[DVec2], ghosts: &Ghosts, i: usize, partner: usize) -> DVec2 {
    let place = partner.checked_sub(positions.len()).map_or_else(|| positions[partner], |ghost| ghosts.position[ghost]);
    place - positions[i]
}

/// The greatest second moment of weights in any direction.
fn greatest_moment(pairs: impl Iterator<Item = (f64, DVec2)>) -> f64 {
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (weight, way) in pairs {
        (xx, xy, yy) = (xx + weight * way.x * way.x, xy + weight * way.x * way.y, yy + weight * way.y * way.y);
    }
    0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy)
}
