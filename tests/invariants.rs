//! What holds for every method of the registry, whatever its weights: in one and two dimensions, on the lattice and on
//! jittered clouds, with one and two materials, under every exchange and every latent-heat scheme.

use std::sync::{Arc, Mutex};

use frazil::registry::methods;
use frazil_core::kernels::list_parts::ListParts;
use frazil_core::kernels::term::Off;
use frazil_core::solvers::assembly::Assembly;
use frazil_core::space::domain::{Domain, Sector};
use frazil_record::Outcome;
use frazil_scene::method::{Discretisation, MethodKind, Stepper};
use frazil_scene::settings::Front;
use frazil_simulation::plan::{self, Plan};
use rand::{RngExt, SeedableRng, rngs::StdRng};

use crate::sketch::{Sketch, advance, sand, thicknesses, wall_by_chance, water, without_noise};

const SPACING: f64 = 0.1;
const LINE: Domain = Domain::Line { length: 2.4 };
const RECTANGLE: Domain = Domain::Rectangle { width: 0.9, height: 0.7 };
/// A disc whose wall passes particles at all depths.
const DISC: Domain = Domain::Ring { outer_radius: 0.93, sector: Sector::Half };
/// A body that is narrower than most pairs reach.
const NARROW: Domain = Domain::Rectangle { width: 0.2, height: 0.3 };
const JITTERED: &str = "layout = \"jittered\"\njitter_fraction = 0.3";

fn ring(sector: Sector) -> Domain {
    Domain::Ring { outer_radius: 3.0, sector }
}

/// Eight pipes on a ring.
const EIGHT_PIPES: &str = "count = 8\nring_radius_m = 1.2\npipe_radius_m = 0.05\ntemperature_c = -20";

/// Freezing laws, without the freezing point, and whether they are sharp.
const LAWS: [(&str, bool); 4] = [
    ("law = \"none\"", true),
    ("law = \"isothermal\", latent_heat_J_per_kg = 50000", true),
    ("law = \"linear\", width_K = 2, latent_heat_J_per_kg = 50000", false),
    ("law = \"weibull\", width_K = 0.5, latent_heat_J_per_kg = 50000", false),
];

/// One way to run a body.
struct Variant {
    name: String,
    sketch: Sketch,
    /// Whether pairs exchange by the potential.
    potential: bool,
    /// The word of the latent-heat scheme.
    scheme: &'static str,
    /// Whether the freezing law is a curve.
    curved: bool,
}

/// All ways in which a method can run a body that starts at 3 degC. There is no heat exchange with anything yet.
fn variants(kind: &'static MethodKind, domain: Domain) -> Vec<Variant> {
    let mut found = Vec::new();
    for (law, sharp) in LAWS {
        for scheme in ["enthalpy", "flags", "apparent-capacity"] {
            // Flags need one freezing point.
            if scheme == "flags" && !sharp {
                continue;
            }
            for exchange in [
                "exchange = \"potential\"",
                "mean = \"harmonic\"",
                "mean = \"arithmetic\"",
                "mean = \"geometric\"",
                "mean = \"harmonic\"\nmushy = false",
            ] {
                for jittered in [false, true] {
                    if jittered && kind.lattice_only {
                        continue;
                    }
                    for two_materials in [false, true] {
                        let mut sketch = Sketch::new(domain, SPACING)
                            .with(exchange)
                            .with(&format!("scheme = \"{scheme}\""))
                            .with(if jittered { JITTERED } else { "" })
                            .with(without_noise(kind));
                        if scheme == "apparent-capacity" && law.contains("isothermal") {
                            sketch = sketch.with("interval_K = 1");
                        }
                        sketch.materials = vec![("water", water(&format!("{law}, temperature_c = 0")))];
                        if two_materials {
                            sketch.materials.push(("sand", sand(&format!("{law}, temperature_c = -0.3"))));
                            let height = if domain.dimension() == 2 { "\ny_min_m = 0.2\ny_max_m = 0.6" } else { "" };
                            sketch.regions = vec![format!("material = \"sand\"\nx_min_m = 0.3\nx_max_m = 0.6{height}")];
                        }
                        let followed = law.contains("isothermal")
                            && scheme == "enthalpy"
                            && exchange.contains("potential")
                            && !(kind.stochastic || jittered || two_materials || domain == NARROW);
                        if followed {
                            let sketch = sketch.clone().with("front = \"sub-cell\"");
                            found.push(Variant {
                                name: format!("{} in {domain:?}: {sketch:?}", kind.name),
                                sketch,
                                potential: true,
                                scheme,
                                curved: false,
                            });
                        }
                        found.push(Variant {
                            name: format!("{} in {domain:?}: {sketch:?}", kind.name),
                            sketch,
                            potential: exchange.contains("potential"),
                            scheme,
                            curved: !sharp,
                        });
                    }
                }
            }
        }
    }
    found
}

