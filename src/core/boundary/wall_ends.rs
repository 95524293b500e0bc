//! Where a part of a wall that is held at a temperature ends beside one through which no heat passes on its own.
//!
//! There the potential goes with the root of the distance, which a lattice does not resolve: the part acts as if it
//! ended short, by a share of the spacing that depends on the weights alone (0.35 for nearest neighbours, 0.5 for
//! peridynamics at ratio 3), and errors fall only with the first power of the spacing. So the part is made longer by
//! what the lattice makes it shorter. How much is found on a half plane of the same lattice: outside of a window the
//! exact root stands, and the difference inside, which decays as the inverse root, tells the place at which the part
//! seems to end. Where walls touch particles it is a ratio of linear functions of what the first particle beyond the end is
//! given; where ghosts are mirrored, the place up to which the part acts is looked for.

use crate::bonds::stencil::Stencil;
use crate::boundary::patch::{Boundary, Stretch};
use crate::solvers::band::Band;
use crate::space::wall::WallId;

/// Where the end of a part seems to be, by the conductance given to the particle that it cuts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallEnd {
    /// How far (in spacings) the part seems to end before the edge of the last particle that it covers whole.
    short: f64,
    slope: f64,
    curve: f64,
}

/// Depth of the window in cells, at least, and in reaches of the stencil.
const DEPTH: usize = 24;
const REACHES: usize = 3;

/// Conductances, in units of the conductivity, at which the end is looked for; a particle that is covered whole has 2.
const TRIALS: [f64; 3] = [0.0, 0.5, 2.0];

impl WallEnd {
    /// The end of a held part under a stencil of a plane.
    pub fn new(stencil: &Stencil, spacing: f64) -> Self {
        let window = Window::new(stencil, spacing);
        let [short, half, whole] = TRIALS.map(|conductance| window.short(Acts::Touching(conductance)));
        // short = (a + b k) / (1 + c k) through the three trials.
        let [_, first, second] = TRIALS;
        let determinant = first * (-second * whole) + second * first * half;
        let (left, right) = (half - short, whole - short);
        let slope = (left * (-second * whole) + right * first * half) / determinant;
        let curve = (first * right - second * left) / determinant;
        WallEnd { short, slope, curve }
    }

    /// How much of the particles from the end on the part must cover, in spacings from the edge of the last one that it
    /// covers whole, to seem to end a share (0 to 1) of a spacing beyond that edge.
    pub fn cover(&self, beyond: f64) -> f64 {
        let share = |beyond: f64| 0.5 * -(self.short + beyond) / (self.slope + beyond * self.curve);
        let first = share(beyond);
        if (0.0..=1.0).contains(&first) { first } else { 1.0 + share(beyond - 1.0).clamp(0.0, 1.0) }
    }
}

/// Agreement of the end that a part seems to have with its own (spacings), and in how many tries.
const AGREED: f64 = 1e-6;
const TRIES: usize = 12;

/// How far (in spacings) beyond the edge of the last particle that it covers whole a part must act, under a stencil of a plane with
/// mirrored ghosts, to seem to end a share (0 to 1) of a spacing beyond that edge.
pub fn mirrored_end(stencil: &Stencil, spacing: f64, beyond: f64) -> f64 {
    let window = Window::mirrored(stencil, spacing);
    let missing = |end: f64| window.short(Acts::UpTo(end)) + beyond;
    let (mut before, mut end) = (beyond, beyond + 0.5);
    let (mut missed, mut misses) = (missing(before), missing(end));
    for _ in 0..TRIES {
        if misses.abs() < AGREED || misses == missed {
            break;
        }
        let next = end - misses * (end - before) / (misses - missed);
        (before, missed) = (end, misses);
        (end, misses) = (next, missing(next));
    }
    end
}

/// The stretches of a wall between two places (m), with held ones made longer where they end beside closed ones: up to `cover`
/// spacings from the edge of the last cell that they cover whole, by the share of a spacing from that edge to their own end.
pub fn lengthened(
    boundary: &Boundary,
    wall: WallId,
    (first, last): (f64, f64),
    spacing: f64,
    cover: impl Fn(f64) -> f64,
) -> Vec<Stretch> {
    let mut found = boundary.stretches(wall, first, last);
    for k in 1..found.len() {
        let (before, after) = (&boundary.patches[found[k - 1].2], &boundary.patches[found[k].2]);
        let place = (found[k].0 - first) / spacing;
        // An edge that is met to rounding is met.
        let whole = if (place - place.round()).abs() < 1e-9 { place.round() } else { place };
        let longer = if before.is_held() && after.is_closed() {
            whole.floor() + cover(whole - whole.floor())
        } else if before.is_closed() && after.is_held() {
            whole.ceil() - cover(whole.ceil() - whole)
        } else {
            continue;
        };
        let place = (first + longer * spacing).clamp(found[k - 1].0, found[k].1);
        found[k - 1].1 = place;
        found[k].0 = place;
    }
    found
}

