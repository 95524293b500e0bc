//! Pairs of freezing particles, and pairs that pass over them.

use super::extent::Extent;
use super::numbers::{Flags as _, Kind, Numbers as _, Portable};
use super::window::{Surroundings, Window};
use crate::bonds::stencil::Stencil;
use crate::memory::HeapSize;

/// A pair of the particle in the middle of the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct OwnPair {
    /// Place of the other in the window.
    pub(super) other: u32,
    /// Place on the opposite side.
    pub(super) opposite: u32,
    /// Spacings between both along the axis across which the front is taken to lie.
    pub(super) cells: f64,
    /// Spacings to the other along x and y.
    pub(super) offset: [f64; 2],
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
    pub(super) ways: Vec<u32>,
    /// The most spacings between both ends of a pair.
    pub(super) longest: usize,
    /// Whether fronts may lie at any angle.
    pub(super) turned: bool,
}

/// Distances (in spacings) from a place `spacings` before the centre of a cell to the front in it, behind the share of the
/// cell that is in the phase of that place.
#[inline(always)]
pub(super) fn distance(spacings: f64, share: f64) -> f64 {
    spacings - 0.5 + share
}

/// One over the distances of fronts from ends some spacings from the middle, frozen and unfrozen ones.
pub(super) type Near<const L: usize> = [[f64; L]; 2];

/// How near fronts are to ends so many spacings from the middle, by the frozen fractions of their cells.
#[inline(always)]
pub(super) fn near<K: Kind<L>, const L: usize>(kind: K, cells: usize, fractions: &[f64; L]) -> Near<L> {
    let (one, fractions) = (kind.of(1.0), kind.load(fractions));
    let before = kind.of(cells as f64 - 0.5);
    let mut near = [[0.0; L]; 2];
    kind.store(one / (before + fractions), &mut near[0]);
    kind.store(one / (before + (one - fractions)), &mut near[1]);
    near
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
    pub(super) fn taken<K: Kind<L>, const L: usize>(&self, kind: K, ways: &[u32], window: &Window<L>) -> K::Flags {
        let below = kind.load(&window.above[self.frozen as usize]);
        let above = kind.load(&window.above[self.unfrozen as usize]);
        let zero = kind.of(0.0);
        let mut taken = below.is_less(zero) & zero.is_less(above);
        for place in &ways[self.way.0 as usize..self.way.1 as usize] {
            taken = taken & !kind.flags(&window.freezing[*place as usize]);
        }
        if !window.is_clear {
            let mut is_free = [0; L];
            for lane in 0..L {
                let within = |axis: usize| {
                    let [least, greatest] = window.free[axis];
                    least[lane] <= self.sums[axis] && self.sums[axis] <= greatest[lane]
                };
                is_free[lane] = if within(0) && within(1) { u64::MAX } else { 0 };
            }
            taken = taken & kind.flags(&is_free);
        }
        taken
    }
}

impl Pairs {
    /// Pairs of a stencil. Fronts run along y, or along x, where nothing varies across.
    pub(super) fn new(stencil: &Stencil, surroundings: &Surroundings, extent: &Extent) -> Self {
        let along_y = extent.along_y;
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
                let offset = [dx as f64, dy as f64];
                let (other, opposite) = (place((dx, dy)), place((-dx, -dy)));
                own.push(OwnPair { other, opposite, cells: spacings as f64, offset, weight });
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
        let longest = own.iter().map(|pair| pair.cells as usize).max().unwrap_or(0);
        Pairs { own, over, ways, longest, turned: surroundings.reach.1 > 0 && along_y.is_none() && extent.free }
    }

    /// Whether the only front of a window takes care of a pair over it.
    pub(super) fn is_taken(&self, pair: &PairOver, window: &Window<1>) -> bool {
        pair.taken(Portable, &self.ways, window).any()
    }
}

impl HeapSize for Pairs {
    fn heap_size(&self) -> usize {
        self.ways.heap_size()
            + self.own.capacity() * size_of::<OwnPair>()
            + self.over.capacity() * size_of::<PairOver>()
    }
}
