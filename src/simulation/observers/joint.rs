//! Two frozen bodies that join once a way between them is frozen through, and when.

use std::cell::RefCell;
use std::sync::Arc;

use frazil_core::memory::HeapSize;
use frazil_core::particles::Particles;
use frazil_core::saved::{Pass, Saved};
use frazil_scene::Scene;
use glam::DVec2;

use super::neck::Neck;
use super::observer::{Fractions, Setup, View};
use super::sampler::{Sample, Sampler};
use super::wall::SAME_PLACE;

/// Whether the ground of a scene freezes at one temperature.
pub(super) fn is_sharp(scene: &Scene) -> bool {
    scene.materials[0].is_sharp()
}

/// Bends of ways that are tried to either side of the straight one, at most.
const MOST_BENDS: f64 = 16.0;

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

/// What tells whether two frozen bodies have joined.
#[derive(Debug)]
enum Reading {
    /// Ways of which the first to freeze joins them.
    Ways(Vec<Way>),
    /// The width of open ground between them.
    Neck(Neck),
}

impl HeapSize for Reading {
    fn heap_size(&self) -> usize {
        match self {
            Reading::Ways(ways) => ways.heap_size(),
            Reading::Neck(neck) => neck.heap_size(),
        }
    }
}

/// Whether two lines of a scene are the same, in whichever direction.
pub(super) fn is_same(line: [DVec2; 2], other: [DVec2; 2], scene: &Scene) -> bool {
    let same = |a: DVec2, b: DVec2| a.distance(b) <= SAME_PLACE * scene.domain.extent();
    (same(line[0], other[0]) && same(line[1], other[1])) || (same(line[0], other[1]) && same(line[1], other[0]))
}

/// Readings between pairs of places, which the observers of a run share.
#[derive(Debug, Default)]
pub(crate) struct Readings(RefCell<Vec<([DVec2; 2], Arc<Reading>)>>);

impl Readings {
    /// The one between two places, and whether it is new.
    fn between(&self, places: [DVec2; 2], scene: &Scene, sampler: &Sampler<'_>) -> (Arc<Reading>, bool) {
        let mut known = self.0.borrow_mut();
        if let Some((_, reading)) = known.iter().find(|(other, _)| is_same(*other, places, scene)) {
            return (reading.clone(), false);
        }
        let reading = Arc::new(match is_sharp(scene) {
            true => Reading::Neck(Neck::between(places, sampler)),
            false => Reading::Ways(ways(places, sampler)),
        });
        known.push((places, reading.clone()));
        (reading, true)
    }
}

/// Two frozen bodies that join.
#[derive(Debug, Clone)]
pub(super) struct Joint {
    reading: Arc<Reading>,
    /// Whether it is the first with its reading.
    is_first: bool,
    /// Time and openness at the last look: positive while open.
    last: Option<(f64, f64)>,
    pub(super) closed: Option<f64>,
}

impl Joint {
    /// Of what is frozen around two pipes.
    pub(super) fn between(pipes: [DVec2; 2], setup: &Setup<'_>, sampler: &Sampler<'_>) -> Self {
        let (reading, is_first) = setup.readings.between(pipes, setup.scene, sampler);
        Joint { reading, is_first, last: None, closed: None }
    }

    /// At a place.
    pub(super) fn at(way: Way) -> Self {
        Joint { reading: Arc::new(Reading::Ways(vec![way])), is_first: true, last: None, closed: None }
    }

    /// How far it is from being closed, in the ground as it is: positive while open. `sharp`: it freezes at one temperature.
    fn openness_in(&self, particles: &Particles, fractions: &Fractions, sharp: bool) -> f64 {
        let ways = match &*self.reading {
            Reading::Neck(neck) => {
                return neck.width(|i| fractions.of_one(particles, i), || fractions.of(particles));
            }
            Reading::Ways(ways) => ways,
        };
        match sharp {
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
    pub(super) fn is_open(&self, particles: &Particles, fractions: &Fractions, sharp: bool) -> bool {
        match &*self.reading {
            Reading::Neck(neck) => !neck.has_met(|i| fractions.of_one(particles, i), || fractions.of(particles)),
            Reading::Ways(_) => self.openness_in(particles, fractions, sharp) > 0.0,
        }
    }

    /// Whether it was open at the last look and is closed now.
    pub(super) fn closes(&self, particles: &Particles, fractions: &Fractions, sharp: bool) -> bool {
        self.closed.is_none() && self.openness_in(particles, fractions, sharp) <= 0.0
    }

    /// Looks at the ground, unless it is closed.
    pub(super) fn look(&mut self, view: &View<'_>, sharp: bool) {
        if self.closed.is_none() {
            self.take(view.time, self.openness_in(view.particles, &view.fractions, sharp));
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
        self.last = Some((time, now));
    }
}

/// Ways from one pipe to another: straight to a point half-way between both, and straight on.
fn ways([a, b]: [DVec2; 2], sampler: &Sampler<'_>) -> Vec<Way> {
    let step = 0.5 * sampler.lattice.spacing;
    let (middle, across) = (0.5 * (a + b), 0.5 * (b - a).perp());
    let count = (across.length() / step).ceil().min(MOST_BENDS) as i64;
    let leg = |from: DVec2, to: DVec2| {
        let pieces = (from.distance(to) / step).ceil() as i64;
        (0..pieces).map(move |k| from.lerp(to, k as f64 / pieces as f64))
    };
    let way = |bend: DVec2| {
        let rest = leg(bend, a).chain(leg(bend, b)).map(|place| sampler.sample(place)).collect();
        Way::Through(sampler.sample(bend), rest)
    };
    (-count..=count).map(|k| way(middle + k as f64 / count as f64 * across)).collect()
}

/// How far the first of ways to freeze is from it.
fn openness(ways: &[Way], value: impl Fn(&Sample) -> f64) -> f64 {
    ways.iter().fold(f64::INFINITY, |least, way| least.min(way.greatest(least, &value)))
}

impl Saved for Joint {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.last, &mut self.closed]);
    }
}

impl HeapSize for Joint {
    fn heap_size(&self) -> usize {
        if self.is_first { self.reading.heap_size() } else { 0 }
    }
}
