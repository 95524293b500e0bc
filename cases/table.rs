//! Reference tables shipped with the program, and the scenes that they belong to.

use frazil_core::boundary::condition::Condition;
use frazil_core::physics::material::{FreezingLaw, Material};
use frazil_core::space::domain::Domain;
use frazil_record::ReferenceInfo;
use frazil_scene::{PipeRing, Scene, Units};
use frazil_simulation::reference::{Plane, Reference};

use crate::exact::constant;
use crate::layouts::{LENGTH_ERROR, TEMPERATURE_ERROR};
use crate::{corner, seepage, shells};

const DAY: f64 = 86_400.0;

/// Relative agreement of a scene's numbers with those of a table for the table to be about that scene.
const SAME: f64 = 1e-3;

/// Names of the tables of columns and shafts, as a scene file asks for them.
pub const NAMES: [&str; 5] = [
    "soil-column",
    "shaft-single-sand-54mm",
    "shaft-single-clay10-54mm",
    "shaft-single-clay-54mm",
    "shaft-single-sand-6.38mm",
];

/// Names of all tables, those of shells and of seepage included.
pub fn names() -> impl Iterator<Item = &'static str> {
    NAMES.into_iter().chain(shells::names()).chain([seepage::NAME, corner::NAME])
}

/// Why a table is not the reference of a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Unfit {
    /// It is about another problem, in words.
    Another(String),
    /// There is none of this name, or it cannot be read.
    Broken(String),
}

impl From<String> for Unfit {
    fn from(reason: String) -> Self {
        Unfit::Broken(reason)
    }
}

/// The table of the given name, if it is about the physics of the scene; else the reason.
pub fn by_name(name: &str, scene: &Scene) -> Result<Box<dyn Reference>, Unfit> {
    let other = |differences: Vec<String>| {
        Unfit::Another(format!("the table '{name}' is about another problem: {}", differences.join("; ")))
    };
    let about = |differences: Vec<String>| if differences.is_empty() { Ok(()) } else { Err(other(differences)) };
    if name == seepage::NAME {
        about(seepage::differences(scene))?;
        return Ok(Box::new(seepage::Inclusion::of_law(scene.materials[0].mixing)?));
    }
    if name == corner::NAME {
        return Ok(Box::new(corner::Corner::of_scene(scene).map_err(other)?));
    }
    if name == "soil-column" {
        about(column_differences(scene))?;
        return Ok(Box::new(ColumnTable::bundled()?));
    }
    if let Some(found) = shells::by_name(name, scene) {
        return found.map_err(other);
    }
    let case = SHAFT_CASES.iter().find(|case| case.name == name).ok_or_else(|| {
        let all: Vec<&str> = names().collect();
        format!("there is no reference table '{name}'; the tables are {}", all.join(", "))
    })?;
    about(case.differences(scene))?;
    Ok(Box::new(ShaftTable::bundled(case)?))
}

/// Columns of numbers under a line of names; lines that start with `#` are comments.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

impl Table {
    /// Reads comma-separated text.
    pub fn read(text: &str) -> Result<Self, String> {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
        let headers = reader.headers().map_err(|error| error.to_string())?;
        let names: Vec<String> = headers.iter().map(str::to_owned).collect();
        let mut columns = vec![Vec::new(); names.len()];
        for row in reader.records() {
            let row = row.map_err(|error| error.to_string())?;
            for ((column, name), field) in columns.iter_mut().zip(&names).zip(&row) {
                column.push(field.parse().map_err(|_| format!("column {name}: '{field}' is not a number"))?);
            }
        }
        if columns.first().is_none_or(Vec::is_empty) {
            return Err("the table has no rows".into());
        }
        Ok(Table { names, columns })
    }

    /// The numbers of a column.
    pub fn column(&self, name: &str) -> Result<&[f64], String> {
        let index = self.names.iter().position(|own| own == name);
        index.map(|index| self.columns[index].as_slice()).ok_or_else(|| format!("the table has no column {name}"))
    }

    /// Names of the columns, in order.
    pub fn names(&self) -> &[String] {
        &self.names
    }
}

/// Piecewise linear interpolation; `None` outside the range of `x`, which must increase.
pub(crate) fn interpolate(x: &[f64], y: &[f64], at: f64) -> Option<f64> {
    let after = x.partition_point(|&node| node <= at);
    if after == 0 {
        return None;
    }
    if after == x.len() {
        return (x[after - 1] == at).then(|| y[after - 1]);
    }
    let share = (at - x[after - 1]) / (x[after] - x[after - 1]);
    Some(y[after - 1] + share * (y[after] - y[after - 1]))
}

