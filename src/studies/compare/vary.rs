//! Convergence in two parameters: the spacing, and how many spacings pairs reach.
//!
//! A nonlocal method converges with the spacing at a fixed ratio of reach to spacing (the reach shrinks along), and with
//! the ratio at a fixed reach, to two different limits. Errors of either kind can have opposite signs, so that one of them
//! passes through zero: a curve of magnitudes then falls steeply and rises again, and looks convergent where it is read at
//! the right place. So errors keep their signs here, and changes of sign between neighbouring runs are told.

mod report;
mod tables;

use std::path::Path;
use std::sync::Arc;

use frazil_plots::style::{duration, number, percent};
use frazil_record::{Outcome, RunResult, Value};
use frazil_scene::Scene;
use frazil_scene::method::MethodKind;
use frazil_simulation::march::Options;
use frazil_simulation::reference::Reference;

use super::group::alike;
use super::plan::{self, overrides, spacings};
use super::reference::{judge_alike, truth};
use super::request::{CompareRequest, Vary};
use super::runner::{Clock, Purpose, Runner};
use super::turns::{self, Turn};
use super::variant::Variant;
use crate::campaign::{Campaign, Shard};
use crate::failure::{Failure, Verdict, complain};
use crate::machine::Machine;
use crate::output::{Folder, Owner};
use crate::parallel;
use crate::parts::Parts;

/// The keys that can be varied beside the spacing, as methods list them: reach over spacing.
pub const RATIOS: [&str; 3] = ["horizon_ratio", "smoothing_ratio", "cutoff_ratio"];

/// Ratios that are run by default, over the scene's own: each has its half or its double beside it.
const SPREAD: [f64; 5] = [2.0 / 3.0, 1.0, 4.0 / 3.0, 2.0, 8.0 / 3.0];

/// Relative difference of horizons that are the same.
const SAME: f64 = 1e-9;

/// Which error of a run is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Of all temperatures of profiles, over the range of the scene's temperatures: their mean has a sign.
    Temperature,
    /// Of all effective saturations of profiles, of unsaturated water.
    Saturation,
    /// Of the front: at the end it has a sign.
    Front,
}

impl Measure {
    /// Both.
    pub const ALL: [Measure; 3] = [Measure::Temperature, Measure::Saturation, Measure::Front];

    /// The word used in files.
    pub fn name(self) -> &'static str {
        match self {
            Measure::Temperature => "temperature",
            Measure::Saturation => "saturation",
            Measure::Front => "front",
        }
    }

    /// The signed error of a run.
    pub fn signed(self, run: &Run) -> Option<f64> {
        match self {
            Measure::Temperature => run.temperature,
            Measure::Saturation => run.saturation,
            Measure::Front => run.result.as_ref()?.record.errors.front_last_rel,
        }
    }

    /// The rms error of a run.
    pub fn rms(self, run: &Run) -> Option<f64> {
        let errors = &run.result.as_ref()?.record.errors;
        match self {
            Measure::Temperature => errors.temperature_rms_rel,
            Measure::Saturation => errors.saturation_rms,
            Measure::Front => errors.front_rms_rel,
        }
    }
}

/// One method at one spacing and ratio.
#[derive(Debug, Clone)]
pub struct Run {
    /// Method.
    pub method: &'static str,
    /// Number of the spacing, from coarse to fine.
    pub level: usize,
    /// Spacing (m).
    pub spacing: f64,
    /// Reach over spacing, as the key means it.
    pub ratio: f64,
    /// What came of it.
    pub result: Option<RunResult>,
    /// Mean error of temperatures over their range.
    pub temperature: Option<f64>,
    /// Mean error of effective saturations.
    pub saturation: Option<f64>,
    /// Why there is nothing, or nothing good.
    pub note: Option<String>,
}

impl Run {
    /// Ratio times spacing (m).
    pub fn reach(&self) -> f64 {
        self.ratio * self.spacing
    }
}

