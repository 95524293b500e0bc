//! What a run says about a layout.

use frazil_core::space::domain::Domain;
use frazil_plots::layouts::between;
use frazil_record::{BudgetRow, GapRow, LinkRow, Outcome, PlaneRow, ProfileRow, Record, RunResult, WallRow};
use frazil_scene::Scene;
use frazil_simulation::observers::LOADS;
use serde::{Deserialize, Serialize};

use super::around::{Around, Line, Mapped, around};
use super::designed::{Weakest, designed};
use super::formula::SteadyRing;
use super::goals::Design;
use super::variants::working;

/// Seconds of a day.
pub const DAY: f64 = 86400.0;

/// What is kept of a run: all that tables and figures over layouts read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    /// The record.
    pub record: Record,
    /// Neighbouring pipes.
    pub links: Vec<LinkRow>,
    /// Sections of the wall.
    pub planes: Vec<PlaneRow>,
    /// The wall over time.
    pub walls: Vec<WallRow>,
    /// Profiles at the last instant.
    pub profiles: Vec<ProfileRow>,
    /// Heat balance.
    pub budget: Vec<BudgetRow>,
    /// Names of its columns.
    pub budget_names: Vec<String>,
    /// Gaps of the first ring, closed anywhere half-way between two pipes.
    pub gaps: Vec<GapRow>,
    /// Heat taken by all pipes in the mean over each day: its end (s), W/m.
    #[serde(default)]
    pub loads: Vec<(f64, f64)>,
    /// What its maps say of it, where it has maps.
    #[serde(default)]
    pub around: Vec<Around>,
    /// The axis plane at the last map: angles (degrees) and temperatures.
    #[serde(default)]
    pub axis: Line,
    /// The plane through the weakest gap at the last map: distances from the centre (m) and temperatures.
    #[serde(default)]
    pub weakest_plane: Line,
}

impl Kept {
    /// From a run of a scene.
    pub fn of(scene: &Scene, result: &RunResult) -> Kept {
        let last = result.profiles.iter().map(|row| row.time_s).fold(f64::NEG_INFINITY, f64::max);
        let weakest = weakest(&result.record, &result.links);
        let Mapped { around, axis, weakest_plane } = around(scene, result, weakest);
        let loads = result.tables.iter().find(|table| table.file == LOADS);
        let loads = loads.iter().flat_map(|table| &table.rows).filter_map(|row| Some((row[0]?, row[1]?)));
        Kept {
            loads: loads.collect(),
            around,
            axis,
            weakest_plane,
            record: result.record.clone(),
            links: result.links.clone(),
            planes: result.planes.clone(),
            walls: result.walls.clone(),
            profiles: result.profiles.iter().filter(|row| row.time_s == last).cloned().collect(),
            budget: result.budget.clone(),
            budget_names: result.budget_names.clone(),
            gaps: result.gaps.clone(),
        }
    }

    /// The run, as far as figures read it.
    pub fn run(&self) -> RunResult {
        RunResult {
            profiles: self.profiles.clone(),
            budget_names: self.budget_names.clone(),
            budget: self.budget.clone(),
            walls: self.walls.clone(),
            links: self.links.clone(),
            planes: self.planes.clone(),
            ..RunResult::bare(self.record.clone())
        }
    }
}

/// The wall at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Day {
    /// The instant (days).
    pub day: f64,
    /// Thickness on interface planes, mean over the ring (m); none where there are none.
    pub thickness_interface_mean_m: Option<f64>,
    /// Thickness on main planes, mean over the ring (m); none where there are none.
    pub thickness_main_mean_m: Option<f64>,
    /// Whether the wall stands closed.
    pub closed: bool,
    /// Thickness where the wall is weakest: frozen length on the least frozen way through it (m); 0 while it is open.
    pub thickness_weakest_m: f64,
    /// Mean temperature on that way; none while it is open.
    pub temperature_weakest_c: Option<f64>,
    /// Where the frozen ground on that way begins and ends (m from the centre).
    pub weakest_m: Option<(f64, f64)>,
    /// Inner and outer front on the interface plane between the first two pipes (m from the centre).
    pub interface_m: Option<(f64, f64)>,
    /// Inner and outer front on the main plane (m from the centre).
    pub main_m: Option<(f64, f64)>,
    /// Frozen area (m2), pipes counted.
    pub area_m2: f64,
    /// Mean temperature on the main plane.
    pub mean_main_c: Option<f64>,
    /// Mean temperature on the interface plane.
    pub mean_interface_c: Option<f64>,
    /// Mean temperature of all frozen ground.
    pub mean_c: Option<f64>,
    /// Mean temperature on the axis plane, where there is a map of this instant.
    pub mean_axis_c: Option<f64>,
    /// Heat taken by a pipe, mean over all (W/m).
    pub heat_per_pipe_w_per_m: f64,
    /// Heat taken by all pipes since the start (MJ by metre of depth).
    pub energy_mj_per_m: f64,
}

