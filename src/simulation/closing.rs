//! The earliest time at which a wall can close, known before any step.
//!
//! Around a point that is a distance `a` from all pipes lies a disc of radius `a` without one. It freezes at its centre not before a disc
//! does whose rim is as cold as the coldest pipe, whose ground starts at the freezing point and stores nothing but latent heat: that is
//! when `4 k/L` times the integral of the coldness is `a^2`. So what is frozen lies within `2 sqrt(k/L integral)` of the pipes, and
//! bodies of that size have to surround the centre. Where ground conducts by direction, `k` is the mean of both directions. Real walls take several times as long: ground is warm, and stores heat.

use frazil_core::boundary::condition::Condition;
use frazil_core::physics::material::Material;
use frazil_scene::{PipeRing, Scene};
use glam::DVec2;

use crate::observers::loops::{closure, neighbours};

/// Pieces of the time over which the coldness of pipes is summed.
const PIECES: usize = 4000;

/// Seconds of a day.
const DAY: f64 = 86400.0;

/// Why a shaft cannot be dug when the scene wants it.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum DugTooEarly {
    /// No wall closes at all.
    #[error("excavation: the pipes do not surround the shaft, so no wall closes around it")]
    NotAround,
    /// The wall is known to be open then.
    #[error(
        "excavation: the shaft is excavated on day {:.1}, but the wall {}: two pipes stand {apart:.2} m apart, and columns that take \
         up nothing but latent heat reach {reach:.2} m",
        .start / DAY,
        .closes.map_or("cannot close in this run".to_owned(), |time| format!("cannot close before day {:.1}", time / DAY))
    )]
    Open {
        /// When it is dug (s).
        start: f64,
        /// Before when the wall cannot close (s), if it can in this run.
        closes: Option<f64>,
        /// How far two pipes stand apart (m).
        apart: f64,
        /// How far columns reach (m).
        reach: f64,
    },
}

/// Looks whether a wall may stand when the shaft is dug.
///
/// # Errors
/// If it is known to be open then.
pub fn in_time(scene: &Scene) -> Result<(), DugTooEarly> {
    let Some(shaft) = &scene.excavation else { return Ok(()) };
    // What varies at random may conduct better than any material by as much as it likes.
    let varies = scene.random.conductivity.is_some();
    // Pipes of given heat get as cold as that takes.
    let without_bound = scene.rings.iter().any(|ring| ring.condition.heat().is_some());
    if scene.rings.is_empty() || without_bound || scene.flow.is_some() || varies || has_other_cold(scene) {
        return Ok(());
    }
    let places: Vec<(DVec2, f64)> =
        scene.rings.iter().flat_map(|ring| ring.numbers().map(|k| (ring.place(k), ring.pipe_radius))).collect();
    let apart = widest(&places).ok_or(DugTooEarly::NotAround)?;
    let diffusion = diffusion(scene);
    let reach = |time: f64| 2.0 * (diffusion * coldness(scene, time)).sqrt();
    if !diffusion.is_finite() || 2.0 * reach(shaft.start) >= apart {
        return Ok(());
    }
    let mut times = (1..=PIECES).map(|k| scene.duration * k as f64 / PIECES as f64);
    let closes = times.find(|time| 2.0 * reach(*time) >= apart);
    Err(DugTooEarly::Open { start: shaft.start, closes, apart, reach: reach(shaft.start) })
}

/// Whether anything but pipes may freeze ground.
fn has_other_cold(scene: &Scene) -> bool {
    let least = scene.materials.iter().map(|material| material.freezing_point).fold(f64::INFINITY, f64::min);
    let cold = |condition: &Condition| match condition {
        Condition::Temperature(series) | Condition::Film { ambient: series, .. } => series.range().0 <= least,
        Condition::Flux(flux) => flux.range().0 < 0.0,
        Condition::Symmetry | Condition::Periodic | Condition::Runoff { .. } | Condition::FreeDrainage => false,
        Condition::Exact => true,
    };
    let starts = scene.regions.iter().filter_map(|region| region.temperature).chain([scene.initial_temperature]);
    starts.fold(f64::INFINITY, f64::min) <= least || scene.walls.iter().any(|wall| cold(&wall.condition))
}

/// The clear width (m) that columns must bridge at the widest of the gaps that a wall cannot do without; none where pipes do not
/// surround the centre.
fn widest(places: &[(DVec2, f64)]) -> Option<f64> {
    let stand: Vec<DVec2> = places.iter().map(|place| place.0).collect();
    let clear = |[a, b]: [usize; 2]| stand[a].distance(stand[b]) - places[a].1 - places[b].1;
    closure(&stand, neighbours(&stand).into_iter().map(|ends| (ends, clear(ends))).collect())
}

/// Conductivity over the latent heat that ground gives off until it counts as frozen (m2/sK), of the ground that freezes fastest.
/// Without latent heat it is without bound.
fn diffusion(scene: &Scene) -> f64 {
    let of = |material: &Material| {
        let half = if material.is_sharp() { 1.0 } else { 0.5 };
        material.frozen.conductivity.max(material.unfrozen.conductivity) / (half * material.volumetric_latent_heat())
    };
    0.5 * (scene.along.x + scene.along.y) * scene.materials.iter().map(of).fold(0.0, f64::max)
}

/// Integral of the coldness of the coldest pipe so far (K s), below the warmest freezing point.
fn coldness(scene: &Scene, time: f64) -> f64 {
    let freezing = scene.materials.iter().map(|material| material.freezing_point).fold(f64::NEG_INFINITY, f64::max);
    let cold = |ring: &PipeRing, time: f64| {
        let works = ring.schedule.as_ref().is_none_or(|schedule| schedule.works(time));
        let temperature = ring.condition.temperature().filter(|_| works);
        temperature.map_or(0.0, |series| (freezing - series.at(time)).max(0.0))
    };
    let piece = time / PIECES as f64;
    let mut coldest: f64 = 0.0;
    (0..=PIECES)
        .map(|k| {
            let now = k as f64 * piece;
            coldest = scene.rings.iter().map(|ring| cold(ring, now)).fold(coldest, f64::max);
            coldest * piece
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_widest_gap_of_a_wall_is_that_of_its_best_loop() {
        let ring = |count: usize, radius: f64| {
            let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
            (0..count).map(move |k| (radius * DVec2::from_angle(angle(k)), 0.1)).collect::<Vec<_>>()
        };
        let chord = |count: usize, radius: f64| 2.0 * radius * (std::f64::consts::PI / count as f64).sin();
        let own = widest(&ring(12, 5.0)).expect("a loop");
        assert!((own - (chord(12, 5.0) - 0.2)).abs() < 1e-12);
        // A second ring of more pipes closes before the first.
        let both = [ring(12, 5.0), ring(24, 4.0)].concat();
        assert!((widest(&both).expect("a loop") - (chord(24, 4.0) - 0.2)).abs() < 1e-12);
        assert_eq!(widest(&ring(12, 5.0)[..5]), None);
    }
}
