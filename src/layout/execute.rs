//! Runs of all layouts, as a campaign whose runs leave a folder each.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use frazil_core::particles::Particles;
use frazil_core::space::domain::Domain;
use frazil_plots::canvas::Formats;
use frazil_plots::ground_plan::ShaftMark;
use frazil_plots::{FigureOptions, run_figures};
use frazil_record::{Field, FrontLineRow, Outcome};
use frazil_scene::{Scene, names};
use frazil_simulation::march::{self, Checkpoints, EachOutput, Options};
use frazil_simulation::predict;
use frazil_studies::campaign::{self, Campaign, Meter, Shard};
use frazil_studies::failure::{Failure, complain};
use frazil_studies::fields::{self, Snapshots};
use frazil_studies::machine::Machine;
use frazil_studies::{figure_options, output, parallel};
use serde::{Deserialize, Serialize};

use super::Overrides;
use super::answers::Kept;
use super::study::{Study, named};
use super::variants::{Layout, Role};

/// What is kept of a layout: a run, and the same at twice the spacing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// The run.
    pub fine: Kept,
    /// The same at twice the spacing; none where that is too coarse for the layout.
    pub coarse: Option<Kept>,
    /// Why not.
    pub refused: Option<String>,
    /// The front of the run, where the layout has maps.
    #[serde(default)]
    pub front_lines: Vec<FrontLineRow>,
}

/// What is kept of a layout at twice the spacing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coarse {
    /// The run; none where that is too coarse for the layout.
    pub kept: Option<Kept>,
    /// Why not.
    pub refused: Option<String>,
}

/// What came of a layout.
#[derive(Debug, Serialize, Deserialize)]
enum Finding {
    /// Its runs.
    Ran(Box<Pair>),
    /// The method cannot run it, for this reason.
    Refused(String),
}

impl Finding {
    fn ran(self) -> Option<Pair> {
        match self {
            Finding::Ran(pair) => Some(*pair),
            Finding::Refused(_) => None,
        }
    }
}

/// Seed of all runs: layouts have no chance.
const SEED: u64 = 1;

/// About how long (s) a layout takes, from its first steps; absent where they do not tell.
pub(super) fn seconds_of(scene: &Scene, method: &str) -> Option<f64> {
    let fine = predict::forecast(scene, method, None, 1, 1).ok()?.seconds()?;
    // Also at twice the spacing: an eighth, or less where steps are few.
    Some(1.125 * fine)
}

/// What makes the scene of a layout out of that of its study, the part of the plan that is run included.
pub(super) fn made_of(layout: &Layout) -> Overrides {
    let sector = match layout.scene.domain {
        Domain::Ring { sector, .. } => sector.name(),
        _ => "whole",
    };
    let whole = [("domain.ring.sector", sector), ("watch.frozen_wall", "true")];
    let whole = whole.map(|(key, value)| (key.to_owned(), value.to_owned()));
    whole.into_iter().chain(layout.overrides.iter().cloned()).collect()
}

/// Runs of a study.
pub struct Work<'a> {
    /// The study.
    pub study: &'a Study<'a>,
    /// Method.
    pub method: &'static str,
    /// Whether it stands beside another method: only layouts that are compared are run, and those that it cannot run are left.
    pub beside: bool,
    /// Folder.
    pub folder: PathBuf,
    /// What keeps what they find.
    pub campaign: &'a Campaign<'a>,
    /// Workers.
    pub threads: usize,
    /// Which part of the layouts is to be run.
    pub shard: Shard,
    /// Whether layouts that are compared leave frames of an animation.
    pub frames: bool,
    /// As what their figures are written beside SVG.
    pub formats: Formats,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// The machine, as it was at the start.
    pub machine: Machine,
}

