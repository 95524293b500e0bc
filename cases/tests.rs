//! Which reference a scene gets, and what it is told when there is none.

use frazil_core::boundary::condition::Condition;
use frazil_core::boundary::pipe::PipeCondition;
use frazil_core::physics::freezing_curve::linear::Linear;
use frazil_core::physics::freezing_curve::weibull::Weibull;
use frazil_core::physics::material::{FreezingLaw, Material, Mixing, Phase};
use frazil_core::series::Series;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::wall::WallId;
use frazil_scene::{PipeRing, ReferenceChoice, Region, Scene, Shape, TimeUnit, Wall};
use frazil_simulation::reference::{Plane, Reference};

use crate::exact::similarity::tests::water;
use crate::{NoReference, tables, truth};

const HOUR: f64 = 3600.0;
const DAY: f64 = 86_400.0;

fn temperature(value: f64) -> Condition {
    Condition::Temperature(Series::Constant(value))
}

fn wall(wall: WallId, condition: Condition) -> Wall {
    Wall { wall, condition }
}

/// A metre of water that freezes from the left for ten hours.
fn half_space(law: FreezingLaw) -> Scene {
    Scene {
        initial_temperature: 8.0,
        walls: vec![wall(WallId::Left, temperature(-20.0)), wall(WallId::Right, Condition::Symmetry)],
        reference: ReferenceChoice::Exact,
        time_unit: TimeUnit::Hour,
        ..Scene::bare(Domain::Line { length: 1.0 }, 10.0 * HOUR, vec![water(law)])
    }
}

fn soil(name: &str, density: f64, frozen: (f64, f64), unfrozen: (f64, f64), point: f64, latent_heat: f64) -> Material {
    Material {
        name: name.into(),
        density,
        frozen: Phase { conductivity: frozen.0, heat_capacity: frozen.1 },
        unfrozen: Phase { conductivity: unfrozen.0, heat_capacity: unfrozen.1 },
        freezing_point: point,
        latent_heat,
        law: FreezingLaw::Isothermal,
        mixing: Mixing::Arithmetic,
        pores: None,
        soil: None,
    }
}

/// The column of the table.
fn column() -> Scene {
    Scene {
        domain: Domain::Line { length: 0.2 },
        duration: 60.0 * HOUR,
        materials: vec![soil("soil", 1800.0, (2.68, 2508.5), (3.05, 2124.0), -0.25, 33_500.0)],
        initial_temperature: 1.0,
        walls: vec![wall(WallId::Left, temperature(-5.0)), wall(WallId::Right, temperature(1.0))],
        reference: ReferenceChoice::Auto,
        ..half_space(FreezingLaw::Isothermal)
    }
}

/// The sand shaft of the table with pipes of 54 mm.
fn shaft() -> Scene {
    Scene {
        time_unit: TimeUnit::Day,
        domain: Domain::Ring { outer_radius: 15.0, sector: Sector::Half },
        duration: 120.0 * DAY,
        materials: vec![soil("sand", 2090.0, (2.56, 1088.4), (1.86, 1465.1), 0.0, 52_875.8)],
        initial_temperature: 15.0,
        walls: vec![wall(WallId::Outer, temperature(15.0))],
        wall_parts: Vec::new(),
        rings: vec![PipeRing {
            count: 26,
            ring_radius: 5.0,
            first_angle: 0.0,
            moved: Vec::new(),
            one_particle: false,
            missing: Vec::new(),
            pipe_radius: 0.054,
            condition: PipeCondition::Temperature(Series::Constant(-20.0)),
            schedule: None,
        }],
        reference: ReferenceChoice::Auto,
        ..half_space(FreezingLaw::Isothermal)
    }
}

fn reference_for(scene: &Scene) -> Result<Option<Box<dyn Reference>>, NoReference> {
    truth(scene).map(|truth| truth.reference)
}

fn kind(scene: &Scene) -> Option<String> {
    reference_for(scene).expect("no refusal").map(|reference| reference.describe().kind)
}

/// Why a scene has not the reference that it names: with another one, or none, in its place, or as an error.
fn refusal(scene: &Scene) -> String {
    truth(scene).map_or_else(|reason| reason.to_string(), |truth| truth.instead.unwrap_or_default())
}

