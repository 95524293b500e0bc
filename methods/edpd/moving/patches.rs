//! What the walls of a body of moving particles hold.

use frazil_core::boundary::condition::Condition;
use frazil_core::series::Series;
use frazil_scene::Scene;

use super::map::DpdUnits;
use super::place::{LiquidBody, WALLS, wall};
use crate::fluid::Behind;

/// Walls in their order, then their parts.
pub struct WallPatches {
    /// Temperature of each over time; none where it is insulated.
    pub temperatures: Vec<Option<Series>>,
    /// Their names in the ledger.
    pub names: Vec<String>,
}

impl WallPatches {
    /// The patches of a scene; particles behind a part of a wall are made its own.
    pub fn of(scene: &Scene, body: &LiquidBody, map: &DpdUnits, behind: &mut [Behind<2>]) -> Self {
        let temperature = |condition: Option<&Condition>| match condition {
            Some(Condition::Temperature(series)) => Some(series.clone()),
            _ => None,
        };
        let mut patches = WallPatches { temperatures: vec![None; WALLS.len()], names: WALLS.map(str::to_owned).into() };
        for (axis, end) in [(0, false), (0, true), (1, false), (1, true)] {
            if body.walled[axis] {
                let patch = wall(axis, end);
                patches.temperatures[patch] = temperature(scene.wall(WALLS[patch]));
            }
        }
        for (k, part) in scene.wall_parts.iter().enumerate() {
            patches.names.push(format!("{}_part_{}", part.wall, k + 1));
            patches.temperatures.push(temperature(Some(&part.condition)));
            let Some(whole) = WALLS.iter().position(|name| *name == part.wall) else { continue };
            let along = usize::from(whole < 2);
            for behind in &mut *behind {
                let place = behind.image[along].rem_euclid(body.lengths[along]) * map.length;
                let own = behind.patch as usize;
                let of_wall = own == whole
                    || own.checked_sub(WALLS.len()).is_some_and(|other| scene.wall_parts[other].wall == part.wall);
                if of_wall && place >= part.from && place < part.to {
                    behind.patch = (WALLS.len() + k) as u32;
                }
            }
        }
        patches
    }
}
