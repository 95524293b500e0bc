//! Sharp fronts inside particles.
//!
//! A particle that is freezing has no temperature of its own to conduct with: the front lies somewhere in its cell, and
//! its frozen fraction `f` tells where. Left alone, its neighbours exchange heat with the centre of the cell, wherever the
//! front is, and fluxes go up and down as the front crosses one cell after another. Here they exchange with the front. The
//! front is taken to lie across the longer axis of a pair, or, where nothing varies along the other axis of the body, across
//! the one that is left, as on the line that stands for such a body: a pair over `k` spacings along it whose one end lies `s`
//! spacings before the freezing cell carries `k / d` times as much between that end and the freezing particle, with
//! `d = s - 1/2 + f` on the frozen side and `s + 1/2 - f` on the other. Over the time in which a cell freezes this and
//! the plain exchange with its centre agree: the mean of `d` is `s`. Where both sides of a cell are in the same phase, two
//! fronts move toward each other, and each has half of the cell. Where a pair reaches over a freezing cell from one
//! phase to the other, both ends exchange with the front and not with each other.
//!
//! Every term is exchanged between two particles, so heat is conserved; weights stay positive, so with a step by the row
//! sums given here the maximum principle holds as without. On a line the error falls with the square of the spacing, for
//! every method (docs/theory/heat.md).

use crate::bonds::stencil::Stencil;
use crate::memory::HeapSize;
use crate::physics::latent_heat::Materials;
use crate::physics::sharp_stretches::{Sharp, find, stretches};
use crate::solvers::kept::add_one;
use crate::space::lattice::Lattice;

/// No particle.
const NONE: u32 = u32::MAX;

/// What fronts need to know of a body beside its particles.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// Least and greatest temperature of the scene.
    pub temperatures: (f64, f64),
    /// Left, right, bottom, top: whether what lies beyond is the mirror image of the body.
    pub mirrors: [bool; 4],
    /// Whether fronts run along y, or along x, where nothing varies across.
    pub along_y: Option<bool>,
}

/// The fronts of a body whose materials, or some of them, freeze at one temperature.
#[derive(Debug, Clone)]
pub struct SubCellFront {
    sharp: Vec<Sharp>,
    /// Neighbouring particles of one material whose fronts are followed: the first, one past the last, and which of `sharp`.
    stretches: Vec<(u32, u32, u32)>,
    /// Pairs of a freezing particle.
    own: Vec<OwnPair>,
    /// Pairs over a freezing particle.
    over: Vec<PairOver>,
    /// Places on their ways.
    ways: Vec<u32>,
    /// Offsets that pairs reach along rows and columns.
    reach: (i64, i64),
    /// Left, right, bottom, top: whether what lies beyond is the mirror image of the body.
    mirrors: [bool; 4],
    /// Sums of the offsets of both ends of a pair, least and greatest by axis, at which no open wall makes an image of one end
    /// for the other.
    free: [(i64, i64); 2],
    /// Particles that freeze.
    freezing: Vec<u32>,
    /// What lies around the freezing particle at hand, row by row.
    window: Vec<Seen>,
    /// What fronts add to the rates of particles (W/m3).
    changes: Vec<(u32, f64)>,
    /// How that follows small changes.
    tangent: FrontTangent,
}

/// How what fronts add follows small changes of the state.
#[derive(Debug, Clone, Default)]
struct FrontTangent {
    /// Particles whose fronts are followed, and what their enthalpy changes by for each watt a metre that they are given (s/m2).
    freezing: Vec<(u32, f64)>,
    /// Rates by potentials: the particle that is changed, the one that changes it, and the factor (m^-2).
    by_potential: Vec<(u32, u32, f64)>,
    /// Rates by enthalpies of freezing particles: the particle that is changed, which of `freezing`, and the factor (1/s).
    by_enthalpy: Vec<(u32, u32, f64)>,
    /// Changes of potentials (W/m), without those of freezing particles, and what their enthalpies change by (J/m3).
    changes: Vec<f64>,
    kept: Vec<f64>,
}

/// A particle as a freezing one sees it.
#[derive(Debug, Clone, Copy)]
struct Seen {
    particle: u32,
    /// Its potential (W/m) less that of the front.
    above: f64,
    /// What fronts add to its rate (W/m3).
    change: f64,
}

