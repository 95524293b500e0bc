//! Reference tables of shafts with one circle of freeze pipes, and how a scene differs from one.

use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_record::ReferenceInfo;
use frazil_scene::{PipeRing, Scene};
use frazil_simulation::reference::{Plane, Reference};

use crate::BadTable;
use crate::layouts::{LENGTH_ERROR, TEMPERATURE_ERROR};
use crate::soils::{CLAY, CLAY_TENTH, SAND, Soil};
use crate::table::{NumberTable, compare, interpolate, interpolate_square, note, wall_temperature};

const DAY: f64 = 86_400.0;

/// One shaft for which there is a table.
pub struct ShaftCase {
    /// Name of the table.
    pub name: &'static str,
    soil: &'static Soil,
    /// Radius of a pipe (m).
    pipe_radius: f64,
    days: &'static str,
    profiles: &'static str,
    /// Time (d) at which neighbouring frozen columns first touch, anywhere between them.
    closure: f64,
    /// Its estimated error (d).
    closure_error: f64,
    /// Time (d) at which the middle of the gap on the pipe circle is frozen.
    closure_at_ring_radius: f64,
}

/// Pipes on the circle of every shaft.
pub(crate) const PIPES: usize = 26;
/// Radius of that circle (m).
pub(crate) const RING_RADIUS: f64 = 5.0;
/// Temperature of the pipes and of the ground at the start.
const SHAFT_TEMPERATURES: (f64, f64) = (-20.0, 15.0);
/// Outer radius (m) beyond which it has no influence within 120 days: fronts at 120 days agree to 1 cm from
/// 12 to 20 m; the tables have 15 m.
const LEAST_OUTER_RADIUS: f64 = 12.0;

/// A shaft in a soil with pipes of a radius, when its gaps close, that day's error, and when they do on the pipe circle.
macro_rules! shaft {
    ($name:literal, $soil:ident, $pipe_radius:literal, $closure:literal, $closure_error:literal, $on_circle:literal) => {
        ShaftCase {
            name: $name,
            soil: &$soil,
            pipe_radius: $pipe_radius,
            days: include_str!(concat!("tables/", $name, "-days.csv")),
            profiles: include_str!(concat!("tables/", $name, "-profiles.csv")),
            closure: $closure,
            closure_error: $closure_error,
            closure_at_ring_radius: $on_circle,
        }
    };
}

/// All shafts.
pub const SHAFT_CASES: [ShaftCase; 4] = [
    shaft!("shaft-single-sand-54mm", SAND, 0.054, 15.398, 0.031, 15.472),
    shaft!("shaft-single-clay10-54mm", CLAY_TENTH, 0.054, 19.300, 0.039, 19.438),
    shaft!("shaft-single-clay-54mm", CLAY, 0.054, 122.449, 0.245, 123.199),
    shaft!("shaft-single-sand-6.38mm", SAND, 0.00638, 39.750, 0.151, 40.046),
];

impl ShaftCase {
    /// What about a scene is not as in the table.
    pub(crate) fn differences(&self, scene: &Scene) -> Vec<String> {
        shaft_differences(self.soil, &[(PIPES, RING_RADIUS, 0.0)], Some(self.pipe_radius), false, scene)
    }
}

