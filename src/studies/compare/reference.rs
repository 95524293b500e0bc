//! What runs are judged by: a closed form or a table, or fine runs of the local method, accepted only if they are shown
//! converged.

mod blame;

use std::collections::BTreeMap;
use std::sync::Arc;

use frazil_plots::style::{duration, percent};
use frazil_record::{Field, Outcome, ProfileRow, ReferenceInfo, RunResult};
use frazil_scene::{ReferenceChoice, Scene, Setting};
use frazil_simulation::march::{Options, Refused, outputs};
use frazil_simulation::measure;
use frazil_simulation::reference::{Cut, Plane, Reference};

use super::plan::overrides;
use super::request::CompareRequest;
use super::runner::{Clock, Purpose, Runner};
use super::variant::Variant;
use crate::ensemble::runs::Headline;
use crate::failure::Failure;
use crate::parts::Parts;
use crate::words::length_words;

/// Estimated error beyond which fine runs are no reference.
const WORST: f64 = 0.02;
/// Share of an instant by which two rows may differ and still be the same instant.
const SAME_INSTANT: f64 = 1e-9;

/// Instant and plane of a profile, and its points in order.
type Profile = (f64, String, Vec<(f64, f64)>);

/// The series of a fine run, read between their rows.
pub struct LocalReference {
    /// Measures that are not known well enough, and why, in words.
    pub unknown: Vec<String>,
    /// Measures that are known.
    known: Vec<Headline>,
    info: ReferenceInfo,
    run: RunResult,
    profiles: Vec<Profile>,
    concentrations: Vec<Profile>,
}

impl LocalReference {
    /// Takes a run of a scene as a reference of everything that it has.
    pub fn new(scene: &Scene, run: RunResult) -> LocalReference {
        let profiles = profiles(scene, &run, |row| Some(row.temperature_c));
        let concentrations = self::profiles(scene, &run, |row| row.concentration);
        let info = ReferenceInfo::new("local", "", 0.0);
        LocalReference { unknown: Vec::new(), known: Headline::ALL.to_vec(), info, run, profiles, concentrations }
    }

    fn knows(&self, headline: Headline) -> bool {
        self.known.contains(&headline)
    }

    fn profile(&self, plane: &str, x: f64, t: f64) -> Option<f64> {
        let read = if self.run.record.of_water { Headline::Saturation } else { Headline::Temperature };
        if self.knows(read) { on_plane(&self.profiles, plane, x, t) } else { None }
    }
}

