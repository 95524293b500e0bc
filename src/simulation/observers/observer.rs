//! What an observer is: when it sees the state of a run, and what it leaves.

use frazil_core::saved::{Pass, Saved};
use std::cell::{OnceCell, RefCell};
use std::sync::Arc;

use frazil_core::boundary::pipe::Sink;
use frazil_core::ledger::Ledger;
use frazil_core::particles::Particles;
use frazil_core::solvers::solver::Solver;
use frazil_core::space::domain::Domain;
use frazil_record::RunResult;
use frazil_scene::Scene;

use super::joint::Joint;
use super::readings::Readings;
use super::sampler::Sampler;
use crate::march::instants::outputs;
use crate::reference::Reference;

/// Something that reads states between steps and leaves tables. No call of it is made within a step.
pub trait Observer: Saved {
    /// When it is to see the state next.
    fn schedule(&self) -> Schedule;
    /// Takes what it is there for off a state.
    fn observe(&mut self, view: &View<'_>);
    /// Frozen bodies whose joining it tells the instant of: where states within steps are known, steps are shorter before it, and it sees
    /// some states within the step in which they join.
    fn joints(&self) -> &[Joint] {
        &[]
    }
    /// Puts what it has seen into what the run leaves.
    fn leave(self: Box<Self>, end: &End<'_>, result: &mut RunResult);
    /// Bytes that it will hold on the heap at the end of the run.
    fn held_at_the_end(&self) -> usize;
}

/// An observer, if the scene needs it.
pub(crate) type Made = Option<Box<dyn Observer>>;

/// What makes an observer where it is needed.
pub(super) type Maker = fn(&Setup<'_>) -> Made;

/// When an observer is to see states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Schedule {
    /// Whether at the start.
    pub(crate) start: bool,
    /// At which of the instants of output.
    pub(crate) instants: Instants,
    /// Time (s) from which on it wants to see the next state between outputs; infinite where it wants none.
    pub(crate) next: f64,
}

/// Instants of output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Instants {
    /// None of them.
    None,
    /// All of them.
    Outputs,
    /// Those at which profiles are kept.
    Profiles,
}

impl Schedule {
    /// Every output.
    pub(crate) const OUTPUTS: Schedule = Schedule { start: false, instants: Instants::Outputs, next: f64::INFINITY };

    /// Whether a view is for it.
    pub(super) fn wants(&self, view: &View<'_>) -> bool {
        match view.moment {
            Moment::Start => self.start,
            Moment::Between => view.time >= self.next,
            Moment::Within => self.next < f64::INFINITY,
            Moment::Output { .. } => match self.instants {
                Instants::None => false,
                Instants::Outputs => true,
                Instants::Profiles => view.is_kept(),
            },
        }
    }
}

/// Evenly spaced looks between outputs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cadence {
    every: f64,
    pub(super) next: f64,
}

impl Saved for Cadence {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.next.pass(pass);
    }
}

impl Cadence {
    /// Share of the duration between two looks.
    pub(crate) const SHARE: f64 = 1.0 / 4000.0;

    pub(super) fn of(scene: &Scene) -> Self {
        Cadence { every: scene.duration * Self::SHARE, next: 0.0 }
    }

    /// Takes that a state was seen at a time (s).
    pub(super) fn seen(&mut self, time: f64) {
        self.next = time + self.every;
    }
}

/// What moment of a run a view is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moment {
    /// Before the first step.
    Start,
    /// After a step, for those that want it between outputs.
    Between,
    /// Within a step, for those that tell instants.
    Within,
    /// An output.
    Output {
        /// Whether a step has landed on it, and has not passed over it.
        landed: bool,
    },
}

/// A state and what belongs to it.
pub(crate) struct View<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) particles: &'a Particles,
    pub(crate) method: &'a dyn Solver,
    /// Heat that has come in.
    pub(crate) ledger: &'a Ledger,
    /// Heat (W) through the surfaces of the scene, in their order; at outputs.
    pub(crate) across: &'a [f64],
    /// Time (s).
    pub(crate) time: f64,
    pub(crate) moment: Moment,
    pub(crate) fractions: Fractions,
}

