//! How wrong a run is: its series against a reference.
//!
//! All measures are pure functions of the series that a run leaves, so a record can be judged again later. A
//! measure that does not apply, or that the reference does not know, is absent and never zero.

pub mod front;
pub mod measured;

use std::collections::BTreeMap;

use frazil_record::{BesideRow, Errors, FrontRow, FrozenRow, GapRow, ProfileRow, RunResult, WallRow};
use frazil_scene::{FreezingDirection, Scene};

use crate::reference::{Cut, Plane, Reference};

/// Temperatures on a plane count only farther than this many particle spacings from the wall of a pipe: an
/// immersed pipe is smeared over them.
const PIPE_SPACINGS: f64 = 2.0;

/// Frozen volumes of rings are judged from the first day on (or a tenth of a shorter run): before, the frozen
/// ground is a few particles, and daily tables do not resolve it.
const VOLUME_FROM: f64 = 86_400.0;

/// Thicknesses are judged from this multiple of the reference's closure on. At closure itself the wall between
/// pipes has no thickness to be relative to, and the time of closure is a measure of its own.
const THICKNESS_FROM: f64 = 1.25;

/// Plane of a profile row, by its name in the series.
enum ProfilePlane {
    Line,
    Ring(Plane),
    Radius,
    Cut(Cut),
}

impl ProfilePlane {
    fn named(name: &str) -> Option<Self> {
        match name {
            "line" => Some(ProfilePlane::Line),
            "main" => Some(ProfilePlane::Ring(Plane::Main)),
            "interface" => Some(ProfilePlane::Ring(Plane::Interface)),
            "radius" => Some(ProfilePlane::Radius),
            _ => Cut::named(name).map(ProfilePlane::Cut),
        }
    }

    /// What the reference has at a place along it (m).
    fn temperature(
        &self,
        direction: Option<FreezingDirection>,
        reference: &dyn Reference,
        along: f64,
        t: f64,
    ) -> Option<f64> {
        match self {
            ProfilePlane::Line => reference.temperature(direction?.distance(along), t),
            ProfilePlane::Radius => reference.temperature(along, t),
            ProfilePlane::Cut(cut) => reference.cut_temperature(*cut, along, t).or_else(|| {
                // A plane front is known on all lines through it.
                let direction = direction?;
                let (x, y) = cut.point(along);
                reference.temperature(direction.distance(if direction.along_y { y } else { x }), t)
            }),
            ProfilePlane::Ring(plane) => reference.plane_temperature(*plane, along, t),
        }
    }

    /// The concentration that the reference has at a place along it (m).
    fn concentration(
        &self,
        direction: Option<FreezingDirection>,
        reference: &dyn Reference,
        along: f64,
        t: f64,
    ) -> Option<f64> {
        match self {
            ProfilePlane::Line => reference.concentration(direction?.distance(along), t),
            ProfilePlane::Cut(cut) => reference.cut_concentration(*cut, along, t),
            ProfilePlane::Radius | ProfilePlane::Ring(_) => None,
        }
    }

    /// Whether a point of the profile counts.
    fn counts(&self, scene: &Scene, spacing: f64, x: f64) -> bool {
        match self {
            // A body without a direction has no such profile.
            ProfilePlane::Line => {
                let reach = scene.watch.profile_length.zip(scene.freezing_direction());
                reach.is_none_or(|(length, direction)| direction.distance(x) <= length)
            }
            ProfilePlane::Radius | ProfilePlane::Cut(_) => true,
            // With several rings the plane between two pipes of one may pass through a pipe of another.
            ProfilePlane::Ring(Plane::Interface) if scene.rings.len() < 2 => true,
            ProfilePlane::Ring(_) => scene
                .rings
                .iter()
                .all(|ring| (x - ring.ring_radius).abs() >= ring.pipe_radius + PIPE_SPACINGS * spacing),
        }
    }
}

