//! Two frozen bodies that join once a way between them is frozen through, and when.

use std::sync::Arc;

use frazil_core::memory::HeapSize;
use frazil_core::particles::Particles;
use frazil_core::saved::{Pass, Saved};
use glam::DVec2;

use super::neck::Neck;
use super::observer::{Fractions, Setup, View};
use super::readings::{Reading, Way, is_sharp};
use super::sampler::{Sample, Sampler};

/// Two frozen bodies that join.
#[derive(Debug, Clone)]
pub(crate) struct Joint {
    reading: Arc<Reading>,
    /// Whether it is the first with its reading.
    is_first: bool,
    /// Whether ground freezes at one temperature.
    sharp: bool,
    /// Time and openness at the last look: positive while open.
    last: Option<(f64, f64)>,
    /// Time (s) from the last look until it closes, at the rate between the last two; infinite where that is not known.
    left: f64,
    pub(super) closed: Option<f64>,
}

impl Joint {
    /// Of what is frozen around two pipes.
    pub(super) fn between(pipes: [DVec2; 2], setup: &Setup<'_>, sampler: &Sampler<'_>) -> Self {
        let (reading, is_first) = setup.readings.between(pipes, setup.scene, sampler);
        Joint { reading, is_first, sharp: is_sharp(setup.scene), last: None, left: f64::INFINITY, closed: None }
    }

    /// At a place. `sharp`: ground freezes at one temperature.
    pub(super) fn at(way: Way, sharp: bool) -> Self {
        Joint {
            reading: Arc::new(Reading::Ways(vec![way])),
            is_first: true,
            sharp,
            last: None,
            left: f64::INFINITY,
            closed: None,
        }
    }

    /// How far it is from being closed, in the ground as it is: positive while open.
    fn openness_in(&self, particles: &Particles, fractions: &Fractions) -> f64 {
        let ways = match &*self.reading {
            Reading::Neck(neck) => {
                return match is_wide(neck, particles) {
                    true => f64::INFINITY,
                    false => neck.width(fractions.of(particles)),
                };
            }
            Reading::Ways(ways) => ways,
        };
        match self.sharp {
            // Enthalpy above the frozen state, in units of the latent heat.
            true => openness(ways, |sample| {
                sample.of(|i| {
                    let thermal = particles.materials.of(i);
                    (particles.enthalpy[i] + thermal.zero_enthalpy) / thermal.curve.latent_heat() + 1.0
                })
            }),
            false => openness(ways, |sample| 0.5 - sample.of(|i| fractions.of_one(particles, i))),
        }
    }

    /// Whether open ground parts both bodies now.
    pub(super) fn is_open(&self, particles: &Particles, fractions: &Fractions) -> bool {
        match &*self.reading {
            Reading::Neck(neck) => is_wide(neck, particles) || !neck.has_met(fractions.of(particles)),
            Reading::Ways(_) => self.openness_in(particles, fractions) > 0.0,
        }
    }

    /// Whether it was open at the last look and is closed now.
    pub(super) fn closes(&self, particles: &Particles, fractions: &Fractions) -> bool {
        self.closed.is_none() && self.openness_in(particles, fractions) <= 0.0
    }

    /// Time (s) until it closes, as far as that is known.
    pub(super) fn left(&self) -> f64 {
        self.left
    }

    /// Looks at the ground, unless it is closed.
    pub(super) fn look(&mut self, view: &View<'_>) {
        if self.closed.is_none() {
            self.take(view.time, self.openness_in(view.particles, &view.fractions));
        }
    }

    /// Takes how far it is from being closed at a time. The instant of closing is interpolated between looks.
    fn take(&mut self, time: f64, now: f64) {
        if now <= 0.0 {
            self.closed = Some(match self.last {
                Some((before, open)) if open > 0.0 && open.is_finite() => {
                    before + (time - before) * open / (open - now)
                }
                _ => time,
            });
        }
        let rate = self.last.map_or(0.0, |(before, open)| (open - now) / (time - before));
        // Nothing is known of a gap that was wider than can be told, and nothing is to come in one that is closed.
        self.left = if rate > 0.0 && rate.is_finite() && now > 0.0 { now / rate } else { f64::INFINITY };
        self.last = Some((time, now));
    }
}

/// Whether open ground is wider than can be told, as long as heat alone tells it: fractions of all particles take longer.
fn is_wide(neck: &Neck, particles: &Particles) -> bool {
    neck.is_wide(|i| particles.materials.of(i).frozen_fraction(particles.enthalpy[i]) == 0.0)
}

/// How far the first of ways to freeze is from it.
fn openness(ways: &[Way], value: impl Fn(&Sample) -> f64) -> f64 {
    ways.iter().fold(f64::INFINITY, |least, way| least.min(way.greatest(least, &value)))
}

impl Saved for Joint {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.last, &mut self.left, &mut self.closed]);
    }
}

impl HeapSize for Joint {
    fn heap_size(&self) -> usize {
        if self.is_first { self.reading.heap_size() } else { 0 }
    }
}
