//! A smaller scene gives the answer of the larger one, and is found only where there is one.

use frazil::registry::methods;
use frazil_core::space::domain::{Domain, Sector};
use frazil_record::RunResult;
use frazil_scene::Scene;
use frazil_scene::method::MethodKind;
use frazil_simulation::march::{self, Options};
use frazil_simulation::reduce::{self, Finding, Reduction};
use rand::{RngExt, SeedableRng, rngs::StdRng, seq::IndexedRandom};

use crate::sketch::{Sketch, even, sand, thicknesses, water, without_noise};

const SPACING: f64 = 0.05;

/// Agreement asked for: temperatures over the range of the scene's data, lengths and areas over the body's, heat over
/// the largest heat of the run. Both runs make the same steps of the same sums in another order, and no step lets
/// differences grow (maximum principle): some hundred roundings of 1e-16 each, and room for sums over particles.
const SAME: f64 = 1e-10;

fn found(scene: &Scene) -> Finding {
    reduce::find(scene, scene.methods[0].method, None).unwrap_or_else(|refused| unreachable!("{refused}"))
}

fn smaller(scene: &Scene) -> Option<Box<Reduction>> {
    match found(scene) {
        Finding::Smaller(reduction) => Some(reduction),
        Finding::Kept(_) | Finding::Whole => None,
    }
}

/// Largest difference of two series of numbers over a scale.
fn difference(name: &str, own: &[f64], other: &[f64], scale: f64) -> f64 {
    assert_eq!(own.len(), other.len(), "rows of {name}");
    let worst = own.iter().zip(other).map(|(own, other)| (own - other).abs()).fold(0.0, f64::max);
    if worst == 0.0 { 0.0 } else { worst / scale }
}

/// Largest difference of anything that two runs leave, each over its own scale.
fn largest_difference(scene: &Scene, own: &RunResult, other: &RunResult) -> f64 {
    let (least, greatest) = scene.temperature_range();
    // Where fluxes alone drive heat, what was seen is the range.
    let seen = own.profiles.iter().chain(&other.profiles).map(|row| row.temperature_c);
    let (least, greatest) = seen.fold((least, greatest), |(low, high), t| (low.min(t), high.max(t)));
    let (range, length) = (greatest - least, scene.domain.extent());
    let of = |name: &str, scale: f64, read: &dyn Fn(&RunResult) -> Vec<f64>| {
        difference(name, &read(own), &read(other), scale)
    };
    let largest = |read: &dyn Fn(&RunResult) -> Vec<f64>| read(own).into_iter().map(f64::abs).fold(0.0, f64::max);
    let heat = |run: &RunResult| run.budget.iter().flat_map(|row| [&[row.stored_j], &row.in_j[..]].concat()).collect();
    assert_eq!(own.budget_names, other.budget_names);
    // The longest of steps by error is theirs to rounding.
    let (step, other_step) = (own.record.step_s, other.record.step_s);
    assert!(own.record.steps == other.record.steps && (step / other_step - 1.0).abs() < 1e-12, "{step}, {other_step}");
    let planes = |run: &RunResult| run.profiles.iter().map(|row| row.plane.clone()).collect::<Vec<_>>();
    assert_eq!(planes(own), planes(other));
    let gaps = |run: &RunResult| run.gaps.iter().map(|gap| (gap.gap, gap.multiplicity)).collect::<Vec<_>>();
    assert_eq!(gaps(own), gaps(other));
    let closed = |run: &RunResult| run.gaps.iter().map(|gap| gap.closure_s.is_some()).collect::<Vec<_>>();
    assert_eq!(closed(own), closed(other));
    let shape = |run: &RunResult| run.fields.iter().map(|field| (field.nx, field.ny)).collect::<Vec<_>>();
    // A plane in which nothing varies across has no map of its line.
    let maps = !other.fields.is_empty();
    if maps {
        assert_eq!(shape(own), shape(other));
    }
    let ring = scene.rings.first().map_or(1.0, |ring| ring.count as f64);
    [
        of("profiles", range, &|run| run.profiles.iter().map(|row| row.temperature_c).collect()),
        of("fractions", 1.0, &|run| run.profiles.iter().map(|row| row.frozen_fraction).collect()),
        of("places of profiles", length, &|run| run.profiles.iter().map(|row| row.along_m).collect()),
        of("times", scene.duration, &|run| run.profiles.iter().map(|row| row.time_s).collect()),
        of("probes", range, &|run| run.probes.iter().map(|row| row.temperature_c).collect()),
        of("places of probes", length, &|run| run.probes.iter().flat_map(|row| [row.x_m, row.y_m]).collect()),
        of("front", length, &|run| run.front.iter().map(|row| row.front_m).collect()),
        of("heat", largest(&heat), &heat),
        of("thickness", length, &|run| run.walls.iter().map(|row| thicknesses(row)[0]).collect()),
        of("thickness between", length, &|run| run.walls.iter().map(|row| thicknesses(row)[1]).collect()),
        of("frozen area", length * length, &|run| run.walls.iter().map(|row| row.frozen_area_m2).collect()),
        of("heat of a pipe", largest(&|run| run.walls.iter().map(|row| row.heat_per_pipe_w_per_m).collect()), &|run| {
            run.walls.iter().map(|row| row.heat_per_pipe_w_per_m).collect()
        }),
        of("closure", scene.duration, &|run| run.gaps.iter().filter_map(|gap| gap.closure_s).collect()),
        of("angles", 360.0 * ring, &|run| run.gaps.iter().map(|gap| gap.angle_deg.expect("a ring")).collect()),
        of("maps", range, &|run| {
            let values = run.fields.iter().filter(|_| maps).flat_map(|field| field.temperature_c.clone());
            values.map(|value| if value.is_nan() { 0.0 } else { value }).collect()
        }),
    ]
    .into_iter()
    .fold(0.0, f64::max)
}