/// Frozen fractions of all particles of a state, and their integral, once an observer has asked for them.
#[derive(Debug, Default)]
pub(crate) struct Fractions {
    column: OnceCell<Vec<f64>>,
    integral: OnceCell<f64>,
    /// Room for the column.
    room: RefCell<Vec<f64>>,
}

impl Fractions {
    /// Those of no particles yet, where there is room.
    pub(crate) fn within(room: Vec<f64>) -> Self {
        Fractions { room: RefCell::new(room), ..Fractions::default() }
    }

    /// Those of all particles of the state.
    pub(crate) fn of(&self, particles: &Particles) -> &[f64] {
        self.column.get_or_init(|| {
            let mut column = self.room.take();
            particles.front_fractions(&mut column);
            column
        })
    }

    /// That of one particle of the state.
    pub(crate) fn of_one(&self, particles: &Particles, index: usize) -> f64 {
        self.column.get().map_or_else(|| particles.front_fraction(index), |column| column[index])
    }

    /// The room.
    pub(crate) fn into_room(self) -> Vec<f64> {
        self.column.into_inner().unwrap_or_else(|| self.room.into_inner())
    }
}

/// Whether particles of a scene have a fraction that is frozen, or of water one that is not filled.
pub(super) fn is_parted(scene: &Scene) -> bool {
    scene.of_water || scene.freezes()
}

impl View<'_> {
    /// Integral of the frozen fraction over the particles (m^d).
    pub(crate) fn frozen(&self) -> f64 {
        if !is_parted(self.scene) {
            return 0.0;
        }
        *self.fractions.integral.get_or_init(|| self.particles.integrals(self.fractions(), &[])[0])
    }

    /// Frozen fractions of all particles.
    pub(crate) fn fractions(&self) -> &[f64] {
        self.fractions.of(self.particles)
    }

    /// Whether profiles are kept at its time.
    pub(super) fn is_kept(&self) -> bool {
        let wanted = |instant: &f64| (instant - self.time).abs() <= 1e-9 * self.scene.duration;
        self.scene.watch.profiles.iter().any(wanted)
    }
}

/// What observers are made from.
pub(crate) struct Setup<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) particles: &'a Particles,
    pub(crate) method: &'a dyn Solver,
    /// Pipes, joined to particles.
    pub(crate) pipes: &'a [Sink],
    /// Whether maps are kept.
    pub(crate) maps: bool,
    /// What the run is measured against.
    pub(crate) reference: Option<&'a Arc<dyn Reference>>,
    /// What tells whether the frozen bodies of two pipes have joined.
    pub(crate) readings: Readings,
}

impl<'a> Setup<'a> {
    /// Instants of output.
    pub(super) fn outputs(&self) -> usize {
        outputs(self.scene).len()
    }

    /// Instants at which profiles are kept.
    pub(super) fn profiles(&self) -> usize {
        self.scene.watch.profiles.len()
    }

    /// How often the part of a ring that is run is in the whole.
    pub(super) fn images(&self) -> f64 {
        match self.scene.domain {
            Domain::Ring { sector, .. } => sector.images() as f64,
            _ => 1.0,
        }
    }

    pub(super) fn sampler(&self) -> Sampler<'a> {
        Sampler::new(self.scene, self.particles, 0.0)
    }
}

/// The end of a run.
pub(crate) struct End<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) particles: &'a Particles,
    /// What the run is measured against.
    pub(crate) reference: Option<&'a Arc<dyn Reference>>,
}

/// Bytes of rows, without what each holds on the heap.
pub(super) fn room<T>(rows: &Vec<T>) -> usize {
    rows.capacity() * size_of::<T>()
}

/// The one of two numbers that is farther from zero.
pub(crate) fn larger_magnitude(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}