/// What about a scene is not as in shafts with these rings: number of pipes, radius (m) and first angle (degrees) of each,
/// the angles from that of the first ring; pipes of a radius (m), or of any; whether water flows across them.
pub(crate) fn shaft_differences(
    soil: &Soil,
    rings: &[(usize, f64, f64)],
    pipe_radius: Option<f64>,
    is_crossed: bool,
    scene: &Scene,
) -> Vec<String> {
    let mut differences = soil.differences(scene);
    let Domain::Ring { outer_radius, .. } = scene.domain else {
        differences.push("the domain is a ring there".into());
        return differences;
    };
    if outer_radius < LEAST_OUTER_RADIUS {
        differences.push(format!("the outer radius is 15 there and {outer_radius} here"));
    }
    let is_any = |of: fn(&PipeRing) -> bool| scene.rings.iter().any(of);
    let found = [
        (!scene.cracks.is_empty(), "there are no cracks there"),
        (!scene.impermeable.is_empty(), "no part is impermeable there"),
        (scene.excavation.is_some(), "there is no excavation there"),
        (is_any(|ring| ring.schedule.is_some()), "the pipes always work there"),
        (is_any(|ring| ring.condition.film().is_some()), "the pipes' walls have the temperature given there"),
        (is_any(|ring| !ring.is_even()), "all pipes are at their design positions there"),
    ];
    note(&mut differences, &found);
    let mut number = |what: &str, own: Option<f64>, expected: f64| compare(&mut differences, what, own, expected);
    number("the number of pipe circles", Some(scene.rings.len() as f64), rings.len() as f64);
    let (pipe_temperature, initial) = SHAFT_TEMPERATURES;
    for (place, (count, radius, angle)) in rings.iter().enumerate() {
        let ring = scene.rings.get(place);
        let of =
            |what: &str| if rings.len() > 1 { format!("{what} of pipe circle {}", place + 1) } else { what.into() };
        number(&of("the number of pipes"), ring.map(|ring| ring.count as f64), *count as f64);
        number(&of("the radius of the pipe circle"), ring.map(|ring| ring.ring_radius), *radius);
        if let Some(pipe_radius) = pipe_radius {
            number(&of("the pipe radius"), ring.map(|ring| ring.pipe_radius), pipe_radius);
        }
        let temperature = ring.and_then(|ring| ring.condition.temperature()?.constant());
        number(&of("the pipe temperature"), temperature, pipe_temperature);
        if let Some((ring, first)) = ring.zip(scene.rings.first()).filter(|_| place > 0) {
            // The same pipes may be counted from another one, of either ring.
            let (own, spacing) = ((ring.first_angle - first.first_angle).to_degrees(), 360.0 / *count as f64);
            let turns = ((own - angle) / spacing).round();
            number(&of("the first angle (degrees)"), Some(own - turns * spacing), *angle);
        }
    }
    number("the initial temperature", Some(scene.initial_temperature), initial);
    number("the temperature of the outer wall", wall_temperature(scene, WallId::Outer), initial);
    if scene.flow.is_some() != is_crossed {
        differences.push(if is_crossed { "water flows across the ring there" } else { "no water flows there" }.into());
    }
    differences
}

/// The frozen wall around a shaft with one circle of freeze pipes.
///
/// Frozen lengths and areas count the pipes as frozen ground, as a method does that immerses its pipes in it.
#[derive(Debug, Clone)]
pub struct ShaftTable {
    source: String,
    closure: f64,
    closure_error: f64,
    closure_at_ring_radius: f64,
    /// Times of the rows (s).
    times: Vec<f64>,
    thickness_main: Vec<f64>,
    thickness_interface: Vec<f64>,
    /// Frozen area of the whole ring (m2).
    areas: Vec<f64>,
    /// Heat taken by one pipe (W/m).
    heat: Vec<f64>,
    /// Radii of the profiles (m).
    radii: Vec<f64>,
    /// Time (s), plane and temperatures of each profile.
    profiles: Vec<(f64, Plane, Vec<f64>)>,
}

