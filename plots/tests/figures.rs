//! Every figure from made-up records: they must be drawn without any font of the machine.
//!
//! With `FRAZIL_FIGURES=folder` the files stay there to be looked at.

use frazil_plots::canvas::Formats;
use frazil_plots::comparison::{WorkCurve, WorkFigure, WorkPoint, work_precision_panels};
use frazil_plots::convergence::{OrderCurve, convergence};
use frazil_plots::ground_plan::{GroundPlan, ShaftMark, WaterMark};
use frazil_plots::moisture_map::{CrackMark, Outlines};
use frazil_plots::run::drawings;
use frazil_plots::{FigureOptions, run_figures};
use frazil_record::{
    Field, FrontRow, GapRow, Outcome, ProfileRow, Record, Role, RunResult, Table, TimeUnit, Unit, WallRow,
};

#[path = "figures/layouts.rs"]
mod layouts;

const ALL: Formats = Formats::ALL;

fn record(title: &str, method: &str) -> Record {
    Record {
        frazil_version: "0.1.0".into(),
        scene: "made-up".into(),
        title: title.into(),
        scene_hash: "0".into(),
        method: method.into(),
        units: "si".into(),
        particles: 200,
        pairs: 600,
        steps: 1000,
        pair_evaluations: 600_000,
        particle_updates: 200_000,
        step_s: 1.0,
        step_bound_s: 1.1,
        step_limit: "diffusion".into(),
        threads: 1,
        seed: 1,
        setup_wall_s: 0.01,
        setup_cpu_s: 0.01,
        solve_wall_s: 1.0,
        solve_cpu_s: 1.0,
        outcome: Outcome::Ok,
        energy_balance_rel: 1e-14,
        bounds_violation_rel: Some(0.0),
        state_hash: "0123456789abcdef".into(),
        ..Record::default()
    }
}

fn empty(title: &str, method: &str) -> RunResult {
    RunResult { ..RunResult::bare(record(title, method)) }
}

fn line_run() -> RunResult {
    let mut run = empty("Freezing of water in a half space (Neumann)", "pd");
    for k in 1..=120 {
        let time = 7200.0 * f64::from(k) / 120.0;
        let exact = 0.0004 * time.sqrt();
        let wiggle = 1.0 + 0.01 * (-f64::from(k) / 30.0).exp() * (f64::from(k) / 3.0).sin();
        run.front.push(FrontRow { time_s: time, front_m: exact * wiggle, front_ref_m: Some(exact) });
    }
    for time in [720.0, 2880.0, 7200.0] {
        let front = 0.0004 * f64::sqrt(time);
        for k in 0..100 {
            let x = 0.001 * (f64::from(k) + 0.5);
            let exact = if x < front { -10.0 * (1.0 - x / front) } else { 4.0 * (1.0 - (-(x - front) / 0.02).exp()) };
            run.profiles.push(ProfileRow {
                time_s: time,
                x_m: Some(x),
                temperature_c: exact + 0.15 * (x * 300.0).sin(),
                temperature_ref_c: Some(exact),
                frozen_fraction: f64::from(u8::from(x < front)),
                concentration: None,
                concentration_ref: None,
                plane: "line".into(),
                y_m: None,
                along_m: x,
                mean_over: None,
            });
        }
    }
    run
}

