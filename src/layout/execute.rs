//! Runs of all layouts, side by side; those that a folder holds are not run again.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use frazil_core::particles::Particles;
use frazil_plots::ground_plan::ShaftMark;
use frazil_plots::{FigureOptions, run_figures};
use frazil_record::Outcome;
use frazil_scene::Scene;
use frazil_simulation::march::{self, EachOutput, Options};
use frazil_simulation::predict;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::answers::Kept;
use super::study::Study;
use super::variants::{Layout, Role};
use crate::failure::{Failure, complain};
use crate::fields::{self, Snapshots};
use crate::machine::Machine;
use crate::progress::{Reporter, countdown};
use crate::{interrupt, load, output, parallel};

/// What a folder keeps of a layout: a run, and the same at twice the spacing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// Name of the layout, program and both scenes, by which it is known again.
    key: String,
    /// The run.
    pub fine: Kept,
    /// The same at twice the spacing; none where that is too coarse for the layout.
    pub coarse: Option<Kept>,
    /// Why not.
    pub refused: Option<String>,
}

/// By what a layout that is kept is known again.
#[derive(Debug, Serialize, Deserialize)]
struct Known {
    key: String,
}

/// Why a method cannot run a layout.
#[derive(Debug, Serialize, Deserialize)]
struct Refusal {
    key: String,
    reason: String,
}

/// File of a layout that is whole.
const KEPT: &str = "layout.json";

/// File of a layout that the method cannot run.
const REFUSED: &str = "refused.json";

/// About how long (s) a layout takes, from its first steps; absent where they do not tell.
pub(super) fn seconds_of(scene: &Scene, method: &str) -> Option<f64> {
    let fine = predict::forecast(scene, method, None, 1, 1).ok()?.seconds()?;
    // Also at twice the spacing: an eighth, or less where steps are few.
    Some(1.125 * fine)
}

/// Runs of a study.
pub struct Work<'a> {
    /// The study.
    pub study: &'a Study,
    /// Method.
    pub method: &'static str,
    /// Whether it stands beside another method: only layouts that are compared are run, and those that it cannot run are left.
    pub beside: bool,
    /// Folder.
    pub folder: PathBuf,
    /// Workers.
    pub threads: usize,
    /// Which part of the layouts is to be run, of how many.
    pub shard: (usize, usize),
    /// Whether layouts that are compared leave frames of an animation.
    pub frames: bool,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// What tells this build of the program from others: what another has left is made anew.
    pub build: &'a str,
    /// The machine, as it was at the start.
    pub machine: Machine,
}

