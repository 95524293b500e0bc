//! The particle store: columns, and only those that the plan asks for.

use std::sync::Arc;

use glam::DVec2;

use crate::memory::{HeapSize, shared};
use crate::physics::latent_heat::Materials;
use crate::physics::sub_cell::{at_the_centre, cells_with_fronts, front_fraction};
use crate::saved::{Pass, Saved};
use crate::side_by_side::{sum_and_size, sum_of, sum_where};
use crate::space::lattice::Lattice;
use crate::space::volumes::Volumes;

/// Where particles stand.
#[derive(Debug, Clone)]
pub enum Places {
    /// On a lattice: no position is stored.
    Lattice,
    /// At stored positions (m).
    Cloud(Arc<[DVec2]>),
}

/// Particles.
#[derive(Debug, Clone)]
pub struct Particles {
    /// Enthalpy by volume (J/m3), relative to each particle's initial state.
    pub enthalpy: Vec<f64>,
    /// What they hold of a solute by volume (relative to its concentration of reference), and its concentration in their water as it
    /// was published last; empty where none is carried.
    pub solute: Vec<f64>,
    /// See [`Particles::solute`].
    pub concentration: Vec<f64>,
    /// How much better the ground of each conducts than its material; empty where all conducts as its material.
    pub factors: Arc<[f64]>,
    /// What it was at the start; empty if all particles started from their initial state.
    pub start: Arc<[f64]>,
    /// Where they stand.
    pub places: Places,
    /// Their velocities (m/s), and that they have any; empty where all are at rest.
    pub velocity: Vec<DVec2>,
    /// The lattice that they fill, or were placed from.
    pub lattice: Arc<Lattice>,
    /// Volumes.
    pub volumes: Volumes,
    /// Whether the front in a freezing particle is where its frozen fraction says.
    pub sub_cell: bool,
    /// Radius (m) of the shaft around the centre, once it is dug. Its ground stays apart, for the balance of heat.
    pub shaft: Option<f64>,
    /// Materials.
    pub materials: Materials,
}