fn ring_run() -> RunResult {
    let mut run = empty("Ring of 26 freeze pipes in sand", "sph");
    for k in 1..=80 {
        let day = f64::from(k);
        let closed = (day - 15.0).max(0.0).sqrt() * 0.28;
        run.walls.push(WallRow {
            time_s: day * 86400.0,
            thickness_main_mean_m: Some(0.3 * day.sqrt()),
            thickness_main_mean_ref_m: Some(0.303 * day.sqrt()),
            thickness_interface_mean_m: Some(closed),
            thickness_interface_mean_ref_m: Some(closed * 1.02),
            frozen_area_m2: day,
            frozen_area_ref_m2: None,
            heat_per_pipe_w_per_m: 80.0 + 400.0 / day.sqrt(),
            closed: None,
            thickness_weakest_m: None,
        });
    }
    for gap in 0..7 {
        run.gaps.push(GapRow {
            gap,
            from: format!("1.{}", gap + 1),
            to: format!("1.{}", gap + 2),
            angle_deg: Some(6.9 + 13.8 * gap as f64),
            along_m: None,
            multiplicity: 4,
            closure_s: (gap != 5).then_some(86400.0 * (15.5 + 0.1 * (gap % 3) as f64)),
            closure_ref_s: Some(86400.0 * 15.4),
        });
    }
    let (n, spacing) = (180, 0.05);
    let mut temperature_c = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let (x, y) = (spacing * (i as f64 + 0.5), spacing * (j as f64 + 0.5));
            let radius = x.hypot(y);
            let mut value = 12.0;
            for k in 0..26 {
                let angle = std::f64::consts::TAU * (f64::from(k) + 0.5) / 26.0;
                let distance = (x - 5.5 * angle.cos()).hypot(y - 5.5 * angle.sin()).max(0.054);
                value -= 3.1 * (-distance / 1.2).exp() * (1.2 / distance).min(6.0);
            }
            temperature_c.push(if radius > 9.0 { f64::NAN } else { value.max(-28.0) });
        }
    }
    run.fields.push(Field {
        time_s: 40.0 * 86400.0,
        nx: n,
        ny: n,
        x0_m: 0.025,
        y0_m: 0.025,
        spacing_m: spacing,
        // Soft over some tenths of a kelvin, as in ground that freezes in an interval.
        frozen_fraction: temperature_c.iter().map(|value| (-0.2 - value).clamp(0.0, 0.6) / 0.6).collect(),
        temperature_c,
        concentration: Vec::new(),
        temperature_ref_c: Vec::new(),
    });
    run
}

fn comparison() -> WorkFigure {
    let curve = |method: &str, label: &str, second: bool, errors: &[f64], first: f64| WorkCurve {
        method: method.into(),
        label: label.into(),
        second,
        points: errors
            .iter()
            .enumerate()
            .map(|(k, error)| WorkPoint {
                error: Some(*error),
                cost: Some(first * 7.5f64.powi(k as i32)),
                error_range: (method == "edpd").then_some((0.8 * error, 1.25 * error)),
                cost_range: Some((first * 7.5f64.powi(k as i32) * 0.9, first * 7.5f64.powi(k as i32) * 1.2)),
                hollow: *error < 4e-4,
                ringed: method == "sph" && k == 1,
                on_front: !(method == "sph" && k == 1),
            })
            .collect(),
    };
    let mut pd = curve("pd", "PD best", false, &[0.027, 0.013, 0.0067, 0.0034], 0.011);
    pd.points.push(WorkPoint {
        error: None,
        cost: Some(30.0),
        error_range: None,
        cost_range: None,
        hollow: false,
        ringed: false,
        on_front: false,
    });
    WorkFigure {
        title: "Freezing of water in a half space (Neumann): front".into(),
        error_label: "rms error of the front".into(),
        cost_label: "wall time, one thread (s)".into(),
        marked: Some((6e-5, "error of the reference")),
        curves: vec![
            pd,
            curve("pd", "PD paper", true, &[0.10, 0.052, 0.027, 0.0141], 0.012),
            curve("sph", "SPH best", false, &[0.008, 0.0011, 0.002, 0.0005], 0.006),
            curve("edpd", "eDPD best, mean of 10 runs", false, &[0.08, 0.035, 0.02], 0.5),
            curve("edpd", "eDPD best, single run", true, &[0.13, 0.06, 0.04], 0.05),
            curve("local", "local best", false, &[0.003, 0.0014, 0.0007, 0.0003], 0.002),
        ],
    }
}

