//! Runs against the truth: the bundled scenes within the accuracy that the program promises, and steady states in
//! closed form.

use frazil::registry::methods;
use frazil_core::space::domain::{Domain, Sector};
use frazil_record::{Errors, Outcome, RunResult};
use frazil_scene::method::MethodKind;
use frazil_simulation::march::{self, Options};

use crate::sketch::{Sketch, sand, steady_material, water, without_noise};

/// Errors of a bundled scene under a method.
pub fn errors(scene: &str, method: &str, overrides: &[(&str, &str)]) -> Errors {
    result(scene, method, overrides).record.errors
}

fn result(scene: &str, method: &str, overrides: &[(&str, &str)]) -> RunResult {
    let overrides: Vec<(String, String)> =
        overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let scene = frazil::load::scene(scene, &overrides).unwrap_or_else(|failure| unreachable!("{failure}"));
    let reference = frazil::run::reference(&scene).unwrap_or_else(|failure| unreachable!("{failure}"));
    let result = march::run(&scene, method, reference.as_ref(), &Options::default()).expect("a run");
    assert_eq!(result.record.outcome, Outcome::Ok, "{} {method}: {:?}", scene.name, result.record.cause);
    result
}

/// The limits of every method without noise: a new one needs its line in each table.
fn limits<'a, T>(table: &'a [(&str, T)]) -> Vec<(&'static str, &'a T)> {
    let deterministic = methods().iter().filter(|kind| !kind.stochastic);
    deterministic
        .map(|kind| {
            let limit = table.iter().find(|row| row.0 == kind.name);
            (kind.name, &limit.unwrap_or_else(|| unreachable!("{} has no limits", kind.name)).1)
        })
        .collect()
}

/// Prints what was measured, for `--nocapture`, and compares.
fn check(what: &str, method: &str, found: Option<f64>, limit: f64) {
    let found = found.unwrap_or_else(|| unreachable!("{what} of {method} was not measured")).abs();
    eprintln!("{what} {method}: {found:.6}, allowed {limit}");
    assert!(found <= limit, "{what} of {method}: {found}, must be at most {limit}");
}

// The limits are those that the program is accepted by, set before there was a run; `--nocapture` shows what is
// measured.

#[test]
fn stefan_water() {
    for (method, (front, temperature)) in
        limits(&[("local", (0.001, 0.002)), ("sph", (0.003, 0.0025)), ("pd", (0.008, 0.005))])
    {
        let errors = errors("stefan-water", method, &[]);
        check("stefan-water, front", method, errors.front_rms_rel, *front);
        check("stefan-water, temperature", method, errors.temperature_rms_rel, *temperature);
    }
}

/// Temperatures are read where the front crosses a particle, is about to leave it or has just left it: at all instants the error is
/// at most the square of the spacing times a second derivative of 20 K over the square of the depth of the front, the gradient of the
/// ice over that depth.
#[test]
fn stefan_water_wherever_the_front_is() {
    let spacing = 0.008;
    let instants: Vec<String> = (0..=180).map(|k| format!("{}", 1.0 + 0.05 * f64::from(k))).collect();
    let instants = format!("[{}]", instants.join(", "));
    for kind in methods().iter().filter(|kind| !kind.stochastic) {
        let own = format!("method.{}.spacing_m", kind.name);
        let changes = [(own.as_str(), spacing.to_string()), ("time.profiles_h", instants.clone())];
        let changes: Vec<(&str, &str)> = changes.iter().map(|(key, value)| (*key, value.as_str())).collect();
        let found = result("stefan-water", kind.name, &changes);
        let front_at = |time: f64| found.front.iter().find(|row| row.time_s >= time).and_then(|row| row.front_ref_m);
        let mut largest = 0.0_f64;
        for row in &found.profiles {
            let front = front_at(row.time_s).expect("a front");
            let allowed = 20.0 * (spacing / front).powi(2);
            let error = (row.temperature_c - row.temperature_ref_c.expect("a reference")).abs();
            largest = largest.max(error);
            assert!(error <= allowed, "{}: off by {error} K, allowed {allowed}: {row:?}", kind.name);
        }
        eprintln!("stefan-water, largest error of a temperature, {}: {largest:.3} K", kind.name);
    }
}

