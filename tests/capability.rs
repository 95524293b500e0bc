//! Every pair of features, under every method: it runs and keeps its balances, or a row of the one table says why not.

use frazil::registry::methods;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::symmetry::Symmetry;
use frazil_record::Outcome;
use frazil_scene::Scene;
use frazil_scene::capability::{EXCLUSIONS, Feature};
use frazil_scene::method::MethodKind;
use frazil_simulation::march::{self, Options};

use crate::sketch::{Sketch, soil, without_noise};

const SHARP: &str = "law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 334000";
const CURVE: &str = "law = \"linear\", temperature_c = 0, latent_heat_J_per_kg = 334000, width_K = 1";

/// Ground with water in its pores.
fn ground(law: &str) -> String {
    format!(
        "{{ porosity = 0.3, permeability_m2 = 1.3e-10, \
         solid = {{ density_kg_per_m3 = 2650, conductivity_W_per_m_K = 9, heat_capacity_J_per_kg_K = 835 }}, \
         water = {{ density_kg_per_m3 = 1000, conductivity_W_per_m_K = 0.6, heat_capacity_J_per_kg_K = 4182 }}, \
         ice = {{ density_kg_per_m3 = 920, conductivity_W_per_m_K = 2.14, heat_capacity_J_per_kg_K = 2060 }}, \
         freezing = {{ {law} }} }}"
    )
}

