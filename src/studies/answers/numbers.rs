//! The results of a run as numbers, for tables and programs.

use frazil_record::RunResult;
use frazil_scene::{Scene, TimeUnit, Units};
use serde::{Deserialize, Serialize};

use super::{Gaps, pipe_walls, volume_unit};
use crate::ensemble::record::errors_of;

/// A number that a run found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Number {
    /// Its name in files, which ends in its unit.
    pub name: String,
    /// What it is, with its unit: the label of an axis.
    pub label: String,
    /// The number, at the end of the run unless its name says when.
    pub value: f64,
}

/// The results of a run, as far as its scene has them, errors last.
pub fn numbers(scene: &Scene, result: &RunResult) -> Vec<Number> {
    let mut list = List { scene, numbers: Vec::new() };
    list.fronts(result);
    list.wall(result);
    list.pipes(result);
    list.water(result);
    if let Some(stream) = &result.record.stream {
        list.add("greatest_speed_m_per_s", "greatest speed", "m/s", Some(stream.greatest_speed_m_per_s));
    }
    list.probes(result);
    list.stored(result);
    let errors = errors_of(&result.record).into_iter().filter(|(name, _)| !name.starts_with("stream."));
    for (name, error) in errors {
        let words = name.trim_end_matches("_rel").replace(['_', '.'], " ");
        let (name, label) = (format!("error_{name}"), format!("error: {words}"));
        list.numbers.push(Number { name, label, value: error });
    }
    list.numbers
}

struct List<'a> {
    scene: &'a Scene,
    numbers: Vec<Number>,
}

impl List<'_> {
    /// Adds a number that is there; the unit of an axis is left out where the scene has none.
    fn add(&mut self, name: &str, words: &str, unit: &str, value: Option<f64>) {
        let has_unit = self.scene.units == Units::Si && !unit.is_empty();
        let label = if has_unit { format!("{words} ({unit})") } else { words.to_owned() };
        self.numbers.extend(value.map(|value| Number { name: name.to_owned(), label, value }));
    }

    fn fronts(&mut self, result: &RunResult) {
        let freezes = self.scene.materials.iter().any(|material| material.latent_heat > 0.0);
        let front = result.front.last().map(|row| row.front_m);
        if self.scene.of_water {
            self.add("wetted_length_m", "wetted length", "m", front);
        } else {
            self.add("front_m", "front", "m", front.filter(|_| freezes));
            let frozen = result.frozen.last().map(|row| row.frozen_volume);
            self.add("frozen_volume", "frozen volume", volume_unit(self.scene), frozen.filter(|_| freezes));
        }
    }

    fn stored(&mut self, result: &RunResult) {
        let stored = result.budget.last().map(|row| row.stored_j);
        if self.scene.of_water {
            self.add("water_stored_m3", "water taken up", volume_unit(self.scene), stored);
        } else {
            self.add("stored_j", "change of stored heat", &volume_unit(self.scene).replace("m³", "J"), stored);
        }
    }

    fn wall(&mut self, result: &RunResult) {
        let Some(row) = result.walls.last() else { return };
        let wall = result.record.wall.as_ref();
        let gaps = Gaps::of(&result.gaps);
        let last = gaps.last.filter(|_| gaps.open == 0);
        let days = |time: f64| time / TimeUnit::Day.seconds();
        let closure = wall.map_or(last, |wall| wall.closure_s);
        self.add("closure_days", "closure", "d", closure.map(days));
        let reopened = wall.and_then(|wall| wall.reopening_s);
        self.add("reopened_days", "reopening", "d", reopened.map(days));
        self.add("thickness_weakest_m", "thickness at the weakest gap", "m", wall.map(|wall| wall.thickness_m));
        self.add("thickness_interface_mean_m", "thickness between pipes", "m", row.thickness_interface_mean_m);
        self.add("thickness_main_mean_m", "thickness through pipes", "m", row.thickness_main_mean_m);
        self.add("frozen_area_m2", "frozen area", "m²", Some(row.frozen_area_m2));
        self.add("heat_per_pipe_w_per_m", "heat of a pipe", "W/m", Some(row.heat_per_pipe_w_per_m));
    }

    fn pipes(&mut self, result: &RunResult) {
        let walls = pipe_walls(result);
        self.add("pipe_wall_c", "walls of pipes", "°C", walls.map(|walls| walls.0));
        self.add("pipe_wall_coldest_c", "coldest wall of a pipe", "°C", walls.map(|walls| walls.1));
    }

    fn water(&mut self, result: &RunResult) {
        let Some(record) = &result.record.water else { return };
        self.add("thawed_s", "last ice", "s", record.events_s.get("thawed").copied());
        let Some(row) = result.water.as_ref().and_then(|water| water.rows.last()) else { return };
        self.add("ice_fraction", "ice over that at the start", "", Some(row.ice_fraction));
        self.add("inflow_m3_per_s", "inflow", "m³/s", Some(row.inflow_m3_per_s));
        self.add("outflow_m3_per_s", "outflow", "m³/s", Some(row.outflow_m3_per_s));
        self.add("heat_in_w", "heat through walls", "W", Some(row.heat_in_w));
    }

    fn probes(&mut self, result: &RunResult) {
        let Some(last) = result.probes.last().map(|row| row.time_s) else { return };
        for (k, row) in result.probes.iter().filter(|row| row.time_s == last).enumerate() {
            let number = k + 1;
            if self.scene.of_water {
                let (name, words) = (format!("probe_{number}_saturation"), format!("saturation at probe {number}"));
                self.add(&name, &words, "", Some(row.temperature_c));
            } else {
                let (name, words) = (format!("probe_{number}_c"), format!("temperature at probe {number}"));
                self.add(&name, &words, "°C", Some(row.temperature_c));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use frazil_record::{Errors, FrontRow, ProbeRow, Record};

    use super::*;
    use crate::bundled;

    #[test]
    fn numbers_are_those_of_the_end_and_errors_stand_last() {
        let mut scene = bundled::scene("stefan-water", &[]).expect("a scene");
        let front = |time_s: f64, front_m: f64| FrontRow { time_s, front_m, front_ref_m: None };
        let probe = |time_s: f64, temperature_c: f64| ProbeRow {
            time_s,
            x_m: 0.1,
            y_m: 0.0,
            temperature_c,
            concentration: None,
        };
        let errors = Errors { front_rms_rel: Some(0.01), ..Errors::default() };
        let result = RunResult {
            front: vec![front(0.0, 0.0), front(10.0, 0.2)],
            probes: vec![probe(0.0, 1.0), probe(10.0, -2.0), probe(10.0, -3.0)],
            ..RunResult::bare(Record { errors, ..Record::default() })
        };
        let found = |scene: &Scene| -> Vec<(String, String, f64)> {
            numbers(scene, &result).into_iter().map(|one| (one.name, one.label, one.value)).collect()
        };
        let number = |name: &str, label: &str, value: f64| (name.to_owned(), label.to_owned(), value);
        let expected = [
            number("front_m", "front (m)", 0.2),
            number("probe_1_c", "temperature at probe 1 (°C)", -2.0),
            number("probe_2_c", "temperature at probe 2 (°C)", -3.0),
            number("error_front_rms_rel", "error: front rms", 0.01),
        ];
        assert_eq!(found(&scene), expected);
        scene.of_water = true;
        assert_eq!(found(&scene)[0], number("wetted_length_m", "wetted length (m)", 0.2));
        assert_eq!(found(&scene)[1].0, "probe_1_saturation");
    }
}
