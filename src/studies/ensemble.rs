//! The same run with many seeds: members side by side, means with intervals, bias and variance apart.
//!
//! An ensemble goes one way: members, each whole in a folder of its own and kept by a campaign; then tables, record and
//! figures from these folders alone. So members known before and members just run are the same.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use frazil_core::memory;
use frazil_plots::canvas::Formats;
use frazil_plots::style::{number, percent};
use frazil_record::{Outcome, Record, RunResult};
use frazil_scene::method::MethodSettings;
use frazil_scene::{Arrangement, Scene};
use frazil_simulation::measure;
use frazil_simulation::reference::Reference;

use crate::campaign::{Campaign, Shard};
use crate::failure::{Failure, Verdict, answer, answer_json, complain};
use crate::output::{self, Folder, Owner};
use crate::progress::{bearable, clock, forewarn};
use crate::{answers, expect};

pub mod figures;
pub mod members;
pub mod record;
pub mod runs;
pub mod table;

use members::{Count, Members};
use record::{EnsembleRecord, Member};
use runs::{BadSeries, EnsembleRuns, Tables};

/// What is asked of an ensemble.
pub struct EnsembleRequest<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Method.
    pub method: &'a str,
    /// The truth, if it is known.
    pub reference: Option<&'a Arc<dyn Reference>>,
    /// Seed of the first member.
    pub seed: u64,
    /// Members.
    pub count: usize,
    /// Members that run at once.
    pub threads: usize,
    /// Folder for the results.
    pub out: &'a Path,
    /// Wall time between two checkpoints of a member; none if absent.
    pub checkpoints: Option<Duration>,
    /// As what figures are written.
    pub formats: Formats,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// Whether to print the record as JSON.
    pub json: bool,
    /// Whether to begin what takes longer than 30 days.
    pub yes: bool,
}

/// Why there is no ensemble.
#[derive(Debug, thiserror::Error)]
enum NoEnsemble {
    #[error("--method {0}: the scene has no settings for it")]
    Unset(String),
    #[error(
        "--seeds {count}: the method \"{method}\" has no noise with these settings and its particles are on a lattice, so all \
         members would be equal; use layout = \"jittered\" or \"random\""
    )]
    Alike { count: usize, method: &'static str },
    #[error("--seed {first}: {count} seeds go beyond {}", u64::MAX)]
    Beyond { first: u64, count: usize },
    #[error("a member was changed while others ran")]
    Changed,
}

/// Runs members, and takes their means.
///
/// # Errors
///
/// If nothing would tell members apart, a run is refused, or a file cannot be written.
pub fn ensemble(request: &EnsembleRequest<'_>, interrupt: &AtomicBool) -> Result<Verdict, Failure> {
    let EnsembleRequest { scene, method, reference, count, out, .. } = *request;
    let Some(settings) = scene.method(method) else {
        return Err(Failure::request(NoEnsemble::Unset(method.to_owned())));
    };
    chance(settings, count)?;
    let seeds = seeds(request.seed, count)?;
    let folder = Folder::make(out, Owner::Alone)?;
    let threads = request.threads.min(count);
    let campaign = Campaign::open(out, Shard::WHOLE, threads, interrupt)?.with_checkpoints(request.checkpoints);
    let members = Members { scene, settings, reference, folder: out, campaign: &campaign, seeds: &seeds };
    expected(request, &members, threads).inspect_err(|_| folder.take_back())?;
    let began = Instant::now();
    let made = members.make(request.quiet).inspect_err(|_| folder.take_back())?;
    if made.finished < count {
        folder.take_back();
        let stopped = if campaign.is_interrupted() { "interrupted" } else { "stopped" };
        complain(&format!(
            "{stopped}: {} of {count} members are finished; the same command runs the others",
            made.finished
        ));
        return Ok(Verdict::Broken);
    }
    let study = Study::of(&members, made, (threads, began.elapsed().as_secs_f64()), reference.map(AsRef::as_ref))?;
    study.write(out)?;
    if let Err(error) = figures::draw(&study, scene, out, request.formats, threads) {
        complain(&format!("figures: {error}"));
    }
    if request.json {
        answer_json(&study.record)?;
    } else if !request.quiet {
        answer(&study.summary(scene, out))?;
    }
    Ok(Verdict::worst(study.record.members.iter().map(|member| member.outcome)))
}

