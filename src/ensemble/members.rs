//! Members of an ensemble: each a run of its own in a folder of its own, made once.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use frazil_record::{Outcome, Record};
use frazil_scene::Scene;
use frazil_scene::settings::MethodSettings;
use frazil_simulation::march::{self, Options, Progress};
use frazil_simulation::reference::Reference;

use super::runs::Tables;
use super::table::Table;
use crate::failure::Failure;
use crate::progress::{Reporter, clock, countdown};
use crate::{interrupt, output, parallel};

/// States of single particles, which stand elsewhere in every member: no series.
const STATES: &str = "flow.csv";

/// What all members share.
pub struct Members<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Method and settings.
    pub settings: &'a MethodSettings,
    /// The truth, if it is known.
    pub reference: Option<&'a Arc<dyn Reference>>,
    /// Folder of the ensemble.
    pub folder: &'a Path,
    /// Their seeds.
    pub seeds: &'a [u64],
    /// How many are made at once.
    pub threads: usize,
}

/// How members came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Made {
    /// Found on disk.
    Before,
    /// Run.
    Now,
}

/// How many members there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Count {
    /// Finished, in all.
    pub finished: usize,
    /// Of these, found on disk.
    pub taken_over: usize,
}

impl Members<'_> {
    /// Folder of a member.
    pub fn folder_of(&self, seed: u64) -> PathBuf {
        self.folder.join(format!("seed-{seed}"))
    }

    /// The record of a member that came to its end with this very request; none if it is still to be run.
    pub fn record_of(&self, seed: u64) -> Option<Record> {
        let text = fs::read_to_string(self.folder_of(seed).join(output::RECORD)).ok()?;
        let record: Record = serde_json::from_str(&text).ok()?;
        let same = record.frazil_version == env!("CARGO_PKG_VERSION")
            && record.scene_hash == self.scene.hash
            && record.scene == self.scene.name
            && record.method == self.settings.method
            && record.settings == self.settings.values()
            && record.seed == seed
            && record.reduced_from.is_none();
        let ended = !matches!(record.outcome, Outcome::Interrupted | Outcome::TimedOut);
        (same && ended).then_some(record)
    }

    /// The series of a member, as it wrote them.
    pub fn tables_of(&self, seed: u64) -> Result<Tables, Failure> {
        let folder = self.folder_of(seed);
        let cannot = |path: &Path, error| Failure::file(path, "cannot be read", error);
        let mut tables = Tables::new();
        for entry in fs::read_dir(&folder).map_err(|error| cannot(&folder, error))? {
            let path = entry.map_err(|error| cannot(&folder, error))?.path();
            let Some(name) = path.file_name().and_then(|name| name.to_str()) else { continue };
            if name.ends_with(".csv") && name != STATES {
                let file = fs::File::open(&path).map_err(|error| cannot(&path, error))?;
                let table = Table::read(file).map_err(|error| cannot(&path, std::io::Error::other(error)))?;
                tables.insert(name.to_owned(), table);
            }
        }
        Ok(tables)
    }

    /// Runs the members that are not there yet, side by side, each on one thread. An interrupt leaves those that are
    /// finished.
    pub fn make(&self, quiet: bool) -> Result<Count, Failure> {
        let interrupted = interrupt::watch();
        let work = Work {
            members: self,
            interrupted,
            reporter: Reporter::new(quiet),
            failed: Mutex::new(None),
            cleared: Mutex::new(false),
            shares: self.seeds.iter().map(|_| AtomicU64::new(0)).collect(),
            taken_over: AtomicU64::new(0),
            began: Instant::now(),
        };
        let made = parallel::in_order(self.seeds.len(), self.threads, |k| work.member(k));
        work.reporter.finish();
        if let Some(failure) = work.failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(failure);
        }
        let count = |of: &dyn Fn(&Made) -> bool| made.iter().flatten().filter(|made| of(made)).count();
        Ok(Count { finished: count(&|_| true), taken_over: count(&|made| *made == Made::Before) })
    }
}

struct Work<'a> {
    members: &'a Members<'a>,
    interrupted: &'static AtomicBool,
    reporter: Reporter,
    failed: Mutex<Option<Failure>>,
    cleared: Mutex<bool>,
    /// Share of each member that is done, as bits of a number.
    shares: Vec<AtomicU64>,
    taken_over: AtomicU64,
    began: Instant,
}

impl Work<'_> {
    /// One member; none if it was not finished.
    fn member(&self, k: usize) -> Option<Made> {
        let seed = self.members.seeds[k];
        if self.interrupted.load(Ordering::Relaxed) || self.failed.lock().is_ok_and(|failed| failed.is_some()) {
            return None;
        }
        if self.members.record_of(seed).is_some() {
            self.taken_over.fetch_add(1, Ordering::Relaxed);
            self.done(k, 1.0);
            return Some(Made::Before);
        }
        match self.run(k, seed) {
            Ok(made) => made,
            Err(failure) => {
                self.failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failure);
                None
            }
        }
    }

    fn run(&self, k: usize, seed: u64) -> Result<Option<Made>, Failure> {
        let show = |progress: &Progress| self.done(k, (progress.time_s / progress.duration_s).clamp(0.0, 1.0));
        let options = Options {
            threads: 1,
            seed,
            interrupt: Some(self.interrupted),
            progress: Some(&show),
            time_limit_s: None,
            // Some series come with them.
            fields: true,
            each_output: None,
        };
        let Members { scene, settings, reference, folder, .. } = *self.members;
        let result = march::run(scene, settings.method, reference, &options)?;
        if result.record.outcome == Outcome::Interrupted {
            return Ok(None);
        }
        self.clear(folder)?;
        let path = self.members.folder_of(seed);
        fs::create_dir_all(&path).map_err(|error| Failure::file(&path, "cannot be made a folder", error))?;
        output::write_run(&path, &result)?;
        self.done(k, 1.0);
        Ok(Some(Made::Now))
    }

    /// Before the first member is written: from then on the folder holds others than those that older results speak of.
    fn clear(&self, folder: &Path) -> Result<(), Failure> {
        let mut cleared = self.cleared.lock().unwrap_or_else(PoisonError::into_inner);
        if !*cleared {
            output::clear(folder)?;
            *cleared = true;
        }
        Ok(())
    }

    /// Shows where the ensemble stands.
    fn done(&self, k: usize, share: f64) {
        self.shares[k].store(share.to_bits(), Ordering::Relaxed);
        let shares = || self.shares.iter().map(|share| f64::from_bits(share.load(Ordering::Relaxed)));
        let (all, sum) = (self.shares.len(), shares().sum::<f64>());
        self.reporter.at(sum / all as f64, || {
            let (elapsed, own) =
                (self.began.elapsed().as_secs_f64(), sum - self.taken_over.load(Ordering::Relaxed) as f64);
            let left = countdown(elapsed, own / (own + all as f64 - sum).max(f64::MIN_POSITIVE));
            let whole = shares().filter(|share| *share == 1.0).count();
            format!("{whole} of {all} members, {}{left}", clock(elapsed))
        });
    }
}
