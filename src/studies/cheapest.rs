//! Which method reaches an error soonest on a scene. Coarse runs of each method tell its order and what a spacing costs; the
//! spacing that the error asks for is forecast, run, and held against finer runs before it is promised.

use std::path::Path;

use frazil_plots::style::{duration, percent};
use frazil_record::EstimatedError;
use frazil_scene::Scene;
use frazil_scene::method::MethodKind;

use crate::campaign::{Campaign, Shard};
use crate::compare::plan::spacing_override;
use crate::ensemble::runs::Headline;
use crate::failure::{Failure, Verdict, answer, complain};
use crate::method;
use crate::output::{Folder, Owner};
use crate::parts::{Override, Parts};
use crate::words::length_words;

pub mod estimate;
mod ladder;
mod report;
mod request;

pub use ladder::{Differ, Ladder, Quantity, Reached, Short};
pub use request::CheapestRequest;

/// A scene without settings for any of the methods.
#[derive(Debug, thiserror::Error)]
#[error("the scene \"{0}\" has settings for none of these methods")]
struct NoMethod(String);

/// No method reaches the error.
#[derive(Debug, thiserror::Error)]
#[error("--error {}: {method} does not reach it on the scene \"{scene}\": {cause}", percent(*error, 3))]
struct OutOfReach {
    error: f64,
    method: &'static str,
    scene: String,
    cause: Short,
}

/// A method and what it came to.
struct Of {
    kind: &'static MethodKind,
    reached: Reached,
}

impl Of {
    /// Time (s) of the run that was chosen.
    fn cost(&self) -> Option<f64> {
        Some(self.reached.rungs[*self.reached.chosen.as_ref().ok()?].cost_s)
    }
}

/// All methods, the cheapest first, and those that do not reach the error behind.
struct Study {
    scene: Scene,
    headline: Option<Headline>,
    all: Vec<Of>,
}

/// Looks for the cheapest run under each method, writes what was found, and prints the answer.
///
/// # Errors
/// Where the scene or a method is none, a run is refused, or a file cannot be written.
pub fn cheapest(request: &CheapestRequest, parts: &Parts<'_>) -> Result<Verdict, Failure> {
    let (verdict, words) = search(request, parts)?;
    if let Some(words) = words {
        answer(&words)?;
    }
    Ok(verdict)
}

/// The same without printing: how it ended, and the answer unless it was interrupted.
///
/// # Errors
/// As [`cheapest`].
pub fn search(request: &CheapestRequest, parts: &Parts<'_>) -> Result<(Verdict, Option<String>), Failure> {
    let (scene, kinds) = asked(request, parts)?;
    let path = request.out.clone().unwrap_or_else(|| Path::new("out/cheapest").join(&scene.name));
    let folder = Folder::make(&path, Owner::Alone)?;
    let campaign = Campaign::open(folder.path(), Shard::WHOLE, request.threads, parts.interrupt)?;
    let (mut of_one, mut all) = (request.clone(), Vec::new());
    for kind in kinds {
        if !request.quiet {
            complain(&format!("{}: {}", scene.name, kind.name));
        }
        let reached = Ladder::new(&of_one, parts, Some(&campaign), (&scene, kind)).climb();
        let reached = reached.unwrap_or_else(|failure| Reached::refused(&failure));
        // All methods are held against each other by the same.
        of_one.measure = of_one.measure.or(reached.headline);
        campaign.check()?;
        if campaign.is_interrupted() {
            complain("interrupted: the same command resumes from here");
            return Ok((Verdict::Broken, None));
        }
        all.push(Of { kind, reached });
    }
    all.sort_by(|one, other| {
        let cost = |of: &Of| of.cost().unwrap_or(f64::INFINITY);
        cost(one).total_cmp(&cost(other))
    });
    let study = Study { scene, headline: of_one.measure, all };
    report::write(request, folder.path(), &study)?;
    let is_reached = study.all.iter().any(|of| of.reached.chosen.is_ok());
    let verdict = if is_reached { Verdict::Done } else { Verdict::CheckFailed };
    Ok((verdict, Some(words(request, &study))))
}

