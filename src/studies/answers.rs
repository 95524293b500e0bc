//! What a run says first: where the front is, when the wall closed, what became of the ice. Errors are called errors.

pub mod numbers;

use std::collections::BTreeMap;

use frazil_core::space::domain::Domain;
use frazil_core::space::symmetry::Symmetry;
use frazil_plots::style::{length, number, percent};
use frazil_record::{Errors, EstimatedError, GapRow, MeasuredErrors, RunResult, WallRecord};
use frazil_record::{WaterRecord, WaterRow};
use frazil_scene::{Scene, Units};
use frazil_simulation::observers::PIPE_WALLS;

use crate::ensemble::record::by_name;
use crate::progress::clock;

/// A line of a summary: its title, and what it says.
pub type Line = (String, String);

/// Lines of a summary, titles below each other.
pub fn text(lines: &[Line]) -> String {
    const WIDTH: usize = 20;
    lines.iter().map(|(title, words)| format!("  {title:<WIDTH$} {words}\n")).collect()
}

/// The errors that people ask for first: of what, and their names in records.
pub const HEADLINES: [(&str, &str); 6] = [
    ("front", "front_rms_rel"),
    ("temperature", "temperature_rms_rel"),
    ("saturation", "saturation_rms"),
    ("concentration", "concentration_rms_rel"),
    ("frozen volume", "frozen_volume_rms_rel"),
    ("closure", "events.closure_day"),
];

/// What a run found, as far as its scene asks for it.
pub fn answers(scene: &Scene, result: &RunResult) -> Vec<Line> {
    let say = Say { scene };
    let freezes = scene.materials.iter().any(|material| material.latent_heat > 0.0);
    let mut lines = if scene.of_water { say.moisture(result) } else { Vec::new() };
    let mut line = |title: &str, words: String| lines.push((title.to_owned(), words));
    if let Some(row) = result.front.last().filter(|_| freezes) {
        line("front", format!("{} after {}", say.front(row.front_m), say.time(row.time_s)));
    }
    if let Some(row) = result.frozen.last().filter(|_| freezes) {
        line("frozen volume", format!("{} after {}", say.volume(row.frozen_volume), say.time(row.time_s)));
    }
    if let Some(row) = result.walls.last() {
        if let Some(closure) = say.closure(result) {
            line("frozen wall", closure);
        }
        let after = say.time(row.time_s);
        let lengths = [("between", row.thickness_interface_mean_m), ("through", row.thickness_main_mean_m)];
        let lengths = lengths.into_iter().filter_map(|(way, mean)| Some(format!("{} {way} pipes", say.length(mean?))));
        let lengths = lengths.collect::<Vec<_>>().join(", ");
        if !lengths.is_empty() {
            line("frozen lengths", format!("{lengths} (means) after {after}"));
        }
        line("frozen area", format!("{} after {after}", say.with(row.frozen_area_m2, "m²")));
    }
    let mut line = |title: &str, words: String| lines.push((title.to_owned(), words));
    if let Some((mean, coldest)) = pipe_walls(result) {
        let [mean, coldest] = [mean, coldest].map(|temperature| say.with(temperature, "°C"));
        line("pipe walls", format!("{mean} at the end (mean of the first ring), {coldest} at the coldest"));
    }
    if let Some((record, last)) = result.record.water.as_ref().zip(result.water.as_ref().and_then(|w| w.rows.last())) {
        lines.extend(say.water(record, last));
    }
    if let Some(stream) = &result.record.stream {
        lines.push(("stream".into(), format!("{} at most", say.with(stream.greatest_speed_m_per_s, "m/s"))));
    }
    lines
}

/// Temperature of the walls of pipes at the end, in the mean over the first ring whose walls follow brine or a heat, and of the coldest
/// wall at any output.
fn pipe_walls(result: &RunResult) -> Option<(f64, f64)> {
    let table = result.tables.iter().find(|table| table.file == PIPE_WALLS)?;
    let at = |name: &str| table.columns.iter().position(|column| column.name == name);
    let (time, mean, coldest) = (at("time_s")?, at("wall_c")?, at("coldest_c")?);
    let end = table.rows.last()?[time];
    let first = table.rows.iter().find(|row| row[time] == end)?;
    let least = table.rows.iter().filter_map(|row| row[coldest]).fold(f64::INFINITY, f64::min);
    Some((first[mean]?, least))
}

