//! Layouts of freeze pipes beside each other: when the wall closes, how thick and cold it is, and at what load.
//!
//! A study goes one way: layouts, each a scene; their runs, each whole in a folder of its own and kept by a campaign; then
//! tables, figures and one page of what is kept. So layouts known before, from other shards and just run are the same.

use std::path::{Path, PathBuf};
use std::time::Duration;

use frazil_core::memory;
use frazil_plots::canvas::Formats;
use frazil_plots::page::Block;
use frazil_scene::Scene;
use frazil_simulation::predict;
use frazil_studies::campaign::{Campaign, Shard};
use frazil_studies::failure::{Failure, Verdict, answer, complain};
use frazil_studies::machine::Machine;
use frazil_studies::method;
use frazil_studies::output::{Folder, Owner};
use frazil_studies::parallel;
use frazil_studies::parts::{Override, Parts};
use frazil_studies::progress::{bearable, forewarn};

pub use dug::beside_open;

mod ahead;
pub mod answers;
pub mod around;
pub mod boreholes;
mod check;
pub mod critical;
mod designed;
pub mod doubts;
mod dug;
pub mod execute;
pub mod file;
pub mod formula;
pub mod found;
pub mod goals;
mod methods;
pub mod read;
pub mod reference;
mod refusals;
pub mod report;
mod rows;
pub mod search;
pub mod shaft;
pub mod soils;
pub mod spacing;
pub mod strata;
pub mod study;
pub mod tables;
pub mod variants;

use ahead::Ahead;
use answers::Answers;
use execute::Work;
use found::{Compared, Found};
use refusals::Refusals;
use rows::write_rows;
use search::Tried;
use study::Study;

/// Pairs of key path and value that override a scene.
pub type Overrides = Vec<Override>;

/// What is to be studied.
#[derive(Debug, Clone, PartialEq)]
pub struct LayoutRequest {
    /// Study, by path or bundled name.
    pub study: String,
    /// Method; the study's, or the first of the scene, if absent.
    pub method: Option<String>,
    /// Pairs of key path and value that override the scene of all layouts.
    pub overrides: Overrides,
    /// Layouts that run at once.
    pub threads: usize,
    /// Relative error of the day of closure and of the thickness at the end for which the spacing is chosen; the study's own spacing
    /// if absent.
    pub error: Option<f64>,
    /// Wall time (s) that the runs of each layout may take by which it is chosen.
    pub budget_s: f64,
    /// Which part of the layouts is to be run.
    pub shard: Shard,
    /// Whether only to say what would be run.
    pub check: bool,
    /// Whether to draw frames of an animation.
    pub frames: bool,
    /// As what the figures of each layout are written beside SVG.
    pub formats: Formats,
    /// Folder for the results; `out/<study>` if absent.
    pub out: Option<PathBuf>,
    /// Wall time between two checkpoints of a run; none if absent.
    pub checkpoints: Option<Duration>,
    /// Whether to say nothing but errors.
    pub quiet: bool,
    /// Whether to begin what takes longer than 30 days.
    pub yes: bool,
    /// The command as it was typed, for the page.
    pub command_line: String,
}

/// Runs layouts and sets them beside each other.
///
/// # Errors
/// Where the study or one of its layouts cannot be run, or a file cannot be written.
pub fn layout(request: &LayoutRequest, parts: &Parts<'_>) -> Result<Verdict, Failure> {
    let study = read::study(&request.study, &request.overrides, parts)?;
    let Some(first) = study.layouts.first() else { return Ok(Verdict::Done) };
    let methods = methods_of(request, &study, &first.scene)?;
    let method = methods[0];
    let as_read = references(&study, method, &request.overrides)?;
    for doubt in doubts::of(&study) {
        complain(&format!("warning: {doubt}"));
    }
    memory::share(request.threads.min(study.layouts.len()));
    let Some(study) = spaced(request, study, &methods, parts)? else { return Ok(Verdict::Broken) };
    // At another spacing not all that fitted may fit.
    let references = if request.error.is_some() { references(&study, method, &request.overrides)? } else { as_read };
    for layout in &study.layouts {
        let fits = predict::fits(&layout.scene, method);
        fits.map_err(|refused| Failure::of(format!("layout \"{}\"", layout.name), refused))?;
    }
    if request.check {
        check::print(&study, &methods, request.threads)?;
        return Ok(Verdict::Done);
    }
    let path = folder_of(request, &study);
    let owner = if request.shard == Shard::WHOLE { Owner::Alone } else { Owner::WithOthers };
    let folder = Folder::make(&path, owner)?;
    let campaign = Campaign::open(&path, request.shard, request.threads, parts.interrupt)?;
    let campaign = campaign.with_checkpoints(request.checkpoints);
    let machine = Machine::now();
    let work_of = |method: &'static str, beside: bool| Work {
        study: &study,
        method,
        beside,
        folder: if beside { path.join("methods").join(method) } else { path.clone() },
        campaign: &campaign,
        threads: request.threads,
        shard: request.shard,
        frames: request.frames,
        formats: request.formats,
        quiet: request.quiet,
        machine: machine.clone(),
    };
    let works: Vec<Work<'_>> = methods.iter().map(|own| work_of(own, *own != method)).collect();
    expected(request, &study, &works, &methods).inspect_err(|_| folder.take_back())?;
    let made = works.iter().try_fold(true, |made, work| Ok(made && work.make()?.is_some()));
    let made = made.inspect_err(|_: &Failure| folder.take_back())?;
    finish(request, &works, &references, made)
}