/// Fills the reference's columns of all series, the errors and the description of the reference.
///
/// `spacing` is the particle spacing of the run (m).
pub fn attach(scene: &Scene, spacing: f64, result: &mut RunResult, reference: &dyn Reference) {
    for row in &mut result.front {
        row.front_ref_m = reference.front(row.time_s);
    }
    let beside = |row: &FrontRow| {
        let (solution, front_m) = reference.beside(row.time_s)?;
        Some(BesideRow { time_s: row.time_s, front_m, solution: solution.to_string() })
    };
    result.beside = result.front.iter().filter_map(beside).collect();
    for row in &mut result.frozen {
        row.frozen_volume_ref = reference.frozen_volume(row.time_s);
    }
    let direction = scene.freezing_direction();
    for row in &mut result.profiles {
        let plane = ProfilePlane::named(&row.plane);
        let at = (row.along_m, row.time_s);
        row.temperature_ref_c = plane.as_ref().and_then(|plane| plane.temperature(direction, reference, at.0, at.1));
        let concentration = plane.and_then(|plane| plane.concentration(direction, reference, at.0, at.1));
        row.concentration_ref = concentration.filter(|_| row.concentration.is_some());
    }
    for row in &mut result.walls {
        row.thickness_main_mean_ref_m = reference.thickness(Plane::Main, row.time_s);
        row.thickness_interface_mean_ref_m = reference.thickness(Plane::Interface, row.time_s);
        row.frozen_area_ref_m2 = reference.frozen_volume(row.time_s);
    }
    for row in &mut result.gaps {
        row.closure_ref_s = reference.event("closure_day");
    }
    for field in &mut result.fields {
        let at = |k: usize| {
            let (x, y) = ((k % field.nx) as f64, (k / field.nx) as f64);
            reference.point_temperature(
                field.x0_m + x * field.spacing_m,
                field.y0_m + y * field.spacing_m,
                field.time_s,
            )
        };
        let count = field.nx * field.ny;
        if (0..count).any(|k| at(k).is_some()) {
            field.temperature_ref_c = (0..count).map(|k| at(k).unwrap_or(f64::NAN)).collect();
        }
    }
    if let Some(points) = reference.measured() {
        result.measured = measured::rows(scene, result, points);
        result.record.measured = measured::deviations(&result.measured);
    }
    result.record.errors = errors(scene, spacing, result, reference);
    result.record.reference = Some(reference.describe());
}

/// Temperatures of a run and of the reference at all profile points that count. `spacing` is the particle spacing of
/// the run (m).
pub fn profile_points(scene: &Scene, spacing: f64, result: &RunResult, reference: &dyn Reference) -> Vec<(f64, f64)> {
    points(scene, spacing, result, reference).collect()
}

fn points(
    scene: &Scene,
    spacing: f64,
    result: &RunResult,
    reference: &dyn Reference,
) -> impl Iterator<Item = (f64, f64)> {
    let direction = scene.freezing_direction();
    let rows = result.profiles.iter().filter_map(move |row| {
        let plane = ProfilePlane::named(&row.plane)?;
        let expected = plane.temperature(direction, reference, row.along_m, row.time_s)?;
        plane.counts(scene, spacing, row.along_m).then_some((row.temperature_c, expected))
    });
    // Where water flows, those of its cut, after the start.
    let cut = result.water.iter().flat_map(|water| &water.cut).filter(|row| row.time_s > 0.0);
    let cut = cut.filter_map(|row| Some((row.temperature_c, reference.cut(row.x_m, row.time_s)?.0)));
    let probes = result.measured.iter().filter(|row| row.is_of_probe());
    rows.chain(cut).chain(probes.filter_map(|row| Some((row.value?, row.value_ref))))
}

/// What temperatures at many points come to beside those of a reference, one after the other.
struct Deviation {
    count: usize,
    squares: f64,
    sum: f64,
    magnitudes: f64,
    largest: f64,
    /// Greatest magnitude of the reference.
    scale: f64,
    /// Least and greatest of the reference.
    range: (f64, f64),
}

impl Deviation {
    fn of(points: impl Iterator<Item = (f64, f64)>) -> Option<Deviation> {
        let range = (f64::INFINITY, f64::NEG_INFINITY);
        let none = Deviation { count: 0, squares: 0.0, sum: 0.0, magnitudes: 0.0, largest: 0.0, scale: 0.0, range };
        let all = points.fold(none, |sum, (own, expected)| Deviation {
            count: sum.count + 1,
            squares: sum.squares + (own - expected).powi(2),
            sum: sum.sum + (own - expected),
            magnitudes: sum.magnitudes + (own - expected).abs(),
            largest: sum.largest.max((own - expected).abs()),
            scale: sum.scale.max(expected.abs()),
            range: (sum.range.0.min(expected), sum.range.1.max(expected)),
        });
        (all.count > 0).then_some(all)
    }

    fn rms(&self) -> Option<f64> {
        finite((self.squares / self.count as f64).sqrt())
    }

