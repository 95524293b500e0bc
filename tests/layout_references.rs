//! Layouts beside their reference tables, pipes of one particle, and parts of the plan beside the whole.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Output};

use frazil_record::RunResult;
use frazil_scene::Scene;
use frazil_scene::method::acting_radius;
use frazil_simulation::march::{self, Options};

use crate::sketch::bundled;

type Row = BTreeMap<String, String>;

fn run(folder: &Path, arguments: &[&str], changes: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frazil"));
    command.arg("layout").args(arguments).args(["--quiet", "--out", "out"]);
    command.args(changes.iter().flat_map(|change| ["--set", change]));
    command.current_dir(folder).output().expect("the program starts")
}

fn rows(folder: &Path, name: &str) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(folder.join("out").join(name)).expect("a table");
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

fn number(row: &Row, key: &str) -> f64 {
    row[key].parse().unwrap_or_else(|_| unreachable!("{key}: {row:?}"))
}

fn ring(changes: &[(&str, &str)]) -> Scene {
    bundled("frozen-wall-sand", changes)
}

fn result(scene: &Scene, method: &str) -> RunResult {
    march::run(scene, method, None, &Options { fields: true, ..Options::default() }).expect("a run")
}

/// The same pipe closes the ring on the same day under every method: within 3 % of tables for pipes that are wider than a
/// particle and far thinner than one.
#[test]
fn pipes_of_every_radius_close_as_the_tables_say_under_every_method() {
    for method in ["local", "sph", "pd"] {
        let folder = tempfile::tempdir().expect("a folder");
        let arguments = ["shaft-pipe-radius", "--method", method];
        let output = run(folder.path(), &arguments, &["time.duration_days=45", "time.profiles_days=[45]"]);
        assert!(output.status.success(), "{output:?}");
        let found = rows(folder.path(), "reference.csv");
        let touches: Vec<&Row> = found.iter().filter(|row| row["quantity"] == "closure_touch_days").collect();
        assert_eq!(touches.len(), 5);
        for row in touches {
            assert!(number(row, "difference_percent").abs() < 3.0, "{method}: {row:?}");
        }
        // Energy once the ground in place of the pipe, which freezes with the rest, has become a small part of it.
        for row in found.iter().filter(|row| !row["day"].is_empty() && number(row, "day") >= 20.0) {
            let within = match row["quantity"].as_str() {
                "heat_per_pipe_w_per_m" => 2.0,
                "energy_mj_per_m" => 1.0,
                _ => continue,
            };
            assert!(number(row, "difference_percent").abs() < within, "{method}: {row:?}");
        }
    }
}

#[test]
fn references_of_other_problems_are_refused_with_the_first_difference() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = |reference: &str, set: &str| {
        let text = format!(
            "title = \"t\"\nscene = \"frozen-wall-sand\"\n[[layouts]]\nname = \"a\"\nreference = \"{reference}\"\nset = {{ {set} }}"
        );
        std::fs::write(folder.path().join("s.toml"), text).expect("written");
        let output = run(folder.path(), &["s.toml", "--method", "local"], &[]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(!folder.path().join("out").exists());
        String::from_utf8_lossy(&output.stderr).trim_end().to_owned()
    };
    let other = |name: &str| format!("layout \"a\": reference: the table '{name}' is about another problem: ");
    for (name, set, difference) in [
        ("shaft-single-clay-54mm", "", "the density is 2050 there and 2090 here"),
        ("shaft-single-sand-80mm", "", "the pipe radius is 0.08 there and 0.054 here"),
        ("shaft-three-sand-54mm", "", "the number of pipe circles is 2 there and 1 here"),
        ("shaft-single-sand-54mm", "\"pipes.1.count\" = 24", "the number of pipes is 26 there and 24 here"),
        ("shaft-single-sand-54mm", "\"pipes.1.missing\" = [\"1.4\"]", "all pipes are at their design positions there"),
        ("shaft-single-sand-54mm", "\"domain.ring.outer_radius_m\" = 8", "the outer radius is 15 there and 8 here"),
        ("shaft-single-sand-54mm", "\"initial.temperature_c\" = 12", "the initial temperature is 15 there and 12 here"),
        ("shaft-groundwater", "", "water flows across the ring there"),
    ] {
        assert_eq!(study(name, set), format!("{}{difference}", other(name)));
    }
    let found = study("shaft", "");
    assert!(
        found.starts_with("layout \"a\": reference: there is no table 'shaft' of a layout; the tables are "),
        "{found}"
    );
}

/// What is set with the command may make another problem of a study: then there is nothing to compare with, and the page
/// says so.
#[test]
fn overrides_of_the_command_put_a_reference_aside() {
    let folder = tempfile::tempdir().expect("a folder");
    let coarse = ["method.local.spacing_m=0.3", "time.duration_days=2", "time.profiles_days=[2]"];
    let changes = [&coarse[..], &["pipes.1.temperature_c=-25"]].concat();
    let output = run(folder.path(), &["shaft-single-sand", "--method", "local"], &changes);
    assert!(output.status.success(), "{output:?}");
    assert!(!folder.path().join("out/reference.csv").exists());
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).expect("a page");
    assert!(page.contains("the pipe temperature is -20 there and -25 here"));
}