/// Errors against the reference, of a run and of its water.
pub fn errors(errors: &Errors, water: Option<&WaterRecord>) -> Vec<Line> {
    const OF_WATER: [(&str, &str); 4] = [
        ("thaw", "thawed"),
        ("ice", "ice_fraction_max"),
        ("cut temperature", "cut_temperature_rms_rel"),
        ("cut pressure", "cut_pressure_rms_rel"),
    ];
    let all = by_name(errors);
    let own = HEADLINES.into_iter().filter_map(|(title, name)| Some((title, *all.get(name)?)));
    let of_water = OF_WATER.into_iter().filter_map(|(title, name)| Some((title, *water?.errors.get(name)?)));
    own.chain(of_water).map(|(title, error)| (format!("{title} error"), percent(error, 3))).collect()
}

/// What a quantity of measured points is called, and how its values are said.
pub fn quantity<'a>(scene: &'a Scene, name: &str) -> (&'static str, Box<dyn Fn(f64) -> String + 'a>) {
    let say = Say { scene };
    match name {
        "front_m" => ("front", Box::new(move |value| say.length(value))),
        "saturation" => ("saturation", Box::new(|value| number(value, 3))),
        "temperature_c" => ("temperature", Box::new(move |value| say.with(value, "K"))),
        _ => ("events", Box::new(move |value| say.time(value))),
    }
}

/// How far a run is off what was measured, of each quantity, beside what the instruments leave open.
pub fn measured(scene: &Scene, measured: &BTreeMap<String, MeasuredErrors>) -> Vec<Line> {
    let line = |(quantity, found): (&String, &MeasuredErrors)| {
        let (title, with) = self::quantity(scene, quantity);
        let MeasuredErrors { points, missing, rms, max, sd_rms, rms_over_sd, within_sd, .. } = *found;
        let within = (within_sd * points as f64).round();
        let missing = if missing > 0 { format!("; {missing} not reached") } else { String::new() };
        let words = format!(
            "{} off (rms, {} standard deviations of {}), at most {}; {within} of {points} points within one{missing}",
            with(rms),
            number(rms_over_sd, 3),
            with(sd_rms),
            with(max),
        );
        (format!("measured {title}"), words)
    };
    measured.iter().map(line).collect()
}

/// The error that was estimated of a run, and its parts as far as they were measured.
pub fn estimated(estimated: &EstimatedError) -> String {
    let parts = [("steps", estimated.time_rel), ("front", estimated.front_rel), ("noise", estimated.noise_rel)];
    let measured = parts.into_iter().filter_map(|(part, error)| Some(format!(", {part} {}", percent(error?, 3))));
    let (promised, space) = (percent(estimated.promised_rel, 3), percent(estimated.space_rel, 3));
    format!("{} at most {promised}: spacing {space}{}", estimated.measure, measured.collect::<String>())
}

/// The unit of a volume of the body of a scene.
fn volume_unit(scene: &Scene) -> &'static str {
    match scene.domain {
        Domain::Axial { .. } | Domain::Radial { symmetry: Symmetry::Spherical, .. } => "m³",
        Domain::Line { .. } => "m³ per square metre",
        _ => "m³ per metre",
    }
}

/// Gaps of the first ring, of the whole plan.
struct Gaps {
    all: usize,
    /// Those that have not closed.
    open: usize,
    /// When the last of those that have closed did (s).
    last: Option<f64>,
}

impl Gaps {
    fn of(rows: &[GapRow]) -> Self {
        let rows = || rows.iter().filter(|gap| gap.multiplicity > 0);
        Gaps {
            all: rows().map(|gap| gap.multiplicity).sum(),
            open: rows().filter(|gap| gap.closure_s.is_none()).map(|gap| gap.multiplicity).sum(),
            last: rows().filter_map(|gap| gap.closure_s).reduce(f64::max),
        }
    }
}

/// How a scene speaks of its numbers.
struct Say<'a> {
    scene: &'a Scene,
}

