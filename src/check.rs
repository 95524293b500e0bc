//! What a run would do, and what it would take: the first of its steps are tried, and nothing is written.

use std::cell::Cell;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use frazil_core::memory::{self, Memory};
use frazil_layouts::soils;
use frazil_plots::style::number;
use frazil_scene::Scene;
use frazil_simulation::march::Refused;
use frazil_simulation::predict::{self, Forecast};
use frazil_simulation::reduce::{self, Finding};
use frazil_simulation::reference::Reference;
use frazil_studies::failure::{Failure, Verdict, answer, answer_json, complain};
use frazil_studies::method;
use frazil_studies::progress::clock;
use serde::Serialize;

use crate::load;
use crate::run::{told_reference, why_not};

/// What is to be checked.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckRequest {
    /// Scene, by path or bundled name.
    pub scene: String,
    /// Methods; all that the scene has settings for if empty.
    pub methods: Vec<String>,
    /// Pairs of key path and value that override the file.
    pub overrides: Vec<(String, String)>,
    /// Threads of the run.
    pub threads: usize,
    /// Whether a smaller scene that gives the same answer is to be planned instead.
    pub reduce: bool,
    /// Whether to print JSON.
    pub json: bool,
}

/// Prints the plan of each method for a scene. A method that is refused does not hide the plans of the others, and neither does
/// one that takes longer to plan than a check has.
pub fn check(request: &CheckRequest) -> Result<Verdict, Failure> {
    let patience = Patience::begin();
    let (argument, overrides) = (request.scene.clone(), request.overrides.clone());
    let read = move || -> Result<Read, Failure> {
        let mut scene = load::scene(&argument, &overrides)?;
        let reference = told_reference(&mut scene)?;
        Ok((scene, reference))
    };
    let Some(read) = patience.wait(1, read) else { return Err(Failure::request(NotRead(request.scene.clone()))) };
    let (scene, reference) = read?;
    let methods: Vec<&'static str> = if request.methods.is_empty() {
        scene.methods.iter().map(|settings| settings.method).collect()
    } else {
        request.methods.iter().map(|asked| method::asked(&scene, Some(asked))).collect::<Result<_, _>>()?
    };
    let mut said = Said { json: request.json, checked: Checked::of(&scene) };
    said.begin()?;
    for doubt in soils::odd(&scene) {
        complain(&format!("warning: {doubt}"));
    }
    let mut verdict = Verdict::Done;
    let (scene, count) = (Arc::new(scene), methods.len());
    for (k, method) in methods.into_iter().enumerate() {
        let (threads, reduce) = (request.threads, request.reduce);
        let (own, reference) = (scene.clone(), reference.clone());
        let planned = patience.wait(count - k, move || planned(&own, method, reference.as_ref(), threads, reduce));
        match planned {
            Some(Ok((forecast, text))) => said.planned(method, &forecast, &text)?,
            Some(Err(refused)) => {
                said.refused(method, &refused);
                verdict = Verdict::Broken;
            }
            None => {
                said.unplanned(method, &scene)?;
                verdict = verdict.max(Verdict::CheckFailed);
            }
        }
    }
    said.end()?;
    Ok(verdict)
}

/// What a check found, as JSON has it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
struct Checked {
    scene: String,
    title: String,
    warnings: Vec<String>,
    plans: Vec<Planned>,
}

/// What is known of the run of one method.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Planned {
    method: &'static str,
    /// `planned`, `refused` or `not_planned`, where planning takes longer than a check has.
    state: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    cause: Option<String>,
    #[serde(flatten)]
    plan: Option<PlanNumbers>,
}

/// The plan of a run as numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanNumbers {
    /// Particles.
    pub particles: u64,
    /// Pairs.
    pub pairs: u64,
    /// What the run holds to its end (bytes).
    pub memory_bytes: usize,
    /// Step (s).
    pub step_s: f64,
    /// Step bound (s).
    pub step_bound_s: f64,
    /// What sets it.
    pub step_limit: String,
    /// Number of steps; absent where it is not known.
    pub steps: Option<u64>,
    /// Run time on this machine (s); absent where the number of steps is not known.
    pub wall_s: Option<f64>,
}

impl PlanNumbers {
    /// Of a forecast.
    pub fn of(forecast: &Forecast) -> Self {
        let summary = &forecast.summary;
        PlanNumbers {
            particles: summary.particles,
            pairs: summary.pairs,
            memory_bytes: summary.memory.total(),
            step_s: summary.step_s,
            step_bound_s: summary.step_bound_s,
            step_limit: summary.step_limit.clone(),
            steps: summary.steps.number(),
            wall_s: forecast.seconds(),
        }
    }
}

