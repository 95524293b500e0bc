//! What is read of the ground between two places, of which observers of a run share what is read between the same.

use std::cell::RefCell;
use std::sync::Arc;

use frazil_core::memory::HeapSize;
use frazil_scene::Scene;
use glam::DVec2;

use super::neck::Neck;
use super::sampler::{Sample, Sampler};

/// Two places that are the same, over the size of the plan.
pub(super) const SAME_PLACE: f64 = 1e-9;

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
    pub(super) fn greatest(&self, known: f64, value: impl Fn(&Sample) -> f64) -> f64 {
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
pub(super) enum Reading {
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
    pub(super) fn between(&self, places: [DVec2; 2], scene: &Scene, sampler: &Sampler<'_>) -> (Arc<Reading>, bool) {
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
