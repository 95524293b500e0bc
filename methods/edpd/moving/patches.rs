//! What the walls of a body of moving particles hold.

use frazil_core::boundary::condition::Condition;
use frazil_core::series::Series;
use frazil_core::space::wall::{PatchId, WallId};
use frazil_scene::Scene;

use super::map::DpdUnits;
use super::place::LiquidBody;
use crate::fluid::Behind;

/// Walls of the box, by their sides.
const WALLS: [WallId; 4] = [WallId::Left, WallId::Right, WallId::Bottom, WallId::Top];

/// Walls in their order, then their parts.
pub struct WallPatches {
    /// Temperature of each over time; none where it is insulated.
    pub temperatures: Vec<Option<Series>>,
    /// Which they are.
    pub ids: Vec<PatchId>,
}

impl WallPatches {
    /// The patches of a scene; particles behind a part of a wall are made its own.
    pub fn of(scene: &Scene, body: &LiquidBody, map: &DpdUnits, behind: &mut [Behind<2>]) -> Self {
        let temperature = |condition: Option<&Condition>| match condition {
            Some(Condition::Temperature(series)) => Some(series.clone()),
            _ => None,
        };
        let mut patches = WallPatches { temperatures: vec![None; WALLS.len()], ids: WALLS.map(PatchId::Whole).into() };
        for wall in WALLS.into_iter().filter(|wall| body.walled[usize::from(wall.is_across_y())]) {
            patches.temperatures[wall.side()] = temperature(scene.wall(wall));
        }
        for (k, part) in scene.wall_parts.iter().enumerate() {
            patches.ids.push(PatchId::Part(part.wall, k));
            patches.temperatures.push(temperature(Some(&part.condition)));
            let along = usize::from(!part.wall.is_across_y());
            for behind in &mut *behind {
                let place = behind.image[along].rem_euclid(body.lengths[along]) * map.length;
                let of_wall = patches.ids[behind.patch as usize].wall() == Some(part.wall);
                if of_wall && place >= part.from && place < part.to {
                    behind.patch = (WALLS.len() + k) as u32;
                }
            }
        }
        patches
    }
}