/// Says that the members to come take long, if they do, and refuses what would not end.
fn expected(request: &EnsembleRequest<'_>, members: &Members<'_>, threads: usize) -> Result<(), Failure> {
    let open = members.seeds.iter().filter(|seed| members.record_of(**seed).is_none()).count();
    memory::share(threads.min(open));
    let expected = expect::run(request.scene, request.method, request.reference, 1)?;
    let Some(one) = expected.filter(|_| open > 0) else { return Ok(()) };
    let seconds = open.div_ceil(threads.max(1)) as f64 * one.seconds;
    let what = format!("{} with {}, {open} members", request.scene.name, request.method);
    if !request.yes {
        bearable(&what, seconds, one.shorter)?;
    }
    if !request.quiet {
        forewarn(&what, Some(seconds));
    }
    Ok(())
}

/// An ensemble needs chance: without any, all members are one.
fn chance(settings: &MethodSettings, count: usize) -> Result<(), Failure> {
    if settings.discretisation.fluctuation > 0.0 || settings.numerics.arrangement != Arrangement::Lattice {
        return Ok(());
    }
    Err(Failure::request(NoEnsemble::Alike { count, method: settings.method }))
}

fn seeds(first: u64, count: usize) -> Result<Vec<u64>, Failure> {
    let last =
        first.checked_add(count as u64 - 1).ok_or(NoEnsemble::Beyond { first, count }).map_err(Failure::request)?;
    Ok((first..=last).collect())
}

/// Members and their means.
pub struct Study {
    /// The record.
    pub record: EnsembleRecord,
    /// Mean of each series, by the names of their files.
    pub means: Tables,
    /// Series of the members that came to the end, in the order of their seeds.
    pub members: Vec<Tables>,
    /// The members' runs, as far as errors are taken of them.
    runs: Vec<RunResult>,
}

impl Study {
    /// From the folders of the members.
    fn of(
        members: &Members<'_>,
        made: Count,
        (threads, wall_s): (usize, f64),
        reference: Option<&dyn Reference>,
    ) -> Result<Study, Failure> {
        let records: Vec<Record> = members.seeds.iter().filter_map(|seed| members.record_of(*seed)).collect();
        let worst = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        let first = records.first().filter(|_| records.len() == members.seeds.len());
        let first = first.cloned().ok_or(NoEnsemble::Changed).map_err(Failure::request)?;
        let entries: Vec<Member> = records.iter().map(Member::of).collect();
        let (mut tables, mut runs) = (Vec::new(), Vec::new());
        for record in records.into_iter().filter(|record| record.outcome != Outcome::Diverged) {
            let own = members.tables_of(record.seed)?;
            runs.push(runs::result(record, &own).map_err(unreadable)?);
            tables.push(own);
        }
        let spacing = members.settings.numerics.spacing;
        let mut means =
            if tables.is_empty() { Tables::new() } else { runs::means(&tables, Some(spacing)).map_err(unreadable)? };
        let mut mean = runs::result(first.clone(), &means).map_err(unreadable)?;
        mean.record.errors = Default::default();
        if let Some(reference) = reference {
            measure::attach(members.scene, spacing, &mut mean, reference);
            // Mean places differ from the members'; the reference is known there, too.
            if let Some(profiles) = means.get_mut("profiles.csv") {
                for name in ["temperature_ref_c", "saturation_ref"] {
                    if let Some(column) = profiles.column(name) {
                        profiles.put(column, mean.profiles.iter().map(|row| row.temperature_ref_c));
                    }
                }
                if let Some(column) = profiles.column("concentration_ref") {
                    profiles.put(column, mean.profiles.iter().map(|row| row.concentration_ref));
                }
            }
        }
        let errors: Vec<_> = runs.iter().map(|run| record::errors_of(&run.record)).collect();
        let split = EnsembleRuns::with_mean(members.scene, spacing, &runs, mean.record.errors.clone(), reference);
        let record = EnsembleRecord {
            frazil_version: first.frazil_version,
            scene: first.scene,
            title: first.title,
            scene_hash: first.scene_hash,
            method: first.method,
            settings: first.settings,
            units: first.units,
            seeds: members.seeds.to_vec(),
            averaged: runs.len(),
            taken_over: made.taken_over,
            errors: record::measures(&errors, &mean.record.errors),
            curves: record::splits(&split),
            reference: first.reference,
            energy_balance_rel: entries.iter().map(|member| member.energy_balance_rel).fold(0.0, worst),
            cpu_s: entries.iter().map(|member| member.cpu_s).sum(),
            members_wall_s: entries.iter().map(|member| member.wall_s).sum(),
            wall_s,
            threads,
            differences: first.differences,
            remarks: first.remarks,
            members: entries,
        };
        Ok(Study { record, means, members: tables, runs })
    }

