//! Rain that runs off full ground, and faces at which water seeps out: exact limits, and what is booked.

use frazil_core::physics::retention::Retention;
use frazil_core::physics::retention::shape::RetentionCurve;
use frazil_core::space::domain::Domain;
use frazil_record::{Outcome, RunResult};

use crate::sketch::{Sketch, even, soil, soil_with_solute, through};

/// Conductivity of the saturated soil (m/s).
const FULL: f64 = 1e-6;

/// A column of fine sand under gravity, 0.5 m high, whose upper end is the wall "right".
fn column(spacing_m: f64) -> Sketch {
    let mut sketch = Sketch::new(Domain::Line { length: 0.5 }, spacing_m);
    (sketch.of_water, sketch.initial_c) = (true, -1.0);
    sketch.materials = vec![("sand", soil())];
    sketch.gravity = "towards = \"left\"".into();
    sketch
}

/// A column of the table of water, output by output.
fn read(result: &RunResult, name: &str) -> Vec<f64> {
    let table = result.tables.iter().find(|table| table.file == "moisture.csv").expect("a table of water");
    let column = table.columns.iter().position(|column| column.name == name).expect("a column");
    table.rows.iter().map(|row| row[column].expect("a value")).collect()
}

fn kept(result: &RunResult, what: &str) {
    let record = &result.record;
    assert_eq!(record.outcome, Outcome::Ok, "{what}: {:?}", record.cause);
    assert!(record.energy_balance_rel.abs() < 1e-9, "{what}: {:e}", record.energy_balance_rel);
    if let Some(solute) = record.solute_balance_rel {
        assert!(solute.abs() < 1e-9, "{what}: {solute:e}");
    }
}

/// What came in the last interval between outputs, by time (m/s).
fn rate(sketch: &Sketch, sums: &[f64]) -> f64 {
    let [.., before, last] = sums else { unreachable!("two outputs") };
    (last - before) * sketch.outputs as f64 / sketch.duration_s
}

/// All of a rain less than the ground conducts enters, and goes through at the saturation that conducts just that.
#[test]
fn a_light_rain_goes_through_at_the_saturation_that_conducts_it() {
    for kind in even() {
        let rain = 0.1 * FULL;
        let mut sketch =
            column(0.02).wall("right", format!("rain_m_per_s = {rain}")).wall("left", "condition = \"free-drainage\"");
        (sketch.duration_s, sketch.outputs) = (4e6, 20);
        let result = sketch.run(kind);
        kept(&result, kind.name);
        let [entered, left] = ["right", "left"].map(|wall| rate(&sketch, &through(&result, wall)));
        assert!((entered / rain - 1.0).abs() < 1e-9, "{}: {entered}", kind.name);
        assert!((left / -rain - 1.0).abs() < 1e-3, "{}: {left}", kind.name);
        assert!(read(&result, "ran_off_right_m3").iter().all(|off| off.abs() < 1e-9));
        let scene = sketch.scene(kind);
        let retention: &Retention = &scene.materials[0].soil.as_ref().expect("a soil").retention;
        let end = result.profiles.last().expect("a profile").time_s;
        for row in result.profiles.iter().filter(|row| row.time_s == end) {
            let conducts = retention.relative_conductivity(retention.suction(1.0 - row.temperature_c));
            assert!((conducts / 0.1 - 1.0).abs() < 0.01, "{}: {conducts}", kind.name);
        }
    }
}

