//! Smaller scenes with the same answer: a line for a plane in which nothing varies across, half of a body that is
//! symmetric about its middle, a sector of a ring of pipes.
//!
//! A reduction is exact and not a model: particles of the smaller body do what their images in the larger one do, in
//! the same steps, so both agree to rounding. Weights of a line that stands for a plane are those of the plane summed
//! over rows ([`frazil_core::bonds::stencil::Stencil::collapsed`]), and the bound of the step is the larger body's. What a run of the smaller body
//! leaves is restored to the terms of the scene that was asked for.

mod fold;
mod restore;

use std::sync::Arc;

use frazil_core::bonds::weight::{Normalisation, PairWeight};
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::particles::Particles;
use frazil_core::solvers::step::Bound;
use frazil_core::space::domain::Domain;
use frazil_core::space::lattice::Lattice;
use frazil_record::RunResult;
use frazil_scene::method::MethodSettings;
use frazil_scene::method::{Discretisation, Stepper};
use frazil_scene::{Arrangement, Front, IntegratorChoice, Scene};
use glam::DVec2;

use crate::march::{self, Options, Refused};
use crate::measure::attach;
use crate::plan::{build, settings_of};
use crate::reference::Reference;

use fold::Fold;

/// A smaller scene under one method, and the way back.
#[derive(Debug, Clone)]
pub struct Reduction {
    /// The smaller scene, with the one method's settings.
    pub scene: Scene,
    /// The larger scene.
    original: Scene,
    method: &'static str,
    /// What was left away, in order.
    folds: Vec<Fold>,
    /// Particles of the larger scene and of the smaller one.
    particles: (usize, usize),
}

/// What the search for a smaller scene came to.
#[derive(Debug, Clone)]
pub enum Finding {
    /// There is one.
    Smaller(Box<Reduction>),
    /// The scene is symmetric, but not its discretisation: why.
    Kept(String),
    /// The scene has no symmetry that would make it smaller.
    Whole,
}

/// Looks for a smaller scene that gives the same answer under a method.
///
/// # Errors
/// What the plan of the larger body refuses.
pub fn find(scene: &Scene, method: &str, reference: Option<&Arc<dyn Reference>>) -> Result<Finding, Refused> {
    let settings = settings_of(scene, method)?;
    let spacing = settings.numerics.spacing;
    let mut smaller = scene.clone();
    let mut folds = Vec::new();
    let mut kept = None;
    let reach = settings.stencil(spacing, scene.domain.dimension()).reach;
    loop {
        let found = Fold::candidates(&smaller).into_iter().find_map(|fold| {
            let folded = fold.shrink(&smaller);
            if !fold.keeps_ground(&smaller, &folded, spacing) {
                return None;
            }
            let obstacle = obstacle(scene, settings)
                .or_else(|| fold.obstacle(&smaller, spacing, reach))
                .or_else(|| front_across(&smaller, settings, fold));
            if obstacle.is_some() {
                kept = kept.take().or(obstacle);
                return None;
            }
            Some((fold, folded))
        });
        let Some((fold, folded)) = found else { break };
        folds.push(fold);
        smaller = folded;
    }
    if folds.is_empty() {
        return Ok(kept.map_or(Finding::Whole, Finding::Kept));
    }
    let bound = match larger(scene, settings, &folds, reference)? {
        Larger::Bound(bound) => bound,
        Larger::Differs(reason) => return Ok(Finding::Kept(reason)),
    };
    let (discretisation, along) = (Arc::new(discretisation(settings, &folds)), smaller.along);
    let own = MethodSettings { discretisation, along, bound, ..settings.clone() };
    smaller.methods = vec![own];
    let count = |scene: &Scene| Lattice::new(&scene.domain, spacing).len();
    let particles = (count(scene), count(&smaller));
    let original = scene.clone();
    let method = settings.method;
    Ok(Finding::Smaller(Box::new(Reduction { scene: smaller, original, method, folds, particles })))
}

