//! Water that flows steadily into a half space brings its temperature along (Ogata and Banks 1961).

use frazil_core::boundary::condition::Condition;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_record::ReferenceInfo;
use frazil_scene::Scene;
use frazil_simulation::reference::Reference;

use super::Unsolved;
use super::functions::erfcx;
use crate::table::wall_temperature;

/// Estimated relative error: library error functions.
const ERROR: f64 = 1e-13;

/// Greatest change of temperature that the half space may show at the far wall, over that at the near one.
const FAR_WALL: f64 = 1e-3;

/// Heat that moves with a velocity and spreads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OgataBanks {
    /// Velocity of heat (m/s): that of water by the ratio of heat capacities.
    velocity: f64,
    /// Diffusivity (m2/s).
    diffusivity: f64,
    wall: f64,
    initial: f64,
    length: f64,
    /// Whether distances of the scene count from the far wall.
    turned: bool,
}

impl OgataBanks {
    /// The solution of a scene: a line of one porous material that does not freeze, into which water flows at a constant
    /// temperature under constant pressures.
    ///
    /// # Errors
    ///
    /// If the scene is none of these, or its far wall is felt.
    pub fn of_scene(scene: &Scene) -> Result<Self, Unsolved> {
        let Domain::Line { length } = scene.domain else {
            return Err(Unsolved::NotALine);
        };
        let flow = scene.flow.as_ref().ok_or(Unsolved::NoWater)?;
        let [material] = scene.materials.as_slice() else { return Err(Unsolved::SeveralMaterials) };
        let pores = material.pores.ok_or(Unsolved::NoPores)?;
        let pressure = |name: WallId| {
            let wall = flow.walls.iter().find(|wall| wall.wall == name).ok_or(Unsolved::NoPressure(name))?;
            wall.pressure.constant().ok_or(Unsolved::PressureChanges(name))
        };
        let drop = pressure(WallId::Left)? - pressure(WallId::Right)?;
        let (near, far) = if drop > 0.0 { (WallId::Left, WallId::Right) } else { (WallId::Right, WallId::Left) };
        let wall = wall_temperature(scene, near).ok_or(Unsolved::WallChanges(near))?;
        let initial = scene.initial_temperature;
        if scene.temperature_range().0 < material.freezing_point && material.volumetric_latent_heat() > 0.0 {
            return Err(Unsolved::Freezes);
        }
        let permeability = pores.permeability.ok_or(Unsolved::NoPermeability)?;
        let water = permeability / flow.viscosity * drop.abs() / length;
        let capacity = material.unfrozen_capacity();
        let solution = OgataBanks {
            velocity: water * pores.water_density * pores.water_heat_capacity / capacity,
            diffusivity: material.unfrozen.conductivity / capacity,
            wall,
            initial,
            length,
            turned: scene.freezing_direction().is_some_and(|direction| direction.from_end) != (near == WallId::Right),
        };
        let change = solution.share(length, scene.duration);
        let still = match scene.wall(far) {
            Some(Condition::Symmetry) => true,
            _ => wall_temperature(scene, far) == Some(initial),
        };
        if !still || change > FAR_WALL {
            return Err(Unsolved::ColumnEnds(change));
        }
        Ok(solution)
    }

    /// Share of the wall's temperature at a distance (m) from it and a time (s).
    fn share(&self, x: f64, t: f64) -> f64 {
        let width = 2.0 * (self.diffusivity * t).sqrt();
        let (behind, ahead) = ((x - self.velocity * t) / width, (x + self.velocity * t) / width);
        // exp(v x / a) erfc(ahead) without overflow, at any ratio of both.
        0.5 * (libm::erfc(behind) + libm::exp(-behind * behind) * erfcx(ahead))
    }
}

impl Reference for OgataBanks {
    fn describe(&self) -> ReferenceInfo {
        let source = "Ogata and Banks 1961, a half space into which water flows";
        ReferenceInfo::new("exact", source, ERROR)
    }

    fn temperature(&self, x: f64, t: f64) -> Option<f64> {
        let x = if self.turned { self.length - x } else { x };
        Some(self.initial + (self.wall - self.initial) * self.share(x, t))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of a table computed with other libraries, for the numbers of Nikolaev et al. 2021, section 5.2.
    #[test]
    fn the_column_of_the_paper() {
        let column = OgataBanks {
            velocity: 2.5e-5,
            diffusivity: 0.6 / 4_182_000.0,
            wall: 5.0,
            initial: 40.0,
            length: 0.4,
            turned: false,
        };
        for (x, t, expected) in [
            (0.0, 1800.0, 5.0),
            (0.03, 1800.0, 10.760_179_046_007_686),
            (0.05, 3600.0, 7.323_100_041_755_7),
            (0.05, 7200.0, 5.029_554_647_987_851),
        ] {
            let found = column.temperature(x, t).expect("a temperature");
            assert!((found - expected).abs() < 1e-11, "{x} {t}: {found}, must be {expected}");
        }
        // At a Peclet number of a million exp(v x / a) has no number, but the front is where the water is.
        let fast = OgataBanks { velocity: 1.0, diffusivity: 1e-7, ..column };
        assert!((fast.share(0.3, 0.3) - 0.5).abs() < 1e-3 && fast.share(0.31, 0.3) < 1e-12);
    }
}