/// The methods that layouts are run under. Under all of them, the first is that of the tables and figures, and the others stand beside
/// it.
fn methods_of(request: &LayoutRequest, study: &Study<'_>, scene: &Scene) -> Result<Vec<&'static str>, Failure> {
    let all = request.method.as_deref() == Some(methods::ALL);
    let asked = request.method.as_deref().filter(|_| !all).or(study.method.as_deref());
    let method = method::asked(scene, asked)?;
    let others = scene.methods.iter().map(|settings| settings.method).filter(|other| all && *other != method);
    Ok(std::iter::once(method).chain(others).collect())
}

/// The study at the spacing at which its answers reach the error that is asked for, or as it is where none is; none if that was
/// interrupted.
fn spaced<'a>(
    request: &LayoutRequest,
    study: Study<'a>,
    methods: &[&'static str],
    parts: &Parts<'a>,
) -> Result<Option<Study<'a>>, Failure> {
    let Some(error) = request.error else { return Ok(Some(study)) };
    let folder = Folder::make(&folder_of(request, &study), Owner::Alone)?;
    let campaign = Campaign::open(folder.path(), Shard::WHOLE, request.threads, parts.interrupt)?;
    let (mut overrides, mut promises) = (request.overrides.clone(), Vec::new());
    for method in methods {
        let chosen = spacing::choose(request, &study, (*method, error), &campaign);
        let Some((own, promise)) = chosen.inspect_err(|_| folder.take_back())? else {
            complain("interrupted: the same command resumes from here");
            return Ok(None);
        };
        overrides.push(own);
        promises.push(promise);
    }
    let again = read::study(&request.study, &overrides, parts)?;
    Ok(Some(Study { error: promises.into_iter().next(), ..again }))
}

fn folder_of(request: &LayoutRequest, study: &Study<'_>) -> PathBuf {
    request.out.clone().unwrap_or_else(|| Path::new("out").join(&study.name))
}

