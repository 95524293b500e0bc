//! One scene under one method.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use frazil_core::particles::Particles;
use frazil_plots::canvas::{Canvas, Formats};
use frazil_plots::run::drawings;
use frazil_plots::style::{number, percent};
use frazil_record::{EstimatedError, Outcome, Provenance, Record, RunResult};
use frazil_scene::Scene;
use frazil_simulation::march::{self, Checkpoints, Going, Options, Progress, Refused, Standing};
use frazil_simulation::reduce::{self, Finding};
use frazil_simulation::reference::Reference;
use frazil_studies::answers::numbers::numbers;
use frazil_studies::cheapest::{self, CheapestRequest, Settled};
use frazil_studies::failure::{Failure, Verdict, answer, answer_json, complain};
use frazil_studies::fields::{self, Snapshots};
use frazil_studies::figures::Figures;
use frazil_studies::output::{self, Folder, Owner};
use frazil_studies::progress::{Reporter, bearable, clock, forewarn};
use frazil_studies::{answers, campaign, expect, figure_options, method};
use serde::Serialize;

use crate::load::Origin;
use crate::parts::parts;
use crate::{interrupt, load, provenance};

/// What is to be run.
#[derive(Debug, Clone, PartialEq)]
pub struct RunRequest {
    /// Scene, by path or bundled name.
    pub scene: String,
    /// Method; the first of the scene if absent.
    pub method: Option<String>,
    /// Pairs of key path and value that override the file.
    pub overrides: Vec<(String, String)>,
    /// Threads.
    pub threads: usize,
    /// Seed.
    pub seed: u64,
    /// Folder for the results; `out/<scene>/<method>` if absent.
    pub out: Option<PathBuf>,
    /// Whether a smaller scene that gives the same answer is to be run instead.
    pub reduce: bool,
    /// What is estimated of its error, where its spacing was chosen for one.
    pub estimated: Option<EstimatedError>,
    /// Whether to write whole states at outputs.
    pub fields: bool,
    /// Whether to draw a map at each output.
    pub frames: bool,
    /// As what figures are written.
    pub formats: Formats,
    /// Wall time between two checkpoints; none if absent.
    pub checkpoints: Option<Duration>,
    /// Whether to go on from the last checkpoint in the folder.
    pub resume: bool,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// Whether to print the results as JSON.
    pub json: bool,
    /// Whether to begin what takes longer than 30 days.
    pub yes: bool,
    /// The command as it was typed, for the record.
    pub command_line: String,
}

/// What a run tells whoever asked for it, and what stops it.
pub struct Host<'a> {
    /// Set to stop after the step at hand.
    pub interrupt: &'a AtomicBool,
    /// Called when the run is prepared, before its first step.
    pub prepared: &'a (dyn Fn() + Sync),
    /// Called now and then while steps are made.
    pub progress: &'a (dyn Fn(&Progress) + Sync),
    /// Called when no more steps are made.
    pub marched: &'a (dyn Fn() + Sync),
}

/// What has become of a request.
pub enum Made {
    /// Nothing was left to run: how the run ended that the folder holds.
    Before(Outcome),
    /// A run, in its folder.
    Now {
        /// What it left.
        result: Box<RunResult>,
        /// The folder.
        folder: PathBuf,
        /// Whether all figures could be drawn.
        drawn: bool,
    },
}

/// Runs and writes the results, whole even if the run was interrupted.
///
/// # Errors
/// Where the scene cannot be run, or a file cannot be written.
pub fn run(request: &RunRequest) -> Result<Verdict, Failure> {
    let (asked, source) = asked(request)?;
    let provenance = provenance::of(request, source, &asked.0.files);
    let reporter = Reporter::new(request.quiet);
    let host = Host {
        interrupt: interrupt::asked(),
        // Until its first step a run has nothing to write, and an interrupt ends it at once.
        prepared: &|| {
            interrupt::watch();
        },
        progress: &|progress| reporter.show(progress),
        marched: &|| reporter.finish(),
    };
    let scene = &asked.0;
    let (result, folder, drawn) = match make(request, &asked, provenance, &host)? {
        Made::Before(outcome) => {
            match record_of(request, scene, asked.1).filter(|_| request.json) {
                Some((folder, record)) => answer_json(&Printed::again(&folder, &record))?,
                None => answer(&format!("{} with {}: finished already: {}", scene.name, asked.1, outcome.name()))?,
            }
            return Ok(Verdict::of(outcome));
        }
        Made::Now { result, folder, drawn } => (result, folder, drawn),
    };
    if let Some(said) = frazil_layouts::beside_open(scene, &result.record) {
        complain(&format!("WARNING: {}: {said}", scene.name));
    }
    if request.json {
        answer_json(&Printed::of(scene, &result, &folder))?;
    } else if !request.quiet {
        answer(&summary(scene, &result, &folder))?;
    }
    let verdict = Verdict::of(result.record.outcome);
    Ok(if drawn { verdict } else { verdict.max(Verdict::Broken) })
}