    /// Writes the means, and last the record. Series of other runs are removed.
    fn write(&self, folder: &Path) -> Result<(), Failure> {
        output::clear(folder)?;
        for name in self.runs.iter().flat_map(output::series).map(|(name, _)| name) {
            if !self.means.contains_key(name) {
                output::remove(&folder.join(name))?;
            }
        }
        for (name, table) in &self.means {
            output::write_whole(&folder.join(name), |writer| table.write(writer))?;
        }
        output::write_json(&folder.join(output::ENSEMBLE), &self.record)
    }

    fn summary(&self, scene: &Scene, folder: &Path) -> String {
        let record = &self.record;
        let count = record.seeds.len();
        let ends = record.seeds.first().zip(record.seeds.last()).map(|(first, last)| format!("{first} to {last}"));
        let head = format!(
            "{} with {}: {count} members, seeds {}, {} of them reused\n",
            record.scene,
            record.method,
            ends.unwrap_or_default(),
            record.taken_over
        );
        let mut lines = Vec::new();
        let mut line = |title: &str, value: String| lines.push((title.to_owned(), value));
        for member in record.members.iter().filter(|member| member.outcome != Outcome::Ok) {
            let cause = member.cause.as_ref().map_or_else(String::new, |cause| format!(": {cause}"));
            line(&format!("seed {}", member.seed), format!("{}{cause}", member.outcome.name()));
        }
        for (title, name) in answers::HEADLINES {
            let Some(found) = record.errors.get(name) else { continue };
            let half =
                found.interval.map_or(String::new(), |[low, high]| format!(" +- {}", number(50.0 * (high - low), 3)));
            let mut words = format!("{}{half} % of one member", number(100.0 * found.mean, 3));
            if let Some(error) = found.of_mean {
                words.push_str(&format!(", {} of their mean", percent(error, 3)));
            }
            if let Some(split) = record.curves.get(title) {
                words.push_str(&match split.bias {
                    Some(bias) => format!(", {} of the mean of infinitely many", percent(bias, 3)),
                    None => ", bias not resolved".into(),
                });
            }
            line(&format!("{title} error"), words);
        }
        if let Some(reference) = &record.reference {
            let own = percent(reference.error_estimate_rel, 2);
            line("reference", format!("{}, {}; accuracy about {own}", reference.kind, reference.source));
        }
        let moved = if scene.of_water { "water" } else { "heat" };
        line(
            &format!("{moved} balance"),
            format!("at worst {} of the {moved} exchanged", number(record.energy_balance_rel, 2)),
        );
        let (all, now) = (clock(record.cpu_s), clock(record.wall_s));
        line("time", format!("{all} of CPU time in total, {now} now; threads {}", record.threads));
        for difference in &record.differences {
            line("difference", difference.clone());
        }
        line("results", folder.display().to_string());
        head + &answers::text(&lines)
    }
}

fn unreadable(error: BadSeries) -> Failure {
    Failure::of("series of members", error)
}
