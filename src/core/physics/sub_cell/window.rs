//! What lies around freezing particles, some of them side by side.

use std::ops::Range;

use super::changes::Changes;
use super::faces::Faces;
use super::numbers::Kind;
use crate::memory::HeapSize;
use crate::physics::laws::Laws;
use crate::space::lattice::Lattice;

/// A freezing particle: its cell and its frozen fraction.
pub(super) type Front = ((i64, i64), f64);

/// No particle.
pub(super) const NONE: u32 = u32::MAX;

/// What lies around `L` freezing particles, place by place: rows of places around each, of which it has the middle.
#[derive(Debug, Clone)]
pub(super) struct Window<const L: usize> {
    /// Places of a row.
    pub(super) width: usize,
    /// Whether, of each freezing particle, all particles of a row of places stand one after the other; and the first of each row.
    pub(super) is_whole: [bool; L],
    /// Whether that holds of all.
    pub(super) are_whole: bool,
    firsts: Vec<[u32; L]>,
    /// Particles, where it is not so; [`NONE`] where there is none.
    pub(super) particles: Vec<[u32; L]>,
    /// Their potentials (W/m) less that of the front, zero where there is none, and where a front is.
    pub(super) above: Vec<[f64; L]>,
    /// The same with those of particles that fronts enter from a face; noted around such particles only.
    pub(super) all_above: Vec<[f64; L]>,
    /// All bits of a place whose particle a front is in, or enters from a face; none of any other.
    pub(super) freezing: Vec<[u64; L]>,
    /// What fronts add to their rates (W/m3).
    pub(super) changes: Vec<[f64; L]>,
    /// Frozen fractions of the particles in the middle.
    pub(super) fractions: [f64; L],
    /// By axis, the least and greatest sums of the offsets of both ends of a pair at which no open wall makes an image of one end
    /// for the other.
    pub(super) free: [[[i64; L]; 2]; 2],
    /// Whether walls are so far that all sums of offsets are free.
    pub(super) is_clear: bool,
    /// The row of the last of them.
    row: Row,
    /// How many freezing particles there are; what lies around the others is empty.
    pub(super) count: usize,
    /// Heat by weight (W/m) that comes to the fronts over a spacing from each end of pairs that they cut, of the normal or of an axis.
    pub(super) flows: Vec<[[f64; L]; 2]>,
    /// Spacings that pairs which they cut go along the normal, one way and the other.
    pub(super) spans: Vec<[[f64; L]; 2]>,
    /// Potential (W/m) of the fronts.
    at_front: f64,
    /// Enthalpies (J/m3) of the particles.
    pub(super) enthalpies: Vec<[f64; L]>,
}

/// What windows around particles of a row have in common.
#[derive(Debug, Clone)]
struct Row {
    number: i64,
    /// Columns around which all particles of a row of places are there, one after the other.
    whole: Range<i64>,
    /// Columns that walls are far from.
    far: Range<i64>,
    /// Numbers of the first particles of rows of places, less the column of the one in the middle.
    bases: Vec<i64>,
}

impl Row {
    /// Turns to another row.
    fn turn_to(&mut self, number: i64, (lattice, surroundings): (&Lattice, &Surroundings)) {
        let (rows, across) = (lattice.rows as i64, surroundings.reach.0);
        let mut whole = i64::MIN..i64::MAX;
        for (base, row) in self.bases.iter_mut().zip(surroundings.rows_around(lattice, number)) {
            if !(0..rows).contains(&row) {
                whole = 0..0;
                break;
            }
            let (first, end) = lattice.span(row as usize);
            *base = lattice.start(row as usize) as i64 - first as i64 - across;
            whole = whole.start.max(first as i64 + across)..whole.end.min(end as i64 - across);
        }
        let row_is_far = is_far(surroundings.free(lattice, (0, number))[1], surroundings.reach.1);
        let columns = 0..if row_is_far { lattice.columns as i64 } else { 0 };
        let column_is_far = |column: &i64| is_far(surroundings.free(lattice, (*column, number))[0], across);
        let first = columns.clone().find(column_is_far).unwrap_or(0);
        let end = columns.rev().find(column_is_far).map_or(0, |last| last + 1);
        *self = Row { number, whole, far: first..end, bases: std::mem::take(&mut self.bases) };
    }
}

