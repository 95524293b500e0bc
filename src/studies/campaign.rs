//! Many runs as one work: side by side, kept as they end, stopped together.
//!
//! Whatever a study finds is a finding under a key, and a store in the folder of its results keeps it. A study that was
//! interrupted or killed asks for the same keys again and goes on where it stood; tables, figures and pages are made of
//! findings alone, so they do not tell how often it was stopped.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use frazil_scene::Scene;
use frazil_simulation::march::{Checkpoints, Going};
use serde::Serialize;
use serde::de::DeserializeOwned;
use xxhash_rust::xxh3::xxh3_64;

use crate::failure::{Failure, complain};
use crate::parallel;
pub use meter::{Meter, Task};
pub use shard::Shard;
use store::Store;
pub use store::{build, count_of_findings, program};

mod meter;
mod shard;
mod store;

/// By what a run is known again, beside the build that made it: whatever decides what it finds. What is set neither by the
/// scene's file nor by overrides belongs to the purpose.
pub fn key(purpose: &str, scene: &Scene, method: &str, seed: u64) -> String {
    format!("{purpose} {} {} {method} {seed}", scene.name, scene.hash)
}

/// The runs of a study.
pub struct Campaign<'a> {
    store: Store,
    /// Where runs on their way have their checkpoints, and how far apart in time.
    on_their_way: PathBuf,
    between: Option<Duration>,
    workers: usize,
    stop: &'a AtomicBool,
    failure: Mutex<Option<Failure>>,
}

impl<'a> Campaign<'a> {
    /// Goes on with the campaign of a folder, or begins one: so many workers at once, until `stop` is set.
    ///
    /// # Errors
    ///
    /// If what the folder keeps cannot be read or added to.
    pub fn open(folder: &Path, shard: Shard, workers: usize, stop: &'a AtomicBool) -> Result<Self, Failure> {
        let file = shard.file();
        let on_their_way = folder.join(format!(".{file}")).with_extension("checkpoints");
        let store = Store::open(folder, &file, &build())?;
        Ok(Campaign { store, on_their_way, between: None, workers, stop, failure: Mutex::new(None) })
    }

    /// Sets the time between two checkpoints of a run; without it none are made.
    pub fn with_checkpoints(mut self, between: Option<Duration>) -> Self {
        self.between = between;
        self
    }

    /// Makes the run of a key, which goes on from where an earlier call of the program left it.
    pub fn on_its_way<T>(&self, key: &str, run: impl FnOnce(Option<&Checkpoints<'_>>) -> T) -> T {
        let folder = self.folder_of(key);
        let build = || self.store.build().to_owned();
        let kept = self.between.map(|every| Checkpoints::new(&folder, every, (&build, Going::OnFromOwn), &complain));
        run(kept.as_ref())
    }

    /// Folder of the checkpoints of the run of a key.
    fn folder_of(&self, key: &str) -> PathBuf {
        self.on_their_way.join(format!("{:016x}", xxh3_64(key.as_bytes())))
    }

    /// Whether nothing more is to be begun: it was interrupted, or something failed.
    pub fn is_stopped(&self) -> bool {
        self.is_interrupted() || self.failure.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// Whether it was interrupted.
    pub fn is_interrupted(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// What runs are to look at, to stop.
    pub fn stop(&self) -> &'a AtomicBool {
        self.stop
    }

    /// Stops everything. Of several failures the first is told.
    pub fn fail(&self, failure: Failure) {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failure);
    }

    /// Hands out the failure that stopped it.
    ///
    /// # Errors
    ///
    /// That failure.
    pub fn check(&self) -> Result<(), Failure> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(Ok(()), Err)
    }

    /// What is known under a key.
    pub fn known<F: DeserializeOwned>(&self, key: &str) -> Option<F> {
        self.store.find(key)
    }

    /// Keeps a finding. That it cannot be kept stops everything.
    pub fn keep<F: Serialize>(&self, key: &str, finding: &F) {
        match self.store.add(key, finding) {
            // Whether checkpoints of what is found can be removed decides nothing: the next study removes what is left.
            Ok(()) => drop(fs::remove_dir_all(self.folder_of(key))),
            Err(failure) => self.fail(failure),
        }
    }

