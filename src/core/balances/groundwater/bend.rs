//! What long pairs make of the bend of a profile of potentials, taken out.
//!
//! On a smooth profile the exchange of pairs is `L U = lap U + kappa lap lap U + ...`: with the fourth moment of the weights,
//! `kappa = sum_j w_ij r^4 / (8 d (d + 2))` in d dimensions. Exchanging
//! `U - kappa L U` in place of U leaves an error of the fourth order. The added exchange is conservative and damps, but it
//! has weights of both signs beyond the reach of pairs, so it is limited like the heat that water carries
//! ([`carrier`](crate::balances::groundwater::carrier)): no particle leaves the enthalpies around it.

use glam::DVec2;

use crate::bonds::pair_list::PairList;

/// Wave numbers along each axis at which rates of decay are looked at.
const WAVES: usize = 32;

/// The correction of one stencil, that of all particles of a lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// Fourth moment of the weights over 24 on a line and 64 in a plane (m2).
    pub kappa: f64,
    /// Largest rate of decay of corrected potentials (1/m2): with diffusivity a, explicit steps are linearly stable up
    /// to `2 / (a rate)`.
    pub rate: f64,
}

impl Bend {
    /// From the pairs of any particle of a lattice, with its ghosts.
    pub fn new(positions: &[DVec2], ghosts: &[DVec2], pairs: &PairList, spacing: f64) -> Self {
        let count = positions.len();
        let place = |index: usize| if index < count { positions[index] } else { ghosts[index - count] };
        let stencil: Vec<(DVec2, f64)> = (pairs.starts[0]..pairs.starts[1])
            .map(|k| (place(pairs.partners[k] as usize) - positions[0], pairs.weights[k]))
            .collect();
        let on_a_line = stencil.iter().all(|(arm, _)| arm.y.abs() < 1e-9 * spacing);
        let fourth: f64 = stencil.iter().map(|(arm, weight)| weight * arm.length_squared().powi(2)).sum();
        let kappa = fourth / if on_a_line { 24.0 } else { 64.0 };
        let mut rate: f64 = 0.0;
        for column in 0..=WAVES {
            for row in 0..=if on_a_line { 0 } else { WAVES } {
                let wave = std::f64::consts::PI / (spacing * WAVES as f64) * DVec2::new(column as f64, row as f64);
                let plain: f64 = stencil.iter().map(|(arm, weight)| weight * (1.0 - wave.dot(*arm).cos())).sum();
                rate = rate.max(plain * (1.0 + kappa * plain));
            }
        }
        Bend { kappa, rate }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second difference, `kappa = h^2/12`: the fourth difference is taken out, and the fastest decay is 4 (1 + 1/3).
    #[test]
    fn the_second_difference_becomes_one_of_fourth_order() {
        let (spacing, weight) = (0.1, 1.0 / (0.1 * 0.1));
        let pairs = PairList { starts: vec![0, 2], partners: vec![1, 2], weights: vec![weight; 2] };
        let places = [DVec2::ZERO, DVec2::new(spacing, 0.0), DVec2::new(-spacing, 0.0)];
        let bend = Bend::new(&places, &[], &pairs, spacing);
        assert!((bend.kappa * weight - 1.0 / 12.0).abs() < 1e-15, "{}", bend.kappa);
        assert!((bend.rate / weight - 4.0 * (1.0 + 1.0 / 3.0)).abs() < 1e-12, "{}", bend.rate);
        // On x^4 the plain second difference is off by 2 h^2, and the corrected one at 0 by nothing.
        let plain = |x: f64| weight * ((x + spacing).powi(4) + (x - spacing).powi(4) - 2.0 * x.powi(4));
        let fourth = weight * (plain(spacing) + plain(-spacing) - 2.0 * plain(0.0));
        assert!((plain(0.0) - bend.kappa * fourth).abs() < 1e-12);
    }
}