impl Day {
    /// Of a run of a scene, at a time (s) that it has outputs around.
    pub fn at(scene: &Scene, kept: &Kept, time: f64) -> Day {
        Series::of(scene, kept).day(time)
    }
}

/// What an engineer asks of a layout.
#[derive(Debug, Clone, PartialEq)]
pub struct Answers {
    /// Pipes that work.
    pub pipes: usize,
    /// Day on which the first two neighbours joined.
    pub first_gap: Option<f64>,
    /// Day on which a closed wall first stood around the centre.
    pub closure: Option<f64>,
    /// Day on which it first opened again.
    pub reopening: Option<f64>,
    /// From what day to what day it stood closed; without an end where it stands at the end.
    pub standing: Vec<(f64, Option<f64>)>,
    /// Whether it stands closed at the end.
    pub closed: bool,
    /// The link between whose pipes the wall is weakest at the end, or the widest that is open.
    pub weakest: Option<LinkRow>,
    /// The pipes that were last to join when the wall closed.
    pub last: Option<[String; 2]>,
    /// Links that are open at the end.
    pub open: usize,
    /// Day on which all neighbours had joined.
    pub all_gaps: Option<f64>,
    /// Day on which the closed wall first had the wanted thickness and mean temperature where it is weakest.
    pub design: Option<f64>,
    /// Day on which it first had them no more.
    pub design_left: Option<f64>,
    /// The wall on the days of the profiles.
    pub days: Vec<Day>,
    /// Heat taken by all pipes over time: seconds, W by metre of depth.
    pub load: Vec<(f64, f64)>,
    /// Heat taken by all pipes since the start: seconds, MJ by metre of depth.
    pub energy: Vec<(f64, f64)>,
    /// The same in the mean over each day: its end (s), W/m.
    pub daily: Vec<(f64, f64)>,
    /// Mean temperature of the wall and heat per pipe (W/m) of the steady ring with the same fronts at the end.
    pub formula: Option<(f64, f64)>,
    /// What the outer wall has done; none where water flows.
    pub far: Option<Far>,
    /// How the run ended.
    pub outcome: Outcome,
}

impl Answers {
    /// From a run of a scene.
    pub fn of(scene: &Scene, kept: &Kept, design: Option<Design>) -> Answers {
        let pipes = working(&scene.rings);
        let day = |time: f64| time / DAY;
        let closures = || kept.links.iter().filter_map(LinkRow::closed_s);
        let open = kept.links.iter().filter(|link| link.closed_s().is_none()).count();
        let series = Series::of(scene, kept);
        let load: Vec<(f64, f64)> = series.heat.iter().map(|(time, heat)| (*time, heat * pipes as f64)).collect();
        let mapped = |time: f64| kept.around.iter().find(|map| (map.time_s - time).abs() <= 1e-9 * scene.duration);
        let on = |time: &f64| Day { mean_axis_c: mapped(*time).and_then(|map| map.mean_axis_c), ..series.day(*time) };
        let days: Vec<Day> = scene.watch.profiles.iter().map(on).collect();
        let wall = kept.record.wall.as_ref();
        let (design, left) = design.map_or((None, None), |design| designed(&series.weakest, design));
        Answers {
            pipes,
            first_gap: closures().reduce(f64::min).map(day),
            closure: wall.and_then(|wall| wall.closure_s).map(day),
            reopening: wall.and_then(|wall| wall.reopening_s).map(day),
            standing: wall.map_or(Vec::new(), |wall| {
                wall.standing_s.iter().map(|(from, to)| (day(*from), to.map(day))).collect()
            }),
            closed: wall.is_some_and(|wall| wall.closed),
            weakest: weakest(&kept.record, &kept.links).cloned(),
            last: wall.and_then(|wall| wall.last_gap.clone()),
            open,
            all_gaps: if open == 0 { closures().reduce(f64::max).map(day) } else { None },
            design: design.map(day),
            design_left: left.map(day),
            far: Far::of(scene, kept, &series),
            formula: days.last().and_then(|last| formula(scene, last)),
            days,
            load,
            daily: kept.loads.clone(),
            energy: series.taken.iter().map(|(time, taken)| (*time, 1e-6 * taken)).collect(),
            outcome: kept.record.outcome,
        }
    }