#[test]
fn the_law_decides_which_solution_it_is() {
    assert_eq!(kind(&half_space(FreezingLaw::Isothermal)).as_deref(), Some("exact"));
    assert_eq!(kind(&half_space(FreezingLaw::None)).as_deref(), Some("exact"));
    assert_eq!(kind(&half_space(Linear { width: 0.5 }.into())).as_deref(), Some("similarity"));
    assert_eq!(kind(&half_space(Weibull { width: 0.5, residual: 0.0 }.into())).as_deref(), Some("similarity"));
}

#[test]
fn the_front_is_the_integral_of_the_frozen_fraction() {
    let time = 10.0 * HOUR;
    let front = |scene: &Scene| reference_for(scene).expect("fits").and_then(|reference| reference.front(time));
    let freezing = front(&half_space(FreezingLaw::Isothermal)).expect("front");
    assert!((freezing / 0.087_495_826_099_615_9 - 1.0).abs() < 1e-12, "{freezing}");
    assert_eq!(front(&half_space(FreezingLaw::None)), None);
    // What thaws is taken from the frozen length of the whole body.
    for law in [FreezingLaw::Isothermal, Linear { width: 1e-3 }.into()] {
        let mut scene = half_space(law);
        scene.domain = Domain::Line { length: 3.0 };
        scene.initial_temperature = -20.0;
        scene.walls[0].condition = temperature(8.0);
        let left = front(&scene).expect("front");
        assert!(left > 2.95 && left < 2.99, "{left}");
    }
}

#[test]
fn the_cold_wall_may_be_any() {
    let reference = reference_for(&half_space(FreezingLaw::Isothermal)).expect("fits").expect("exact");
    let mut scene = half_space(FreezingLaw::Isothermal);
    scene.domain = Domain::Rectangle { width: 0.1, height: 1.0 };
    scene.walls = vec![
        wall(WallId::Left, Condition::Symmetry),
        wall(WallId::Right, Condition::Symmetry),
        wall(WallId::Bottom, temperature(8.0)),
        wall(WallId::Top, temperature(-20.0)),
    ];
    let turned = reference_for(&scene).expect("fits").expect("exact");
    assert_eq!(turned.temperature(0.05, HOUR), reference.temperature(0.05, HOUR));
    assert_eq!(turned.front(HOUR), reference.front(HOUR));
}

#[test]
fn a_far_wall_that_is_felt_is_refused_unless_it_follows_the_solution() {
    let mut scene = half_space(FreezingLaw::Isothermal);
    scene.domain = Domain::Line { length: 0.3 };
    assert!(refusal(&scene).contains("the far wall affects"), "{}", refusal(&scene));
    scene.reference = ReferenceChoice::Auto;
    assert_eq!(kind(&scene), None);
    scene.walls[1].condition = Condition::Exact;
    assert_eq!(kind(&scene).as_deref(), Some("exact"));
}

#[test]
fn other_scenes_are_refused_with_the_reason() {
    let base = half_space(FreezingLaw::Isothermal);
    let with = |change: &dyn Fn(&mut Scene)| {
        let mut scene = base.clone();
        change(&mut scene);
        refusal(&scene)
    };
    let both = with(&|scene| scene.walls[1].condition = temperature(-20.0));
    assert!(both.contains("both the left and the right wall"), "{both}");
    let still = with(&|scene| scene.walls[0].condition = temperature(8.0));
    assert!(still.contains("no wall differs"), "{still}");
    let flux = with(&|scene| scene.walls[0].condition = Condition::Flux(Series::Constant(-10.0)));
    assert!(flux.contains("left wall has no constant temperature"), "{flux}");
    let rising =
        with(&|scene| scene.walls[0].condition = Condition::Temperature(Series::Table(vec![(0.0, -20.0), (1.0, 0.0)])));
    assert!(rising.contains("left wall has no constant temperature"), "{rising}");
    let inclusion = with(&|scene| {
        scene.materials.push(scene.materials[0].clone());
        scene.regions.push(Region {
            material: Some(1),
            temperature: None,
            heat: None,
            shape: Shape::Polygon(Vec::new()),
        });
    });
    assert!(inclusion.contains("several materials"), "{inclusion}");
    let side = with(&|scene| {
        scene.domain = Domain::Rectangle { width: 1.0, height: 1.0 };
        scene.walls.push(wall(WallId::Top, temperature(8.0)));
    });
    assert!(side.contains("top wall is not insulated"), "{side}");
    let ring = Scene { reference: ReferenceChoice::Exact, ..shaft() };
    assert!(refusal(&ring).contains("freeze pipes"), "{}", refusal(&ring));
}