/// What reaches an error.
pub struct Settled {
    /// The spacing.
    pub spacing: Override,
    /// What is promised of it, in words.
    pub words: String,
    /// The error, and what it is made of.
    pub estimated: EstimatedError,
}

/// The spacing at which the first method that is asked for reaches the error, and what is promised of it.
///
/// # Errors
/// As [`cheapest`], and where the error is not reached.
pub fn settings(request: &CheapestRequest, parts: &Parts<'_>) -> Result<Settled, Failure> {
    let (scene, kinds) = asked(request, parts)?;
    let name = method::asked(&scene, request.methods.first().map(String::as_str))?;
    let found = kinds.into_iter().find(|kind| kind.name == name);
    let kind = found.ok_or_else(|| Failure::request(NoMethod(scene.name.clone())))?;
    let mut ladder = Ladder::new(request, parts, None, (&scene, kind));
    let reached = ladder.climb()?;
    let chosen = match &reached.chosen {
        Ok(chosen) => *chosen,
        Err(cause) => {
            let (error, method, scene, cause) = (request.error, kind.name, scene.name, cause.clone());
            return Err(Failure::request(OutOfReach { error, method, scene, cause }));
        }
    };
    let spacing = reached.rungs[chosen].spacing;
    let words = format!(
        "a spacing of {}: {} at most {}, by runs at {}",
        length_words(scene.units, spacing),
        reached.headline.map_or("error", Headline::label),
        percent(reached.promised[chosen], 2),
        spacings(&scene, &reached)
    );
    let estimated = ladder.parts_of(chosen, &reached)?;
    Ok(Settled { spacing: spacing_override(scene.units, kind.name, spacing), words, estimated })
}

/// The scene, and the methods.
fn asked(request: &CheapestRequest, parts: &Parts<'_>) -> Result<(Scene, Vec<&'static MethodKind>), Failure> {
    let scene = (parts.scene_at)(&request.scene, &request.overrides)?;
    method::check(&request.methods, parts.methods)?;
    let asked = |kind: &MethodKind| match request.methods.as_slice() {
        [] => scene.method(kind.name).is_some(),
        names => names.iter().any(|name| name == kind.name),
    };
    let kinds: Vec<_> = parts.methods.iter().copied().filter(|kind| asked(kind)).collect();
    if kinds.is_empty() {
        return Err(Failure::request(NoMethod(scene.name)));
    }
    Ok((scene, kinds))
}

/// Spacings of all runs, in words.
fn spacings(scene: &Scene, reached: &Reached) -> String {
    let all: Vec<String> = reached.rungs.iter().map(|rung| length_words(scene.units, rung.spacing)).collect();
    all.join(", ")
}

/// The answer.
fn words(request: &CheapestRequest, study: &Study) -> String {
    let measure = study.headline.map_or("error", Headline::label);
    let mut lines = vec![format!("{measure}, {} on {}:", percent(request.error, 3), study.scene.name)];
    let least = study.all.first().and_then(Of::cost);
    for of in &study.all {
        let name = of.kind.name;
        lines.push(match &of.reached.chosen {
            Ok(chosen) => {
                let rung = &of.reached.rungs[*chosen];
                let ratio = least
                    .filter(|least| *least < rung.cost_s)
                    .map_or_else(String::new, |least| format!(", {:.1} x the cheapest", rung.cost_s / least));
                format!(
                    "  {name:<6} {} at {}, at most {}{ratio}",
                    duration(rung.cost_s),
                    length_words(study.scene.units, rung.spacing),
                    percent(of.reached.promised[*chosen], 2)
                )
            }
            Err(short) => format!("  {name:<6} not reached: {short}"),
        });
    }
    lines.join("\n")
}
