//! A run made again from its record, and whether it came to the same state.

use std::fs;
use std::path::{Path, PathBuf};

use frazil_plots::canvas::Formats;
use frazil_record::{Provenance, Record, quoted};
use frazil_scene::files::is_beside;
use frazil_studies::failure::{Failure, Verdict, answer};
use frazil_studies::output::{self, make_folder};

use crate::provenance;
use crate::run::{self, RunRequest};

/// What is to be made again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RerunRequest {
    /// The record, or its folder.
    pub record: PathBuf,
    /// Folder for the results; `out/rerun/SCENE` if absent.
    pub out: Option<PathBuf>,
    /// Threads.
    pub threads: usize,
    /// The command as it was typed.
    pub command_line: String,
    /// Whether to say nothing but errors.
    pub quiet: bool,
}

/// Why a record cannot be run again.
#[derive(Debug, thiserror::Error)]
enum NoRerun {
    #[error("{0}: no record of a run: {1}")]
    Record(String, serde_json::Error),
    #[error(
        "{0}: does not hold the scene that was run; `frazil run` writes it since version 0.1.0, runs of studies and members of \
         ensembles have the command in their tables"
    )]
    Scene(String),
    #[error("{0}: names the file {name}, which does not lie beside the scene", name = quoted(.1))]
    File(String, String),
    #[error("{0}: holds no hash of a state: the run did not come to its end")]
    End(String),
}

/// Makes the run of a record again, and compares.
///
/// # Errors
/// Where the record is none, or the run cannot be made.
pub fn rerun(request: &RerunRequest) -> Result<Verdict, Failure> {
    let (record, provenance) = read(&request.record)?;
    let out = request.out.clone().unwrap_or_else(|| Path::new("out/rerun").join(&provenance.scene));
    make_folder(&out)?;
    let scene = out.join(format!("{}.toml", provenance.scene));
    write(&scene, &provenance.scene_file)?;
    for (name, text) in &provenance.files {
        // A record is a file like any other: what it names may lead anywhere.
        if !is_beside(name) {
            return Err(Failure::request(NoRerun::File(request.record.display().to_string(), name.clone())));
        }
        let file = out.join(name);
        file.parent().map_or(Ok(()), make_folder)?;
        write(&file, text)?;
    }
    let results = out.join(&record.method);
    let verdict = run::run(&RunRequest {
        scene: scene.display().to_string(),
        method: Some(record.method.clone()),
        overrides: provenance.overrides.clone(),
        threads: request.threads,
        seed: record.seed,
        out: Some(results.clone()),
        reduce: provenance.reduce,
        estimated: None,
        fields: false,
        frames: false,
        formats: Formats::SVG,
        checkpoints: None,
        resume: false,
        quiet: request.quiet,
        json: false,
        yes: true,
        command_line: request.command_line.clone(),
    })?;
    let Some(again) = output::record_in(&results) else { return Ok(Verdict::Broken) };
    if again.state_hash == record.state_hash {
        if !request.quiet {
            answer(&format!("the same state: {}\n", again.state_hash))?;
        }
        return Ok(verdict);
    }
    answer(&format!(
        "another state: {} in the record, {} now\n{}",
        record.state_hash,
        again.state_hash,
        apart(&record, &again)
    ))?;
    Ok(verdict.max(Verdict::CheckFailed))
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    output::write_whole(path, |writer| writer.write_all(text.as_bytes()))
}

/// A record that can be run again, by its file or folder.
fn read(path: &Path) -> Result<(Record, Provenance), Failure> {
    let file = if path.is_dir() { path.join("record.json") } else { path.to_owned() };
    let name = file.display().to_string();
    let text = fs::read_to_string(&file).map_err(|error| Failure::file(&file, "cannot be read", error))?;
    let record: Record =
        serde_json::from_str(&text).map_err(|error| Failure::request(NoRerun::Record(name.clone(), error)))?;
    let Some(provenance) = record.provenance.clone() else { return Err(Failure::request(NoRerun::Scene(name))) };
    if record.state_hash.is_empty() {
        return Err(Failure::request(NoRerun::End(name)));
    }
    Ok((record, provenance))
}

/// What may make two states differ, a line each.
fn apart(record: &Record, again: &Record) -> String {
    let now = provenance::machine();
    let then = record.provenance.clone().unwrap_or_default();
    let rows = [
        ("version", &record.frazil_version, &again.frazil_version),
        ("commit", &then.commit.unwrap_or_default(), &now.commit.unwrap_or_default()),
        ("compiler", &then.compiler, &now.compiler),
        ("processor", &then.processor, &now.processor),
        ("system", &then.system, &now.system),
        ("outcome", &record.outcome.name().to_owned(), &again.outcome.name().to_owned()),
    ];
    let differ = rows.into_iter().filter(|(_, then, now)| then != now);
    differ.map(|(what, then, now)| format!("  {what:10} {then} in the record, {now} now\n")).collect()
}
