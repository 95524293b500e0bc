//! The instants of a run: outputs, and those on which steps must land.

use frazil_scene::Scene;

/// Output and profile instants and those at which something was measured, in order, the end included.
pub fn outputs(scene: &Scene) -> Vec<f64> {
    let outputs = scene.watch.outputs.max(1);
    let mut instants: Vec<f64> = (1..=outputs)
        .map(|k| if k == outputs { scene.duration } else { scene.duration * k as f64 / outputs as f64 })
        .chain(scene.watch.profiles.iter().copied())
        .chain(scene.watch.measured.iter().copied())
        .filter(|instant| *instant > 0.0 && *instant <= scene.duration)
        .collect();
    instants.sort_by(f64::total_cmp);
    // A profile wanted at an output is that output.
    instants.dedup_by(|later, earlier| *later - *earlier <= 1e-9 * scene.duration);
    if let Some(last) = instants.last_mut() {
        *last = scene.duration;
    }
    instants
}

/// Instants on which steps land whatever the walls do: all outputs or, where states between steps are known, those
/// alone at which whole profiles are kept, and the end.
pub fn stops(scene: &Scene, outputs: &[f64], dense: bool) -> Vec<f64> {
    if !dense {
        return outputs.to_vec();
    }
    let kept = scene.watch.profiles.iter().copied().filter(|instant| *instant > 0.0 && *instant < scene.duration);
    let mut stops: Vec<f64> = kept.chain([scene.duration]).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup();
    stops
}

/// The next instant after `time` at which steps land for what walls and pipes do: they are switched between steps, and
/// long steps, as those of unsaturated water always are, do not pass over a bend of their series.
pub fn next_turn(scene: &Scene, time: f64, dense: bool) -> f64 {
    let bend = if dense || scene.of_water { scene.next_bend(time) } else { None };
    scene.next_switch(time).into_iter().chain(bend).fold(f64::INFINITY, f64::min)
}
