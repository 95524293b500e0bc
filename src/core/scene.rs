//! A scene: the physics of a run and nothing else, checked and in SI (or in the file's own dimensionless units).
//!
//! Temperatures are stored on the file's scale: degrees Celsius in SI scenes, the DPD or dimensionless
//! temperature elsewhere. [`Units::absolute_zero`] maps them to an absolute scale where a law needs one.

pub mod read;
pub mod settings;

use std::sync::Arc;

use crate::material::Material;

pub use read::{Duration, Key, Problem, Problems, Range, Section, read_section};
pub use settings::{
    Exchange, IntegratorChoice, Layout, Mean, Numerics, SearchChoice, Setting, StepChoice, Uptake, WallModel,
};

/// Units of a scene file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Units {
    /// SI: keys carry their unit (`spacing_m`, `duration_h`, `temperature_c`).
    Si,
    /// Units of dissipative particle dynamics (k_B = 1): keys carry no unit.
    Dpd,
    /// No dimensions at all: keys carry no unit.
    Dimensionless,
}

impl Units {
    /// The temperature of absolute zero on the scale of the scene.
    pub fn absolute_zero(self) -> f64 {
        match self {
            Units::Si => -273.15,
            Units::Dpd | Units::Dimensionless => 0.0,
        }
    }

    /// The word used in files and records.
    pub fn name(self) -> &'static str {
        match self {
            Units::Si => "si",
            Units::Dpd => "dpd",
            Units::Dimensionless => "dimensionless",
        }
    }
}

/// Unit in which people speak of the times of a scene; only figures and messages use it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds, or the scene's own dimensionless time.
    Second,
    /// Hours.
    Hour,
    /// Days.
    Day,
}

impl TimeUnit {
    /// Seconds in one unit.
    pub fn seconds(self) -> f64 {
        match self {
            TimeUnit::Second => 1.0,
            TimeUnit::Hour => 3600.0,
            TimeUnit::Day => 86400.0,
        }
    }

    /// Symbol for axis labels.
    pub fn symbol(self) -> &'static str {
        match self {
            TimeUnit::Second => "s",
            TimeUnit::Hour => "h",
            TimeUnit::Day => "d",
        }
    }
}

/// The body of ground or water that is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Domain {
    /// The interval `0 <= x <= length` (m); walls `left` and `right`.
    Line {
        /// Length (m).
        length: f64,
    },
    /// The box `0 <= x <= width`, `0 <= y <= height` (m); walls `left`, `right`, `bottom`, `top`.
    Rectangle {
        /// Extent in x (m).
        width: f64,
        /// Extent in y (m).
        height: f64,
    },
    /// The plan of a shaft: the disc of `outer_radius` around the origin, or the part of it that its mirror
    /// planes leave. Walls: `outer`; the mirror planes x = 0 and y = 0 need none.
    Ring {
        /// Radius of the outer wall (m).
        outer_radius: f64,
        /// How much of the disc is simulated.
        sector: Sector,
    },
}

impl Domain {
    /// Number of space dimensions.
    pub fn dimension(&self) -> usize {
        match self {
            Domain::Line { .. } => 1,
            Domain::Rectangle { .. } | Domain::Ring { .. } => 2,
        }
    }
}

/// Part of a ring. The mirror planes are the axes because these, and not the planes of a narrower sector, map
/// a square lattice onto itself: the mirror is exact to the last bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sector {
    /// x >= 0 and y >= 0; the scene is symmetric in both axes.
    Quarter,
    /// y >= 0; the scene is symmetric in the x axis.
    Half,
    /// The whole plan.
    Whole,
}

/// A quantity that is constant or given as a table in time (linear between rows, constant beyond them).
#[derive(Debug, Clone, PartialEq)]
pub enum Series {
    /// The same at all times.
    Constant(f64),
    /// Times (s, strictly increasing) and values.
    Table(Vec<(f64, f64)>),
    /// A table that repeats: linear from its last row to the first of the next period.
    Repeated {
        /// Times (s, strictly increasing, at most one period) and values.
        rows: Vec<(f64, f64)>,
        /// Length of one period (s).
        period: f64,
    },
}

