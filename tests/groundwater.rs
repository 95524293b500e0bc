//! Groundwater that crosses a ring of freeze pipes.

use frazil_cases::groundwater;
use frazil_cases::layouts::{self, Gap};
use frazil_core::space::domain::{Domain, Sector};
use frazil_scene::Scene;
use frazil_scene::method::MethodKind;
use frazil_simulation::march::{self, Options};
use frazil_simulation::plan;
use glam::DVec2;

use crate::sketch::{SHARP, Sketch, advance, bundled, even};

/// Sand with water in it.
fn sand(law: &str) -> String {
    format!(
        "{{ density_kg_per_m3 = 2090, \
         frozen = {{ conductivity_W_per_m_K = 2.56, heat_capacity_J_per_kg_K = 1088.4 }}, \
         unfrozen = {{ conductivity_W_per_m_K = 1.86, heat_capacity_J_per_kg_K = 1465.1 }}, freezing = {{ {law} }}, \
         groundwater = {{ porosity = 0.36, density_kg_per_m3 = 1000, heat_capacity_J_per_kg_K = 4190, \
         permeability_m2 = 1e-11 }} }}"
    )
}

pub const NEVER: &str = "law = \"none\", temperature_c = 0";

/// A ring of radius 4 m that water crosses.
pub fn crossed(law: &str, sector: Sector, velocity: f64, degrees: f64) -> Sketch {
    let mut sketch = Sketch::new(Domain::Ring { outer_radius: 4.0, sector }, 0.2).wall("outer", "temperature_c = 15");
    sketch.materials = vec![("sand", sand(law))];
    sketch.initial_c = 15.0;
    let ice =
        if law == NEVER { "" } else { "relative_permeability = { law = \"power\", exponent = 1, least = 1e-12 }\n" };
    sketch.flow = format!("viscosity_Pa_s = 1.3e-3\n{ice}velocity_m_per_day = {velocity}\ndirection_deg = {degrees}");
    sketch
}

/// Two rows of pipes, the same after a quarter turn.
fn with_pipes(mut sketch: Sketch) -> Sketch {
    sketch.pipes = vec!["count = 12\nring_radius_m = 2\npipe_radius_m = 0.054\ntemperature_c = -20".into()];
    sketch
}

#[test]
fn undisturbed_water_is_even() {
    for kind in even() {
        for (sector, degrees) in [(Sector::Whole, 30.0), (Sector::Half, 0.0), (Sector::Half, 180.0)] {
            let plan = crossed(NEVER, sector, 0.1, degrees).plan(kind);
            let expected = 0.1 / 86400.0 * DVec2::from_angle(f64::to_radians(degrees));
            let (_, velocity) = plan.method.water_fields().expect("water flows");
            for (i, found) in velocity.iter().enumerate() {
                // The first solution balances every particle to 1e-11 of what is driven, some hundred paths away.
                let difference = (*found - expected).length() / expected.length();
                assert!(difference < 1e-7, "{} {degrees} at particle {i}: {found}, not {expected}", kind.name);
            }
        }
    }
}

/// Ice round the centre, in a ring at whose outer wall the pressure is that of water which nothing disturbs:
/// `p = -A (r + a^2 / r) cos`, with `A (R + a^2 / R) = G R`.
#[test]
fn water_flows_around_ice_as_potentials_do() {
    let (ice, outer) = (1.0_f64, 4.0_f64);
    for kind in even() {
        let error = |spacing: f64| {
            let mut sketch = crossed(SHARP, Sector::Half, 0.1, 0.0);
            sketch.spacing_m = spacing;
            sketch.regions = vec![format!("temperature_c = -5\ncircle = {{ x_m = 0, y_m = 0, radius_m = {ice} }}")];
            let plan = sketch.plan(kind);
            let (pressure, _) = plan.method.water_fields().expect("water flows");
            let drive = 0.1 / 86400.0 * 1.3e-3 / 1e-11;
            let factor = drive / (1.0 + (ice / outer).powi(2));
            let (mut sum, mut count) = (0.0, 0.0);
            plan.particles.visit(|i, place| {
                let r = place.length();
                if r > ice + 0.4 {
                    let exact = -factor * place.x * (1.0 + (ice / r).powi(2));
                    sum += ((pressure[i] - exact) / (drive * outer)).powi(2);
                    count += 1.0;
                }
            });
            f64::sqrt(sum / count)
        };
        let (coarse, fine) = (error(0.2), error(0.1));
        // Both walls are met within a spacing, over which the pressure changes by a twentieth of its range at 0.2 m, so the
        // error is of first order at least; staircases of one spacing make it fall unevenly.
        assert!(coarse < 0.05 && fine < 0.7 * coarse, "{}: {coarse:.2e}, then {fine:.2e}", kind.name);
    }
}

