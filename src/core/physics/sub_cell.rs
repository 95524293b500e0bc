//! Sharp fronts inside particles.
//!
//! A particle that is freezing has no temperature of its own to conduct with: the front lies somewhere in its cell, and
//! its frozen fraction `f` tells where. Left alone, its neighbours exchange heat with the centre of the cell, wherever the
//! front is, and fluxes go up and down as the front crosses one cell after another. Here they exchange with the front. The
//! front is taken to lie across the longer axis of a pair: a pair over `k` spacings along it whose one end lies `s`
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
use crate::physics::thermal::Thermal;
use crate::space::lattice::Lattice;

/// Particles that are looked at together: mostly none of them freezes.
const LOOK: usize = 16;

/// No particle.
const NONE: u32 = u32::MAX;

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
    /// Offsets that pairs reach along rows and columns.
    reach: (i64, i64),
    /// What lies around the freezing particle at hand, row by row.
    window: Vec<Seen>,
    /// What fronts add to the rates of particles (W/m3).
    changes: Vec<(u32, f64)>,
}

/// A material that freezes at one temperature.
#[derive(Debug, Clone, Copy)]
struct Sharp {
    /// Enthalpies (J/m3) of a particle at the freezing point, frozen and unfrozen.
    interval: (f64, f64),
    /// Potential (W/m) at the freezing point.
    potential: f64,
    /// Largest distance of a potential from it.
    most: f64,
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
    /// Spacings between both along the longer axis.
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
    /// Spacings between both along the longer axis.
    cells: f64,
    /// Spacings between the frozen end and the middle.
    before: f64,
    /// Weight (m^-2).
    weight: f64,
    /// Places on the way from the frozen end to the middle: a front there takes care of the pair.
    way: Vec<u32>,
}

/// Distance (in spacings) from a place `spacings` before the centre of a cell to the front in it, behind the share of the
/// cell that is in the phase of that place.
#[inline(always)]
fn distance(spacings: f64, share: f64) -> f64 {
    spacings - 0.5 + share
}

/// Cells on the way over an offset, one for each spacing along its longer axis, ends left out. Where the way runs between
/// two cells, it takes the lower or the higher of them.
fn way((dx, dy): (i64, i64), higher: bool) -> Vec<(i64, i64)> {
    let cells = dx.abs().max(dy.abs());
    let round = |along: i64| {
        let (whole, rest) = (along.div_euclid(cells), 2 * along.rem_euclid(cells));
        whole + i64::from(rest > cells || rest == cells && higher)
    };
    (1..cells).map(|step| (round(step * dx), round(step * dy))).collect()
}