#[test]
fn stefan_water_along_a_curve() {
    for (method, front) in limits(&[("local", 0.01), ("sph", 0.01), ("pd", 0.01)]) {
        check("stefan-water-mushy, front", method, errors("stefan-water-mushy", method, &[]).front_rms_rel, *front);
    }
}

#[test]
fn stefan_unit() {
    for (method, front) in limits(&[("local", 0.003), ("sph", 0.006), ("pd", 0.015)]) {
        check("stefan-unit, front", method, errors("stefan-unit", method, &[]).front_rms_rel, *front);
    }
}

#[test]
fn frozen_wall_sand() {
    for (method, closure) in limits(&[("local", 0.02), ("sph", 0.025), ("pd", 0.04)]) {
        let found = errors("frozen-wall-sand", method, &[]).events.get("closure_day").copied();
        check("frozen-wall-sand, closure", method, found, *closure);
    }
}

// This scene has no limits of its own: it takes those of stefan-unit, a line of as many particles to the front.
#[test]
fn soil_column() {
    for (method, front) in limits(&[("local", 0.003), ("sph", 0.006), ("pd", 0.015)]) {
        check("soil-column, front", method, errors("soil-column", method, &[]).front_rms_rel, *front);
    }
}

const LENGTH: f64 = 0.1;
/// Conductivities of frozen and unfrozen water in the sketches.
const FROZEN: f64 = 2.14;
const UNFROZEN: f64 = 0.6;

/// A line of little latent heat, long enough to be steady: the slowest of its modes falls by exp(-25) in 50 h.
fn steady_line() -> Sketch {
    let mut sketch = Sketch::new(Domain::Line { length: LENGTH }, LENGTH / 24.0);
    sketch.materials = vec![("water", water("law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 1000"))];
    sketch.duration_s = 50.0 * 3600.0;
    // Steps by error may leave what they are allowed.
    sketch.with("integrator = \"euler\"")
}

fn check_steady(sketch: &Sketch, kind: &'static MethodKind, potential: impl Fn(f64) -> f64) {
    let result = sketch.run(kind);
    assert!(result.profiles.len() == 24);
    for row in &result.profiles {
        let wanted = potential(row.along_m);
        let wanted = if wanted < 0.0 { wanted / FROZEN } else { wanted / UNFROZEN };
        // The exchange and all walls are exact for a potential that is linear; what remains of the start is below
        // 25 K exp(-25) = 4e-10 K.
        assert!((row.temperature_c - wanted).abs() < 1e-8, "{}: {row:?}, must be {wanted}", kind.name);
    }
}

#[test]
fn steady_between_two_temperatures() {
    for kind in methods() {
        let sketch = steady_line()
            .with(without_noise(kind))
            .wall("left", "temperature_c = -10")
            .wall("right", "temperature_c = 10");
        let (left, right) = (-10.0 * FROZEN, 10.0 * UNFROZEN);
        check_steady(&sketch, kind, |x| left + (right - left) * x / LENGTH);
        let flux = (right - left) / LENGTH;
        let result = sketch.run(kind);
        let mut longer = sketch.clone();
        longer.duration_s *= 1.25;
        // Heat through the right wall in the last hours.
        let heat = |result: &RunResult| result.budget.last().expect("an output").in_j[1];
        let found = (heat(&longer.run(kind)) - heat(&result)) / (0.25 * sketch.duration_s);
        assert!((found / flux - 1.0).abs() < 1e-8, "{}: {found} W/m2, must be {flux}", kind.name);
    }
}

#[test]
fn steady_under_a_flux() {
    for kind in methods() {
        let sketch = steady_line()
            .with(without_noise(kind))
            .wall("left", "flux_W_per_m2 = -300")
            .wall("right", "temperature_c = 10");
        check_steady(&sketch, kind, |x| 10.0 * UNFROZEN - 300.0 * (LENGTH - x));
    }
}

