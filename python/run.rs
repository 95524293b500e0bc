//! One run.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use frazil::parts::parts_until;
use frazil::provenance;
use frazil::run::{Asked, Host, Made, RunRequest, asked_of, drawn, make, options};
use frazil_plots::canvas::Formats;
use frazil_record::{Field, Provenance, RunResult};
use frazil_scene::Scene;
use frazil_simulation::march::{self, Progress};
use frazil_studies::cheapest::{self, CheapestRequest};
use frazil_studies::ensemble::runs::Headline;
use frazil_studies::failure::Failure;
use frazil_studies::parts::Parts;
use frazil_studies::{output, parallel};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyMapping};

use crate::errors::{RunError, SceneError, raised};
use crate::source::{Scenes, Source};
use crate::studies::{between, positive};
use crate::{table, value, work};

/// Wall time between two checkpoints of a run in a folder, as the commands have it.
pub const BETWEEN_CHECKPOINTS: Option<Duration> = Some(Duration::from_secs(60));

/// Threads at most, as the command has it.
pub const MOST_THREADS: usize = 1024;

/// Threads that were asked for; by default as many as there are cores.
///
/// # Errors
/// Where they are too many or none.
pub fn threads(asked: Option<usize>) -> PyResult<usize> {
    let threads = asked.unwrap_or_else(parallel::cores);
    if !(1..=MOST_THREADS).contains(&threads) {
        return Err(SceneError::new_err(format!("threads: found {threads}, must be from 1 to {MOST_THREADS}")));
    }
    Ok(threads)
}

/// A quantity that errors are of, if one was asked for.
///
/// # Errors
/// Where there is none of that name.
pub fn measure(asked: Option<&str>) -> PyResult<Option<Headline>> {
    let unknown =
        |name: &str| SceneError::new_err(format!("measure: found {name:?}, must be one of {}", Headline::names()));
    asked.map(|name| Headline::named(name).ok_or_else(|| unknown(name))).transpose()
}

/// A run that was made, with all that it left.
#[pyclass(frozen, module = "frazil._native")]
pub struct Run {
    scene: Scene,
    result: RunResult,
    folder: Option<PathBuf>,
}

#[pymethods]
impl Run {
    /// The record as JSON.
    fn record(&self) -> PyResult<String> {
        serde_json::to_string(&self.result.record).map_err(|error| RunError::new_err(error.to_string()))
    }

    /// Where results were written, if they were.
    fn folder(&self) -> Option<PathBuf> {
        self.folder.clone()
    }

    /// The tables that have rows, by the names of their files without endings.
    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, Vec<table::Column<'py>>)>> {
        let mut tables = Vec::new();
        for (file, fill) in output::series(&self.result) {
            let Some(fill) = fill else { continue };
            let mut text = Vec::new();
            fill(&mut text)?;
            tables.push((file.trim_end_matches(".csv").to_owned(), table::of_text(py, &text)?));
        }
        Ok(tables)
    }

    /// The figures as SVG, by their names.
    fn figures(&self, py: Python<'_>) -> Vec<(String, String)> {
        let draw = || drawn(&self.scene, &self.result).into_iter().map(|(name, canvas)| (name, canvas.svg())).collect();
        py.detach(draw)
    }

    /// The maps that it kept: their numbers, and the bytes of their values.
    fn maps<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.result.fields.iter().map(|field| map(py, field)).collect()
    }
}

fn map<'py>(py: Python<'py>, field: &Field) -> PyResult<Bound<'py, PyDict>> {
    let map = PyDict::new(py);
    map.set_item("time_s", field.time_s)?;
    map.set_item("shape", (field.ny, field.nx))?;
    map.set_item("first_m", (field.x0_m, field.y0_m))?;
    map.set_item("spacing_m", field.spacing_m)?;
    let values = [
        ("temperature_c", &field.temperature_c),
        ("temperature_ref_c", &field.temperature_ref_c),
        ("frozen_fraction", &field.frozen_fraction),
        ("concentration", &field.concentration),
    ];
    for (name, values) in values.into_iter().filter(|(_, values)| !values.is_empty()) {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_ne_bytes()).collect();
        map.set_item(name, PyBytes::new(py, &bytes))?;
    }
    Ok(map)
}

