//! Pairs of freezing particles, and pairs that pass over them.

use super::extent::Extent;
use super::numbers::{Flags as _, Kind, Numbers as _};
use super::window::{Surroundings, Window};
use crate::bonds::stencil::Stencil;
use crate::memory::HeapSize;

/// A pair of the particle in the middle of the window.
#[derive(Debug, Clone, Copy)]
pub(super) struct OwnPair {
    /// Place of the other in the window.
    pub(super) other: u32,
    /// Spacings between both along the axis across which the front is taken to lie.
    pub(super) cells: f64,
    /// Spacings to the other along x and y.
    pub(super) offset: [f64; 2],
    /// Weight (m^-2).
    pub(super) weight: f64,
}

/// A pair that the front in the middle of the window cuts, as one of its ends sees it: the pair ends in the middle or passes over it.
#[derive(Debug, Clone)]
pub(super) struct Cut {
    /// Place of the end in the window.
    pub(super) end: u32,
    /// Place of the other end, which may be the middle.
    pub(super) other: u32,
    /// Which of [`Pairs::ends`] its end is.
    pub(super) number: u32,
    /// Spacings between both ends along the axis across which the front is taken to lie.
    pub(super) cells: f64,
    /// Which of [`Pairs::spans`] it goes over, and which way if its end is frozen and if it is not.
    pub(super) span: u32,
    pub(super) directions: [usize; 2],
    /// Places of the two that come after the middle on the way.
    pub(super) next: [u32; 2],
    /// Place of what comes after the other end.
    pub(super) behind: u32,
    /// Weight (m^-2).
    pub(super) weight: f64,
    /// Sums of the offsets of both ends from the middle, along rows and columns.
    pub(super) sums: [i64; 2],
    /// Places on the way from the end to the middle, as a range of [`Pairs::ways`]: a front there cuts the pair.
    way: (u32, u32),
}

/// An end of pairs that the front in the middle of the window cuts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct End {
    /// Its place in the window, and that of what comes before the middle on the way, along an axis or a diagonal.
    pub(super) place: u32,
    pub(super) before: u32,
    /// Spacings to it along x and y, and along the axis of the pair.
    pub(super) offset: [f64; 2],
    pub(super) cells: f64,
}

/// All pairs that a front has to do with.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    /// Pairs of a freezing particle.
    pub(super) own: Vec<OwnPair>,
    /// Pairs of several spacings that a front cuts: those of its own particle, then those over it.
    pub(super) cuts: Vec<Cut>,
    /// How many are of its own particle.
    pub(super) own_cuts: usize,
    /// Their ends, and spacings along x and y that they go over, one way.
    pub(super) ends: Vec<End>,
    pub(super) spans: Vec<[f64; 2]>,
    /// Places on their ways.
    pub(super) ways: Vec<u32>,
    /// Whether fronts may lie at any angle.
    pub(super) turned: bool,
    /// Whether pairs are cut whose ends are in one phase, or by one of two fronts that meet: where it is known which way fronts go, or they
    /// go along an axis.
    pub(super) meeting: bool,
}

