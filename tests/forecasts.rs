//! What is said of a run beforehand: its memory against what the allocator handed out, its steps against those made.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use frazil::registry::methods;
use frazil_cases::scenes::BundledScene;
use frazil_core::space::domain::{Domain, Sector};
use frazil_scene::method::MethodKind;
use frazil_scene::{Scene, Units};
use frazil_simulation::march::{self, Options};
use frazil_simulation::plan;
use frazil_simulation::predict::{StepCount, forecast};

use crate::counting::{live, most};
use crate::sketch::{Sketch, sand};

/// Names, causes and differences in words, boxes, shared counters: what is not counted (bytes).
const SMALL: f64 = 6000.0;

fn assert_counted(name: &str, scene: &Scene) {
    let before = live();
    let plan = plan::build(scene, &scene.methods[0], None, 1, 1).unwrap_or_else(|refused| unreachable!("{refused}"));
    let held = (live() - before) as f64;
    let counted = (plan.summary.memory.particles + plan.summary.memory.method) as f64;
    assert!((counted..counted + SMALL).contains(&held), "{name}: {counted} bytes counted, {held} held");
}

#[test]
fn a_plan_counts_what_it_holds() {
    let law = "law = \"weibull\", width_K = 1, latent_heat_J_per_kg = 50000, temperature_c = 0";
    for kind in methods() {
        for domain in [
            Domain::Line { length: 40.0 },
            Domain::Rectangle { width: 4.0, height: 3.0 },
            Domain::Ring { outer_radius: 4.0, sector: Sector::Half },
        ] {
            let sketch = Sketch::new(domain, 0.05);
            let mut ring = sketch.clone();
            if matches!(domain, Domain::Ring { .. }) {
                ring.pipes = vec!["count = 8\nring_radius_m = 2\npipe_radius_m = 0.05\ntemperature_c = -20".into()];
            }
            let mut mixed = sketch.clone();
            mixed.materials = vec![("sand", sand(law)), ("clay", sand(law))];
            let y = if domain.dimension() == 2 { "\ny_min_m = 0\ny_max_m = 1" } else { "" };
            mixed.regions = vec![format!("material = \"clay\"\nx_min_m = 1\nx_max_m = 2{y}")];
            let mut variants = vec![
                ("plain", sketch.clone()),
                ("pipes", ring),
                ("materials", mixed),
                ("list", sketch.clone().with("search = \"cells\"")),
                ("mean", sketch.clone().with("mean = \"harmonic\"\nmushy = false")),
                ("flags", sketch.clone().with("scheme = \"flags\"")),
            ];
            if !kind.stochastic {
                variants.push(("rkl2", sketch.clone().with("integrator = \"rkl2\"\nstages = 5")));
            }
            if !kind.lattice_only {
                variants.push(("cloud", sketch.with("layout = \"jittered\"\njitter_fraction = 0.2")));
            }
            for (name, sketch) in variants {
                assert_counted(&format!("{} {name} {domain:?}", kind.name), &sketch.scene(kind));
            }
        }
    }
}

/// The most that a run holds at once, its preparation and its results included, is what was counted before: to a tenth,
/// which leaves room for what only the preparation holds.
#[test]
fn a_forecast_counts_what_a_run_holds() {
    for (name, finer) in [
        ("stefan-water", 1.0),
        ("stefan-unit", 1.0),
        ("soil-column", 1.0),
        ("stefan-dpd-1", 1.0),
        ("frozen-wall-clay", 1.0),
        ("frozen-wall-sand", 2.0),
    ] {
        let bundled = frazil_cases::scenes::find(name).expect("bundled");
        for kind in methods() {
            let scene = shortened(bundled, kind, finer);
            let reference = frazil_cases::truth(&scene).expect("a reference").reference.map(Arc::from);
            let expected = forecast(&scene, kind.name, reference.as_ref(), 1, 1).expect("a forecast");
            let options = Options { fields: true, ..Options::default() };
            let (result, held) = most(|| march::run(&scene, kind.name, reference.as_ref(), &options));
            let result = result.expect("a run");
            let (forecast, made) = (expected.summary.steps, result.record.steps);
            match forecast {
                StepCount::Planned(steps) => assert_eq!(steps, made, "{name} {}", kind.name),
                // Steps by error, from those of a trial.
                StepCount::ByErrorControl { .. } => {
                    let ratio = forecast.number().expect("a number") as f64 / made as f64;
                    assert!((0.5..2.0).contains(&ratio), "{name} {}: {forecast}, and {made}", kind.name);
                }
            }
            let ratio = expected.summary.memory.total() as f64 / held as f64;
            assert!((0.9..1.1).contains(&ratio), "{name}, {}: {ratio} of {held} bytes", kind.name);
        }
    }
}

