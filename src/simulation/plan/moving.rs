//! Plans of particles that move.

use std::sync::Arc;

use frazil_core::memory::{HeapSize, Memory};
use frazil_core::particles::{Particles, Places};
use frazil_core::physics::latent_heat::Materials;
use frazil_core::solvers::moving::ParticleSet;
use frazil_core::solvers::solver::SolverReport;
use frazil_core::space::lattice::Lattice;
use frazil_core::space::volumes::Volumes;
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;
use glam::DVec2;

use crate::plan::steps::choose_step;
use crate::plan::{Plan, PlanSummary};
use crate::predict::{StepCount, planned_steps};
use crate::refused::Refused;

/// The plan of a scene whose particles move.
pub(super) fn plan(scene: &Scene, settings: &MethodSettings, set: ParticleSet) -> Result<Plan, Refused> {
    let numerics = &settings.numerics;
    let ParticleSet { thermal, enthalpy, volume, differences, mut method } = set;
    let SolverReport { bound, pairs, .. } = method.report();
    let step = choose_step(numerics, &bound, scene)?;
    let count = enthalpy.len();
    let mut particles = Particles {
        solute: Vec::new(),
        concentration: Vec::new(),
        factors: Arc::new([]),
        start: if scene.has_uneven_start() { enthalpy.as_slice().into() } else { Arc::new([]) },
        enthalpy,
        places: Places::Cloud(vec![DVec2::ZERO; count].into()),
        velocity: vec![DVec2::ZERO; count],
        lattice: Arc::new(Lattice::new(&scene.domain, numerics.spacing)),
        volumes: Volumes::even(volume),
        sub_cell: false,
        shaft: None,
        materials: Materials::new([thermal].into(), Vec::new()),
    };
    method.publish(&mut particles);
    let summary = PlanSummary {
        particles: count as u64,
        pairs,
        memory: Memory { particles: particles.heap_size(), method: method.heap_size(), observers: 0 },
        step_s: step,
        step_bound_s: bound.step,
        step_limit: bound.cause.clone(),
        steps: StepCount::Planned(planned_steps(scene, step, None)),
        used: vec![
            format!("{count} moving particles, {} m apart on average", numerics.spacing),
            "columns of enthalpy, position and velocity; neighbours from cells, without a list".into(),
        ],
        spared: Vec::new(),
        relaxed_by: Vec::new(),
        differences: [settings.discretisation.differences.clone(), differences].concat(),
    };
    Ok(Plan { particles, method, step, bound, summary, pipes: Vec::new() })
}