    /// What `find` finds, which is known under a key from then on. Nothing where the campaign is stopped before or by it.
    pub fn make<F: Serialize>(&self, key: &str, find: impl FnOnce() -> Result<Option<F>, Failure>) -> Option<F> {
        if self.is_stopped() {
            return None;
        }
        let found = self.or_stop(find())??;
        self.keep(key, &found);
        Some(found)
    }

    /// What a result holds; a failure stops everything.
    pub fn or_stop<T>(&self, result: Result<T, Failure>) -> Option<T> {
        result.map_err(|failure| self.fail(failure)).ok()
    }

    /// Works on tasks side by side until all are done or the campaign is stopped, the dearest first, so that none is left
    /// alone at the end; of equal ones the first. Answers stand in the order of the tasks, whose prices are in any unit.
    ///
    /// # Errors
    ///
    /// The first failure of any.
    pub fn side_by_side<T: Send>(
        &self,
        prices: &[f64],
        work: impl Fn(usize) -> Option<T> + Sync,
    ) -> Result<Vec<Option<T>>, Failure> {
        let mut order: Vec<usize> = (0..prices.len()).collect();
        order.sort_by(|a, b| prices[*b].total_cmp(&prices[*a]));
        let begin = |k: usize| if self.is_stopped() { None } else { work(order[k]) };
        let answers = parallel::runs(order.len(), self.workers, begin);
        self.check()?;
        let mut sorted: Vec<(usize, Option<T>)> = order.into_iter().zip(answers).collect();
        sorted.sort_by_key(|(task, _)| *task);
        Ok(sorted.into_iter().map(|(_, answer)| answer).collect())
    }
}

impl Drop for Campaign<'_> {
    fn drop(&mut self) {
        if !self.is_stopped() {
            // Those of other studies in the same folder too.
            drop(fs::remove_dir_all(&self.on_their_way));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;

    use super::*;

    fn in_folder(test: impl Fn(&Path)) {
        test(tempfile::tempdir().expect("a folder").path());
    }

    #[test]
    fn the_dearest_task_comes_first_and_answers_stand_in_the_order_of_the_tasks() {
        in_folder(|folder| {
            let stop = AtomicBool::new(false);
            let campaign = Campaign::open(folder, Shard::WHOLE, 1, &stop).expect("opened");
            let order = Mutex::new(Vec::new());
            let work = |task: usize| {
                order.lock().expect("whole").push(task);
                (task != 2).then_some(10 * task)
            };
            let answers = campaign.side_by_side(&[1.0, 3.0, 2.0, 3.0], work).expect("no failure");
            assert_eq!(answers, [Some(0), Some(10), None, Some(30)]);
            assert_eq!(order.into_inner().expect("whole"), [1, 3, 2, 0]);
        });
    }

    #[test]
    fn what_was_found_is_not_sought_again_and_a_failure_stops_the_others() {
        in_folder(|folder| {
            let stop = AtomicBool::new(false);
            let sought = AtomicUsize::new(0);
            let run = |worse: usize| {
                let campaign = Campaign::open(folder, Shard::WHOLE, 1, &stop).expect("opened");
                campaign.side_by_side(&[0.0; 4], |task| {
                    let key = format!("task {task}");
                    let seek = || {
                        sought.fetch_add(1, Ordering::Relaxed);
                        if task == worse { Err(Failure::of("task", "no")) } else { Ok(Some(task)) }
                    };
                    campaign.known(&key).or_else(|| campaign.make(&key, seek))
                })
            };
            assert!(run(2).is_err());
            assert_eq!(sought.load(Ordering::Relaxed), 3, "the fourth was not begun");
            assert_eq!(run(9).expect("no failure"), [Some(0), Some(1), Some(2), Some(3)]);
            assert_eq!(sought.load(Ordering::Relaxed), 5, "the first two were known");
            stop.store(true, Ordering::Relaxed);
            assert_eq!(run(9).expect("no failure"), [None; 4]);
        });
    }
}
