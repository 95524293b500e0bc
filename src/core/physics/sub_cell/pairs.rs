//! Pairs of freezing particles, and pairs that pass over them.

use super::window::{Surroundings, Window};
use crate::bonds::stencil::Stencil;
use crate::memory::HeapSize;

/// Fronts that are worked on side by side.
pub(super) const LANES: usize = 8;

/// A pair of the particle in the middle of the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct OwnPair {
    /// Place of the other in the window.
    pub(super) other: u32,
    /// Place on the opposite side.
    pub(super) opposite: u32,
    /// Spacings between both along the axis across which the front is taken to lie.
    pub(super) cells: usize,
    /// Weight (m^-2).
    pub(super) weight: f64,
}

/// A pair that passes over the middle of the window, from the frozen to the unfrozen side.
#[derive(Debug, Clone)]
pub(super) struct PairOver {
    /// Place of the frozen end in the window.
    pub(super) frozen: u32,
    /// Place of the unfrozen end.
    pub(super) unfrozen: u32,
    /// Spacings between both along the axis across which the front is taken to lie.
    pub(super) cells: usize,
    /// Spacings between the frozen end and the middle.
    pub(super) before: usize,
    /// Weight (m^-2).
    pub(super) weight: f64,
    /// Sums of the offsets of both ends from the middle, along rows and columns.
    pub(super) sums: [i64; 2],
    /// Places on the way from the frozen end to the middle, as a range of [`Pairs::ways`]: a front there takes care of the pair.
    way: (u32, u32),
}

/// All pairs that a front has to do with.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    /// Pairs of a freezing particle.
    pub(super) own: Vec<OwnPair>,
    /// Pairs over a freezing particle.
    pub(super) over: Vec<PairOver>,
    /// Places on their ways.
    ways: Vec<u32>,
    /// The most spacings between both ends of a pair.
    pub(super) longest: usize,
}

/// Distances (in spacings) from a place `spacings` before the centre of a cell to the front in it, behind the share of the
/// cell that is in the phase of that place.
#[inline(always)]
pub(super) fn distance(spacings: f64, share: f64) -> f64 {
    spacings - 0.5 + share
}

/// How near fronts are to ends some spacings from the middle, frozen and unfrozen ones.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near<const L: usize> {
    /// One over the distance.
    inverse: [[f64; L]; 2],
    /// What a pair of the freezing particle carries more than the plain one, over that: with one front in the cell, and with two.
    more: [[[f64; L]; 2]; 2],
}

impl<const L: usize> Near<L> {
    pub(super) const NOWHERE: Self = Near { inverse: [[0.0; L]; 2], more: [[[0.0; L]; 2]; 2] };

    #[inline(always)]
    fn of(cells: usize, fractions: &[f64; L]) -> Self {
        let (mut near, cells, frozen) = (Self::NOWHERE, cells as f64, *fractions);
        for (phase, (inverse, more)) in near.inverse.iter_mut().zip(&mut near.more).enumerate() {
            for lane in 0..L {
                let share = if phase == 0 { frozen[lane] } else { 1.0 - frozen[lane] };
                inverse[lane] = 1.0 / distance(cells, share);
                more[0][lane] = cells * inverse[lane] - 1.0;
                more[1][lane] = cells / distance(cells, 0.5 * share) - 1.0;
            }
        }
        near
    }
}

/// Cells on the way over an offset that is cut into so many of them, ends left out. Where the way runs between two cells,
/// it takes the lower or the higher of them.
fn way((dx, dy): (i64, i64), cells: i64, higher: bool) -> Vec<(i64, i64)> {
    let round = |along: i64| {
        let (whole, rest) = (along.div_euclid(cells), 2 * along.rem_euclid(cells));
        whole + i64::from(rest > cells || rest == cells && higher)
    };
    (1..cells).map(|step| (round(step * dx), round(step * dy))).collect()
}

impl PairOver {
    /// For each front at hand, all bits where it takes care of the pair in the middle, none where another front on the way does.
    /// Nor where a wall that heat passes makes an image of one end for the other: the image weighs against the pair itself, and
    /// would be left without it.
    #[inline(always)]
    fn taken<const L: usize>(&self, ways: &[u32], window: &Window<L>) -> [u64; L] {
        let (below, above) = (window.above[self.frozen as usize], window.above[self.unfrozen as usize]);
        let mut taken = [0; L];
        for lane in 0..L {
            taken[lane] = if (below[lane] < 0.0) & (above[lane] > 0.0) { u64::MAX } else { 0 };
        }
        for place in &ways[self.way.0 as usize..self.way.1 as usize] {
            let freezing = window.freezing[*place as usize];
            for lane in 0..L {
                taken[lane] &= !freezing[lane];
            }
        }
        if !window.is_clear {
            for (sum, [least, greatest]) in self.sums.iter().zip(window.free) {
                for lane in 0..L {
                    taken[lane] &= if (least[lane] <= *sum) & (*sum <= greatest[lane]) { u64::MAX } else { 0 };
                }
            }
        }
        taken
    }
}