#[test]
fn all_figures_are_drawn_without_a_font_of_the_machine() -> Result<(), Box<dyn std::error::Error>> {
    let temporary = tempfile::tempdir()?;
    let folder = std::env::var_os("FRAZIL_FIGURES").map_or(temporary.path().to_path_buf(), Into::into);
    let mut files = run_figures(&line_run(), &folder, &plain(TimeUnit::Hour), ALL)?;
    files.extend(run_figures(
        &ring_run(),
        &folder,
        &FigureOptions { freezing_point: Some(-0.5), ..plain(TimeUnit::Day) },
        ALL,
    )?);
    let figure = comparison();
    files.extend(work_precision_panels(std::slice::from_ref(&figure)).write(&folder, "work_precision", ALL)?);
    let orders: Vec<OrderCurve> = figure
        .curves
        .iter()
        .map(|curve| OrderCurve {
            method: curve.method.clone(),
            label: curve.label.clone(),
            second: curve.second,
            points: curve
                .points
                .iter()
                .enumerate()
                .filter_map(|(k, point)| Some((0.008 * 0.5f64.powi(k as i32), point.error?, point.hollow)))
                .collect(),
        })
        .collect();
    files.extend(convergence("Convergence", "particle spacing (mm)", 1e3, "rms error of the front", &orders).write(
        &folder,
        "convergence",
        ALL,
    )?);
    let names: Vec<String> = files.iter().filter_map(|path| Some(path.file_stem()?.to_str()?.into())).collect();
    for name in ["front", "profiles", "wall", "heat", "gaps", "map_40d", "work_precision", "convergence"] {
        assert_eq!(names.iter().filter(|other| *other == name).count(), 3, "{name} in {names:?}");
    }
    for path in files {
        let size = std::fs::metadata(&path)?.len();
        assert!(size > 2000 && size < 600_000, "{}: {size} bytes", path.display());
    }
    Ok(())
}

/// Options of a run of which nothing is known but its unit of time.
fn plain(time_unit: TimeUnit) -> FigureOptions {
    FigureOptions {
        name: None,
        plan: Default::default(),
        unsaturated: None,
        ground: Vec::new(),
        time_unit,
        freezing_point: Some(0.0),
        axes: ("x", "y"),
        pressures: (0.0, 0.0),
        cut: 0.0,
    }
}

#[test]
fn a_run_without_rows_has_no_figures() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let options = plain(TimeUnit::Second);
    assert!(run_figures(&empty("nothing", "pd"), folder.path(), &options, ALL)?.is_empty());
    Ok(())
}

/// The figure of a table has a panel for each of its columns with a value, by its words and unit, and a curve for each key.
#[test]
fn a_table_is_drawn_by_what_it_says_of_itself() {
    let columns = [
        ("isotherm_c", "isotherm", Unit::Celsius, Role::Key),
        ("depth_m", "depth", Unit::Metre, Role::Value),
        ("colder_m2", "colder area", Unit::SquareMetre, Role::Sum),
        ("length_m", "length", Unit::Metre, Role::Sum),
    ];
    let mut table = Table::over_time("isotherms.csv", "Isotherms", &columns, 4);
    for (time, isotherm) in [(3600.0, -1.0), (3600.0, 2.0), (7200.0, -1.0), (7200.0, 2.0)] {
        table.rows.push(vec![Some(time), Some(isotherm), Some(1e-5 * time), Some(time), None]);
    }
    let run = |units: &str| {
        let mut run = empty("a slab", "pd");
        run.record.units = units.into();
        run.tables = vec![table.clone()];
        let options = plain(TimeUnit::Hour);
        let all = drawings(&run, &options);
        assert_eq!(all.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["isotherms"]);
        all[0].1.svg()
    };
    let (own, bare) = (run("si"), run("dimensionless"));
    for words in ["isotherm −1 °C", "isotherm 2 °C", "depth (mm)", "colder area (m²)", "time (h)"] {
        assert!(own.contains(words), "{words}");
    }
    assert!(!own.contains("length") && bare.contains("depth (dimensionless)"));
}

