//! What a run would do, without a step of it.

use frazil_core::plan::{self, PlanSummary};
use frazil_core::reduce::{self, Finding};

use crate::failure::{Failure, Verdict, answer, complain};
use crate::load;
use crate::run::{reference, why_not};

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
    let scene = load::scene(&request.scene, &request.overrides)?;
    let methods: Vec<&str> = if request.methods.is_empty() {
        scene.methods.iter().map(|settings| settings.method).collect()
    } else {
        request.methods.iter().map(|asked| load::method(&scene, Some(asked))).collect::<Result<_, _>>()?
    };
    answer(&format!("{}: {}\n", scene.name, scene.title))?;
    let reference = reference(&scene)?;
    let mut verdict = Verdict::Done;
    for method in methods {
        let planned = reduce::find(&scene, method, reference.as_ref()).and_then(|finding| {
            let smaller = match &finding {
                Finding::Smaller(reduction) if request.reduce => &reduction.scene,
                _ => &scene,
            };
            let summary = plan::summary(smaller, method, reference.as_ref(), 1)?;
            Ok(format!("{}{}", reduction_text(&finding, request.reduce), plan_text(&summary)))
        });
        match planned {
            Ok(text) => answer(&format!("\n{method}\n{text}"))?,
            Err(refused) => {
                complain(&format!("{method}: {refused}"));
                verdict = Verdict::Broken;
            }
        }
    }
    Ok(verdict)
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

fn plan_text(summary: &PlanSummary) -> String {
    let megabytes = summary.memory_bytes as f64 / 1e6;
    let mut text = format!(
        "  particles    {}\n  pairs        {}\n  memory       {megabytes:.1} MB\n  step         {:.4e} s\n  \
         step limit   {:.4e} s: {}\n  steps        {}\n",
        summary.particles, summary.pairs, summary.step_s, summary.step_bound_s, summary.step_limit, summary.steps
    );
    for (title, lines) in [("uses", &summary.used), ("spared", &summary.spared), ("differences", &summary.differences)]
    {
        for (index, line) in lines.iter().enumerate() {
            text.push_str(&format!("  {:<12} {line}\n", if index == 0 { title } else { "" }));
        }
    }
    text
}
