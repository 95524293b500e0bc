//! What a run says about a layout.

use frazil_core::record::{BudgetRow, GapRow, LinkRow, Outcome, PlaneRow, ProfileRow, Record, RunResult, WallRow};
use frazil_core::scene::{Domain, Scene};
use frazil_plots::layouts::between;
use serde::{Deserialize, Serialize};

use super::around::{Around, Axis, around};
use super::formula::SteadyRing;
use super::study::Design;
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
    /// When a closed wall stood (s).
    pub wall_closure_s: Option<f64>,
    /// What its maps say of it, where it has maps.
    #[serde(default)]
    pub around: Vec<Around>,
    /// The axis plane at the last map: angles (degrees) and temperatures.
    #[serde(default)]
    pub axis: Axis,
}

impl Kept {
    /// From a run of a scene.
    pub fn of(scene: &Scene, result: &RunResult) -> Kept {
        let last = result.profiles.iter().map(|row| row.time_s).fold(f64::NEG_INFINITY, f64::max);
        let weakest = weakest(&result.links, result.wall_closure_s);
        let (around, axis) = around(scene, result, weakest);
        Kept {
            around,
            axis,
            record: result.record.clone(),
            links: result.links.clone(),
            planes: result.planes.clone(),
            walls: result.walls.clone(),
            profiles: result.profiles.iter().filter(|row| row.time_s == last).cloned().collect(),
            budget: result.budget.clone(),
            budget_names: result.budget_names.clone(),
            gaps: result.gaps.clone(),
            wall_closure_s: result.wall_closure_s,
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
            wall_closure_s: self.wall_closure_s,
            ..RunResult::bare(self.record.clone())
        }
    }
}

/// The wall at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Day {
    /// The instant (days).
    pub day: f64,
    /// Thickness on the interface plane (m).
    pub thickness_interface_mean_m: f64,
    /// Thickness on the main plane (m).
    pub thickness_main_mean_m: f64,
    /// Inner front on the interface plane (m from the centre).
    pub inner_m: Option<f64>,
    /// Outer front on the interface plane (m from the centre).
    pub outer_m: Option<f64>,
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
    /// Thickness at the weakest gap (m), where there is a map of this instant.
    pub thickness_weakest_m: Option<f64>,
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
    /// Day on which a closed wall stood around the centre.
    pub closure: Option<f64>,
    /// The link that was last to close the wall, or the widest that is open.
    pub weakest: Option<LinkRow>,
    /// Links that are open at the end.
    pub open: usize,
    /// Day on which all neighbours had joined.
    pub all_gaps: Option<f64>,
    /// Day on which the wall had the wanted thickness and mean temperature.
    pub design: Option<f64>,
    /// The wall on the days of the profiles.
    pub days: Vec<Day>,
    /// Heat taken by all pipes over time: seconds, W by metre of depth.
    pub load: Vec<(f64, f64)>,
    /// Heat taken by all pipes since the start: seconds, MJ by metre of depth.
    pub energy: Vec<(f64, f64)>,
    /// Greatest load after the first day (W/m).
    pub peak: f64,
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
        let closures = || kept.links.iter().filter_map(|link| link.closure_s);
        let open = kept.links.iter().filter(|link| link.closure_s.is_none()).count();
        let series = Series::of(scene, kept);
        let load: Vec<(f64, f64)> = series.heat.iter().map(|(time, heat)| (*time, heat * pipes as f64)).collect();
        let mapped = |time: f64| kept.around.iter().find(|map| (map.time_s - time).abs() <= 1e-9 * scene.duration);
        let on = |time: &f64| Day {
            thickness_weakest_m: mapped(*time).and_then(|map| map.thickness_weakest_m),
            mean_axis_c: mapped(*time).and_then(|map| map.mean_axis_c),
            ..series.day(*time)
        };
        let days: Vec<Day> = scene.watch.profiles.iter().map(on).collect();
        Answers {
            pipes,
            first_gap: closures().reduce(f64::min).map(day),
            closure: kept.wall_closure_s.map(day),
            weakest: weakest(&kept.links, kept.wall_closure_s).cloned(),
            open,
            all_gaps: if open == 0 { closures().reduce(f64::max).map(day) } else { None },
            design: design.and_then(|design| series.reached(&kept.walls, design)),
            far: Far::of(scene, kept, &series),
            formula: days.last().and_then(|last| formula(scene, last)),
            days,
            peak: load.iter().filter(|(time, _)| *time > DAY).map(|(_, load)| *load).fold(0.0, f64::max),
            load,
            energy: series.taken.iter().map(|(time, taken)| (*time, 1e-6 * taken)).collect(),
            outcome: kept.record.outcome,
        }
    }
}