    /// Greatest mean load of a day after the first (W/m); none of runs of less than two.
    pub fn peak(&self) -> Option<f64> {
        greatest(&self.daily)
    }
}

/// The greatest of means over days (s at their ends) after the first.
pub(super) fn greatest(daily: &[(f64, f64)]) -> Option<f64> {
    daily.iter().filter(|(end, _)| *end > 1.5 * DAY).map(|(_, load)| *load).reduce(f64::max)
}

/// The link between whose pipes the wall of a run is weakest.
fn weakest<'a>(record: &Record, links: &'a [LinkRow]) -> Option<&'a LinkRow> {
    let [from, to] = record.wall.as_ref()?.weakest_gap.as_ref()?;
    links.iter().find(|link| link.from == *from && link.to == *to)
}

/// What the outer wall, which stands for ground without end, has done by the end of a run.
///
/// A wall of the ground's own temperature gives heat that ground beyond it would have kept, one that is insulated lacks it. What is
/// false by that at the wall has to come the same way again to be felt by pipes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Far {
    /// Heat that came through the wall over that taken by pipes.
    pub share: f64,
    /// How far ground at the wall has cooled from the start towards the freezing point, over all the way.
    pub cooled: f64,
}

impl Far {
    /// Share and cooling from which on the load is off by more than some 1 %: the guide has the numbers.
    const SHARE: f64 = 0.1;
    const COOLED: f64 = 0.6;

    /// Of a run; none where water flows, which brings heat through the wall.
    fn of(scene: &Scene, kept: &Kept, series: &Series) -> Option<Far> {
        if scene.flow.is_some() {
            return None;
        }
        let (_, taken) = series.taken.last()?;
        let (_, given) = series.given.last()?;
        let outermost = kept
            .profiles
            .iter()
            .filter(|row| row.plane == "interface")
            .max_by(|a, b| a.along_m.total_cmp(&b.along_m))?;
        let way = scene.initial_temperature - scene.materials[0].freezing_point;
        let cooled = (scene.initial_temperature - outermost.temperature_c) / way;
        let share = if *taken > 0.0 { given / taken } else { 0.0 };
        Some(Far { share, cooled: if way > 0.0 { cooled } else { 0.0 } })
    }

    /// Whether it matters.
    pub fn matters(&self) -> bool {
        self.share > Far::SHARE || self.cooled > Far::COOLED
    }
}

/// What is read of the wall over time: seconds and values.
struct Series {
    /// The wall where it is weakest.
    weakest: Vec<Weakest>,
    weakest_inner: Vec<(f64, f64)>,
    weakest_outer: Vec<(f64, f64)>,
    thickness_interface: Vec<(f64, f64)>,
    thickness_main: Vec<(f64, f64)>,
    inner: Vec<(f64, f64)>,
    outer: Vec<(f64, f64)>,
    main_inner: Vec<(f64, f64)>,
    main_outer: Vec<(f64, f64)>,
    area: Vec<(f64, f64)>,
    mean_main: Vec<(f64, f64)>,
    mean_interface: Vec<(f64, f64)>,
    mean: Vec<(f64, f64)>,
    /// Heat taken by a pipe (W/m).
    heat: Vec<(f64, f64)>,
    /// Heat taken by all pipes (J/m).
    taken: Vec<(f64, f64)>,
    /// Heat given by the outer wall (J/m).
    given: Vec<(f64, f64)>,
}

