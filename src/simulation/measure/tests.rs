//! Errors against references that are made up.

use frazil_core::boundary::condition::Condition;
use frazil_core::boundary::pipe::PipeCondition;
use frazil_core::physics::material::{FreezingLaw, Material, Mixing, Phase};
use frazil_core::series::Series;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::wall::WallId;
use frazil_record::{Outcome, ProfileRow, Record, ReferenceInfo};
use frazil_scene::{PipeRing, Wall};

use super::*;

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
        initial_temperature: 5.0,
        walls: vec![Wall { wall: WallId::Left, condition: Condition::Temperature(Series::Constant(-20.0)) }],
        ..Scene::bare(
            domain,
            duration,
            vec![Material {
                name: "soil".into(),
                density: 1.0,
                frozen: phase,
                unfrozen: phase,
                freezing_point: 0.0,
                latent_heat: 1.0,
                law: FreezingLaw::Isothermal,
                mixing: Mixing::Arithmetic,
                pores: None,
                soil: None,
            }],
        )
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
        missing: Vec::new(),
        pipe_radius: 0.05,
        condition: PipeCondition::Temperature(Series::Constant(-20.0)),
        schedule: None,
    });
    scene
}

fn empty_result() -> RunResult {
    RunResult::bare(Record { units: "si".into(), threads: 1, seed: 1, outcome: Outcome::Ok, ..Record::default() })
}

fn profile(plane: &str, along_m: f64, temperature_c: f64) -> ProfileRow {
    let plane = plane.into();
    ProfileRow {
        time_s: 1.0,
        x_m: Some(along_m),
        temperature_c,
        temperature_ref_c: None,
        frozen_fraction: 0.0,
        concentration: None,
        concentration_ref: None,
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
        angle_deg: Some(0.0),
        along_m: None,
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
        thickness_main_mean_m: Some(main),
        thickness_main_mean_ref_m: None,
        thickness_interface_mean_m: Some(interface),
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
