//! The lattice Green's function of a pair operator in the plane: what one cell feels of a line source in another.
//!
//! `g` solves `sum_o w_o (g(x + o) - g(x)) dx^2 = delta(x)` with g(0) = 0; far away `g ~ ln(r/dx) / 2 pi + c`.
//! It is computed as the nearest-neighbour function, for which one integral is done in closed form, plus an
//! integral of the difference of the two spectral inverses, which is smooth enough for the midpoint rule.

use std::f64::consts::PI;

use crate::bonds::stencil::Stencil;

/// Euler's constant.
const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;

/// Midpoints along one axis of the quarter of the Brillouin zone.
const MIDPOINTS: usize = 192;

/// Green's function of a stencil on offsets up to `reach` cells.
#[derive(Debug, Clone)]
pub struct Green {
    reach: usize,
    values: Vec<f64>,
    /// The constant c of the far field.
    pub far_constant: f64,
    /// The integral (in cells) by which the function lies below that of the continuum: `sum w r^4 / 64`.
    pub spread: f64,
}

impl Green {
    /// Computes the function for offsets of up to `reach` cells in each direction.
    pub fn new(stencil: &Stencil, spacing: f64, reach: usize) -> Self {
        // Scaled so that the operator has unit second moment: conductivity errors are not the pipe's business.
        let scale = spacing * spacing / stencil.moment(spacing);
        let offsets: Vec<(usize, usize, f64)> =
            stencil.offsets().map(|(c, r, w)| (c, r, w * scale * Stencil::multiplicity(c, r) as f64)).collect();
        let fourth = |c: usize, r: usize| ((c * c + r * r) * (c * c + r * r)) as f64;
        let spread = offsets.iter().map(|(c, r, w)| w * fourth(*c, *r)).sum::<f64>() / 64.0;
        let mut values: Vec<f64> =
            (0..=reach).flat_map(|y| (0..=reach).map(move |x| nearest_neighbour(x, y))).collect();
        let nearest_constant = (EULER_GAMMA + 1.5 * 2f64.ln()) / (2.0 * PI);
        let step = PI / MIDPOINTS as f64;
        let widest = stencil.reach.max(reach);
        let cosines: Vec<Vec<f64>> = (0..MIDPOINTS)
            .map(|i| (0..=widest).map(|n| (n as f64 * (i as f64 + 0.5) * step).cos()).collect())
            .collect();
        let mut constant = 0.0;
        let area = 1.0 / (MIDPOINTS * MIDPOINTS) as f64;
        for cx in &cosines {
            for cy in &cosines {
                let symbol: f64 = offsets.iter().map(|(c, r, w)| w * (1.0 - cx[*c] * cy[*r])).sum();
                let nearest = 4.0 - 2.0 * cx[1] - 2.0 * cy[1];
                let difference = (1.0 / symbol - 1.0 / nearest) * area;
                constant += difference;
                for y in 0..=reach {
                    for x in 0..=reach {
                        values[y * (reach + 1) + x] += (1.0 - cx[x] * cy[y]) * difference;
                    }
                }
            }
        }
        Green { reach, values, far_constant: nearest_constant + constant, spread }
    }

    /// The function at an offset in cells.
    pub fn at(&self, x: i64, y: i64) -> f64 {
        self.values[y.unsigned_abs() as usize * (self.reach + 1) + x.unsigned_abs() as usize]
    }

    /// Greatest offset.
    pub fn reach(&self) -> usize {
        self.reach
    }

    /// Radius over spacing of the circle that one cell held at a temperature stands for.
    pub fn one_particle_radius(&self) -> f64 {
        (-2.0 * PI * self.far_constant).exp()
    }
}

/// Green's function of the five-point operator, by one integral over a decaying mode.
fn nearest_neighbour(x: usize, y: usize) -> f64 {
    let (x, y) = (x.max(y) as f64, x.min(y) as f64);
    // (1/pi) integral over 0..pi of (1 - exp(-x s) cos(y k)) / (2 sinh s), cosh s = 2 - cos k. The integrand is
    // smooth on the half period; composite Gauss-Legendre resolves it to rounding.
    const NODES: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
        (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
    ];
    const PANELS: usize = 32;
    let half = PI / (2 * PANELS) as f64;
    let integrand = |k: f64| {
        let s = (2.0 - k.cos()).acosh();
        (1.0 - (-x * s).exp() * (y * k).cos()) / (2.0 * s.sinh())
    };
    let mut sum = 0.0;
    for panel in 0..PANELS {
        let centre = half * (2 * panel + 1) as f64;
        for (node, weight) in NODES {
            sum += weight * (integrand(centre - half * node) + integrand(centre + half * node));
        }
    }
    sum * half / PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bonds::weight::{Normalisation, PairWeight};

    struct Disc(f64, f64);
    impl PairWeight for Disc {
        fn reach(&self) -> f64 {
            self.0
        }
        fn weight(&self, distance: f64) -> f64 {
            distance.powf(-self.1)
        }
    }

    fn stencil(reach: f64, power: f64) -> Stencil {
        Stencil::new(&Disc(reach, power), Normalisation::DiscreteMoment, 1.0, 2)
    }

    #[test]
    fn nearest_neighbour_values_are_the_known_ones() {
        // g(1,0) = 1/4, g(1,1) = 1/pi, g(2,0) = 1 - 2/pi (McCrea and Whipple 1940), to quadrature.
        let green = Green::new(&stencil(1.0, 2.0), 1.0, 8);
        for ((x, y), exact) in [((0, 0), 0.0), ((1, 0), 0.25), ((1, 1), 1.0 / PI), ((2, 0), 1.0 - 2.0 / PI)] {
            assert!((green.at(x, y) - exact).abs() < 1e-12, "g({x},{y}) = {}", green.at(x, y));
        }
    }

    #[test]
    fn the_operator_turns_it_into_a_point_source() {
        for (reach, power) in [(1.0, 2.0), (3.0, 2.0), (2.4, 1.0), (3.92, 1.0)] {
            let stencil = stencil(reach, power);
            let green = Green::new(&stencil, 1.0, 16);
            for (x, y) in [(0i64, 0i64), (1, 0), (2, 1), (5, 3), (8, 8)] {
                let mut rate = 0.0;
                for (c, r, w) in stencil.offsets() {
                    let mut signs = vec![(1, 1)];
                    if c > 0 {
                        signs.push((-1, 1));
                    }
                    if r > 0 {
                        signs.extend(signs.clone().iter().map(|(a, _)| (*a, -1)));
                    }
                    for (a, b) in signs {
                        rate += w * (green.at(x + a * c as i64, y + b * r as i64) - green.at(x, y));
                    }
                }
                let source = if (x, y) == (0, 0) { 1.0 } else { 0.0 };
                // The midpoint rule meets a direction-dependent value at the origin: second order in its step.
                assert!((rate - source).abs() < 2e-4, "({x},{y}) reach {reach}: {rate}");
            }
        }
    }

    #[test]
    fn one_particle_stands_for_the_radii_of_the_lattice_sums() {
        // Independent lattice sums: 5-point 0.1985, PD constant m = 3 0.0159, m = 2 0.0855, m = 4 0.0022.
        for (reach, expected, digits) in
            [(1.0, 0.1985, 1e-4), (2.0, 0.0855, 1e-4), (3.0, 0.0159, 1e-4), (4.0, 0.0022, 1e-4)]
        {
            let radius = Green::new(&stencil(reach, 2.0), 1.0, 2).one_particle_radius();
            assert!((radius - expected).abs() < digits, "m = {reach}: {radius}");
        }
    }
}