/// Runs a scene whole and reduced.
fn assert_same(sketch: &Sketch, kind: &'static MethodKind) -> f64 {
    let scene = sketch.scene(kind);
    let text = sketch.text(kind.name);
    let Some(reduction) = smaller(&scene) else { unreachable!("no smaller scene for\n{text}") };
    let options = Options { fields: true, ..Options::default() };
    let whole = march::run(&scene, kind.name, None, &options).unwrap_or_else(|refused| unreachable!("{refused}"));
    let reduced = reduction.run(None, &options).unwrap_or_else(|refused| unreachable!("{refused}"));
    assert!(reduced.record.reduced_from.is_some() && whole.record.reduced_from.is_none());
    assert!(reduced.record.particles < whole.record.particles);
    let worst = largest_difference(&scene, &whole, &reduced);
    assert!(worst <= SAME, "{}: {worst:e} in\n{text}", kind.name);
    worst
}

/// A condition of a wall that drives heat.
fn condition(random: &mut StdRng) -> String {
    let [a, b, c]: [f64; 3] = [(); 3].map(|()| random.random_range(-25.0..10.0));
    match random.random_range(0..4) {
        0 => format!("temperature_c = {a}"),
        1 => format!("temperature_c = {{ times_h = [0, 1, 3], values = [{a}, {b}, {c}] }}"),
        2 => format!("flux_W_per_m2 = {}", 10.0 * a),
        _ => format!("coefficient_W_per_m2_K = {}\nambient_c = {b}", 5.0 + a.abs()),
    }
}