/// Of a rain heavier than the ground conducts that much enters in the end, and the rest runs off.
#[test]
fn of_a_heavy_rain_the_ground_takes_what_it_conducts() {
    for kind in even() {
        let mut sketch = column(0.02)
            .wall("right", format!("rain_mm_per_day = {}", 3.0 * FULL * 86_400.0 * 1e3))
            .wall("left", "condition = \"free-drainage\"");
        (sketch.duration_s, sketch.outputs) = (1e6, 20);
        let result = sketch.run(kind);
        kept(&result, kind.name);
        let entered = through(&result, "right");
        let last = rate(&sketch, &entered);
        assert!((last / FULL - 1.0).abs() < 1e-3, "{}: {last}", kind.name);
        let off = read(&result, "ran_off_right_m3");
        assert!((rate(&sketch, &off) / (2.0 * FULL) - 1.0).abs() < 1e-3, "{}", kind.name);
        let rained = 3.0 * FULL * sketch.duration_s;
        assert!((off[19] + entered[19] - rained).abs() < 1e-9 * rained);
        // Less runs off before the ground is full.
        assert!(off[0] < (off[19] - off[0]) / 19.0, "{}: {off:?}", kind.name);
    }
}

/// A rain without end in sight is a wall of saturated ground, and water that stands on it one of a head.
#[test]
fn a_flood_is_a_wall_of_its_head() {
    for kind in even() {
        for (depth, flood) in [("0", "rain_m_per_s = 1"), ("0.05", "rain_m_per_s = 1\nponding_m = 0.05")] {
            let run = |line: &str| {
                let mut sketch = column(0.01).wall("right", line);
                sketch.duration_s = 2e4;
                let result = sketch.run(kind);
                kept(&result, kind.name);
                *through(&result, "right").last().expect("an output")
            };
            let (held, flooded) = (run(&format!("head_m = {depth}")), run(flood));
            assert!((flooded / held - 1.0).abs() < 0.02, "{} {depth}: {flooded} {held}", kind.name);
        }
    }
}

/// What has run off after the ground has become full, which tells when it has, is that of a run four times as fine to a thousandth.
#[test]
fn the_time_of_ponding_is_that_of_finer_runs() {
    for kind in even() {
        let off = |spacing: f64| {
            let rain = format!("rain_m_per_s = {}", 4.0 * FULL);
            let mut sketch = column(spacing).wall("right", rain).with("tolerance = 1e-6");
            sketch.duration_s = 1.5e4;
            let result = sketch.run(kind);
            kept(&result, kind.name);
            *read(&result, "ran_off_right_m3").last().expect("an output")
        };
        let (own, fine) = (off(0.0125), off(0.003_125));
        eprintln!("{}: {own:e} {fine:e}", kind.name);
        assert!(fine > 0.0 && (own / fine - 1.0).abs() < 1e-3, "{}: {own} {fine}", kind.name);
    }
}

/// Between a head and a face at which it seeps out, water flows as between that head and none: nothing leaves before, and all that
/// enters leaves in the end.
#[test]
fn water_seeps_out_when_it_has_come_through() {
    for kind in even() {
        let mut sketch = column(0.02).wall("left", "head_m = 0.3").wall("right", "condition = \"seepage\"");
        sketch.gravity = String::new();
        (sketch.duration_s, sketch.outputs) = (4e5, 40);
        let result = sketch.run(kind);
        kept(&result, kind.name);
        let left = through(&result, "right");
        // Rounding of a rain of none where mirrors let water through.
        assert!(left[0].abs() < 1e-15, "{}: {}", kind.name, left[0]);
        assert!(left.iter().all(|left| *left < 1e-15), "{}: {left:?}", kind.name);
        let steady = FULL * 0.3 / 0.5;
        for wall in [rate(&sketch, &through(&result, "left")), -rate(&sketch, &left)] {
            assert!((wall / steady - 1.0).abs() < 1e-6, "{}: {wall} {steady}", kind.name);
        }
        assert!((read(&result, "ran_off_right_m3")[39] + left[39]).abs() < 1e-15);
    }
}