/// What about the settings of a method is not symmetric, or would not be in the smaller body.
fn obstacle(scene: &Scene, settings: &MethodSettings) -> Option<String> {
    let numerics = &settings.numerics;
    if !matches!(settings.discretisation.stepper, Stepper::Shared) {
        let method = settings.method;
        return Some(format!("the method {method} has its own time steps: each particle has its own noise"));
    }
    let fitted = numerics.walls == WallModel::MovingLeastSquares && !matches!(scene.domain, Domain::Ring { .. });
    let reasons = [
        (scene.flow.is_some(), "water flows"),
        (scene.gravity.is_some(), "water falls"),
        (!scene.random.is_even(), "the ground varies at random"),
        (numerics.arrangement != Arrangement::Lattice, "particles are irregular"),
        (fitted, "fits of wall_model = \"moving-least-squares\" have no mirror planes"),
        (numerics.walls == WallModel::InnerLayers, "inner layers hold particles of the body itself"),
        (
            numerics.walls == WallModel::Naive && scene.brings_heat(),
            "naive layers at a flux or film depend on all particles of the body",
        ),
    ];
    reasons.into_iter().find(|reason| reason.0).map(|reason| reason.1.to_owned())
}

/// Why fronts inside particles would not be those of a line: in a plane they are where the scene shows that nothing varies across.
fn front_across(scene: &Scene, settings: &MethodSettings, fold: Fold) -> Option<String> {
    let Fold::Line { along_y, .. } = fold else { return None };
    let known = scene.freezing_direction().is_some_and(|direction| direction.along_y == along_y);
    (settings.numerics.front == Front::SubCell && !known)
        .then(|| "sub-cell fronts are plane only for regions that are boxes from wall to wall".to_owned())
}

/// What only a plan of the larger body knows.
enum Larger {
    /// The bound of its step, where it is not plainly that of the smaller body.
    Bound(Option<Bound>),
    /// Why the smaller body would not do the same.
    Differs(String),
}

/// Plans the larger body where that is needed. Particles of a half of a straight body have the bounds of the whole.
fn larger(
    scene: &Scene,
    settings: &MethodSettings,
    folds: &[Fold],
    reference: Option<&Arc<dyn Reference>>,
) -> Result<Larger, Refused> {
    let spacing = settings.numerics.spacing;
    let mut larger = scene.clone();
    match folds.first() {
        Some(Fold::Line { along_y, .. }) => {
            // A strip of the plane has all its kinds of rows: the middle one sees no end.
            let reach = settings.stencil(spacing, scene.domain.dimension()).reach;
            let strip = (2 * reach + 1) as f64 * spacing;
            if let Domain::Rectangle { width, height } = scene.domain {
                larger.domain = match along_y {
                    true => Domain::Rectangle { width: width.min(strip), height },
                    false => Domain::Rectangle { width, height: height.min(strip) },
                };
            }
        }
        Some(Fold::Sector { .. }) => {}
        Some(Fold::Half { .. }) | None => return Ok(Larger::Bound(None)),
    }
    let mut plain = settings.clone();
    plain.numerics.integrator = IntegratorChoice::Euler;
    let plan = build(&larger, &plain, reference, 1, 1)?;
    let borders =
        plan.pipes.iter().map(|pipe| pipe.extent).find(|pipe| straddles(&plan.particles, pipe.centre, pipe.half_width));
    Ok(match borders {
        Some(pipe) => {
            let at = pipe.centre;
            Larger::Differs(format!("the pipe at ({:.4}, {:.4}) m touches two materials", at.x, at.y))
        }
        None => Larger::Bound(Some(plan.bound)),
    })
}