/// Makes the run of a request whose scene has been read, and writes its results and where they come from.
///
/// # Errors
/// Where the scene cannot be run, or a file cannot be written.
pub fn make(
    request: &RunRequest,
    (scene, method, reference): &Asked,
    provenance: Provenance,
    host: &Host<'_>,
) -> Result<Made, Failure> {
    let reference = reference.as_ref();
    let finding = request.reduce.then(|| reduce::find(scene, method, reference));
    expected(request, scene, method, reference, finding.as_ref())?;
    let path = request.out.clone().unwrap_or_else(|| folder_of(scene, method));
    let folder = Folder::make(&path, Owner::Alone)?;
    let goes_on = match begin(request, folder.path(), scene, method)? {
        Begin::AtItsEnd(outcome) => return Ok(Made::Before(outcome)),
        Begin::GoesOn => true,
        Begin::Anew => false,
    };
    let wanted = (request.fields, request.frames);
    let snapshots = (wanted != (false, false)).then(|| Snapshots::new(scene, method, wanted, (folder.path(), goes_on)));
    let snapshots = snapshots.transpose().inspect_err(|_| folder.take_back())?;
    let see = |particles: &Particles, time: f64| {
        if let Some(snapshots) = &snapshots {
            snapshots.see(particles, time);
        }
    };
    let checkpoints = checkpoints(request, folder.path());
    let options = Options {
        each_output: snapshots.is_some().then_some(&see),
        checkpoints: checkpoints.as_ref(),
        ..options(host, (request.threads, request.seed))
    };
    let result = match finding {
        Some(finding) => finding.and_then(|finding| reduced(&finding, scene, method, reference, &options)),
        None => march::run(scene, method, reference, &options),
    };
    (host.marched)();
    let result = match result {
        Ok(mut result) => {
            result.record.estimated_error = request.estimated.clone();
            result.record.provenance = Some(provenance);
            result
        }
        Err(refused) => {
            if let Some(snapshots) = snapshots {
                snapshots.give_up();
            }
            folder.take_back();
            return Err(refused.into());
        }
    };
    let drawn = Cell::new(true);
    let also = || {
        snapshots.map_or(Ok(()), |snapshots| snapshots.finish(folder.path()))?;
        if let Err(error) = figures(scene, &result, folder.path()).write(request.formats, request.threads) {
            // The numbers are what counts: a figure that cannot be drawn does not undo them.
            complain(&format!("figures: {error}"));
            drawn.set(false);
        }
        Ok(())
    };
    output::write_run_and(folder.path(), &result, also)?;
    if let Some(checkpoints) = checkpoints.filter(|_| result.record.outcome != Outcome::Interrupted && drawn.get()) {
        checkpoints.clear().map_err(|error| Failure::file(folder.path(), "cannot be cleared of checkpoints", error))?;
    }
    Ok(Made::Now { result: Box::new(result), folder: path, drawn: drawn.get() })
}

/// How a run is made for its host, on so many threads and from a seed.
pub fn options<'a>(host: &Host<'a>, (threads, seed): (usize, u64)) -> Options<'a> {
    Options {
        threads,
        seed,
        interrupt: Some(host.interrupt),
        prepared: Some(host.prepared),
        progress: Some(host.progress),
        time_limit_s: None,
        fields: true,
        each_output: None,
        checkpoints: None,
    }
}

/// Every figure of a run.
fn figures(scene: &Scene, result: &RunResult, folder: &Path) -> Figures {
    let mut figures = Figures::default();
    for (name, canvas) in drawn(scene, result) {
        figures.add(folder, name, canvas);
    }
    figures
}

/// Every figure of a run, by its name.
pub fn drawn(scene: &Scene, result: &RunResult) -> Vec<(String, Canvas)> {
    drawings(result, &figure_options::of_run(scene, &result.fields))
}

/// The checkpoints of a run in its folder, if it is to have any.
fn checkpoints<'a>(request: &RunRequest, folder: &'a Path) -> Option<Checkpoints<'a>> {
    let going = if request.resume { Going::On } else { Going::Anew };
    request.checkpoints.map(|every| Checkpoints::new(folder, every, (&campaign::build, going), &complain))
}

