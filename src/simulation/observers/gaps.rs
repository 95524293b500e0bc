//! Gaps between the pipes of the first ring or row, which close once ground there is frozen with its latent heat released.

use frazil_core::memory::total;
use frazil_core::saved::{Pass, Saved};
use frazil_core::space::domain::Domain;
use frazil_record::{GapRow, RunResult};

use super::joint::Joint;
use super::observer::{Cadence, End, Instants, Made, Moment, Observer, Schedule, Setup, View, room};
use super::rays::{Pair, following, pairs};

struct Gaps {
    rows: Vec<GapRow>,
    /// Of each of them.
    joints: Vec<Joint>,
    cadence: Cadence,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let (scene, sampler) = (setup.scene, setup.sampler());
    let ring = scene.rings.first()?;
    let gap = |pair: Pair, along_m: Option<f64>, multiplicity: usize| {
        let joint = Joint::between(pair.places, setup, &sampler);
        let [from, to] = pair.names();
        let row = GapRow {
            gap: pair.first(),
            from,
            to,
            angle_deg: along_m.is_none().then(|| pair.angle().to_degrees()),
            along_m,
            multiplicity,
            closure_s: None,
            closure_ref_s: None,
        };
        (row, joint)
    };
    let (rows, joints): (Vec<_>, Vec<_>) = match scene.domain {
        Domain::Ring { sector, .. } => {
            let held = pairs(ring).into_iter().filter(|pair| sector.holds(pair.angle()));
            held.map(|pair| {
                let multiplicity = sector.multiplicity(pair.angle());
                gap(pair, None, multiplicity)
            })
            .unzip()
        }
        Domain::Rectangle { .. } => {
            let (pairs, direction) = (following(ring), ring.direction());
            let start = pairs.first().map_or(0.0, |pair| pair.places[0].dot(direction));
            let along = |pair: Pair| {
                let along = pair.middle.dot(direction) - start;
                gap(pair, Some(along), 1)
            };
            pairs.into_iter().map(along).unzip()
        }
        _ => return None,
    };
    (!rows.is_empty()).then(|| Box::new(Gaps { rows, joints, cadence: Cadence::of(scene) }) as _)
}

impl Saved for Gaps {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.cadence.pass(pass);
        self.joints.iter_mut().for_each(|joint| joint.pass(pass));
    }
}

impl Observer for Gaps {
    fn schedule(&self) -> Schedule {
        Schedule { start: true, instants: Instants::Outputs, next: self.cadence.next }
    }

    fn observe(&mut self, view: &View<'_>) {
        if !matches!(view.moment, Moment::Output { .. }) {
            self.cadence.seen(view.time);
        }
        self.joints.iter_mut().for_each(|joint| joint.look(view));
    }

    fn joints(&self) -> &[Joint] {
        &self.joints
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        let rows = self.rows.into_iter().zip(self.joints);
        result.gaps = rows.map(|(row, joint)| GapRow { closure_s: joint.closed, ..row }).collect();
    }

    fn held_at_the_end(&self) -> usize {
        room(&self.rows) + total(&[&self.joints])
    }
}
