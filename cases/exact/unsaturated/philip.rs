//! Absorption of water by a horizontal half space (Philip 1957).
//!
//! With `lambda = x / sqrt(t)` the balance of water, `theta_t = Phi_xx` with Kirchhoff's potential `Phi`, leaves
//! `dF/dSe = (theta_s - theta_r) lambda / 2` for the flux `F / sqrt(t)`, and `d lambda / d Phi = -1 / F`. Both are integrated
//! over saturation, `lambda` from the wall and `F` from the untouched soil on, until they agree. All terms are positive,
//! so nothing cancels, also where the soil is dry at first and the front is sharp.

use super::graded::{Coordinate, NODES, Nodal, Panel, Rule, panels};
use super::soil::Soil;
use super::{Unsolvable, require};
use crate::exact::functions::{erfc_ratio, erfcx};

/// Estimated relative error of infiltrated water and positions. With 17 nodes a panel in place of 21 water moves by 2e-12 and
/// positions by 1e-9, and the identity that the squares of `lambda` obey holds to 5e-11, for n from 1.1 to 3.
pub const ERROR: f64 = 1e-9;

/// Relative change of the flux from one round to the next below which the iteration has settled.
const SETTLED: f64 = 1e-12;

/// Rounds before it is given up; 33 to 43 are needed in the tests.
const MOST_ROUNDS: usize = 300;

/// The solution on a panel.
#[derive(Debug, Clone)]
struct Stretch {
    panel: Panel,
    /// Growths of saturation and potential with the place, by node.
    saturation: Nodal,
    potential: Nodal,
    /// Place over the root of time (m/s^1/2), by node.
    position: Nodal,
    /// Flux times the root of time (m/s^1/2), by node.
    flux: Nodal,
}

/// Water that a half space of soil takes up through its wall, without gravity.
#[derive(Debug, Clone)]
pub struct Absorption {
    soil: Soil,
    rule: Rule,
    /// Effective saturation at first, and at the wall.
    initial: f64,
    wall: f64,
    /// Length over the root of time (m/s^1/2) that is saturated by a head at the wall above that of air entry.
    saturated: f64,
    /// From dry to wet.
    stretches: Vec<Stretch>,
}

impl Absorption {
    /// The solution from an initial effective saturation, which may be zero, under one at the wall, which may be one.
    ///
    /// # Errors
    ///
    /// If the saturations are not in this order between zero and one, or the iteration does not settle.
    pub fn new(soil: Soil, initial: f64, wall: f64) -> Result<Self, Unsolvable> {
        Absorption::solve(soil, initial, wall, 0.0)
    }

    /// The solution under a pressure head (m) at the wall. Where it is above that of air entry, saturated soil grows from the wall.
    ///
    /// # Errors
    ///
    /// As above.
    pub fn under_head(soil: Soil, initial: f64, head: f64) -> Result<Self, Unsolvable> {
        let excess = (head - soil.air_entry()).max(0.0);
        Absorption::solve(soil, initial, soil.saturation(head), soil.saturated_conductivity() * excess)
    }

    /// The solution where potential (m2/s) beyond the wall's saturation drives water through saturated soil.
    fn solve(soil: Soil, initial: f64, wall: f64, beyond: f64) -> Result<Self, Unsolvable> {
        require((0.0..1.0).contains(&initial), "the initial saturation", initial, "at least 0 and below 1")?;
        require(
            wall > initial && wall <= 1.0,
            "the saturation at the wall",
            wall,
            "above the initial one and at most 1",
        )?;
        let rule = Rule::new();
        let stretch = |panel: Panel| {
            let growth = panel.growth(&soil, &rule);
            // Any positive flux will do as a beginning; this one falls evenly with the saturation.
            let share = |place: f64| (panel.saturation(&soil, place) - initial).max(0.0) / (wall - initial);
            Stretch {
                panel,
                saturation: growth.map(|growth| growth.saturation),
                potential: growth.map(|growth| growth.potential),
                position: [0.0; NODES],
                flux: rule.nodes().map(|place| share(place).max(f64::EPSILON)),
            }
        };
        let stretches = panels(&soil, initial, wall).into_iter().map(stretch).collect();
        let mut solution = Absorption { soil, rule, initial, wall, saturated: 0.0, stretches };
        let mut change = f64::INFINITY;
        for _ in 0..MOST_ROUNDS {
            solution.place(beyond);
            change = solution.improve_flux();
            if change < SETTLED {
                solution.place(beyond);
                return Ok(solution);
            }
        }
        Err(Unsolvable::NotSettled { change, limit: SETTLED })
    }

