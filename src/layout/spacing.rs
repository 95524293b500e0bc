//! The spacing at which the answers of all layouts reach an error.

use std::collections::BTreeMap;

use frazil_plots::style::percent;
use frazil_record::{RunResult, WallRow};
use frazil_simulation::reference::Truth;
use frazil_studies::campaign::Campaign;
use frazil_studies::cheapest::{CheapestRequest, Differ, Ladder, Quantity, Reached, Short};
use frazil_studies::compare::plan::spacing_override;
use frazil_studies::failure::{Failure, complain};
use frazil_studies::parts::{Override, Parts};
use frazil_studies::words::length_words;

use super::LayoutRequest;
use super::execute::made_of;
use super::found::{Attained, Found};
use super::goals::Promise;
use super::study::Study;
use super::variants::{Layout, Role};

/// Which of the layouts that are compared have not reached an error, each in words.
pub(super) fn missed(promise: &Promise, found: &[Found<'_>]) -> Vec<String> {
    let words = |one: &Found<'_>| {
        let Attained { closure, thickness } = one.attained(promise);
        let all = [("day of closure", closure), ("thickness at the end", thickness)];
        let over = all.into_iter().filter_map(|(name, own)| Some((name, own.filter(|own| *own > promise.error)?)));
        let over: Vec<String> = over.map(|(name, own)| format!("{name} to {}", percent(own, 2))).collect();
        let (name, asked) = (&one.layout.name, percent(promise.error, 3));
        (!over.is_empty())
            .then(|| format!("layout \"{name}\": {} instead of {asked}; set a smaller spacing", over.join(", ")))
    };
    found.iter().filter(|one| one.layout.role == Role::Compared).filter_map(words).collect()
}

/// A layout that does not reach the error.
#[derive(Debug, thiserror::Error)]
#[error("--error {}: layout \"{layout}\" does not reach it with {method}: {cause}", percent(*error, 3))]
struct OutOfReach {
    error: f64,
    layout: String,
    method: &'static str,
    cause: Short,
}

/// The spacing at which all layouts that are compared promise an error under a method, which is said.
///
/// # Errors
/// Where one of them does not within the budget of its runs, or a run is refused.
pub(super) fn choose(
    request: &LayoutRequest,
    study: &Study<'_>,
    (method, error): (&'static str, f64),
    campaign: &Campaign<'_>,
) -> Result<Option<(Override, Promise)>, Failure> {
    let (mut spacing, mut promise) =
        (f64::INFINITY, Promise { error, order: f64::INFINITY, promised: BTreeMap::new() });
    for layout in study.compared() {
        let reached = climb(request, study, layout, (method, error), campaign)?;
        let chosen = match reached.chosen {
            Ok(chosen) => chosen,
            Err(Short::Interrupted) => return Ok(None),
            Err(cause) => {
                return Err(Failure::request(OutOfReach { error, layout: layout.name.clone(), method, cause }));
            }
        };
        spacing = spacing.min(reached.rungs[chosen].spacing);
        promise.order = promise.order.min(reached.order);
        promise.promised.insert(layout.name.clone(), reached.promised[chosen]);
    }
    let units = study.layouts[0].scene.units;
    if !request.quiet {
        let worst = promise.promised.values().copied().fold(0.0, f64::max);
        let (length, promised) = (length_words(units, spacing), percent(worst, 2));
        let method = if request.method.is_some() { format!(" with {method}") } else { String::new() };
        complain(&format!(
            "{}: a spacing of {length}{method}: days of closure and thickness at the end at most {promised} off, by runs at larger ones",
            study.name
        ));
    }
    Ok(Some((spacing_override(units, method, spacing), promise)))
}

/// Runs of a layout from coarse to fine.
fn climb(
    request: &LayoutRequest,
    study: &Study<'_>,
    layout: &Layout,
    (method, error): (&'static str, f64),
    campaign: &Campaign<'_>,
) -> Result<Reached, Failure> {
    let ground = &study.ground;
    let of_one = CheapestRequest {
        scene: ground.scene.clone(),
        methods: Vec::new(),
        error,
        measure: None,
        overrides: made_of(layout),
        threads: request.threads,
        budget_s: request.budget_s,
        out: None,
        quiet: request.quiet,
        command_line: String::new(),
    };
    // A layout is another problem than that of the reference of its scene.
    let parts = Parts { reference_for: &|_| Ok(Truth { reference: None, instead: None }), ..ground.parts };
    let Some(kind) = parts.methods.iter().copied().find(|kind| kind.name == method) else {
        return Ok(Reached::refused(&Failure::request(NoSettings(method))));
    };
    let (closes, thick, frozen): (&Differ<'_>, &Differ<'_>, &Differ<'_>) = (&closure, &thickness, &area);
    let quantities = [closes, thick, frozen].map(Quantity::Answer).into();
    let ladder = Ladder::new(&of_one, &parts, Some(campaign), (&layout.scene, kind));
    ladder.of(quantities, coarsest(study, layout, method)).climb()
}

/// A method that a scene has no settings for.
#[derive(Debug, thiserror::Error)]
#[error("the scene has no settings for {0}")]
struct NoSettings(&'static str);

/// The largest spacing that a layout can be run at, of eight times its own and halves of that.
fn coarsest(study: &Study<'_>, layout: &Layout, method: &str) -> f64 {
    let mut at = layout.clone();
    let own = layout.scene.method(method).map_or(f64::NAN, |own| own.numerics.spacing);
    let mut spacing = 8.0 * own;
    while spacing > own {
        for settings in at.scene.methods.iter_mut().filter(|settings| settings.method == method) {
            settings.numerics.spacing = spacing;
        }
        if at.fits(study.shaft_radius, method).is_ok() {
            break;
        }
        spacing *= 0.5;
    }
    spacing
}

/// What two values differ by, over the finer one; nothing where none of both is there.
fn relative(coarse: Option<f64>, fine: Option<f64>) -> Option<f64> {
    match (coarse, fine) {
        (Some(coarse), Some(fine)) => Some((coarse - fine).abs() / fine),
        (None, None) => Some(0.0),
        _ => None,
    }
}

fn closure(coarse: &RunResult, fine: &RunResult) -> Option<f64> {
    let day = |run: &RunResult| run.record.wall.as_ref().and_then(|wall| wall.closure_s);
    relative(day(coarse), day(fine))
}

fn at_the_end(run: &RunResult, of: impl Fn(&WallRow) -> Option<f64>) -> Option<f64> {
    run.walls.last().and_then(of).filter(|value| *value > 0.0)
}

fn thickness(coarse: &RunResult, fine: &RunResult) -> Option<f64> {
    let thickness = |run: &RunResult| at_the_end(run, |row| row.thickness_weakest_m);
    relative(thickness(coarse), thickness(fine))
}

/// Of walls that are open, the frozen area.
fn area(coarse: &RunResult, fine: &RunResult) -> Option<f64> {
    let area = |run: &RunResult| at_the_end(run, |row| Some(row.frozen_area_m2).filter(|_| row.closed != Some(true)));
    match (area(coarse), area(fine)) {
        (Some(coarse), Some(fine)) => relative(Some(coarse), Some(fine)),
        _ => Some(0.0),
    }
}
