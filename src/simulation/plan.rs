//! From a scene to what its steps need, and what it is spared: the one place where run time becomes types.

mod bonds;
mod heating;
mod irregular;
mod listed;
mod moving;
mod pipes;
mod prepared;
mod random;
pub(crate) mod refusals;
pub(crate) mod steps;
mod transport;

use std::sync::Arc;

use frazil_core::boundary::pipe::Sink;
use frazil_core::memory::{HeapSize, Memory};
use frazil_core::particles::Particles;
use frazil_core::physics::latent_heat::LatentHeatScheme;
use frazil_core::solvers::moving::Purpose;
use frazil_core::solvers::solver::{Solver, SolverReport};
use frazil_core::solvers::step::Bound;
use frazil_scene::method::MethodSettings;
use frazil_scene::method::Stepper;
use frazil_scene::settings::SearchChoice;
use frazil_scene::{Front, IntegratorChoice, Numerics, Scene, StepChoice};

use crate::plan::listed::Listed;
use crate::plan::prepared::Prepared;
use crate::plan::refusals::{affordable, why_list};
use crate::plan::steps::{choose_step, limited, on_lattice, pool, solver, team};
use crate::predict::{StepCount, planned_steps};
use crate::reference::Reference;
use crate::refused::Refused;
use crate::terms;

/// What a run of a scene under a method will do: the answer of `frazil check`.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSummary {
    /// Particles.
    pub particles: u64,
    /// Pairs that one evaluation visits (each pair once).
    pub pairs: u64,
    /// What the run holds on the heap to its end, apart from observers (bytes).
    pub memory: Memory,
    /// Step that will be made (s), before it is shortened to land on outputs.
    pub step_s: f64,
    /// Derived bound of the explicit step (s).
    pub step_bound_s: f64,
    /// What sets the bound.
    pub step_limit: String,
    /// Steps of the whole run.
    pub steps: StepCount,
    /// What the scene uses, in words.
    pub used: Vec<String>,
    /// What it is spared, in words.
    pub spared: Vec<String>,
    /// What would allow longer steps, in words.
    pub relaxed_by: Vec<String>,
    /// How the method differs from the scene, in words.
    pub differences: Vec<String>,
}

/// A run that is ready for its first step.
pub struct Plan {
    /// Particles at their start.
    pub particles: Particles,
    /// The method.
    pub method: Box<dyn Solver>,
    /// The longest step that will be made (s).
    pub step: f64,
    /// The bound that the step was chosen from.
    pub bound: Bound,
    /// The same in words.
    pub summary: PlanSummary,
    /// Pipes of the sector, joined to particles.
    pub pipes: Vec<Sink>,
}

/// Limits of explicit steps of a method on a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    /// By row sums of the actual pairs (Gershgorin): up to here the maximum principle holds.
    pub gershgorin: Bound,
    /// Two over the largest rate of decay (s), by power iteration: up to here steps are linearly stable.
    pub sharp_step: f64,
}

/// Both limits of explicit steps.
///
/// # Errors
/// What a plan refuses.
pub fn bounds(
    scene: &Scene,
    settings: &MethodSettings,
    reference: Option<&Arc<dyn Reference>>,
    seed: u64,
) -> Result<Bounds, Refused> {
    let mut explicit = settings.clone();
    explicit.numerics.integrator = IntegratorChoice::Euler;
    explicit.numerics.step = StepChoice::Fraction(1.0);
    let mut plan = build(scene, &explicit, reference, 1, seed)?;
    Ok(Bounds { sharp_step: plan.method.sharp_step(), gershgorin: plan.bound })
}

/// The settings of a method on a scene, or why there are none.
///
/// # Errors
/// A scene that says nothing of the method.
pub fn settings_of<'a>(scene: &'a Scene, method: &str) -> Result<&'a MethodSettings, Refused> {
    scene.method(method).ok_or_else(|| Refused::NoMethod { scene: scene.name.clone(), method: method.to_owned() })
}

/// Builds everything that a run needs.
///
/// # Errors
/// Whatever of the scene or its settings cannot be run, by what is allowed.
pub fn build(
    scene: &Scene,
    settings: &MethodSettings,
    reference: Option<&Arc<dyn Reference>>,
    threads: usize,
    seed: u64,
) -> Result<Plan, Refused> {
    build_for(Purpose::Run, scene, settings, reference, threads, seed)
}