/// Walls of a straight body, all different: for each its name, and its line.
fn four_walls() -> [(&'static str, &'static str); 4] {
    [
        ("left", "temperature_c = { times_h = [0, 10, 30], values = [3, -12, -6] }"),
        ("right", "coefficient_W_per_m2_K = 15\nambient_c = -18"),
        ("bottom", "flux_W_per_m2 = -40"),
        ("top", "condition = \"symmetry\""),
    ]
}

/// The particles, pairs and walls of a list, as the plan makes them.
fn assembled(sketch: &Sketch, kind: &'static MethodKind) -> ListParts {
    let mut scene = sketch.scene(kind);
    let kept = Arc::new(Mutex::new(None));
    let keep = kept.clone();
    let settings = &mut scene.methods[0];
    // A list knows no fronts inside particles.
    settings.numerics.front = Front::Cell;
    let own = &settings.discretisation;
    settings.discretisation = Arc::new(Discretisation {
        weight: own.weight.clone(),
        normalisation: own.normalisation,
        knobs: Vec::new(),
        differences: Vec::new(),
        fluctuation: 0.0,
        stepper: Stepper::Own(Arc::new(move |assembly: Assembly| {
            *keep.lock().expect("no other thread") = Some(assembly.parts.clone());
            assembly.into_solver(Off)
        })),
    });
    plan::build(&scene, &scene.methods[0], None, 1, 1).expect("a plan");
    kept.lock().expect("no other thread").take().expect("the parts")
}

/// Second moment of a particle's weights, ghosts included: the conductivity that it acts with, over the true one.
fn moment(parts: &ListParts, i: usize, dimension: usize) -> f64 {
    let count = parts.positions.len();
    let row = parts.pairs.starts[i]..parts.pairs.starts[i + 1];
    let sum: f64 = row
        .map(|k| {
            let j = parts.pairs.partners[k] as usize;
            let place = if j < count { parts.positions[j] } else { parts.ghosts.position[j - count] };
            parts.pairs.weights[k] * (place - parts.positions[i]).length_squared()
        })
        .sum();
    sum / (2 * dimension) as f64
}

#[test]
fn weights_are_symmetric_to_the_last_bit_and_never_negative() {
    for kind in methods() {
        for domain in [LINE, RECTANGLE, ring(Sector::Quarter), ring(Sector::Half)] {
            for numerics in ["", "setting = \"paper\"", JITTERED, "layout = \"random\""] {
                if kind.lattice_only && numerics.contains("layout") {
                    continue;
                }
                let parts = assembled(&Sketch::new(domain, SPACING).with(numerics), kind);
                let pairs = &parts.pairs;
                let count = parts.positions.len();
                let mut inner = 0;
                for i in 0..count {
                    for k in pairs.starts[i]..pairs.starts[i + 1] {
                        let (j, weight) = (pairs.partners[k] as usize, pairs.weights[k]);
                        assert!(weight >= 0.0 && weight.is_finite(), "{} {domain:?} {numerics}: {weight}", kind.name);
                        if j < count {
                            let row = pairs.starts[j]..pairs.starts[j + 1];
                            let back = row.clone().find(|back| pairs.partners[*back] as usize == i);
                            let back = back.map(|back| pairs.weights[back].to_bits());
                            assert_eq!(back, Some(weight.to_bits()), "{} {domain:?} {numerics}", kind.name);
                            inner += 1;
                        }
                    }
                }
                assert!(inner >= 2 * (count - 1) && inner % 2 == 0, "{}: {inner} pairs", kind.name);
            }
        }
    }
}