    fn mean(&self) -> Option<f64> {
        finite(self.sum / self.count as f64)
    }

    fn mean_abs(&self) -> Option<f64> {
        finite(self.magnitudes / self.count as f64)
    }
}

/// Errors of a run against a reference. `spacing` is the particle spacing of the run (m).
pub fn errors(scene: &Scene, spacing: f64, result: &RunResult, reference: &dyn Reference) -> Errors {
    if scene.of_water {
        return errors_of_water(scene, spacing, result, reference);
    }
    let found = Deviation::of(points(scene, spacing, result, reference));
    let (mut least, mut greatest) = scene.temperature_range();
    if let Some(found) = found.as_ref().filter(|_| scene.has_flux()) {
        // A flux drives temperatures beyond the data: the reference tells how far.
        (least, greatest) = (least.min(found.range.0), greatest.max(found.range.1));
    }
    let deviation = found.as_ref().and_then(Deviation::rms);
    let mean = found.as_ref().and_then(Deviation::mean);
    // A point that is no number has no error, and a run that has one has none that is known.
    let largest = found.as_ref().filter(|_| deviation.is_some()).map(|found| found.largest);
    let scale = found.as_ref().map(|found| found.scale);

    let window = front::window(scene, spacing, &result.front, reference);

    let volume_from = scene.watch.front_from.unwrap_or(0.0).max(VOLUME_FROM.min(0.1 * scene.duration));
    let closure = reference.event("closure_day");
    let thickness_from = closure.map(|closure| THICKNESS_FROM * closure);
    let wall_error = |from: Option<f64>, own: fn(&WallRow) -> Option<f64>, expected: &dyn Fn(f64) -> Option<f64>| {
        let from = from?;
        relative_rms(
            result
                .walls
                .iter()
                .filter(|row| row.time_s >= from)
                .filter_map(|row| Some((own(row)?, positive(expected(row.time_s)?)?))),
        )
    };
    Errors {
        temperature_rms_rel: over(deviation, Some(greatest - least)),
        temperature_mean_rel: mean.and_then(|mean| finite(mean / positive(greatest - least)?)),
        temperature_rms_over_max_abs: over(deviation, scale),
        temperature_max_rel: over(largest, Some(greatest - least)),
        front_rms_rel: rms(window.iter().map(front::Judged::error)),
        front_last_rel: front::last(scene, &result.front, reference),
        front_constant_rel: front::constant(&window),
        frozen_volume_rms_rel: frozen_area(&result.walls, volume_from, reference)
            .or_else(|| frozen_volume(scene, &result.frozen, reference)),
        thickness_main_rms_rel: wall_error(thickness_from, |row| row.thickness_main_mean_m, &|t| {
            reference.thickness(Plane::Main, t)
        }),
        thickness_interface_rms_rel: wall_error(thickness_from, |row| row.thickness_interface_mean_m, &|t| {
            reference.thickness(Plane::Interface, t)
        }),
        events: closure_errors(scene, result, reference),
        ..Errors::default()
    }
}

/// The same of unsaturated water and of what it carries.
fn errors_of_water(scene: &Scene, spacing: f64, result: &RunResult, reference: &dyn Reference) -> Errors {
    let saturations = Deviation::of(points(scene, spacing, result, reference));
    let concentrations = Deviation::of(concentration_points(scene, spacing, result, reference).into_iter());
    let (least, greatest) = scene.solute.as_ref().map_or((0.0, 0.0), |solute| solute.range());
    let window = front::window(scene, spacing, &result.front, reference);
    let rms = |found: &Option<Deviation>| found.as_ref().and_then(Deviation::rms);
    let mean = |found: &Option<Deviation>| found.as_ref().and_then(Deviation::mean_abs);
    Errors {
        saturation_rms: rms(&saturations),
        saturation_mean_abs: mean(&saturations),
        concentration_rms_rel: over(rms(&concentrations), Some(greatest - least)),
        concentration_mean_abs_rel: over(mean(&concentrations), Some(greatest - least)),
        front_rms_rel: self::rms(window.iter().map(front::Judged::error)),
        front_last_rel: front::last(scene, &result.front, reference),
        front_constant_rel: front::constant(&window),
        ..Errors::default()
    }
}

