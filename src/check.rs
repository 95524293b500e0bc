//! What a run would do, without a step of it.

use frazil_core::plan::{self, PlanSummary};

use crate::failure::{Failure, Verdict, answer, complain};
use crate::load;
use crate::run::reference;

/// Prints the plan of each method for a scene. A method that is refused does not hide the plans of the others.
pub fn check(scene: &str, methods: &[String], overrides: &[(String, String)]) -> Result<Verdict, Failure> {
    let scene = load::scene(scene, overrides)?;
    let methods: Vec<&str> = if methods.is_empty() {
        scene.methods.iter().map(|settings| settings.method).collect()
    } else {
        methods.iter().map(|asked| load::method(&scene, Some(asked))).collect::<Result<_, _>>()?
    };
    answer(&format!("{}: {}\n", scene.name, scene.title))?;
    let reference = reference(&scene)?;
    let mut verdict = Verdict::Done;
    for method in methods {
        match plan::summary(&scene, method, reference.as_ref(), 1) {
            Ok(summary) => answer(&format!("\n{method}\n{}", plan_text(&summary)))?,
            Err(refused) => {
                complain(&format!("{method}: {refused}"));
                verdict = Verdict::Broken;
            }
        }
    }
    Ok(verdict)
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