/// A map of a layout has its name, its shaft, and the water that crosses it.
#[test]
fn a_map_names_its_layout_and_shows_shaft_and_water() {
    let map = |dug: Option<f64>, plan: bool| {
        let water = WaterMark { speeds: vec![(0.0, 0.1 / 86_400.0)], direction: (0.6, 0.8) };
        let shaft = Some(ShaftMark { radius: 3.5, dug });
        let marks = GroundPlan { pipes: vec![(5.0, 0.0, 0.1)], shaft, water: Some(water) };
        let options = FigureOptions {
            name: plan.then(|| "26 pipes, dug late".into()),
            plan: if plan { marks } else { GroundPlan::default() },
            freezing_point: Some(-0.5),
            ..plain(TimeUnit::Day)
        };
        let maps = drawings(&ring_run(), &options).into_iter().find(|(name, _)| name.starts_with("map_"));
        maps.expect("a map").1.svg()
    };
    let bare = map(None, false);
    for words in ["shaft", "groundwater", "26 pipes"] {
        assert!(!bare.contains(words), "{words}");
    }
    let early = map(Some(1e9), true);
    for words in ["26 pipes, dug late", ">shaft<", "groundwater, 0.1 m/day"] {
        assert!(early.contains(words), "{words} in {early}");
    }
    assert!(map(Some(0.0), true).contains("shaft, excavated"));
}

/// Where nothing freezes, no figure speaks of a freezing point, and axes reach to the temperatures alone.
#[test]
fn a_body_that_does_not_freeze_has_no_freezing_point() {
    let svgs = |freezing_point: Option<f64>| {
        let options = FigureOptions { freezing_point, ..plain(TimeUnit::Hour) };
        let mut run = line_run();
        run.fields = ring_run().fields;
        run.fields.iter_mut().for_each(|field| field.frozen_fraction.clear());
        let shown = |name: &str| name == "profiles" || name.starts_with("map_");
        let drawn = drawings(&run, &options).into_iter().filter(|(name, _)| shown(name));
        drawn.map(|(_, canvas)| canvas.svg()).collect::<Vec<_>>()
    };
    let [without, far] = [None, Some(-500.0)].map(svgs);
    assert!(without.len() > 1 && without.iter().all(|svg| !svg.contains("freezing point") && !svg.contains("−500")));
    assert!(far.iter().all(|svg| svg.contains("freezing point")) && far[0].contains("−500"));
}

/// A body that is even at the edge of a colour, as it was at the start, has one colour, whatever its rounding.
#[test]
fn rounding_of_an_even_body_is_not_drawn() {
    let areas = |rounding: f64| {
        let mut run = ring_run();
        for field in &mut run.fields {
            for (k, value) in field.temperature_c.iter_mut().enumerate() {
                let (x, y) = ((k % field.nx) as f64 / field.nx as f64, (k / field.nx) as f64 / field.ny as f64);
                let cooled = 20.0 * (-40.0 * (x * x + y * y)).exp();
                *value = if cooled > 0.1 { 5.0 - cooled } else { 5.0 + rounding * f64::from((k * k % 7) as i32 - 3) };
            }
            field.frozen_fraction.clear();
        }
        let options = FigureOptions { freezing_point: Some(-0.5), ..plain(TimeUnit::Day) };
        let map = drawings(&run, &options).into_iter().find(|(name, _)| name.starts_with("map_")).expect("a map");
        map.1.svg().matches("<path").count()
    };
    assert_eq!(areas(1e-13), areas(0.0));
    assert!(areas(1.0) > areas(0.0) + 10);
}

