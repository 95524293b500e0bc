//! The particle store: columns, and only those that the plan asks for.

use std::sync::Arc;

use glam::DVec2;

use crate::lattice::Lattice;
use crate::uptake::Materials;

/// Where particles stand.
#[derive(Debug, Clone)]
pub enum Places {
    /// On a lattice: no position is stored.
    Lattice,
    /// At stored positions (m).
    Cloud(Arc<[DVec2]>),
}

/// Particles at rest.
#[derive(Debug, Clone)]
pub struct Particles {
    /// Enthalpy by volume (J/m3), relative to each particle's initial state.
    pub enthalpy: Vec<f64>,
    /// What it was at the start; empty if all particles started from their initial state.
    pub start: Arc<[f64]>,
    /// Where they stand.
    pub places: Places,
    /// The lattice that they fill, or were placed from.
    pub lattice: Arc<Lattice>,
    /// Volume of each particle (m^d).
    pub volume: f64,
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

    /// Temperature of a particle.
    pub fn temperature(&self, index: usize) -> f64 {
        self.materials.of(index).temperature(self.enthalpy[index])
    }

    /// Frozen fraction of a particle.
    pub fn frozen_fraction(&self, index: usize) -> f64 {
        self.materials.of(index).frozen_fraction(self.enthalpy[index])
    }

    /// Hash of the enthalpies to the last bit, as 16 hexadecimal digits.
    pub fn state_hash(&self) -> String {
        let mut hasher = xxhash_rust::xxh3::Xxh3::new();
        for enthalpy in &self.enthalpy {
            hasher.update(&enthalpy.to_bits().to_le_bytes());
        }
        format!("{:016x}", hasher.digest())
    }
}
