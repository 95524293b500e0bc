//! The lattice Green's function of a pair operator in the plane: what one cell feels of a line source in another.
//!
//! `g` solves `sum_o w_o (g(x + o) - g(x)) dx^2 = delta(x)` with g(0) = 0; far away `g ~ ln(r/dx) / 2 pi + c`. In ground that conducts
//! by `a` along x and by `b` along y it is `g ~ ln(r/dx) / (2 pi root(a b)) + c` with `r^2 = x^2 + (a/b) y^2`.
//! It is computed as the nearest-neighbour function, for which one integral is done in closed form, plus an
//! integral of the difference of the two spectral inverses, which is smooth enough for the midpoint rule.

use std::f64::consts::PI;

use glam::DVec2;

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
    /// Conductivity along x and along y, over that of the material.
    along: DVec2,
    /// The constant c of the far field.
    pub far_constant: f64,
    /// The integral (in cells) by which the function lies below that of the continuum: `sum w r^4 / 64`, where ground conducts alike in
    /// all directions; else the mean over all waves.
    pub spread: f64,
}

impl Green {
    /// Computes the function for offsets of up to `reach` cells in each direction.
    pub fn new(stencil: &Stencil, spacing: f64, reach: usize) -> Self {
        // Scaled so that the operator has unit second moment: conductivity errors are not the pipe's business.
        let along = stencil.along();
        let (mean, ratio) = (0.5 * (along.x + along.y), along.y / along.x);
        let scale = spacing * spacing * mean / stencil.moment(spacing);
        let offsets: Vec<(usize, usize, f64)> =
            stencil.offsets().map(|(c, r, w)| (c, r, w * scale * Stencil::multiplicity(c, r) as f64)).collect();
        let spread = if along == DVec2::ONE { spread(&offsets) } else { spread_along(&offsets, along) };
        let mut values: Vec<f64> =
            (0..=reach).flat_map(|y| (0..=reach).map(move |x| nearest_neighbour((x, y), ratio) / along.x)).collect();
        let ends = EULER_GAMMA + 1.5 * 2f64.ln() + 0.5 * (2.0 * ratio / (1.0 + ratio)).ln();
        let nearest_constant = ends / (2.0 * PI * (along.x * along.y).sqrt());
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
                let nearest = 2.0 * (along.x + along.y) - 2.0 * along.x * cx[1] - 2.0 * along.y * cy[1];
                let difference = (1.0 / symbol - 1.0 / nearest) * area;
                constant += difference;
                for y in 0..=reach {
                    for x in 0..=reach {
                        values[y * (reach + 1) + x] += (1.0 - cx[x] * cy[y]) * difference;
                    }
                }
            }
        }
        Green { reach, values, along, far_constant: nearest_constant + constant, spread }
    }

    /// The function at an offset in cells.
    pub fn at(&self, x: i64, y: i64) -> f64 {
        self.values[y.unsigned_abs() as usize * (self.reach + 1) + x.unsigned_abs() as usize]
    }

    /// Greatest offset.
    pub fn reach(&self) -> usize {
        self.reach
    }

    /// The part of the far field that grows with the distance, around a circle of a radius (cells) held at one temperature. Where
    /// ground conducts by direction, its field is that of an ellipse once lengths along y are measured by how well heat goes there; far
    /// away an ellipse acts as a circle of the mean of its half axes.
    pub fn far_field(&self, radius: f64) -> f64 {
        (radius * self.mean_half_axis()).ln() / (2.0 * PI * self.conducts())
    }

    /// Radius over spacing of the circle that one cell held at a temperature stands for.
    pub fn one_particle_radius(&self) -> f64 {
        (-2.0 * PI * self.conducts() * self.far_constant).exp() / self.mean_half_axis()
    }

    /// How well the ground conducts heat from a line, over the material: the geometric mean of both directions.
    pub fn conducts(&self) -> f64 {
        (self.along.x * self.along.y).sqrt()
    }

    fn mean_half_axis(&self) -> f64 {
        0.5 * (1.0 + (self.along.x / self.along.y).sqrt())
    }
}

/// `sum w r^4 / 64` over offsets and their weights.
fn spread(offsets: &[(usize, usize, f64)]) -> f64 {
    let fourth = |c: usize, r: usize| ((c * c + r * r) * (c * c + r * r)) as f64;
    offsets.iter().map(|(c, r, w)| w * fourth(*c, *r)).sum::<f64>() / 64.0
}

/// The mean over all directions `n` of waves of `sum w (n . r)^4 / 24 / (a nx^2 + b ny^2)^2`.
fn spread_along(offsets: &[(usize, usize, f64)], along: DVec2) -> f64 {
    const DIRECTIONS: usize = 256;
    let one = |k: usize| {
        let wave = DVec2::from_angle(2.0 * PI * (k as f64 + 0.5) / DIRECTIONS as f64);
        let conducts = along.dot(wave * wave);
        // Offsets of the first quadrant stand for those mirrored at either axis.
        let fourth = |c: usize, r: usize| {
            let (x, y) = (wave.x * c as f64, wave.y * r as f64);
            0.5 * ((x + y).powi(4) + (x - y).powi(4))
        };
        offsets.iter().map(|(c, r, w)| w * fourth(*c, *r)).sum::<f64>() / (24.0 * conducts * conducts)
    };
    (0..DIRECTIONS).map(one).sum::<f64>() / DIRECTIONS as f64
}

/// Green's function of the five-point operator in ground that conducts `ratio` times as well along y as along x, by one integral over a
/// decaying mode.
fn nearest_neighbour((x, y): (usize, usize), ratio: f64) -> f64 {
    if y > x {
        return nearest_neighbour((y, x), 1.0 / ratio) / ratio;
    }
    let (x, y) = (x as f64, y as f64);
    // (1/pi) integral over 0..pi of (1 - exp(-x s) cos(y k)) / (2 sinh s), cosh s = 1 + ratio (1 - cos k). The integrand is
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
        let s = (1.0 + ratio - ratio * k.cos()).acosh();
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
    use crate::bonds::weight::{Disc, Normalisation};

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
    fn far_away_it_is_the_logarithm_of_the_distance_that_heat_feels() {
        for (reach, power) in [(1.0, 2.0), (3.0, 2.0), (2.4, 1.0)] {
            for along in [1.0, 2.0, 0.3, 8.0].map(|ratio| DVec2::new(1.0, ratio)) {
                let stencil = Stencil::directed(&Disc(reach, power), Normalisation::DiscreteMoment, 1.0, along);
                let green = Green::new(&stencil, 1.0, 24);
                let scale = 2.0 * PI * green.conducts();
                for (x, y) in [(24_i64, 0_i64), (0, 24), (20, 20), (9, 22)] {
                    let distance = DVec2::new(x as f64, y as f64 * (along.x / along.y).sqrt()).length();
                    let expected = distance.ln() / scale + green.far_constant;
                    // The next term falls with the square of the distance.
                    let error = (green.at(x, y) - expected).abs() * scale * distance * distance;
                    assert!(error < 2.0 * reach * reach, "({x},{y}) reach {reach} {along}: {error}");
                }
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