/// Concentrations of a run and of the reference at all profile points that count. `spacing` is the particle spacing of the
/// run (m).
pub fn concentration_points(
    scene: &Scene,
    spacing: f64,
    result: &RunResult,
    reference: &dyn Reference,
) -> Vec<(f64, f64)> {
    let direction = scene.freezing_direction();
    let point = |row: &ProfileRow| {
        let plane = ProfilePlane::named(&row.plane)?;
        let expected = plane.concentration(direction, reference, row.along_m, row.time_s)?;
        plane.counts(scene, spacing, row.along_m).then_some((row.concentration?, expected))
    };
    result.profiles.iter().filter_map(point).collect()
}

fn positive(value: f64) -> Option<f64> {
    (value > 0.0).then_some(value)
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Root of the mean square; absent for no values and where one is not finite.
fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut count, mut sum) = (0_usize, 0.0);
    for value in values {
        count += 1;
        sum += value * value;
    }
    if count == 0 { None } else { finite((sum / count as f64).sqrt()) }
}

/// Rms of the relative error of pairs of own and expected values.
fn relative_rms(pairs: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    rms(pairs.map(|(own, expected)| (own - expected) / expected))
}

fn over(value: Option<f64>, scale: Option<f64>) -> Option<f64> {
    finite(value? / positive(scale?)?)
}

/// Rms from an instant (s) on of the error of the frozen area of a ring, over how much more (or less) there is of the
/// reference's than at the start.
fn frozen_area(rows: &[WallRow], from: f64, reference: &dyn Reference) -> Option<f64> {
    let start = reference.frozen_volume(0.0).unwrap_or(0.0);
    rms(rows.iter().filter(|row| row.time_s >= from).filter_map(|row| {
        let expected = reference.frozen_volume(row.time_s)?;
        Some((row.frozen_area_m2 - expected) / positive((expected - start).abs())?)
    }))
}

/// Rms over the window of the error of a frozen volume, over the greatest change of the reference's since the start: a thaw
/// is judged by what has thawed.
fn frozen_volume(scene: &Scene, rows: &[FrozenRow], reference: &dyn Reference) -> Option<f64> {
    let from = scene.watch.front_from.unwrap_or(0.0);
    let known =
        || rows.iter().filter_map(|row| Some((row.time_s, row.frozen_volume, reference.frozen_volume(row.time_s)?)));
    let start = reference.frozen_volume(0.0).unwrap_or(0.0);
    let greatest = known().map(|(.., expected)| (expected - start).abs()).reduce(f64::max);
    let window = known().filter(|(time, ..)| *time >= from);
    over(rms(window.map(|(_, own, expected)| own - expected)), greatest)
}

/// Times (s) of what came about in a run, by name: closure as the mean over all gaps of the ring, of the first and of the last gap,
/// the latter and the mean only once all are closed; the thaw of the last ice; and when the front became steady.
fn events(scene: &Scene, result: &RunResult) -> BTreeMap<&'static str, f64> {
    let gaps = || result.gaps.iter().filter(|gap| gap.multiplicity > 0);
    let mut events = BTreeMap::new();
    events.extend(gaps().filter_map(|gap| gap.closure_s).reduce(f64::min).map(|first| ("closure_day_first", first)));
    if gaps().all(|gap| gap.closure_s.is_some()) {
        let weighted = |gap: &GapRow| gap.closure_s.map(|closure| closure * gap.multiplicity as f64);
        let count: usize = gaps().map(|gap| gap.multiplicity).sum();
        if count > 0 {
            events.insert("closure_day", gaps().filter_map(weighted).sum::<f64>() / count as f64);
        }
        events.extend(gaps().filter_map(|gap| gap.closure_s).reduce(f64::max).map(|last| ("closure_day_last", last)));
    }
    let thawed = result.record.water.as_ref().and_then(|water| water.events_s.get("thawed"));
    events.extend(thawed.map(|thawed| ("thawed", *thawed)));
    events.extend(front::steady(scene, &result.front).map(|steady| ("front_steady", steady)));
    events
}

/// Signed relative errors of the times of closure.
fn closure_errors(scene: &Scene, result: &RunResult, reference: &dyn Reference) -> BTreeMap<String, f64> {
    let error = |(name, own): (&str, f64)| {
        let expected = reference.event(name).or_else(|| reference.event("closure_day"));
        Some((name.to_owned(), finite(own / expected.and_then(positive)? - 1.0)?))
    };
    events(scene, result).into_iter().filter(|(name, _)| name.starts_with("closure")).filter_map(error).collect()
}

#[cfg(test)]
mod tests;
