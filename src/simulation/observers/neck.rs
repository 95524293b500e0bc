//! How wide the open ground between two frozen bodies is, where it is narrowest.
//!
//! Ground that freezes at one temperature is open for `1 - f` of a particle, f its frozen fraction. Summed along a way from one body
//! to the other that is the width of open ground on it. Ways side by side tell it at the neck: there the width goes with the square
//! of the distance `v` from the narrowest place, `w + k v^2`, until `w` is nothing. No single particle decides: which one freezes last,
//! and when, depends on how the lattice lies.

use frazil_core::memory::{HeapSize, total};
use glam::DVec2;

use super::sampler::{Sample, Sampler};

/// Distance of ways, over the spacing of particles and over the distance of the bodies, at most: a neck is a parabola only where it
/// is narrow beside how round its sides are.
const APART: (f64, f64) = (0.5, 1.0 / 24.0);

/// How open a place is from which on nothing there is frozen, but for rounding.
const OPEN: f64 = 1.0 - 1e-12;

/// Weights of five ways side by side whose mean is taken.
const MEAN: [f64; 5] = [1.0 / 9.0, 2.0 / 9.0, 3.0 / 9.0, 2.0 / 9.0, 1.0 / 9.0];

/// Mean square of how far they lie from the middle one, in ways.
const MEAN_SQUARE: f64 = 4.0 / 3.0;

/// The same of all places that a particle is read for, in spacings: it fills its cell, and is read in those beside it too.
const OF_A_CELL: f64 = 1.0 / 12.0 + 1.0 / 6.0;

/// Ways from one mean to the next, of the three that a parabola goes through.
const NEXT: usize = 3;

/// Ways that tell of one place: two to either side in each mean, of three means.
const AROUND: usize = 2 * NEXT + MEAN.len();

/// Ways that tell of one place, by their numbers, and their widths (m).
type Widths = [(usize, f64); AROUND];

/// None of them.
const NO_WIDTHS: Widths = [(usize::MAX, 0.0); AROUND];

/// A way between two bodies, with a bend half-way.
#[derive(Debug, Clone)]
struct Way {
    /// Its bend.
    gate: Sample,
    /// Particles, and the lengths of the way (m) that lie in them.
    lengths: Sample,
}

/// The whole number that a quotient of lengths comes up to; what rounding adds to it makes no further one.
fn up(quotient: f64) -> f64 {
    ((1.0 - 1e-9) * quotient).ceil()
}

impl HeapSize for Way {
    fn heap_size(&self) -> usize {
        self.gate.heap_size() + self.lengths.heap_size()
    }
}

/// Ways between two bodies, side by side.
#[derive(Debug, Clone)]
pub(super) struct Neck {
    ways: Vec<Way>,
    /// Mean square distance from a way of all that is read for it, in ways.
    spread: f64,
    /// Particles at the bends and beside them: while nothing of these is frozen, all bends are open. None where a bend is not all within
    /// particles, and so never open.
    at_bends: Vec<u32>,
}

impl Neck {
    /// Between two places, with ways that bend as far to either side as half the distance of both.
    pub(super) fn between([a, b]: [DVec2; 2], sampler: &Sampler<'_>) -> Neck {
        let spacing = sampler.lattice.spacing;
        let apart = (APART.0 * spacing).min(APART.1 * a.distance(b));
        let (middle, across) = (0.5 * (a + b), (b - a).perp().normalize_or_zero());
        let count = up(0.5 * a.distance(b) / apart) as i64 + (AROUND / 2) as i64;
        let way = |bend: DVec2| {
            let mut lengths = Vec::new();
            for end in [a, b] {
                let pieces = up(2.0 * bend.distance(end) / spacing).max(1.0);
                let length = bend.distance(end) / pieces;
                for piece in 0..pieces as usize {
                    let place = bend.lerp(end, (piece as f64 + 0.5) / pieces);
                    sampler.add(place, length, &mut lengths);
                }
            }
            lengths.sort_unstable_by_key(|entry: &(u32, f64)| entry.0);
            lengths.dedup_by(|next, own| {
                let same = next.0 == own.0;
                own.1 += if same { next.1 } else { 0.0 };
                same
            });
            lengths.shrink_to_fit();
            Way { gate: sampler.sample(bend), lengths: Sample(lengths) }
        };
        let spread = MEAN_SQUARE + OF_A_CELL * (spacing / apart).powi(2);
        let ways: Vec<Way> = (-count..=count).map(|k| way(middle + k as f64 * apart * across)).collect();
        let bends = &ways[AROUND / 2..ways.len() - AROUND / 2];
        let at_bends = match bends.iter().all(|way| way.gate.of(|_| 1.0) >= OPEN) {
            true => around(bends, sampler),
            false => Vec::new(),
        };
        Neck { ways, spread, at_bends }
    }