/// Interpolation of the square, which is nearly linear for a frozen length that grows with the root of time.
fn interpolate_square(x: &[f64], y: &[f64], at: f64) -> Option<f64> {
    let squares: Vec<f64> = y.iter().map(|value| value * value).collect();
    interpolate(x, &squares, at).map(f64::sqrt)
}

/// A material by the numbers that a table depends on.
pub(crate) struct Soil {
    density: f64,
    frozen: (f64, f64),
    unfrozen: (f64, f64),
    freezing_point: f64,
    latent_heat: f64,
}

/// Sand of Chen and Bai 2016.
pub(crate) const SAND: Soil = Soil {
    density: 2090.0,
    frozen: (2.56, 1088.4),
    unfrozen: (1.86, 1465.1),
    freezing_point: 0.0,
    latent_heat: 52_875.8,
};

/// Clay of Chen and Bai 2016 with the latent heat as printed.
pub(crate) const CLAY: Soil = Soil {
    density: 2050.0,
    frozen: (2.05, 1172.1),
    unfrozen: (1.51, 1548.8),
    freezing_point: 0.0,
    latent_heat: 530_718.0,
};

/// The same clay with a tenth of the latent heat.
pub(crate) const CLAY_TENTH: Soil = Soil { latent_heat: 53_071.8, ..CLAY };

/// Soil of the column of Chen and Bai 2016.
const COLUMN: Soil = Soil {
    density: 1800.0,
    frozen: (2.68, 2508.5),
    unfrozen: (3.05, 2124.0),
    freezing_point: -0.25,
    latent_heat: 33_500.0,
};

/// Notes a number of the scene that is not the table's.
pub(crate) fn compare(differences: &mut Vec<String>, what: &str, own: Option<f64>, expected: f64) {
    let is_same = own.is_some_and(|own| (own - expected).abs() <= SAME * expected.abs().max(1e-9));
    if !is_same {
        let own = own.map_or("something else".into(), |own| own.to_string());
        differences.push(format!("{what} is {expected} there and {own} here"));
    }
}

impl Soil {
    fn differences(&self, scene: &Scene) -> Vec<String> {
        let mut differences = Vec::new();
        if scene.units != Units::Si {
            differences.push("units are si there".into());
        }
        let own: Option<&Material> = match scene.is_uniform() {
            true => scene.materials.first(),
            false => None,
        };
        let mut number = |what: &str, read: fn(&Material) -> f64, expected: f64| {
            compare(&mut differences, what, own.map(read), expected);
        };
        number("the density", |own| own.density, self.density);
        number("the frozen conductivity", |own| own.frozen.conductivity, self.frozen.0);
        number("the frozen heat capacity", |own| own.frozen.heat_capacity, self.frozen.1);
        number("the unfrozen conductivity", |own| own.unfrozen.conductivity, self.unfrozen.0);
        number("the unfrozen heat capacity", |own| own.unfrozen.heat_capacity, self.unfrozen.1);
        number("the freezing point", |own| own.freezing_point, self.freezing_point);
        number("the latent heat", |own| own.latent_heat, self.latent_heat);
        if own.is_some_and(|own| own.law != FreezingLaw::Isothermal) {
            differences.push("the soil freezes at one temperature there".into());
        }
        differences
    }
}

/// The constant temperature of a wall.
fn wall_temperature(scene: &Scene, name: &str) -> Option<f64> {
    match scene.wall(name) {
        Some(Condition::Temperature(series)) => constant(series),
        _ => None,
    }
}

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