/// A run as it is asked for from Python.
pub fn request(
    (scene, method): (&str, Option<&str>),
    overrides: Vec<(String, String)>,
    (threads, seed): (usize, u64),
    out: Option<PathBuf>,
) -> RunRequest {
    RunRequest {
        scene: scene.to_owned(),
        method: method.map(str::to_owned),
        overrides,
        threads,
        seed,
        out,
        reduce: false,
        estimated: None,
        fields: false,
        frames: false,
        formats: Formats::SVG,
        checkpoints: BETWEEN_CHECKPOINTS,
        resume: false,
        quiet: true,
        json: false,
        // Whoever waits can see how far it is, and stop it.
        yes: true,
        command_line: "frazil.run(...)".into(),
    }
}

/// Where a run stands: time and end (s), steps, wall time (s).
type Standing = (f64, f64, u64, f64);

/// Makes a run, and writes its results where there is a folder for them. `tell` is told where it stands.
#[pyfunction]
#[pyo3(signature = (scene, method, set, seed, threads, error, measure, budget_s, out, tell))]
#[expect(clippy::too_many_arguments, reason = "the arguments of the function of Python")]
pub fn run(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    method: Option<&str>,
    set: Option<&Bound<'_, PyMapping>>,
    seed: u64,
    threads: Option<usize>,
    error: Option<f64>,
    measure: Option<&str>,
    budget_s: f64,
    out: Option<PathBuf>,
    tell: Option<&Bound<'_, PyAny>>,
) -> PyResult<Run> {
    let source = Source::of(scene)?;
    let (scenes, overrides) = (Scenes::of(std::slice::from_ref(&source))?, value::overrides(set)?);
    let threads = self::threads(threads)?;
    let asked_error = error.map(|error| between("error", error, (1e-12, 1.0))).transpose()?;
    let measure = self::measure(measure)?;
    let budget_s = positive("budget_s", budget_s)?;
    let mut request = request((source.name(), method), overrides, (threads, seed), out);
    let (interrupt, standing) = (AtomicBool::new(false), Mutex::new(None::<Standing>));
    let latest = || standing.lock().unwrap_or_else(PoisonError::into_inner);
    let progress = |at: &Progress| *latest() = Some((at.time_s, at.duration_s, at.steps, at.elapsed_s));
    let host = Host { interrupt: &interrupt, prepared: &|| {}, progress: &progress, marched: &|| {} };
    let told = |_: Python<'_>| match (tell, latest().take()) {
        (Some(tell), Some(standing)) => tell.call1(standing).map(drop),
        _ => Ok(()),
    };
    let work = || {
        if let Some(error) = asked_error {
            let asked = CheapestRequest {
                scene: request.scene.clone(),
                methods: request.method.iter().cloned().collect(),
                error,
                measure,
                overrides: request.overrides.clone(),
                threads: 1,
                budget_s,
                out: None,
                quiet: true,
                command_line: request.command_line.clone(),
            };
            let scene_at = |name: &str, overrides: &[(String, String)]| Ok(scenes.read(name, overrides)?.0);
            let parts = Parts { scene_at: &scene_at, ..parts_until(false, &interrupt) };
            let settled = cheapest::settings(&asked, &parts)?;
            request.overrides.push(settled.spacing);
            request.estimated = Some(settled.estimated);
        }
        let (scene, source) = scenes.read(&request.scene, &request.overrides)?;
        let provenance = provenance::of(&request, source, &scene.files);
        made(&request, asked_of(scene, request.method.as_deref())?, provenance, &host)
    };
    let (made, stopped) = work::beside(py, &interrupt, told, work)?;
    match stopped {
        Some(stopped) => Err(stopped),
        None => made.map_err(|failure| raised(&failure)),
    }
}

/// The run of a request: in its folder as the command makes it, or in memory alone.
fn made(request: &RunRequest, asked: Asked, provenance: Provenance, host: &Host<'_>) -> Result<Run, Failure> {
    if request.out.is_some()
        && let Made::Now { result, folder, .. } = make(request, &asked, provenance.clone(), host)?
    {
        return Ok(Run { scene: asked.0, result: *result, folder: Some(folder) });
    }
    let (scene, method, reference) = asked;
    let mut result = march::run(&scene, method, reference.as_ref(), &options(host, (request.threads, request.seed)))?;
    result.record.estimated_error = request.estimated.clone();
    result.record.provenance = Some(provenance);
    Ok(Run { scene, result, folder: None })
}
