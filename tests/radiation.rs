//! Walls that radiate.

use frazil::registry::methods;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::symmetry::Symmetry;
use frazil_scene::method::MethodKind;

use crate::sketch::{Sketch, sand, steady_material, through, water, without_noise};

const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;
const ABSOLUTE_ZERO: f64 = -273.15;

/// Heat that a wall has brought at the end over that of the last output before it (W/m2 or W/m).
fn rate(sketch: &Sketch, kind: &'static MethodKind, wall: &str) -> f64 {
    let result = sketch.run(kind);
    let [.., (before, t0), (last, t1)] =
        &through(&result, wall).into_iter().zip(result.budget.iter().map(|row| row.time_s)).collect::<Vec<_>>()[..]
    else {
        unreachable!("two outputs")
    };
    (last - before) / (t1 - t0)
}

/// A plate of 2 W/mK and half a metre between a wall of given temperature and another one, long enough to come to rest: fifty
/// times what the first mode of its temperature takes.
fn plate(kind: &MethodKind, left: f64, right: String) -> Sketch {
    let mut sketch = Sketch::new(Domain::Line { length: 0.5 }, 0.05)
        .with(without_noise(kind))
        .wall("left", format!("temperature_c = {left}"))
        .wall("right", right);
    sketch.materials = vec![("ground", steady_material())];
    sketch.initial_c = left;
    (sketch.duration_s, sketch.outputs) = (5e6, 20);
    sketch
}

#[test]
fn a_plate_at_rest_carries_what_its_wall_radiates() {
    for kind in methods() {
        for (left, ambient, emissivity) in [(40.0_f64, -60.0_f64, 0.9), (-20.0, 300.0, 0.4), (600.0, -100.0, 1.0)] {
            // The root of 4 (left - wall) = e s (wall^4 - ambient^4), which rises from left to right, by bisection.
            let fourth = |temperature: f64| (temperature - ABSOLUTE_ZERO).powi(4);
            let radiated = |wall: f64| emissivity * STEFAN_BOLTZMANN * (fourth(ambient) - fourth(wall));
            let (mut low, mut high) = (left.min(ambient), left.max(ambient));
            for _ in 0..100 {
                let wall = 0.5 * (low + high);
                if 4.0 * (left - wall) + radiated(wall) > 0.0 { low = wall } else { high = wall }
            }
            for numerics in ["", "search = \"tree\"", "mean = \"harmonic\""] {
                let sketch = plate(kind, left, format!("emissivity = {emissivity}\nambient_c = {ambient}"));
                let own = rate(&sketch.with(numerics), kind, "right");
                // Mirrored walls meet a linear profile exactly, so what is left is rounding of heat counted from the start.
                let name = format!("{} {left} {ambient} {numerics}", kind.name);
                assert!((own / radiated(low) - 1.0).abs() < 1e-9, "{name}: {own} W/m2, not {}", radiated(low));
            }
        }
    }
}

/// Beside a film of the coefficient `4 e s T^3` a wall radiates more or less by the first power of the difference.
#[test]
fn small_differences_make_it_a_film() {
    for kind in methods() {
        let off = |difference: f64| {
            let coefficient = 4.0 * 0.8 * STEFAN_BOLTZMANN * (10.0_f64 - ABSOLUTE_ZERO).powi(3);
            let run = |wall: &str| {
                let ambient = format!("{wall}\nambient_c = 10");
                rate(&plate(kind, 10.0 + difference, ambient), kind, "right")
            };
            run("emissivity = 0.8") / run(&format!("coefficient_W_per_m2_K = {coefficient}")) - 1.0
        };
        let [large, small] = [8.0, 4.0].map(off);
        // Of the next order is a square of 8 K over 283 K.
        assert!(large > 0.0 && large < 1.5 * 8.0 / 283.0, "{}: {large}", kind.name);
        assert!((large / small - 2.0).abs() < 0.1, "{}: {large} {small}", kind.name);
    }
}

/// Whatever the body, its arrangement and its steps, what radiates in is what the body holds.
#[test]
fn no_heat_is_lost_at_walls_that_radiate() {
    const WALL: &str = "emissivity = 0.9\nambient_c = { times_h = [0, 20], values = [60, -150] }";
    let sharp = "law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 50000";
    let curve = "law = \"weibull\", temperature_c = 0, latent_heat_J_per_kg = 50000, width_K = 1";
    for kind in methods() {
        let rectangle = || Sketch::new(Domain::Rectangle { width: 0.6, height: 0.4 }, 0.05).wall("right", WALL);
        let ring =
            || Sketch::new(Domain::Ring { outer_radius: 0.5, sector: Sector::Quarter }, 0.05).wall("outer", WALL);
        let shells = Sketch::new(Domain::Radial { symmetry: Symmetry::Axial, inner: 0.3, outer: 0.9 }, 0.05);
        let mut layered = rectangle();
        layered.materials = vec![("water", water(sharp)), ("sand", sand(curve))];
        // A layer thinner than a spacing at the wall: heat comes in through an interface.
        layered.regions = vec!["material = \"sand\"\nx_min_m = 0.56\nx_max_m = 0.6\ny_min_m = 0\ny_max_m = 0.4".into()];
        let mut bodies = vec![rectangle(), ring(), layered];
        if !kind.stochastic {
            bodies.push(shells.wall("outer", WALL));
            bodies.push(rectangle().with("wall_model = \"naive\""));
            bodies.push(rectangle().with("wall_model = \"inner-layers\""));
            bodies.push(rectangle().with("integrator = \"rkl2\""));
            bodies.push(rectangle().with("integrator = \"implicit\""));
            bodies.push(ring().with("integrator = \"implicit\"\nsearch = \"tree\""));
        }
        if !kind.lattice_only {
            bodies.push(
                rectangle().with("wall_model = \"moving-least-squares\"\nlayout = \"jittered\"\njitter_fraction = 0.1"),
            );
        }
        for body in bodies.into_iter().flat_map(|body| [(body.clone(), sharp), (body, curve)]) {
            let (mut sketch, law) = (body.0.with(without_noise(kind)), body.1);
            if sketch.materials.len() == 1 {
                sketch.materials = vec![("water", water(law))];
            }
            (sketch.duration_s, sketch.outputs) = (2e5, 3);
            let name = format!("{} {sketch:?}", kind.name);
            let result = sketch.run(kind);
            let balance = result.record.energy_balance_rel;
            // Implicit steps stop their solver at a stated part of the heat; explicit ones round.
            let allowed = if sketch.numerics.contains("implicit") { 1e-9 } else { 1e-12 };
            assert!(balance.abs() <= allowed, "{name}: {balance:e}");
            let heat = result.budget.last().map_or(0.0, |row| row.in_j.iter().map(|heat| heat.abs()).sum());
            assert!(heat > 1e5, "{name}: {heat}");
        }
    }
}
