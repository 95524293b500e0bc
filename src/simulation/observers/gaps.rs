//! Gaps between the pipes of the first ring, which close once ground there is frozen with its latent heat released.

use frazil_core::memory::HeapSize;
use frazil_core::particles::Particles;
use frazil_core::saved::{Pass, Saved};
use frazil_core::space::domain::Domain;
use frazil_record::{GapRow, RunResult};

use super::joint::{Joint, Way, is_sharp};
use super::observer::{Cadence, End, Instants, Made, Observer, Schedule, Setup, View, room};
use super::rays::pairs;

struct Gaps {
    gaps: Vec<(GapRow, Joint)>,
    sharp: bool,
    cadence: Cadence,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let (scene, sampler) = (setup.scene, setup.sampler());
    let (Domain::Ring { outer_radius, sector }, Some(ring)) = (&scene.domain, scene.rings.first()) else { return None };
    let pairs = pairs(ring).into_iter().filter(|pair| sector.holds(pair.angle()));
    let gaps = pairs.map(|pair| {
        // Columns meet a little inside the ring; look where they can.
        let (from, to) = (-0.5 * pair.distance, 0.3 * pair.distance);
        let count = ((to - from) / (0.25 * sampler.lattice.spacing)).ceil().max(1.0) as usize;
        let places = (0..=count).map(|k| pair.middle + (from + (to - from) * k as f64 / count as f64) * pair.across);
        // Not beyond the centre, nor the outer wall.
        let near = places.filter(|place| place.length() <= *outer_radius && place.dot(pair.middle) >= 0.0);
        let ways = near.map(|place| Way::Through(sampler.sample(place), Vec::new())).collect();
        let [from, to] = pair.names();
        let row = GapRow {
            gap: pair.first(),
            from,
            to,
            angle_deg: pair.angle().to_degrees(),
            multiplicity: sector.multiplicity(pair.angle()),
            closure_s: None,
            closure_ref_s: None,
        };
        (row, Joint::new(ways))
    });
    let gaps: Vec<_> = gaps.collect();
    (!gaps.is_empty()).then(|| Box::new(Gaps { gaps, sharp: is_sharp(scene), cadence: Cadence::of(scene) }) as _)
}

impl Saved for Gaps {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.cadence.pass(pass);
        self.gaps.iter_mut().for_each(|(_, joint)| joint.pass(pass));
    }
}

impl Observer for Gaps {
    fn schedule(&self) -> Schedule {
        Schedule { start: true, instants: Instants::None, next: self.cadence.next }
    }

    fn observe(&mut self, view: &View<'_>) {
        self.cadence.seen(view.time);
        self.gaps.iter_mut().for_each(|(_, joint)| joint.look(view.particles, self.sharp, view.time));
    }

    fn has_crossed(&self, particles: &Particles) -> bool {
        self.gaps.iter().any(|(_, joint)| joint.closes(particles, self.sharp))
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        let rows = self.gaps.into_iter().map(|(row, joint)| GapRow { closure_s: joint.closed, ..row });
        result.gaps = rows.collect();
    }

    fn held_at_the_end(&self) -> usize {
        room(&self.gaps) + self.gaps.iter().map(|(_, joint)| joint.heap_size()).sum::<usize>()
    }
}
