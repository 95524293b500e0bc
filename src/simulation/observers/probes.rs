//! Temperatures at points.

use frazil_core::memory::HeapSize;
use frazil_record::ProbeRow;
use glam::DVec2;

use super::observer::{Instants, Made, Setup};
use super::sampler::{Sample, Sampler};
use super::series::series;

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let places = &setup.scene.watch.probes;
    if places.is_empty() {
        return None;
    }
    let sampler = setup.sampler();
    let at = |(x, y): &(f64, f64)| (DVec2::new(*x, *y), sampler.sample(DVec2::new(*x, *y)));
    let probes: Vec<(DVec2, Sample)> = places.iter().map(at).collect();
    series(
        Instants::Outputs,
        Vec::with_capacity(places.len() * setup.outputs()),
        (0, probes.heap_size()),
        move |view, rows| {
            let particles = view.particles;
            let sampler = Sampler::anew(view.scene, particles, view.time);
            for (place, sample) in probes.iter().filter(|(place, _)| !particles.is_dug(place.length())) {
                let anew = sampler.as_ref().map(|sampler| sampler.sample(*place));
                let sample = anew.as_ref().unwrap_or(sample);
                let temperature_c = sample.of(|i| particles.reading(i));
                let carries = !particles.concentration.is_empty();
                let concentration = carries.then(|| sample.of(|i| particles.concentration[i]));
                rows.push(ProbeRow { time_s: view.time, x_m: place.x, y_m: place.y, temperature_c, concentration });
            }
        },
        |rows, result| result.probes = rows,
    )
}