impl Series {
    /// From a run of a scene.
    fn of(scene: &Scene, kept: &Kept) -> Series {
        let images = match scene.domain {
            Domain::Ring { sector, .. } => sector.images() as f64,
            _ => 1.0,
        };
        let wall = |value: fn(&WallRow) -> Option<f64>| {
            kept.walls.iter().filter_map(|row| Some((row.time_s, value(row)?))).collect()
        };
        let plane = |name: &str, value: fn(&PlaneRow) -> Option<f64>| {
            let rows = kept.planes.iter().filter(|row| row.plane == name);
            rows.filter_map(|row| Some((row.time_s, value(row)?))).collect()
        };
        // Columns are named after patches: walls, pipes or pipes_2, perhaps what is inside.
        let entered = |name: &str, sign: f64| {
            let patches: Vec<usize> =
                (0..kept.budget_names.len()).filter(|k| kept.budget_names[*k].starts_with(name)).collect();
            let sum = |row: &BudgetRow| sign * images * patches.iter().filter_map(|k| row.in_j.get(*k)).sum::<f64>();
            kept.budget.iter().map(|row| (row.time_s, sum(row))).collect()
        };
        // At the same instants, in the same order.
        let sections: Vec<&PlaneRow> = kept.planes.iter().filter(|row| row.plane == "weakest").collect();
        let row = |wall: &WallRow| {
            let at = sections.partition_point(|row| row.time_s < wall.time_s);
            let plane = sections.get(at).filter(|row| row.time_s == wall.time_s);
            let closed = wall.closed.unwrap_or(false);
            let temperature = plane.and_then(|plane| plane.mean_temperature_c);
            (wall.time_s, closed, wall.thickness_weakest_m.unwrap_or(0.0), temperature)
        };
        Series {
            weakest: kept.walls.iter().map(row).collect(),
            weakest_inner: plane("weakest", |row| row.inner_m),
            weakest_outer: plane("weakest", |row| row.outer_m),
            thickness_interface: wall(|row| row.thickness_interface_mean_m),
            thickness_main: wall(|row| row.thickness_main_mean_m),
            inner: plane("interface", |row| row.inner_m),
            outer: plane("interface", |row| row.outer_m),
            main_inner: plane("main", |row| row.inner_m),
            main_outer: plane("main", |row| row.outer_m),
            area: wall(|row| Some(row.frozen_area_m2)),
            mean_main: plane("main", |row| row.mean_temperature_c),
            mean_interface: plane("interface", |row| row.mean_temperature_c),
            mean: plane("wall", |row| row.mean_temperature_c),
            heat: wall(|row| Some(row.heat_per_pipe_w_per_m)),
            taken: entered("pipes", -1.0),
            given: entered("outer", 1.0),
        }
    }

    /// The wall at an instant; what is not there yet is absent, or 0.
    fn day(&self, time: f64) -> Day {
        let read = |series: &[(f64, f64)]| between(series, time);
        // At the last output that is not after it: a wall that closes between two outputs is not there at the first.
        let room = 1e-9 * time.abs();
        let weakest = self.weakest.iter().rev().find(|row| row.0 <= time + room);
        Day {
            day: time / DAY,
            thickness_interface_mean_m: read(&self.thickness_interface),
            thickness_main_mean_m: read(&self.thickness_main),
            closed: weakest.is_some_and(|(_, closed, ..)| *closed),
            thickness_weakest_m: weakest.map_or(0.0, |(_, _, thickness, _)| *thickness),
            temperature_weakest_c: weakest.and_then(|(.., temperature)| *temperature),
            weakest_m: read(&self.weakest_inner)
                .zip(read(&self.weakest_outer))
                .filter(|_| weakest.is_some_and(|row| row.1)),
            interface_m: read(&self.inner).zip(read(&self.outer)),
            main_m: read(&self.main_inner).zip(read(&self.main_outer)),
            area_m2: read(&self.area).unwrap_or(0.0),
            mean_main_c: read(&self.mean_main),
            mean_interface_c: read(&self.mean_interface),
            mean_c: read(&self.mean),
            mean_axis_c: None,
            heat_per_pipe_w_per_m: read(&self.heat).unwrap_or(0.0),
            energy_mj_per_m: 1e-6 * read(&self.taken).unwrap_or(0.0),
        }
    }
}

/// The steady ring of a scene with one even ring, with the fronts of a day.
fn formula(scene: &Scene, day: &Day) -> Option<(f64, f64)> {
    let [ring] = &scene.rings[..] else { return None };
    // Its fronts are at the freezing point, and it is alike all around.
    if scene.excavation.is_some() || !scene.conducts_alike() {
        return None;
    }
    let material = &scene.materials[0];
    let (inner, outer) = day.interface_m?;
    let steady = SteadyRing {
        count: ring.count,
        ring_radius: ring.ring_radius,
        pipe_radius: ring.pipe_radius,
        pipe: ring.condition.temperature()?.at(scene.duration) - material.freezing_point,
        fronts: (inner, outer),
        conductivity: material.frozen.conductivity,
    };
    let (mean, heat) = if ring.is_even() && !ring.one_particle && ring.condition.film().is_none() && steady.pipe < 0.0 {
        steady.mean_and_heat()?
    } else {
        return None;
    };
    Some((mean + material.freezing_point, heat))
}