/// Steps are shortened to land on outputs and profiles, and grow where the integrator asks for it.
#[test]
fn the_steps_of_a_run_are_counted_beforehand() {
    for numerics in
        ["integrator = \"euler\"", "integrator = \"rkl2\"\nstages = 7", "step_s = 1000", "step_fraction = 0.37"]
    {
        for (outputs, duration_s) in [(1, 40_000.0), (7, 654_321.0), (400, 1e6)] {
            for kind in methods().iter().filter(|kind| !kind.stochastic) {
                let mut sketch = Sketch::new(Domain::Line { length: 5.0 }, 0.1).with(numerics);
                (sketch.outputs, sketch.duration_s) = (outputs, duration_s);
                let planned = sketch.plan(kind).summary.steps.number();
                let made = sketch.run(kind).record.steps;
                assert_eq!(planned, Some(made), "{} {numerics} {outputs}", kind.name);
            }
        }
    }
}

/// A bundled scene with all its outputs, in a hundredth of its time.
fn shortened(bundled: &BundledScene, kind: &MethodKind, finer: f64) -> Scene {
    const SHARE: f64 = 0.01;
    let read = |overrides: &[(String, String)]| {
        Scene::read(bundled, bundled.name, bundled.name, overrides, methods())
            .unwrap_or_else(|problems| unreachable!("{problems}"))
    };
    let own = read(&[]);
    let spacing = own.method(kind.name).expect("settings").numerics.spacing / finer;
    let key = if own.units == Units::Si { "spacing_m" } else { "spacing" };
    let mut scene = read(&[(format!("method.{}.{key}", kind.name), spacing.to_string())]);
    scene.duration *= SHARE;
    scene.watch.front_from = scene.watch.front_from.map(|from| SHARE * from);
    scene.watch.profiles.iter_mut().for_each(|instant| *instant *= SHARE);
    scene
}

/// What a command says on standard error up to its warning that it takes long, if it does; it is stopped there.
fn warned(arguments: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_frazil"));
    command.args(arguments.split(' ')).current_dir(folder.path()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let (tell, told) = mpsc::channel();
    std::thread::spawn(move || lines.map_while(Result::ok).try_for_each(|line| tell.send(line)));
    let mut said = String::new();
    while let Ok(line) = told.recv_timeout(Duration::from_secs(60)) {
        said.push_str(&line);
        said.push('\n');
        if line.contains("this will take") {
            break;
        }
    }
    child.kill().and_then(|()| child.wait()).expect("ended");
    said
}

/// Every command that takes more than ten minutes says so before it starts, on any machine; the same of a few seconds says nothing.
#[test]
fn what_takes_more_than_ten_minutes_says_so_before_it_starts() {
    // Hours or days on any machine, and less than the thirty days from which on nothing is begun: each command is stopped once it has
    // said so.
    let long = "--set time.duration_days=4000000";
    let sand = format!("--method local --set method.local.spacing_m=0.05 {long}");
    let of_stefan = "--set time.duration_h=1e7 --set time.profiles_h=[] --set watch.front_from_h=1";
    for (command, what) in [
        (format!("run frozen-wall-sand {sand}"), "frozen-wall-sand with local: "),
        (format!("run frozen-wall-sand --method edpd --seeds 5 {long}"), "frozen-wall-sand with edpd, 5 members: "),
        (format!("layout shaft-single-sand {sand}"), "shaft-single-sand: "),
        (format!("layout shaft-search {sand}"), "shaft-search: "),
        (format!("layout shaft-deviation {sand}"), "shaft-deviation: "),
        (format!("stability stefan-water --methods local --axes own --time-limit-s 1e6 {of_stefan}"), "stability: "),
        ("compare stefan-water --budget-s 4000".to_owned(), "compare, at most 67 min for each scene: "),
        (
            "compare stefan-water --vary spacing,horizon_ratio --budget-s 4000".to_owned(),
            "compare, at most 67 min for each scene: ",
        ),
        ("properties water --temperatures-c 25 --seeds 1000".to_owned(), "properties: "),
        ("properties water --equilibrium --effort 100".to_owned(), "properties: "),
    ] {
        let said = warned(&command);
        let last = said.lines().last().unwrap_or_default();
        assert!(last.starts_with(&format!("{what}this will take ")), "{command}: {said}");
    }
    for short in [
        // Of the smaller scene that is run, and not of the one that it stands for.
        "run soil-column-printed --method pd --reduce --threads 1 --set time.duration_h=200",
        "stability stefan-water --methods local --axes own --grid 2",
        "layout shaft-single-sand --method local --set method.local.spacing_m=0.3 --set time.duration_days=5 --set \
         time.profiles_days=[5]",
    ] {
        let said = warned(short);
        assert!(!said.contains("this will take"), "{short}: {said}");
    }
}
