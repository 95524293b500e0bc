//! What a driven liquid is compared with: the parabola of a viscous stream, and heat that it carries along.
//!
//! The parabola is fitted to the measured velocities. Temperatures of its sections follow from it by marching along x:
//! second order across and along (Crank and Nicolson's rule after four backward steps of half the length), without
//! conduction along the stream, which is smaller by the square of the Peclet number. It knows nothing of particles.

use frazil_core::boundary::condition::Condition;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_record::{SectionRow, StreamRecord, StreamRow};
use frazil_scene::Scene;

/// Cells across and steps along: halving both moves no temperature by more than 1e-4 of the range.
const CELLS: usize = 160;
const STEPS: usize = 2000;

/// Judges a stream, and fills the reference's temperatures of its sections, where there are any.
pub fn judge(scene: &Scene, rows: &[StreamRow], sections: &mut [SectionRow]) -> Option<StreamRecord> {
    let (Some(stream), Domain::Rectangle { height, .. }) = (&scene.stream, scene.domain) else { return None };
    let (first, last) = (rows.first()?, rows.last()?);
    let half = 0.5 * height;
    let shape = |y: f64| 1.0 - ((y - half) / half).powi(2);
    let fitted = |value: &dyn Fn(&StreamRow) -> f64| rows.iter().map(value).sum::<f64>();
    let greatest = fitted(&|row| row.speed_m_per_s * shape(row.y_m)) / fitted(&|row| shape(row.y_m).powi(2));
    let square = fitted(&|row| (row.speed_m_per_s - greatest * shape(row.y_m)).powi(2)) / rows.len() as f64;
    let viscosity = stream.acceleration * half * half / (2.0 * greatest);
    if let Some(temperature) = carried(scene, greatest) {
        for row in sections.iter_mut() {
            row.temperature_ref_c = temperature(row.x_m, row.y_m);
        }
    }
    let (low, high) = scene.temperature_range();
    let errors: Vec<f64> =
        sections.iter().filter_map(|row| Some((row.temperature_c - row.temperature_ref_c?) / (high - low))).collect();
    let judged = !errors.is_empty();
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len().max(1) as f64).sqrt();
    Some(StreamRecord {
        greatest_speed_m_per_s: greatest,
        speed_rms_rel: square.sqrt() / greatest.abs(),
        kinematic_viscosity_m2_per_s: stream.is_even().then_some(viscosity),
        wall_density_rel: (first.density_rel - 1.0).abs().max((last.density_rel - 1.0).abs()),
        temperature_rms_rel: judged.then_some(rms),
        temperature_max_rel: judged.then(|| errors.iter().fold(0.0, |most, error| f64::max(most, error.abs()))),
    })
}

/// Temperature at a place (m) behind a region of reset of a stream that nothing freezes in and no wall of which changes.
fn carried(scene: &Scene, greatest: f64) -> Option<impl Fn(f64, f64) -> Option<f64>> {
    let stream = scene.stream.as_ref()?;
    let Domain::Rectangle { width, height } = scene.domain else { return None };
    let ((_, begin), start) = stream.reset?;
    let material = &scene.materials[0];
    let constant = scene.conditions().all(|condition| match condition {
        Condition::Symmetry | Condition::Periodic => true,
        Condition::Temperature(series) => !series.changes(),
        _ => false,
    });
    let liquid = material.latent_heat == 0.0 || scene.temperature_range().0 > material.freezing_point;
    if !constant || !liquid || greatest <= 0.0 || begin >= width {
        return None;
    }
    let wall = |wall: WallId, x: f64| match scene.wall_at(wall, x) {
        Some(Condition::Temperature(series)) => Some(series.at(0.0)),
        _ => None,
    };
    let diffusivity = material.unfrozen.conductivity / material.unfrozen_capacity();
    let cell = height / CELLS as f64;
    let step = (width - begin) / STEPS as f64;
    let speed = |k: usize| {
        let place = ((k as f64 + 0.5) / CELLS as f64 - 0.5) * 2.0;
        greatest * (1.0 - place * place)
    };
    let mut state = vec![start; CELLS];
    let mut columns = Vec::with_capacity(STEPS + 1);
    columns.push(state.clone());
    for k in 0..STEPS {
        let x = begin + (k as f64 + 0.5) * step;
        let walls = [wall(WallId::Bottom, x)?, wall(WallId::Top, x)?];
        let implicit = |state: &mut [f64], length: f64, theta: f64| {
            let ratio = |k: usize| diffusivity * length / (speed(k) * cell * cell);
            let change = |state: &[f64], k: usize| {
                let below = if k == 0 { 2.0 * (walls[0] - state[0]) } else { state[k - 1] - state[k] };
                let above = if k == CELLS - 1 { 2.0 * (walls[1] - state[k]) } else { state[k + 1] - state[k] };
                below + above
            };
            let right: Vec<f64> = (0..CELLS).map(|k| state[k] + (1.0 - theta) * ratio(k) * change(state, k)).collect();
            solve(state, &right, |k| theta * ratio(k), walls);
        };
        if k < 2 {
            // The jump at the walls would ring.
            implicit(&mut state, 0.5 * step, 1.0);
            implicit(&mut state, 0.5 * step, 1.0);
        } else {
            implicit(&mut state, step, 0.5);
        }
        columns.push(state.clone());
    }
    Some(move |x: f64, y: f64| {
        let along = (x - begin) / step;
        if !(0.0..=STEPS as f64).contains(&along) {
            return None;
        }
        let (k, part) = ((along as usize).min(STEPS - 1), along - along.floor());
        let place = (y / cell - 0.5).clamp(0.0, (CELLS - 1) as f64);
        let (row, share) = ((place as usize).min(CELLS - 2), place - (place as usize).min(CELLS - 2) as f64);
        let at = |column: &[f64]| column[row] + share * (column[row + 1] - column[row]);
        Some(at(&columns[k]) + part * (at(&columns[k + 1]) - at(&columns[k])))
    })
}

/// Solves `(1 + 2 r) T - r (T below + T above) = right` for a column, with walls half a cell beyond its ends.
fn solve(state: &mut [f64], right: &[f64], ratio: impl Fn(usize) -> f64, walls: [f64; 2]) {
    let count = state.len();
    let mut upper = vec![0.0; count];
    let mut value = vec![0.0; count];
    for k in 0..count {
        let r = ratio(k);
        let ends = usize::from(k == 0) + usize::from(k == count - 1);
        let mut diagonal = 1.0 + 2.0 * r + r * ends as f64;
        let mut sum = right[k];
        sum += if k == 0 { 2.0 * r * walls[0] } else { 0.0 };
        sum += if k == count - 1 { 2.0 * r * walls[1] } else { 0.0 };
        if k > 0 {
            diagonal -= r * upper[k - 1];
            sum += r * value[k - 1];
        }
        upper[k] = r / diagonal;
        value[k] = sum / diagonal;
    }
    state[count - 1] = value[count - 1];
    for k in (0..count - 1).rev() {
        state[k] = value[k] + upper[k] * state[k + 1];
    }
}