/// A scene that has all of some features, if a body can.
fn scene_of(features: &[Feature], kind: &MethodKind) -> Option<Sketch> {
    let has = |feature| features.contains(&feature);
    let water = has(Feature::UnsaturatedWater) || has(Feature::Gravity);
    let ring = has(Feature::Ring) || has(Feature::Excavation) || has(Feature::Pipes);
    // A body is of one kind.
    if (ring || has(Feature::Cracks)) && has(Feature::Shells) || ring && has(Feature::Surfaces) {
        return None;
    }
    let domain = if ring {
        Domain::Ring { outer_radius: 4.0, sector: Sector::Half }
    } else if has(Feature::Shells) {
        Domain::Radial { symmetry: Symmetry::Axial, inner: 0.4, outer: 1.6 }
    } else {
        Domain::Rectangle { width: 1.2, height: 0.8 }
    };
    let mut sketch = Sketch::new(domain, if ring { 0.2 } else { 0.05 }).with(without_noise(kind));
    (sketch.duration_s, sketch.initial_c) = (40_000.0, 2.0);
    let law = if has(Feature::FreezingCurve) || has(Feature::NothingSharp) { CURVE } else { SHARP };
    let cold =
        if has(Feature::NaiveOpenWalls) { "coefficient_W_per_m2_K = 20\nambient_c = -9" } else { "temperature_c = -9" };
    sketch = match domain {
        Domain::Rectangle { .. } => sketch.wall("left", cold).wall("right", "temperature_c = 2"),
        _ => sketch.wall("outer", cold),
    };
    let flows = has(Feature::Groundwater) || has(Feature::GradientAdvection) && !water;
    let plain = ground(law).replace(", permeability_m2 = 1.3e-10", "");
    sketch.materials = vec![("ground", if flows { ground(law) } else { plain })];
    if has(Feature::Gravity) {
        let towards = if matches!(domain, Domain::Rectangle { .. }) { "bottom" } else { "outer" };
        sketch.gravity = format!("towards = \"{towards}\"");
    }
    if water {
        // Water of a scene of water neither freezes nor flows through frozen ground.
        if has(Feature::FreezingCurve) || has(Feature::GradientAdvection) {
            return None;
        }
        (sketch.of_water, sketch.initial_c) = (true, -2.0);
        sketch.materials = vec![("ground", soil())];
        let wet = if has(Feature::NaiveOpenWalls) { "water_flux_m_per_s = 1e-7" } else { "saturation = 1" };
        sketch = match domain {
            Domain::Rectangle { .. } => sketch.wall("left", wet).wall("right", "head_m = -2"),
            _ => sketch.wall("outer", wet),
        };
    }
    if has(Feature::PeriodicWalls) {
        if !matches!(domain, Domain::Rectangle { .. }) || water {
            return None;
        }
        for wall in ["bottom", "top"] {
            sketch = sketch.wall(wall, "condition = \"periodic\"");
        }
    }
    if has(Feature::WallParts) {
        if !matches!(domain, Domain::Rectangle { .. }) {
            return None;
        }
        let own = sketch.walls.iter().find(|wall| wall.0 == "left").map(|wall| wall.1.clone()).unwrap_or_default();
        let part = "parts = [{ from_m = 0.2, to_m = 0.45, condition = \"symmetry\" }]";
        sketch = sketch.wall("left", format!("{own}\n{part}"));
    }
    if has(Feature::FreezingCurve) && !has(Feature::NothingSharp) {
        // Two materials, of which one is sharp.
        let inside = if has(Feature::Shells) {
            "x_min_m = 0.9\nx_max_m = 1.2"
        } else {
            "circle = { x_m = 0.5, y_m = 0.4, radius_m = 0.3 }"
        };
        let sharp = if flows { ground(SHARP) } else { ground(SHARP).replace(", permeability_m2 = 1.3e-10", "") };
        sketch.materials.push(("sharp", sharp));
        sketch.regions = vec![format!("material = \"sharp\"\n{inside}")];
    }
    if has(Feature::InitialProfile) {
        let values = if sketch.of_water { "[-2, -1.5]" } else { "[2, 1]" };
        sketch.initial_along = format!("{{ x_m = [0, 1], values = {values} }}");
    }
    if has(Feature::HeatSources) {
        let inside = if has(Feature::Shells) {
            "x_min_m = 0.7\nx_max_m = 1.02"
        } else {
            "circle = { x_m = 0.7, y_m = 0.3, radius_m = 0.2 }"
        };
        sketch.regions.push(format!("heat_W_per_m3 = 400\n{inside}"));
    }
    if flows {
        sketch.flow =
            "viscosity_Pa_s = 1.793e-3\nrelative_permeability = { law = \"impedance\", impedance = 50 }\n".into();
        sketch.flow += if ring {
            "velocity_m_per_day = 0.5"
        } else {
            "walls.left = { pressure_Pa = 20 }\nwalls.right = { pressure_Pa = 0 }"
        };
    }
    if has(Feature::Anisotropy) {
        sketch.anisotropy = "conductivity_y_over_x = 2".into();
    }
    if has(Feature::RandomConductivity) {
        sketch.random = "conductivity = { log_deviation = 0.5, correlation_length_m = 0.3 }".into();
    }
    if has(Feature::Cracks) {
        sketch.cracks = vec!["from_m = [0.5, 0.3]\nto_m = [0.9, 0.5]".into()];
    }
    if has(Feature::Excavation) {
        sketch.excavation = "radius_m = 1.5\nstart_s = 15000\ncoefficient_W_per_m2_K = 20\nambient_c = 9".into();
        sketch.pipes = vec!["count = 8\nring_radius_m = 2.5\npipe_radius_m = 0.06\ntemperature_c = -20".into()];
    }
    if has(Feature::Pipes) && sketch.pipes.is_empty() {
        sketch.pipes = vec!["count = 8\nring_radius_m = 2.5\npipe_radius_m = 0.06\ntemperature_c = -20".into()];
    }
    if has(Feature::Surfaces) {
        sketch.watch =
            if has(Feature::Shells) { "surfaces = [{ r_m = 1 }]" } else { "surfaces = [{ x_m = 0.6 }]" }.into();
    }
    let settings = [
        (Feature::UnevenParticles, "layout = \"jittered\"\njitter_fraction = 0.1"),
        (Feature::PairMeans, "mean = \"harmonic\""),
        (Feature::Flags, "scheme = \"flags\""),
        (
            Feature::ApparentCapacity,
            if has(Feature::NothingSharp) || water {
                "scheme = \"apparent-capacity\""
            } else {
                "scheme = \"apparent-capacity\"\ninterval_K = 1"
            },
        ),
        (
            Feature::WholePhases,
            if has(Feature::PairMeans) { "mushy = false" } else { "mean = \"harmonic\"\nmushy = false" },
        ),
        (Feature::Stages, "integrator = \"heun\""),
        (Feature::ExplicitSteps, "integrator = \"euler\""),
        (Feature::Rkl2, "integrator = \"rkl2\""),
        (Feature::Implicit, "integrator = \"implicit\""),
        (Feature::GradientAdvection, "advection = \"central\""),
        (Feature::SubCellFronts, "front = \"sub-cell\""),
        (Feature::FittedWalls, "wall_model = \"moving-least-squares\""),
        (Feature::InnerLayers, "wall_model = \"inner-layers\""),
        (Feature::NaiveOpenWalls, "wall_model = \"naive\""),
        (Feature::LatticeSearch, "search = \"lattice\""),
        (Feature::ListSearch, "search = \"tree\""),
    ];
    let keys =
        |line: &str| line.lines().map(|line| line.split(' ').next().unwrap_or("").to_owned()).collect::<Vec<_>>();
    let mut seen: Vec<String> = Vec::new();
    for (feature, line) in settings {
        if !has(feature) {
            continue;
        }
        // A key has one value.
        if keys(line).iter().any(|key| seen.contains(key)) {
            return None;
        }
        seen.extend(keys(line));
        sketch = sketch.with(line);
    }
    Some(sketch)
}

