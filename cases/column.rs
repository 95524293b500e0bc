//! The reference table of a column of soil that freezes from one end.

use frazil_core::boundary::condition::Condition;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_record::ReferenceInfo;
use frazil_scene::Scene;
use frazil_simulation::reference::Reference;

use crate::BadTable;
use crate::soils::Soil;
use crate::table::{NumberTable, compare, interpolate_square, wall_temperature};

/// Name of the table, as a scene file asks for it.
pub const NAME: &str = "soil-column";

/// Soil of the column of Chen and Bai 2016.
const COLUMN: Soil = Soil {
    density: 1800.0,
    frozen: (2.68, 2508.5),
    unfrozen: (3.05, 2124.0),
    freezing_point: -0.25,
    latent_heat: 33_500.0,
};

/// The front in a column of soil that freezes from one end.
#[derive(Debug, Clone)]
pub struct ColumnTable {
    /// Times (s), from zero.
    times: Vec<f64>,
    fronts: Vec<f64>,
}

/// Largest error of a front in the column (m).
const COLUMN_ERROR: f64 = 1e-6;

impl ColumnTable {
    /// The shipped table.
    ///
    /// # Errors
    ///
    /// If it cannot be read.
    pub fn bundled() -> Result<Self, BadTable> {
        let table = NumberTable::read(include_str!("tables/soil-column.csv"))?;
        let from_start = |name: &str| Ok::<_, BadTable>([&[0.0], table.column(name)?].concat());
        Ok(ColumnTable { times: from_start("time_s")?, fronts: from_start("front_m")? })
    }
}

impl Reference for ColumnTable {
    fn describe(&self) -> ReferenceInfo {
        let source = "table soil-column: sharp front, each phase on its own moving grid of finite volumes";
        ReferenceInfo::new("table", source, COLUMN_ERROR / self.fronts[1])
    }

    fn front(&self, t: f64) -> Option<f64> {
        interpolate_square(&self.times, &self.fronts, t)
    }
}

/// What about a scene is not as in the column.
pub fn differences(scene: &Scene) -> Vec<String> {
    let mut differences = COLUMN.differences(scene);
    if !scene.rings.is_empty() {
        differences.push("there are no freeze pipes there".into());
    }
    let ends: &[(WallId, WallId, f64)] = match scene.domain {
        Domain::Line { length } => &[(WallId::Left, WallId::Right, length)],
        Domain::Rectangle { width, height } => {
            &[(WallId::Left, WallId::Right, width), (WallId::Bottom, WallId::Top, height)]
        }
        Domain::Ring { .. } | Domain::Radial { .. } | Domain::Axial { .. } => &[],
    };
    let both = |&(first, second, length): &(WallId, WallId, f64)| [(first, second, length), (second, first, length)];
    let cold = ends.iter().flat_map(both).find(|end| wall_temperature(scene, end.0).is_some_and(|at| at < 0.0));
    let mut number = |what: &str, own: Option<f64>, expected: f64| compare(&mut differences, what, own, expected);
    number("the length", cold.map(|end| end.2), 0.2);
    number("the temperature of the cold end", cold.and_then(|end| wall_temperature(scene, end.0)), -5.0);
    number("the temperature of the other end", cold.and_then(|end| wall_temperature(scene, end.1)), 1.0);
    number("the initial temperature", Some(scene.initial_temperature), 1.0);
    if let Some((near, far, _)) = cold {
        let is_side = |wall: WallId| wall != near && wall != far;
        if !scene.wall_parts.is_empty() {
            differences.push("no wall is in parts there".into());
        }
        if scene.walls.iter().any(|wall| is_side(wall.wall) && wall.condition != Condition::Symmetry) {
            differences.push("the sides are insulated there".into());
        }
    }
    differences
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::Neumann;
    use frazil_core::physics::material::{FreezingLaw, Material, Mixing, Phase};

    #[test]
    fn the_column_starts_as_a_half_space() {
        let material = Material {
            name: "soil".into(),
            density: COLUMN.density,
            frozen: Phase { conductivity: COLUMN.frozen.0, heat_capacity: COLUMN.frozen.1 },
            unfrozen: Phase { conductivity: COLUMN.unfrozen.0, heat_capacity: COLUMN.unfrozen.1 },
            freezing_point: COLUMN.freezing_point,
            latent_heat: COLUMN.latent_heat,
            law: FreezingLaw::Isothermal,
            mixing: Mixing::Arithmetic,
            pores: None,
            soil: None,
        };
        let exact = Neumann::new(&material, -5.0, 1.0).expect("front");
        let table = ColumnTable::bundled().expect("table");
        for t in [100.0, 450.0, 900.0, 1200.0, 1800.0] {
            let (own, expected) = (table.front(t).expect("front"), exact.front(t).expect("front"));
            // The other end is not felt yet, so what differs is the table's own error.
            assert!((own - expected).abs() < 2.0 * COLUMN_ERROR, "{t} s: {own} against {expected}");
        }
        assert_eq!(table.front(216_001.0), None);
    }
}