/// Settings in which flags of latent heat are enthalpies, where steps have several stages, water flows, or fronts and rows
/// are those of enthalpies: with overshoots credited both are the same unknown, in other words.
fn flags_as_enthalpies(scene: &Scene, settings: &MethodSettings) -> Option<MethodSettings> {
    let numerics = &settings.numerics;
    let whole_steps = numerics.integrator == IntegratorChoice::Euler && scene.flow.is_none();
    let own_rows = numerics.front == Front::Cell && numerics.search != SearchChoice::Lattice;
    if numerics.latent_heat_scheme != LatentHeatScheme::Flags || whole_steps && own_rows {
        return None;
    }
    let numerics = Numerics { latent_heat_scheme: LatentHeatScheme::Enthalpy, ..numerics.clone() };
    Some(MethodSettings { numerics, ..settings.clone() })
}

/// Builds everything that is needed for a purpose.
pub(crate) fn build_for(
    purpose: Purpose,
    scene: &Scene,
    settings: &MethodSettings,
    reference: Option<&Arc<dyn Reference>>,
    threads: usize,
    seed: u64,
) -> Result<Plan, Refused> {
    let as_enthalpies = flags_as_enthalpies(scene, settings);
    let settings = as_enthalpies.as_ref().unwrap_or(settings);
    let numerics = &settings.numerics;
    let discretisation = settings.discretisation.as_ref();
    let stencil = settings.stencil(numerics.spacing, scene.domain.dimension());
    affordable(scene, settings, &stencil)?;
    let own_step = match &discretisation.stepper {
        Stepper::Moving(make) => {
            let set = make(scene, settings, pool(threads)?, seed, purpose)?;
            return moving::plan(scene, settings, set);
        }
        Stepper::Own(step) => Some(step.as_ref()),
        Stepper::Shared => None,
    };
    refusals::unsupported(scene)?;
    let team = team(threads)?;
    let mut prepared = Prepared::new(scene, settings, reference, seed, team.as_ref())?;
    refusals::out_of_place(scene, numerics, &prepared)?;
    let pipes = prepared.sinks.clone();
    let why_list = |flows| why_list(scene, numerics, discretisation, &prepared.stencil, prepared.narrow, flows);
    // Water needs the pairs; heat may be conducted without them.
    let conducts_on_lattice = why_list(false).is_none();
    refusals::front_off_the_lattice(numerics, why_list(false))?;
    let why_list = why_list(scene.flow.is_some());
    let (terms, spared, relaxed_by) = prepared.terms(scene, settings, why_list.is_some());
    let mut used = vec![prepared.words(numerics)];
    let said = "flags of latent heat stored as enthalpies, which is equivalent";
    used.extend(as_enthalpies.iter().map(|_| said.into()));
    let method: Box<dyn Solver> = match why_list {
        None => {
            used.push(format!("one fused sweep per step, {} neighbours per particle", prepared.stencil.neighbours()));
            let (range, largest_slope) = (prepared.range(scene), prepared.largest_slope());
            let sums = (prepared.count(), Some(scene.duration));
            let parts = prepared.lattice_parts(scene, settings, team.clone())?;
            used.extend(parts.irregular.as_deref().map(terms::irregular));
            solver(numerics, heating::heated(on_lattice(parts), scene, &prepared), range, largest_slope, sums)
        }
        Some(reason) => {
            used.push(format!("a neighbour list, because {reason}"));
            let listed = Listed { scene, settings, own_step, conducts_on_lattice, seed };
            let swept = conducts_on_lattice && own_step.is_none() && scene.flow.is_some();
            used.extend(swept.then(|| "conduction by a lattice sweep".into()));
            listed.solver(&mut prepared, team.clone())?
        }
    };
    let method = transport::transport(scene, settings, &mut prepared, method, team)?;
    let SolverReport { bound, pairs, gentle_step, .. } = limited(method.report(), scene);
    let step = choose_step(numerics, &bound, scene)?;
    let (particles, differences) = prepared.into_particles(numerics);
    let summary = PlanSummary {
        particles: particles.len() as u64,
        pairs,
        memory: Memory { particles: particles.heap_size(), method: method.heap_size(), observers: 0 },
        step_s: step,
        step_bound_s: bound.step,
        step_limit: bound.cause.clone(),
        steps: match numerics.integrator.tolerance() {
            None => StepCount::Planned(planned_steps(scene, step, gentle_step)),
            Some(_) => StepCount::ByErrorControl { estimate: None, trial: 0 },
        },
        used: [used, terms].concat(),
        spared,
        relaxed_by,
        differences: [
            discretisation.differences.clone(),
            terms::noise(scene, &particles.materials, discretisation.fluctuation),
            differences,
        ]
        .concat(),
    };
    Ok(Plan { particles, method, step, bound, summary, pipes })
}