/// Where the reference has a map, it stands beside that of the run, and the difference beside both.
#[test]
fn maps_stand_beside_those_of_the_reference() {
    let options = FigureOptions { freezing_point: Some(-0.5), ..plain(TimeUnit::Day) };
    let map = |run: &RunResult| {
        let maps = drawings(run, &options).into_iter().find(|(name, _)| name.starts_with("map_"));
        maps.map(|(_, canvas)| canvas)
    };
    let mut run = ring_run();
    let alone = map(&run).map(|canvas| canvas.width);
    for field in &mut run.fields {
        field.temperature_ref_c = field.temperature_c.iter().map(|value| 0.9 * value).collect();
    }
    let beside = map(&run);
    assert_eq!(beside.as_ref().map(|canvas| canvas.width), alone.map(|width| 3.0 * width));
    let svg = beside.map(|canvas| canvas.svg()).unwrap_or_default();
    assert!(svg.contains("Reference, 40 d") && svg.contains("Difference, 40 d"));
    // The same field as its own reference differs nowhere, and is drawn.
    for field in &mut run.fields {
        field.temperature_ref_c = field.temperature_c.clone();
    }
    assert!(map(&run).is_some_and(|canvas| canvas.svg().len() > 2000));
}

/// A run of unsaturated water with a solute, on a plane with a crack.
fn wet_run() -> RunResult {
    let mut run = empty("Wetting", "pd");
    let row = |x: f64| ProfileRow {
        time_s: 86_400.0,
        x_m: Some(x),
        temperature_c: 1.0 - x,
        temperature_ref_c: Some(0.9 - 0.9 * x),
        frozen_fraction: x,
        concentration: Some(0.5 - 0.5 * x),
        concentration_ref: None,
        plane: "line".into(),
        y_m: None,
        along_m: x,
        mean_over: None,
    };
    run.profiles = (0..=10).map(|k| row(0.1 * f64::from(k))).collect();
    run.front = [1.0, 2.0].map(|t| FrontRow { time_s: t * 86_400.0, front_m: 0.1 * t, front_ref_m: None }).into();
    let cells = || (0..100).map(|k| f64::from(k % 10) / 9.0);
    run.fields.push(Field {
        time_s: 86_400.0,
        nx: 10,
        ny: 10,
        x0_m: 0.05,
        y0_m: 0.05,
        spacing_m: 0.1,
        temperature_c: cells().map(|x| 1.0 - x).collect(),
        frozen_fraction: cells().collect(),
        concentration: cells().map(|x| 0.8 - 0.8 * x).collect(),
        temperature_ref_c: Vec::new(),
    });
    run
}

#[test]
fn figures_of_water_speak_of_water() {
    let crack = CrackMark { from: (0.2, 0.2), tips: vec![(86_400.0, (0.2, 0.6))] };
    let closed = CrackMark { from: (0.8, 0.2), tips: Vec::new() };
    let rim = vec![(0.6, 0.6), (0.8, 0.6), (0.7, 0.8), (0.6, 0.6)];
    let outlines = |cracks: Vec<CrackMark>| Outlines { regions: vec![rim.clone()], cracks };
    let options = |cracks| FigureOptions { unsaturated: Some(outlines(cracks)), ..plain(TimeUnit::Day) };
    let all = drawings(&wet_run(), &options(vec![crack]));
    let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["front", "profiles", "map_1d", "concentration_1d"]);
    for (name, canvas) in &all {
        let svg = canvas.svg();
        assert!(!svg.contains("°C") && !svg.contains("freezing") && !svg.contains("frozen"), "{name}");
    }
    let svg = |k: usize| all[k].1.svg();
    assert!(svg(0).contains("wetted length"));
    assert!(svg(1).contains("effective saturation (1)") && svg(1).contains("concentration (1)"));
    assert!(svg(2).contains("half saturated") && svg(3).contains("concentration (1)"));
    // A crack is drawn once it is open.
    let map = |cracks| drawings(&wet_run(), &options(cracks))[2].1.clone();
    assert_eq!(map(vec![closed]), map(Vec::new()));
    assert_ne!(map(Vec::new()), all[2].1);
}
