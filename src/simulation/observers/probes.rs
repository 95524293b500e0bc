//! Temperatures at points.

use frazil_core::memory::HeapSize;
use frazil_record::{ProbeRow, RunResult};
use glam::DVec2;

use super::observer::{End, Made, Observer, Schedule, Setup, View, room};
use super::sampler::{Sample, Sampler};

struct Probes {
    probes: Vec<(DVec2, Sample)>,
    rows: Vec<ProbeRow>,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let places = &setup.scene.watch.probes;
    let sampler = setup.sampler();
    let at = |(x, y): &(f64, f64)| (DVec2::new(*x, *y), sampler.sample(DVec2::new(*x, *y)));
    let rows = Vec::with_capacity(places.len() * setup.outputs());
    (!places.is_empty()).then(|| Box::new(Probes { probes: places.iter().map(at).collect(), rows }) as _)
}

impl Observer for Probes {
    fn schedule(&self) -> Schedule {
        Schedule::OUTPUTS
    }

    fn observe(&mut self, view: &View<'_>) {
        let particles = view.particles;
        // Samples are of particles that stay where they are.
        let sampler = Sampler::free(particles);
        for (place, sample) in self.probes.iter().filter(|(place, _)| !particles.is_dug(place.length())) {
            let moved = particles.move_about().then(|| sampler.sample(*place));
            let temperature_c = moved.as_ref().unwrap_or(sample).of(|i| particles.reading(i));
            self.rows.push(ProbeRow { time_s: view.time, x_m: place.x, y_m: place.y, temperature_c });
        }
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        result.probes = self.rows;
    }

    fn held_at_the_end(&self) -> usize {
        room(&self.rows) + self.probes.heap_size()
    }
}