/// The spacing at which a run promises an error, which is said, and what the error is made of.
///
/// # Errors
/// Where it cannot be promised.
pub fn for_error(request: &CheapestRequest) -> Result<Settled, Failure> {
    let settled = cheapest::settings(request, &parts(false))?;
    if !request.quiet {
        complain(&format!("{}: {}", request.scene, settled.words));
    }
    Ok(settled)
}

/// How a run begins.
enum Begin {
    /// There is nothing left to run.
    AtItsEnd(Outcome),
    /// From a checkpoint.
    GoesOn,
    /// From the start.
    Anew,
}

/// How a run begins in a folder, by what is there; says so.
fn begin(request: &RunRequest, folder: &Path, scene: &Scene, method: &str) -> Result<Begin, Failure> {
    let begin = match kept(folder)? {
        Some(standing) if request.resume => {
            if !request.quiet {
                complain(&format!("resumed at {}", words(&standing)));
            }
            return Ok(Begin::GoesOn);
        }
        Some(standing) => {
            let from = words(&standing);
            complain(&format!(
                "{}: starts from the beginning; --resume would have resumed from {from}",
                folder.display()
            ));
            Begin::Anew
        }
        None => match ended(folder, scene, method, request.seed).filter(|_| request.resume) {
            Some(record) => Begin::AtItsEnd(record.outcome),
            None => Begin::Anew,
        },
    };
    if matches!(begin, Begin::Anew) {
        fields::forget(folder)?;
    }
    Ok(begin)
}

/// Where the run stands that a folder keeps, if it keeps one.
fn kept(folder: &Path) -> Result<Option<Standing>, Failure> {
    march::standing(folder).map_err(|error| Failure::file(folder, "cannot be read", error))
}

/// Where a run stands.
pub fn words(standing: &Standing) -> String {
    let Standing { time_s, duration_s, steps, solve_wall_s, .. } = standing;
    format!("{:.1} % ({steps} steps, {})", 100.0 * time_s / duration_s, clock(*solve_wall_s))
}

/// The record of a run that a folder holds, if it is this one and came to its end.
fn ended(folder: &Path, scene: &Scene, method: &str, seed: u64) -> Option<Record> {
    let record = output::record_in(folder)?;
    let is_it = record.scene_hash == scene.hash && record.method == method && record.seed == seed;
    (is_it && record.outcome != Outcome::Interrupted).then_some(record)
}

/// Says that a run takes long, if it does, and refuses what would not end.
fn expected(
    request: &RunRequest,
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    finding: Option<&Result<Finding, Refused>>,
) -> Result<(), Failure> {
    let planned = match finding {
        Some(Ok(Finding::Smaller(reduction))) => &reduction.scene,
        _ => scene,
    };
    let Some(expected) = expect::run(planned, method, reference, request.threads)? else { return Ok(()) };
    let what = format!("{} with {method}", scene.name);
    if !request.yes {
        bearable(&what, expected.seconds, expected.shorter)?;
    }
    if !request.quiet {
        forewarn(&what, Some(expected.seconds));
    }
    Ok(())
}