/// How the wall of a window acts on its particles.
#[derive(Clone, Copy)]
enum Acts {
    /// On the outermost ones, with a conductance of its own on the first beyond the end.
    Touching(f64),
    /// Through mirrored ghosts, up to a place beyond the end.
    UpTo(f64),
}

/// A half plane around the end of a part: held to the right of the middle, closed to the left.
struct Window {
    columns: usize,
    rows: usize,
    /// Strength of pairs by offset in columns and rows, nearest pairs without what follows.
    weights: Vec<(i64, i64, f64)>,
    /// What is added to nearest pairs along the wall, by row, and into the depth, by face.
    along: Vec<f64>,
    down: Vec<f64>,
}

/// The potential around the end: zero on the held part, no flux through the closed one.
fn root(x: f64, y: f64) -> f64 {
    x.hypot(y).sqrt() * (0.5 * y.atan2(x)).sin()
}

impl Window {
    /// Particles at a wall that mirrors them.
    fn mirrored(stencil: &Stencil, spacing: f64) -> Self {
        let reach = stencil.reach as i64;
        let rows = DEPTH.max(REACHES * stencil.reach);
        let strength = |a: i64, b: i64| {
            let weight = stencil.at(a.unsigned_abs() as usize, b.unsigned_abs() as usize);
            weight * spacing * spacing
        };
        let offsets = || (-reach..=reach).flat_map(|b| (-reach..=reach).map(move |a| (a, b)));
        let weights: Vec<(i64, i64, f64)> = offsets()
            .map(|(a, b)| (a, b, strength(a, b)))
            .filter(|(a, b, weight)| *weight > 0.0 || a.abs() + b.abs() == 1)
            .collect();
        Window { columns: 2 * rows, rows, weights, along: Vec::new(), down: Vec::new() }
    }

    /// Particles that a wall touches.
    fn new(stencil: &Stencil, spacing: f64) -> Self {
        let plain = Window::mirrored(stencil, spacing);
        let (reach, weights) = (stencil.reach as i64, &plain.weights);
        // Every face carries exactly the flux of a linear profile, as in the body itself.
        let along = (0..reach).map(|row| {
            let there = weights.iter().filter(|(_, b, _)| row + b >= 0);
            1.0 - there.map(|(a, _, weight)| 0.5 * weight * (a * a) as f64).sum::<f64>()
        });
        let down = (1..=reach).map(|face| {
            let there = weights.iter().filter(|(_, b, _)| *b > 0);
            1.0 - there.map(|(_, b, weight)| weight * (b * face.min(*b)) as f64).sum::<f64>()
        });
        let (along, down) = (along.collect(), down.collect());
        Window { along, down, ..plain }
    }

    fn place(&self, column: i64, row: i64) -> (f64, f64) {
        (column as f64 + 0.5 - self.rows as f64, row as f64 + 0.5)
    }

    /// The share of a pair with an image that passes the part where it acts up to a place (spacings) beyond the middle.
    fn passing(&self, column: i64, row: i64, (along, image): (i64, i64), end: f64) -> f64 {
        let ((x, y), (other, depth)) = (self.place(column, row), self.place(column + along, image));
        ((depth * x + y * other) / (y + depth) + 0.5 + end).clamp(0.0, 1.0)
    }

