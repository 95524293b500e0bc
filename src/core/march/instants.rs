//! The instants of a run: outputs, and those on which steps must land.

use crate::scene::{Condition, Scene, Series};

/// Output and profile instants in order, the end included.
pub fn outputs(scene: &Scene) -> Vec<f64> {
    let outputs = scene.watch.outputs.max(1);
    let mut instants: Vec<f64> = (1..=outputs)
        .map(|k| if k == outputs { scene.duration } else { scene.duration * k as f64 / outputs as f64 })
        .chain(scene.watch.profiles.iter().copied())
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

/// Instants at which a series of the scene bends, in order: steps must land there.
pub fn bends(scene: &Scene) -> Vec<f64> {
    let mut bends = Vec::new();
    let mut add = |series: &Series| {
        if let Series::Table(rows) = series {
            bends.extend(rows.iter().map(|row| row.0).filter(|time| *time > 0.0 && *time < scene.duration));
        }
    };
    for wall in &scene.walls {
        match &wall.condition {
            Condition::Temperature(series) | Condition::Flux(series) => add(series),
            Condition::Convection { coefficient, ambient } => {
                add(coefficient);
                add(ambient);
            }
            Condition::Symmetry | Condition::Exact => {}
        }
    }
    scene.rings.iter().for_each(|ring| add(&ring.temperature));
    bends.sort_by(f64::total_cmp);
    bends.dedup();
    bends
}

/// Instants on which steps land: the bends, all outputs or, where states between steps are known, those alone at which
/// whole profiles are kept, and the end.
pub fn stops(scene: &Scene, outputs: &[f64], dense: bool) -> Vec<f64> {
    let mut stops = bends(scene);
    let wanted = |instant: &f64| (0.0..scene.duration).contains(instant);
    stops.extend(if dense { scene.watch.profiles.as_slice() } else { outputs }.iter().copied().filter(wanted));
    stops.push(scene.duration);
    stops.sort_by(f64::total_cmp);
    stops.dedup();
    stops
}