impl Work<'_> {
    /// All layouts of this shard that are not there yet; returns how many were run, or that it was interrupted.
    pub fn make(&self) -> Result<Option<usize>, Failure> {
        let layouts = &self.study.layouts;
        let wanted = self.wanted();
        let reporter = Reporter::new(self.quiet);
        let (began, done, failed) = (Instant::now(), AtomicUsize::new(0), Mutex::new(None));
        let made = parallel::in_order(wanted.len(), self.threads, |k| {
            let stopped = interrupt::watch().load(Ordering::Relaxed);
            if stopped || failed.lock().unwrap_or_else(PoisonError::into_inner).is_some() {
                return None;
            }
            match self.layout(&layouts[wanted[k]]) {
                Ok(true) => {
                    let count = done.fetch_add(1, Ordering::Relaxed) + 1;
                    let share = count as f64 / wanted.len() as f64;
                    reporter.at(share, || {
                        let left = countdown(began.elapsed().as_secs_f64(), share);
                        format!("{count} of {} layouts{left}", wanted.len())
                    });
                    Some(())
                }
                Ok(false) => None,
                Err(failure) => {
                    failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failure);
                    None
                }
            }
        });
        reporter.finish();
        if let Some(failure) = failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(failure);
        }
        let count = made.iter().flatten().count();
        Ok((count == wanted.len()).then_some(count))
    }

    /// The layouts of this shard that are not there yet, the longest first, so that none is left alone at the end.
    fn wanted(&self) -> Vec<usize> {
        let (shard, shards) = self.shard;
        let layouts = &self.study.layouts;
        let own: Vec<usize> = (0..layouts.len())
            .filter(|k| k % shards == shard && (!self.beside || layouts[*k].role == Role::Compared))
            .collect();
        let open = |k: usize| (!self.is_done(&layouts[own[k]])).then_some(own[k]);
        let mut wanted: Vec<usize> = parallel::in_order(own.len(), self.threads, open).into_iter().flatten().collect();
        wanted.sort_by_key(|k| layouts[*k].images());
        wanted
    }

    /// About how long (s) these take, from the first steps of one of them; absent where they do not tell.
    pub fn seconds(&self) -> Option<f64> {
        let layouts = &self.study.layouts;
        let wanted = self.wanted();
        let first = &layouts[*wanted.first()?];
        let one = seconds_of(&first.scene, self.method)?;
        let share = |k: &usize| first.images() as f64 / layouts[*k].images() as f64;
        let all = one * wanted.iter().map(share).sum::<f64>();
        Some(all / self.threads.min(wanted.len()) as f64)
    }

    /// Whether nothing is left to other shards, so that what is sought can be tried.
    pub fn is_last(&self) -> bool {
        let (shard, shards) = self.shard;
        let mut others = self.study.layouts.iter().enumerate().filter(|(k, _)| k % shards != shard);
        others.all(|(_, layout)| self.is_done(layout))
    }

    /// Folder of a layout.
    pub fn folder_of(&self, layout: &Layout) -> PathBuf {
        let plain: String = layout
            .name
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() || "-._".contains(c) { c } else { '_' })
            .take(60)
            .collect();
        // Names that differ in other letters only stay apart.
        let hash = xxhash_rust::xxh3::xxh3_64(layout.name.as_bytes()) & 0xffff_ffff;
        self.folder.join("layouts").join(format!("{plain}-{hash:08x}"))
    }

    fn key(&self, layout: &Layout) -> String {
        format!("{} {} {} {}", self.build, layout.name, self.method, layout.scene.hash)
    }

    fn draws_frames(&self, layout: &Layout) -> bool {
        self.frames && layout.role == Role::Compared && !self.beside
    }

    fn lacks_frames(&self, layout: &Layout) -> bool {
        self.draws_frames(layout) && !self.folder_of(layout).join(fields::NAMES[2]).is_dir()
    }

    /// A file of the folder of a layout, if it is of this layout.
    fn read<T: DeserializeOwned>(&self, layout: &Layout, name: &str, key: fn(&T) -> &str) -> Option<T> {
        let text = fs::read_to_string(self.folder_of(layout).join(name)).ok()?;
        let found: T = serde_json::from_str(&text).ok()?;
        (key(&found) == self.key(layout)).then_some(found)
    }

    /// What is known of a layout; nothing while frames are wanted that it has not left.
    pub fn kept(&self, layout: &Layout) -> Option<Pair> {
        if self.lacks_frames(layout) { None } else { self.read(layout, KEPT, |pair: &Pair| &pair.key) }
    }

    /// Why the method cannot run a layout, where it has been found that it cannot.
    pub fn refused(&self, layout: &Layout) -> Option<String> {
        let found = self.read(layout, REFUSED, |refusal: &Refusal| &refusal.key);
        found.filter(|_| self.beside).map(|refusal| refusal.reason)
    }

    fn is_done(&self, layout: &Layout) -> bool {
        let known = || self.read(layout, KEPT, |known: &Known| &known.key).is_some();
        (!self.lacks_frames(layout) && known()) || self.refused(layout).is_some()
    }

    /// What is known of a layout, which is run if nothing is; none if it was interrupted.
    pub(super) fn made(&self, layout: &Layout) -> Result<Option<Pair>, Failure> {
        layout.check(self.study.shaft_radius, self.method)?;
        if let Some(pair) = self.kept(layout) {
            return Ok(Some(pair));
        }
        Ok(if self.layout(layout)? { self.kept(layout) } else { None })
    }

    /// One layout; says whether it came to its end.
    fn layout(&self, layout: &Layout) -> Result<bool, Failure> {
        let named = |failure: Failure| Failure::Request(format!("layout \"{}\": {failure}", layout.name));
        let path = self.folder_of(layout);
        fs::create_dir_all(&path).map_err(|error| Failure::file(&path, "cannot be made a folder", error))?;
        let wanted = self.draws_frames(layout);
        let frames =
            if wanted { Some(Snapshots::new(&layout.scene, self.method, (false, true), &path)?) } else { None };
        let see = |particles: &Particles, time: f64| {
            if let Some(frames) = &frames {
                frames.see(particles, time);
            }
        };
        let options = Options {
            threads: 1,
            seed: 1,
            interrupt: Some(interrupt::watch()),
            progress: None,
            time_limit_s: None,
            fields: layout.role == Role::Compared && !self.beside,
            each_output: None,
        };
        let run = |scene: &Scene, see: Option<&EachOutput<'_>>| {
            let options = Options { each_output: see, ..options };
            march::run(scene, self.method, None, &options).map_err(Failure::from)
        };
        let seen: Option<&EachOutput<'_>> = if frames.is_some() { Some(&see) } else { None };
        let tried = match self.beside {
            true => layout.check(self.study.shaft_radius, self.method).and_then(|()| run(&layout.scene, seen)),
            false => run(&layout.scene, seen).map_err(named),
        };
        let fine = match tried {
            Ok(fine) => fine,
            Err(failure) if self.beside => {
                let refusal = Refusal { key: self.key(layout), reason: failure.to_string() };
                return output::write_json(&path.join(REFUSED), &refusal).map(|()| true);
            }
            Err(failure) => return Err(failure),
        };
        if matches!(fine.record.outcome, Outcome::Interrupted | Outcome::TimedOut) {
            return Ok(false);
        }
        let (mut coarse, mut refused) = (None, None);
        match self.coarser(layout).and_then(|scene| Ok((run(&scene, None)?, scene))) {
            Ok((result, _)) if result.record.outcome == Outcome::Interrupted => return Ok(false),
            Ok((result, scene)) => coarse = Some(Kept::of(&scene, &result)),
            Err(failure) => refused = Some(failure.to_string()),
        }
        output::write_run_and(&path, &fine, || frames.map_or(Ok(()), |frames| frames.finish(&path)))?;
        if layout.role == Role::Compared
            && !self.beside
            && let Err(error) = run_figures(&fine, &path, &self.figure_options(layout))
        {
            complain(&format!("figures: {error}"));
        }
        output::write_json(
            &path.join(KEPT),
            &Pair { key: self.key(layout), fine: Kept::of(&layout.scene, &fine), coarse, refused },
        )?;
        Ok(true)
    }

    /// Figures of a layout have its name, and the shaft also where it is not dug.
    fn figure_options(&self, layout: &Layout) -> FigureOptions {
        let mut options = FigureOptions::of(&layout.scene);
        options.name = Some(layout.name.clone());
        let planned = self.study.shaft_radius.map(|radius| ShaftMark { radius, dug: None });
        options.plan.shaft = options.plan.shaft.or(planned);
        options
    }

    /// The scene of a layout at twice the spacing.
    fn coarser(&self, layout: &Layout) -> Result<Scene, Failure> {
        let spacing = layout.scene.method(self.method).map_or(0.0, |settings| settings.numerics.spacing);
        let sector = match layout.scene.domain {
            frazil_core::space::domain::Domain::Ring { sector, .. } => sector.name(),
            _ => "whole",
        };
        let mut overrides = vec![
            ("domain.ring.sector".to_owned(), sector.to_owned()),
            ("watch.frozen_wall".to_owned(), "true".to_owned()),
        ];
        overrides.extend(layout.overrides.iter().cloned());
        overrides.push((format!("method.{}.spacing_m", self.method), format!("{}", 2.0 * spacing)));
        load::scene(&self.study.scene, &overrides)
    }
}
