//! What there is to run, and what a run would do.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use frazil::run::told_reference;
use frazil::{check as checks, list};
use frazil_studies::{input, method};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use toml::Table;

use crate::errors::{SceneError, raised};
use crate::run::threads;
use crate::source::{Scenes, Source};
use crate::{value, work};

/// Rows of a list: kind, name, title, and the source of a scene or whether a method is `stochastic`.
type Listed = (&'static str, &'static str, String, String);

/// The bundled scenes, studies and fluids, and the methods.
#[pyfunction]
pub fn listed() -> PyResult<Vec<Listed>> {
    let rows = list::listed().map_err(|failure| raised(&failure))?;
    Ok(rows.into_iter().map(|row| (row.kind, row.name, row.title, row.source)).collect())
}

/// The file of a bundled scene or study, or one of its own, as a dictionary.
#[pyfunction]
pub fn read<'py>(py: Python<'py>, scene: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
    let name = match Source::of(scene)? {
        Source::Table { table, .. } => return value::dictionary(py, &table),
        Source::Named(name) => name,
    };
    let bundled = frazil_cases::scenes::find(&name).or_else(|| frazil_cases::studies::find(&name));
    let text = match bundled {
        Some(bundled) => bundled.text.to_owned(),
        None => input::text(Path::new(&name)).map_err(|failure| raised(&failure))?,
    };
    let table = text.parse::<Table>().map_err(|error| SceneError::new_err(format!("{name}: {error}")))?;
    value::dictionary(py, &table)
}

/// What a run of a scene would do under each method, by its name: numbers and words.
#[pyfunction]
pub fn check<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    methods: Vec<String>,
    set: Option<&Bound<'py, PyMapping>>,
    threads: Option<usize>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let source = Source::of(scene)?;
    let (scenes, overrides) = (Scenes::of(std::slice::from_ref(&source))?, value::overrides(set)?);
    let threads = self::threads(threads)?;
    let planned = || {
        let mut scene = scenes.read(source.name(), &overrides)?.0;
        let reference = told_reference(&mut scene)?;
        let mut methods =
            methods.iter().map(|asked| method::asked(&scene, Some(asked))).collect::<Result<Vec<_>, _>>()?;
        if methods.is_empty() {
            methods = scene.methods.iter().map(|settings| settings.method).collect();
        }
        let plan =
            |method: &'static str| Ok((method, checks::planned(&scene, method, reference.as_ref(), threads, false)?));
        methods.into_iter().map(plan).collect::<Result<Vec<_>, frazil_studies::failure::Failure>>()
    };
    let (planned, stopped) = work::beside(py, &AtomicBool::new(false), |_| Ok(()), planned)?;
    if let Some(stopped) = stopped {
        return Err(stopped);
    }
    let dictionary = |(method, (forecast, text)): (&str, (frazil_simulation::predict::Forecast, String))| {
        let (plan, numbers) = (PyDict::new(py), checks::PlanNumbers::of(&forecast));
        plan.set_item("method", method)?;
        plan.set_item("particles", numbers.particles)?;
        plan.set_item("pairs", numbers.pairs)?;
        plan.set_item("memory_bytes", numbers.memory_bytes)?;
        plan.set_item("step_s", numbers.step_s)?;
        plan.set_item("step_bound_s", numbers.step_bound_s)?;
        plan.set_item("step_limit", &numbers.step_limit)?;
        plan.set_item("steps", numbers.steps)?;
        plan.set_item("wall_s", numbers.wall_s)?;
        plan.set_item("text", text)?;
        Ok(plan)
    };
    planned.map_err(|failure| raised(&failure))?.into_iter().map(dictionary).collect()
}