impl Series {
    /// Value at time `t` (s).
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Series::Constant(value) => *value,
            Series::Table(rows) => {
                let after = rows.partition_point(|row| row.0 <= t);
                if after == 0 {
                    return rows[0].1;
                }
                if after == rows.len() {
                    return rows[after - 1].1;
                }
                between(rows[after - 1], rows[after], t)
            }
            Series::Repeated { rows, period } => {
                let t = t.rem_euclid(*period);
                let after = rows.partition_point(|row| row.0 <= t);
                let (first, last) = (rows[0], rows[rows.len() - 1]);
                if after == 0 {
                    between((last.0 - period, last.1), first, t)
                } else if after == rows.len() {
                    between(last, (first.0 + period, first.1), t)
                } else {
                    between(rows[after - 1], rows[after], t)
                }
            }
        }
    }

    /// The first instant after `t` (s) at which the series bends or jumps.
    pub fn next_bend(&self, t: f64) -> Option<f64> {
        match self {
            Series::Constant(_) => None,
            Series::Table(rows) => rows.get(rows.partition_point(|row| row.0 <= t)).map(|row| row.0),
            Series::Repeated { rows, period } => {
                let cycle = (t / period).floor();
                let instants = [cycle - 1.0, cycle, cycle + 1.0].into_iter();
                let instants = instants.flat_map(|cycle| rows.iter().map(move |row| cycle * period + row.0));
                instants.filter(|instant| *instant > t).reduce(f64::min)
            }
        }
    }

    /// Whether the value is not the same at all times.
    pub fn changes(&self) -> bool {
        let (least, greatest) = self.range();
        least != greatest
    }

    /// Least and greatest value over all times.
    pub fn range(&self) -> (f64, f64) {
        match self {
            Series::Constant(value) => (*value, *value),
            Series::Table(rows) | Series::Repeated { rows, .. } => {
                rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), row| (lo.min(row.1), hi.max(row.1)))
            }
        }
    }
}

/// The value at time `t` (s) on the straight line from one row to a later one.
fn between((t0, v0): (f64, f64), (t1, v1): (f64, f64), t: f64) -> f64 {
    if t1 <= t0 { v1 } else { v0 + (v1 - v0) * (t - t0) / (t1 - t0) }
}

/// When a ring of pipes works.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Intervals of work (s): from each first instant up to, but not including, the second. They do not overlap and
    /// stand in order; with a period, the last ends within it.
    pub on: Vec<(f64, f64)>,
    /// Length (s) after which the intervals repeat; they happen once if absent.
    pub period: Option<f64>,
}

impl Schedule {
    /// All intervals that touch the instants near `t`, repeated ones at their place in time.
    fn near(&self, t: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        // The same sum for a switch and for the question whether it is past: rounding cannot part them.
        let (first, last, period) = match self.period {
            Some(period) => ((t / period).floor() - 1.0, 2, period),
            None => (0.0, 0, 0.0),
        };
        (0..=last).flat_map(move |k| {
            let start = (first + f64::from(k)).max(0.0) * period;
            self.on.iter().map(move |(from, to)| (start + from, start + to))
        })
    }

    /// Whether the pipes work at time `t` (s).
    pub fn works(&self, t: f64) -> bool {
        self.near(t).any(|(from, to)| from <= t && t < to)
    }

    /// How many times the pipes are switched within a time (s), at most.
    pub fn switches(&self, duration: f64) -> f64 {
        2.0 * self.on.len() as f64 * self.period.map_or(1.0, |period| (duration / period).ceil())
    }

    /// The first instant after `t` (s) at which the pipes are switched.
    pub fn next_switch(&self, t: f64) -> Option<f64> {
        self.near(t)
            .flat_map(|(from, to)| [from, to])
            .filter(|instant| *instant > t && instant.is_finite())
            .reduce(f64::min)
    }
}