#[test]
fn best_weights_conduct_as_they_should() {
    for kind in methods() {
        for domain in [LINE, RECTANGLE] {
            let dimension = domain.dimension();
            let sketch = Sketch::new(domain, SPACING);
            let scene = sketch.scene(kind);
            let stencil = scene.methods[0].stencil(SPACING, dimension);
            // Rounding of some fifty terms: 50 eps = 1.1e-14.
            assert!((stencil.moment(SPACING) - 1.0).abs() < 1e-13, "{} {domain:?}", kind.name);
            assert!(stencil.offsets().all(|offset| offset.2 > 0.0), "{} {domain:?}", kind.name);
            // On the list every particle has a whole neighbourhood, ghosts included. Distances are differences of
            // positions up to 2.4 m, 24 spacings: they are good to 24 eps, their squares to twice that, and so is
            // what normalises them.
            let parts = assembled(&sketch, kind);
            for i in 0..parts.positions.len() {
                let moment = moment(&parts, i, dimension);
                assert!((moment - 1.0).abs() < 1e-13, "{} {domain:?}: {moment} of particle {i}", kind.name);
            }
        }
    }
}

/// On a cloud each particle scales its pairs by its own neighbourhood and pairs take the mean of both scales, so
/// single particles miss the moment; in a body between mirrors, which repeats to a periodic one, the mean is exact.
#[test]
fn clouds_conduct_as_they_should_on_average() {
    for kind in methods().iter().filter(|kind| !kind.lattice_only) {
        for domain in [LINE, RECTANGLE] {
            let parts = assembled(&Sketch::new(domain, SPACING).with(JITTERED), kind);
            let count = parts.positions.len();
            let moments: Vec<f64> = (0..count).map(|i| moment(&parts, i, domain.dimension())).collect();
            let mean = moments.iter().sum::<f64>() / count as f64;
            // Rounding as above; measured below 1e-15.
            assert!((mean - 1.0).abs() < 1e-13, "{} {domain:?}: {mean}", kind.name);
            assert!(moments.iter().any(|moment| (moment - 1.0).abs() > 1e-3), "{}: nothing was moved", kind.name);
        }
    }
}

#[test]
fn pipes_are_shared_out_whole() {
    for kind in methods() {
        for (sector, parts_of_ring) in [(Sector::Quarter, 4.0), (Sector::Half, 2.0), (Sector::Whole, 1.0)] {
            let mut sketch = Sketch::new(ring(sector), SPACING);
            sketch.pipes = vec![EIGHT_PIPES.to_owned()];
            let sinks = assembled(&sketch, kind).sinks;
            let shares: f64 = sinks.iter().map(|sink| sink.share).sum();
            // Halves and wholes add up without rounding.
            assert_eq!(shares * parts_of_ring, 8.0, "{} {sector:?}", kind.name);
            for sink in &sinks {
                let sum: f64 = sink.sample.iter().map(|entry| entry.1).sum();
                // Some forty weights that were divided by their sum: 40 eps = 9e-15.
                assert!((sum - 1.0).abs() < 1e-14 && sink.sample.iter().all(|entry| entry.1 > 0.0));
            }
        }
    }
}

fn assert_at_rest(plan: &mut Plan, name: &str) {
    advance(plan, 2);
    let moved = plan.particles.enthalpy.iter().position(|enthalpy| *enthalpy != 0.0);
    assert_eq!(moved, None, "{name}: {:?}", moved.map(|i| plan.particles.enthalpy[i]));
    assert!(plan.method.ledger().heat().iter().all(|heat| *heat == 0.0), "{name}: {:?}", plan.method.ledger());
}

#[test]
fn a_constant_field_stays_at_rest_to_the_last_bit() {
    for kind in methods() {
        for domain in [LINE, RECTANGLE] {
            for variant in variants(kind, domain) {
                let mut warm = variant.sketch.clone();
                let mut frozen = variant.sketch.clone();
                // Thirds and sevenths, which no arithmetic represents.
                warm.initial_c = 10.0 / 3.0;
                frozen.initial_c = -50.0 / 7.0;
                // Some walls are held at the same temperature, the others are symmetry planes.
                // The warm side of a curve is that of a sharp law, and its table takes long to make.
                let starts = if variant.curved { vec![frozen] } else { vec![warm, frozen] };
                for sketch in starts {
                    let held = format!("temperature_c = {}", sketch.initial_c);
                    let sketch = sketch.wall("left", held.clone());
                    let sketch = if domain.dimension() == 2 { sketch.wall("top", held) } else { sketch };
                    assert_at_rest(&mut sketch.plan(kind), &variant.name);
                }
            }
        }
    }
}

