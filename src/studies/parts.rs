//! The rest of the program as studies see it; tests put made-up parts in its place.

use std::error::Error;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use frazil_record::RunResult;
use frazil_scene::Scene;
use frazil_scene::method::MethodKind;
use frazil_simulation::march::{Options, Refused};
use frazil_simulation::reference::{Reference, Truth};

use crate::failure::Failure;

/// Key path and value, as of `--set`.
pub type Override = (String, String);

/// Reads a scene by name or path with overrides.
pub type SceneAt<'a> = dyn Fn(&str, &[Override]) -> Result<Scene, Failure> + Sync + 'a;
/// The reference of a scene that needs no run, and why it is not the one that the scene names.
pub type ReferenceFor<'a> = dyn Fn(&Scene) -> Result<Truth, Box<dyn Error + Send + Sync>> + Sync + 'a;
/// Makes one run.
pub type Run<'a> =
    dyn Fn(&Scene, &str, Option<&Arc<dyn Reference>>, &Options<'_>) -> Result<RunResult, Refused> + Sync + 'a;

/// What studies are told of the rest of the program.
#[derive(Clone, Copy)]
pub struct Parts<'a> {
    /// Reads scenes.
    pub scene_at: &'a SceneAt<'a>,
    /// Knows references.
    pub reference_for: &'a ReferenceFor<'a>,
    /// Makes runs.
    pub run: &'a Run<'a>,
    /// The methods.
    pub methods: &'a [&'static MethodKind],
    /// Set to stop.
    pub interrupt: &'a AtomicBool,
}