/// The half plan is the whole, and a quarter turn of the water turns the state. Not under `limited`, whose correction for
/// bent profiles takes a pair and its mirror image as one.
#[test]
fn halves_and_turns_are_the_whole() {
    for kind in even() {
        let state = |sector: Sector, degrees: f64| {
            let mut plan = with_pipes(crossed(SHARP, sector, 0.5, degrees)).with("advection = \"blended\"").plan(kind);
            advance(&mut plan, 40);
            plan
        };
        let (whole, half, turned) = (state(Sector::Whole, 0.0), state(Sector::Half, 0.0), state(Sector::Whole, 90.0));
        let lattice = &whole.particles.lattice;
        let most = whole.particles.enthalpy.iter().fold(0.0, |most: f64, h| most.max(h.abs()));
        assert!(most > 0.0);
        let cell_at = |plan: &plan::Plan, x: i64, y: i64| {
            let corner = plan.particles.lattice.corner / plan.particles.lattice.spacing;
            plan.particles.lattice.index(x - corner.x.round() as i64, y - corner.y.round() as i64).expect("a cell")
        };
        for i in 0..lattice.len() {
            let (column, row) = lattice.cell(i);
            let (x, y) = (column - lattice.columns as i64 / 2, row - lattice.rows as i64 / 2);
            let own = whole.particles.enthalpy[i];
            let mirrored = half.particles.enthalpy[cell_at(&half, x, if y < 0 { -1 - y } else { y })];
            // A turn maps cell (x, y) to (-1 - y, x).
            let other = turned.particles.enthalpy[cell_at(&turned, -1 - y, x)];
            for (what, found) in [("half", mirrored), ("turned", other)] {
                // Pressures are found to 1e-8 of what flows.
                assert!((found - own).abs() < 1e-6 * most, "{} {what} at {x} {y}: {found}, not {own}", kind.name);
            }
        }
    }
}

#[test]
fn heat_is_neither_lost_nor_made_and_water_slows_freezing() {
    for kind in even() {
        let ice = |velocity: f64| {
            let mut sketch = with_pipes(crossed(SHARP, Sector::Half, velocity, 0.0));
            sketch.duration_s = 5.0 * 86400.0;
            let result = sketch.run(kind);
            let balance = result.record.energy_balance_rel;
            assert!(balance.abs() < 1e-9, "{} at {velocity} m/day: heat {balance}", kind.name);
            let water = result.record.water.as_ref().expect("water flows");
            assert!(water.balance_rel.abs() < 1e-9, "{} at {velocity} m/day: {}", kind.name, water.balance_rel);
            result.water.expect("water flows").rows.last().expect("a row").ice_m3
        };
        let (still, slow, fast) = (ice(0.0), ice(0.5), ice(1.0));
        assert!(still > slow && slow > fast && fast > 0.0, "{}: ice {still}, {slow}, {fast} m2", kind.name);
    }
}