#[test]
fn a_constant_ring_stays_at_rest_to_the_last_bit() {
    for kind in methods() {
        for sector in [Sector::Quarter, Sector::Half, Sector::Whole] {
            for search in ["auto", "tree"] {
                let mut sketch = Sketch::new(ring(sector), SPACING)
                    .with(without_noise(kind))
                    .with(&format!("search = \"{search}\""))
                    .wall("outer", "temperature_c = 7.3");
                sketch.initial_c = 7.3;
                sketch.pipes = vec![EIGHT_PIPES.replace("-20", "7.3")];
                assert_at_rest(&mut sketch.plan(kind), &format!("{} {sector:?} {search}", kind.name));
            }
        }
    }
}

/// Reflects a sketch of a rectangle or a line in x, or in y.
fn mirrored(sketch: &Sketch, in_y: bool) -> Sketch {
    let mut mirrored = sketch.clone();
    let extent = match sketch.domain {
        Domain::Line { length } => length,
        Domain::Rectangle { width, height } => {
            if in_y {
                height
            } else {
                width
            }
        }
        _ => unreachable!("only straight bodies"),
    };
    for wall in &mut mirrored.walls {
        wall.0 = match (wall.0, in_y) {
            ("left", false) => "right",
            ("right", false) => "left",
            ("bottom", true) => "top",
            ("top", true) => "bottom",
            (name, _) => name,
        };
    }
    let (low, high) = if in_y { ("y_min_m", "y_max_m") } else { ("x_min_m", "x_max_m") };
    for region in &mut mirrored.regions {
        let lines = region.lines().map(|line| match line.split_once(" = ") {
            Some((key, value)) if key == low || key == high => {
                let value: f64 = value.parse().expect("a number");
                format!("{} = {}", if key == low { high } else { low }, extent - value)
            }
            _ => line.to_owned(),
        });
        *region = lines.collect::<Vec<_>>().join("\n");
    }
    mirrored
}

/// How far two runs may drift apart by rounding alone: in every step each of some fifty pairs of a particle rounds a
/// term that is smaller than the span of enthalpies, distances on the list are rounded at the scale of the body and
/// not of the spacing (a factor of extent over spacing), and the exchange itself does not enlarge differences.
fn rounding(plan: &Plan, steps: u64, temperatures: (f64, f64)) -> f64 {
    let span = |thermal: &frazil_core::physics::thermal::Thermal| {
        thermal.enthalpy(temperatures.0).abs().max(thermal.enthalpy(temperatures.1).abs())
    };
    let span = plan.particles.materials.thermals.iter().map(span).fold(0.0, f64::max);
    let lattice = &plan.particles.lattice;
    steps as f64 * 50.0 * f64::EPSILON * span * lattice.columns.max(lattice.rows) as f64
}

/// How much larger roundings of temperatures are, taken as enthalpies, than those of enthalpies: where temperature is
/// the unknown, they come back multiplied by the largest apparent capacity.
fn rounding_of_temperatures(plan: &Plan, (low, high): (f64, f64)) -> f64 {
    let ratio = |thermal: &frazil_core::physics::thermal::Thermal| {
        let capacities =
            (0..=1000).map(|k| thermal.curve.apparent_capacity(low + (high - low) * f64::from(k) / 1000.0));
        let span = thermal.enthalpy(low).abs().max(thermal.enthalpy(high).abs());
        capacities.fold(0.0, f64::max) * (high - low) / span
    };
    plan.particles.materials.thermals.iter().map(ratio).fold(1.0, f64::max)
}