#[test]
fn a_table_is_found_for_its_own_scene_alone() {
    let reference = reference_for(&column()).expect("no refusal").expect("table");
    assert_eq!(reference.describe().kind, "table");
    let front = reference.front(HOUR).expect("an hour is in the table");
    assert!((front - 0.034_076_287_1).abs() < 1e-15, "{front}");
    let reference = reference_for(&shaft()).expect("no refusal").expect("table");
    assert!(reference.describe().source.contains("shaft-single-sand-54mm"));
    assert!(reference.thickness(Plane::Main, 60.0 * DAY).is_some());

    let mut scene = shaft();
    scene.reference = ReferenceChoice::Table("shaft-single-sand-6.38mm".into());
    assert!(refusal(&scene).contains("the pipe radius is 0.00638 there and 0.054 here"), "{}", refusal(&scene));
    assert!(reference_for(&scene).expect("no refusal").expect("another").describe().source.contains("sand-54mm"));
    scene.rings[0].condition = PipeCondition::Temperature(Series::Constant(-21.0));
    assert_eq!(kind(&scene), None);
    assert!(refusal(&scene).contains("none that needs no run of its own fits"), "{}", refusal(&scene));
    scene.reference = ReferenceChoice::Table("shaft".into());
    assert!(reference_for(&scene).is_err(), "a name that is none is an error");
    assert!(tables::names().all(|name| refusal(&scene).contains(name)), "{}", refusal(&scene));

    let mut scene = column();
    scene.reference = ReferenceChoice::Table("soil-column".into());
    assert_eq!(kind(&scene).as_deref(), Some("table"));
    scene.walls[0].condition = temperature(-7.0);
    scene.materials[0].latent_heat = 40_000.0;
    let reason = refusal(&scene);
    assert!(reason.contains("cold end is -5 there and -7 here") && reason.contains("latent heat"), "{reason}");
    scene.reference = ReferenceChoice::Auto;
    assert_eq!(kind(&scene), None);
}

#[test]
fn a_changed_table_gives_way_to_a_closed_form_and_none_to_nothing() {
    // Without the other end the column is a half space.
    let mut scene = column();
    scene.reference = ReferenceChoice::Table("soil-column".into());
    scene.domain = Domain::Line { length: 4.0 };
    assert_eq!(kind(&scene).as_deref(), Some("exact"));
    let said = refusal(&scene);
    assert!(said.contains("the length is 0.2 there and 4 here") && said.contains("Neumann"), "{said}");
    scene.reference = ReferenceChoice::None;
    assert_eq!((kind(&scene), refusal(&scene)), (None, String::new()));
}

#[test]
fn a_local_run_is_made_elsewhere() {
    let scene = Scene { reference: ReferenceChoice::Local, ..half_space(FreezingLaw::Isothermal) };
    assert_eq!(kind(&scene), None);
}

/// Days, radii (m) and temperatures (C) inside the front of that line sink, by an independent solution.
const PROFILES: [(f64, f64, f64); 5] = [
    (1.0, 0.1, 242.994_975_643_425_36 - 273.15),
    (1.0, 0.19, 271.342_863_223_423_7 - 273.15),
    (2.0, 0.15, 245.666_759_818_834_8 - 273.15),
    (3.0, 0.1, 217.756_318_043_688_68 - 273.15),
    (3.0, 0.2, 249.503_078_340_639_8 - 273.15),
];

/// The line sink of the freezing annulus: its constant to eight digits and fronts to five, by an independent solution.
#[test]
fn the_line_sink_has_the_known_front() {
    let water = Material { latent_heat: 333e3, ..water(FreezingLaw::Isothermal) };
    let sink = crate::exact::line_sink::LineSink::new(&water, 8.0, std::f64::consts::TAU * 0.1 * 1000.0);
    assert!((sink.constant - 0.331_015_33).abs() < 1e-8, "{}", sink.constant);
    for (day, front) in [(1.0, 0.19834), (2.0, 0.28049), (3.0, 0.34353)] {
        assert!((sink.front(day * 86_400.0) - front).abs() < 1e-5, "{day}");
    }
    for (day, radius, temperature) in PROFILES {
        let found = sink.frozen_temperature(radius, day * 86_400.0);
        assert!((found - temperature).abs() < 1e-8, "{day} d, {radius} m: {found}");
    }
}