/// What happens at a wall.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// No heat crosses: a mirror plane.
    Symmetry,
    /// The wall has this temperature.
    Temperature(Series),
    /// This heat flux enters the body (W/m2; negative when it leaves).
    Flux(Series),
    /// The wall exchanges heat with surroundings at a temperature through a film coefficient.
    Convection {
        /// Film coefficient (W/m2K).
        coefficient: Series,
        /// Temperature of the surroundings.
        ambient: Series,
    },
    /// The wall has the temperature of the scene's exact solution at its position: a finite stand-in for an
    /// infinite body.
    Exact,
}

/// One named wall of the domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    /// `left`, `right`, `bottom`, `top` or `outer`.
    pub name: &'static str,
    /// What happens there.
    pub condition: Condition,
}

/// A freeze pipe: a cold circle of true radius at an exact position.
#[derive(Debug, Clone, PartialEq)]
pub struct Pipe {
    /// Centre (m).
    pub x: f64,
    /// Centre (m).
    pub y: f64,
    /// Outer radius of the pipe (m).
    pub radius: f64,
    /// Temperature of the pipe's outer wall while it works.
    pub temperature: Series,
    /// When it works; always if absent. No heat crosses its wall at other times.
    pub schedule: Option<Arc<Schedule>>,
}

/// A ring of evenly spaced pipes, from which pipes and gaps follow.
#[derive(Debug, Clone, PartialEq)]
pub struct PipeRing {
    /// Number of pipes on the full circle.
    pub count: usize,
    /// Radius of the circle (m).
    pub ring_radius: f64,
    /// Angle of the first pipe from the x axis (radians).
    pub first_angle: f64,
    /// Radius of one pipe (m).
    pub pipe_radius: f64,
    /// Temperature of the pipes' outer wall while they work.
    pub temperature: Series,
    /// When they work; always if absent. No heat crosses their walls at other times.
    pub schedule: Option<Arc<Schedule>>,
}

impl PipeRing {
    /// Angle of pipe `k` (radians).
    pub fn angle(&self, k: usize) -> f64 {
        self.first_angle + std::f64::consts::TAU * k as f64 / self.count as f64
    }

    /// Angle of the middle of the gap between pipe `k` and the next (radians).
    pub fn gap_angle(&self, k: usize) -> f64 {
        self.first_angle + std::f64::consts::TAU * (k as f64 + 0.5) / self.count as f64
    }

    /// The pipes themselves, in order of their angle.
    pub fn pipes(&self) -> Vec<Pipe> {
        (0..self.count)
            .map(|k| {
                let (sin, cos) = self.angle(k).sin_cos();
                Pipe {
                    x: self.ring_radius * cos,
                    y: self.ring_radius * sin,
                    radius: self.pipe_radius,
                    temperature: self.temperature.clone(),
                    schedule: self.schedule.clone(),
                }
            })
            .collect()
    }
}

/// A box of the domain that holds another material than the first one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Least x (m).
    pub x_min: f64,
    /// Greatest x (m).
    pub x_max: f64,
    /// Least y (m); minus infinity on a line.
    pub y_min: f64,
    /// Greatest y (m); infinity on a line.
    pub y_max: f64,
}

/// What is observed, and when.
#[derive(Debug, Clone, PartialEq)]
pub struct Watch {
    /// Number of evenly spaced output instants up to the end; the start is not one of them.
    pub outputs: usize,
    /// Instants (s) at which profiles are kept.
    pub profiles: Vec<f64>,
    /// Points (m) whose temperature is kept at every output.
    pub probes: Vec<(f64, f64)>,
    /// Profiles and their errors end at this distance (m) from the wall; the whole domain if absent.
    pub profile_length: Option<f64>,
    /// Start (s) of the window over which the front is judged.
    pub front_from: f64,
}

/// Where the truth about a scene comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ReferenceChoice {
    /// A closed form or a similarity solution, if the scene fits one.
    Exact,
    /// A table shipped with the program, by name.
    Table(String),
    /// The local method on finer lattices, accepted only if shown converged.
    Local,
    /// Whatever of the above fits first, in that order.
    Auto,
}

/// Where a plane front runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreezingDirection {
    /// Along y instead of x.
    pub along_y: bool,
    /// Length of the domain in that direction (m).
    pub length: f64,
    /// Extent across it (m); 1 on a line.
    pub across: f64,
    /// Whether distances count from the far wall (right or top).
    pub from_end: bool,
}