#[test]
fn the_mirror_image_of_a_scene_has_mirrored_states() {
    const STEPS: u64 = 30;
    for kind in methods() {
        for domain in [LINE, RECTANGLE] {
            // Clouds have no mirror image: their shifts are random.
            let on_lattice = |variant: &Variant| !variant.sketch.numerics.contains("jittered");
            for variant in variants(kind, domain).into_iter().filter(on_lattice) {
                let mut sketch = variant.sketch;
                sketch.duration_s = 1e7;
                for (name, line) in four_walls().into_iter().take(2 * domain.dimension()) {
                    sketch = sketch.wall(name, line);
                }
                let mut own = sketch.plan(kind);
                advance(&mut own, STEPS);
                let temperatures = (-18.0, 3.0);
                let roundings = rounding(&own, STEPS, temperatures);
                let bound = match variant.scheme {
                    "apparent-capacity" => roundings * rounding_of_temperatures(&own, temperatures),
                    _ => roundings,
                };
                let (columns, rows) = (own.particles.lattice.columns, own.particles.lattice.rows);
                for in_y in [false, true].into_iter().take(domain.dimension()) {
                    let mut other = mirrored(&sketch, in_y).plan(kind);
                    advance(&mut other, STEPS);
                    let mut worst: f64 = 0.0;
                    for row in 0..rows {
                        for column in 0..columns {
                            let image = if in_y {
                                (rows - 1 - row) * columns + column
                            } else {
                                row * columns + columns - 1 - column
                            };
                            let here = own.particles.enthalpy[row * columns + column];
                            worst = worst.max((here - other.particles.enthalpy[image]).abs());
                        }
                    }
                    assert!(worst <= bound, "{}: {worst:e} J/m3, rounding explains {bound:e}", variant.name);
                }
                let cooled = own.particles.enthalpy.iter().any(|enthalpy| enthalpy.abs() > 1e6 * bound);
                assert!(cooled, "{}: nothing happened", variant.name);
            }
        }
    }
}

/// How a field is drawn between two temperatures.
#[derive(Debug, Clone, Copy)]
enum Draw {
    /// Anything between.
    Between,
    /// One of the two.
    Either,
    /// The first everywhere, the second in one particle: where a step that is too long shows first.
    Spike,
}

