//! Velocities, densities and temperatures across a driven liquid, averaged over time.

use frazil_core::particles::Particles;
use frazil_core::saved::{Pass, Saved};
use frazil_core::space::domain::Domain;
use frazil_record::{RunResult, SectionRow, StreamRow};

use super::observer::{Cadence, End, Instants, Made, Observer, Schedule, Setup, View};
use crate::stream::judge;

/// Half the length along x over which a section is averaged, over the spacing.
const HALF_LENGTH: f64 = 4.0;

/// Sums of one bin.
#[derive(Debug, Clone, Copy, Default)]
struct Bin {
    count: f64,
    speed: f64,
    temperature: f64,
}

/// Averages across a stream.
struct Averages {
    between: (f64, f64),
    sections: Vec<f64>,
    half_length: f64,
    length: f64,
    height: f64,
    /// Bins across, evenly over all of the stream, and by section.
    whole: Vec<Bin>,
    across: Vec<Vec<Bin>>,
    looks: f64,
    cadence: Cadence,
}

/// The averages of a scene with a stream.
pub(super) fn of(setup: &Setup<'_>) -> Made {
    let (scene, particles) = (setup.scene, setup.particles);
    let (Some(stream), Domain::Rectangle { width, height }) = (&scene.stream, scene.domain) else { return None };
    let spacing = particles.lattice.spacing;
    let bins = (height / spacing).round().max(1.0) as usize;
    let averages = Averages {
        between: stream.average,
        sections: stream.sections.clone(),
        half_length: HALF_LENGTH * spacing,
        length: width,
        height,
        whole: vec![Bin::default(); bins],
        across: vec![vec![Bin::default(); bins]; stream.sections.len()],
        looks: 0.0,
        cadence: Cadence::of(scene),
    };
    particles.move_about().then(|| Box::new(averages) as _)
}

impl Saved for Bin {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.count, &mut self.speed, &mut self.temperature]);
    }
}

impl Saved for Averages {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.whole, &mut self.across, &mut self.looks, &mut self.cadence]);
    }
}

impl Observer for Averages {
    fn schedule(&self) -> Schedule {
        let next = self.cadence.next.max(self.between.0);
        let next = if next <= self.between.1 { next } else { f64::INFINITY };
        Schedule { start: true, instants: Instants::None, next }
    }

    fn observe(&mut self, view: &View<'_>) {
        self.cadence.seen(view.time);
        if (self.between.0..=self.between.1).contains(&view.time) {
            self.add(view.particles);
        }
    }

    fn leave(self: Box<Self>, end: &End<'_>, result: &mut RunResult) {
        (result.stream, result.sections) = (self.stream(end.particles), self.sections());
        result.record.stream = judge(end.scene, &result.stream, &mut result.sections);
    }

    fn held_at_the_end(&self) -> usize {
        let bins = self.whole.len();
        let rows = bins * size_of::<StreamRow>() + self.sections.len() * bins * size_of::<SectionRow>();
        rows + (1 + self.sections.len()) * bins * size_of::<Bin>()
    }
}

impl Averages {
    /// Adds a state.
    fn add(&mut self, particles: &Particles) {
        self.looks += 1.0;
        let bins = self.whole.len();
        particles.visit(|i, place| {
            let bin = ((place.y / self.height * bins as f64) as usize).min(bins - 1);
            let (speed, temperature) = (particles.velocity[i].x, particles.temperature(i));
            let add = |bin: &mut Bin| {
                bin.count += 1.0;
                bin.speed += speed;
                bin.temperature += temperature;
            };
            add(&mut self.whole[bin]);
            for (at, across) in self.sections.iter().zip(&mut self.across) {
                if (place.x - at).abs() <= self.half_length {
                    add(&mut across[bin]);
                }
            }
        });
    }

    /// Velocity and density across all of the stream.
    fn stream(&self, particles: &Particles) -> Vec<StreamRow> {
        let bins = self.whole.len();
        let even = self.length * self.height / bins as f64 / particles.volumes.largest() * self.looks;
        let row = |(k, bin): (usize, &Bin)| StreamRow {
            y_m: (k as f64 + 0.5) / bins as f64 * self.height,
            speed_m_per_s: bin.speed / bin.count,
            density_rel: bin.count / even,
        };
        if self.looks > 0.0 { self.whole.iter().enumerate().map(row).collect() } else { Vec::new() }
    }

    /// Temperatures across the sections.
    fn sections(&self) -> Vec<SectionRow> {
        let bins = self.whole.len();
        let mut rows = Vec::new();
        for (x_m, across) in self.sections.iter().zip(&self.across) {
            for (k, bin) in across.iter().enumerate().filter(|(_, bin)| bin.count > 0.0) {
                rows.push(SectionRow {
                    x_m: *x_m,
                    y_m: (k as f64 + 0.5) / bins as f64 * self.height,
                    temperature_c: bin.temperature / bin.count,
                    temperature_ref_c: None,
                });
            }
        }
        rows
    }
}