/// Distances (in spacings) from a place `spacings` before the centre of a cell to the front in it, behind the share of the
/// cell that is in the phase of that place.
#[inline(always)]
pub(super) fn distance(spacings: f64, share: f64) -> f64 {
    spacings - 0.5 + share
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

impl Cut {
    /// For each front at hand, all bits where it cuts the pair as the end sees it.
    ///
    /// That is the first front on the way from the end, unless the other end is freezing as well and the same front may be in both: then
    /// it is the front there.
    ///
    /// Nor is a pair cut where a wall that heat passes makes an image of one end for the other: the image weighs against the pair
    /// itself, and would be left without it.
    #[inline(always)]
    pub(super) fn is_made<K: Kind<L>, const L: usize>(
        &self,
        kind: K,
        pairs: &Pairs,
        (window, interval): (&Window<L>, (f64, f64)),
        ends_here: bool,
    ) -> K::Flags {
        let end = kind.load(&window.above[self.end as usize]);
        let there = end.differs(kind.of(0.0));
        let mut made = there;
        for place in &pairs.ways[self.way.0 as usize..self.way.1 as usize] {
            made = made & !kind.flags(&window.freezing[*place as usize]);
        }
        let in_question = if ends_here {
            there & !made
        } else {
            // Where there is no particle at the other end, there is no pair; one in the same phase counts where fronts may meet.
            let freezing = kind.flags(&window.freezing[self.other as usize]);
            let other = kind.load(&window.above[self.other as usize]);
            let counts = if pairs.meeting { other.differs(kind.of(0.0)) } else { (end * other).is_less(kind.of(0.0)) };
            made = made & !(!freezing & !counts);
            made & freezing
        };
        if in_question.any() {
            let meets = window.meets(kind, end, [self.other, self.behind], interval);
            let meets = if pairs.meeting { meets } else { meets & !meets };
            made = if ends_here { there & !(in_question & meets) } else { made & !(in_question & !meets) };
        }
        if window.is_clear { made } else { made & window.is_free(kind, self.sums) }
    }
}

impl Pairs {
    /// Pairs of a stencil. Fronts run along y, or along x, where nothing varies across.
    pub(super) fn new(stencil: &Stencil, surroundings: &Surroundings, extent: &Extent) -> Self {
        let along_y = extent.along_y;
        let (across, along) = surroundings.reach;
        let turned = along > 0 && along_y.is_none() && extent.free;
        let mut pairs = Pairs {
            own: Vec::new(),
            cuts: Vec::new(),
            own_cuts: 0,
            ends: Vec::new(),
            spans: Vec::new(),
            ways: Vec::new(),
            turned,
            meeting: turned || along == 0 || along_y.is_some(),
        };
        let mut over = Vec::new();
        for dy in -along..=along {
            for dx in -across..=across {
                let weight = stencil.at(dx.unsigned_abs() as usize, dy.unsigned_abs() as usize);
                let cells = match along_y {
                    None => dx.abs().max(dy.abs()),
                    Some(true) => dy.abs(),
                    Some(false) => dx.abs(),
                };
                if weight == 0.0 || cells == 0 {
                    continue;
                }
                let offset = [dx as f64, dy as f64];
                pairs.own.push(OwnPair { other: surroundings.place((dx, dy)), cells: cells as f64, offset, weight });
                // Where the way runs between cells, half of the pair takes either.
                let [lower, higher] = [false, true].map(|higher| way((dx, dy), cells, higher));
                let both = if lower == higher { vec![(lower, 1.0)] } else { vec![(lower, 0.5), (higher, 0.5)] };
                for (way, part) in both.iter().filter(|(way, _)| !way.is_empty()) {
                    for middle in 0..way.len() {
                        over.push(pairs.cut(surroundings, ((dx, dy), cells, part * weight), way, middle));
                    }
                    let cut = pairs.cut(surroundings, ((dx, dy), cells, part * weight), way, way.len());
                    pairs.cuts.push(cut);
                }
            }
        }
        pairs.own_cuts = pairs.cuts.len();
        pairs.cuts.extend(over);
        pairs
    }

    /// A pair over an offset of so many spacings that is cut in one of the cells on its way, or at its end.
    fn cut(
        &mut self,
        surroundings: &Surroundings,
        ((dx, dy), cells, weight): ((i64, i64), i64, f64),
        way: &[(i64, i64)],
        number: usize,
    ) -> Cut {
        let middle = way.get(number).copied().unwrap_or((dx, dy));
        let from_middle = |(x, y): (i64, i64)| (x - middle.0, y - middle.1);
        let place = |cell: (i64, i64)| surroundings.place(from_middle(cell));
        let spacings = |(x, y): (i64, i64)| [x as f64, y as f64];
        let (there, steps) = (from_middle((0, 0)), number as i64 + 1);
        let near = |along: i64| along / steps;
        let end = End {
            place: place((0, 0)),
            before: surroundings.place((near(there.0), near(there.1))),
            offset: spacings(there),
            cells: steps as f64,
        };
        let is_back = (dy, dx) < (0, 0);
        let forwards = if is_back { (-dx, -dy) } else { (dx, dy) };
        let next = way.get(number + 1).copied().unwrap_or((dx, dy));
        let last = way.last().copied().unwrap_or((0, 0));
        // Where nothing varies across, any place along that axis does.
        let (across, along) = surroundings.reach;
        let behind = from_middle((2 * dx - last.0, 2 * dy - last.1));
        let behind = (behind.0.clamp(-across, across), behind.1.clamp(-along, along));
        let after = match number + 2 {
            step if step < way.len() => place(way[step]),
            step if step == way.len() => place((dx, dy)),
            _ => surroundings.place(behind),
        };
        let first = self.ways.len() as u32;
        self.ways.extend(way[..number].iter().map(|cell| place(*cell)));
        Cut {
            end: place((0, 0)),
            other: place((dx, dy)),
            number: number_of(&mut self.ends, end),
            cells: cells as f64,
            span: number_of(&mut self.spans, spacings(forwards)),
            directions: if is_back { [1, 0] } else { [0, 1] },
            behind: surroundings.place(behind),
            next: [place(next), after],
            weight,
            sums: [dx - 2 * middle.0, dy - 2 * middle.1],
            way: (first, self.ways.len() as u32),
        }
    }
}

/// The number of an element in a list, to which it is added if it is not there.
fn number_of<T: PartialEq>(list: &mut Vec<T>, element: T) -> u32 {
    let number = list.iter().position(|other| *other == element).unwrap_or_else(|| {
        list.push(element);
        list.len() - 1
    });
    number as u32
}

impl HeapSize for Pairs {
    fn heap_size(&self) -> usize {
        self.ways.heap_size()
            + self.own.capacity() * size_of::<OwnPair>()
            + self.cuts.capacity() * size_of::<Cut>()
            + self.ends.capacity() * size_of::<End>()
            + self.spans.capacity() * size_of::<[f64; 2]>()
    }
}
