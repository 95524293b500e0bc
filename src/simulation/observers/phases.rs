//! How much of the body, or of a part of it, is liquid, freezing and solid.

use frazil_core::particles::Particles;
use frazil_record::{PhaseRow, RunResult};

use super::observer::{End, Made, Observer, Schedule, Setup, View, room};

struct Phases {
    /// Part of the body (m along x).
    part: (f64, f64),
    rows: Vec<PhaseRow>,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let part = setup.scene.watch.phases?;
    Some(Box::new(Phases { part, rows: Vec::with_capacity(setup.outputs()) }))
}

impl Observer for Phases {
    fn schedule(&self) -> Schedule {
        Schedule::OUTPUTS
    }

    fn observe(&mut self, view: &View<'_>) {
        self.rows.push(shares(view.particles, self.part, view.time));
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        result.phases = self.rows;
    }

    fn held_at_the_end(&self) -> usize {
        room(&self.rows)
    }
}

/// Shares of the particles, by volume, that lie between two places (m) along x.
fn shares(particles: &Particles, (from, to): (f64, f64), time_s: f64) -> PhaseRow {
    let (mut liquid, mut mushy, mut solid) = (0.0, 0.0, 0.0);
    particles.visit(|i, place| {
        if place.x < from || place.x > to {
            return;
        }
        let volume = particles.volumes.of(i);
        let frozen = particles.frozen_fraction(i);
        if frozen <= 0.0 {
            liquid += volume;
        } else if frozen < 1.0 {
            mushy += volume;
        } else {
            solid += volume;
        }
    });
    let all = liquid + mushy + solid;
    let share = |part: f64| if all > 0.0 { part / all } else { f64::NAN };
    PhaseRow { time_s, liquid: share(liquid), mushy: share(mushy), solid: share(solid) }
}