/// What surrounds windows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surroundings {
    /// Offsets that pairs reach along rows and columns.
    pub(super) reach: (i64, i64),
    /// Left, right, bottom, top: whether what lies beyond is the mirror image of the body.
    pub(super) mirrors: [bool; 4],
    /// Along rows and columns: whether the body repeats.
    pub(super) repeats: [bool; 2],
}

impl Surroundings {
    /// Places of a window.
    fn size(&self) -> usize {
        self.width() * (2 * self.reach.1 + 1) as usize
    }

    /// Places of a row of a window.
    fn width(&self) -> usize {
        (2 * self.reach.0 + 1) as usize
    }

    /// Offsets that pairs reach along rows and along columns, one after the other.
    fn both(&self) -> [i64; 2] {
        [self.reach.0, self.reach.1]
    }

    /// Rows of a lattice that rows of places around a row are.
    fn rows_around(&self, lattice: &Lattice, row: i64) -> impl Iterator<Item = i64> + use<> {
        let Surroundings { reach: (_, along), mirrors: [.., bottom, top], repeats } = *self;
        let rows = lattice.rows as i64;
        (row - along..=row + along).map(move |row| reflected(row, rows, (bottom, top), repeats[1]))
    }

    /// By axis, sums of offsets that are free around a cell: see [`free`].
    fn free(&self, lattice: &Lattice, (column, row): (i64, i64)) -> [[i64; 2]; 2] {
        let Surroundings { reach: (across, along), mirrors: [left, right, bottom, top], repeats } = *self;
        [
            free(column, lattice.columns as i64, across, (left, right), repeats[0]),
            free(row, lattice.rows as i64, along, (bottom, top), repeats[1]),
        ]
    }

    /// The place of an offset from the middle.
    pub(super) fn place(&self, (x, y): (i64, i64)) -> u32 {
        ((y + self.reach.1) * (2 * self.reach.0 + 1) + x + self.reach.0) as u32
    }
}

/// The place of the image, in a body of `count` cells that repeats or has mirrors at its ends, of a place on the same axis.
fn reflected(mut place: i64, count: i64, (low, high): (bool, bool), repeats: bool) -> i64 {
    if repeats {
        return place.rem_euclid(count);
    }
    while low && place < 0 || high && place >= count {
        place = if place < 0 { -1 - place } else { 2 * count - 1 - place };
    }
    place
}

/// Sums of the offsets of both ends of a pair from a place, least and greatest, at which neither end reaches the image of
/// the other beyond an open end of the axis.
fn free(place: i64, count: i64, reach: i64, (low, high): (bool, bool), repeats: bool) -> [i64; 2] {
    let (low, high) = (low || repeats, high || repeats);
    let least = if low { i64::MIN } else { reach - 2 * place };
    [least, if high { i64::MAX } else { 2 * (count - 1 - place) - reach }]
}

/// Whether all sums of the offsets of both ends of a pair, of at most some each, are free.
fn is_far([least, greatest]: [i64; 2], reach: i64) -> bool {
    least <= -2 * reach && 2 * reach <= greatest
}

impl<const L: usize> Window<L> {
    /// Windows for pairs with so many ends, which go over so many spans.
    pub(super) fn new(surroundings: &Surroundings, (ends, spans): (usize, usize)) -> Self {
        let (size, width) = (surroundings.size(), surroundings.width());
        Window {
            width,
            is_whole: [true; L],
            are_whole: true,
            firsts: vec![[0; L]; size / width],
            particles: vec![[NONE; L]; size],
            above: vec![[0.0; L]; size],
            all_above: vec![[0.0; L]; size],
            freezing: vec![[0; L]; size],
            changes: vec![[0.0; L]; size],
            fractions: [0.5; L],
            free: [[[0; L]; 2]; 2],
            is_clear: true,
            row: Row { number: i64::MIN, whole: 0..0, far: 0..0, bases: vec![0; size / width] },
            count: 0,
            flows: vec![[[0.0; L]; 2]; ends],
            spans: vec![[[0.0; L]; 2]; spans],
            at_front: 0.0,
            enthalpies: vec![[0.0; L]; size],
        }
    }