/// Whether the scene runs, or is refused by rows alone, told at once with the line of each; else what is wrong.
fn runs(sketch: &Sketch, features: &[Feature], kind: &'static MethodKind) -> Result<bool, String> {
    let problems = match Scene::read(&sketch.text(kind.name), "pair", "pair.toml", &[], &[kind]) {
        Ok(scene) => {
            let result = march::run(&scene, kind.name, None, &Options::default());
            let record = result.map_err(|refused| format!("refused by no row: {refused}"))?.record;
            return match (record.outcome, record.energy_balance_rel) {
                (Outcome::Ok, balance) if balance.abs() < 1e-9 => Ok(true),
                // That scheme loses latent heat, and says so.
                (Outcome::PhaseSkipped, _) if features.contains(&Feature::ApparentCapacity) => Ok(true),
                (outcome, balance) => Err(format!("{outcome:?}, {balance:e}, {:?}", record.cause)),
            };
        }
        Err(problems) => problems,
    };
    // Whole phases are known beside means alone, and a ring is the body of a shaft.
    let brought = |feature: &Feature| {
        let falls = features.contains(&Feature::Gravity);
        let water = falls || features.contains(&Feature::UnsaturatedWater);
        let beside = [
            (Feature::OwnSteps, kind.stochastic),
            (Feature::LatticeWeights, kind.lattice_only),
            (Feature::FreezingCurve, features.contains(&Feature::NothingSharp)),
            (Feature::Pipes, features.contains(&Feature::Excavation)),
            (Feature::PairMeans, features.contains(&Feature::WholePhases)),
            (Feature::Groundwater, features.contains(&Feature::GradientAdvection)),
            (Feature::ExplicitSteps, features.contains(&Feature::Stages)),
            (Feature::UnsaturatedWater, falls),
            (Feature::NothingSharp, water),
            (Feature::Implicit, water),
            (Feature::Stages, water || features.contains(&Feature::Rkl2) || features.contains(&Feature::Implicit)),
            (Feature::Ring, features.contains(&Feature::Excavation) || features.contains(&Feature::Pipes)),
        ];
        features.contains(feature) || beside.contains(&(*feature, true))
    };
    for problem in &problems.problems {
        let row = EXCLUSIONS.iter().find(|row| problem.message == row.message());
        match row.filter(|row| brought(&row.asked) && brought(&row.beside) && problem.line.is_some()) {
            Some(_) => {}
            None => return Err(problems.to_string()),
        }
    }
    Ok(false)
}

#[test]
fn every_pair_of_features_runs_or_is_refused_by_a_row() {
    let (mut ran, mut refused, mut wrong) = (0, 0, Vec::new());
    for kind in methods() {
        // What another method brings along is tried under that.
        let own = |feature: &Feature| match feature {
            Feature::OwnSteps => kind.stochastic,
            Feature::LatticeWeights => kind.lattice_only,
            _ => true,
        };
        let features: Vec<Feature> = Feature::all().filter(own).collect();
        for (k, first) in features.iter().enumerate() {
            for second in &features[k + 1..] {
                let pair = [*first, *second];
                let Some(sketch) = scene_of(&pair, kind) else { continue };
                match runs(&sketch, &pair, kind) {
                    Ok(true) => ran += 1,
                    Ok(false) => refused += 1,
                    Err(what) => wrong.push(format!("{first:?} and {second:?} under {}: {what}", kind.name)),
                }
            }
        }
    }
    eprintln!("{ran} pairs run, {refused} are refused by {} rows", EXCLUSIONS.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Nothing is said twice, and no row is of a feature with itself.
#[test]
fn rows_are_of_two_features_each_once() {
    for (k, row) in EXCLUSIONS.iter().enumerate() {
        assert_ne!(row.asked, row.beside);
        let same = |other: &&frazil_scene::capability::Exclusion| {
            [other.asked, other.beside] == [row.asked, row.beside]
                || [other.beside, other.asked] == [row.asked, row.beside]
        };
        assert_eq!(EXCLUSIONS[k + 1..].iter().find(same), None);
    }
}

/// The guide's table is the program's.
#[test]
fn the_guide_says_what_does_not_go_together() {
    let guide = include_str!("../docs/guide/scene.md");
    for row in &EXCLUSIONS {
        let line = format!("| {} | {} | {} |", row.asked.words(), row.beside.words(), row.because);
        assert!(guide.contains(&line), "{line}");
    }
}