/// A whole checked scene.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Short name: the file's stem or the bundled name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Where the parameters come from.
    pub source: String,
    /// Units of all numbers below.
    pub units: Units,
    /// Unit for times in figures and messages.
    pub time_unit: TimeUnit,
    /// The body.
    pub domain: Domain,
    /// End of the run (s).
    pub duration: f64,
    /// Materials; the first fills the domain.
    pub materials: Vec<Material>,
    /// Boxes of other materials; later ones win.
    pub regions: Vec<Region>,
    /// Temperature everywhere at the start.
    pub initial_temperature: f64,
    /// The walls of the domain that are not mirror planes of a sector.
    pub walls: Vec<Wall>,
    /// Rings of freeze pipes.
    pub rings: Vec<PipeRing>,
    /// Observation.
    pub watch: Watch,
    /// Where the truth comes from.
    pub reference: ReferenceChoice,
    /// Numerical settings for each method that the file names, in the order of the registry.
    pub methods: Vec<settings::MethodSettings>,
    /// Hash of the effective file (after `--set`), as 16 hexadecimal digits.
    pub hash: String,
}

impl Scene {
    /// Least and greatest temperature that data of the scene name: start, walls, pipes.
    pub fn temperature_range(&self) -> (f64, f64) {
        let mut range = (self.initial_temperature, self.initial_temperature);
        let mut widen = |series: &Series| {
            let (lo, hi) = series.range();
            range = (range.0.min(lo), range.1.max(hi));
        };
        for wall in &self.walls {
            match &wall.condition {
                Condition::Temperature(series) => widen(series),
                Condition::Convection { ambient, .. } => widen(ambient),
                Condition::Symmetry | Condition::Flux(_) | Condition::Exact => {}
            }
        }
        for ring in &self.rings {
            widen(&ring.temperature);
        }
        range
    }

    /// The direction in which a plane front runs, if the scene has one: along a line, or along the one axis of a
    /// rectangle whose walls let heat through. It starts at the colder of the two walls.
    pub fn freezing_direction(&self) -> Option<FreezingDirection> {
        let closed = |name: &str| self.wall(name).is_none_or(|condition| *condition == Condition::Symmetry);
        let (along_y, length, across) = match self.domain {
            Domain::Line { length } => (false, length, 1.0),
            Domain::Rectangle { width, height } if closed("bottom") && closed("top") => (false, width, height),
            Domain::Rectangle { width, height } if closed("left") && closed("right") => (true, height, width),
            _ => return None,
        };
        let (near, far) = if along_y { ("bottom", "top") } else { ("left", "right") };
        // A wall that drives the front has a temperature of its own; the colder of two is the start.
        let drive = |name: &str| match self.wall(name) {
            Some(Condition::Temperature(series)) => (series.at(self.duration) - self.initial_temperature).abs(),
            Some(Condition::Convection { ambient, .. }) => (ambient.at(self.duration) - self.initial_temperature).abs(),
            Some(Condition::Flux(series)) => series.range().0.abs().max(series.range().1.abs()),
            _ => 0.0,
        };
        Some(FreezingDirection { along_y, length, across, from_end: drive(far) > drive(near) })
    }

    /// Whether a flux condition can drive temperatures beyond [`Scene::temperature_range`].
    pub fn has_flux(&self) -> bool {
        self.walls.iter().any(|wall| matches!(wall.condition, Condition::Flux(_)))
    }

    /// The first instant after `t` (s) at which pipes are switched: steps land on it.
    pub fn next_switch(&self, t: f64) -> Option<f64> {
        let schedules = self.rings.iter().filter_map(|ring| ring.schedule.as_ref());
        schedules.filter_map(|schedule| schedule.next_switch(t)).reduce(f64::min)
    }