/// The link that was last to close the wall; while it is open, the widest open one.
fn weakest(links: &[LinkRow], closure_s: Option<f64>) -> Option<&LinkRow> {
    let closing = links.iter().find(|link| closure_s.is_some() && link.closure_s == closure_s);
    let open = links.iter().filter(|link| link.closure_s.is_none());
    closing.or_else(|| open.max_by(|a, b| a.distance_m.total_cmp(&b.distance_m)))
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
        let outermost =
            kept.profiles.iter().filter(|row| row.plane == "interface").max_by(|a, b| a.x_m.total_cmp(&b.x_m))?;
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
        let wall = |value: fn(&WallRow) -> f64| kept.walls.iter().map(|row| (row.time_s, value(row))).collect();
        let plane = |name: &str, value: fn(&PlaneRow) -> Option<f64>| {
            let rows = kept.planes.iter().filter(|row| row.plane == name);
            rows.filter_map(|row| Some((row.time_s, value(row)?))).collect()
        };
        // Columns are named after doors: walls, pipes or pipes_2, perhaps what is inside.
        let entered = |name: &str, sign: f64| {
            let doors: Vec<usize> =
                (0..kept.budget_names.len()).filter(|k| kept.budget_names[*k].starts_with(name)).collect();
            let sum = |row: &BudgetRow| sign * images * doors.iter().filter_map(|k| row.in_j.get(*k)).sum::<f64>();
            kept.budget.iter().map(|row| (row.time_s, sum(row))).collect()
        };
        Series {
            thickness_interface: wall(|row| row.thickness_interface_mean_m),
            thickness_main: wall(|row| row.thickness_main_mean_m),
            inner: plane("interface", |row| row.inner_m),
            outer: plane("interface", |row| row.outer_m),
            main_inner: plane("main", |row| row.inner_m),
            main_outer: plane("main", |row| row.outer_m),
            area: wall(|row| row.frozen_area_m2),
            mean_main: plane("main", |row| row.mean_temperature_c),
            mean_interface: plane("interface", |row| row.mean_temperature_c),
            mean: plane("wall", |row| row.mean_temperature_c),
            heat: wall(|row| row.heat_per_pipe_w_per_m),
            taken: entered("pipes", -1.0),
            given: entered("outer", 1.0),
        }
    }

    /// Day on which the wall first was as designed, between the outputs (rows of `walls`) that tell of it.
    fn reached(&self, walls: &[WallRow], design: Design) -> Option<f64> {
        // How far both are from what is wanted, as parts of it: 0 or less once they are there.
        let lack = |day: &Day| {
            let thin = design.thickness_m - day.thickness_interface_mean_m;
            day.mean_c.map(|mean| [thin, mean - design.mean_temperature_c])
        };
        let mut before: Option<(f64, [f64; 2])> = None;
        for row in walls {
            let day = self.day(row.time_s);
            let Some(now) = lack(&day) else { continue };
            if now.iter().all(|lack| *lack <= 0.0) {
                let Some((last, lacked)) = before else { return Some(day.day) };
                let part =
                    lacked.iter().zip(now).map(|(last, now)| if *last > 0.0 { last / (last - now) } else { 0.0 });
                return Some(last + part.fold(0.0, f64::max) * (day.day - last));
            }
            before = Some((day.day, now));
        }
        None
    }

    /// The wall at an instant; what is not there yet is absent, or 0.
    fn day(&self, time: f64) -> Day {
        let read = |series: &[(f64, f64)]| between(series, time);
        Day {
            day: time / DAY,
            thickness_interface_mean_m: read(&self.thickness_interface).unwrap_or(0.0),
            thickness_main_mean_m: read(&self.thickness_main).unwrap_or(0.0),
            inner_m: read(&self.inner),
            outer_m: read(&self.outer),
            main_m: read(&self.main_inner).zip(read(&self.main_outer)),
            area_m2: read(&self.area).unwrap_or(0.0),
            mean_main_c: read(&self.mean_main),
            mean_interface_c: read(&self.mean_interface),
            mean_c: read(&self.mean),
            thickness_weakest_m: None,
            mean_axis_c: None,
            heat_per_pipe_w_per_m: read(&self.heat).unwrap_or(0.0),
            energy_mj_per_m: 1e-6 * read(&self.taken).unwrap_or(0.0),
        }
    }
}

/// The steady ring of a scene with one even ring, with the fronts of a day.
fn formula(scene: &Scene, day: &Day) -> Option<(f64, f64)> {
    let [ring] = &scene.rings[..] else { return None };
    // Its fronts are at the freezing point.
    if scene.excavation.is_some() {
        return None;
    }
    let material = &scene.materials[0];
    let (inner, outer) = day.inner_m.zip(day.outer_m)?;
    let steady = SteadyRing {
        count: ring.count,
        ring_radius: ring.ring_radius,
        pipe_radius: ring.pipe_radius,
        pipe: ring.temperature.at(scene.duration) - material.freezing_point,
        fronts: (inner, outer),
        conductivity: material.frozen.conductivity,
    };
    let (mean, heat) = if ring.is_even() && !ring.one_particle && ring.film.is_none() && steady.pipe < 0.0 {
        steady.mean_and_heat()?
    } else {
        return None;
    };
    Some((mean + material.freezing_point, heat))
}