/// Says what is run and that it takes long, if it does, and refuses what would not end.
fn expected(
    request: &LayoutRequest,
    study: &Study<'_>,
    works: &[Work<'_>],
    methods: &[&'static str],
) -> Result<(), Failure> {
    let ahead = if works[0].is_last() { ahead::open(&works[0])? } else { Ahead::default() };
    if !request.quiet {
        complain(check::heading(study, methods, &ahead).trim_end());
    }
    let seconds = works.iter().filter_map(Work::seconds).sum::<f64>() + ahead.wall_s;
    if !request.yes {
        let shorter = "shorter by a larger spacing, an earlier end, fewer layouts or more --threads".to_owned();
        bearable(&study.name, seconds, shorter)?;
    }
    if !request.quiet {
        forewarn(&study.name, Some(seconds));
    }
    Ok(())
}

/// What refuses layouts: each cause once, with its layouts.
#[derive(Debug, thiserror::Error)]
#[error("{}", .0.join("\n"))]
struct RefusedLayouts(Vec<String>);

/// What each layout is compared with, once all of them have been held against what can be meant and what is sought of them can be
/// tried.
fn references(study: &Study<'_>, method: &str, asked: &Overrides) -> Result<Vec<Option<Compared>>, Failure> {
    let (mut found, mut refusals) = (Vec::new(), Refusals::new());
    for layout in &study.layouts {
        let fits = layout.fits(study.shaft_radius, method).map_err(|unfit| unfit.to_string());
        let table = || reference::table(study, layout, method, asked).map_err(|failure| failure.to_string());
        match fits.and_then(|()| table()) {
            Ok(reference) => found.push(reference),
            Err(reason) => refusals.add(reason, &layout.name),
        }
    }
    if found.len() < study.layouts.len() {
        let told = refusals.told().map(|(reason, layouts)| format!("{layouts}: {reason}"));
        return Err(Failure::request(RefusedLayouts(told.collect())));
    }
    if let Some(wanted) = &study.search {
        search::check(study, wanted, method)?;
    }
    if let Some(wanted) = &study.critical {
        critical::check(study, wanted, method)?;
    }
    Ok(found)
}

/// Tables, figures and page of what the folders keep, and what was sought; `made` is whether nothing interrupted the runs.
fn finish(
    request: &LayoutRequest,
    works: &[Work<'_>],
    references: &[Option<Compared>],
    made: bool,
) -> Result<Verdict, Failure> {
    let work = &works[0];
    let (study, path) = (work.study, &work.folder);
    let known = |k: usize| {
        let layout = &study.layouts[k];
        let pair = work.kept(layout)?;
        let design = study.design_of(layout);
        let fine = Answers::of(&layout.scene, &pair.fine, design);
        let coarse = pair.coarse.as_ref().map(|kept| Answers::of(&layout.scene, kept, design));
        Some(Found { layout, pair, fine, coarse, reference: references[k].clone() })
    };
    let found: Vec<Found<'_>> =
        parallel::in_order(study.layouts.len(), request.threads, known).into_iter().flatten().collect();
    let beside =
        if request.method.as_deref() == Some(methods::ALL) { methods::beside(study, works) } else { Vec::new() };
    let others = beside.iter().map(|one| works.len() - one.said.len()).sum::<usize>();
    let missing = study.layouts.len() - found.len() + others;
    if !made {
        complain(&format!("interrupted: the same command runs the remaining {missing} layouts"));
        return Ok(Verdict::Broken);
    }
    if missing > 0 {
        if !request.quiet {
            let all = study.layouts.len() * works.len();
            answer(&format!("{missing} of {all} layouts are left to other shards\n"))?;
        }
        return Ok(Verdict::Done);
    }
    let Some(tried) = searched(work)? else { return Ok(Verdict::Broken) };
    let Some(critical) = sought(work)? else { return Ok(Verdict::Broken) };
    tables::write(path, study, work.method, &found)?;
    if !beside.is_empty() {
        methods::write(path, &beside)?;
    }
    let told = report::Told { found: &found, tried: &tried, beside: &beside, critical };
    report::write(&request.command_line, study, work, told)?;
    found.iter().filter_map(dug::warning).for_each(|warning| complain(&format!("WARNING: {warning}")));
    if !request.quiet {
        answer(&tables::summary(study, work.method, &found, path))?;
        for words in beside.iter().filter_map(methods::Beside::words) {
            answer(&format!("  {words}\n"))?;
        }
        if let Some(search) = &study.search {
            answer(&format!("  {}\n", search::words(search, &tried)))?;
        }
    }
    let missed = study.error.as_ref().map_or(Vec::new(), |promise| spacing::missed(promise, &found));
    missed.iter().for_each(|words| complain(&format!("WARNING: {words}")));
    let reached = if missed.is_empty() { Verdict::Done } else { Verdict::CheckFailed };
    Ok(Verdict::worst(found.iter().map(|one| one.fine.outcome)).max(reached))
}

/// What a search has tried, with its table; nothing without a search, none if it was interrupted.
fn searched(work: &Work<'_>) -> Result<Option<Vec<Tried>>, Failure> {
    let Some(search) = &work.study.search else { return Ok(Some(Vec::new())) };
    let Some(tried) = search::search(work.study, search, work)? else {
        complain("interrupted: the same command resumes the search");
        return Ok(None);
    };
    write_rows(&work.folder, "search.csv", &tried)?;
    Ok(Some(tried))
}

/// What was sought of each layout, for the page, with its tables; nothing where nothing is, none if it was interrupted.
fn sought(work: &Work<'_>) -> Result<Option<Vec<Block>>, Failure> {
    let Some(wanted) = &work.study.critical else { return Ok(Some(Vec::new())) };
    let Some(outcome) = critical::seek(work.study, wanted, work)? else {
        complain("interrupted: the same command resumes the bisection");
        return Ok(None);
    };
    write_rows(&work.folder, "critical.csv", &outcome.found)?;
    write_rows(&work.folder, "critical_tried.csv", &outcome.tried)?;
    Ok(Some(vec![critical::block(wanted, &outcome, work)?]))
}

/// The methods and bundled scenes, as the application has them.
#[cfg(test)]
mod bundled {
    use std::sync::atomic::AtomicBool;

    use frazil_scene::Scene;
    use frazil_scene::method::MethodKind;
    use frazil_studies::failure::Failure;
    use frazil_studies::parts::{Override, Parts};

    static METHODS: [&MethodKind; 4] =
        [&frazil_local::METHOD, &frazil_pd::METHOD, &frazil_sph::METHOD, &frazil_edpd::METHOD];
    static INTERRUPT: AtomicBool = AtomicBool::new(false);

    pub fn scene(name: &str, overrides: &[Override]) -> Result<Scene, Failure> {
        let bundled = frazil_cases::scenes::find(name).expect("bundled");
        Ok(Scene::read(bundled, name, name, overrides, &METHODS)?)
    }

    pub fn parts() -> Parts<'static> {
        Parts {
            scene_at: &scene,
            reference_for: &|scene| frazil_cases::truth(scene).map_err(Into::into),
            run: &frazil_simulation::march::run,
            methods: &METHODS,
            interrupt: &INTERRUPT,
        }
    }
}