/// All runs of one scene.
pub struct Grid {
    /// The scene as its file gives it.
    pub scene: Scene,
    /// The key that is varied.
    pub key: String,
    /// Runs, from coarse to fine.
    pub runs: Vec<Run>,
    /// What the reference is, in words.
    pub reference: String,
}

/// Runs of a method along which one parameter alone changes, from coarse to fine.
pub struct Line<'a> {
    /// Method.
    pub method: &'static str,
    /// What is the same along it: the ratio, or the reach (m).
    pub fixed: f64,
    /// The runs.
    pub runs: Vec<&'a Run>,
}

impl Grid {
    /// The methods, in their order.
    pub fn methods(&self) -> Vec<&'static str> {
        let mut methods: Vec<&'static str> = self.runs.iter().map(|run| run.method).collect();
        methods.dedup();
        methods.sort_unstable();
        methods.dedup();
        methods
    }

    /// Lines of one value of something, by that value.
    fn lines(&self, method: &'static str, value: impl Fn(&Run) -> f64) -> Vec<Line<'_>> {
        let own = self.runs.iter().filter(|run| run.method == method);
        let groups = alike(own, |a, b| (value(a) - value(b)).abs() <= SAME * value(b));
        let mut lines: Vec<Line<'_>> =
            groups.into_iter().map(|runs| Line { method, fixed: value(runs[0]), runs }).collect();
        lines.sort_by(|a, b| a.fixed.total_cmp(&b.fixed));
        lines
    }

    /// Lines of one ratio: the reach shrinks with the spacing.
    pub fn by_ratio(&self, method: &'static str) -> Vec<Line<'_>> {
        self.lines(method, |run| run.ratio)
    }

    /// Lines of one reach with more than one run: the ratio grows as the spacing shrinks.
    pub fn by_reach(&self, method: &'static str) -> Vec<Line<'_>> {
        self.lines(method, Run::reach).into_iter().filter(|line| line.runs.len() > 1).collect()
    }
}

impl Line<'_> {
    /// Neighbouring runs between which a signed error changes its sign, as pairs of spacings.
    pub fn crossings(&self, measure: Measure) -> Vec<(f64, f64)> {
        let signed: Vec<(f64, f64)> =
            self.runs.iter().filter_map(|run| Some((run.spacing, measure.signed(run)?))).collect();
        let turns = |pair: &&[(f64, f64)]| pair[0].1 * pair[1].1 < 0.0;
        signed.windows(2).filter(turns).map(|pair| (pair[0].0, pair[1].0)).collect()
    }
}

/// A warning in words for each change of sign along any line.
pub fn warnings(grid: &Grid) -> Vec<String> {
    let mut found = Vec::new();
    for method in grid.methods() {
        let by_ratio =
            grid.by_ratio(method).into_iter().map(|line| (format!("{} {}", grid.key, number(line.fixed, 4)), line));
        let by_reach =
            grid.by_reach(method).into_iter().map(|line| (format!("reach {} m", number(line.fixed, 4)), line));
        for (fixed, line) in by_ratio.chain(by_reach) {
            for measure in Measure::ALL {
                for (coarse, fine) in line.crossings(measure) {
                    found.push(format!(
                        "{method}, {}, at fixed {fixed}: the error changes its sign between spacings of {} and {} m. Its \
                         magnitude passes through zero there, which does not indicate convergence",
                        measure.name(),
                        number(coarse, 4),
                        number(fine, 4)
                    ));
                }
            }
        }
    }
    found
}

/// Varies scene after scene, and writes tables, figures and the page.
pub fn vary(request: &CompareRequest, vary: &Vary, parts: &Parts<'_>) -> Result<Verdict, Failure> {
    let path = request.out.clone().unwrap_or_else(|| Path::new("out").join("compare"));
    let mut jobs = Vec::new();
    for name in &request.scenes {
        let scene = request.scene(parts, name, &[])?;
        plan::check(request, parts, name, &scene)?;
        let methods = methods(request, vary, parts, &scene)?;
        jobs.push((name, scene, methods));
    }
    request.forewarn();
    let folder = Folder::make(&path, Owner::Alone)?;
    let machine = Machine::now();
    let campaign = Campaign::open(&path, Shard::WHOLE, parallel::cores(), parts.interrupt)?;
    let campaign = campaign.with_checkpoints(request.checkpoints);
    let runner = Runner::new(request, parts, &campaign);
    let say = |text: &str| {
        if !request.quiet {
            complain(text);
        }
    };
    let mut grids = Vec::new();
    for (name, scene, methods) in jobs {
        let grid = runs(request, vary, parts, &runner, (name, scene), &methods, &say);
        grids.push(grid.map_err(|failure| Failure::of(name, failure))?);
        campaign.check()?;
        tables::write(folder.path(), &grids)?;
        report::write(request, &machine, folder.path(), &grids)?;
        if campaign.is_interrupted() {
            complain("interrupted: the same command resumes from here");
            return Ok(Verdict::Broken);
        }
    }
    let count = runner.counts();
    if count.known > 0 {
        say(&count.words());
    }
    for warning in grids.iter().flat_map(warnings) {
        say(&format!("warning: {warning}"));
    }
    say(&format!("written: {}", path.join("report.html").display()));
    Ok(Verdict::Done)
}

/// No method has the key that is to be varied.
#[derive(Debug, thiserror::Error)]
#[error("no requested method of scene `{scene}` has the key \"{key}\"")]
struct NoKey {
    scene: String,
    key: String,
}

/// Methods of a scene that have the key. Noise would drown signs.
fn methods(
    request: &CompareRequest,
    vary: &Vary,
    parts: &Parts<'_>,
    scene: &Scene,
) -> Result<Vec<&'static MethodKind>, Failure> {
    let wanted = |kind: &MethodKind| match request.methods.as_slice() {
        [] => !kind.stochastic,
        names => names.iter().any(|name| name == kind.name),
    };
    let has = |kind: &MethodKind| own_ratio(scene, kind.name, &vary.key).is_some();
    let found: Vec<_> = parts.methods.iter().copied().filter(|kind| wanted(kind) && has(kind)).collect();
    if found.is_empty() {
        return Err(Failure::request(NoKey { scene: scene.name.clone(), key: vary.key.clone() }));
    }
    Ok(found)
}