/// Water at rest changes neither the wall nor what is said of it.
#[test]
fn still_water_changes_nothing() {
    for kind in even() {
        let end = |flows: bool| {
            // Water makes Heun's steps, conduction alone Euler's: both are short here.
            // Fronts stay in cells beside water and not without.
            let mut sketch = with_pipes(crossed(SHARP, Sector::Half, 0.0, 0.0)).with("step_fraction = 0.1");
            sketch = sketch.with("front = \"cell\"");
            if !flows {
                sketch.flow.clear();
                sketch.materials = vec![("sand", crate::sketch::sand(SHARP))];
            }
            sketch.watch = "frozen_wall = true".into();
            (sketch.duration_s, sketch.outputs) = (20.0 * 86400.0, 20);
            let result = sketch.run(kind);
            let mean =
                result.planes.iter().rev().find(|row| row.plane == "wall").and_then(|row| row.mean_temperature_c);
            let heat = result.walls.last().expect("a row").heat_per_pipe_w_per_m;
            (mean.expect("frozen ground"), heat, result.record.setback_rel.expect("a rule"))
        };
        let (still, without) = (end(true), end(false));
        // At the whole step the local method differs by 0.013 K and 0.03 %, of first order in it.
        assert!((still.0 - without.0).abs() < 0.01, "{}: {still:?}, not {without:?}", kind.name);
        assert!((still.1 / without.1 - 1.0).abs() < 5e-3, "{}: {still:?}, not {without:?}", kind.name);
        assert!(still.2 <= without.2.max(1e-9), "{}: {still:?}, not {without:?}", kind.name);
    }
}

/// What is tried between two velocities narrows the range in which the greatest lies that the wall still closes at.
#[test]
fn how_much_keeps_a_wall_open_is_found_by_halving() {
    let folder = tempfile::tempdir().expect("a folder");
    let study = "title = \"Rings\"\nscene = \"frozen-wall-seepage\"\nmethod = \"local\"\n\
                 set = { \"time.duration_days\" = 20, \"time.outputs\" = 40, \"time.profiles_days\" = [20], \
                 \"method.local.spacing_m\" = 0.25, \"domain.ring.outer_radius_m\" = 8 }\n\
                 [[layouts]]\nname = \"ring\"\n[critical]\nkey = \"flow.velocity_m_per_day\"\n\
                 values = [0, 0.5, 1]\nwithin = 0.1\n";
    std::fs::write(folder.path().join("rings.toml"), study).expect("written");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_frazil"));
    let output = command.args(["layout", "rings.toml", "--quiet", "--out", "out"]).current_dir(folder.path()).output();
    let output = output.expect("the program starts");
    assert!(output.status.success(), "{output:?}");
    let rows = |name: &str| -> Vec<std::collections::BTreeMap<String, String>> {
        let mut reader = csv::Reader::from_path(folder.path().join("out").join(name)).expect("a table");
        reader.deserialize().map(|row| row.expect("a row")).collect()
    };
    let number = |text: &str| text.parse::<f64>().expect("a number");
    let found = rows("critical.csv");
    let (closes, open) = (number(&found[0]["closes_up_to"]), number(&found[0]["open_from"]));
    assert!(closes < open && open - closes <= 0.1, "{found:?}");
    for tried in rows("critical_tried.csv") {
        let closed = !tried["closure_days"].is_empty();
        assert_eq!(closed, number(&tried["value"]) <= closes, "{tried:?}");
    }
}

fn ring(changes: &[(&str, &str)]) -> Scene {
    bundled("frozen-wall-seepage", changes)
}

/// The table of gaps across which water flows has half a ring, from where water leaves it to where it comes from.
#[test]
fn the_table_of_groundwater_has_each_gap_of_half_a_ring() {
    for (pipes, velocity) in [("26", "0.05"), ("26", "0.1"), ("26", "0.2"), ("26", "0.5"), ("20", "0.1"), ("32", "0.2")]
    {
        let scene = ring(&[("pipes.1.count", pipes), ("flow.velocity_m_per_day", velocity)]);
        let table = layouts::by_name(groundwater::NAME, &scene, None).expect("a table");
        let spacing = 360.0 / pipes.parse::<f64>().expect("a number");
        assert_eq!((table.closures.len() as f64 * spacing).round(), 180.0, "{pipes} at {velocity}");
        for (k, closure) in table.closures.iter().enumerate() {
            let expected = (k as f64 + 0.5) * spacing;
            assert!(matches!(closure.gap, Gap::FromDownstream(own) if (own - expected).abs() < 0.01), "{closure:?}");
        }
    }
}