    /// Looks around freezing particles, no more than `L`, given by their cells and frozen fractions, by the laws and enthalpies (J/m3)
    /// of all particles and the potential (W/m) of the front.
    #[inline(always)]
    pub(super) fn look_around(
        &mut self,
        (lattice, surroundings): (&Lattice, &Surroundings),
        fronts: &[Front],
        (laws, enthalpy): (&impl Laws, &[f64]),
        (at_front, freezing): (f64, f64),
    ) {
        self.count = fronts.len();
        match self.width {
            3 => self.see_all::<3>((lattice, surroundings), fronts, (enthalpy, freezing)),
            5 => self.see_all::<5>((lattice, surroundings), fronts, (enthalpy, freezing)),
            7 => self.see_all::<7>((lattice, surroundings), fronts, (enthalpy, freezing)),
            _ => self.see_all::<0>((lattice, surroundings), fronts, (enthalpy, freezing)),
        }
        for lane in fronts.len()..L {
            self.is_whole[lane] = true;
            self.enthalpies.iter_mut().for_each(|enthalpies| enthalpies[lane] = freezing);
        }
        self.are_whole = self.is_whole.iter().all(|is_whole| *is_whole);
        let mut above = std::mem::take(&mut self.above);
        laws.fill_some(|at| self.particle(at / L, at % L), self.enthalpies.as_flattened(), above.as_flattened_mut());
        self.above = above;
        self.at_front = at_front;
    }

    /// The particle at a place.
    #[inline(always)]
    pub(super) fn particle(&self, place: usize, lane: usize) -> u32 {
        if self.is_whole[lane] {
            self.firsts[place / self.width][lane] + (place % self.width) as u32
        } else {
            self.particles[place][lane]
        }
    }

    /// Takes the potential of the front from all others, and notes which particles fronts are in, or enter.
    #[inline(always)]
    pub(super) fn note_phases(&mut self, faces: &Faces) {
        self.take_front();
        self.leave_out(faces);
    }

    /// The same around particles that fronts enter, with the potentials of all of these.
    #[inline(always)]
    pub(super) fn note_all_phases(&mut self, faces: &Faces) {
        self.take_front();
        self.all_above.copy_from_slice(&self.above);
        self.leave_out(faces);
    }

    #[inline(always)]
    fn take_front(&mut self) {
        let (above, freezing) = (self.above.as_flattened_mut(), self.freezing.as_flattened_mut());
        for (above, freezing) in above.iter_mut().zip(freezing) {
            *above -= self.at_front;
            *freezing = if *above == 0.0 { u64::MAX } else { 0 };
        }
        for lane in (0..self.count).filter(|lane| !self.is_whole[*lane]) {
            for ((above, freezing), particles) in self.above.iter_mut().zip(&mut self.freezing).zip(&self.particles) {
                if particles[lane] == NONE {
                    (above[lane], freezing[lane]) = (0.0, 0);
                }
            }
        }
    }

    /// Lets particles that fronts enter from a face count as freezing ones.
    #[inline(always)]
    fn leave_out(&mut self, faces: &Faces) {
        if faces.entered().is_empty() {
            return;
        }
        for lane in 0..self.count {
            let mut leave_out = |place: usize| (self.above[place][lane], self.freezing[place][lane]) = (0.0, u64::MAX);
            if self.is_whole[lane] {
                for (row, firsts) in self.firsts.iter().enumerate() {
                    let mut entered = faces.of(firsts[lane], self.width);
                    while entered != 0 {
                        leave_out(row * self.width + entered.trailing_zeros() as usize);
                        entered &= entered - 1;
                    }
                }
            } else {
                for (place, particles) in self.particles.iter().enumerate() {
                    if particles[lane] != NONE && faces.holds(particles[lane]) {
                        leave_out(place);
                    }
                }
            }
        }
    }

    /// Sees the particles around some freezing ones, in rows of `WIDTH` places, if that is not zero.
    #[inline(always)]
    fn see_all<const WIDTH: usize>(
        &mut self,
        place: (&Lattice, &Surroundings),
        fronts: &[Front],
        states: (&[f64], f64),
    ) {
        let width = if WIDTH == 0 { self.width } else { WIDTH };
        let mut are_far = true;
        for (lane, ((column, row), fraction)) in fronts.iter().enumerate() {
            self.fractions[lane] = *fraction;
            if self.row.number != *row {
                self.row.turn_to(*row, place);
            }
            are_far &= self.row.far.contains(column);
            self.is_whole[lane] = self.row.whole.contains(column);
            if !self.is_whole[lane] {
                self.see_places(lane, place, (*column, *row), states);
                continue;
            }
            let rows = self.enthalpies.chunks_exact_mut(width).zip(&mut self.firsts);
            for ((enthalpies, firsts), base) in rows.zip(&self.row.bases) {
                let first = (base + column) as usize;
                firsts[lane] = first as u32;
                for (enthalpies, enthalpy) in enthalpies.iter_mut().zip(&states.0[first..first + width]) {
                    enthalpies[lane] = *enthalpy;
                }
            }
        }
        self.is_clear = are_far || self.note_walls(place, fronts);
    }

