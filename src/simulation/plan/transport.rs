//! A solute beside unsaturated water: pairs along which it goes, and what advances both.

use std::sync::Arc;

use frazil_core::balances::solute::{Entering, Solute, SoluteParts};
use frazil_core::boundary::condition::Condition;
use frazil_core::boundary::patch::Patch;
use frazil_core::kernels::flows::PairFlows;
use frazil_core::kernels::list_parts::ListParts;
use frazil_core::physics::latent_heat::{Materials, scheme};
use frazil_core::solvers::heun::Heun;
use frazil_core::solvers::solver::Solver;
use frazil_core::solvers::transport::Transport;
use frazil_core::team::Team;
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;
use frazil_scene::region::Cell;
use glam::DVec2;

use crate::plan::bonds::list;
use crate::plan::prepared::Prepared;
use crate::refused::Refused;

/// What particles hold of a solute at the start, and what advances it beside water.
pub(super) fn transport(
    scene: &Scene,
    settings: &MethodSettings,
    prepared: &mut Prepared,
    water: Box<dyn Solver>,
    team: Option<Team>,
) -> Result<Box<dyn Solver>, Refused> {
    let Some((solute, own)) = scene.solute.as_ref().zip(settings.numerics.solute) else { return Ok(water) };
    if let Some(in_parts) = prepared.in_parts.take() {
        prepared.boundary = in_parts;
    }
    let (parts, _) = list(scene, settings, prepared, team)?;
    let of = |patch: &Patch| {
        let own = solute.walls.iter().find(|wall| wall.patch == patch.id);
        // Rain brings what is dissolved in it, and nothing diffuses up into the air.
        let diffuses = !matches!(patch.condition, Condition::Runoff { .. });
        own.map(|wall| Entering { concentration: wall.concentration.clone(), diffuses })
    };
    let walls = parts.boundary.patches.iter().map(of).collect();
    let count = prepared.count();
    let numerics = &settings.numerics;
    let choice = scheme(numerics.latent_heat_scheme, numerics.mushy, &prepared.materials, &prepared.start, count);
    let flows = PairFlows::new(parts.clone(), choice);
    let saturated = saturated(&prepared.materials, count);
    let contents: Vec<f64> = saturated.iter().zip(prepared.enthalpies()).map(|(full, held)| full + held).collect();
    let materials = scene.materials.iter().filter_map(|material| material.soil.as_ref()?.solute).collect();
    // A solute diffuses through ground that varies as through its materials; the water that carries it knows better.
    let parts = ListParts { factors: Arc::new([]), ..parts };
    let parts = SoluteParts { list: parts, materials, walls, advection: own.advection };
    let balance = Solute::new(parts, &contents)?;
    prepared.solute = (0..count)
        .map(|i| balance.content(i, starts(scene, solute, prepared.place(i), prepared.lattice.spacing), 0.0))
        .collect();
    let solver = Box::new(Heun::new(Box::new(balance), own.fraction, count));
    Ok(Box::new(Transport::new(water, solver, flows, saturated, (own.coupling, own.fraction))))
}

/// The concentration with which a particle starts.
fn starts(scene: &Scene, solute: &frazil_scene::Solute, place: DVec2, spacing: f64) -> f64 {
    let mut concentration = solute.initial;
    for (region, own) in scene.regions.iter().zip(&solute.regions) {
        if let Some(own) = own {
            let share = region.shape.share_of(&Cell::around(place, spacing));
            concentration += share * (own - concentration);
        }
    }
    concentration
}

/// Water contents from which the contents of particles count.
fn saturated(materials: &Materials, count: usize) -> Vec<f64> {
    let of = |i: usize| {
        let thermal = materials.of(i);
        let saturated = thermal.curve.moisture().map_or(0.0, |moisture| moisture.soil().saturated);
        saturated + thermal.zero_enthalpy
    };
    (0..count).map(of).collect()
}