impl Checked {
    fn of(scene: &Scene) -> Self {
        let (scene, title, warnings) = (scene.name.clone(), scene.title.clone(), scene.remarks.clone());
        Checked { scene, title, warnings, plans: Vec::new() }
    }
}

/// What is printed of a check: text as it is found, JSON at the end.
struct Said {
    json: bool,
    checked: Checked,
}

impl Said {
    fn begin(&self) -> Result<(), Failure> {
        if self.json {
            return Ok(());
        }
        answer(&format!("{}: {}\n", self.checked.scene, self.checked.title))?;
        self.checked.warnings.iter().try_for_each(|remark| answer(&format!("warning: {remark}\n")))
    }

    fn planned(&mut self, method: &'static str, forecast: &Forecast, text: &str) -> Result<(), Failure> {
        let plan = Some(PlanNumbers::of(forecast));
        self.checked.plans.push(Planned { method, state: "planned", cause: None, plan });
        if self.json { Ok(()) } else { answer(&format!("\n{method}\n{text}")) }
    }

    fn refused(&mut self, method: &'static str, refused: &Refused) {
        complain(&format!("{method}: {refused}"));
        self.checked.plans.push(Planned { method, state: "refused", cause: Some(refused.to_string()), plan: None });
    }

    fn unplanned(&mut self, method: &'static str, scene: &Scene) -> Result<(), Failure> {
        self.checked.plans.push(Planned { method, state: "not_planned", cause: Some(too_long()), plan: None });
        if self.json { Ok(()) } else { answer(&format!("\n{method}\n{}", unplanned(scene, method))) }
    }

    fn end(&self) -> Result<(), Failure> {
        if self.json { answer_json(&self.checked) } else { Ok(()) }
    }
}

/// A scene, and the truth about it if there is one.
type Read = (Scene, Option<Arc<dyn Reference>>);

/// A scene that is not read, or has no reference, within the time that a check has.
#[derive(Debug, thiserror::Error)]
#[error("{0}: reading it and solving for its reference takes longer than the time limit of check, {LONGEST} s")]
struct NotRead(String);

/// Time (s) after which a check ends.
const LONGEST: f64 = 2.0;
/// Part of it that is left for what the program does besides.
const BESIDES: f64 = 0.3;
/// On a machine that is busy with other things it waits as much longer (s) as its threads wait for a core, at most.
const BUSY: f64 = 5.0;

/// Time (s) in which most methods of most scenes are planned and tried; it is left to those that come later.
const ENOUGH: f64 = 0.25;

/// What is left of the time of a check.
struct Patience {
    began: Instant,
    /// How long (s) threads that are done have waited for a core.
    waited: Cell<f64>,
}

impl Patience {
    fn begin() -> Self {
        Patience { began: Instant::now(), waited: Cell::new(0.0) }
    }

    /// Time (s) that is left.
    fn left(&self) -> f64 {
        LONGEST - BESIDES - self.began.elapsed().as_secs_f64() + (self.waited.get() + waiting()).min(BUSY)
    }

    /// What some work makes, unless that leaves too little to the others of so many works in all. It goes on where nobody waits for
    /// it any more, up to the end of the program.
    fn wait<T: Send + 'static>(&self, works: usize, work: impl FnOnce() -> T + Send + 'static) -> Option<T> {
        let (tell, told) = mpsc::channel();
        let work = move || {
            // Nobody may be waiting.
            let made = work();
            let _ = tell.send((made, waited(Path::new("/proc/thread-self")).unwrap_or(0.0)));
        };
        thread::Builder::new().stack_size(STACK).spawn(work).ok()?;
        let left = self.left();
        let rest = (ENOUGH * (works - 1) as f64).min(left * (1.0 - 1.0 / works as f64));
        loop {
            match told.recv_timeout(LOOK) {
                Ok((made, waited)) => {
                    self.waited.set(self.waited.get() + waited);
                    return Some(made);
                }
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) if self.left() <= rest => return None,
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }
}

/// How often the time that is left is looked at.
const LOOK: Duration = Duration::from_millis(20);

/// How long (s) that of the threads at work has waited for a core that has waited longest, where the system tells.
fn waiting() -> f64 {
    let Ok(threads) = fs::read_dir("/proc/self/task") else { return 0.0 };
    threads.flatten().filter_map(|thread| waited(&thread.path())).fold(0.0, f64::max)
}

