//! How much of the body, or of a part of it, is liquid, freezing and solid.

use frazil_core::particles::Particles;
use frazil_record::PhaseRow;

use super::observer::{Instants, Made, Setup, View};
use super::series::series;

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let part = setup.scene.watch.phases?;
    let rows = Vec::with_capacity(setup.outputs());
    let read = move |view: &View<'_>, rows: &mut Vec<PhaseRow>| rows.push(shares(view.particles, part, view.time));
    series(Instants::Outputs, rows, (0, 0), read, |rows, result| result.phases = rows)
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
