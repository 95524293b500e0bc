//! Members of an ensemble: each a run of its own in a folder of its own, made once.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use frazil_record::{Outcome, Record};
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;
use frazil_simulation::march::{self, Checkpoints, Options, Progress};
use frazil_simulation::reference::Reference;

use super::runs::Tables;
use super::table::Table;
use crate::campaign::{self, Campaign, Meter};
use crate::failure::Failure;
use crate::output;

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
    /// What keeps them.
    pub campaign: &'a Campaign<'a>,
    /// Their seeds.
    pub seeds: &'a [u64],
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

    fn key(&self, seed: u64) -> String {
        campaign::key("member", self.scene, self.settings.method, seed)
    }

    /// The record of a member that came to its end and stands in its folder; none if it is still to be run.
    pub fn record_of(&self, seed: u64) -> Option<Record> {
        self.campaign.known(&self.key(seed)).filter(|record| output::holds(&self.folder_of(seed), record))
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

    /// Runs the members that are not there yet, each on one thread. An interrupt leaves those that are finished.
    pub fn make(&self, quiet: bool) -> Result<Count, Failure> {
        let work = Work {
            members: self,
            meter: Meter::new(quiet, self.seeds.len() as f64),
            whole: AtomicUsize::new(0),
            cleared: Mutex::new(false),
        };
        let made = self.campaign.side_by_side(&vec![1.0; self.seeds.len()], |k| work.member(self.seeds[k]));
        work.meter.finish();
        let made: Vec<Made> = made?.into_iter().flatten().collect();
        let taken_over = made.iter().filter(|made| **made == Made::Before).count();
        Ok(Count { finished: made.len(), taken_over })
    }
}

struct Work<'a> {
    members: &'a Members<'a>,
    meter: Meter,
    whole: AtomicUsize,
    cleared: Mutex<bool>,
}

impl Work<'_> {
    /// One member; none if it was not finished.
    fn member(&self, seed: u64) -> Option<Made> {
        let Members { campaign, .. } = *self.members;
        if self.members.record_of(seed).is_some() {
            self.whole.fetch_add(1, Ordering::Relaxed);
            self.meter.skip(1.0);
            return Some(Made::Before);
        }
        campaign.make(&self.members.key(seed), || self.run(seed)).map(|_| Made::Now)
    }

    /// Runs a member, its files before all else: what is kept has its folder. None if it was interrupted.
    fn run(&self, seed: u64) -> Result<Option<Record>, Failure> {
        let Members { scene, settings, reference, folder, campaign, seeds } = *self.members;
        let task = self.meter.task(1.0);
        let words = |_| format!("{} of {} members", self.whole.load(Ordering::Relaxed), seeds.len());
        let show = |progress: &Progress| task.at(progress.time_s / progress.duration_s, words);
        let options = Options {
            threads: 1,
            seed,
            interrupt: Some(campaign.stop()),
            progress: Some(&show),
            time_limit_s: None,
            // Some series come with them.
            fields: true,
            prepared: None,
            each_output: None,
            checkpoints: None,
        };
        let run = |checkpoints: Option<&Checkpoints<'_>>| {
            march::run(scene, settings.method, reference, &Options { checkpoints, ..options })
        };
        let result = campaign.on_its_way(&self.members.key(seed), run)?;
        if result.record.outcome == Outcome::Interrupted {
            return Ok(None);
        }
        self.clear(folder)?;
        let path = self.members.folder_of(seed);
        output::make_folder(&path)?;
        output::write_run(&path, &result)?;
        self.whole.fetch_add(1, Ordering::Relaxed);
        task.at(1.0, words);
        Ok(Some(result.record))
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
}
