//! Every section, figure and table of the papers beside what the program finds: one run for each, and a page.

mod item;
mod read;
mod report;

use frazil_studies::failure::{Failure, Verdict, answer};

use crate::process_runs::ManyRuns;
pub use item::UnknownPaper;
use item::{Atlas, Judged, Outcome, Run};

/// Makes all runs that are not there yet, and writes the table and the page.
///
/// # Errors
/// Where a paper is not known, or a file cannot be written.
pub fn atlas(request: &ManyRuns) -> Result<Verdict, Failure> {
    let atlas = Atlas::read()?.of_papers(&request.chosen)?;
    let folder = request.out.clone().unwrap_or_else(|| "out/atlas".into());
    let runs: Vec<&Run> = atlas.runs_in_use().collect();
    let kept = request.in_folder(&folder);
    if !kept.make(&runs.iter().map(|run| (run.name.as_str(), run.command.as_str())).collect::<Vec<_>>())? {
        return Ok(Verdict::Broken);
    }
    let judged: Vec<Vec<Judged<'_>>> =
        atlas.papers.iter().map(|paper| paper.rows.iter().map(|row| row.judge(&kept.folder)).collect()).collect();
    report::write(request, &folder, &atlas, &judged)?;
    answer(&format!("{}\n  results: {}\n", report::counts(judged.iter().flatten()), folder.display()))?;
    let broken = judged.iter().flatten().any(|one| matches!(one.outcome, Outcome::Missing(_)));
    Ok(if broken { Verdict::CheckFailed } else { Verdict::Done })
}