impl Particles {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.enthalpy.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.enthalpy.is_empty()
    }

    /// Position of a particle (m).
    pub fn position(&self, index: usize) -> DVec2 {
        match &self.places {
            Places::Lattice => self.lattice.position(index),
            Places::Cloud(positions) => positions[index],
        }
    }

    /// Stored positions (m), where there are any.
    pub fn cloud(&self) -> Option<&[DVec2]> {
        match &self.places {
            Places::Lattice => None,
            Places::Cloud(positions) => Some(positions),
        }
    }

    /// Visits all particles in order with their positions (m).
    pub fn visit(&self, mut visitor: impl FnMut(usize, DVec2)) {
        match &self.places {
            Places::Cloud(positions) => positions.iter().enumerate().for_each(|(i, place)| visitor(i, *place)),
            Places::Lattice => {
                for row in 0..self.lattice.rows {
                    let (first, end) = self.lattice.span(row);
                    let start = self.lattice.start(row);
                    for column in first..end {
                        visitor(start + column - first, self.lattice.centre(column as i64, row as i64));
                    }
                }
            }
        }
    }

    /// Integral over the body of a value of each particle.
    #[inline]
    pub fn integral(&self, value: impl Fn(usize) -> f64) -> f64 {
        sum_of(self.len(), |i| value(i) * self.volumes.share(i)) * self.volumes.unit()
    }

    /// The same of a value that is zero where a column is.
    #[inline]
    pub fn integral_where(&self, column: &[f64], value: impl Fn(usize) -> f64) -> f64 {
        sum_where(column, |i| value(i) * self.volumes.share(i)) * self.volumes.unit()
    }

    /// Integrals over the body of a column less another, of which there may be none, and of the magnitudes of what it integrates.
    pub fn integrals(&self, column: &[f64], less: &[f64]) -> [f64; 2] {
        if self.volumes.is_even() {
            return sum_and_size(column, less).map(|sum| sum * self.volumes.unit());
        }
        let value = |i: usize| column[i] - less.get(i).copied().unwrap_or(0.0);
        [self.integral(value), self.integral(|i| value(i).abs())]
    }

    /// How much better the ground of some particles conducts than their material: the geometric mean, as places conduct in series and
    /// side by side.
    pub fn mean_factor(&self, particles: &[u32]) -> f64 {
        if self.factors.is_empty() {
            return 1.0;
        }
        let sum: f64 = particles.iter().map(|index| self.factors[*index as usize].ln()).sum();
        (sum / particles.len() as f64).exp()
    }

    /// Temperature of a particle.
    #[inline]
    pub fn temperature(&self, index: usize) -> f64 {
        self.materials.of(index).temperature(self.enthalpy[index])
    }

    /// What is read off at the place of a particle: of water its effective saturation, of heat its temperature, or, where the
    /// front in its cell is known, that beside the front.
    pub fn reading(&self, index: usize) -> f64 {
        self.reading_by(index, || self.front_fraction(index))
    }

    /// The same by what [`Particles::front_fraction`] tells of the particle, which is asked for where there may be a front.
    #[inline]
    pub fn reading_by(&self, index: usize, front_fraction: impl FnOnce() -> f64) -> f64 {
        if self.materials.of(index).curve.moisture().is_some() {
            return 1.0 - self.frozen_fraction(index);
        }
        if !self.sub_cell || !self.materials.of(index).curve.is_sharp() {
            return self.temperature(index);
        }
        // A particle that has just given off its latent heat is at the freezing point, though most of its cell is colder.
        let fraction = front_fraction();
        let has_front =
            [fraction, self.frozen_fraction(index)].iter().any(|fraction| *fraction > 0.0 && *fraction < 1.0);
        if !has_front {
            return self.temperature(index);
        }
        let freezing = self.materials.of(index).curve.freezing_point();
        freezing + at_the_centre(&self.lattice, index, fraction, |other| self.temperature(other) - freezing)
    }

    /// Temperature of what is frozen of a particle: where the front passes through it, its place may lie in what is not.
    #[inline]
    pub fn frozen_reading(&self, index: usize, front_fraction: impl FnOnce() -> f64) -> f64 {
        self.reading_by(index, front_fraction).min(self.materials.of(index).curve.freezing_point())
    }

    /// Whether ground at a distance (m) from the centre was dug out.
    #[inline]
    pub fn is_dug(&self, distance: f64) -> bool {
        self.shaft.is_some_and(|radius| distance < radius)
    }

    /// Whether a particle's ground was dug out.
    #[inline]
    pub fn is_gone(&self, index: usize) -> bool {
        self.shaft.is_some() && self.is_dug(self.position(index).length())
    }

    /// Frozen fraction of a particle; none of what was dug out.
    #[inline]
    pub fn frozen_fraction(&self, index: usize) -> f64 {
        if self.is_gone(index) {
            return 0.0;
        }
        self.materials.of(index).frozen_fraction(self.enthalpy[index])
    }

    /// Frozen fraction of a particle as fronts inside particles tell it, where they are followed: see
    /// [`crate::physics::sub_cell::front_fraction`].
    #[inline]
    pub fn front_fraction(&self, index: usize) -> f64 {
        if !self.sub_cell || self.is_gone(index) {
            return self.frozen_fraction(index);
        }
        self.front_fraction_of(index, self.lattice.cell(index))
    }

    /// The same where fronts are followed, of a particle in a cell, of which nothing is dug out.
    fn front_fraction_of(&self, index: usize, cell: (i64, i64)) -> f64 {
        let by_heat = |other: usize| self.materials.of(other).frozen_fraction(self.enthalpy[other]);
        if !self.materials.of(index).curve.is_sharp() {
            return by_heat(index);
        }
        let material = self.materials.index(index);
        // Of another material, what a particle lacks tells its phase alone, and nothing of the slope.
        let lacked = |other: usize| match self.materials.index(other) == material {
            true => self.materials.of(other).latent_heat_lacked(self.enthalpy[other]),
            false => by_heat(other),
        };
        front_fraction(&self.lattice, cell, lacked)
    }

    /// The same of all particles, in place of what was in `fractions`.
    pub fn front_fractions(&self, fractions: &mut Vec<f64>) {
        fractions.clear();
        fractions.reserve_exact(self.len());
        match self.materials.single() {
            Some(material) => material.frozen_fractions(&self.enthalpy, fractions),
            None => {
                let by_heat = |(i, enthalpy): (usize, &f64)| self.materials.of(i).frozen_fraction(*enthalpy);
                fractions.extend(self.enthalpy.iter().enumerate().map(by_heat));
            }
        }
        let fronts = if self.sub_cell { cells_with_fronts(&self.lattice, fractions) } else { Vec::new() };
        for (index, cell) in fronts {
            fractions[index] = self.front_fraction_of(index, cell);
        }
        if self.shaft.is_some() {
            self.visit(|i, place| fractions[i] = if self.is_dug(place.length()) { 0.0 } else { fractions[i] });
        }
    }

    /// Whether they move.
    pub fn move_about(&self) -> bool {
        !self.velocity.is_empty()
    }

    /// Hash of the state to the last bit, as 16 hexadecimal digits: enthalpies, and places and velocities where they change.
    pub fn state_hash(&self) -> String {
        let mut hasher = xxhash_rust::xxh3::Xxh3::new();
        for enthalpy in &self.enthalpy {
            hasher.update(&enthalpy.to_bits().to_le_bytes());
        }
        for content in &self.solute {
            hasher.update(&content.to_bits().to_le_bytes());
        }
        for (i, velocity) in self.velocity.iter().enumerate() {
            let place = self.position(i);
            for number in [place.x, place.y, velocity.x, velocity.y] {
                hasher.update(&number.to_bits().to_le_bytes());
            }
        }
        format!("{:016x}", hasher.digest())
    }
}

impl Saved for Particles {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        let Particles { enthalpy, solute, concentration, velocity, shaft, .. } = self;
        pass.all(&mut [enthalpy, solute, concentration, velocity, shaft]);
        // Those at rest stand where their plan has placed them.
        if self.move_about()
            && let Places::Cloud(places) = &mut self.places
        {
            Arc::make_mut(places).iter_mut().for_each(|place| place.pass(pass));
        }
    }
}

impl HeapSize for Particles {
    fn heap_size(&self) -> usize {
        // Positions of a cloud are counted where pairs are: the operator holds them even on a lattice.
        let thermals = size_of_val(&*self.materials.thermals)
            + size_of_val(&*self.materials.blends)
            + self.materials.laws().map(|thermal| thermal.curve.heap_size() + thermal.law.heap_size()).sum::<usize>();
        self.enthalpy.heap_size()
            + self.velocity.heap_size()
            + self.solute.heap_size()
            + self.concentration.heap_size()
            + shared(&self.start)
            + shared(&self.factors)
            + self.lattice.heap_size()
            + self.materials.of_particle.heap_size()
            + self.materials.law_of.heap_size()
            + thermals
    }
}