impl ShaftTable {
    /// The shipped table of a case.
    ///
    /// # Errors
    ///
    /// If it cannot be read.
    pub fn bundled(case: &ShaftCase) -> Result<Self, BadTable> {
        let days = NumberTable::read(case.days)?;
        let seconds = |days: f64| days * DAY;
        let times = days.column("time_day")?.iter().copied().map(seconds).collect();
        let pipes = PIPES as f64 * std::f64::consts::PI * case.pipe_radius * case.pipe_radius;
        // A wedge is half a pipe spacing.
        let whole = |wedge: &f64| 2.0 * PIPES as f64 * wedge + pipes;
        let table = NumberTable::read(case.profiles)?;
        let mut profiles = Vec::new();
        for name in table.names().iter().filter(|name| *name != "r_m") {
            let unnamed = |what| BadTable::Unnamed { column: name.clone(), what };
            let (plane, day) = name.split_once('_').ok_or_else(|| unnamed("day"))?;
            let plane = match plane {
                "main" => Plane::Main,
                "interface" => Plane::Interface,
                _ => return Err(unnamed("plane")),
            };
            let day: f64 = day.parse().map_err(|_| unnamed("day"))?;
            profiles.push((seconds(day), plane, table.column(name)?.to_vec()));
        }
        Ok(ShaftTable {
            source: format!(
                "table {}: finite volumes on a mesh fitted to the pipes; closure known to {} d, thickness to \
                 {LENGTH_ERROR} m, temperature to {TEMPERATURE_ERROR} K",
                case.name, case.closure_error
            ),
            closure: seconds(case.closure),
            closure_error: seconds(case.closure_error),
            closure_at_ring_radius: seconds(case.closure_at_ring_radius),
            times,
            thickness_main: days.column("thickness_main_m")?.to_vec(),
            thickness_interface: days.column("thickness_interface_m")?.to_vec(),
            areas: days.column("wedge_area_m2")?.iter().map(whole).collect(),
            heat: days.column("heat_per_pipe_w_per_m")?.to_vec(),
            radii: table.column("r_m")?.to_vec(),
            profiles,
        })
    }

    /// Heat taken by one pipe (W/m) at time `t` (s).
    pub fn heat_per_pipe(&self, t: f64) -> Option<f64> {
        if self.is_known(t) { interpolate(&self.times, &self.heat, t) } else { None }
    }

    /// Rows stand a day apart, too far to interpolate between the first instant and the first day.
    fn is_known(&self, t: f64) -> bool {
        t >= self.times[1]
    }
}

impl Reference for ShaftTable {
    fn describe(&self) -> ReferenceInfo {
        let closure = self.closure_error / self.closure;
        let (pipe, ground) = SHAFT_TEMPERATURES;
        // Lengths are judged from some time after closure on, so what they are relative to is the wall between pipes then.
        let last = self.times.last().copied().unwrap_or(self.closure);
        let judged = self.times.iter().filter(|time| **time >= 1.25 * self.closure);
        let shares: Vec<f64> = judged
            .filter_map(|time| {
                Some(LENGTH_ERROR / self.thickness(Plane::Interface, *time).filter(|length| *length > 0.0)?)
            })
            .collect();
        let thickness = match shares.len() {
            0 => LENGTH_ERROR / self.thickness(Plane::Main, last).unwrap_or(f64::INFINITY),
            count => (shares.iter().map(|share| share * share).sum::<f64>() / count as f64).sqrt(),
        };
        let errors = [
            ("closure", closure),
            ("temperature", TEMPERATURE_ERROR / (ground - pipe)),
            ("thickness", thickness),
            // An area is a sum of lengths.
            ("volume", thickness),
        ];
        ReferenceInfo {
            errors: errors.map(|(measure, error)| (measure.to_owned(), error)).into(),
            ..ReferenceInfo::new("table", self.source.clone(), closure)
        }
    }

    /// Known at the instants of the profiles alone.
    fn plane_temperature(&self, plane: Plane, r: f64, t: f64) -> Option<f64> {
        let same_time = |time: f64| (time - t).abs() < 1e-9 * t;
        let profile = self.profiles.iter().find(|(time, own, _)| *own == plane && same_time(*time))?;
        interpolate(&self.radii, &profile.2, r)
    }

    fn frozen_volume(&self, t: f64) -> Option<f64> {
        if self.is_known(t) { interpolate(&self.times, &self.areas, t) } else { None }
    }