    /// Whether the bends of all ways are open, so that the open ground is wider than can be told, by whether heat says of a particle that
    /// nothing of it is frozen. What fronts say of a particle beside which nothing is frozen is the same.
    pub(super) fn is_wide(&self, is_unfrozen: impl Fn(usize) -> bool) -> bool {
        !self.at_bends.is_empty() && self.at_bends.iter().all(|i| is_unfrozen(*i as usize))
    }

    /// Width (m) of the open ground where it is narrowest, by the frozen fractions of particles. Nothing, or less, once both bodies have
    /// met; infinite while the bends of all ways are open: then it is wider than a particle.
    pub(super) fn width(&self, fractions: &[f64]) -> f64 {
        let mut widths = NO_WIDTHS;
        let places = 0..=self.ways.len() - AROUND;
        places.fold(f64::INFINITY, |least, first| least.min(self.width_at(first, &mut widths, fractions)))
    }

    /// Whether both bodies have met. Where they have met half-way, as those that are alike do, nothing else is looked at.
    pub(super) fn has_met(&self, fractions: &[f64]) -> bool {
        let half_way = self.width_at((self.ways.len() - AROUND) / 2, &mut { NO_WIDTHS }, fractions);
        half_way <= 0.0 || self.width(fractions) <= 0.0
    }

    /// Width (m) by the ways from one on; infinite where the middle one of them bends in the open. Widths of ways that are known are kept
    /// from one call to the next.
    fn width_at(&self, first: usize, widths: &mut Widths, fractions: &[f64]) -> f64 {
        let middle = AROUND / 2;
        if self.ways[first + middle].gate.of(|i| 1.0 - fractions[i]) >= OPEN {
            return f64::INFINITY;
        }
        for way in first..first + AROUND {
            let held = &mut widths[way % AROUND];
            if held.0 != way {
                *held = (way, self.ways[way].lengths.of(|i| 1.0 - fractions[i]));
            }
        }
        let mean = |middle: usize| -> f64 {
            MEAN.iter().zip(first + middle - 2..).map(|(weight, way)| weight * widths[way % AROUND].1).sum()
        };
        narrowest([mean(middle - NEXT), mean(middle), mean(middle + NEXT)], self.spread)
    }
}

/// Particles at bends and beside them.
fn around(bends: &[Way], sampler: &Sampler<'_>) -> Vec<u32> {
    let mut around = Vec::new();
    for (i, _) in bends.iter().flat_map(|way| &way.gate.0) {
        let (column, row) = sampler.lattice.cell(*i as usize);
        let cross = [(0, 0), (-1, 0), (1, 0), (0, -1), (0, 1)];
        let there = cross.iter().filter_map(|(dx, dy)| sampler.lattice.index(column + dx, row + dy));
        around.extend(there.map(|i| i as u32));
    }
    around.sort_unstable();
    around.dedup();
    around.shrink_to_fit();
    around
}

/// The least of a parabola, within half a way of the middle, by three means over ways that lie `spread` from the middle ones.
fn narrowest([before, here, after]: [f64; 3], spread: f64) -> f64 {
    let next = NEXT as f64;
    let (curvature, slope) = ((before - 2.0 * here + after) / (2.0 * next * next), (after - before) / (2.0 * next));
    let aside = if curvature > 0.0 { (-0.5 * slope / curvature).clamp(-0.5, 0.5) } else { 0.0 };
    here - curvature * spread + (slope + curvature * aside) * aside
}