    /// Flux at the wall, times the root of time.
    fn wall_flux(&self) -> f64 {
        self.stretches.last().map_or(0.0, |stretch| stretch.flux[NODES - 1])
    }

    /// Places all saturations by the flux.
    fn place(&mut self, beyond: f64) {
        self.saturated = beyond / self.wall_flux();
        let mut reached = self.saturated;
        for stretch in self.stretches.iter_mut().rev() {
            let steps = std::array::from_fn(|node| stretch.potential[node] / stretch.flux[node]);
            let passed = self.rule.integrals(&steps);
            let whole = passed[NODES - 1];
            stretch.position = passed.map(|passed| reached + (whole - passed));
            reached += whole;
        }
    }

    /// Takes the mean of the flux and what follows from the places, and tells by how much it changes. A flux that is too great by
    /// a factor makes the next one too small by it, so the mean is geometric.
    fn improve_flux(&mut self) -> f64 {
        let half_range = 0.5 * self.soil.range();
        let mut reached = self.first_flux();
        let mut change = 0.0_f64;
        for stretch in &mut self.stretches {
            let steps = std::array::from_fn(|node| half_range * stretch.position[node] * stretch.saturation[node]);
            for (flux, passed) in stretch.flux.iter_mut().zip(self.rule.integrals(&steps)) {
                let ratio = ((reached + passed) / *flux).sqrt();
                change = change.max((ratio - 1.0).abs());
                *flux *= ratio;
            }
            reached += self.rule.total(&steps);
        }
        change
    }

    /// Flux, times the root of time, where the first panel begins: beyond it water diffuses as if linearly.
    fn first_flux(&self) -> f64 {
        let Some(first) = self.stretches.first() else { return 0.0 };
        let depth = first.position[0] / self.tail_width();
        let sharp = depth * erfcx(depth) * std::f64::consts::PI.sqrt();
        let sharp_front = 0.5 * self.soil.range() * first.panel.start * first.position[0];
        // A tail of no width is a sharp front.
        if sharp.is_finite() && sharp > 0.0 { sharp_front / sharp } else { sharp_front }
    }

    /// Width over the root of time (m/s^1/2) of the error function before the first panel.
    fn tail_width(&self) -> f64 {
        let start = self.stretches.first().map_or(0.0, |first| first.panel.start);
        2.0 * (self.soil.along_saturation(self.initial + start).potential / self.soil.range()).sqrt()
    }

    /// Sorptivity (m/s^1/2): infiltrated water over the root of time.
    pub fn sorptivity(&self) -> f64 {
        2.0 * self.wall_flux()
    }

    /// Water (m) that has entered by a time (s).
    pub fn infiltrated(&self, t: f64) -> f64 {
        self.sorptivity() * t.max(0.0).sqrt()
    }

    /// Length (m) of the saturated soil that a head above air entry keeps at the wall at a time (s).
    pub fn saturated_length(&self, t: f64) -> f64 {
        self.saturated * t.max(0.0).sqrt()
    }

    /// Distance (m) from the wall beyond which the soil is untouched at a time (s). None where it was not dry at first: water is
    /// felt at any distance then.
    pub fn foot(&self, t: f64) -> Option<f64> {
        let first = self.stretches.first().filter(|_| self.initial == 0.0)?;
        Some(first.position[0] * t.max(0.0).sqrt())
    }