/// A number without the rounding of its last digits, as people would write it.
fn plain(number: f64) -> f64 {
    (1e9 * number).round() / 1e9
}

/// The scene's own value of a key of a method.
fn own_ratio(scene: &Scene, method: &str, key: &str) -> Option<f64> {
    let knobs = &scene.method(method)?.discretisation.knobs;
    match knobs.iter().find(|knob| knob.0 == key)?.1 {
        Value::Number(ratio) => Some(ratio),
        _ => None,
    }
}

/// All runs of a scene, none of them made.
fn planned(request: &CompareRequest, vary: &Vary, scene: &Scene, methods: &[&'static MethodKind]) -> Vec<Run> {
    let mut grid = Vec::new();
    for level in 0..request.levels.max(1) {
        for kind in methods {
            let Some(settings) = scene.method(kind.name) else { continue };
            let spacing = spacings(settings.numerics.spacing, request.levels)[level];
            let own = own_ratio(scene, kind.name, &vary.key).unwrap_or(1.0);
            let ratios: Vec<f64> = if vary.ratios.is_empty() {
                SPREAD.map(|share| plain(share * own)).to_vec()
            } else {
                vary.ratios.clone()
            };
            for ratio in ratios {
                grid.push(Run {
                    method: kind.name,
                    level,
                    spacing,
                    ratio,
                    result: None,
                    temperature: None,
                    saturation: None,
                    note: None,
                });
            }
        }
    }
    grid
}

fn runs(
    request: &CompareRequest,
    vary: &Vary,
    parts: &Parts<'_>,
    runner: &Runner<'_>,
    (name, mut scene): (&str, Scene),
    methods: &[&'static MethodKind],
    say: &dyn Fn(&str),
) -> Result<Grid, Failure> {
    let mut grid = planned(request, vary, &scene, methods);
    let spacings = || grid.iter().map(|run| run.spacing);
    let ends = (spacings().fold(f64::INFINITY, f64::min), spacings().fold(0.0, f64::max));
    let reference = truth(request, parts, runner, (name, &mut scene), ends, say)?;
    if let Some(reference) = &reference {
        judge_alike(&mut scene, ends.1, reference.as_ref());
    }
    for remark in &scene.remarks {
        say(&format!("{}: warning: {remark}", scene.name));
    }
    let words = reference.as_ref().map_or("none: no errors".to_owned(), |reference| {
        let info = reference.describe();
        format!("{}, {}", info.kind, info.source)
    });
    let reference = reference.as_ref();
    let work = Work { request, vary, parts, runner, name, scene: &scene, reference, clock: Clock::start(), say };
    work.all(&mut grid);
    Ok(Grid { scene, key: vary.key.clone(), runs: grid, reference: words })
}

/// What the runs of a scene share.
struct Work<'a> {
    request: &'a CompareRequest,
    vary: &'a Vary,
    parts: &'a Parts<'a>,
    runner: &'a Runner<'a>,
    name: &'a str,
    scene: &'a Scene,
    reference: Option<&'a Arc<dyn Reference>>,
    clock: Clock,
    say: &'a dyn Fn(&str),
}

impl Work<'_> {
    /// Makes all runs, cheap ones first over all methods and ratios, as far as the time allows.
    fn all(&self, grid: &mut [Run]) {
        let growth = 2f64.powi(self.scene.domain.dimension() as i32 + 2);
        // Runs of one method and ratio, from coarse to fine.
        let of = |k: usize| (grid[k].method, grid[k].ratio);
        let curves = alike(0..grid.len(), |a, b| of(*a) == of(*b));
        let mut lines: Vec<turns::Line> =
            curves.iter().map(|curve| turns::Line { turns: vec![Turn::Waiting; curve.len()], growth }).collect();
        let mut count = 0;
        while let Some((line, level, expected)) = turns::next(&lines) {
            let left = self.request.budget() - self.clock.elapsed();
            let stopped = self.runner.is_stopped();
            if stopped || expected > left {
                let left = if left > 0.0 { duration(left) } else { "nothing".into() };
                let note = if stopped {
                    "interrupted".to_owned()
                } else {
                    format!("left out: about {} expected, {left} left", duration(expected))
                };
                for finer in lines[line].leave_out(level) {
                    let run = &mut grid[curves[line][finer]];
                    (self.say)(&format!("{}: {note}", self.label(run)));
                    run.note = Some(note.clone());
                }
                continue;
            }
            count += 1;
            let limit = turns::allowed(&lines, expected, left);
            let begin = self.clock.elapsed();
            let run = &mut grid[curves[line][level]];
            let was_made = self.make(run, limit);
            let took = self.clock.elapsed() - begin;
            lines[line].turns[level] = if was_made { Turn::Made(took) } else { Turn::Refused };
            let signed = |measure: Measure| {
                let error = measure.signed(run)?;
                Some(format!("{} {}{}", measure.name(), if error > 0.0 { "+" } else { "" }, percent(error, 3)))
            };
            let words: Vec<String> = Measure::ALL.into_iter().filter_map(signed).chain(run.note.clone()).collect();
            (self.say)(&format!(
                "[{count}/{}] {}: {}",
                grid.len(),
                self.label(&grid[curves[line][level]]),
                words.join(", ")
            ));
        }
    }

    fn label(&self, run: &Run) -> String {
        format!("{}, {} m, {} {}", run.method, number(run.spacing, 4), self.vary.key, number(run.ratio, 4))
    }

    /// Makes one run, and says whether it was one.
    fn make(&self, run: &mut Run, limit: f64) -> bool {
        match self.one(run, limit) {
            Ok(result) => {
                let outcome = result.record.outcome;
                let error = mean_error(self.scene, &result).filter(|_| outcome == Outcome::Ok);
                (run.temperature, run.saturation) = if self.scene.of_water { (None, error) } else { (error, None) };
                run.result = Some(result).filter(|_| outcome == Outcome::Ok);
                run.note = (outcome != Outcome::Ok).then(|| outcome.name().to_owned());
                true
            }
            Err(failure) => {
                // All problems of a scene would not fit on a line.
                run.note = failure.to_string().lines().next().map(str::to_owned);
                false
            }
        }
    }

    fn one(&self, run: &Run, limit: f64) -> Result<RunResult, Failure> {
        let Work { request, vary, parts, name, scene: base, .. } = *self;
        let best = || Variant::standard(frazil_scene::Setting::Best);
        let setting = request.settings.first().cloned().unwrap_or_else(best);
        let mut pairs = overrides(base.units, run.method, run.spacing, &setting);
        pairs.push((format!("method.{}.{}", run.method, vary.key), format!("{}", run.ratio)));
        let mut scene = request.scene(parts, name, &pairs)?;
        scene.watch.front_from = base.watch.front_from;
        let options = Options { threads: request.threads, time_limit_s: Some(limit.max(1.0)), ..Options::default() };
        let made = self.runner.run(Purpose::First, &scene, run.method, self.reference, &options);
        let made = made.map_err(|refused| Failure::of("refused", refused))?;
        self.clock.add(made.earlier_s);
        Ok(made.result)
    }
}