/// Profiles of a value of their rows.
fn profiles(scene: &Scene, run: &RunResult, value: impl Fn(&ProfileRow) -> Option<f64>) -> Vec<Profile> {
    let mut profiles: Vec<Profile> = Vec::new();
    let direction = scene.freezing_direction();
    for (row, value) in run.profiles.iter().filter_map(|row| Some((row, value(row)?))) {
        // Plane fronts are known by the distance from the wall at which they start.
        let start = direction.filter(|_| row.plane == "line");
        let point = (start.map_or(row.along_m, |direction| direction.distance(row.along_m)), value);
        match profiles.iter_mut().find(|(time, plane, _)| *time == row.time_s && *plane == row.plane) {
            Some((.., points)) => points.push(point),
            None => profiles.push((row.time_s, row.plane.clone(), vec![point])),
        }
    }
    for (.., points) in &mut profiles {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    profiles
}

fn is_instant(time: f64, t: f64) -> bool {
    (time - t).abs() <= SAME_INSTANT * t.abs().max(1.0)
}

fn on_plane(profiles: &[Profile], plane: &str, x: f64, t: f64) -> Option<f64> {
    let same = |(time, own, _): &&Profile| own == plane && is_instant(*time, t);
    between(profiles.iter().find(same).map(|(.., points)| points.as_slice())?, x)
}

fn on_cut(profiles: &[Profile], cut: Cut, x: f64, t: f64) -> Option<f64> {
    let same = |(time, own, _): &&Profile| Cut::named(own) == Some(cut) && is_instant(*time, t);
    between(profiles.iter().find(same).map(|(.., points)| points.as_slice())?, x)
}

/// Value between rows, linear; absent outside them.
fn between(rows: &[(f64, f64)], at: f64) -> Option<f64> {
    let after = rows.partition_point(|row| row.0 < at);
    let next = rows.get(after)?;
    if next.0 == at {
        return Some(next.1);
    }
    let before = rows.get(after.checked_sub(1)?)?;
    Some(before.1 + (next.1 - before.1) * (at - before.0) / (next.0 - before.0))
}

/// Temperature between the cells of a field; that of the nearest beyond the last centres, none without a cell.
fn bilinear(field: &Field, x: f64, y: f64) -> Option<f64> {
    let place = |at: f64, first: f64, count: usize| {
        let cells = ((at - first) / field.spacing_m).clamp(0.0, (count - 1) as f64);
        let low = (cells as usize).min(count.saturating_sub(2));
        (low, (low + 1).min(count - 1), cells - low as f64)
    };
    let ((left, right, u), (below, above, v)) = (place(x, field.x0_m, field.nx), place(y, field.y0_m, field.ny));
    let value = |column: usize, row: usize| field.temperature_c[row * field.nx + column];
    let along = |row: usize| (1.0 - u) * value(left, row) + u * value(right, row);
    Some((1.0 - v) * along(below) + v * along(above)).filter(|value| value.is_finite())
}

impl Reference for LocalReference {
    fn describe(&self) -> ReferenceInfo {
        self.info.clone()
    }

    fn temperature(&self, x: f64, t: f64) -> Option<f64> {
        self.profile("line", x, t).or_else(|| self.profile("radius", x, t))
    }

    fn cut_temperature(&self, cut: Cut, x: f64, t: f64) -> Option<f64> {
        on_cut(&self.profiles, cut, x, t)
    }

    fn concentration(&self, x: f64, t: f64) -> Option<f64> {
        let known = self.knows(Headline::Concentration);
        on_plane(&self.concentrations, "line", x, t).filter(|_| known)
    }

    fn cut_concentration(&self, cut: Cut, x: f64, t: f64) -> Option<f64> {
        let known = self.knows(Headline::Concentration);
        on_cut(&self.concentrations, cut, x, t).filter(|_| known)
    }

    fn point_temperature(&self, x: f64, y: f64, t: f64) -> Option<f64> {
        let same = |field: &&Field| is_instant(field.time_s, t);
        bilinear(self.run.fields.iter().find(same)?, x, y)
    }

    fn plane_temperature(&self, plane: Plane, r: f64, t: f64) -> Option<f64> {
        self.profile(if plane == Plane::Main { "main" } else { "interface" }, r, t)
    }

    fn front(&self, t: f64) -> Option<f64> {
        let start = self.run.start.front_m.map(|front| (0.0, front));
        let rows = start.into_iter().chain(self.run.front.iter().map(|row| (row.time_s, row.front_m)));
        if self.knows(Headline::Front) { between(&rows.collect::<Vec<_>>(), t) } else { None }
    }

    fn frozen_volume(&self, t: f64) -> Option<f64> {
        let start = (0.0, self.run.start.frozen_volume);
        let walls = self.run.walls.iter().map(|row| (row.time_s, row.frozen_area_m2));
        let volumes = self.run.frozen.iter().map(|row| (row.time_s, row.frozen_volume));
        let rows: Vec<(f64, f64)> = std::iter::once(start).chain(walls).chain(volumes).collect();
        if self.knows(Headline::Volume) && rows.len() > 1 { between(&rows, t) } else { None }
    }

    fn thickness(&self, plane: Plane, t: f64) -> Option<f64> {
        let value = |row: &frazil_record::WallRow| match plane {
            Plane::Main => row.thickness_main_mean_m,
            Plane::Interface => row.thickness_interface_mean_m,
        };
        let rows = self.run.walls.iter().filter_map(|row| Some((row.time_s, value(row)?)));
        between(&rows.collect::<Vec<_>>(), t)
    }

    fn event(&self, name: &str) -> Option<f64> {
        if !self.knows(Headline::Closure) {
            return None;
        }
        let closures: Option<Vec<(f64, f64)>> =
            self.run.gaps.iter().map(|gap| Some((gap.closure_s?, gap.multiplicity as f64))).collect();
        match name {
            "closure_day_first" => self.run.gaps.iter().filter_map(|gap| gap.closure_s).reduce(f64::min),
            "closure_day_last" => closures?.iter().map(|closure| closure.0).reduce(f64::max),
            "closure_day" => {
                let closures = closures?;
                let count: f64 = closures.iter().map(|closure| closure.1).sum();
                (count > 0.0).then(|| closures.iter().map(|(time, weight)| time * weight).sum::<f64>() / count)
            }
            _ => None,
        }
    }
}

/// Why fine local runs are no reference.
#[derive(Debug, thiserror::Error)]
enum NoLocalReference {
    #[error("no local run ended well")]
    Failed,
    #[error("{} allow one local run only; give more time with --budget-s", duration(*.budget_s))]
    Single { budget_s: f64 },
    #[error("{}", .0.join("; "))]
    Unconverged(Vec<String>),
    #[error("the local runs have nothing to compare")]
    Nothing,
    #[error("there is no local method to make one")]
    NoMethod,
    #[error(transparent)]
    Refused(#[from] Refused),
}

/// Judges all runs of a scene over one window, in which the front has left the first particles of the coarsest spacing (m),
/// where the scene does not say another.
pub fn judge_alike(scene: &mut Scene, coarsest: f64, reference: &dyn Reference) {
    if scene.watch.front_from.is_none() {
        let from = measure::front::window_start(scene, coarsest, outputs(scene).into_iter(), reference);
        scene.watch.front_from = Some(from);
    }
}

/// The reference of a scene: a closed form or a table or, where there is none, fine local runs; none if the scene asks for none.
/// What stands in for the one that the scene names is among its remarks afterwards. `spacings` are the finest and the
/// coarsest of the comparison (m).
///
/// # Errors
///
/// If the reference that the scene names is none.
pub fn truth(
    request: &CompareRequest,
    parts: &Parts<'_>,
    runner: &Runner<'_>,
    (name, base): (&str, &mut Scene),
    spacings: (f64, f64),
    say: &dyn Fn(&str),
) -> Result<Option<Arc<dyn Reference>>, Failure> {
    let known = (parts.reference_for)(base).map_err(Failure::Request)?;
    base.remarks.extend(known.instead);
    if let Some(closed) = known.reference {
        return Ok(Some(Arc::from(closed)));
    }
    if base.reference == ReferenceChoice::None {
        return Ok(None);
    }
    Ok(match local_reference(request, parts, runner, (name, base), spacings, say) {
        Ok(reference) => {
            base.remarks.extend(reference.unknown.iter().cloned());
            Some(Arc::new(reference))
        }
        Err(reason) => {
            base.remarks.push(format!("no reference: {reason}"));
            None
        }
    })
}

/// Runs the local method at the finest spacing of a comparison and finer, as far as the time allows, and takes the
/// finest run, with the errors that the difference of the two finest suggests. Measures in which they differ too much it does
/// not know. `spacings` are the finest and the coarsest of the comparison (m).
fn local_reference(
    request: &CompareRequest,
    parts: &Parts<'_>,
    runner: &Runner<'_>,
    (name, base): (&str, &Scene),
    (finest, coarsest): (f64, f64),
    say: &dyn Fn(&str),
) -> Result<LocalReference, NoLocalReference> {
    let mut runs = fine_runs(request, parts, runner, (name, base), finest, say)?;
    let (spacing, fine) = runs.pop().ok_or(NoLocalReference::Failed)?;
    let (_, coarser) = runs.last().ok_or(NoLocalReference::Single { budget_s: request.budget() })?;
    let mut truth = LocalReference::new(base, fine);
    let mut judged = base.clone();
    judge_alike(&mut judged, coarsest, &truth);
    let difference = |run: &RunResult, headline: Headline| {
        headline.of(&measure::errors(&judged, 2.0 * spacing, run, &truth)).map(f64::abs)
    };
    let (mut known, mut unknown, mut errors) = (Vec::new(), Vec::new(), BTreeMap::new());
    for headline in Headline::ALL {
        let Some(estimate) = difference(coarser, headline) else { continue };
        // With a third run the order is seen; without, first order is the cautious guess.
        let order = match runs.len().checked_sub(2).and_then(|k| difference(&runs[k].1, headline)) {
            Some(coarse) if estimate > 0.0 => (coarse / estimate - 1.0).max(1.0).log2().clamp(1.0, 2.0),
            _ => 1.0,
        };
        let error = estimate / (2f64.powf(order) - 1.0);
        if error > WORST {
            unknown.push(format!(
                "local runs at {} and {} still differ by {} in the {}: not converged; {}",
                length_words(base.units, 2.0 * spacing),
                length_words(base.units, spacing),
                percent(estimate, 2),
                headline.name(),
                blame::outputs(headline, &judged, 2.0 * spacing, coarser, &truth)
            ));
        } else {
            known.push(headline);
            errors.insert(headline.name().to_owned(), error);
        }
    }
    let Some(first) = known.first() else {
        return Err(if unknown.is_empty() {
            NoLocalReference::Nothing
        } else {
            NoLocalReference::Unconverged(unknown)
        });
    };
    let source = format!("finest of {} local runs, at {}", runs.len() + 1, length_words(base.units, spacing));
    truth.info = ReferenceInfo { errors: errors.clone(), ..ReferenceInfo::new("local", source, errors[first.name()]) };
    (truth.known, truth.unknown) = (known, unknown);
    Ok(truth)
}

/// Local runs from twice the finest spacing (m) on, each at half of the one before, as far as the time (s) allows.
fn fine_runs(
    request: &CompareRequest,
    parts: &Parts<'_>,
    runner: &Runner<'_>,
    (name, base): (&str, &Scene),
    finest: f64,
    say: &dyn Fn(&str),
) -> Result<Vec<(f64, RunResult)>, NoLocalReference> {
    if !parts.methods.iter().any(|kind| kind.name == "local") {
        return Err(NoLocalReference::NoMethod);
    }
    let seconds = request.budget();
    let explicit = 2f64.powi(base.domain.dimension() as i32 + 2);
    let clock = Clock::start();
    let mut runs: Vec<(f64, RunResult)> = Vec::new();
    let mut last = 0.0;
    for spacing in [2.0 * finest, finest, 0.5 * finest, 0.25 * finest] {
        if clock.elapsed() + last * explicit > seconds {
            break;
        }
        let best = Variant::standard(Setting::Best);
        let Ok(scene) = request.scene(parts, name, &overrides(base.units, "local", spacing, &best)) else {
            continue;
        };
        say(&format!("{}: local run at {} for a reference", base.name, length_words(base.units, spacing)));
        let begun = clock.elapsed();
        let options = Options { time_limit_s: Some(2.0 * seconds), fields: true, ..Options::default() };
        let made = runner.run(Purpose::Reference, &scene, "local", None, &options)?;
        clock.add(made.earlier_s);
        if made.result.record.outcome != Outcome::Ok {
            break;
        }
        last = clock.elapsed() - begun;
        runs.push((spacing, made.result));
    }
    Ok(runs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_between_rows_and_not_beyond() {
        let rows = [(1.0, 10.0), (2.0, 20.0), (4.0, 0.0)];
        assert_eq!(between(&rows, 3.0), Some(10.0));
        assert_eq!(between(&rows, 4.0), Some(0.0));
        assert_eq!((between(&rows, 0.5), between(&rows, 4.5)), (None, None));
    }
}
