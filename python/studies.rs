//! Studies: made by the same functions as the commands, into a folder.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};

use frazil::parts::parts_until;
use frazil::run::{RunRequest, asked_of, folder_of};
use frazil::seeds::ensemble_of;
use frazil_layouts::LayoutRequest;
use frazil_plots::canvas::Formats;
use frazil_scene::{Setting, names};
use frazil_studies::campaign::Shard;
use frazil_studies::cheapest::CheapestRequest;
use frazil_studies::compare::CompareRequest;
use frazil_studies::compare::variant::Variant;
use frazil_studies::failure::{Failure, Verdict};
use frazil_studies::method;
use frazil_studies::parts::Parts;
use frazil_studies::stability::StabilityRequest;
use frazil_studies::stability::axis::Axis;
use frazil_studies::sweep::{SweepRequest, VariedKey};
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use tempfile::TempDir;
use toml::{Table, Value};

use crate::errors::{RunError, SceneError, raised};
use crate::run::{self, BETWEEN_CHECKPOINTS, threads};
use crate::source::{Scenes, Source};
use crate::{value, work};

/// Wall time that the runs of a layout may take by which its spacing is chosen (s), as the command has it.
const LAYOUT_BUDGET_S: f64 = 120.0;

/// How a study ended, in a word, and its folder.
type Studied = (&'static str, PathBuf);

/// Makes a study on scenes that may be dictionaries.
fn study(
    py: Python<'_>,
    (scenes, out): (&Scenes, PathBuf),
    make: impl Fn(&Parts<'_>) -> Result<Verdict, Failure> + Send + Sync,
) -> PyResult<Studied> {
    let interrupt = AtomicBool::new(false);
    let work = || {
        let scene_at = |name: &str, overrides: &[(String, String)]| Ok(scenes.read(name, overrides)?.0);
        make(&Parts { scene_at: &scene_at, ..parts_until(false, &interrupt) })
    };
    let (made, stopped) = work::beside(py, &interrupt, |_| Ok(()), work)?;
    match stopped {
        Some(stopped) => Err(stopped),
        None => made.map(|verdict| (verdict.name(), out)).map_err(|failure| raised(&failure)),
    }
}

fn sources(given: &[Bound<'_, PyAny>]) -> PyResult<(Scenes, Vec<String>)> {
    let sources = given.iter().map(Source::of).collect::<PyResult<Vec<_>>>()?;
    Ok((Scenes::of(&sources)?, sources.iter().map(|source| source.name().to_owned()).collect()))
}

/// What a folder for the results of a scene or study is called.
fn stem(argument: &str) -> String {
    let stem = Path::new(argument).file_stem().map_or_else(|| argument.into(), |stem| stem.to_string_lossy());
    names::of(&stem)
}

/// A number that must lie between others.
///
/// # Errors
/// Where it does not.
pub fn between<T: PartialOrd + std::fmt::Display>(name: &str, number: T, (least, most): (T, T)) -> PyResult<T> {
    if number >= least && number <= most {
        return Ok(number);
    }
    Err(SceneError::new_err(format!("{name}: found {number}, must be from {least} to {most}")))
}

/// A number that must be greater than 0.
///
/// # Errors
/// Where it is not.
pub fn positive(name: &str, number: f64) -> PyResult<f64> {
    if number.is_finite() && number > 0.0 {
        return Ok(number);
    }
    Err(SceneError::new_err(format!("{name}: found {number}, must be a number greater than 0")))
}

/// Methods against each other: error against run time.
#[pyfunction]
#[pyo3(signature = (scenes, methods, levels, budget_s, repeats, seeds, threads, set, out, quiet))]
#[expect(clippy::too_many_arguments, reason = "the arguments of the function of Python")]
pub fn compare(
    py: Python<'_>,
    scenes: Vec<Bound<'_, PyAny>>,
    methods: Vec<String>,
    levels: usize,
    budget_s: Option<f64>,
    repeats: Option<usize>,
    seeds: Option<usize>,
    threads: usize,
    set: Option<&Bound<'_, PyMapping>>,
    out: Option<PathBuf>,
    quiet: bool,
) -> PyResult<Studied> {
    let (scenes, names) = sources(&scenes)?;
    let out = out.unwrap_or_else(|| Path::new("out").join("compare"));
    let request = CompareRequest {
        scenes: names,
        methods,
        levels: between("levels", levels, (1, 8))?,
        out: Some(out.clone()),
        repeats: repeats.map(|repeats| between("repeats", repeats, (1, 1000))).transpose()?,
        seeds: seeds.map(|seeds| between("seeds", seeds, (2, 1000))).transpose()?,
        threads: self::threads(Some(threads))?,
        budget_s: budget_s.map(|budget| positive("budget_s", budget)).transpose()?,
        vary: None,
        settings: vec![Variant::standard(Setting::Best)],
        overrides: value::overrides(set)?,
        reduce: false,
        checkpoints: BETWEEN_CHECKPOINTS,
        quiet,
        command_line: "frazil.compare(...)".into(),
    };
    study(py, (&scenes, out), |parts| frazil_studies::compare::compare(&request, parts))
}

/// The fastest run of each method with an error, and what the command prints of it.
#[pyfunction]
#[pyo3(signature = (scene, error, methods, measure, set, threads, budget_s, out, quiet))]
#[expect(clippy::too_many_arguments, reason = "the arguments of the function of Python")]
pub fn cheapest(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    error: f64,
    methods: Vec<String>,
    measure: Option<&str>,
    set: Option<&Bound<'_, PyMapping>>,
    threads: usize,
    budget_s: f64,
    out: Option<PathBuf>,
    quiet: bool,
) -> PyResult<(&'static str, PathBuf, String)> {
    let source = Source::of(scene)?;
    let scenes = Scenes::of(std::slice::from_ref(&source))?;
    let out = out.unwrap_or_else(|| Path::new("out/cheapest").join(stem(source.name())));
    let request = CheapestRequest {
        scene: source.name().to_owned(),
        methods,
        error: between("error", error, (1e-12, 1.0))?,
        measure: run::measure(measure)?,
        overrides: value::overrides(set)?,
        threads: self::threads(Some(threads))?,
        budget_s: positive("budget_s", budget_s)?,
        out: Some(out.clone()),
        quiet,
        command_line: "frazil.cheapest(...)".into(),
    };
    let answer = Mutex::new(String::new());
    let (verdict, out) = study(py, (&scenes, out), |parts| {
        let (verdict, words) = frazil_studies::cheapest::search(&request, parts)?;
        *answer.lock().unwrap_or_else(PoisonError::into_inner) = words.unwrap_or_default();
        Ok(verdict)
    })?;
    Ok((verdict, out, answer.into_inner().unwrap_or_else(PoisonError::into_inner)))
}

/// A run with several seeds.
#[pyfunction]
#[pyo3(signature = (scene, method, seeds, seed, set, threads, out, quiet))]
#[expect(clippy::too_many_arguments, reason = "the arguments of the function of Python")]
pub fn ensemble(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    method: Option<&str>,
    seeds: usize,
    seed: u64,
    set: Option<&Bound<'_, PyMapping>>,
    threads: Option<usize>,
    out: Option<PathBuf>,
    quiet: bool,
) -> PyResult<Studied> {
    let source = Source::of(scene)?;
    let scenes = Scenes::of(std::slice::from_ref(&source))?;
    let (overrides, threads) = (value::overrides(set)?, self::threads(threads)?);
    let seeds = between("seeds", seeds, (1, 1000))?;
    let read = || -> Result<_, Failure> {
        let scene = scenes.read(source.name(), &overrides)?.0;
        let method = method::asked(&scene, method)?;
        Ok((scene, method))
    };
    let (scene, method) = read().map_err(|failure| raised(&failure))?;
    let out = out.unwrap_or_else(|| folder_of(&scene, method));
    let request = run::request((source.name(), Some(method)), overrides, (threads, seed), Some(out.clone()));
    let request = RunRequest { quiet, command_line: "frazil.ensemble(...)".into(), ..request };
    study(py, (&scenes, out), |parts| {
        ensemble_of(&request, &asked_of(scene.clone(), Some(method))?, seeds, parts.interrupt)
    })
}

/// Maps of where methods break.
#[pyfunction]
#[pyo3(signature = (scenes, methods, axes, grid, values, seeds, coarsen, time_limit_s, threads, set, out, quiet))]
#[expect(clippy::too_many_arguments, reason = "the arguments of the function of Python")]
pub fn stability(
    py: Python<'_>,
    scenes: Vec<Bound<'_, PyAny>>,
    methods: Vec<String>,
    axes: Vec<String>,
    grid: usize,
    values: usize,
    seeds: usize,
    coarsen: u32,
    time_limit_s: f64,
    threads: Option<usize>,
    set: Option<&Bound<'_, PyMapping>>,
    out: Option<PathBuf>,
    quiet: bool,
) -> PyResult<Studied> {
    let (scenes, names) = sources(&scenes)?;
    let out = out.unwrap_or_else(|| Path::new("out").join("stability"));
    if values.is_multiple_of(2) {
        return Err(SceneError::new_err(format!("values: found {values}, must be an odd number from 1 to 99")));
    }
    let axis = |word: &String| {
        let words = || Axis::WORDS.map(|(word, _)| word).join(", ");
        Axis::of_word(word).ok_or_else(|| SceneError::new_err(format!("axes: found {word:?}, must be of {}", words())))
    };
    let request = StabilityRequest {
        scenes: names,
        methods,
        axes: axes.iter().map(axis).collect::<PyResult<_>>()?,
        overrides: value::overrides(set)?,
        steps: Vec::new(),
        grid: between("grid", grid, (2, 200))?,
        values: between("values", values, (1, 99))?,
        seeds: between("seeds", seeds, (1, 1000))?,
        coarsen: between("coarsen", coarsen, (1, 16))?,
        time_limit_s: positive("time_limit_s", time_limit_s)?,
        threads: self::threads(threads)?,
        out: Some(out.clone()),
        quiet,
        command_line: "frazil.stability(...)".into(),
    };
    study(py, (&scenes, out), |parts| frazil_studies::stability::stability(&request, parts))
}

/// A scene at all combinations of values of some of its keys.
#[pyfunction]
#[pyo3(signature = (scene, vary, methods, seed, threads, set, out, quiet))]
#[expect(clippy::too_many_arguments, reason = "the arguments of the function of Python")]
pub fn sweep(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    vary: &Bound<'_, PyMapping>,
    methods: Vec<String>,
    seed: u64,
    threads: Option<usize>,
    set: Option<&Bound<'_, PyMapping>>,
    out: Option<PathBuf>,
    quiet: bool,
) -> PyResult<Studied> {
    let source = Source::of(scene)?;
    let scenes = Scenes::of(std::slice::from_ref(&source))?;
    let keys = value::varied(vary)?.into_iter().map(|(key, values)| VariedKey::new(key, values));
    let keys = keys.collect::<Result<Vec<_>, _>>().map_err(|error| SceneError::new_err(format!("vary: {error}")))?;
    let out = out.unwrap_or_else(|| Path::new("out/sweep").join(stem(source.name())));
    let request = SweepRequest {
        scene: source.name().to_owned(),
        keys,
        methods,
        overrides: value::overrides(set)?,
        threads: self::threads(threads)?,
        seed,
        out: Some(out.clone()),
        checkpoints: BETWEEN_CHECKPOINTS,
        quiet,
        command_line: "frazil.sweep(...)".into(),
    };
    study(py, (&scenes, out), |parts| frazil_studies::sweep::sweep(&request, parts))
}

/// Layouts of freeze pipes beside each other.
#[pyfunction]
#[pyo3(signature = (study, method, set, threads, error, out, quiet))]
#[expect(clippy::too_many_arguments, reason = "the arguments of the function of Python")]
pub fn layout(
    py: Python<'_>,
    study: &Bound<'_, PyAny>,
    method: Option<String>,
    set: Option<&Bound<'_, PyMapping>>,
    threads: Option<usize>,
    error: Option<f64>,
    out: Option<PathBuf>,
    quiet: bool,
) -> PyResult<Studied> {
    let source = Source::of(study)?;
    let files = Files::of(&source)?;
    let argument = files.as_ref().map_or_else(|| source.name().to_owned(), |files| files.study.clone());
    let out = out.unwrap_or_else(|| Path::new("out").join(stem(&argument)));
    let request = LayoutRequest {
        study: argument.clone(),
        method,
        overrides: value::overrides(set)?,
        threads: self::threads(threads)?,
        error: error.map(|error| between("error", error, (1e-12, 1.0))).transpose()?,
        budget_s: LAYOUT_BUDGET_S,
        shard: Shard::WHOLE,
        check: false,
        frames: false,
        formats: Formats::SVG,
        out: Some(out.clone()),
        checkpoints: BETWEEN_CHECKPOINTS,
        quiet,
        yes: true,
        command_line: "frazil.layout(...)".into(),
    };
    let scenes = Scenes::default();
    let studied = self::study(py, (&scenes, out), |parts| frazil_layouts::layout(&request, parts));
    studied.map_err(|raised| match &files {
        Some(files) => files.shortened(py, raised),
        None => raised,
    })
}

/// The files that a study and its scene become which are dictionaries.
struct Files {
    folder: TempDir,
    /// Path of the study.
    study: String,
}

impl Files {
    /// Files, if the study is a dictionary. A scene by a path lies where whoever called is.
    fn of(source: &Source) -> PyResult<Option<Files>> {
        let Source::Table { name, table } = source else { return Ok(None) };
        let folder = tempfile::tempdir()?;
        let mut table = table.clone();
        let scene = match table.get("scene") {
            Some(Value::Table(scene)) => {
                let path = folder.path().join("scene.toml");
                write(&path, scene)?;
                Some(path)
            }
            Some(Value::String(scene)) if Path::new(scene).exists() => Some(std::path::absolute(scene)?),
            _ => None,
        };
        if let Some(scene) = scene {
            table.insert("scene".into(), Value::String(scene.to_string_lossy().into_owned()));
        }
        let study = folder.path().join(name).with_extension("toml");
        write(&study, &table)?;
        Ok(Some(Files { study: study.to_string_lossy().into_owned(), folder }))
    }

    /// What was raised, without the folder in its words: nobody has seen it.
    fn shortened(&self, py: Python<'_>, raised: PyErr) -> PyErr {
        let words = raised.value(py).to_string().replace(&format!("{}/", self.folder.path().display()), "");
        if raised.is_instance_of::<SceneError>(py) {
            SceneError::new_err(words)
        } else if raised.is_instance_of::<RunError>(py) {
            RunError::new_err(words)
        } else {
            raised
        }
    }
}

fn write(path: &Path, table: &Table) -> PyResult<()> {
    let text = toml::to_string(table).map_err(|error| RunError::new_err(error.to_string()))?;
    Ok(std::fs::write(path, text)?)
}
