//! Observers: what is read off the particles between steps, and never inside one.

mod alike;
mod arrivals;
mod boundary;
mod budget;
mod corners;
mod fields;
mod front;
mod front_lines;
mod front_shape;
mod frozen;
mod gaps;
mod isotherms;
mod joint;
mod lengths;
mod level_set;
mod loads;
pub(crate) mod loops;
mod moisture;
mod neck;
pub(crate) mod observer;
mod passage;
mod phases;
mod pipe_walls;
mod probes;
mod profiles;
pub(crate) mod rays;
pub(crate) mod readings;
mod regions;
mod sampler;
mod section;
mod series;
mod shells;
mod standing;
mod stream;
mod sunk;
mod surfaces;
mod wall;
mod water;

use frazil_core::particles::Particles;
use frazil_core::saved::{Pass, Saved};
use frazil_record::RunResult;

use crate::monotonicity;
use joint::Joint;
use observer::{End, Fractions, Maker, Observer, Setup, View, is_parted};

pub use fields::map;
pub use loads::TABLE as LOADS;
pub use pipe_walls::TABLE as PIPE_WALLS;

/// Makes each observer, where a scene needs it; and the table that says itself what is in it, if it leaves one.
const OBSERVERS: [(Maker, Option<&str>); 20] = [
    (monotonicity::of, None),
    (front::of, None),
    (frozen::of, None),
    (phases::of, None),
    (stream::of, None),
    (surfaces::of, None),
    (profiles::of, None),
    (probes::of, None),
    (budget::of, None),
    (gaps::of, None),
    (wall::of, None),
    (fields::of, None),
    (front_lines::of, None),
    (water::of, None),
    (moisture::of, Some(moisture::TABLE)),
    (isotherms::of, Some(isotherms::TABLE)),
    (regions::of, Some(regions::TABLE)),
    (front_shape::of, Some(front_shape::TABLE)),
    (pipe_walls::of, Some(pipe_walls::TABLE)),
    (loads::of, Some(loads::TABLE)),
];

/// Files of the tables that say themselves what is in them.
pub fn tables() -> impl Iterator<Item = &'static str> {
    OBSERVERS.iter().filter_map(|(_, table)| *table)
}

/// The observers of a run.
pub(crate) struct Observers {
    all: Vec<Box<dyn Observer>>,
    /// Frozen fractions of the state that they have seen last, the time (s) of it, and how many there are.
    fractions: Fractions,
    seen: f64,
    count: usize,
    /// The earliest time (s) at which one of them wants to see a state between outputs.
    next: f64,
}

impl Saved for Observers {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.all.iter_mut().for_each(|observer| observer.pass(pass));
        self.plan();
    }
}

impl Observers {
    /// Those that a scene needs.
    pub(crate) fn new(setup: &Setup<'_>) -> Self {
        let all = OBSERVERS.iter().filter_map(|(of, _)| of(setup)).collect();
        let count = if is_parted(setup.scene) { setup.particles.len() } else { 0 };
        let (fractions, seen) = (Fractions::default(), f64::NAN);
        let mut observers = Observers { all, fractions, seen, count, next: f64::INFINITY };
        observers.plan();
        observers
    }

    fn plan(&mut self) {
        self.next = self.all.iter().map(|observer| observer.schedule().next).fold(f64::INFINITY, f64::min);
    }

    /// Whether one of them wants to see the state between outputs at this time (s).
    #[inline]
    pub(crate) fn are_due(&self, time: f64) -> bool {
        time >= self.next
    }

    /// Fractions of a state at a time (s): those that are known, if it is the one that was seen last.
    fn fractions_at(&mut self, time: f64) -> Fractions {
        let known = std::mem::take(&mut self.fractions);
        if std::mem::replace(&mut self.seen, time) == time { known } else { Fractions::within(known.into_room()) }
    }

    /// Shows a state to those that want it.
    pub(crate) fn observe(&mut self, mut view: View<'_>) {
        view.fractions = self.fractions_at(view.time);
        self.all.iter_mut().filter(|observer| observer.schedule().wants(&view)).for_each(|one| one.observe(&view));
        self.fractions = view.fractions;
        self.plan();
    }

    fn joints(&self) -> impl Iterator<Item = &Joint> {
        self.all.iter().flat_map(|observer| observer.joints())
    }

    /// Whether a gap that was open when it was seen last has closed, by the state at a time (s).
    pub(crate) fn has_closed(&mut self, particles: &Particles, time: f64) -> bool {
        let fractions = self.fractions_at(time);
        let crossed = self.joints().any(|joint| joint.closes(particles, &fractions));
        self.fractions = fractions;
        crossed
    }

    /// Time (s) until a gap closes, as far as that is known.
    pub(crate) fn until_closure(&self) -> f64 {
        self.joints().map(Joint::left).fold(f64::INFINITY, f64::min)
    }

    /// Puts all that they have seen into what the run leaves.
    pub(crate) fn leave(self, end: &End<'_>, result: &mut RunResult) {
        self.all.into_iter().for_each(|observer| observer.leave(end, result));
    }

    /// Bytes that they will hold on the heap at the end of a run.
    pub(crate) fn held_at_the_end(&self) -> usize {
        self.count * size_of::<f64>() + self.all.iter().map(|observer| observer.held_at_the_end()).sum::<usize>()
    }
}