    /// Notes which sums of offsets are free around some freezing particles; whether all are.
    fn note_walls(&mut self, (lattice, surroundings): (&Lattice, &Surroundings), fronts: &[Front]) -> bool {
        let mut is_clear = true;
        for (lane, ((column, row), _)) in fronts.iter().enumerate() {
            let both = surroundings.free(lattice, (*column, *row));
            for ((free, [least, greatest]), reach) in self.free.iter_mut().zip(both).zip(surroundings.both()) {
                (free[0][lane], free[1][lane]) = (least, greatest);
                is_clear &= is_far([least, greatest], reach);
            }
        }
        is_clear
    }

    /// Where no wall that heat passes makes an image of one end of a pair for the other, by the sums of the offsets of both.
    #[inline(always)]
    pub(super) fn is_free<K: Kind<L>>(&self, kind: K, sums: [i64; 2]) -> K::Flags {
        let mut is_free = [0; L];
        for lane in 0..L {
            let within = |axis: usize| {
                let [least, greatest] = self.free[axis];
                least[lane] <= sums[axis] && sums[axis] <= greatest[lane]
            };
            is_free[lane] = if within(0) && within(1) { u64::MAX } else { 0 };
        }
        kind.flags(&is_free)
    }

    /// Sees the particles around one, whose number in the window is `lane`, place by place.
    fn see_places(
        &mut self,
        lane: usize,
        (lattice, surroundings): (&Lattice, &Surroundings),
        (column, row): (i64, i64),
        (enthalpy, freezing): (&[f64], f64),
    ) {
        let Surroundings { reach: (across, _), mirrors: [left, right, ..], repeats } = *surroundings;
        let places = self.enthalpies.chunks_exact_mut(self.width).zip(self.particles.chunks_exact_mut(self.width));
        for ((enthalpies, particles), row) in places.zip(surroundings.rows_around(lattice, row)) {
            for ((enthalpies, particles), dx) in enthalpies.iter_mut().zip(particles).zip(-across..=across) {
                let column = reflected(column + dx, lattice.columns as i64, (left, right), repeats[0]);
                let other = lattice.index(column, row);
                particles[lane] = other.map_or(NONE, |other| other as u32);
                enthalpies[lane] = other.map_or(freezing, |other| enthalpy[other]);
            }
        }
    }

    /// Adds what fronts exchange to a list, front by front.
    #[inline(always)]
    pub(super) fn collect(&self, changes: &mut Changes) {
        match self.width {
            3 => self.collect_rows::<3>(changes),
            5 => self.collect_rows::<5>(changes),
            7 => self.collect_rows::<7>(changes),
            _ => self.collect_rows::<0>(changes),
        }
    }

    /// The same in rows of `WIDTH` places, if that is not zero.
    #[inline(always)]
    fn collect_rows<const WIDTH: usize>(&self, changes: &mut Changes) {
        let width = if WIDTH == 0 { self.width } else { WIDTH };
        let mut room = changes.room(self.count * self.changes.len());
        for lane in 0..self.count {
            if self.is_whole[lane] {
                for (firsts, all) in self.firsts.iter().zip(self.changes.chunks_exact(width)) {
                    for (particle, changes) in (firsts[lane]..).zip(all) {
                        room.add(particle, changes[lane]);
                    }
                }
            } else {
                for (particles, changes) in self.particles.iter().zip(&self.changes) {
                    room.add(particles[lane], changes[lane]);
                }
            }
        }
        let taken = room.taken;
        changes.take(taken);
    }
}

impl<const L: usize> HeapSize for Window<L> {
    fn heap_size(&self) -> usize {
        let places = (self.particles.capacity() + self.firsts.capacity()) * size_of::<[u32; L]>();
        let numbers =
            self.above.capacity() + self.all_above.capacity() + self.changes.capacity() + self.enthalpies.capacity();
        let flows = (self.flows.capacity() + self.spans.capacity()) * size_of::<[[f64; L]; 2]>()
            + self.row.bases.capacity() * size_of::<i64>();
        places + flows + (numbers + self.freezing.capacity()) * size_of::<[f64; L]>()
    }
}