impl Pairs {
    /// Pairs of a stencil. Fronts run along y, or along x, where nothing varies across.
    pub(super) fn new(stencil: &Stencil, surroundings: &Surroundings, along_y: Option<bool>) -> Self {
        let (across, along) = surroundings.reach;
        let place = |offset| surroundings.place(offset);
        let (mut own, mut over, mut ways) = (Vec::new(), Vec::new(), Vec::new());
        for dy in -along..=along {
            for dx in -across..=across {
                let weight = stencil.at(dx.unsigned_abs() as usize, dy.unsigned_abs() as usize);
                let spacings = match along_y {
                    None => dx.abs().max(dy.abs()),
                    Some(true) => dy.abs(),
                    Some(false) => dx.abs(),
                };
                if weight == 0.0 || spacings == 0 {
                    continue;
                }
                let cells = spacings as usize;
                own.push(OwnPair { other: place((dx, dy)), opposite: place((-dx, -dy)), cells, weight });
                // Where the way runs between cells, half of the pair takes either.
                let [lower, higher] = [false, true].map(|higher| way((dx, dy), spacings, higher));
                let both = if lower == higher { vec![(lower, 1.0)] } else { vec![(lower, 0.5), (higher, 0.5)] };
                for (way, part) in &both {
                    for (step, middle) in way.iter().enumerate() {
                        let from_middle = |(x, y): (i64, i64)| place((x - middle.0, y - middle.1));
                        over.push(PairOver {
                            frozen: from_middle((0, 0)),
                            unfrozen: from_middle((dx, dy)),
                            cells,
                            before: step + 1,
                            weight: part * weight,
                            sums: [dx - 2 * middle.0, dy - 2 * middle.1],
                            way: (ways.len() as u32, (ways.len() + step) as u32),
                        });
                        ways.extend(way[..step].iter().map(|cell| from_middle(*cell)));
                    }
                }
            }
        }
        let longest = own.iter().map(|pair| pair.cells).max().unwrap_or(0);
        Pairs { own, over, ways, longest }
    }

    /// Whether the only front of a window takes care of a pair over it.
    pub(super) fn is_taken(&self, pair: &PairOver, window: &Window<1>) -> bool {
        pair.taken(&self.ways, window)[0] != 0
    }
}

/// What fronts exchange that are side by side in the middle of a window.
#[inline(always)]
pub(super) fn exchange<const L: usize>(pairs: &Pairs, window: &mut Window<L>) {
    window.note_phases();
    for (cells, near) in window.near.iter_mut().enumerate().skip(1) {
        *near = Near::of(cells, &window.fractions);
    }
    window.changes.fill([0.0; L]);
    // Lanes are copied out and back as wholes: a compiler turns the loops over them into vectors.
    let mut to_middle = [0.0; L];
    for OwnPair { other, opposite, cells, weight } in &pairs.own {
        let (above, beyond) = (window.above[*other as usize], window.above[*opposite as usize]);
        let ([frozen, unfrozen], mut changes) = (window.near[*cells].more, window.changes[*other as usize]);
        for lane in 0..L {
            // Where both sides are in the same phase, two fronts move toward each other.
            let two = above[lane] * beyond[lane] > 0.0;
            let cold = if two { frozen[1][lane] } else { frozen[0][lane] };
            let warm = if two { unfrozen[1][lane] } else { unfrozen[0][lane] };
            let change = weight * above[lane] * if above[lane] > 0.0 { warm } else { cold };
            changes[lane] -= change;
            to_middle[lane] += change;
        }
        window.changes[*other as usize] = changes;
    }
    for pair in &pairs.over {
        let taken = pair.taken(&pairs.ways, window);
        let (frozen, unfrozen) = (pair.frozen as usize, pair.unfrozen as usize);
        let carried = pair.weight * pair.cells as f64;
        let (below, above) = (window.above[frozen], window.above[unfrozen]);
        let (near, far) = (window.near[pair.before].inverse[0], window.near[pair.cells - pair.before].inverse[1]);
        let (mut of_frozen, mut of_unfrozen) = (window.changes[frozen], window.changes[unfrozen]);
        for lane in 0..L {
            // Nothing, where the pair is not taken.
            let below = f64::from_bits(below[lane].to_bits() & taken[lane]);
            let above = f64::from_bits(above[lane].to_bits() & taken[lane]);
            let (cold, warm) = (carried * below * near[lane], carried * above * far[lane]);
            let direct = pair.weight * (above - below);
            of_frozen[lane] -= cold + direct;
            of_unfrozen[lane] += direct - warm;
            to_middle[lane] += cold + warm;
        }
        (window.changes[frozen], window.changes[unfrozen]) = (of_frozen, of_unfrozen);
    }
    let middle = window.changes.len() / 2;
    window.changes[middle] = to_middle;
}

impl HeapSize for Pairs {
    fn heap_size(&self) -> usize {
        self.ways.heap_size()
            + self.own.capacity() * size_of::<OwnPair>()
            + self.over.capacity() * size_of::<PairOver>()
    }
}