/// All shafts.
pub const SHAFT_CASES: [ShaftCase; 4] = [
    ShaftCase {
        name: "shaft-single-sand-54mm",
        soil: &SAND,
        pipe_radius: 0.054,
        days: include_str!("tables/shaft-single-sand-54mm-days.csv"),
        profiles: include_str!("tables/shaft-single-sand-54mm-profiles.csv"),
        closure: 15.398,
        closure_error: 0.031,
        closure_at_ring_radius: 15.472,
    },
    ShaftCase {
        name: "shaft-single-clay10-54mm",
        soil: &CLAY_TENTH,
        pipe_radius: 0.054,
        days: include_str!("tables/shaft-single-clay10-54mm-days.csv"),
        profiles: include_str!("tables/shaft-single-clay10-54mm-profiles.csv"),
        closure: 19.300,
        closure_error: 0.039,
        closure_at_ring_radius: 19.438,
    },
    ShaftCase {
        name: "shaft-single-clay-54mm",
        soil: &CLAY,
        pipe_radius: 0.054,
        days: include_str!("tables/shaft-single-clay-54mm-days.csv"),
        profiles: include_str!("tables/shaft-single-clay-54mm-profiles.csv"),
        closure: 122.449,
        closure_error: 0.245,
        closure_at_ring_radius: 123.199,
    },
    ShaftCase {
        name: "shaft-single-sand-6.38mm",
        soil: &SAND,
        pipe_radius: 0.00638,
        days: include_str!("tables/shaft-single-sand-6.38mm-days.csv"),
        profiles: include_str!("tables/shaft-single-sand-6.38mm-profiles.csv"),
        closure: 39.750,
        closure_error: 0.151,
        closure_at_ring_radius: 40.046,
    },
];

