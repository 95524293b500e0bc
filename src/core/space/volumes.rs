//! Volumes of particles.

use std::sync::Arc;

use crate::memory::{HeapSize, shared};
use crate::space::domain::Domain;
use crate::space::lattice::Lattice;

/// Volumes of particles.
#[derive(Debug, Clone)]
pub struct Volumes {
    /// What shares are of (m^d).
    unit: f64,
    /// By column of the lattice, or by particle; empty where all particles are alike.
    shares: Arc<[f64]>,
}

impl Volumes {
    /// All alike (m^d).
    pub fn even(volume: f64) -> Self {
        Volumes { unit: volume, shares: Arc::new([]) }
    }

    /// Volumes of the particles of a lattice in a domain. `printed` takes the papers', by the middle radius.
    pub fn new(domain: &Domain, lattice: &Lattice, printed: bool) -> Self {
        let Some(symmetry) = domain.symmetry() else { return Volumes::even(lattice.volume()) };
        let height = if lattice.dimension == 2 { lattice.spacing } else { 1.0 };
        let shell = |column: usize| {
            let (inner, outer) = (edge(lattice, column), edge(lattice, column + 1));
            let volume = match printed {
                true => symmetry.area(0.5 * (inner + outer)) * lattice.spacing,
                false => symmetry.volume(inner, outer),
            };
            volume * height
        };
        Volumes { unit: 1.0, shares: (0..lattice.columns).map(shell).collect() }
    }

    /// By particle, in shares of a volume (m^d).
    pub fn by_share(volume: f64, shares: Vec<f64>) -> Self {
        Volumes { unit: volume, shares: shares.into() }
    }

    /// Those of some particles.
    pub fn of_some(&self, particles: &[u32]) -> Self {
        if self.shares.is_empty() {
            return self.clone();
        }
        Volumes { unit: self.unit, shares: particles.iter().map(|particle| self.share(*particle as usize)).collect() }
    }

    /// Whether all are alike.
    pub fn is_even(&self) -> bool {
        self.shares.is_empty()
    }

    /// What [`Volumes::share`] is of (m^d).
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// Volume of a particle over [`Volumes::unit`]: 1 where all are alike.
    #[inline(always)]
    pub fn share(&self, particle: usize) -> f64 {
        if self.shares.is_empty() { 1.0 } else { self.shares[particle % self.shares.len()] }
    }

    /// Volume of a particle (m^d).
    #[inline]
    pub fn of(&self, particle: usize) -> f64 {
        self.unit * self.share(particle)
    }

    /// The largest of all (m^d).
    pub fn largest(&self) -> f64 {
        self.unit * self.shares.iter().copied().fold(if self.shares.is_empty() { 1.0 } else { 0.0 }, f64::max)
    }
}

impl HeapSize for Volumes {
    fn heap_size(&self) -> usize {
        if self.shares.is_empty() { 0 } else { shared(&self.shares) }
    }
}

/// Radius (m) of the inner edge of a column.
pub(crate) fn edge(lattice: &Lattice, column: usize) -> f64 {
    lattice.corner.x + column as f64 * lattice.spacing
}
