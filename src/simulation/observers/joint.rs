//! Two frozen bodies that join once a way between them is frozen through, and when.

use frazil_core::memory::HeapSize;
use frazil_core::particles::Particles;
use frazil_core::saved::{Pass, Saved};
use frazil_scene::Scene;

use super::sampler::Sample;

/// Whether the ground of a scene freezes at one temperature.
pub(super) fn is_sharp(scene: &Scene) -> bool {
    scene.materials[0].is_sharp()
}

/// Openness of a place that the tip of open ground between two frozen bodies is leaving, over the difference of openness one
/// spacing to either side of it, behind the tip and ahead: a tip is a parabola, as wide as the root of the distance from it, so with
/// it at the place the cell there holds the integral of the root from 0 to 1/2, and the next one that from 1/2 to 3/2.
const AT_A_TIP: f64 = 0.25;

/// Places that all have to freeze for a way through them to be frozen.
#[derive(Debug, Clone)]
pub(super) enum Way {
    /// The place half-way, likely to be the last, and the others.
    Through(Sample, Vec<Sample>),
    /// One place that a tip of open ground is leaving, and places a spacing to either side of it.
    Tip(Sample, [Sample; 2]),
}

impl Way {
    /// The greatest of a value along the way; less is not sought than a greatest value that is known.
    fn greatest(&self, known: f64, value: impl Fn(&Sample) -> f64) -> f64 {
        match self {
            Way::Through(gate, rest) => {
                let mut greatest = value(gate);
                for sample in rest {
                    if greatest >= known {
                        break;
                    }
                    greatest = greatest.max(value(sample));
                }
                greatest
            }
            Way::Tip(place, [before, behind]) => {
                let open = |sample: &Sample| value(sample).clamp(0.0, 1.0);
                value(place) - AT_A_TIP * (open(before) - open(behind)).abs()
            }
        }
    }
}

impl HeapSize for Way {
    fn heap_size(&self) -> usize {
        match self {
            Way::Through(gate, rest) => gate.heap_size() + rest.heap_size(),
            Way::Tip(place, beside) => place.heap_size() + beside.iter().map(HeapSize::heap_size).sum::<usize>(),
        }
    }
}

/// Ways of which the first to freeze joins two frozen bodies.
#[derive(Debug, Clone, Default)]
pub(super) struct Joint {
    ways: Vec<Way>,
    /// Time and openness at the last look: positive while open.
    last: Option<(f64, f64)>,
    pub(super) closed: Option<f64>,
}

impl Joint {
    pub(super) fn new(ways: Vec<Way>) -> Self {
        Joint { ways, ..Joint::default() }
    }

    /// How far it is from being closed: positive while open.
    fn openness(&self, value: impl Fn(&Sample) -> f64) -> f64 {
        self.ways.iter().fold(f64::INFINITY, |least, way| least.min(way.greatest(least, &value)))
    }

    /// The same in the ground as it is. `sharp`: it freezes at one temperature.
    fn openness_in(&self, particles: &Particles, sharp: bool) -> f64 {
        match sharp {
            // Enthalpy above the frozen state, in units of the latent heat.
            true => self.openness(|sample| {
                sample.of(|i| {
                    let thermal = particles.materials.of(i);
                    (particles.enthalpy[i] + thermal.zero_enthalpy) / thermal.curve.latent_heat() + 1.0
                })
            }),
            false => self.openness(|sample| 0.5 - sample.of(|i| particles.frozen_fraction(i))),
        }
    }

    /// Whether it was open at the last look and is closed now.
    pub(super) fn closes(&self, particles: &Particles, sharp: bool) -> bool {
        self.closed.is_none() && self.openness_in(particles, sharp) <= 0.0
    }

    /// Looks at the ground at a time (s), unless it is closed.
    pub(super) fn look(&mut self, particles: &Particles, sharp: bool, time: f64) {
        if self.closed.is_none() {
            self.take(time, self.openness_in(particles, sharp));
        }
    }

    /// Takes how far it is from being closed at a time. The instant of closing is interpolated between looks.
    fn take(&mut self, time: f64, now: f64) {
        if now <= 0.0 {
            self.closed = Some(match self.last {
                Some((before, open)) if open > 0.0 => before + (time - before) * open / (open - now),
                _ => time,
            });
        }
        self.last = Some((time, now));
    }
}

impl Saved for Joint {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.last, &mut self.closed]);
    }
}

impl HeapSize for Joint {
    fn heap_size(&self) -> usize {
        self.ways.heap_size()
    }
}
