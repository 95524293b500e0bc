//! Rows of a lattice that its stencil does not know: those whose pairs interfaces, cracks or a shaft cut, and those at walls
//! near them. They are on a list of their own, with all that a list can do, and take the place of what the sweep makes of them.

use crate::kernels::enthalpy_rows::Linearised;
use crate::kernels::list_parts::{ListParts, row_sums};
use crate::kernels::rows::ListRows;
use crate::kernels::term::Off;
use crate::memory::HeapSize;
use crate::physics::latent_heat::{LatentHeatScheme, Mushy, SchemeState, scheme};
use crate::saved::{Pass, Saved};
use crate::solvers::step::Clock;

/// Particles of a lattice with rows of their own, and those that they see.
pub struct IrregularRows {
    /// Numbers on the lattice: first those with rows, in order.
    particles: Vec<u32>,
    /// How many have rows.
    rows: usize,
    list: ListRows<Off>,
    scheme: Box<dyn SchemeState>,
    enthalpy: Vec<f64>,
    rate: Vec<f64>,
    /// What the rates are added to.
    kept: Vec<f64>,
    patches: Vec<f64>,
    tangent: Linearised,
}

impl IrregularRows {
    /// Rows of the first `rows` of these particles of a lattice; `parts` numbers particles by their place in `particles`.
    pub fn new(particles: Vec<u32>, rows: usize, parts: ListParts) -> Self {
        let count = particles.len();
        let scheme = scheme(LatentHeatScheme::Enthalpy, Mushy::Fraction, &parts.materials, &[], count);
        let patches = vec![0.0; parts.boundary.patches.len()];
        IrregularRows {
            rows,
            list: ListRows::new(parts, Off),
            scheme,
            enthalpy: vec![0.0; count],
            rate: vec![0.0; count],
            kept: vec![0.0; rows],
            patches,
            tangent: Linearised::default(),
            particles,
        }
    }

    /// Particles that have rows here.
    pub fn particles(&self) -> &[u32] {
        &self.particles[..self.rows]
    }

    fn gather(&mut self, column: &[f64]) {
        for (own, particle) in self.enthalpy.iter_mut().zip(&self.particles) {
            *own = column[*particle as usize];
        }
    }

    /// Takes the rates at a state of all particles and a time (s).
    pub(super) fn evaluate(&mut self, enthalpy: &[f64], time: f64) {
        self.gather(enthalpy);
        let clock = Clock { time, step: 0.0, index: 0, turned: false };
        self.list.rate_of(self.scheme.as_ref(), &self.enthalpy, &clock, &mut self.rate, &mut self.patches);
    }

    /// Takes the rates that small changes of the potentials of all particles cause, by the last linearisation.
    pub(super) fn act(&mut self, changes: &[f64]) {
        self.gather(changes);
        self.list.act(&mut self.tangent, &self.enthalpy, &mut self.rate);
    }

    /// Linearises at a state of all particles and a time (s).
    pub(super) fn linearise(&mut self, enthalpy: &[f64], time: f64) {
        self.gather(enthalpy);
        // Slopes of particles are those of the lattice.
        self.list.linearise(self.scheme.as_ref(), &self.enthalpy, time, &mut self.rate, &mut self.tangent);
    }

    /// Keeps what the rates are to be added to, by particle, before the sweep leaves something else there.
    pub(super) fn keep(&mut self, base: impl Fn(usize) -> f64) {
        for (kept, particle) in self.kept.iter_mut().zip(&self.particles) {
            *kept = base(*particle as usize);
        }
    }

    /// Puts what was kept and the rates, scaled, in the place of what the sweep has left.
    pub(super) fn settle(&self, slots: &mut [f64], scale: f64) {
        for ((particle, kept), rate) in self.particles.iter().zip(&self.kept).zip(&self.rate) {
            slots[*particle as usize] = kept + scale * rate;
        }
    }

    /// Adds the heat (W) that these rows have from walls.
    pub(super) fn book(&self, patches: &mut [f64]) {
        for (all, own) in patches.iter_mut().zip(&self.patches) {
            *all += own;
        }
    }

    /// Heat (W) through the surfaces that the list knows, towards greater coordinates, at a state and time (s).
    pub(super) fn across(&mut self, enthalpy: &[f64], time: f64, heat: &mut [f64]) {
        self.evaluate(enthalpy, time);
        self.list.across(heat);
    }

    /// Surfaces through which heat is counted.
    pub(super) fn surfaces(&self) -> usize {
        self.list.parts.surfaces.len()
    }

    /// Row sums (m^-2) of the particles that have rows here.
    pub fn row_sums(&self) -> Vec<f64> {
        let mut sums = row_sums(&self.list.parts, &self.list.faces[0]);
        sums.truncate(self.rows);
        sums
    }

    /// Whether small changes act by a symmetric matrix.
    pub(super) fn is_symmetric(&self) -> bool {
        let parts = &self.list.parts;
        parts.volumes.is_even() && !parts.materials.mixed() && parts.boundary.is_linear() && parts.rims.is_empty()
    }

    /// Whether small changes act alike at all states and times.
    pub(super) fn is_constant(&self) -> bool {
        !self.list.parts.materials.mixed() && self.list.parts.cuts.is_empty() && self.list.parts.boundary.is_linear()
    }

    /// Whether particles see curved walls through others, wherever these are in the numbering.
    pub(super) fn has_rims(&self) -> bool {
        !self.list.parts.rims.is_empty()
    }
}

impl Saved for IrregularRows {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.list.parts.pass(pass);
    }
}

impl HeapSize for IrregularRows {
    fn heap_size(&self) -> usize {
        let columns =
            self.enthalpy.heap_size() + self.rate.heap_size() + self.kept.heap_size() + self.patches.heap_size();
        self.particles.heap_size() + self.list.heap_size() + columns + self.tangent.heap_size()
    }
}
