//! Every section, figure and table of the papers beside what the program finds: one run for each, and a page.

mod item;
mod read;
mod report;

use frazil_studies::failure::{Failure, Verdict, answer};

use crate::process_runs::ManyRuns;
pub use item::UnknownPaper;
use item::{Atlas, Judged, Outcome};

/// Makes all runs that are not there yet, and writes the table and the pages. Papers whose runs the folder holds from earlier commands
/// stay on the page.
///
/// # Errors
/// Where a paper is not known, or a file cannot be written.
pub fn atlas(request: &ManyRuns) -> Result<Verdict, Failure> {
    let mut atlas = Atlas::read()?;
    let asked = atlas.keys_of(&request.chosen)?;
    let folder = request.out.clone().unwrap_or_else(|| "out/atlas".into());
    let runs = request.in_folder(&folder);
    let own: Vec<(&str, &str)> = atlas
        .runs_in_use(|paper| asked.contains(&paper.key))
        .map(|run| (run.name.as_str(), run.command.as_str()))
        .collect();
    if !runs.make(&own)? {
        return Ok(Verdict::Broken);
    }
    let is_there = |key: &str| atlas.runs_in_use(|paper| paper.key == key).all(|run| runs.has(&run.name, &run.command));
    let mut kept = atlas.keys_of(&[])?;
    kept.retain(|key| asked.contains(key) || is_there(key));
    atlas.papers.retain(|paper| kept.contains(&paper.key));
    let judged: Vec<Vec<Judged<'_>>> =
        atlas.papers.iter().map(|paper| paper.rows.iter().map(|row| row.judge(&runs.folder)).collect()).collect();
    report::write(request, &folder, &atlas, &judged)?;
    let shown = || atlas.papers.iter().zip(&judged).filter(|(paper, _)| asked.contains(&paper.key)).flat_map(|of| of.1);
    answer(&format!("{}\n  results: {}\n", report::Counts::of(shown()), folder.display()))?;
    let broken = shown().any(|one| matches!(one.outcome, Outcome::Missing(_)));
    Ok(if broken { Verdict::CheckFailed } else { Verdict::Done })
}