#[test]
fn temperatures_stay_within_the_data_at_the_bound_of_the_step() {
    for kind in methods() {
        for domain in [LINE, RECTANGLE, DISC, NARROW] {
            // Explicit Euler promises it for the potential; means of conductivities make no such promise beside
            // walls and on clouds (they do leave the data there), nor does an apparent capacity that a step may leave.
            // Noise does not reach over a body, so its methods do not either; and the second material would lie outside.
            let fits = |variant: &Variant| domain != NARROW || !kind.stochastic && variant.sketch.regions.is_empty();
            let promised = |variant: &Variant| variant.potential && variant.scheme == "enthalpy" && fits(variant);
            for (number, variant) in variants(kind, domain).into_iter().filter(promised).enumerate() {
                let mut random = StdRng::seed_from_u64(number as u64);
                // Through the freezing point, and frozen throughout, where diffusivity and the bound are greatest.
                for (low, high) in [(-10.0, 10.0), (-10.0, -2.0)] {
                    let mut sketch = variant.sketch.clone().with("step_fraction = 1.0");
                    sketch.duration_s = 1e8;
                    sketch.initial_c = random.random_range(low..high);
                    let walls: &[&'static str] = match domain {
                        Domain::Line { .. } => &["left", "right"],
                        Domain::Rectangle { .. } => &["left", "right", "bottom", "top"],
                        Domain::Ring { .. } => &["outer"],
                        Domain::Radial { .. } | Domain::Axial { .. } => unreachable!("shells have tests of their own"),
                    };
                    for name in walls.iter().copied() {
                        let temperature: f64 = if random.random() { low } else { random.random_range(low..high) };
                        let line = wall_by_chance(&mut random, temperature);
                        sketch = sketch.wall(name, line);
                    }
                    let mut plan = sketch.plan(kind);
                    for draw in [Draw::Between, Draw::Either, Draw::Spike, Draw::Spike] {
                        let count = plan.particles.len();
                        let spike = if random.random() { 0 } else { random.random_range(0..count) };
                        for i in 0..count {
                            let temperature = match draw {
                                Draw::Between => random.random_range(low..high),
                                Draw::Either => *[low, high].get(random.random_range(0..2)).expect("one of two"),
                                Draw::Spike => [low, high][usize::from(i == spike)],
                            };
                            plan.particles.enthalpy[i] = plan.particles.materials.of(i).enthalpy(temperature);
                        }
                        for _ in 0..3 {
                            advance(&mut plan, 1);
                            for i in 0..count {
                                let temperature = plan.particles.temperature(i);
                                let slack = 1e-12 * (high - low);
                                assert!(
                                    temperature >= low - slack && temperature <= high + slack,
                                    "{}: {temperature} of particle {i}, {draw:?}\n{}",
                                    variant.name,
                                    sketch.text(kind.name)
                                );
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The bound is no smaller than it must be: a hundredth beyond it, a lone warm particle in a cold body overshoots.
#[test]
fn the_bound_of_the_step_is_sharp() {
    for kind in methods() {
        for domain in [LINE, RECTANGLE] {
            for search in ["auto", "tree"] {
                let mut sketch =
                    Sketch::new(domain, SPACING).with(without_noise(kind)).with(&format!("search = \"{search}\""));
                sketch.initial_c = -10.0;
                sketch.duration_s = 1e8;
                let coldest = |beyond: f64| {
                    let mut plan = sketch.clone().with("step_fraction = 1.0").plan(kind);
                    let lattice = &plan.particles.lattice;
                    let middle = lattice.rows / 2 * lattice.columns + lattice.columns / 2;
                    plan.particles.enthalpy[middle] = plan.particles.materials.of(middle).enthalpy(-2.0);
                    plan.step *= beyond;
                    advance(&mut plan, 1);
                    plan.particles.temperature(middle)
                };
                // It keeps 8 K (1 - step sum of weights x slope), which is nothing at the bound; rounding of -10.
                let name = format!("{} {domain:?} {search}", kind.name);
                assert!((coldest(1.0) + 10.0).abs() < 1e-12, "{name}: {}", coldest(1.0));
                assert!((coldest(1.01) + 10.08).abs() < 1e-12, "{name}: {}", coldest(1.01));
            }
        }
    }
}

#[test]
fn the_heat_balance_closes_to_rounding() {
    for kind in methods() {
        for domain in [LINE, RECTANGLE] {
            // An apparent capacity loses heat where a step leaves the interval: its balance is a result, not a law.
            let conserving = |variant: &Variant| variant.scheme != "apparent-capacity";
            for variant in variants(kind, domain).into_iter().filter(conserving) {
                let mut sketch = variant.sketch;
                sketch.duration_s = 2e5;
                sketch.outputs = 3;
                for (name, line) in four_walls().into_iter().take(2 * domain.dimension()) {
                    sketch = sketch.wall(name, line);
                }
                check_balance(&sketch, kind, &variant.name);
            }
        }
        for search in ["auto", "tree"] {
            let mut sketch = Sketch::new(ring(Sector::Quarter), SPACING)
                .with(without_noise(kind))
                .with(&format!("search = \"{search}\""))
                .wall("outer", "coefficient_W_per_m2_K = 15\nambient_c = { times_h = [0, 100], values = [3, 9] }");
            sketch.duration_s = 1e6;
            sketch.pipes = vec![EIGHT_PIPES.replace("-20", "{ times_h = [0, 50], values = [3, -20] }")];
            check_balance(&sketch, kind, &format!("ring of {}, search {search}", kind.name));
        }
    }
}

/// A wall of given flux brings that flux over its whole area, whatever the walls beside it do and however a body is kept.
#[test]
fn a_wall_of_given_flux_brings_it_up_to_its_corners() {
    for kind in methods() {
        for search in ["auto", "tree"] {
            for law in LAWS.map(|law| law.0) {
                let mut sketch = Sketch::new(RECTANGLE, SPACING)
                    .with(without_noise(kind))
                    .with(&format!("search = \"{search}\""))
                    .wall("top", "flux_W_per_m2 = 25");
                sketch.materials = vec![("water", water(&format!("{law}, temperature_c = 0")))];
                sketch.duration_s = 1e5;
                for (name, line) in four_walls().into_iter().take(3) {
                    sketch = sketch.wall(name, line);
                }
                let result = sketch.run(kind);
                let last = result.budget.last().expect("an output");
                for (wall, flux) in [("bottom", -40.0), ("top", 25.0)] {
                    let k = result.budget_names.iter().position(|name| name == wall).expect("a wall");
                    let brought = flux * 0.9 * last.time_s;
                    // Rounding of sums of what pairs move to and fro.
                    let off = (last.in_j[k] / brought - 1.0).abs();
                    assert!(off < 1e-11, "{} {search} {law} {wall}: {off:e}", kind.name);
                }
            }
        }
    }
}

fn check_balance(sketch: &Sketch, kind: &'static MethodKind, name: &str) {
    let result = sketch.run(kind);
    assert!(!result.budget.is_empty(), "{name}: {:?}\n{}", result.record.cause, sketch.text(kind.name));
    let balance = result.record.energy_balance_rel;
    // The wanted accuracy of the balance; rounding of the sums explains 1e-14.
    assert!(balance.abs() <= 1e-12, "{name}: {balance:e}");
    let last = result.budget.last().expect("an output");
    assert!(last.in_j.iter().any(|heat| heat.abs() > 1e5), "{name}: no heat went in: {last:?}");
}

#[test]
fn an_insulated_curved_wall_keeps_all_heat() {
    for kind in methods() {
        for numerics in ["", "search = \"tree\"", JITTERED, "mean = \"harmonic\""] {
            if kind.lattice_only && numerics == JITTERED {
                continue;
            }
            let mut plan = Sketch::new(DISC, SPACING).with(numerics).with(without_noise(kind)).plan(kind);
            let mut random = StdRng::seed_from_u64(5);
            let materials = plan.particles.materials.clone();
            for (i, enthalpy) in plan.particles.enthalpy.iter_mut().enumerate() {
                *enthalpy = materials.of(i).enthalpy(random.random_range(-20.0..20.0));
            }
            let sum = |plan: &Plan| plan.particles.enthalpy.iter().sum::<f64>();
            let (before, start) = (sum(&plan), plan.particles.enthalpy.clone());
            advance(&mut plan, 100);
            let moved: f64 = plan.particles.enthalpy.iter().zip(&start).map(|(own, was)| (own - was).abs()).sum();
            // Pairs cancel to the rounding of what a hundred steps moved.
            let lost = (sum(&plan) - before).abs() / moved;
            assert!(moved > 1e8 && lost < 1e-12, "{} {numerics}: {lost:e} of {moved:e}", kind.name);
            assert!(plan.method.ledger().heat().iter().all(|heat| *heat == 0.0), "{} {numerics}", kind.name);
        }
    }
}

#[test]
fn noise_conserves_heat() {
    for kind in methods().iter().filter(|kind| kind.stochastic) {
        for domain in [LINE, RECTANGLE] {
            for numerics in ["", JITTERED] {
                // Between mirrors nothing may change the sum at all; the random fluxes that cancel are 1e5 times
                // larger than their sum over any one particle, so 1e-10 of them is near rounding.
                let mut sketch = Sketch::new(domain, SPACING).with(numerics).with("heat_capacity_dpd = 1000");
                sketch.duration_s = 1e8;
                let mut plan = sketch.plan(kind);
                advance(&mut plan, 100);
                let moved: f64 = plan.particles.enthalpy.iter().map(|enthalpy| enthalpy.abs()).sum();
                let sum: f64 = plan.particles.enthalpy.iter().sum();
                assert!(moved > 1e5 && sum.abs() < 1e-10 * moved, "{} {domain:?}: {sum:e} of {moved:e}", kind.name);
                // Of a run, too, in which nothing comes in.
                sketch.duration_s = 2e5;
                let record = sketch.run(kind).record;
                assert_eq!(record.outcome, Outcome::Ok, "{} {domain:?}: {:?}", kind.name, record.cause);
                assert!(record.energy_balance_rel.abs() <= 1e-10, "{} {domain:?}", kind.name);
                // With walls, what has come in through them is what is stored.
                for (name, line) in four_walls().into_iter().take(2 * domain.dimension()) {
                    sketch = sketch.wall(name, line);
                }
                let balance = sketch.run(kind).record.energy_balance_rel;
                assert!(balance.abs() <= 1e-10, "{} {domain:?}: {balance:e}", kind.name);
            }
        }
    }
}

#[test]
fn the_lattice_and_every_list_take_the_same_steps() {
    const STEPS: u64 = 60;
    for kind in methods() {
        for (domain, laws) in [(LINE, &LAWS[..]), (RECTANGLE, &LAWS[..]), (ring(Sector::Quarter), &LAWS[1..2])] {
            for (law, _) in laws {
                // A list knows no fronts inside particles, and steps by error are not the same to rounding.
                let mut sketch = Sketch::new(domain, SPACING).with(without_noise(kind)).with("front = \"cell\"");
                sketch = sketch.with("integrator = \"euler\"");
                sketch.duration_s = 1e8;
                sketch.materials = vec![("water", water(&format!("{law}, temperature_c = 0")))];
                if matches!(domain, Domain::Ring { .. }) {
                    sketch = sketch.wall("outer", "temperature_c = -5");
                    sketch.pipes = vec![EIGHT_PIPES.to_owned()];
                }
                for (name, line) in four_walls().into_iter().take(2 * domain.dimension()) {
                    sketch = sketch.wall(name, line);
                }
                let mut auto = sketch.plan(kind);
                advance(&mut auto, STEPS);
                let bound = rounding(&auto, STEPS, (-20.0, 3.0));
                assert!(auto.particles.enthalpy.iter().any(|enthalpy| enthalpy.abs() > 1e6 * bound));
                for search in ["tree", "cells", "all-pairs"] {
                    let mut list = sketch.clone().with(&format!("search = \"{search}\"")).plan(kind);
                    // The bound of the list looks at each particle and may be longer.
                    list.step = auto.step;
                    advance(&mut list, STEPS);
                    let worst = (auto.particles.enthalpy.iter().zip(&list.particles.enthalpy))
                        .map(|(a, b)| (a - b).abs())
                        .fold(0.0, f64::max);
                    let name = format!("{} {domain:?} {law} {search}", kind.name);
                    assert!(worst <= bound, "{name}: {worst:e} J/m3, rounding explains {bound:e}");
                    for (own, other) in auto.method.ledger().heat().iter().zip(list.method.ledger().heat()) {
                        // Patches are sums over particles: their rounding is that of all of them.
                        let bound = bound * auto.particles.volumes.of(0) * auto.particles.len() as f64;
                        assert!((own - other).abs() <= bound, "{name}: {own} and {other} J through a patch");
                    }
                }
            }
        }
    }
}

#[test]
fn a_quarter_a_half_and_the_whole_ring_freeze_alike() {
    for kind in methods() {
        let results = [Sector::Quarter, Sector::Half, Sector::Whole].map(|sector| {
            let mut sketch = Sketch::new(ring(sector), SPACING)
                .with(without_noise(kind))
                .with("step_s = 900")
                .wall("outer", "temperature_c = 3");
            sketch.materials =
                vec![("sand", sand("law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 52875.8"))];
            sketch.duration_s = 40.0 * 86_400.0;
            sketch.outputs = 8;
            sketch.pipes = vec![EIGHT_PIPES.to_owned()];
            sketch.run(kind)
        });
        let closure =
            |result: &frazil_record::RunResult| result.gaps.iter().filter_map(|gap| gap.closure_s).fold(0.0, f64::max);
        let [quarter, half, whole] = &results;
        assert!(closure(whole) > 0.0 && whole.gaps.iter().all(|gap| gap.closure_s.is_some()), "{}", kind.name);
        for part in [quarter, half] {
            // Sums over a part and over the whole round differently, some 1e-13 over thousands of steps; a phase
            // change that falls into another step moves a closure by less than that step's share of a look.
            let name = format!("{}, {} particles", kind.name, part.record.particles);
            assert!((closure(part) / closure(whole) - 1.0).abs() < 1e-9, "{name}: {}", closure(part) / closure(whole));
            for (own, other) in part.walls.iter().zip(&whole.walls) {
                assert!((own.frozen_area_m2 / other.frozen_area_m2 - 1.0).abs() < 1e-9, "{name}: {own:?} {other:?}");
                for (own_mean, other_mean) in thicknesses(own).into_iter().zip(thicknesses(other)) {
                    assert!((own_mean - other_mean).abs() < 1e-9, "{name}: {own:?} {other:?}");
                }
                assert!((own.heat_per_pipe_w_per_m / other.heat_per_pipe_w_per_m - 1.0).abs() < 1e-9, "{name}");
            }
        }
    }
}