/// Freezing law, latent-heat scheme, exchange and integrator of a body.
fn physics(sketch: &mut Sketch, random: &mut StdRng) {
    let choice = |random: &mut StdRng, words: &[&'static str]| *words.choose(random).expect("words");
    let law = choice(random, &["none", "isothermal", "linear", "weibull"]);
    let rest = match law {
        "none" => "",
        "isothermal" => ", latent_heat_J_per_kg = 50000",
        _ => ", latent_heat_J_per_kg = 50000, width_K = 2",
    };
    let law = format!("law = \"{law}\"{rest}, temperature_c = 0");
    sketch.materials = vec![("water", water(&law))];
    if !sketch.regions.is_empty() {
        sketch.materials.push(("sand", sand(&law)));
    }
    let exchange = choice(random, &["", "", "mean = \"harmonic\"", "mean = \"arithmetic\"\nmushy = false"]);
    let is_plain = exchange.is_empty();
    let search = choice(random, &["", "search = \"tree\""]);
    let integrator = choice(random, &["", "", "integrator = \"rkl2\"\nstages = 5"]);
    for line in [exchange, search, if is_plain { integrator } else { "" }] {
        *sketch = sketch.clone().with(line);
    }
    sketch.duration_s = 4.0 * 3600.0;
    sketch.outputs = 5;
}

/// Extent of a whole and even number of particles.
fn extent(random: &mut StdRng, cells: std::ops::Range<usize>) -> f64 {
    2.0 * random.random_range(cells) as f64 * SPACING
}

fn region(x: (f64, f64), y: Option<(f64, f64)>) -> String {
    let y = y.map_or(String::new(), |y| format!("\ny_min_m = {}\ny_max_m = {}", y.0, y.1));
    format!("material = \"sand\"\nx_min_m = {}\nx_max_m = {}{y}", x.0, x.1)
}

#[test]
fn a_line_stands_for_a_plane_in_which_nothing_varies_across() {
    let mut random = StdRng::seed_from_u64(1);
    for round in 0..12 {
        let (along, across) = (extent(&mut random, 6..12), extent(&mut random, 4..7));
        let along_y = round % 2 == 1;
        let (width, height) = if along_y { (across, along) } else { (along, across) };
        let mut sketch = Sketch::new(Domain::Rectangle { width, height }, SPACING);
        let ends = if along_y { ["bottom", "top"] } else { ["left", "right"] };
        for name in ends {
            sketch = sketch.wall(name, condition(&mut random));
        }
        if random.random_bool(0.5) {
            let layer = (0.2 * along, 0.55 * along);
            let (x, y) = if along_y { ((0.0, width), layer) } else { (layer, (0.0, height)) };
            sketch.regions = vec![region(x, Some(y))];
        }
        physics(&mut sketch, &mut random);
        let points = [(0.31, 0.77), (0.9, 0.2)].map(|(x, y)| format!("[{}, {}]", x * width, y * height));
        sketch.watch = format!("probes_m = [{}]\nprofile_length_m = {}", points.join(", "), 0.8 * along);
        for kind in even() {
            assert_same(&sketch, kind);
        }
    }
}

#[test]
fn half_of_a_line_and_a_half_or_a_quarter_of_a_rectangle_stand_for_the_whole() {
    let mut random = StdRng::seed_from_u64(2);
    for round in 0..12 {
        let (width, height) = (extent(&mut random, 6..10), extent(&mut random, 6..10));
        let line = round % 3 == 0;
        let domain = if line { Domain::Line { length: width } } else { Domain::Rectangle { width, height } };
        let mut sketch = Sketch::new(domain, SPACING);
        let (sides, ends) = (condition(&mut random), condition(&mut random));
        sketch = sketch.wall("left", sides.clone()).wall("right", sides);
        if !line {
            // Symmetric about one middle or about both, and never the same all along a direction.
            sketch = sketch
                .wall("bottom", ends.clone())
                .wall("top", if round % 3 == 1 { ends } else { condition(&mut random) });
        }
        if random.random_bool(0.5) {
            let middle = (0.3 * width, 0.7 * width);
            sketch.regions = vec![region(middle, (!line).then_some((0.4 * height, 0.6 * height)))];
        }
        physics(&mut sketch, &mut random);
        let probe = if line { format!("[{}]", 0.83 * width) } else { format!("[{}, {}]", 0.83 * width, 0.12 * height) };
        sketch.watch = format!("probes_m = [{probe}]");
        if line {
            sketch.watch.push_str(&format!("\nprofile_length_m = {}", random.random_range(0.2..1.0) * width));
        }
        for kind in even() {
            assert_same(&sketch, kind);
        }
    }
}

#[test]
fn a_sector_stands_for_a_larger_one_and_all_gaps_are_told() {
    let mut random = StdRng::seed_from_u64(3);
    let firsts = [(8, 0.0), (6, 30.0), (4, 45.0)];
    for (round, (count, first)) in firsts.into_iter().enumerate() {
        for sector in [Sector::Whole, Sector::Half] {
            let mut sketch =
                Sketch::new(Domain::Ring { outer_radius: 1.5, sector }, SPACING).wall("outer", condition(&mut random));
            if round == 1 {
                sketch.regions =
                    vec![region((-1.5, 1.5), Some((if sector == Sector::Half { 0.0 } else { -0.05 }, 0.05)))];
            }
            physics(&mut sketch, &mut random);
            sketch.initial_c = 2.0;
            sketch.duration_s = 3.0 * 86_400.0;
            sketch.pipes = vec![format!(
                "count = {count}\nring_radius_m = 0.6\nfirst_angle_deg = {first}\npipe_radius_m = 0.03\ntemperature_c = -30"
            )];
            sketch.watch = "probes_m = [[-0.4, 0.2], [0.7, 0.6]]".into();
            for kind in even() {
                assert_same(&sketch, kind);
            }
        }
    }
}

/// Every one of these bodies lacks the symmetry that its neighbour above or below has.
#[test]
fn bodies_without_symmetry_are_left_whole() {
    let rectangle = Domain::Rectangle { width: 1.2, height: 0.8 };
    let cold = |sketch: Sketch| sketch.wall("left", "temperature_c = -10").wall("right", "temperature_c = 2");
    let pipes = |count: usize, first: f64, cold: f64| {
        format!(
            "count = {count}\nring_radius_m = 0.6\nfirst_angle_deg = {first}\npipe_radius_m = 0.03\ntemperature_c = {cold}"
        )
    };
    let law = "law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 50000";
    let with_sand = |mut sketch: Sketch, x: (f64, f64), y: Option<(f64, f64)>| {
        sketch.materials.push(("sand", sand(law)));
        sketch.regions = vec![region(x, y)];
        sketch
    };
    let ring = |sector: Sector, lines: &[String]| {
        let mut sketch =
            Sketch::new(Domain::Ring { outer_radius: 1.5, sector }, SPACING).wall("outer", "temperature_c = 3");
        sketch.pipes = lines.to_vec();
        sketch
    };
    let line = Sketch::new(Domain::Line { length: 1.2 }, SPACING);
    let bodies: Vec<(&str, Sketch)> = vec![
        ("ends differ", cold(line.clone())),
        ("ends follow other series", {
            let series = |last: f64| format!("temperature_c = {{ times_h = [0, 1], values = [0, {last}] }}");
            line.clone().wall("left", series(-5.0)).wall("right", series(-5.001))
        }),
        ("a layer off the middle of a line", {
            let sketch = line.clone().wall("left", "temperature_c = -10").wall("right", "temperature_c = -10");
            with_sand(sketch, (0.3, 0.6), None)
        }),
        ("a side that lets heat through", { cold(Sketch::new(rectangle, SPACING)).wall("top", "flux_W_per_m2 = -5") }),
        ("a region off both middles", {
            with_sand(cold(Sketch::new(rectangle, SPACING)), (0.3, 0.6), Some((0.0, 0.5)))
        }),
        ("a region one particle short of the edge", {
            with_sand(cold(Sketch::new(rectangle, SPACING)), (0.3, 0.6), Some((0.0, 0.75)))
        }),
        ("a pipe that failed, by rings of one", {
            let all: Vec<String> = (0..8).map(|k| pipes(1, 45.0 * k as f64, -20.0)).collect();
            ring(Sector::Whole, &all[..7])
        }),
        ("a ring turned off the axes", ring(Sector::Whole, &[pipes(8, 10.0, -20.0)])),
        ("five pipes, symmetric about the y axis alone", ring(Sector::Whole, &[pipes(5, 90.0, -20.0)])),
        ("a warmer ring turned against the first", {
            ring(Sector::Whole, &[pipes(8, 0.0, -20.0), pipes(3, 17.0, -5.0).replace("0.6", "0.9")])
        }),
        ("ground that differs left and right", {
            with_sand(ring(Sector::Half, &[pipes(8, 0.0, -20.0)]), (0.0, 1.5), Some((0.0, 1.5)))
        }),
        ("already a quarter", ring(Sector::Quarter, &[pipes(8, 0.0, -20.0)])),
    ];
    for (name, sketch) in bodies {
        for kind in methods() {
            let sketch = sketch.clone().with(without_noise(kind));
            let finding = found(&sketch.scene(kind));
            assert!(matches!(finding, Finding::Whole), "{name}, {}: {finding:?}", kind.name);
        }
    }
}

#[test]
fn symmetric_bodies_whose_particles_are_not_are_left_whole_with_the_reason() {
    let plane = Sketch::new(Domain::Rectangle { width: 1.2, height: 0.8 }, SPACING)
        .wall("left", "temperature_c = -10")
        .wall("right", "temperature_c = 2");
    let line = |cells: f64| {
        let cold = "temperature_c = -10";
        Sketch::new(Domain::Line { length: cells * SPACING }, SPACING).wall("left", cold).wall("right", cold)
    };
    let pd = |sketch: &Sketch| {
        let kind = methods().iter().find(|kind| kind.name == "pd").expect("pd");
        found(&sketch.scene(kind))
    };
    let jittered = plane.clone().with("layout = \"jittered\"\njitter_fraction = 0.3");
    for (sketch, word) in [
        (jittered, "irregular"),
        (plane.clone().with("wall_model = \"moving-least-squares\""), "moving-least-squares"),
        (line(21.0), "number is odd"),
        (line(4.0), "narrower"),
    ] {
        let finding = pd(&sketch);
        assert!(matches!(&finding, Finding::Kept(reason) if reason.contains(word)), "{word}: {finding:?}");
    }
    let mut pipes = Sketch::new(Domain::Ring { outer_radius: 1.5, sector: Sector::Whole }, SPACING);
    pipes.pipes = vec!["count = 4\nring_radius_m = 0.6\npipe_radius_m = 0.03\ntemperature_c = -20".into()];
    pipes.materials.push(("sand", sand("law = \"none\", temperature_c = 0")));
    pipes.regions = vec![region((-1.5, 1.5), Some((-0.6, 0.6)))];
    let finding = pd(&pipes);
    assert!(matches!(&finding, Finding::Kept(reason) if reason.contains("two materials")), "{finding:?}");
    for kind in methods().iter().filter(|kind| kind.stochastic) {
        assert!(matches!(found(&plane.scene(kind)), Finding::Kept(reason) if reason.contains("noise")));
    }
}

/// The printed column, the first hour of it: profiles and front as on the plane of 120000 particles.
#[test]
fn the_printed_soil_column_is_a_line() {
    let bundled = frazil_cases::scenes::find("soil-column-printed").expect("bundled");
    for kind in even() {
        // A hundred-odd steps: the plane is large.
        let overrides = [("time.duration_h", "0.004"), ("time.outputs", "4"), ("time.profiles_h", "[0.004]")]
            .map(|(key, value)| (key.to_owned(), value.to_owned()));
        let watch = [("watch.front_from_h".to_owned(), "0.001".to_owned())];
        let scene = Scene::read(bundled, bundled.name, bundled.name, &[&overrides[..], &watch].concat(), methods())
            .unwrap_or_else(|problems| unreachable!("{problems}"));
        let Ok(Finding::Smaller(reduction)) = reduce::find(&scene, kind.name, None) else {
            unreachable!("{}", kind.name)
        };
        let whole = march::run(&scene, kind.name, None, &Options::default()).expect("the plane");
        let line = reduction.run(None, &Options::default()).expect("the line");
        assert_eq!((whole.record.particles, line.record.particles), (120_000, 400));
        let worst = largest_difference(&scene, &whole, &line);
        assert!(worst <= SAME, "{}: {worst:e}", kind.name);
    }
}