#[test]
fn the_table_of_groundwater_is_about_one_problem() {
    for (key, value, expected) in [
        ("flow.velocity_m_per_day", "0.3", "pipes at velocities (m/day) are "),
        ("flow.relative_permeability.exponent", "2", "ground lets pass water in proportion to what is unfrozen there"),
        ("pipes.1.first_angle_deg", "3", "a pipe stands farthest downstream there"),
        ("pipes.1.temperature_c", "-25", "the pipe temperature is -20 there and -25 here"),
        (
            "materials.sand.groundwater.heat_capacity_J_per_kg_K",
            "4000",
            "the heat capacity of water by volume is 4190000 there and 4000000 here",
        ),
    ] {
        let scene = ring(&[(key, value), ("domain.ring.sector", "whole")]);
        let difference = layouts::by_name(groundwater::NAME, &scene, None).expect_err("another problem").to_string();
        let (_, difference) = difference.split_once("another problem: ").expect("a difference");
        assert!(difference.starts_with(expected), "{key}: {difference}");
    }
    let scene = ring(&[]);
    let still = layouts::by_name("shaft-single-sand-54mm", &scene, None).expect_err("another problem").to_string();
    assert!(still.ends_with("no water flows there"), "{still}");
}

/// A ring in groundwater closes as an independent program has it under every method: upstream last, where water comes warm.
/// Particles of 0.2 m are a sixth of the distance of pipes; half of it moves the day by 1.3 %, and twice that is allowed.
#[test]
fn a_ring_in_groundwater_closes_upstream_last_on_the_day_of_the_table() {
    let changes = [("flow.velocity_m_per_day", "0.2"), ("time.duration_days", "52"), ("time.profiles_days", "[52]")];
    let scene = |kind: &MethodKind| {
        let spacing = format!("method.{}.spacing_m", kind.name);
        ring(&[&changes[..], &[("watch.frozen_wall", "true"), (&spacing, "0.2")]].concat())
    };
    for kind in even() {
        let scene = scene(kind);
        let table = layouts::by_name(groundwater::NAME, &scene, None).expect("a table");
        let last = table.closures.iter().max_by(|a, b| a.day.total_cmp(&b.day)).expect("gaps");
        let result = march::run(&scene, kind.name, None, &Options::default()).expect("a run");
        let found = result.record.wall.and_then(|wall| wall.closure_s).expect("a closed wall") / 86_400.0;
        assert!((found / last.day - 1.0).abs() < 0.026, "{}: day {found}, not {}", kind.name, last.day);
        let days = result.links.iter().map(|link| (link.closure_s.expect("closed"), link.x_m));
        let weakest = days.max_by(|a, b| a.0.total_cmp(&b.0)).expect("gaps");
        assert!(weakest.1 < -4.5, "{}: the gap at x = {} m", kind.name, weakest.1);
    }
}

/// Water goes on as it has changed, so that pressures which stand for a while are wrong by the second order of how long; where ice
/// takes up more room than water, from shorter times on.
#[test]
fn pressures_that_stand_are_of_second_order() {
    // Euler's steps are below this one.
    let step = 1.0;
    let at_end = |expands: &str, steps: f64| {
        let interval = ((steps - 0.5) * step).to_string();
        let changes = [
            // Wide enough for no particle to thaw within one interval.
            ("materials.sand.freezing.width_K", "10"),
            ("flow.relative_permeability.impedance", "5"),
            ("flow.density_change", expands),
            ("method.local.spacing_m", "0.01"),
            ("method.local.integrator", "\"euler\""),
            ("method.local.pressure_change", "1"),
            ("method.local.pressure_interval_s", &interval),
        ];
        let scene = bundled("thawing-inclusion", &changes);
        let settings = scene.methods.iter().find(|settings| settings.method == "local").expect("a method");
        let mut plan = plan::build(&scene, settings, None, 1, 1).unwrap_or_else(|refused| unreachable!("{refused}"));
        assert!(plan.step > step, "{}", plan.step);
        plan.step = step;
        advance(&mut plan, 640);
        plan.particles.enthalpy.clone()
    };
    for (expands, steps) in [("false", [32.0, 16.0, 8.0]), ("true", [8.0, 4.0, 2.0])] {
        let exact = at_end(expands, 1.0);
        let errors = steps.map(|steps| {
            let found = at_end(expands, steps);
            let squares: f64 = found.iter().zip(&exact).map(|(found, exact)| (found - exact).powi(2)).sum();
            squares.sqrt()
        });
        // A first order would halve them.
        assert!(errors[0] > 3.0 * errors[1] && errors[1] > 3.0 * errors[2], "expands {expands}: {errors:?}");
    }
}
