//! Runs of a comparison, each made once: one that is known counts with the time that it took, so that a comparison that goes
//! on decides as one does that was never stopped.

use std::cell::Cell;
use std::ops::Sub;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use frazil_record::{Outcome, RunResult};
use frazil_scene::Scene;
use frazil_simulation::march::{Options, Refused};
use frazil_simulation::reference::Reference;
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64;

use super::request::CompareRequest;
use crate::campaign::{self, Campaign};
use crate::machine;
use crate::parts::{Parts, Run};

/// By how much more time a run that was cut off must be allowed to be tried again: the clock is not exact.
const MORE_TIME: f64 = 1.1;

/// What a run is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// A fine run that is to be the truth, or the one that it is judged by.
    Reference,
    /// The run of a configuration that gives its errors, and a first time.
    First,
    /// A run with another seed beside others: its time is not used.
    Seed,
    /// The repetition of this number, for its time alone.
    Repeat(usize),
}

/// A run as it is kept.
#[derive(Serialize, Deserialize)]
struct Kept {
    /// Time that it was allowed (s).
    limit_s: Option<f64>,
    /// Time that it took of that of the comparison (s).
    wall_s: f64,
    result: RunResult,
}

impl Kept {
    /// Whether it would come out alike within a limit (s).
    fn holds_within(&self, limit_s: Option<f64>) -> bool {
        let limit = |limit_s: Option<f64>| limit_s.unwrap_or(f64::INFINITY);
        self.result.record.outcome != Outcome::TimedOut || limit(limit_s) < MORE_TIME * limit(self.limit_s)
    }
}

/// A run, and the time (s) that it took before this call of the program; zero if it was made now.
pub struct Made {
    /// The run.
    pub result: RunResult,
    /// Its time, where it was known.
    pub earlier_s: f64,
}

/// How many runs there are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Count {
    /// Taken over from an earlier call of the program.
    pub known: usize,
    /// Made by this one.
    pub made: usize,
}

impl Count {
    /// How many were taken over, in words.
    pub fn words(self) -> String {
        format!("{} of {} runs taken over, with their times", self.known, self.known + self.made)
    }
}

impl Sub for Count {
    type Output = Count;

    fn sub(self, other: Count) -> Count {
        Count { known: self.known - other.known, made: self.made - other.made }
    }
}

/// Makes the runs of a comparison, or knows them.
pub struct Runner<'a> {
    run: &'a Run<'a>,
    campaign: &'a Campaign<'a>,
    /// What decides all results beside scene, method and reference.
    alike: &'static str,
    /// What decides all times.
    machine: String,
    known: AtomicUsize,
    made: AtomicUsize,
}

impl<'a> Runner<'a> {
    /// For the runs of a request.
    pub fn new(request: &CompareRequest, parts: &'a Parts<'a>, campaign: &'a Campaign<'a>) -> Self {
        let alike = if request.reduce { "reduced" } else { "whole" };
        let (known, made) = Default::default();
        Runner { run: parts.run, campaign, alike, machine: machine::identity(), known, made }
    }

    /// Whether nothing more is to be begun.
    pub fn is_stopped(&self) -> bool {
        self.campaign.is_stopped()
    }

    /// How many runs there are so far.
    pub fn counts(&self) -> Count {
        Count { known: self.known.load(Ordering::Relaxed), made: self.made.load(Ordering::Relaxed) }
    }

    /// One run.
    ///
    /// # Errors
    ///
    /// If the scene cannot be run under the method.
    pub fn run(
        &self,
        purpose: Purpose,
        scene: &Scene,
        method: &str,
        reference: Option<&Arc<dyn Reference>>,
        options: &Options<'_>,
    ) -> Result<Made, Refused> {
        let key = self.key(purpose, scene, method, reference, options);
        let known = self.campaign.known::<Kept>(&key).filter(|kept| kept.holds_within(options.time_limit_s));
        if let Some(kept) = known {
            self.known.fetch_add(1, Ordering::Relaxed);
            return Ok(Made { result: kept.result, earlier_s: kept.wall_s });
        }
        let began = Instant::now();
        let options = Options { interrupt: Some(self.campaign.stop()), ..*options };
        // Runs whose time counts are made in one go.
        let is_timed = matches!(purpose, Purpose::First | Purpose::Repeat(_));
        let mut result = match is_timed {
            true => (self.run)(scene, method, reference, &options)?,
            false => self.campaign.on_its_way(&key, |checkpoints| {
                (self.run)(scene, method, reference, &Options { checkpoints, ..options })
            })?,
        };
        if matches!(purpose, Purpose::Repeat(_)) {
            result = RunResult::bare(result.record);
        }
        self.made.fetch_add(1, Ordering::Relaxed);
        let kept = Kept { limit_s: options.time_limit_s, wall_s: began.elapsed().as_secs_f64(), result };
        if kept.result.record.outcome != Outcome::Interrupted {
            self.campaign.keep(&key, &kept);
        }
        Ok(Made { result: kept.result, earlier_s: 0.0 })
    }

    /// By what a run is known again: also by what it is judged by, and by the machine where its time counts.
    fn key(
        &self,
        purpose: Purpose,
        scene: &Scene,
        method: &str,
        reference: Option<&Arc<dyn Reference>>,
        options: &Options<'_>,
    ) -> String {
        let words = match purpose {
            Purpose::Reference => "reference".to_owned(),
            Purpose::First => "first".to_owned(),
            Purpose::Seed => "seed".to_owned(),
            Purpose::Repeat(number) => format!("repeat {number}"),
        };
        let judged = (scene.watch.front_from, reference.map(|reference| reference.describe()));
        let mut decides = format!("{judged:?} {} {}", self.alike, options.fields);
        if matches!(purpose, Purpose::First | Purpose::Repeat(_)) {
            decides += &format!(" {} {}", options.threads, self.machine);
        }
        campaign::key(&format!("{words} {:016x}", xxh3_64(decides.as_bytes())), scene, method, options.seed)
    }
}

/// The time that is spent on a scene (s), with what runs took that were known.
pub struct Clock {
    began: Instant,
    earlier: Cell<f64>,
}

impl Clock {
    /// From now on.
    pub fn start() -> Self {
        Clock { began: Instant::now(), earlier: Cell::new(0.0) }
    }

    /// Time spent so far (s).
    pub fn elapsed(&self) -> f64 {
        self.began.elapsed().as_secs_f64() + self.earlier.get()
    }

    /// Counts time (s) that was spent before this call of the program.
    pub fn add(&self, seconds: f64) {
        self.earlier.set(self.earlier.get() + seconds);
    }
}
