//! How wrong a run is: its series against a reference.
//!
//! All measures are pure functions of the series that a run leaves, so a record can be judged again later. A
//! measure that does not apply, or that the reference does not know, is absent and never zero.

pub mod front;

use std::collections::BTreeMap;

use crate::reference::{Cut, Plane, Reference};
use frazil_record::{BesideRow, Errors, FrontRow, FrozenRow, GapRow, RunResult, WallRow};
use frazil_scene::{FreezingDirection, Scene};

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
        row.temperature_ref_c =
            plane.and_then(|plane| plane.temperature(direction, reference, row.along_m, row.time_s));
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
    rows.chain(cut.filter_map(|row| Some((row.temperature_c, reference.cut(row.x_m, row.time_s)?.0))))
}

/// What temperatures at many points come to beside those of a reference, one after the other.
struct Deviation {
    count: usize,
    squares: f64,
    sum: f64,
    largest: f64,
    /// Greatest magnitude of the reference.
    scale: f64,
    /// Least and greatest of the reference.
    range: (f64, f64),
}

impl Deviation {
    fn of(points: impl Iterator<Item = (f64, f64)>) -> Option<Deviation> {
        let range = (f64::INFINITY, f64::NEG_INFINITY);
        let none = Deviation { count: 0, squares: 0.0, sum: 0.0, largest: 0.0, scale: 0.0, range };
        let all = points.fold(none, |sum, (own, expected)| Deviation {
            count: sum.count + 1,
            squares: sum.squares + (own - expected).powi(2),
            sum: sum.sum + (own - expected),
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
}

/// Errors of a run against a reference. `spacing` is the particle spacing of the run (m).
pub fn errors(scene: &Scene, spacing: f64, result: &RunResult, reference: &dyn Reference) -> Errors {
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
    let wall_error = |from: Option<f64>, own: fn(&WallRow) -> f64, expected: &dyn Fn(f64) -> Option<f64>| {
        let from = from?;
        relative_rms(
            result
                .walls
                .iter()
                .filter(|row| row.time_s >= from)
                .filter_map(|row| Some((own(row), positive(expected(row.time_s)?)?))),
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
        events: closure_errors(&result.gaps, reference),
    }
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

/// Signed relative errors of closure: of the mean over all gaps of the ring, and of the first and the last gap.
/// While a gap is open there is neither mean nor last.
fn closure_errors(gaps: &[GapRow], reference: &dyn Reference) -> BTreeMap<String, f64> {
    let mut events = BTreeMap::new();
    let mut note = |name: &str, own: Option<f64>| {
        let expected = reference.event(name).or_else(|| reference.event("closure_day"));
        let error = own.zip(expected.and_then(positive)).and_then(|(own, expected)| finite(own / expected - 1.0));
        if let Some(error) = error {
            events.insert(name.to_owned(), error);
        }
    };
    let gaps = || gaps.iter().filter(|gap| gap.multiplicity > 0);
    note("closure_day_first", gaps().filter_map(|gap| gap.closure_s).reduce(f64::min));
    if gaps().all(|gap| gap.closure_s.is_some()) {
        let weighted = |gap: &GapRow| gap.closure_s.map(|closure| closure * gap.multiplicity as f64);
        let count: usize = gaps().map(|gap| gap.multiplicity).sum();
        if count > 0 {
            note("closure_day", Some(gaps().filter_map(weighted).sum::<f64>() / count as f64));
        }
        note("closure_day_last", gaps().filter_map(|gap| gap.closure_s).reduce(f64::max));
    }
    events
}

#[cfg(test)]
mod tests {
    use super::*;
    use frazil_core::boundary::condition::Condition;
    use frazil_core::physics::material::{FreezingLaw, Material, Mixing, Phase};
    use frazil_core::series::Series;
    use frazil_core::space::domain::{Domain, Sector};
    use frazil_record::{Outcome, ProfileRow, Record, ReferenceInfo};
    use frazil_scene::{PipeRing, ReferenceChoice, TimeUnit, Units, Wall, Watch};

    const DAY: f64 = 86_400.0;

    /// A truth in simple closed forms.
    struct Truth;

    impl Reference for Truth {
        fn describe(&self) -> ReferenceInfo {
            ReferenceInfo::new("exact", "made up", 0.0)
        }
        fn temperature(&self, x: f64, _t: f64) -> Option<f64> {
            Some(-20.0 + 10.0 * x)
        }
        fn plane_temperature(&self, plane: Plane, r: f64, _t: f64) -> Option<f64> {
            Some(if plane == Plane::Main { r } else { 2.0 * r })
        }
        fn front(&self, t: f64) -> Option<f64> {
            Some(0.1 * t.sqrt())
        }
        fn frozen_volume(&self, t: f64) -> Option<f64> {
            (t >= DAY).then_some(t / DAY)
        }
        fn thickness(&self, plane: Plane, t: f64) -> Option<f64> {
            Some(if plane == Plane::Main { 2.0 } else { (t / DAY - 10.0).max(0.0) })
        }
        fn event(&self, name: &str) -> Option<f64> {
            (name == "closure_day").then_some(10.0 * DAY)
        }
    }

    /// A truth whose front does not follow the root of time, and that knows nothing else.
    struct Slowing;

    impl Reference for Slowing {
        fn describe(&self) -> ReferenceInfo {
            ReferenceInfo::new("table", "made up", 0.0)
        }
        fn front(&self, t: f64) -> Option<f64> {
            Some(t.sqrt() / (1.0 + 1e-3 * t))
        }
    }

    fn scene(domain: Domain, duration: f64) -> Scene {
        let phase = Phase { conductivity: 1.0, heat_capacity: 1.0 };
        Scene {
            name: "test".into(),
            title: String::new(),
            source: String::new(),
            units: Units::Si,
            time_unit: TimeUnit::Second,
            domain,
            duration,
            materials: vec![Material {
                name: "soil".into(),
                density: 1.0,
                frozen: phase,
                unfrozen: phase,
                freezing_point: 0.0,
                latent_heat: 1.0,
                law: FreezingLaw::Isothermal,
                mixing: Mixing::Arithmetic,
                pores: None,
            }],
            regions: Vec::new(),
            cracks: Vec::new(),
            initial_temperature: 5.0,
            walls: vec![Wall { name: "left", condition: Condition::Temperature(Series::Constant(-20.0)) }],
            wall_parts: Vec::new(),
            rings: Vec::new(),
            excavation: None,
            flow: None,
            stream: None,
            watch: Watch {
                outputs: 10,
                profiles: Vec::new(),
                probes: Vec::new(),
                surfaces: Vec::new(),
                cuts: Vec::new(),
                phases: None,
                corner_front: false,
                frozen_wall: false,
                profile_length: None,
                front_from: None,
            },
            reference: ReferenceChoice::Auto,
            methods: Vec::new(),
            hash: String::new(),
            remarks: Vec::new(),
        }
    }

    fn ring_scene() -> Scene {
        let mut scene = scene(Domain::Ring { outer_radius: 15.0, sector: Sector::Quarter }, 100.0 * DAY);
        scene.rings.push(PipeRing {
            count: 26,
            ring_radius: 5.0,
            first_angle: 0.0,
            moved: Vec::new(),
            one_particle: false,
            film: None,
            missing: Vec::new(),
            pipe_radius: 0.05,
            temperature: Series::Constant(-20.0),
            schedule: None,
        });
        scene
    }

    fn empty_result() -> RunResult {
        RunResult::bare(Record {
            frazil_version: String::new(),
            scene: String::new(),
            title: String::new(),
            scene_hash: String::new(),
            method: String::new(),
            settings: BTreeMap::new(),
            units: "si".into(),
            particles: 0,
            pairs: 0,
            steps: 0,
            pair_evaluations: 0,
            particle_updates: 0,
            work: Default::default(),
            step_s: 0.0,
            step_bound_s: 0.0,
            step_limit: String::new(),
            threads: 1,
            seed: 1,
            setup_wall_s: 0.0,
            setup_cpu_s: 0.0,
            solve_wall_s: 0.0,
            solve_cpu_s: 0.0,
            observation_wall_s: 0.0,
            observation_cpu_s: 0.0,
            peak_memory_bytes: None,
            outcome: Outcome::Ok,
            cause: None,
            energy_balance_rel: 0.0,
            bounds_violation_rel: None,
            setback_rel: None,
            errors: Errors::default(),
            reference: None,
            reduced_from: None,
            water: None,
            wall: None,
            stream: None,
            spared: Vec::new(),
            differences: Vec::new(),
            remarks: Vec::new(),
            state_hash: String::new(),
        })
    }

    fn profile(plane: &str, along_m: f64, temperature_c: f64) -> ProfileRow {
        let plane = plane.into();
        ProfileRow {
            time_s: 1.0,
            x_m: Some(along_m),
            temperature_c,
            temperature_ref_c: None,
            frozen_fraction: 0.0,
            plane,
            y_m: None,
            along_m,
            mean_over: None,
        }
    }

    fn front(time_s: f64, front_m: f64) -> FrontRow {
        FrontRow { time_s, front_m, front_ref_m: None }
    }

    fn gap(gap: usize, multiplicity: usize, days: Option<f64>) -> GapRow {
        let closure_s = days.map(|days| days * DAY);
        GapRow {
            gap,
            from: String::new(),
            to: String::new(),
            angle_deg: 0.0,
            multiplicity,
            closure_s,
            closure_ref_s: None,
        }
    }

    fn close(own: Option<f64>, expected: f64) {
        assert!(own.is_some_and(|own| (own - expected).abs() < 1e-12), "{own:?} against {expected}");
    }

    #[test]
    fn temperatures_are_relative_to_the_range_of_the_data() {
        let mut scene = scene(Domain::Line { length: 3.0 }, 1.0);
        let mut result = empty_result();
        result.profiles = vec![profile("line", 0.0, -20.0), profile("line", 1.0, -7.0), profile("line", 2.0, -4.0)];
        let found = errors(&scene, 0.1, &result, &Truth);
        // Errors 0, 3 and -4 over a range of 25; the greatest magnitude of the truth is 20.
        close(found.temperature_rms_rel, (25.0_f64 / 3.0).sqrt() / 25.0);
        close(found.temperature_rms_over_max_abs, (25.0_f64 / 3.0).sqrt() / 20.0);
        close(found.temperature_max_rel, 4.0 / 25.0);
        scene.watch.profile_length = Some(1.5);
        close(errors(&scene, 0.1, &result, &Truth).temperature_max_rel, 3.0 / 25.0);
    }

    #[test]
    fn a_diverged_run_has_no_errors_rather_than_nonsense() {
        let scene = scene(Domain::Line { length: 3.0 }, 4.0);
        let mut result = empty_result();
        result.profiles = vec![profile("line", 0.0, f64::NAN)];
        result.front = vec![front(4.0, f64::INFINITY)];
        assert_eq!(errors(&scene, 0.1, &result, &Truth), Errors::default());
        assert_eq!(errors(&scene, 0.1, &empty_result(), &Truth), Errors::default());
    }

    #[test]
    fn points_beside_a_pipe_do_not_count() {
        let scene = ring_scene();
        let mut result = empty_result();
        // 0.2 m of smear and 0.05 m of pipe: 4.8 m is inside, 4.7 m outside. Nothing is left out between pipes.
        result.profiles = vec![profile("main", 4.8, 100.0), profile("main", 4.7, 4.7 + 2.5)];
        close(errors(&scene, 0.1, &result, &Truth).temperature_max_rel, 0.1);
        result.profiles.push(profile("interface", 5.0, 10.0 + 5.0));
        close(errors(&scene, 0.1, &result, &Truth).temperature_max_rel, 0.2);
        result.profiles.push(profile("elsewhere", 5.0, 1e9));
        close(errors(&scene, 0.1, &result, &Truth).temperature_max_rel, 0.2);
    }

    #[test]
    fn the_front_is_judged_inside_its_window() {
        let mut scene = scene(Domain::Line { length: 3.0 }, 16.0);
        scene.watch.front_from = Some(4.0);
        let mut result = empty_result();
        result.front = vec![front(1.0, 9.9), front(4.0, 0.2 * 1.03), front(9.0, 0.3), front(16.0, 0.4 * 0.96)];
        let found = errors(&scene, 0.1, &result, &Truth);
        close(found.front_rms_rel, (0.0025_f64 / 3.0).sqrt());
        close(found.front_last_rel, -0.04);
        let moment = 4.0 * 4.0 * 1.03 * 1.03 + 9.0 * 9.0 + 16.0 * 16.0 * 0.96 * 0.96;
        close(found.front_constant_rel, (moment / (16.0_f64 + 81.0 + 256.0)).sqrt() - 1.0);
        result.front.pop();
        assert_eq!(errors(&scene, 0.1, &result, &Truth).front_last_rel, None, "the run did not end");
    }

    #[test]
    fn a_front_constant_needs_a_front_that_has_one() {
        let scene = scene(Domain::Line { length: 3.0 }, 16.0);
        let mut result = empty_result();
        result.front = [4.0, 9.0, 16.0].map(|t: f64| front(t, 1.01 * Slowing.front(t).unwrap_or(0.0))).to_vec();
        let found = errors(&scene, 0.1, &result, &Slowing);
        close(found.front_rms_rel, 0.01);
        assert_eq!(found.front_constant_rel, None);
    }

    #[test]
    fn a_ring_is_judged_by_volume_thickness_and_closure() {
        let scene = ring_scene();
        let mut result = empty_result();
        let wall = |day: f64, area: f64, main: f64, interface: f64| WallRow {
            time_s: day * DAY,
            thickness_main_mean_m: main,
            thickness_main_mean_ref_m: None,
            thickness_interface_mean_m: interface,
            thickness_interface_mean_ref_m: None,
            frozen_area_m2: area,
            frozen_area_ref_m2: None,
            heat_per_pipe_w_per_m: 0.0,
            closed: None,
            thickness_weakest_m: None,
        };
        // Half a day does not count at all, eleven days not for thickness.
        result.walls =
            vec![wall(0.5, 99.0, 99.0, 99.0), wall(11.0, 11.0 * 1.03, 99.0, 99.0), wall(20.0, 20.0 * 0.96, 2.2, 9.0)];
        result.gaps = vec![gap(0, 1, Some(9.0)), gap(1, 2, Some(10.0)), gap(2, 1, Some(13.0))];
        let found = errors(&scene, 0.1, &result, &Truth);
        close(found.frozen_volume_rms_rel, (0.0025_f64 / 2.0).sqrt());
        close(found.thickness_main_rms_rel, 0.1);
        close(found.thickness_interface_rms_rel, 0.1);
        close(found.events.get("closure_day").copied(), 0.05);
        close(found.events.get("closure_day_first").copied(), -0.1);
        close(found.events.get("closure_day_last").copied(), 0.3);
        result.gaps[2].closure_s = None;
        let open = errors(&scene, 0.1, &result, &Truth).events;
        assert_eq!(open.keys().collect::<Vec<_>>(), ["closure_day_first"]);
        assert!(errors(&scene, 0.1, &result, &Slowing).events.is_empty());
    }

    #[test]
    fn attaching_fills_the_columns_of_the_reference() {
        let scene = ring_scene();
        let mut result = empty_result();
        result.front = vec![front(4.0, 0.2)];
        result.profiles = vec![profile("main", 4.0, 4.0), profile("elsewhere", 1.0, 1.0)];
        result.gaps = vec![gap(0, 26, None)];
        attach(&scene, 0.1, &mut result, &Truth);
        assert_eq!(result.front[0].front_ref_m, Some(0.2));
        assert_eq!(result.profiles[0].temperature_ref_c, Some(4.0));
        assert_eq!(result.profiles[1].temperature_ref_c, None);
        assert_eq!(result.gaps[0].closure_ref_s, Some(10.0 * DAY));
        assert_eq!(result.record.reference.as_ref().map(|info| info.kind.as_str()), Some("exact"));
        assert_eq!(result.record.errors.temperature_rms_rel, Some(0.0));
        assert_eq!(result.record.errors.events.len(), 0);
    }
}