impl ShaftCase {
    /// What about a scene is not as in the table.
    fn differences(&self, scene: &Scene) -> Vec<String> {
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
    if !scene.cracks.is_empty() {
        differences.push("there are no cracks there".into());
    }
    if scene.excavation.is_some() {
        differences.push("no shaft is dug there".into());
    }
    if scene.rings.iter().any(|ring| ring.schedule.is_some()) {
        differences.push("the pipes always work there".into());
    }
    if scene.rings.iter().any(|ring| ring.film.is_some()) {
        differences.push("the pipes' walls have the temperature given there".into());
    }
    if !scene.rings.iter().all(PipeRing::is_even) {
        differences.push("all pipes stand in their places there".into());
    }
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
        let temperature = ring.and_then(|ring| constant(&ring.temperature));
        number(&of("the pipe temperature"), temperature, pipe_temperature);
        if let Some((ring, first)) = ring.zip(scene.rings.first()).filter(|_| place > 0) {
            // The same pipes may be counted from another one, of either ring.
            let (own, spacing) = ((ring.first_angle - first.first_angle).to_degrees(), 360.0 / *count as f64);
            let turns = ((own - angle) / spacing).round();
            number(&of("the first angle (degrees)"), Some(own - turns * spacing), *angle);
        }
    }
    number("the initial temperature", Some(scene.initial_temperature), initial);
    number("the temperature of the outer wall", wall_temperature(scene, "outer"), initial);
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
    pub fn bundled(case: &ShaftCase) -> Result<Self, String> {
        let days = Table::read(case.days)?;
        let seconds = |days: f64| days * DAY;
        let times = days.column("time_day")?.iter().copied().map(seconds).collect();
        let pipes = PIPES as f64 * std::f64::consts::PI * case.pipe_radius * case.pipe_radius;
        // A wedge is half a pipe spacing.
        let whole = |wedge: &f64| 2.0 * PIPES as f64 * wedge + pipes;
        let table = Table::read(case.profiles)?;
        let mut profiles = Vec::new();
        for name in table.names().iter().filter(|name| *name != "r_m") {
            let (plane, day) = name.split_once('_').ok_or_else(|| format!("column {name} names no day"))?;
            let plane = match plane {
                "main" => Plane::Main,
                "interface" => Plane::Interface,
                _ => return Err(format!("column {name} names no plane")),
            };
            let day: f64 = day.parse().map_err(|_| format!("column {name} names no day"))?;
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

/// The front in a column of soil that freezes from one end.
#[derive(Debug, Clone)]
pub struct ColumnTable {
    /// Times (s), from zero.
    times: Vec<f64>,
    fronts: Vec<f64>,
}

/// Largest error of a front in the column (m).
const COLUMN_ERROR: f64 = 1e-6;

impl ColumnTable {
    /// The shipped table.
    pub fn bundled() -> Result<Self, String> {
        let table = Table::read(include_str!("tables/soil-column.csv"))?;
        let from_start = |name: &str| Ok::<_, String>([&[0.0], table.column(name)?].concat());
        Ok(ColumnTable { times: from_start("time_s")?, fronts: from_start("front_m")? })
    }
}

impl Reference for ColumnTable {
    fn describe(&self) -> ReferenceInfo {
        let source = "table soil-column: sharp front, each phase on its own moving grid of finite volumes";
        ReferenceInfo::new("table", source, COLUMN_ERROR / self.fronts[1])
    }

    fn front(&self, t: f64) -> Option<f64> {
        interpolate_square(&self.times, &self.fronts, t)
    }
}

/// What about a scene is not as in the column.
fn column_differences(scene: &Scene) -> Vec<String> {
    let mut differences = COLUMN.differences(scene);
    if !scene.rings.is_empty() {
        differences.push("there are no freeze pipes there".into());
    }
    let ends: &[(&str, &str, f64)] = match scene.domain {
        Domain::Line { length } => &[("left", "right", length)],
        Domain::Rectangle { width, height } => &[("left", "right", width), ("bottom", "top", height)],
        Domain::Ring { .. } | Domain::Radial { .. } | Domain::Axial { .. } => &[],
    };
    let both = |&(first, second, length): &(&'static str, &'static str, f64)| {
        [(first, second, length), (second, first, length)]
    };
    let cold = ends.iter().flat_map(both).find(|end| wall_temperature(scene, end.0).is_some_and(|at| at < 0.0));
    let mut number = |what: &str, own: Option<f64>, expected: f64| compare(&mut differences, what, own, expected);
    number("the length", cold.map(|end| end.2), 0.2);
    number("the temperature of the cold end", cold.and_then(|end| wall_temperature(scene, end.0)), -5.0);
    number("the temperature of the other end", cold.and_then(|end| wall_temperature(scene, end.1)), 1.0);
    number("the initial temperature", Some(scene.initial_temperature), 1.0);
    if let Some((near, far, _)) = cold {
        let is_side = |name: &str| name != near && name != far;
        if scene.walls.iter().any(|wall| is_side(wall.name) && wall.condition != Condition::Symmetry) {
            differences.push("the sides are insulated there".into());
        }
    }
    differences
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::Neumann;
    use frazil_core::physics::material::{Mixing, Phase};

    fn shaft(name: &str) -> ShaftTable {
        let case = SHAFT_CASES.iter().find(|case| case.name == name).expect("case");
        ShaftTable::bundled(case).expect("table")
    }

    #[test]
    fn every_table_reads() {
        ColumnTable::bundled().expect("column");
        for case in &SHAFT_CASES {
            let table = ShaftTable::bundled(case).unwrap_or_else(|error| unreachable!("{}: {error}", case.name));
            assert!(NAMES.contains(&case.name));
            assert!(table.times.is_sorted() && table.radii.is_sorted());
            assert!(table.profiles.iter().all(|profile| profile.2.len() == table.radii.len()));
            let values = table.areas.iter().chain(&table.thickness_main).chain(&table.heat);
            assert!(values.chain(&table.thickness_interface).all(|value| value.is_finite()));
        }
        assert_eq!(NAMES.len(), SHAFT_CASES.len() + 1);
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

    #[test]
    fn the_column_starts_as_a_half_space() {
        let material = Material {
            name: "soil".into(),
            density: COLUMN.density,
            frozen: Phase { conductivity: COLUMN.frozen.0, heat_capacity: COLUMN.frozen.1 },
            unfrozen: Phase { conductivity: COLUMN.unfrozen.0, heat_capacity: COLUMN.unfrozen.1 },
            freezing_point: COLUMN.freezing_point,
            latent_heat: COLUMN.latent_heat,
            law: FreezingLaw::Isothermal,
            mixing: Mixing::Arithmetic,
            pores: None,
        };
        let exact = Neumann::new(&material, -5.0, 1.0).expect("front");
        let table = ColumnTable::bundled().expect("table");
        for t in [100.0, 450.0, 900.0, 1200.0, 1800.0] {
            let (own, expected) = (table.front(t).expect("front"), exact.front(t).expect("front"));
            // The other end is not felt yet, so what differs is the table's own error.
            assert!((own - expected).abs() < 2.0 * COLUMN_ERROR, "{t} s: {own} against {expected}");
        }
        assert_eq!(table.front(216_001.0), None);
    }

    #[test]
    fn a_bad_table_says_what_is_wrong() {
        assert!(Table::read("# a\nx,y\n1,two\n").is_err_and(|error| error.contains("'two'")));
        assert!(Table::read("x,y\n").is_err());
        let table = Table::read("# a\nx,y\n1,2\n").expect("table");
        assert!(table.column("z").is_err_and(|error| error.contains('z')));
    }
}