/// Scene, method and reference.
pub type Asked = (Scene, &'static str, Option<Arc<dyn Reference>>);

/// What a request is about; warns of what is not taken as the scene has it.
///
/// # Errors
/// Where the scene cannot be read, has no such method, or its reference cannot be had.
pub(crate) fn asked(request: &RunRequest) -> Result<(Asked, Origin), Failure> {
    let (scene, source) = load::read(&request.scene, &request.overrides)?;
    let (scene, method, reference) = asked_of(scene, request.method.as_deref())?;
    for remark in scene.remarks.iter().filter(|_| !request.quiet) {
        complain(&format!("{}: warning: {remark}", scene.name));
    }
    Ok(((scene, method, reference), source))
}

/// The same of a scene: its method of a name, or its first one, and its reference.
///
/// # Errors
/// Where it has no such method, or its reference cannot be had.
pub fn asked_of(mut scene: Scene, method: Option<&str>) -> Result<Asked, Failure> {
    let method = method::asked(&scene, method)?;
    let reference = told_reference(&mut scene)?;
    Ok((scene, method, reference))
}

/// Where results of a scene under a method go unless another folder is asked for.
pub fn folder_of(scene: &Scene, method: &str) -> PathBuf {
    Path::new("out").join(&scene.name).join(method)
}

/// Runs the smaller scene, or says why there is none.
fn reduced(
    finding: &Finding,
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    options: &Options<'_>,
) -> Result<RunResult, Refused> {
    match finding {
        Finding::Smaller(reduction) => reduction.run(reference, options),
        finding => {
            complain(&format!("{}: not reduced: {}", scene.name, why_not(finding)));
            march::run(scene, method, reference, options)
        }
    }
}

/// Why a scene is not reduced, in words.
pub fn why_not(finding: &Finding) -> &str {
    match finding {
        Finding::Kept(reason) => reason,
        Finding::Whole | Finding::Smaller(_) => "the scene has no symmetry for a reduction",
    }
}

/// The truth about a scene, if there is one that needs no run of its own.
pub fn reference(scene: &Scene) -> Result<Option<Arc<dyn Reference>>, Failure> {
    told_reference(&mut scene.clone())
}

/// The same. Why it is not the one that the scene names is among the scene's remarks afterwards.
pub fn told_reference(scene: &mut Scene) -> Result<Option<Arc<dyn Reference>>, Failure> {
    match frazil_cases::truth(scene) {
        Ok(truth) => {
            scene.remarks.extend(truth.instead);
            Ok(truth.reference.map(Arc::from))
        }
        Err(reason) => Err(Refused::Reference(format!("the reference of scene `{}`: {reason}", scene.name)).into()),
    }
}

/// The folder of a request and the record in it.
fn record_of(request: &RunRequest, scene: &Scene, method: &str) -> Option<(PathBuf, Record)> {
    let folder = request.out.clone().unwrap_or_else(|| folder_of(scene, method));
    let record = output::record_in(&folder)?;
    Some((folder, record))
}

/// What is printed of a run as JSON.
#[derive(Serialize)]
struct Printed<'a> {
    outcome: Outcome,
    folder: &'a Path,
    /// Results by their names, which end in their units, errors among them; absent where an earlier call made the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    results: Option<BTreeMap<String, f64>>,
    record: &'a Record,
}

impl<'a> Printed<'a> {
    fn of(scene: &Scene, result: &'a RunResult, folder: &'a Path) -> Self {
        let results = numbers(scene, result).into_iter().map(|number| (number.name, number.value)).collect();
        Printed { outcome: result.record.outcome, folder, results: Some(results), record: &result.record }
    }

    /// Of a run that is in its folder already.
    fn again(folder: &'a Path, record: &'a Record) -> Self {
        Printed { outcome: record.outcome, folder, results: None, record }
    }
}

fn summary(scene: &Scene, result: &RunResult, folder: &Path) -> String {
    let record = &result.record;
    let cause = record.cause.as_ref().map_or_else(String::new, |cause| format!(": {cause}"));
    let mut lines = answers::answers(scene, result);
    if let Some(estimated) = &record.estimated_error {
        lines.push(("estimated error".into(), answers::estimated(estimated)));
    }
    if let Some(reference) = &record.reference {
        lines.extend(answers::measured(scene, &record.measured));
        lines.extend(answers::errors(&record.errors, record.water.as_ref()));
        let own = percent(reference.error_estimate_rel, 2);
        let words = format!("{}, {}; accuracy about {own}", reference.kind, reference.source);
        lines.push(("reference".into(), words));
    }
    let mut line = |title: &str, value: String| lines.push((title.to_owned(), value));
    if let Some(words) = &record.reduced_from {
        line("reduced", words.clone());
    }
    line("particles", format!("{}, pairs {}", record.particles, record.pairs));
    let bound = format!("bound {} s, set by {}", number(record.step_bound_s, 4), record.step_limit);
    line("steps", format!("{} of {} s; {bound}", record.steps, number(record.step_s, 4)));
    let (setup, solve) = (clock(record.setup_wall_s), clock(record.solve_wall_s));
    line("time", format!("{solve}, plus {setup} of setup; threads {}", record.threads));
    let moved = if record.of_water { "water" } else { "heat" };
    line(&format!("{moved} balance"), format!("{} of the {moved} exchanged", number(record.energy_balance_rel, 2)));
    if let Some(balance) = record.solute_balance_rel {
        line("solute balance", format!("{} of the solute exchanged", number(balance, 2)));
    }
    for difference in &record.differences {
        line("difference", difference.clone());
    }
    line("results", folder.display().to_string());
    let outcome = record.outcome.name();
    format!("{} with {}: {outcome}{cause}\n{}", record.scene, record.method, answers::text(&lines))
}
