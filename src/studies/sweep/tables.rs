//! The runs of a sweep as a file: unrounded, a row each.

use std::io;
use std::path::Path;

use super::SweepRequest;
use super::execute::{SweptRun, columns};
use crate::failure::Failure;
use crate::output::{cells, write_whole};

/// Writes `sweep.csv`.
///
/// # Errors
/// Where it cannot be written.
pub fn write(request: &SweepRequest, folder: &Path, runs: &[SweptRun]) -> Result<(), Failure> {
    let columns = columns(runs);
    write_whole(&folder.join("sweep.csv"), |writer| {
        let mut csv = cells::writer(writer);
        let keys = request.keys.iter().map(|varied| varied.key.as_str());
        let known = ["outcome", "cause", "particles", "steps", "cpu_s", "balance_rel", "state_hash"];
        let names = columns.iter().map(|(name, _)| name.as_str());
        let head: Vec<&str> = keys.chain(["method"]).chain(known).chain(names).collect();
        csv.write_record(head).map_err(io::Error::other)?;
        for run in runs {
            let finding = &run.finding;
            let known = [
                run.method.to_owned(),
                finding.outcome.map_or("refused", |outcome| outcome.name()).to_owned(),
                finding.cause.clone().unwrap_or_default(),
                finding.particles.to_string(),
                finding.steps.to_string(),
                finding.cpu_s.to_string(),
                finding.balance_rel.to_string(),
                finding.state_hash.clone(),
            ];
            let numbers = columns.iter().map(|(name, _)| run.number(name).map_or(String::new(), |one| one.to_string()));
            let row: Vec<String> = run.values.iter().cloned().chain(known).chain(numbers).collect();
            csv.write_record(row).map_err(io::Error::other)?;
        }
        csv.flush()
    })
}