    /// How far before the middle the part seems to end.
    fn short(&self, acts: Acts) -> f64 {
        let (columns, rows) = (self.columns as i64, self.rows as i64);
        let number = |column: i64, row: i64| (column * rows + row) as usize;
        let reach = self.weights.iter().map(|(a, b, _)| a.abs().max(b.abs())).max().unwrap_or(1);
        let half = (reach * rows + reach) as usize;
        let mut matrix = Band::new((columns * rows) as usize, half);
        let mut potential = vec![0.0; (columns * rows) as usize];
        for column in 0..columns {
            for row in 0..rows {
                let own = number(column, row);
                for (a, b, weight) in &self.weights {
                    let (other, mut depth) = (column + a, row + b);
                    let mut follows = 1.0;
                    if depth < 0 {
                        let Acts::UpTo(end) = acts else { continue };
                        depth = -1 - depth;
                        follows -= 2.0 * self.passing(column, row, (*a, depth), end);
                    }
                    let added = match (a.abs(), b.abs()) {
                        (1, 0) => self.along.get(row as usize),
                        (0, 1) => self.down.get((row.max(depth) - 1) as usize),
                        _ => None,
                    };
                    let strength = weight + added.copied().unwrap_or(0.0);
                    matrix.row_mut(own)[half] += strength;
                    if (0..columns).contains(&other) && depth < rows {
                        matrix.row_mut(own)[half + number(other, depth) - own] -= follows * strength;
                    } else {
                        let (x, y) = self.place(other, depth);
                        potential[own] += follows * strength * root(x, y);
                    }
                }
                if let (Acts::Touching(conductance), true) = (acts, row == 0 && column + 1 >= rows) {
                    matrix.row_mut(own)[half] += if column >= rows { 2.0 } else { conductance };
                }
            }
        }
        matrix.solve(&mut potential);
        // What differs is c (rho^-1/2 + d rho^1/2) sin(phi/2), and a shift of the root by s has c = s/2.
        let mut sums = [0.0; 5];
        for column in 0..columns {
            for row in 0..rows {
                let (x, y) = self.place(column, row);
                let distance = x.hypot(y) / self.rows as f64;
                if !(0.25..0.6).contains(&distance) {
                    continue;
                }
                let (near, far) = (root(x, y) / x.hypot(y), root(x, y));
                let difference = potential[number(column, row)] - root(x, y);
                let terms = [near * near, near * far, far * far, near * difference, far * difference];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
        }
        let [nn, nf, ff, nd, fd] = sums;
        2.0 * (nd * ff - fd * nf) / (nn * ff - nf * nf)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bonds::weight::{Disc, Normalisation, PairWeight};

    struct Nearest;

    impl PairWeight for Nearest {
        fn reach(&self) -> f64 {
            1.0
        }
        fn weight(&self, _distance: f64) -> f64 {
            1.0
        }
    }

    /// Values of the same problem by an independent sparse solve on wider windows (64 and 40 deep), to their digits.
    #[test]
    fn ends_seem_short_by_the_known_shares() {
        let found =
            |weight: &dyn PairWeight| WallEnd::new(&Stencil::new(weight, Normalisation::DiscreteMoment, 1.0, 2), 1.0);
        for (weight, short, cover) in [
            (&Nearest as &dyn PairWeight, 0.3526, 0.1847),
            (&Disc(3.0, 2.0), 0.5024, 0.2625),
            (&Disc(4.0, 2.0), 0.5672, 0.3085),
            (&Disc(8.0, 2.0), 0.8346, 0.6302),
        ] {
            let end = found(weight);
            assert!((end.short - short).abs() < 0.006, "{end:?}, {short}");
            assert!((end.cover(0.0) - cover).abs() < 0.012, "{}, {cover}", end.cover(0.0));
        }
    }

    /// The same with mirrored ghosts, by an independent dense solve on windows as wide, to its digits.
    #[test]
    fn mirrors_act_as_far_beyond_ends_as_is_known() {
        for (weight, short, end) in [(&Nearest as &dyn PairWeight, 0.351, 0.19), (&Disc(3.0, 2.0), 0.459, 0.43)] {
            let stencil = Stencil::new(weight, Normalisation::DiscreteMoment, 1.0, 2);
            let plain = Window::mirrored(&stencil, 1.0).short(Acts::UpTo(0.0));
            assert!((plain - short).abs() < 1e-3, "{plain}, {short}");
            let found = mirrored_end(&stencil, 1.0, 0.0);
            assert!((found - end).abs() < 0.015, "{found}, {end}");
            let farther = mirrored_end(&stencil, 1.0, 0.5);
            assert!(farther > found && farther < found + 1.0, "{found}, {farther}");
        }
    }

    /// A part that ends a whole spacing farther covers a whole particle more, and covers grow in between.
    #[test]
    fn covers_grow_with_the_part() {
        for ratio in [1.0, 3.0, 8.0] {
            let stencil = Stencil::new(&Disc(ratio, 2.0), Normalisation::DiscreteMoment, 1.0, 2);
            let end = WallEnd::new(&stencil, 1.0);
            let covers: Vec<f64> = (0..=20).map(|k| end.cover(f64::from(k) / 20.0)).collect();
            assert!(covers.windows(2).all(|pair| pair[0] < pair[1]), "{ratio}: {covers:?}");
            assert!((covers[20] - covers[0] - 1.0).abs() < 0.02, "{ratio}: {covers:?}");
        }
    }
}
