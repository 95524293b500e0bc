//! Days on which gaps of a ring close while groundwater crosses it, from a table for some numbers of pipes and velocities.

use std::f64::consts::TAU;

use frazil_core::balances::groundwater::ground::RelativePermeability;
use frazil_scene::Scene;

use crate::Unfit;
use crate::layouts::{Closure, Gap};
use crate::shaft::{RING_RADIUS, shaft_differences};
use crate::soils::SAND;
use crate::table::NumberTable;

/// Name of the table, as a layout asks for it.
pub const NAME: &str = "shaft-groundwater";

const TABLE: &str = include_str!("tables/shaft-groundwater.csv");
const DAY: f64 = 86_400.0;
/// Relative agreement of velocities and heat capacities with those of the table.
const SAME: f64 = 1e-3;
/// Heat capacity by volume of water there (J/m3K).
const WATER_HEAT: f64 = 4.19e6;
/// Radius of the pipes (m).
const PIPE_RADIUS: f64 = 0.054;

/// When gaps close in the scene; where its problem is none of the table, the first difference.
pub(crate) fn closures(scene: &Scene) -> Result<Vec<Closure>, Unfit> {
    let table = NumberTable::read(TABLE)?;
    let column = |name: &str| table.column(name);
    let (pipes, velocities) = (column("pipes")?, column("velocity_m_per_day")?);
    let count = scene.rings.first().map_or(0, |ring| ring.count);
    let rings = [(count, RING_RADIUS, 0.0)];
    if let Some(first) = shaft_differences(&SAND, &rings, Some(PIPE_RADIUS), true, scene).into_iter().next() {
        return Err(another(first));
    }
    let velocity = velocity(scene)?;
    let is_this =
        |row: &usize| pipes[*row] == count as f64 && (velocities[*row] - velocity).abs() <= SAME * velocities[*row];
    let (angles, days, errors) = (column("from_downstream_deg")?, column("day")?, column("error_day")?);
    let closure =
        |row: usize| Closure { gap: Gap::FromDownstream(angles[row]), day: days[row], error: Some(errors[row]) };
    let found: Vec<Closure> = (0..pipes.len()).filter(is_this).map(closure).collect();
    if found.is_empty() {
        let mut known: Vec<String> =
            pipes.iter().zip(velocities).map(|(pipes, velocity)| format!("{pipes} at {velocity}")).collect();
        known.dedup();
        let known = known.join(", ");
        return Err(another(format!("pipes at velocities (m/day) are {known} there and {count} at {velocity} here")));
    }
    Ok(found)
}

fn another(difference: String) -> Unfit {
    Unfit::another(NAME, vec![difference])
}

/// Darcy velocity (m a day) of the water, where it meets the ring as it does in the table.
fn velocity(scene: &Scene) -> Result<f64, Unfit> {
    let nothing = || another("water flows across the ring there".into());
    let flow = scene.flow.as_ref().ok_or_else(nothing)?;
    let (across, wall) = flow.across.zip(flow.walls.first()).ok_or_else(nothing)?;
    let (material, ring) = scene.materials.first().zip(scene.rings.first()).ok_or_else(nothing)?;
    if flow.relative_permeability != RelativePermeability::Power(1.0) {
        return Err(another("ground lets pass water in proportion to what is unfrozen there".into()));
    }
    let pores = material.pores.ok_or_else(nothing)?;
    let own = pores.water_density * pores.water_heat_capacity;
    if (own / WATER_HEAT - 1.0).abs() > SAME {
        return Err(another(format!("the heat capacity of water by volume is {WATER_HEAT} there and {own} here")));
    }
    let turns = (across.direction.y.atan2(across.direction.x) - ring.first_angle) * ring.count as f64 / TAU;
    if (turns - turns.round()).abs() > SAME {
        return Err(another("a pipe stands farthest downstream there".into()));
    }
    let constant = || another("the velocity of water is constant there".into());
    let pressure = wall.pressure.constant().ok_or_else(constant)?;
    let permeability = pores.permeability.ok_or_else(nothing)?;
    // Rounded, since it is shown.
    Ok((pressure * permeability / (flow.viscosity * across.radius) * DAY * 1e6).round() / 1e6)
}