impl SubCellFront {
    /// Fronts of materials between two temperatures of a scene, on a lattice. Particles that `mixed` tells have neighbours
    /// of other materials, or pairs that are cut: they are taken as wholes.
    pub fn new(
        materials: &Materials,
        temperatures: (f64, f64),
        lattice: &Lattice,
        stencil: &Stencil,
        mixed: impl Fn(usize) -> bool,
    ) -> Self {
        let (sharp, stretches) = stretches(materials, temperatures, lattice.len(), mixed);
        let across = stencil.reach as i64;
        let reach = (across, if lattice.dimension == 1 { 0 } else { across });
        let place = |(x, y): (i64, i64)| ((y + reach.1) * (2 * across + 1) + x + across) as u32;
        let (mut own, mut over) = (Vec::new(), Vec::new());
        for dy in -reach.1..=reach.1 {
            for dx in -across..=across {
                let weight = stencil.at(dx.unsigned_abs() as usize, dy.unsigned_abs() as usize);
                if weight == 0.0 || (dx, dy) == (0, 0) {
                    continue;
                }
                let cells = dx.abs().max(dy.abs()) as f64;
                own.push(OwnPair { other: place((dx, dy)), opposite: place((-dx, -dy)), cells, weight });
                let ways = [way((dx, dy), false), way((dx, dy), true)];
                for way in &ways {
                    for (step, middle) in way.iter().enumerate() {
                        let from_middle = |(x, y): (i64, i64)| place((x - middle.0, y - middle.1));
                        over.push(PairOver {
                            frozen: from_middle((0, 0)),
                            unfrozen: from_middle((dx, dy)),
                            cells,
                            before: (step + 1) as f64,
                            weight: 0.5 * weight,
                            way: way[..step].iter().map(|cell| from_middle(*cell)).collect(),
                        });
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
            reach,
            window: vec![Seen { particle: NONE, above: 0.0, change: 0.0 }; size],
            changes: Vec::with_capacity(2 * size * (lattice.columns + lattice.rows)),
        }
    }

    /// Brings the fronts to a state of enthalpies (J/m3) with their potentials (W/m).
    pub fn update(&mut self, lattice: &Lattice, enthalpy: &[f64], potential: impl Fn(usize) -> f64) {
        self.changes.clear();
        for stretch in 0..self.stretches.len() {
            let (first, end, sharp) = self.stretches[stretch];
            let Sharp { interval: (frozen, unfrozen), potential: at_front, .. } = self.sharp[sharp as usize];
            for (number, look) in enthalpy[first as usize..end as usize].chunks(LOOK).enumerate() {
                if !look.iter().fold(false, |any, h| any | ((*h > frozen) & (*h < unfrozen))) {
                    continue;
                }
                for (i, own) in look.iter().enumerate() {
                    if *own > frozen && *own < unfrozen {
                        let fraction = (unfrozen - own) / (unfrozen - frozen);
                        let above = |other: usize| potential(other) - at_front;
                        self.look_around(lattice, first as usize + number * LOOK + i, above);
                        self.exchange(fraction);
                    }
                }
            }
        }
    }

    /// Fills the window around a particle.
    fn look_around(&mut self, lattice: &Lattice, index: usize, above: impl Fn(usize) -> f64) {
        let (column, row) = lattice.cell(index);
        let (across, along) = self.reach;
        for (seen, dy) in self.window.chunks_exact_mut(2 * across as usize + 1).zip(-along..=along) {
            for (seen, dx) in seen.iter_mut().zip(-across..=across) {
                *seen = match lattice.index(column + dx, row + dy) {
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
            let freezes =
                |place: &u32| window[*place as usize].above == 0.0 && window[*place as usize].particle != NONE;
            if below < 0.0 && above > 0.0 && !pair.way.iter().any(freezes) {
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

    /// Adds what the fronts exchange to `rates`, scaled.
    #[inline]
    pub fn add(&self, rates: &mut [f64], scale: f64) {
        for (particle, change) in &self.changes {
            rates[*particle as usize] += scale * change;
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

/// The materials that freeze at one temperature, and the stretches of particles whose fronts are followed.
fn stretches(
    materials: &Materials,
    temperatures: (f64, f64),
    count: usize,
    mixed: impl Fn(usize) -> bool,
) -> (Vec<Sharp>, Vec<(u32, u32, u32)>) {
    let (mut sharp, mut stretches) = (Vec::new(), Vec::<(u32, u32, u32)>::new());
    let of_material: Vec<Option<u32>> = materials
        .thermals
        .iter()
        .map(|thermal| {
            if !thermal.curve.is_sharp() {
                return None;
            }
            let interval = interval(thermal);
            // As the law itself has it, to the last bit.
            let potential = thermal.law.potential(0.5 * (interval.0 + interval.1));
            let far = |temperature: f64| (thermal.potential_at(temperature) - potential).abs();
            sharp.push(Sharp { interval, potential, most: far(temperatures.0).max(far(temperatures.1)) });
            Some(sharp.len() as u32 - 1)
        })
        .collect();
    for particle in 0..count {
        let own = of_material.get(materials.law(particle)).copied().flatten().filter(|_| !mixed(particle));
        match (own, stretches.last_mut()) {
            (None, _) => {}
            (Some(own), Some(last)) if last.2 == own && last.1 as usize == particle => last.1 += 1,
            (Some(own), _) => stretches.push((particle as u32, particle as u32 + 1, own)),
        }
    }
    (sharp, stretches)
}

/// Enthalpies (J/m3) that a particle carries at the freezing point, frozen and unfrozen.
fn interval(thermal: &Thermal) -> (f64, f64) {
    let unfrozen = thermal.enthalpy(thermal.curve.freezing_point());
    (unfrozen - thermal.curve.latent_heat(), unfrozen)
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
        let ways: usize = self.over.iter().map(|pair| pair.way.heap_size()).sum();
        let tables = self.own.capacity() * size_of::<OwnPair>() + self.over.capacity() * size_of::<PairOver>();
        let states = self.window.capacity() * size_of::<Seen>() + self.changes.capacity() * size_of::<(u32, f64)>();
        ways + tables + states
    }
}