impl Work<'_> {
    /// All layouts of this shard that are not there yet; returns how many were run, or that it was interrupted.
    pub fn make(&self) -> Result<Option<usize>, Failure> {
        let layouts = &self.study.layouts;
        let wanted = self.wanted();
        // A part of the plan costs as much as its share of the whole.
        let prices: Vec<f64> = wanted.iter().map(|k| 1.0 / layouts[*k].images() as f64).collect();
        let (meter, done) = (Meter::new(self.quiet, prices.iter().sum()), AtomicUsize::new(0));
        let made = self.campaign.side_by_side(&prices, |k| {
            self.make_one(&layouts[wanted[k]])?;
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            meter.made(prices[k], |_| format!("{count} of {} layouts", wanted.len()));
            Some(())
        });
        meter.finish();
        let count = made?.iter().flatten().count();
        Ok((count == wanted.len()).then_some(count))
    }

    /// The layouts of this shard that are not there yet.
    fn wanted(&self) -> Vec<usize> {
        let layouts = &self.study.layouts;
        let is_own = |k: &usize| self.shard.has(*k) && (!self.beside || layouts[*k].role == Role::Compared);
        let own: Vec<usize> = (0..layouts.len()).filter(is_own).collect();
        let open = |k: usize| (!self.is_done(&layouts[own[k]])).then_some(own[k]);
        parallel::in_order(own.len(), self.threads, open).into_iter().flatten().collect()
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
        let mut others = self.study.layouts.iter().enumerate().filter(|(k, _)| !self.shard.has(*k));
        others.all(|(_, layout)| self.is_done(layout))
    }

    /// Folder of a layout.
    pub fn folder_of(&self, layout: &Layout) -> PathBuf {
        self.folder.join("layouts").join(names::apart(&layout.name))
    }

    fn key(&self, layout: &Layout) -> String {
        let maps = if self.has_maps(layout) { " with maps" } else { "" };
        campaign::key(&format!("layout \"{}\"{maps}", layout.name), &layout.scene, self.method, SEED)
    }

    /// Whether maps of a layout are looked at.
    fn has_maps(&self, layout: &Layout) -> bool {
        layout.role == Role::Compared && !self.beside
    }

    fn draws_frames(&self, layout: &Layout) -> bool {
        self.frames && self.has_maps(layout)
    }

    fn lacks_frames(&self, layout: &Layout) -> bool {
        self.draws_frames(layout) && !self.folder_of(layout).join(fields::NAMES[2]).is_dir()
    }

    /// Whether figures of a layout are wanted as what its folder lacks.
    fn lacks_figures(&self, layout: &Layout) -> bool {
        let Formats { png, pdf } = self.formats;
        let wanted: Vec<&str> =
            [(png, "png"), (pdf, "pdf")].into_iter().filter(|(is, _)| *is).map(|(_, as_)| as_).collect();
        let files = std::fs::read_dir(self.folder_of(layout)).into_iter().flatten().flatten().map(|file| file.path());
        let lacks = |svg: PathBuf| wanted.iter().any(|as_| !svg.with_extension(as_).is_file());
        self.has_maps(layout) && files.filter(|file| file.extension().is_some_and(|own| own == "svg")).any(lacks)
    }

    /// What is known of a layout: nothing while its folder lacks the run, or frames or figures that are wanted.
    fn found(&self, layout: &Layout) -> Option<Finding> {
        let found = self.campaign.known(&self.key(layout))?;
        let is_there = match &found {
            Finding::Ran(pair) => {
                output::holds(&self.folder_of(layout), &pair.fine.record)
                    && !self.lacks_frames(layout)
                    && !self.lacks_figures(layout)
            }
            Finding::Refused(_) => true,
        };
        is_there.then_some(found)
    }

    /// The runs of a layout that is known.
    pub fn kept(&self, layout: &Layout) -> Option<Pair> {
        self.found(layout).and_then(Finding::ran)
    }

    /// Why the method cannot run a layout, where it has been found that it cannot.
    pub fn refused(&self, layout: &Layout) -> Option<String> {
        match self.found(layout)? {
            Finding::Refused(reason) => Some(reason),
            Finding::Ran(_) => None,
        }
    }

    fn is_done(&self, layout: &Layout) -> bool {
        self.found(layout).is_some()
    }

    /// What is known of a layout, which is run if nothing is; none if it was interrupted.
    pub(super) fn made(&self, layout: &Layout) -> Result<Option<Pair>, Failure> {
        layout.check(self.study.shaft_radius, self.method)?;
        let found = self.found(layout).or_else(|| self.make_one(layout));
        self.campaign.check()?;
        Ok(found.and_then(Finding::ran))
    }

    fn make_one(&self, layout: &Layout) -> Option<Finding> {
        self.campaign.make(&self.key(layout), || self.layout(layout))
    }

    /// One layout, its files before all else: what is kept has its folder. None if it was interrupted.
    fn layout(&self, layout: &Layout) -> Result<Option<Finding>, Failure> {
        let path = self.folder_of(layout);
        output::make_folder(&path)?;
        let draw = || Snapshots::new(&layout.scene, self.method, (false, true), (&path, true));
        let frames = self.draws_frames(layout).then(draw).transpose()?;
        let see = |particles: &Particles, time: f64| {
            if let Some(frames) = &frames {
                frames.see(particles, time);
            }
        };
        let options = Options {
            threads: 1,
            seed: SEED,
            interrupt: Some(self.campaign.stop()),
            progress: None,
            time_limit_s: None,
            fields: self.has_maps(layout),
            prepared: None,
            each_output: None,
            checkpoints: None,
        };
        let seen: Option<&EachOutput<'_>> = if frames.is_some() { Some(&see) } else { None };
        let run = || {
            let run = |checkpoints: Option<&Checkpoints<'_>>| {
                march::run(&layout.scene, self.method, None, &Options { each_output: seen, checkpoints, ..options })
            };
            self.campaign.on_its_way(&self.key(layout), run).map_err(Failure::from)
        };
        let tried = match self.beside {
            true => layout.check(self.study.shaft_radius, self.method).and_then(|()| run()),
            false => run().map_err(|failure| named(&layout.name, failure)),
        };
        let fine = match tried {
            Ok(fine) => fine,
            Err(failure) if self.beside => return Ok(Some(Finding::Refused(failure.to_string()))),
            Err(failure) => return Err(failure),
        };
        if matches!(fine.record.outcome, Outcome::Interrupted | Outcome::TimedOut) {
            return Ok(None);
        }
        let known = self.campaign.known(&self.coarse_key(layout));
        let Some(coarse) = known.or_else(|| self.run_coarse(layout)) else { return Ok(None) };
        output::write_run_and(&path, &fine, || frames.map_or(Ok(()), |frames| frames.finish(&path)))?;
        if self.has_maps(layout)
            && let Err(error) = run_figures(&fine, &path, &self.figure_options(layout, &fine.fields), self.formats)
        {
            complain(&format!("figures: {error}"));
        }
        let Coarse { kept, refused } = coarse;
        let front_lines = fine.front_lines.clone();
        Ok(Some(Finding::Ran(Box::new(Pair {
            fine: Kept::of(&layout.scene, &fine),
            coarse: kept,
            refused,
            front_lines,
        }))))
    }

    fn coarse_key(&self, layout: &Layout) -> String {
        campaign::key(&format!("layout \"{}\" at twice the spacing", layout.name), &layout.scene, self.method, SEED)
    }

    /// What is known of a layout at twice the spacing.
    pub(super) fn known_coarse(&self, layout: &Layout) -> Option<Coarse> {
        self.campaign.known(&self.coarse_key(layout))
    }

    /// What is known of a layout at twice the spacing, which is run if nothing is; none if it was interrupted.
    pub(super) fn made_coarse(&self, layout: &Layout) -> Result<Option<Coarse>, Failure> {
        layout.check(self.study.shaft_radius, self.method)?;
        let make = || self.campaign.make(&self.coarse_key(layout), || Ok(self.run_coarse(layout)));
        let found = self.known_coarse(layout).or_else(make);
        self.campaign.check()?;
        Ok(found)
    }

    /// A layout at twice the spacing: it takes an eighth of the time. None if it was interrupted.
    fn run_coarse(&self, layout: &Layout) -> Option<Coarse> {
        let options = Options {
            threads: 1,
            seed: SEED,
            interrupt: Some(self.campaign.stop()),
            fields: self.has_maps(layout),
            ..Options::default()
        };
        let run = |scene: Scene| Ok((march::run(&scene, self.method, None, &options)?, scene));
        match self.coarser(layout).and_then(run) {
            Ok((result, _)) if result.record.outcome == Outcome::Interrupted => None,
            Ok((result, scene)) => Some(Coarse { kept: Some(Kept::of(&scene, &result)), refused: None }),
            Err(failure) => Some(Coarse { kept: None, refused: Some(failure.to_string()) }),
        }
    }

    /// Figures of a layout have its name, and the shaft also where it is not dug.
    fn figure_options(&self, layout: &Layout, maps: &[Field]) -> FigureOptions {
        let mut options = figure_options::of(&layout.scene, maps);
        options.name = Some(layout.name.clone());
        let planned = self.study.shaft_radius.map(|radius| ShaftMark { radius, dug: None });
        options.plan.shaft = options.plan.shaft.or(planned);
        options
    }

    /// The scene of a layout at twice the spacing.
    fn coarser(&self, layout: &Layout) -> Result<Scene, Failure> {
        let spacing = layout.scene.method(self.method).map_or(0.0, |settings| settings.numerics.spacing);
        let mut overrides = made_of(layout);
        overrides.push((format!("method.{}.spacing_m", self.method), format!("{}", 2.0 * spacing)));
        let ground = &self.study.ground;
        (ground.parts.scene_at)(&ground.scene, &overrides)
    }
}