/// A pair of the particle in the middle of the window.
#[derive(Debug, Clone, Copy)]
struct OwnPair {
    /// Place of the other in the window.
    other: u32,
    /// Place on the opposite side.
    opposite: u32,
    /// Spacings between both along the axis across which the front is taken to lie.
    cells: f64,
    /// Weight (m^-2).
    weight: f64,
}

/// A pair that passes over the middle of the window, from the frozen to the unfrozen side.
#[derive(Debug, Clone)]
struct PairOver {
    /// Place of the frozen end in the window.
    frozen: u32,
    /// Place of the unfrozen end.
    unfrozen: u32,
    /// Spacings between both along the axis across which the front is taken to lie.
    cells: f64,
    /// Spacings between the frozen end and the middle.
    before: f64,
    /// Weight (m^-2).
    weight: f64,
    /// Sums of the offsets of both ends from the middle, along rows and columns.
    sums: [i64; 2],
    /// Places on the way from the frozen end to the middle, as a range of [`SubCellFront::ways`]: a front there takes care of the pair.
    way: (u32, u32),
}

/// Distance (in spacings) from a place `spacings` before the centre of a cell to the front in it, behind the share of the
/// cell that is in the phase of that place.
#[inline(always)]
fn distance(spacings: f64, share: f64) -> f64 {
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

/// The place of the image, in a body of `count` cells with mirrors at its ends, of a place on the same axis.
fn reflected(mut place: i64, count: i64, (low, high): (bool, bool)) -> i64 {
    while low && place < 0 || high && place >= count {
        place = if place < 0 { -1 - place } else { 2 * count - 1 - place };
    }
    place
}

/// Sums of the offsets of both ends of a pair from a place, least and greatest, at which neither end reaches the image of
/// the other beyond an open end of the axis.
fn free(place: i64, count: i64, reach: i64, (low, high): (bool, bool)) -> (i64, i64) {
    let least = if low { i64::MIN } else { reach - 2 * place };
    (least, if high { i64::MAX } else { 2 * (count - 1 - place) - reach })
}

impl PairOver {
    /// Whether the front in the middle takes care of the pair. Not where a wall that heat passes makes an image of one end
    /// for the other: the image weighs against the pair itself, and would be left without it.
    #[inline]
    fn is_taken(&self, ways: &[u32], window: &[Seen], free: &[(i64, i64); 2]) -> bool {
        let freezes = |place: &u32| window[*place as usize].above == 0.0 && window[*place as usize].particle != NONE;
        let clear = self.sums.iter().zip(free).all(|(sum, (least, greatest))| least <= sum && sum <= greatest);
        clear && !ways[self.way.0 as usize..self.way.1 as usize].iter().any(freezes)
    }
}

impl SubCellFront {
    /// Fronts of materials on a lattice. Particles that `mixed` tells have neighbours of other materials, or pairs that are
    /// cut: they are taken as wholes.
    pub fn new(
        materials: &Materials,
        extent: Extent,
        lattice: &Lattice,
        stencil: &Stencil,
        mixed: impl Fn(usize) -> bool,
    ) -> Self {
        let (sharp, stretches) = stretches(materials, extent.temperatures, lattice.len(), mixed);
        let across = stencil.reach as i64;
        let reach = (across, if lattice.dimension == 1 { 0 } else { across });
        let place = |(x, y): (i64, i64)| ((y + reach.1) * (2 * across + 1) + x + across) as u32;
        let (mut own, mut over, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for dy in -reach.1..=reach.1 {
            for dx in -across..=across {
                let weight = stencil.at(dx.unsigned_abs() as usize, dy.unsigned_abs() as usize);
                let spacings = match extent.along_y {
                    None => dx.abs().max(dy.abs()),
                    Some(true) => dy.abs(),
                    Some(false) => dx.abs(),
                };
                if weight == 0.0 || spacings == 0 {
                    continue;
                }
                let cells = spacings as f64;
                own.push(OwnPair { other: place((dx, dy)), opposite: place((-dx, -dy)), cells, weight });
                // Where the way runs between cells, half of the pair takes either.
                let [lower, higher] = [false, true].map(|higher| way((dx, dy), spacings, higher));
                let ways = if lower == higher { vec![(lower, 1.0)] } else { vec![(lower, 0.5), (higher, 0.5)] };
                for (way, part) in &ways {
                    for (step, middle) in way.iter().enumerate() {
                        let from_middle = |(x, y): (i64, i64)| place((x - middle.0, y - middle.1));
                        over.push(PairOver {
                            frozen: from_middle((0, 0)),
                            unfrozen: from_middle((dx, dy)),
                            cells,
                            before: (step + 1) as f64,
                            weight: part * weight,
                            sums: [dx - 2 * middle.0, dy - 2 * middle.1],
                            way: (places.len() as u32, (places.len() + step) as u32),
                        });
                        places.extend(way[..step].iter().map(|cell| from_middle(*cell)));
                    }
                }
            }
        }
        let size = ((2 * across + 1) * (2 * reach.1 + 1)) as usize;
        SubCellFront {
            sharp,
            stretches,
            own,
            over,
            ways: places,
            reach,
            mirrors: extent.mirrors,
            free: [(i64::MIN, i64::MAX); 2],
            freezing: Vec::new(),
            window: vec![Seen { particle: NONE, above: 0.0, change: 0.0 }; size],
            changes: Vec::with_capacity(2 * size * (lattice.columns + lattice.rows)),
            tangent: FrontTangent::default(),
        }
    }

    /// Brings the fronts to a state of enthalpies (J/m3) with their potentials (W/m).
    pub fn update(&mut self, lattice: &Lattice, enthalpy: &[f64], potential: impl Fn(usize) -> f64) {
        self.changes.clear();
        self.each_front(lattice, enthalpy, potential, |front, _, fraction, _| front.exchange(fraction));
    }

    /// Linearises at a state of enthalpies (J/m3) with their potentials (W/m). Potentials of freezing particles do not follow
    /// their enthalpies: they are given the slope `steepest` (m2/s) in `slopes`, and stand for the change of the enthalpy.
    pub fn linearise(
        &mut self,
        lattice: &Lattice,
        enthalpy: &[f64],
        potential: impl Fn(usize) -> f64,
        steepest: impl Fn(usize) -> f64,
        slopes: &mut [f64],
    ) {
        let FrontTangent { freezing, by_potential, by_enthalpy, .. } = &mut self.tangent;
        freezing.clear();
        by_potential.clear();
        by_enthalpy.clear();
        self.each_front(lattice, enthalpy, potential, |front, particle, fraction, latent_heat| {
            slopes[particle] = steepest(particle);
            front.tangent.freezing.push((particle as u32, 1.0 / slopes[particle]));
            front.exchange_changes(fraction, -1.0 / latent_heat);
        });
    }

    /// Does something at every front, with its surroundings in the window: by its particle, the frozen fraction there, and the
    /// latent heat (J/m3).
    fn each_front(
        &mut self,
        lattice: &Lattice,
        enthalpy: &[f64],
        potential: impl Fn(usize) -> f64,
        mut one: impl FnMut(&mut Self, usize, f64, f64),
    ) {
        // Particles come in the order of their rows.
        let mut row = 0;
        let mut freezing = std::mem::take(&mut self.freezing);
        for stretch in 0..self.stretches.len() {
            let (first, end, sharp) = self.stretches[stretch];
            let Sharp { interval: (frozen, unfrozen), potential: at_front, .. } = self.sharp[sharp as usize];
            freezing.clear();
            find(&enthalpy[first as usize..end as usize], first, (frozen, unfrozen), &mut freezing);
            for particle in &freezing {
                let particle = *particle as usize;
                let fraction = (unfrozen - enthalpy[particle]) / (unfrozen - frozen);
                let above = |other: usize| potential(other) - at_front;
                while lattice.start(row + 1) <= particle {
                    row += 1;
                }
                let column = lattice.span(row).0 + particle - lattice.start(row);
                self.look_around(lattice, (column as i64, row as i64), above);
                one(self, particle, fraction, unfrozen - frozen);
            }
        }
        self.freezing = freezing;
    }

    /// Fills the window around a particle.
    fn look_around(&mut self, lattice: &Lattice, (column, row): (i64, i64), above: impl Fn(usize) -> f64) {
        let (across, along) = self.reach;
        let [left, right, bottom, top] = self.mirrors;
        let (columns, rows) = (lattice.columns as i64, lattice.rows as i64);
        self.free = [free(column, columns, across, (left, right)), free(row, rows, along, (bottom, top))];
        for (seen, dy) in self.window.chunks_exact_mut(2 * across as usize + 1).zip(-along..=along) {
            let row = reflected(row + dy, rows, (bottom, top));
            // Mostly all of a row is there, one particle after the other.
            if (0..rows).contains(&row) {
                let (first, end) = lattice.span(row as usize);
                if column - across >= first as i64 && column + across < end as i64 {
                    let first = lattice.start(row as usize) + (column - across) as usize - first;
                    for (seen, other) in seen.iter_mut().zip(first..) {
                        *seen = Seen { particle: other as u32, above: above(other), change: 0.0 };
                    }
                    continue;
                }
            }
            for (seen, dx) in seen.iter_mut().zip(-across..=across) {
                let column = reflected(column + dx, columns, (left, right));
                *seen = match lattice.index(column, row) {
                    Some(other) => Seen { particle: other as u32, above: above(other), change: 0.0 },
                    None => Seen { particle: NONE, above: 0.0, change: 0.0 },
                };
            }
        }
    }

    /// What the front in the middle of the window exchanges.
    fn exchange(&mut self, fraction: f64) {
        let window = &mut self.window;
        let middle = window.len() / 2;
        for OwnPair { other, opposite, cells, weight } in &self.own {
            let above = window[*other as usize].above;
            if above != 0.0 {
                let share = if above < 0.0 { fraction } else { 1.0 - fraction };
                let fronts = if above * window[*opposite as usize].above > 0.0 { 2.0 } else { 1.0 };
                let more = cells / distance(*cells, share / fronts) - 1.0;
                let change = weight * above * more;
                window[*other as usize].change -= change;
                window[middle].change += change;
            }
        }
        for pair in &self.over {
            let (frozen, unfrozen) = (pair.frozen as usize, pair.unfrozen as usize);
            let (below, above) = (window[frozen].above, window[unfrozen].above);
            if below < 0.0 && above > 0.0 && pair.is_taken(&self.ways, window, &self.free) {
                let carried = pair.weight * pair.cells;
                let cold = carried * below / distance(pair.before, fraction);
                let warm = carried * above / distance(pair.cells - pair.before, 1.0 - fraction);
                let direct = pair.weight * (above - below);
                window[frozen].change -= cold + direct;
                window[unfrozen].change += direct - warm;
                window[middle].change += cold + warm;
            }
        }
        let changed = window.iter().filter(|seen| seen.change != 0.0);
        self.changes.extend(changed.map(|seen| (seen.particle, seen.change)));
    }

    /// How what the front in the middle of the window exchanges follows the potentials around it, and the enthalpy of its own
    /// particle, with which the frozen fraction goes by `slope` (m3/J).
    fn exchange_changes(&mut self, fraction: f64, slope: f64) {
        let FrontTangent { freezing, by_potential, by_enthalpy, .. } = &mut self.tangent;
        let window = &self.window;
        let (middle, own) = (window.len() / 2, freezing.len() as u32 - 1);
        let name = |place: usize| window[place].particle;
        for OwnPair { other, opposite, cells, weight } in &self.own {
            let (other, above) = (*other as usize, window[*other as usize].above);
            if above != 0.0 {
                let (share, grows) = if above < 0.0 { (fraction, 1.0) } else { (1.0 - fraction, -1.0) };
                let fronts = if above * window[*opposite as usize].above > 0.0 { 2.0 } else { 1.0 };
                let far = distance(*cells, share / fronts);
                let by_above = weight * (cells / far - 1.0);
                let by_fraction = -weight * above * cells / (far * far) * grows / fronts * slope;
                by_potential.extend([(name(other), name(other), -by_above), (name(middle), name(other), by_above)]);
                by_enthalpy.extend([(name(other), own, -by_fraction), (name(middle), own, by_fraction)]);
            }
        }
        for pair in &self.over {
            let (frozen, unfrozen) = (pair.frozen as usize, pair.unfrozen as usize);
            let (below, above) = (window[frozen].above, window[unfrozen].above);
            if below < 0.0 && above > 0.0 && pair.is_taken(&self.ways, window, &self.free) {
                let carried = pair.weight * pair.cells;
                let near = distance(pair.before, fraction);
                let far = distance(pair.cells - pair.before, 1.0 - fraction);
                let (cold, warm, direct) = (carried / near, carried / far, pair.weight);
                let rows = [name(frozen), name(unfrozen), name(middle)];
                for (row, (by_below, by_above)) in
                    rows.into_iter().zip([(direct - cold, -direct), (-direct, direct - warm), (cold, warm)])
                {
                    by_potential.extend([(row, rows[0], by_below), (row, rows[1], by_above)]);
                }
                let (cold, warm) = (-cold * below / near * slope, warm * above / far * slope);
                by_enthalpy.extend([(rows[0], own, -cold), (rows[1], own, -warm), (rows[2], own, cold + warm)]);
            }
        }
    }

    /// Takes small changes of potentials (W/m) apart, and gives them without those of freezing particles.
    pub fn hold_back(&mut self, potentials: &[f64]) -> &[f64] {
        let FrontTangent { freezing, changes, kept, .. } = &mut self.tangent;
        changes.clear();
        changes.extend_from_slice(potentials);
        kept.clear();
        let enthalpy = |(particle, by): &(u32, f64)| by * std::mem::take(&mut changes[*particle as usize]);
        kept.extend(freezing.iter().map(enthalpy));
        changes
    }

    /// Adds to `rates` (W/m3) how fronts follow the changes that were taken apart last.
    pub fn act(&self, rates: &mut [f64]) {
        let FrontTangent { by_potential, by_enthalpy, changes, kept, .. } = &self.tangent;
        for (row, column, factor) in by_potential {
            rates[*row as usize] += factor * changes[*column as usize];
        }
        for (row, number, factor) in by_enthalpy {
            rates[*row as usize] += factor * kept[*number as usize];
        }
    }

    /// Adds what the fronts exchange to `rates`, scaled.
    #[inline]
    pub fn add(&self, rates: &mut [f64], scale: f64) {
        for (particle, change) in &self.changes {
            rates[*particle as usize] += scale * change;
        }
    }

    /// The same to contents, with what rounding takes from them kept in `lost`.
    #[inline]
    pub fn add_keeping(&self, contents: &mut [f64], lost: &mut [f64], scale: f64) {
        for (particle, change) in &self.changes {
            add_one(&mut contents[*particle as usize], scale * change, &mut lost[*particle as usize]);
        }
    }

    /// What fronts may add to the row sum (m^-2) of a particle: where they have just come nearest on all sides.
    pub fn row_sum(&self) -> f64 {
        self.own.iter().map(|pair| pair.weight * (pair.cells / distance(1.0, 0.0) - 1.0)).sum()
    }

    /// Rate (1/s) at which a freezing particle answers to its own frozen fraction, at most: all that surrounds it is as
    /// far from the freezing point as can be.
    pub fn own_rate(&self) -> f64 {
        let nearest = |pair: &OwnPair| -> f64 {
            (1..=pair.cells as usize).map(|before| distance(before as f64, 0.0).powi(-2)).sum()
        };
        let by_pairs: f64 = self.own.iter().map(|pair| pair.weight * pair.cells * nearest(pair)).sum();
        let answer = |sharp: &Sharp| sharp.most / (sharp.interval.1 - sharp.interval.0);
        by_pairs * self.sharp.iter().map(answer).fold(0.0, f64::max)
    }
}

/// Temperature at the centre of a freezing particle, less that of freezing: on the line from the front in its cell to the
/// neighbours in the phase in which the centre is. `temperature` tells that of a particle, less that of freezing.
pub fn at_the_centre(lattice: &Lattice, index: usize, fraction: f64, temperature: impl Fn(usize) -> f64) -> f64 {
    let (column, row) = lattice.cell(index);
    let frozen_side = fraction > 0.5;
    let depth = (fraction - 0.5).abs();
    let (mut sum, mut count) = (0.0, 0.0);
    for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().take(2 * lattice.dimension) {
        if let Some(other) = lattice.index(column + dx, row + dy) {
            let above = temperature(other);
            if above != 0.0 && (above < 0.0) == frozen_side {
                sum += above * depth / (depth + 1.0);
                count += 1.0;
            }
        }
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

impl HeapSize for SubCellFront {
    fn heap_size(&self) -> usize {
        let tables = self.ways.heap_size()
            + self.own.capacity() * size_of::<OwnPair>()
            + self.over.capacity() * size_of::<PairOver>();
        let states = self.window.capacity() * size_of::<Seen>()
            + self.changes.capacity() * size_of::<(u32, f64)>()
            + self.freezing.heap_size();
        let FrontTangent { freezing, by_potential, by_enthalpy, changes, kept } = &self.tangent;
        let factors = freezing.heap_size() + by_potential.heap_size() + by_enthalpy.heap_size();
        let tangent = factors + changes.heap_size() + kept.heap_size();
        tables + states + tangent
    }
}
