//! Freezing of a corner between two cold walls.

use std::f64::consts::SQRT_2;

use frazil_core::space::domain::Domain;
use frazil_record::ReferenceInfo;
use frazil_scene::Scene;
use frazil_simulation::reference::Reference;

use crate::Unfit;
use crate::table::{NumberTable, wall_temperature};

/// Name of the table, as a scene file asks for it.
pub const NAME: &str = "corner-front";

const TEXT: &str = include_str!("tables/corner-front.csv");

/// Stefan number, and how far the start is above freezing over how far the walls are below it, that the table is about.
const STEFAN: f64 = 0.222;
const START: f64 = 2.0;

/// Relative difference of these numbers that moves the front by less than the table is known: 0.2 % of the Stefan number
/// moves it by 0.1 %.
const SAME: f64 = 2e-3;

/// Fourier number, by half the shorter side, up to which opposite walls are not felt on the diagonal: the paper's time of 21
/// in a square of 30.
const LATEST: f64 = 1.1 * 21.0 / 225.0;

/// The similarity solution of a corner.
#[derive(Debug, Clone)]
pub struct Corner {
    /// Distance of the front from either wall on the diagonal, over root(4 alpha t).
    diagonal: f64,
    diffusivity: f64,
    /// Time (s) up to which a body is two walls of infinite length to it.
    latest: f64,
}

impl Corner {
    /// The solution.
    ///
    /// # Errors
    ///
    /// If the scene is not about it.
    pub fn of_scene(scene: &Scene) -> Result<Self, Unfit> {
        let mut differences = Vec::new();
        let Domain::Rectangle { width, height } = scene.domain else {
            return Err(Unfit::another(NAME, vec!["the domain is no rectangle".into()]));
        };
        if scene.materials.len() != 1 || !scene.is_uniform() {
            differences.push("the body is not of one material at one temperature".into());
        }
        if !scene.wall_parts.is_empty() {
            differences.push("walls are in parts".into());
        }
        let material = &scene.materials[0];
        let same = material.frozen == material.unfrozen;
        if !same {
            differences.push("the phases differ".into());
        }
        let mut walls = scene.walls.iter().map(|wall| wall_temperature(scene, wall.wall));
        let first = walls.next().flatten();
        let cold = first.filter(|first| walls.all(|other| other == Some(*first)) && *first < material.freezing_point);
        let Some(cold) = cold else {
            differences.push("the walls are not held at one temperature below freezing".into());
            return Err(Unfit::another(NAME, differences));
        };
        let below = material.freezing_point - cold;
        let stefan = material.unfrozen.heat_capacity * below / material.latent_heat;
        let start = (scene.initial_temperature - material.freezing_point) / below;
        for (what, found, wanted) in [("Stefan number", stefan, STEFAN), ("start", start, START)] {
            if (found / wanted - 1.0).abs() > SAME {
                differences.push(format!("the {what} is {found:.4} instead of {wanted}"));
            }
        }
        Unfit::unless_same(NAME, differences)?;
        let diagonal = NumberTable::read(TEXT)?.column("x_star")?[0];
        let diffusivity = material.unfrozen.conductivity / (material.density * material.unfrozen.heat_capacity);
        let half = 0.5 * width.min(height);
        Ok(Corner { diagonal, diffusivity, latest: LATEST * half * half / diffusivity })
    }
}

impl Reference for Corner {
    fn describe(&self) -> ReferenceInfo {
        ReferenceInfo::new("table", "similarity solution of a freezing corner, enthalpy finite volumes", 1e-3)
    }

    fn front(&self, t: f64) -> Option<f64> {
        (t <= self.latest).then(|| SQRT_2 * self.diagonal * (4.0 * self.diffusivity * t).sqrt())
    }
}