/// Under gravity the face below lets out what rains in above, and the ground there is just full.
#[test]
fn a_column_drains_through_a_face_below() {
    for kind in even() {
        let rain = 0.3 * FULL;
        let mut sketch =
            column(0.01).wall("right", format!("rain_m_per_s = {rain}")).wall("left", "condition = \"seepage\"");
        (sketch.duration_s, sketch.outputs) = (4e6, 20);
        let result = sketch.run(kind);
        kept(&result, kind.name);
        let left = -rate(&sketch, &through(&result, "left"));
        assert!((left / rain - 1.0).abs() < 1e-3, "{}: {left}", kind.name);
        let end = result.profiles.last().expect("a profile").time_s;
        let lowest = result.profiles.iter().find(|row| row.time_s == end).expect("a row").temperature_c;
        assert!(lowest > 0.995, "{}: {lowest}", kind.name);
    }
}

/// Showers: nothing enters between them, what stands on the ground is gone at once, and each one enters anew.
#[test]
fn rain_comes_and_goes() {
    for (kind, carries) in even().flat_map(|kind| [(kind, false), (kind, true)]) {
        let mut showers = format!(
            "rain_m_per_s = {{ times_s = [0, 9990, 10000, 39990, 40000], values = [{0}, {0}, 0, 0, {0}], period_s = 40000 }}",
            3.0 * FULL
        );
        if carries {
            showers.push_str("\nconcentration = 1");
        }
        let mut sketch = column(0.01).wall("right", showers).wall("left", "condition = \"free-drainage\"");
        (sketch.duration_s, sketch.outputs) = (1.2e5, 12);
        sketch.materials = vec![("sand", if carries { soil_with_solute() } else { soil() })];
        let result = sketch.run(kind);
        kept(&result, kind.name);
        let entered = through(&result, "right");
        let by_interval: Vec<f64> = entered.windows(2).map(|pair| pair[1] - pair[0]).collect();
        for (number, gained) in by_interval.iter().enumerate() {
            let shower = (number + 1) % 4 == 0;
            // The ramp before a shower lasts ten seconds.
            let most = 3.0 * FULL * 10.0;
            assert!(
                if shower { *gained > 1e-3 } else { (-1e-12..most).contains(gained) },
                "{}: {by_interval:?}",
                kind.name
            );
        }
        let off = read(&result, "ran_off_right_m3");
        assert!(off.windows(2).all(|pair| pair[1] >= pair[0] - 1e-7), "{}: {off:?}", kind.name);
    }
}

/// Rain brings its concentration with all that enters and nothing else; water that seeps out takes along that of the ground.
#[test]
fn rain_brings_a_solute_and_seepage_takes_it() {
    for kind in even() {
        for (line, brought, start) in [("concentration = 0.5\n", 0.5, 0.5), ("", 0.0, 1.0)] {
            let mut sketch = column(0.02)
                .wall("right", format!("{line}rain_m_per_s = {}", 3.0 * FULL))
                .wall("left", "condition = \"seepage\"");
            sketch.materials = vec![("sand", soil_with_solute())];
            (sketch.duration_s, sketch.outputs) = (4e5, 4);
            let text =
                sketch.text(kind.name).replace("head_m = -1\n", &format!("head_m = -1\nconcentration = {start}\n"));
            let scene = frazil_scene::Scene::read(&text, "sketch", "sketch", &[], &[kind]).expect("a scene");
            let options = frazil_simulation::march::Options::default();
            let result = frazil_simulation::march::run(&scene, kind.name, None, &options).expect("a run");
            kept(&result, kind.name);
            let entered = *through(&result, "right").last().expect("an output");
            let solute = *read(&result, "solute_in_right_m3").last().expect("an output");
            assert!((solute - brought * entered).abs() < 1e-9 * entered, "{}: {solute} {entered}", kind.name);
            let taken = *read(&result, "solute_in_left_m3").last().expect("an output");
            assert!(taken < 0.0, "{}: {taken}", kind.name);
            let concentrations = result.profiles.iter().filter_map(|row| row.concentration);
            for concentration in concentrations.filter(|_| start == brought) {
                assert!((concentration - start).abs() < 1e-9, "{}: {concentration}", kind.name);
            }
        }
    }
}
