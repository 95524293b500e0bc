//! What a run would do, and what it would take: the first of its steps are tried, and nothing is written.

use std::sync::Arc;

use frazil_core::memory::{self, Memory};
use frazil_layouts::soils;
use frazil_scene::Scene;
use frazil_simulation::march::Refused;
use frazil_simulation::predict::{self, Forecast};
use frazil_simulation::reduce::{self, Finding};
use frazil_simulation::reference::Reference;
use frazil_studies::failure::{Failure, Verdict, answer, complain};
use frazil_studies::method;
use frazil_studies::progress::clock;

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
}

/// Prints the plan of each method for a scene. A method that is refused does not hide the plans of the others.
pub fn check(request: &CheckRequest) -> Result<Verdict, Failure> {
    let mut scene = load::scene(&request.scene, &request.overrides)?;
    let methods: Vec<&str> = if request.methods.is_empty() {
        scene.methods.iter().map(|settings| settings.method).collect()
    } else {
        request.methods.iter().map(|asked| method::asked(&scene, Some(asked))).collect::<Result<_, _>>()?
    };
    answer(&format!("{}: {}\n", scene.name, scene.title))?;
    let reference = told_reference(&mut scene)?;
    for remark in &scene.remarks {
        answer(&format!("warning: {remark}\n"))?;
    }
    for doubt in soils::odd(&scene) {
        complain(&format!("warning: {doubt}"));
    }
    let mut verdict = Verdict::Done;
    for method in methods {
        match plan(&scene, method, reference.as_ref(), request.threads, request.reduce) {
            Ok(text) => answer(&format!("\n{method}\n{text}"))?,
            Err(refused) => {
                complain(&format!("{method}: {refused}"));
                verdict = Verdict::Broken;
            }
        }
    }
    Ok(verdict)
}

/// What a run of a scene under a method would do, in words; of the smaller scene that gives the same answer, if asked for and
/// there is one.
pub fn plan(
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    threads: usize,
    reduced: bool,
) -> Result<String, Refused> {
    let finding = reduce::find(scene, method, reference)?;
    let smaller = match &finding {
        Finding::Smaller(reduction) if reduced => &reduction.scene,
        _ => scene,
    };
    let forecast = predict::forecast(smaller, method, reference, threads, 1)?;
    Ok(format!("{}{}", reduction_text(&finding, reduced), plan_text(&forecast)))
}

/// What there is to be said of a smaller scene.
fn reduction_text(finding: &Finding, asked: bool) -> String {
    match (finding, asked) {
        (Finding::Smaller(reduction), true) => format!("  reduced      {}\n", reduction.words()),
        (Finding::Smaller(reduction), false) => {
            format!("  reduction    {} gives the same answer: {} (--reduce)\n", reduction.body(), reduction.why())
        }
        (Finding::Kept(_), _) | (Finding::Whole, true) => format!("  reduction    none: {}\n", why_not(finding)),
        (Finding::Whole, false) => String::new(),
    }
}

fn plan_text(forecast: &Forecast) -> String {
    let summary = &forecast.summary;
    let mut text = format!(
        "  particles    {}\n  pairs        {}\n  memory       {}\n  step         {:.4e} s\n  \
         step limit   {:.4e} s: {}\n  steps        {}\n  time         {}\n",
        summary.particles,
        summary.pairs,
        memory_text(&summary.memory),
        summary.step_s,
        summary.step_bound_s,
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
                "{} on {threads}: {step}; {} for outputs and looks",
                clock(seconds),
                short(forecast.cost.beside(work))
            )
        }
        _ => format!("unknown, as the number of steps is: {step}, {threads}"),
    }
}

fn short(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.2} us", 1e6 * s),
        s => clock(s),
    }
}