    fn thickness(&self, plane: Plane, t: f64) -> Option<f64> {
        if !self.is_known(t) {
            return None;
        }
        match plane {
            Plane::Main => interpolate_square(&self.times, &self.thickness_main, t),
            Plane::Interface if t <= self.closure => Some(0.0),
            Plane::Interface => {
                let first = self.times.partition_point(|&time| time <= self.closure);
                let times: Vec<f64> =
                    std::iter::once(self.closure).chain(self.times[first..].iter().copied()).collect();
                let lengths: Vec<f64> =
                    std::iter::once(0.0).chain(self.thickness_interface[first..].iter().copied()).collect();
                interpolate_square(&times, &lengths, t)
            }
        }
    }

    fn event(&self, name: &str) -> Option<f64> {
        match name {
            "closure_day" => Some(self.closure),
            "closure_at_ring_radius" => Some(self.closure_at_ring_radius),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shaft(name: &str) -> ShaftTable {
        let case = SHAFT_CASES.iter().find(|case| case.name == name).expect("case");
        ShaftTable::bundled(case).expect("table")
    }

    #[test]
    fn every_table_reads() {
        for case in &SHAFT_CASES {
            let table = ShaftTable::bundled(case).unwrap_or_else(|error| unreachable!("{}: {error}", case.name));
            assert!(table.times.is_sorted() && table.radii.is_sorted());
            assert!(table.profiles.iter().all(|profile| profile.2.len() == table.radii.len()));
            let values = table.areas.iter().chain(&table.thickness_main).chain(&table.heat);
            assert!(values.chain(&table.thickness_interface).all(|value| value.is_finite()));
        }
    }

    #[test]
    fn closure_stands_in_the_comments_too() {
        for case in &SHAFT_CASES {
            let line = format!("two pipes {:.3}, on the pipe circle {:.3}.", case.closure, case.closure_at_ring_radius);
            assert!(case.days.contains(&line), "{}: {line}", case.name);
            assert!(case.days.contains(&format!("closure {:.3} d", case.closure_error)), "{}", case.name);
        }
    }

    #[test]
    fn a_shaft_answers_with_its_rows() {
        let table = shaft("shaft-single-sand-54mm");
        assert_eq!(table.event("closure_day"), Some(15.398 * DAY));
        let wedge = 1.62138;
        let expected = 52.0 * wedge + 26.0 * std::f64::consts::PI * 0.054 * 0.054;
        assert!((table.frozen_volume(78.0 * DAY).expect("area") - expected).abs() < 1e-9);
        let thickness = table.thickness(Plane::Interface, 78.0 * DAY).expect("thickness");
        assert!((thickness - 2.78807).abs() < 1e-12);
        assert_eq!(table.thickness(Plane::Interface, 15.3 * DAY), Some(0.0));
        assert!((table.heat_per_pipe(78.0 * DAY).expect("heat") - 68.3397).abs() < 1e-9);
        let value = |r: f64| table.plane_temperature(Plane::Interface, r, 60.0 * DAY);
        assert!((value(5.0).expect("temperature") + 10.494).abs() < 1e-12);
        assert!((value(4.825).expect("temperature") + 10.44825).abs() < 1e-3);
        assert_eq!(table.plane_temperature(Plane::Main, 5.0, 61.0 * DAY), None);
        assert_eq!(table.plane_temperature(Plane::Main, 16.0, 60.0 * DAY), None);
        assert_eq!(table.frozen_volume(0.5 * DAY), None);
        assert_eq!(table.frozen_volume(121.0 * DAY), None);
    }

    #[test]
    fn thickness_between_rows_is_smooth_after_closure() {
        let table = shaft("shaft-single-sand-54mm");
        let thickness = |day: f64| table.thickness(Plane::Interface, day * DAY).expect("thickness");
        // Just after closure the wall grows with the root of time: without that its first half day is 40 % low.
        assert!(thickness(15.7) > 0.18 && thickness(15.7) < 0.22, "{}", thickness(15.7));
        assert!((thickness(16.5) - 0.5 * (0.280_223 + 0.450_953)).abs() < 0.02);
    }
}