/// Whether particles within `half` (m) of a place in both directions are of several materials.
fn straddles(particles: &Particles, centre: DVec2, half: f64) -> bool {
    if !particles.materials.mixed() {
        return false;
    }
    let mut found = None;
    let mut several = false;
    particles.visit(|i, place| {
        if (place - centre).abs().max_element() <= half {
            let material = particles.materials.law(i);
            several |= *found.get_or_insert(material) != material;
        }
    });
    several
}

/// Weights of a line that stands for a plane.
struct Collapsed {
    spacing: f64,
    /// By distance in cells, from 1 on (m^-2).
    weights: Vec<f64>,
}

impl PairWeight for Collapsed {
    fn reach(&self) -> f64 {
        self.weights.len() as f64 * self.spacing
    }

    fn weight(&self, distance: f64) -> f64 {
        let cells = (distance / self.spacing).round() as usize;
        cells.checked_sub(1).and_then(|cell| self.weights.get(cell)).map_or(0.0, |weight| weight / self.spacing)
    }
}

fn discretisation(settings: &MethodSettings, folds: &[Fold]) -> Discretisation {
    let own = &settings.discretisation;
    let (weight, normalisation): (Arc<dyn PairWeight>, Normalisation) = match folds.first() {
        Some(Fold::Line { along_y, .. }) => {
            let spacing = settings.numerics.spacing;
            let weights = settings.stencil(spacing, 2).collapsed(*along_y);
            (Arc::new(Collapsed { spacing, weights }), Normalisation::Nominal)
        }
        _ => (own.weight.clone(), own.normalisation),
    };
    Discretisation { weight, normalisation, ..own.as_ref().clone() }
}

impl Reduction {
    /// How many times as many particles the larger body has.
    pub fn saves(&self) -> f64 {
        self.particles.0 as f64 / self.particles.1 as f64
    }

    /// The smaller body in words, as "a line (400 particles)".
    pub fn body(&self) -> String {
        let kind = match self.scene.domain {
            Domain::Line { .. } => "a line".to_string(),
            Domain::Rectangle { width, height } => format!("a rectangle of {width} m x {height} m"),
            Domain::Ring { sector, .. } => format!("a {} of the ring", sector.name()),
            Domain::Radial { .. } | Domain::Axial { .. } => "a body of shells".to_string(),
        };
        format!("{kind} ({} particles)", self.particles.1)
    }

    /// Why it gives the same answer, in words.
    pub fn why(&self) -> String {
        self.folds.iter().map(Fold::why).collect::<Vec<_>>().join("; ")
    }

    /// The sentence of the record: what was run in place of what, and why.
    pub fn words(&self) -> String {
        format!("{} for a body of {}: {}", self.body(), self.particles.0, self.why())
    }

    /// Runs the smaller scene; what it leaves is in terms of the larger one.
    ///
    /// # Errors
    /// What the plans of both bodies refuse.
    pub fn run(&self, reference: Option<&Arc<dyn Reference>>, options: &Options<'_>) -> Result<RunResult, Refused> {
        let mut result = march::run(&self.scene, self.method, reference, options)?;
        for (k, fold) in self.folds.iter().enumerate().rev() {
            // The scene as it was before this fold.
            let larger = self.folds[..k].iter().fold(self.original.clone(), |scene, fold| fold.shrink(&scene));
            fold.restore(&larger, &mut result);
        }
        if let Some(reference) = reference {
            let spacing = self.scene.methods[0].numerics.spacing;
            attach(&self.original, spacing, &mut result, reference.as_ref());
        }
        result.record.reduced_from = Some(self.words());
        Ok(result)
    }
}

/// Runs a scene as [`march::run`] does, by a smaller one if there is one.
///
/// # Errors
/// What the plans of both bodies refuse.
pub fn run(
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    options: &Options<'_>,
) -> Result<RunResult, Refused> {
    match find(scene, method, reference)? {
        Finding::Smaller(reduction) => reduction.run(reference, options),
        Finding::Kept(_) | Finding::Whole => march::run(scene, method, reference, options),
    }
}
