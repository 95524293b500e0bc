//! A method as a scene sees it: its geometry, its own settings, and how it makes steps.

use std::collections::BTreeMap;
use std::error::Error;
use std::sync::Arc;
use std::{fmt, iter};

use frazil_core::bonds::stencil::{Stencil, longest_reach};
use frazil_core::bonds::weight::{Normalisation, PairWeight};
use frazil_core::boundary::green::Green;
use frazil_core::boundary::pipe::radius_of_one_particle;
use frazil_core::solvers::assembly::Assembly;
use frazil_core::solvers::moving::{ParticleSet, Purpose};
use frazil_core::solvers::solver::Solver;
use frazil_core::solvers::step::Bound;
use frazil_record::Value;
use glam::DVec2;
use rayon::ThreadPool;

use crate::read::Section;
use crate::scene::Scene;
use crate::settings::{Numerics, Setting, word};

/// A method's geometry on one scene, made by [`MethodKind::read`].
#[derive(Clone)]
pub struct Discretisation {
    /// Pair weight.
    pub weight: Arc<dyn PairWeight>,
    /// Scaling.
    pub normalisation: Normalisation,
    /// The method's own settings, by their keys in the file, defaults included.
    pub knobs: Vec<(&'static str, Value)>,
    /// Differences between the scene and what the method represents, in words, for the report.
    pub differences: Vec<String>,
    /// Standard deviation of one unfrozen particle's temperature over its absolute value; 0 without noise.
    pub fluctuation: f64,
    /// How steps are made.
    pub stepper: Stepper,
}

/// How weights are scaled, and the words of the record: by what a method with exact weights on any particles needs, or as the papers
/// print it, which is the default of their setting.
pub fn normalisation(section: &mut Section<'_>, setting: Setting) -> (Normalisation, Value) {
    let choices = [("discrete-moment", Normalisation::DiscreteMoment), ("continuum", Normalisation::Nominal)];
    let default = if setting == Setting::Paper { Normalisation::Nominal } else { Normalisation::DiscreteMoment };
    let chosen = section.choice_or("normalisation", &choices, default);
    let word = choices.iter().find(|choice| choice.1 == chosen).map_or("", |choice| choice.0);
    (chosen, Value::Text(word.into()))
}

/// What of a scene a method cannot represent: an error of its own.
pub type Unrepresented = Box<dyn Error + Send + Sync>;

/// Makes the particles of a scene with these settings, threads and seed, for a purpose; or says what it cannot represent.
pub type MakeParticleSet = dyn Fn(&Scene, &MethodSettings, Option<Arc<ThreadPool>>, u64, Purpose) -> Result<ParticleSet, Unrepresented>
    + Send
    + Sync;

/// Makes a method with its own time steps.
pub type OwnStep = dyn Fn(Assembly) -> Box<dyn Solver> + Send + Sync;

/// Who makes the step.
#[derive(Clone)]
pub enum Stepper {
    /// The shared conduction operator and integrator.
    Shared,
    /// The method itself, from the assembled particles, neighbours and walls.
    Own(Arc<OwnStep>),
    /// The method itself, which also places and moves the particles.
    Moving(Arc<MakeParticleSet>),
}

/// A method as the registry lists it.
pub struct MethodKind {
    /// Short name, as in `--method` and `[method.NAME]`.
    pub name: &'static str,
    /// One line for people.
    pub title: &'static str,
    /// Paper and equations.
    pub source: &'static str,
    /// Whether the method is stochastic, so that errors need an ensemble.
    pub stochastic: bool,
    /// Whether it exists only on a lattice.
    pub lattice_only: bool,
    /// Shared settings of a preset; the spacing is filled in from the file.
    pub defaults: fn(Setting) -> Numerics,
    /// Reads the method's own keys. Problems go into the section; a best guess is returned all the same.
    pub read: fn(&mut Section<'_>, Setting, &Numerics, &SceneFacts) -> Discretisation,
}

/// What a method may know of a scene when it reads its keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SceneFacts {
    /// Space dimensions.
    pub dimension: usize,
    /// Whether all of its ground is one material, in which heat is what spreads.
    pub one_material: bool,
}

/// Everything a scene says about one method.
#[derive(Clone)]
pub struct MethodSettings {
    /// Name in the registry.
    pub method: &'static str,
    /// The preset.
    pub setting: Setting,
    /// Shared settings.
    pub numerics: Numerics,
    /// The method's own geometry.
    pub discretisation: Arc<Discretisation>,
    /// Conductivity along x and along y of a plane, over that of its materials. On a line, that of the plane along it, by which the
    /// weights are greater already.
    pub along: DVec2,
    /// The bound of an explicit step, where a larger body knows it for this one (a body that is reduced): both then make
    /// the same steps. Derived from the particles if absent.
    pub bound: Option<Bound>,
}

impl MethodSettings {
    /// The weights on a lattice of a spacing (m).
    pub fn stencil(&self, spacing: f64, dimension: usize) -> Stencil {
        let Discretisation { weight, normalisation, .. } = self.discretisation.as_ref();
        match dimension {
            1 => Stencil::new(weight.as_ref(), *normalisation, spacing, dimension).acting(self.along),
            _ => Stencil::directed(weight.as_ref(), *normalisation, spacing, self.along),
        }
    }

    /// How far pairs reach at most (m).
    pub fn reach(&self) -> f64 {
        longest_reach(self.discretisation.weight.as_ref(), self.along)
    }

    /// All settings by the keys of the file, defaults included, as a record shows them.
    pub fn values(&self) -> BTreeMap<String, Value> {
        let setting = ("setting", word(&Setting::WORDS, &self.setting));
        let own = self.discretisation.knobs.iter().cloned();
        let all = iter::once(setting).chain(self.numerics.values()).chain(own);
        all.map(|(key, value)| (key.to_owned(), value)).collect()
    }
}

impl fmt::Debug for MethodSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MethodSettings")
            .field("method", &self.method)
            .field("setting", &self.setting)
            .field("numerics", &self.numerics)
            .finish_non_exhaustive()
    }
}

/// The same of a method's settings.
pub fn acting_radius(settings: &MethodSettings) -> f64 {
    let spacing = settings.numerics.spacing;
    let green = Green::new(&settings.stencil(spacing, 2), spacing, 1);
    radius_of_one_particle(&green, spacing)
}