impl HeapSize for Neck {
    fn heap_size(&self) -> usize {
        total(&[&self.ways, &self.at_bends])
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use frazil_core::space::domain::{Domain, Sector};
    use frazil_core::space::lattice::Lattice;
    use proptest::prelude::*;

    /// Open share of a cell beside two discs: the mean over lines across it, on each of which it is known.
    fn share(lattice: &Lattice, i: usize, discs: [DVec2; 2], radius: f64) -> f64 {
        const LINES: usize = 200;
        let (place, half) = (lattice.position(i), 0.5 * lattice.spacing);
        let frozen = |line: usize| {
            let x = place.x + ((line as f64 + 0.5) / LINES as f64 - 0.5) * lattice.spacing;
            let [a, b] = discs.map(|disc| {
                let reach = (radius * radius - (x - disc.x).powi(2)).max(0.0).sqrt();
                (disc.y - reach, disc.y + reach)
            });
            let within = |(low, high): (f64, f64)| (high.min(place.y + half) - low.max(place.y - half)).max(0.0);
            within(a) + within(b) - within((a.0.max(b.0), a.1.min(b.1)))
        };
        1.0 - (0..LINES).map(frozen).sum::<f64>() / (LINES as f64 * lattice.spacing)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Two discs, however they lie to the lattice: the width between them is told within a small part of a spacing, and its
        /// sign is right.
        #[test]
        fn the_width_between_discs_is_found(
            turn in 0.0..TAU, x in -0.05..0.05f64, y in -0.05..0.05f64, open in -0.03..0.09f64,
        ) {
            let lattice = Lattice::new(&Domain::Ring { outer_radius: 1.6, sector: Sector::Whole }, 0.1);
            let sampler = Sampler::on(&lattice);
            let (aside, centre) = (0.6 * DVec2::from_angle(turn), DVec2::new(x, y));
            let discs = [centre - aside, centre + aside];
            let neck = Neck::between(discs, &sampler);
            let frozen: Vec<f64> =
                (0..lattice.len()).map(|i| 1.0 - share(&lattice, i, discs, 0.6 - 0.5 * open)).collect();
            let found = neck.width(&frozen);
            // Sides of six spacings are flatter than parabolas.
            let tolerance = 0.05 * 0.1;
            prop_assert!(found >= open - tolerance, "{found} for {open}");
            // Where both overlap, widths are cut off at nothing.
            prop_assert!(found <= open.max(0.0) + tolerance, "{found} for {open}");
            prop_assert!(found < 0.0 || open > -0.1 * 0.1, "{found} for {open}");
            // By then bends are no longer open.
            prop_assert!(!neck.is_wide(|i| frozen[i] == 0.0), "{found} for {open}");
        }
    }

    #[test]
    fn open_ground_is_wide_and_frozen_ground_is_closed() {
        let lattice = Lattice::new(&Domain::Ring { outer_radius: 1.6, sector: Sector::Whole }, 0.1);
        let neck = Neck::between([DVec2::new(-0.6, 0.0), DVec2::new(0.6, 0.1)], &Sampler::on(&lattice));
        let [none, all] = [0.0, 1.0].map(|frozen| vec![frozen; lattice.len()]);
        assert_eq!(neck.width(&none), f64::INFINITY);
        assert!(neck.width(&all) <= 0.0);
        assert!(!neck.is_wide(|_| false));
    }

    /// Ground between two discs that grow is told to be wide until a bend is beside what is frozen, and then the width is told.
    #[test]
    fn wide_ground_has_no_width() {
        let lattice = Lattice::new(&Domain::Ring { outer_radius: 1.6, sector: Sector::Whole }, 0.1);
        for turn in [0.0, 0.3, 0.9, 2.0] {
            let aside = 0.6 * DVec2::from_angle(turn);
            let discs = [-aside, aside];
            let neck = Neck::between(discs, &Sampler::on(&lattice));
            let mut last = true;
            for radius in (10..60).map(|k| 0.01 * f64::from(k)) {
                let frozen: Vec<f64> = (0..lattice.len()).map(|i| 1.0 - share(&lattice, i, discs, radius)).collect();
                let (is_wide, width) = (neck.is_wide(|i| frozen[i] == 0.0), neck.width(&frozen));
                assert!(last || !is_wide, "{turn} {radius}");
                assert!(!is_wide || width == f64::INFINITY, "{turn} {radius}: {width}");
                // Bends are read over two spacings, and beside them one more.
                assert!(is_wide || 0.6 - radius < 3.0 * 0.1, "{turn} {radius}");
                last = is_wide;
            }
            assert!(!last);
        }
    }
}