    /// Distance (m) from the wall at which the effective saturation has a value at a time (s). None where it has it nowhere
    /// but at the wall, or everywhere. Nearer to the initial saturation than a trillionth of the range it does not change.
    pub fn position(&self, saturation: f64, t: f64) -> Option<f64> {
        if saturation <= self.initial || saturation > self.wall {
            return None;
        }
        let excess = saturation - self.initial;
        let dryness = self.soil.dryness(saturation);
        let at = |panel: &Panel| match panel.coordinate {
            Coordinate::Excess(_) => excess,
            Coordinate::Dryness => dryness,
        };
        let is_before = |stretch: &Stretch| match stretch.panel.coordinate {
            Coordinate::Excess(_) => stretch.panel.end < excess,
            Coordinate::Dryness => stretch.panel.end > dryness,
        };
        let index = self.stretches.partition_point(is_before).min(self.stretches.len() - 1);
        let stretch = &self.stretches[index];
        let place = stretch.panel.place_of(at(&stretch.panel));
        Some(self.rule.value(&stretch.position, place) * t.max(0.0).sqrt())
    }

    /// Effective saturation at a distance (m) from the wall at a time (s).
    pub fn saturation(&self, x: f64, t: f64) -> f64 {
        if t <= 0.0 && x > 0.0 {
            return self.initial;
        }
        let reached = if x > 0.0 { x / t.sqrt() } else { 0.0 };
        if reached <= self.saturated {
            return self.wall;
        }
        match self.place_at(reached) {
            Some((stretch, place)) => stretch.panel.saturation(&self.soil, place),
            None => self.initial + self.tail(reached),
        }
    }

    /// Flux (m/s) at a distance (m) from the wall at a time (s) after the start.
    pub fn flux(&self, x: f64, t: f64) -> f64 {
        let reached = x.max(0.0) / t.sqrt();
        let scaled = if reached <= self.saturated {
            self.wall_flux()
        } else if let Some((stretch, place)) = self.place_at(reached) {
            self.rule.value(&stretch.flux, place)
        } else {
            0.0
        };
        scaled / t.sqrt()
    }

    /// What is left above the initial saturation beyond the first panel, where water diffuses as if linearly.
    fn tail(&self, reached: f64) -> f64 {
        let (width, Some(first)) = (self.tail_width(), self.stretches.first()) else { return 0.0 };
        // Of a tail of no width nothing is left, nor a number.
        first.panel.start * erfc_ratio(reached / width, first.position[0] / width).max(0.0)
    }

    /// The panel, and the place in it, where the distance over the root of time has a value. None farther out than all.
    fn place_at(&self, reached: f64) -> Option<(&Stretch, f64)> {
        if reached > self.stretches.first()?.position[0] {
            return None;
        }
        let index = self.stretches.partition_point(|stretch| stretch.position[NODES - 1] > reached);
        let stretch = &self.stretches[index.min(self.stretches.len() - 1)];
        let (mut dry, mut wet) = (-1.0, 1.0);
        let (mut above, mut below) = (stretch.position[0] - reached, stretch.position[NODES - 1] - reached);
        // False position, which halves what the end that stays is taken for.
        while wet - dry > f64::EPSILON && above > 0.0 && below < 0.0 {
            let middle = (dry + (wet - dry) * above / (above - below)).clamp(dry, wet);
            let found = self.rule.value(&stretch.position, middle) - reached;
            if middle == dry || middle == wet || found == 0.0 {
                return Some((stretch, middle));
            }
            if found > 0.0 {
                (dry, above, below) = (middle, found, 0.5 * below);
            } else {
                (wet, above, below) = (middle, 0.5 * above, found);
            }
        }
        Some((stretch, if above <= 0.0 { dry } else { wet }))
    }
}

#[cfg(test)]
mod tests;