impl Say<'_> {
    fn with(&self, value: f64, unit: &str) -> String {
        if self.scene.units == Units::Si { format!("{} {unit}", number(value, 4)) } else { number(value, 4) }
    }

    fn length(&self, value: f64) -> String {
        if self.scene.units == Units::Si { length(value) } else { number(value, 3) }
    }

    fn time(&self, seconds: f64) -> String {
        let unit = self.scene.time_unit;
        self.with(if self.scene.units == Units::Si { seconds / unit.seconds() } else { seconds }, unit.symbol())
    }

    fn front(&self, front: f64) -> String {
        match self.scene.domain {
            Domain::Radial { .. } => format!("at a radius of {}", self.length(front)),
            Domain::Rectangle { .. } if self.scene.watch.corner_front => {
                format!("{} along diagonals", self.length(front))
            }
            _ => match self.scene.freezing_direction() {
                Some(direction) => format!("{} of {} frozen", self.length(front), self.length(direction.length)),
                None => self.length(front),
            },
        }
    }

    fn volume(&self, volume: f64) -> String {
        self.with(volume, volume_unit(self.scene))
    }

    /// When the wall closed around the centre, whether it still stands, and how thick it is; of a ring whose wall was not
    /// watched, when its last gap closed; nothing of pipes that have no gaps between them.
    fn closure(&self, result: &RunResult) -> Option<String> {
        if let Some(wall) = &result.record.wall {
            return Some(self.watched(wall));
        }
        let Gaps { all, open, last } = Gaps::of(&result.gaps);
        let last = last.and_then(|last| result.gaps.iter().find(|gap| gap.closure_s == Some(last)));
        match last.and_then(|gap| Some((gap, gap.closure_s?))) {
            Some((gap, closure)) if open == 0 => {
                let (from, to) = (&gap.from, &gap.to);
                Some(format!("the last gap, between pipes {from} and {to}, closed after {}", self.time(closure)))
            }
            _ => (all > 0).then(|| format!("not closed: {open} of {all} gaps are open at the end")),
        }
    }

    fn watched(&self, wall: &WallRecord) -> String {
        let Some(closure) = wall.closure_s else { return "not closed".into() };
        let reopened =
            wall.reopening_s.map_or(String::new(), |time| format!(", opened again after {}", self.time(time)));
        let between = wall.weakest_gap.as_ref().map_or(String::new(), |[a, b]| format!(" between {a} and {b}"));
        let end = match wall.closed {
            true => format!("at the end {} at its weakest gap{between}", self.length(wall.thickness_m)),
            false => format!("OPEN at the end{between}"),
        };
        let alike = match wall.last_gap_spread_s {
            Some(spread) if wall.last_gap_alike > 1 => {
                format!(" (mean of {} equivalent gaps, ± {})", wall.last_gap_alike, self.time(spread))
            }
            _ => String::new(),
        };
        format!("closed after {}{alike}{reopened}; {end}", self.time(closure))
    }

    /// How far unsaturated water has come, and how much the ground has taken up of it.
    fn moisture(&self, result: &RunResult) -> Vec<Line> {
        let mut lines = Vec::new();
        let mut line = |title: &str, words: String| lines.push((title.to_owned(), words));
        if let Some(row) = result.front.last() {
            let of = match (self.scene.domain, self.scene.freezing_direction()) {
                (Domain::Radial { .. }, _) => format!("up to a radius of {}", self.length(row.front_m)),
                (_, Some(direction)) => format!("{} of {}", self.length(row.front_m), self.length(direction.length)),
                _ => self.length(row.front_m),
            };
            line("wetted length", format!("{of} after {}", self.time(row.time_s)));
        }
        if let Some(row) = result.budget.last() {
            let volume = self.with(row.stored_j, volume_unit(self.scene));
            line("water taken up", format!("{volume} after {}", self.time(row.time_s)));
        }
        lines
    }

    fn water(&self, record: &WaterRecord, last: &WaterRow) -> Vec<Line> {
        let mut lines = Vec::new();
        let mut line = |title: &str, words: String| lines.push((title.to_owned(), words));
        let after = self.time(last.time_s);
        if let Some(thawed) = record.events_s.get("thawed") {
            line("thaw", format!("the last ice after {}", self.time(*thawed)));
        }
        let share = if last.ice_fraction > 0.0 {
            format!(", {} of that at the start", percent(last.ice_fraction, 4))
        } else {
            String::new()
        };
        line("ice", format!("{}{share}, after {after}", self.with(last.ice_m3, volume_unit(self.scene))));
        let (inflow, outflow) = (last.inflow_m3_per_s, last.outflow_m3_per_s);
        line("water", format!("{} in, {} out after {after}", self.with(inflow, "m³/s"), self.with(outflow, "m³/s")));
        let heat = self.with(last.heat_in_w, "W");
        line("heat of walls", format!("{heat} in, conducted and advected, after {after}"));
        let (solutions, time) = (record.pressure_solutions, clock(record.pressure_wall_s));
        line("pressure", format!("{solutions} solutions, {} iterations, {time}", record.pressure_iterations));
        let (balance, owed) = (record.balance_rel, record.owed_rel);
        line(
            "water balance",
            format!("{} of the water exchanged, {} of it still to be supplied", number(balance, 2), number(owed, 2)),
        );
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundled;

    #[test]
    fn a_wall_is_said_to_stand_only_while_it_does() {
        let scene = bundled::scene("frozen-wall-sand", &[]).expect("a scene");
        let say = Say { scene: &scene };
        let day = |day: f64| day * 86_400.0;
        let wall = WallRecord {
            closed: true,
            closure_s: Some(day(30.0)),
            reopening_s: None,
            standing_s: vec![(day(30.0), None)],
            thickness_m: 1.25,
            mean_temperature_c: Some(-8.0),
            weakest_gap: Some(["1.3".into(), "1.4".into()]),
            last_gap: None,
            last_gap_alike: 1,
            last_gap_spread_s: Some(0.0),
        };
        assert_eq!(say.watched(&wall), "closed after 30 d; at the end 1.25 m at its weakest gap between 1.3 and 1.4");
        let even = WallRecord { last_gap_alike: 26, last_gap_spread_s: Some(day(0.25)), ..wall.clone() };
        assert_eq!(
            say.watched(&even),
            "closed after 30 d (mean of 26 equivalent gaps, ± 0.25 d); at the end 1.25 m at its weakest gap between 1.3 and 1.4"
        );
        let open = WallRecord { closed: false, reopening_s: Some(day(50.0)), thickness_m: 0.0, ..wall.clone() };
        assert_eq!(
            say.watched(&open),
            "closed after 30 d, opened again after 50 d; OPEN at the end between 1.3 and 1.4"
        );
        assert_eq!(say.watched(&WallRecord { closure_s: None, closed: false, ..wall }), "not closed");
    }

    #[test]
    fn errors_are_called_errors_those_of_water_too() {
        let found = Errors { front_rms_rel: Some(0.00672), temperature_rms_rel: Some(5.1e-6), ..Errors::default() };
        let water = WaterRecord { errors: [("thawed".to_owned(), -0.01)].into(), ..WaterRecord::default() };
        let lines = errors(&found, Some(&water));
        let said = [("front error", "0.672 %"), ("temperature error", "0.00051 %"), ("thaw error", "−1 %")];
        assert_eq!(lines, said.map(|(title, error)| (title.to_owned(), error.to_owned())));
        assert!(text(&lines).lines().all(|line| line.starts_with("  ") && line.contains(" error ")));
    }

    #[test]
    fn unsaturated_water_says_how_far_it_has_come() {
        let mut scene = bundled::scene("stefan-water", &[]).expect("a scene");
        scene.of_water = true;
        let row = frazil_record::FrontRow { time_s: 7200.0, front_m: 0.25, front_ref_m: None };
        let result = RunResult { front: vec![row], ..RunResult::default() };
        assert_eq!(
            text(&Say { scene: &scene }.moisture(&result)),
            "  wetted length        0.25 m of 0.4 m after 2 h\n"
        );
    }

    #[test]
    fn water_says_what_its_record_knows() {
        let scene = bundled::scene("thawing-inclusion", &[]).expect("a scene");
        let record = WaterRecord {
            events_s: [("thawed".to_owned(), 2500.0)].into(),
            pressure_solutions: 7,
            pressure_iterations: 70,
            ..WaterRecord::default()
        };
        let last = WaterRow {
            time_s: 3000.0,
            ice_m3: 0.5,
            liquid_m3: 1.0,
            ice_fraction: 0.25,
            ice_fraction_ref: None,
            inflow_m3_per_s: 2e-6,
            outflow_m3_per_s: 3e-6,
            heat_in_w: 12.0,
            least_temperature_c: -1.0,
            balance_rel: 0.0,
        };
        let said = text(&Say { scene: &scene }.water(&record, &last));
        for words in [
            "thaw                 the last ice after 2500 s",
            "25 % of that at the start",
            "m³/s in",
            "7 solutions",
            "12 W in",
        ] {
            assert!(said.contains(words), "{words} in\n{said}");
        }
    }
}