#[test]
fn steady_under_convection() {
    for kind in methods() {
        let sketch = steady_line()
            .with(without_noise(kind))
            .wall("left", "coefficient_W_per_m2_K = 50\nambient_c = -20")
            .wall("right", "temperature_c = 10");
        // The film passes what the line conducts: 50 (T - -20) = (U_right - k_frozen T) / length.
        let right = 10.0 * UNFROZEN;
        let wall = FROZEN * (right / LENGTH - 50.0 * 20.0) / (50.0 + FROZEN / LENGTH);
        check_steady(&sketch, kind, |x| wall + (right - wall) * x / LENGTH);
    }
}

/// Two materials in series. Half-pairs share their interface half-way, as neighbours beside the interface do; pairs
/// that reach further across it do so too wherever it lies, which leaves an error that falls with the spacing.
#[test]
fn steady_through_two_materials() {
    let exact = 20.0 / (0.5 * LENGTH / UNFROZEN + 0.5 * LENGTH / 1.86);
    for kind in methods() {
        let error = |parts: f64| {
            let mut sketch = steady_line()
                .with(without_noise(kind))
                .wall("left", "temperature_c = 10")
                .wall("right", "temperature_c = 30");
            sketch.spacing_m = LENGTH / parts;
            let law = "law = \"none\", temperature_c = 0";
            sketch.materials = vec![("water", water(law)), ("sand", sand(law))];
            sketch.regions = vec![format!("material = \"sand\"\nx_min_m = {}\nx_max_m = {LENGTH}", 0.5 * LENGTH)];
            sketch.outputs = 5;
            let result = sketch.run(kind);
            let rows = &result.budget[3..];
            let flux = (rows[1].in_j[1] - rows[0].in_j[1]) / (rows[1].time_s - rows[0].time_s);
            flux / exact - 1.0
        };
        let errors = [12.0, 24.0, 48.0].map(error);
        eprintln!("two materials in series, {}: {errors:.8?}", kind.name);
        // Pairs carry the flux of what lies between their ends; what is left is that the run ends.
        assert!(errors.iter().all(|error| error.abs() < 1e-6), "{}: {errors:?}", kind.name);
    }
}

/// A disc whose curved wall is quenched, against its series from the time on at which two modes are all that is left.
#[test]
fn a_cooling_disc() {
    // Roots of the Bessel function J0 with J1 there, and J0 by its power series, exact to rounding below 6.
    let modes = [(2.404_825_557_695_773, 0.519_147_497_289_467), (5.520_078_110_286_311, -0.340_264_806_368_209_5)];
    let j0 = |x: f64| {
        (1..60)
            .fold((1.0, 1.0), |(sum, term): (f64, f64), k: i32| {
                let next = -term * 0.25 * x * x / f64::from(k * k);
                (sum + next, next)
            })
            .0
    };
    for (kind, disc) in
        methods().iter().filter(|kind| !kind.stochastic).flat_map(|kind| [1.0, 1.03].map(|radius| (kind, radius)))
    {
        let mut sketch = Sketch::new(Domain::Ring { outer_radius: disc, sector: Sector::Quarter }, 0.05)
            .wall("outer", "temperature_c = -10");
        sketch.materials = vec![("soil", steady_material())];
        sketch.initial_c = 10.0;
        sketch.duration_s = 4e5;
        sketch.outputs = 40;
        sketch.watch = "probes_m = [[0.05, 0.05], [0.5, 0.1], [0.3, 0.6], [0.8, 0.3]]".to_owned();
        let result = sketch.run(kind);
        let mut squares = Vec::new();
        for row in result.probes.iter().filter(|row| row.time_s >= 0.2e6 * disc * disc) {
            let radius = row.x_m.hypot(row.y_m) / disc;
            let fourier = 1e-6 * row.time_s / (disc * disc);
            let series = modes.map(|(z, j1)| 2.0 / (z * j1) * j0(z * radius) * (-z * z * fourier).exp());
            squares.push((row.temperature_c + 10.0 - 20.0 * (series[0] + series[1])).powi(2));
        }
        assert!(squares.len() >= 60, "{}", kind.name);
        let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt() / 20.0;
        // Measured below 0.3 %. A wall half a spacing off would make the radius wrong by 2.5 %, the decay by 5 %, and
        // these temperatures by about 1 % of the range.
        check("cooling disc, temperature", kind.name, Some(error), 0.005);
    }
}