/// How long (s) a thread was ready to work and had no core.
fn waited(thread: &Path) -> Option<f64> {
    let text = fs::read_to_string(thread.join("schedstat")).ok()?;
    Some(1e-9 * text.split_whitespace().nth(1)?.parse::<f64>().ok()?)
}

/// Stack of a thread that works in place of the first one (bytes), as large as that one's.
const STACK: usize = 8 << 20;

/// What is known of a run that is not planned within the time of a check: what can be counted without a plan.
fn unplanned(scene: &Scene, method: &str) -> String {
    let counted = predict::counted(scene, method);
    let words = counted.map(|counted| {
        format!(
            "  particles    about {:.1e}, and {:.1e} pairs\n  memory       at least {}\n",
            counted.particles,
            counted.pairs,
            memory::words(counted.bytes)
        )
    });
    format!("{}  not planned  {}\n", words.unwrap_or_default(), too_long())
}

/// Why a run is not planned.
fn too_long() -> String {
    format!(
        "planning and trying it takes longer than the time limit of check, {LONGEST} s; a larger spacing is planned faster"
    )
}

/// What a run of a scene under a method would do, as numbers and in words; of the smaller scene that gives the same answer, if
/// asked for and there is one.
///
/// # Errors
/// What the plan of the run refuses.
pub fn planned(
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    threads: usize,
    reduced: bool,
) -> Result<(Forecast, String), Refused> {
    let finding = reduce::find(scene, method, reference)?;
    let smaller = match &finding {
        Finding::Smaller(reduction) if reduced => &reduction.scene,
        _ => scene,
    };
    let forecast = predict::forecast(smaller, method, reference, threads, 1)?;
    let text = format!("{}{}", reduction_text(&finding, reduced), plan_text(&forecast));
    Ok((forecast, text))
}

/// What there is to be said of a smaller scene.
fn reduction_text(finding: &Finding, asked: bool) -> String {
    match (finding, asked) {
        (Finding::Smaller(reduction), true) => format!("  reduced      {}\n", reduction.words()),
        (Finding::Smaller(reduction), false) => {
            format!("  reduction    {} has the same solution: {} (--reduce)\n", reduction.body(), reduction.why())
        }
        (Finding::Kept(_), _) | (Finding::Whole, true) => format!("  reduction    none: {}\n", why_not(finding)),
        (Finding::Whole, false) => String::new(),
    }
}

fn plan_text(forecast: &Forecast) -> String {
    let summary = &forecast.summary;
    let mut text = format!(
        "  particles    {}\n  pairs        {}\n  memory       {}\n  step         {} s\n  \
         step limit   {} s: {}\n  steps        {}\n  time         {}\n",
        summary.particles,
        summary.pairs,
        memory_text(&summary.memory),
        number(summary.step_s, 4),
        number(summary.step_bound_s, 4),
        summary.step_limit,
        summary.steps,
        time_text(forecast)
    );
    let lists = [
        ("uses", &summary.used),
        ("spared", &summary.spared),
        ("relaxed by", &summary.relaxed_by),
        ("differences", &summary.differences),
    ];
    for (title, lines) in lists {
        for (index, line) in lines.iter().enumerate() {
            text.push_str(&format!("  {:<12} {line}\n", if index == 0 { title } else { "" }));
        }
    }
    text
}

fn memory_text(memory: &Memory) -> String {
    let parts =
        [("particles", memory.particles), ("pairs, walls and step", memory.method), ("results", memory.observers)];
    let parts = parts.map(|(name, bytes)| format!("{name} {}", size(bytes)));
    format!("{}: {}", size(memory.total()), parts.join(", "))
}

fn size(bytes: usize) -> String {
    memory::words(bytes as f64)
}

/// The time and what it rests on.
fn time_text(forecast: &Forecast) -> String {
    let step = format!("{} a step, measured over {} steps now", short(forecast.cost.step), forecast.timed_steps);
    let threads = if forecast.threads == 1 { "1 thread".into() } else { format!("{} threads", forecast.threads) };
    match (forecast.seconds(), &forecast.work) {
        (Some(seconds), Some(work)) => {
            format!(
                "{} on {threads}: {step}; {} for outputs and observers",
                clock(seconds),
                short(forecast.cost.beside(work))
            )
        }
        _ if forecast.summary.steps.number().is_some() => {
            format!("unknown: the first steps give values that are not finite; {threads}")
        }
        _ => format!("unknown, like the number of steps: {step}, {threads}"),
    }
}

fn short(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.2} us", 1e6 * s),
        s => clock(s),
    }
}