    /// The first instant after `t` (s) at which the temperature, flux or film of a wall or the temperature of pipes bends
    /// or jumps: long steps land on it.
    pub fn next_bend(&self, t: f64) -> Option<f64> {
        let walls = self.walls.iter().flat_map(|wall| match &wall.condition {
            Condition::Temperature(series) | Condition::Flux(series) => [Some(series), None],
            Condition::Convection { coefficient, ambient } => [Some(coefficient), Some(ambient)],
            Condition::Symmetry | Condition::Exact => [None, None],
        });
        let rings = self.rings.iter().map(|ring| Some(&ring.temperature));
        walls.chain(rings).flatten().filter_map(|series| series.next_bend(t)).reduce(f64::min)
    }

    /// All pipes of all rings.
    pub fn pipes(&self) -> Vec<Pipe> {
        self.rings.iter().flat_map(PipeRing::pipes).collect()
    }

    /// The condition at a named wall.
    pub fn wall(&self, name: &str) -> Option<&Condition> {
        self.walls.iter().find(|wall| wall.name == name).map(|wall| &wall.condition)
    }

    /// The settings of a method, if the scene has them.
    pub fn method(&self, name: &str) -> Option<&settings::MethodSettings> {
        self.methods.iter().find(|method| method.method == name)
    }

    /// Index of the material at a point (m).
    pub fn material_at(&self, x: f64, y: f64) -> usize {
        self.regions
            .iter()
            .rev()
            .find(|region| x >= region.x_min && x < region.x_max && y >= region.y_min && y < region.y_max)
            .map_or(0, |region| region.material)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_table_is_linear_across_its_ends() {
        let series = Series::Repeated { rows: vec![(1.0, 10.0), (3.0, -10.0)], period: 4.0 };
        // From -10 at 3 to 10 at 5: zero at the turn of the period.
        for (time, value) in [(0.0, 0.0), (1.0, 10.0), (2.0, 0.0), (3.0, -10.0), (3.5, -5.0), (4.0, 0.0), (4.5, 5.0)] {
            for cycle in [0.0, 1.0, 1000.0] {
                assert_eq!(series.at(time + 4.0 * cycle), value, "{time} of cycle {cycle}");
            }
        }
        assert_eq!(series.range(), (-10.0, 10.0));
        let jump = Series::Repeated { rows: vec![(0.0, 0.0), (4.0, 8.0)], period: 4.0 };
        assert_eq!((jump.at(3.0), jump.at(4.0), jump.at(5.0)), (6.0, 0.0, 2.0));
        let constant = Series::Repeated { rows: vec![(1.0, 7.0)], period: 4.0 };
        assert!([0.0, 1.0, 3.9, 4.0, 17.3].iter().all(|time| constant.at(*time) == 7.0) && !constant.changes());
    }

    /// Thirds and tenths have no exact sum, but work begins and ends at the very instants that steps land on.
    #[test]
    fn pipes_work_from_switch_to_switch() {
        for period in [0.1, 1.0 / 3.0, 7200.0] {
            let schedule = Schedule { on: vec![(0.0, 0.2 * period), (0.5 * period, period)], period: Some(period) };
            let (mut time, mut worked, mut switches) = (0.0, 0.0, 0);
            while time < 1000.0 * period {
                let next = schedule.next_switch(time).expect("it repeats");
                assert!(next > time);
                let middle = schedule.works(0.5 * (time + next));
                // Where two switches round to neighbouring numbers there is no middle.
                if next - time > 1e-9 * period {
                    assert_eq!(schedule.works(time), middle, "{period} at {time}");
                    switches += 1;
                }
                worked += if middle { next - time } else { 0.0 };
                time = next;
            }
            // A thousand periods of three stretches, whose lengths sum to the rounding of the last instant.
            assert_eq!(switches, 3 * 1000, "{period}");
            assert!((worked / (700.0 * period) - 1.0).abs() < 1e-9, "{period}: {worked}");
        }
    }

    #[test]
    fn work_without_a_period_happens_once() {
        let late = Schedule { on: vec![(10.0, 20.0), (30.0, f64::INFINITY)], period: None };
        assert!(!late.works(9.9) && late.works(10.0) && !late.works(20.0) && late.works(1e9));
        assert_eq!(late.next_switch(0.0), Some(10.0));
        assert_eq!(late.next_switch(20.0), Some(30.0));
        assert_eq!(late.next_switch(30.0), None);
    }
}