/// Mean over all profile points of the error of temperature, over the range of the scene's temperatures; or of that of the
/// effective saturation.
fn mean_error(scene: &Scene, result: &RunResult) -> Option<f64> {
    let (low, high) = if scene.of_water { (0.0, 1.0) } else { scene.temperature_range() };
    let errors: Vec<f64> =
        result.profiles.iter().filter_map(|row| Some(row.temperature_c - row.temperature_ref_c?)).collect();
    (!errors.is_empty() && high > low).then(|| errors.iter().sum::<f64>() / errors.len() as f64 / (high - low))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(spacing: f64, ratio: f64, error: f64) -> Run {
        let level = 0;
        Run {
            method: "pd",
            level,
            spacing,
            ratio,
            result: None,
            temperature: Some(error),
            saturation: None,
            note: None,
        }
    }

    #[test]
    fn lines_keep_one_parameter_and_tell_changes_of_sign() {
        let scene = crate::bundled::scene("stefan-unit", &[]);
        let errors = [(0.04, [-4.0, -1.0]), (0.02, [-1.0, 0.5]), (0.01, [-0.2, 0.1])];
        let runs = errors.into_iter().flat_map(|(h, [two, four])| [run(h, 2.0, two), run(h, 4.0, four)]).collect();
        let grid = Grid { scene: scene.expect("good"), key: "horizon_ratio".into(), runs, reference: String::new() };
        let lines = grid.by_ratio("pd");
        assert_eq!(lines.iter().map(|line| (line.fixed, line.runs.len())).collect::<Vec<_>>(), [(2.0, 3), (4.0, 3)]);
        assert_eq!(lines[0].crossings(Measure::Temperature), []);
        assert_eq!(lines[1].crossings(Measure::Temperature), [(0.04, 0.02)]);
        // 0.04 x 2 = 0.02 x 4, 0.02 x 2 = 0.01 x 4.
        let fixed = grid.by_reach("pd");
        assert_eq!(fixed.iter().map(|line| line.runs.len()).collect::<Vec<_>>(), [2, 2]);
        assert_eq!(fixed[1].crossings(Measure::Temperature), [(0.04, 0.02)]);
        assert_eq!(fixed[0].crossings(Measure::Temperature), [(0.02, 0.01)]);
        assert_eq!(warnings(&grid).len(), 3);
    }
}