/// A fixed particle of a lattice acts as a pipe of a radius over spacing that lattice sums give (independent program: five
/// points 0.1985, nine points 0.1621; SPH, cubic spline, smoothing ratio 1, 1.2 and 1.5: 0.1629, 0.1276, 0.0637; peridynamics with a constant
/// influence, which weighs pairs by 1/r^2, horizon ratio 2 and 3: 0.0855, 0.0159; horizon cut off sharply). The particle
/// is joined to the pipe by a resistance of 0.005 over the conductivity.
#[test]
fn one_particle_acts_as_the_radius_of_lattice_sums() {
    let joined = (-2.0 * std::f64::consts::PI * 0.005f64).exp();
    for (method, changes, expected) in [
        ("local", vec![("method.local.stencil", "\"five-point\"")], 0.1985),
        ("local", vec![], 0.1621),
        ("sph", vec![("method.sph.smoothing_ratio", "1.0")], 0.1629),
        ("sph", vec![("method.sph.smoothing_ratio", "1.2")], 0.1276),
        ("sph", vec![("method.sph.smoothing_ratio", "1.5")], 0.0637),
        ("pd", vec![("method.pd.horizon_ratio", "2")], 0.0855),
        ("pd", vec![("method.pd.horizon_ratio", "3")], 0.0159),
    ] {
        let scene = ring(&changes);
        let settings = scene.method(method).expect("settings");
        let found = acting_radius(settings) / settings.numerics.spacing / joined;
        // Four digits of the sums.
        assert!((found - expected).abs() < 1e-4, "{method} {changes:?}: {found}");
    }
}

/// On the real code path: a pipe of one particle takes the heat that a true pipe of that radius takes in the same place, where
/// nothing freezes. Fields of the same far constant differ by the square of spacing over diffusion length: 2 % of one part in
/// seven, the logarithm of their ratio.
#[test]
fn one_particle_takes_the_heat_of_a_pipe_of_its_radius() {
    for method in ["local", "sph", "pd"] {
        let [spacing, integrator] = ["spacing_m", "integrator"].map(|key| format!("method.{method}.{key}"));
        // Particles 0.2 m apart have one at (3.9, 3.9).
        let places = "count = 4, ring_radius_m = 5.515432893255071, first_angle_deg = 45, temperature_c = 5";
        let heat = |pipe: &str| {
            let scene = ring(&[
                ("domain.ring.sector", "\"whole\""),
                ("domain.ring.outer_radius_m", "9"),
                // The last rate of steps by error is theirs to a third of a per cent.
                (&integrator, "euler"),
                (&spacing, "0.2"),
                ("time.duration_days", "40"),
                ("time.profiles_days", "[40]"),
                ("pipes", &format!("[{{ {places}, {pipe} }}]")),
            ]);
            let radius = acting_radius(scene.method(method).expect("settings"));
            (result(&scene, method).walls.last().expect("a wall").heat_per_pipe_w_per_m, radius)
        };
        let (one, radius) = heat("one_particle = true");
        let (true_one, _) = heat(&format!("pipe_radius_m = {radius:e}"));
        assert!((one / true_one - 1.0).abs() < 0.003, "{method}: {one} against {true_one}");
    }
}

/// Mirrors map the lattice onto itself, so a quarter and a half are the whole plan to rounding: at every mirrored particle,
/// and for every gap.
#[test]
fn parts_of_the_plan_have_the_states_of_the_whole_at_mirrored_points() {
    for method in ["local", "sph", "pd"] {
        let [spacing, integrator] = ["spacing_m", "integrator"].map(|key| format!("method.{method}.{key}"));
        let at = |sector: &str| {
            let sector = format!("\"{sector}\"");
            let scene = ring(&[
                ("domain.ring.sector", &sector),
                ("domain.ring.outer_radius_m", "9"),
                ("watch.frozen_wall", "true"),
                // Roundings that choose other steps by error are no roundings of states any more.
                (&integrator, "euler"),
                (&spacing, "0.2"),
                ("time.duration_days", "18"),
                ("time.profiles_days", "[6, 18]"),
            ]);
            result(&scene, method)
        };
        let whole = at("whole");
        for part in [at("quarter"), at("half")] {
            let half = part.record.particles * 3 > whole.record.particles;
            for (own, all) in part.fields.iter().zip(&whole.fields) {
                let range = 35.0;
                let mut compared = 0;
                for k in 0..all.nx * all.ny {
                    let x = all.x0_m + all.spacing_m * (k % all.nx) as f64;
                    let y = all.y0_m + all.spacing_m * (k / all.nx) as f64;
                    let column = ((if half { x } else { x.abs() } - own.x0_m) / own.spacing_m).round() as usize;
                    let row = ((y.abs() - own.y0_m) / own.spacing_m).round() as usize;
                    let mirrored = row * own.nx + column;
                    if all.temperature_c[k].is_nan() {
                        continue;
                    }
                    let off = (all.temperature_c[k] - own.temperature_c[mirrored]).abs() / range;
                    assert!(off <= 1e-9, "{method}: {off:e} at ({x:.2}, {y:.2})");
                    let off = (all.frozen_fraction[k] - own.frozen_fraction[mirrored]).abs();
                    assert!(off <= 1e-9, "{method}: frozen fraction {off:e} at ({x:.2}, {y:.2})");
                    compared += 1;
                }
                assert!(compared > 4000, "{compared}");
            }
            assert_eq!(part.links.len(), whole.links.len());
            for (own, all) in part.links.iter().zip(&whole.links) {
                let (own, all) = (own.closure_s.unwrap_or(f64::NAN), all.closure_s.unwrap_or(f64::NAN));
                assert!((own / all - 1.0).abs() < 2e-3, "{method}: {own} against {all}");
            }
            assert!(part.record.wall.as_ref().is_some_and(|wall| wall.closed));
        }
    }
}
