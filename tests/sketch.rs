//! Small scenes for tests, rendered as scene files and read like any other.

use std::fmt::Write;

use frazil::registry::methods;
use frazil_core::solvers::step::Clock;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::statistics::order::observed_order;
use frazil_record::{Outcome, RunResult, WallRow};
use frazil_scene::Scene;
use frazil_scene::method::MethodKind;
use frazil_simulation::march::{self, Options};
use frazil_simulation::plan::{self, Plan};
use rand::{RngExt, rngs::StdRng};

/// A scene in a few words. Walls, materials and numerics are lines of the file.
#[derive(Debug, Clone)]
pub struct Sketch {
    pub domain: Domain,
    /// Whether it is of unsaturated water; it then starts with a head (m) in place of a temperature.
    pub of_water: bool,
    pub duration_s: f64,
    pub outputs: usize,
    /// Inline tables by name; the first fills the body.
    pub materials: Vec<(&'static str, String)>,
    /// Lines of one region each.
    pub regions: Vec<String>,
    /// Lines of one crack each.
    pub cracks: Vec<String>,
    pub initial_c: f64,
    /// A table along an axis in its place, as `{ x_m = [0, 1], values = [5, -5] }`; none where it is empty.
    pub initial_along: String,
    /// Lines by wall; walls that are not named are symmetry planes.
    pub walls: Vec<(&'static str, String)>,
    /// Lines of one ring of pipes each.
    pub pipes: Vec<String>,
    /// Lines of the section `excavation`; no shaft is dug if empty.
    pub excavation: String,
    /// Lines of the section `flow`; no water flows if empty.
    pub flow: String,
    /// Lines of the section `anisotropy`; the ground conducts alike in all directions if empty.
    pub anisotropy: String,
    /// Lines of the section `random`; the ground is even if empty.
    pub random: String,
    /// Lines of the section `gravity`; water does not fall if empty.
    pub gravity: String,
    /// Lines of the section `watch`.
    pub watch: String,
    pub spacing_m: f64,
    /// Further lines of the method's section.
    pub numerics: String,
}

/// Water, with the freezing law as lines of an inline table.
pub fn water(law: &str) -> String {
    format!(
        "{{ density_kg_per_m3 = 1000, \
         frozen = {{ conductivity_W_per_m_K = 2.14, heat_capacity_J_per_kg_K = 2060 }}, \
         unfrozen = {{ conductivity_W_per_m_K = 0.6, heat_capacity_J_per_kg_K = 4182 }}, freezing = {{ {law} }} }}"
    )
}

/// Sand, which conducts better and holds less latent heat.
pub fn sand(law: &str) -> String {
    format!(
        "{{ density_kg_per_m3 = 2090, \
         frozen = {{ conductivity_W_per_m_K = 2.56, heat_capacity_J_per_kg_K = 1088.4 }}, \
         unfrozen = {{ conductivity_W_per_m_K = 1.86, heat_capacity_J_per_kg_K = 1465.1 }}, freezing = {{ {law} }} }}"
    )
}

/// Fine sand, for unsaturated water.
pub fn soil() -> String {
    "{ retention = { law = \"van-genuchten\", alpha_per_m = 2, n = 1.8 }, residual_water_content = 0.05, \
     saturated_water_content = 0.4, conductivity_m_per_s = 1e-6 }"
        .to_owned()
}

/// The same with a solute that only diffuses in it.
pub fn soil_with_solute() -> String {
    let soil = soil();
    let body = soil.strip_suffix(" }").expect("an inline table");
    format!("{body}, solute = {{ diffusion_m2_per_s = 1e-9 }} }}")
}

/// A material whose properties do not depend on temperature: diffusivity 1e-6 m2/s, conductivity 2 W/mK.
pub fn steady_material() -> String {
    let phase = "{ conductivity_W_per_m_K = 2, heat_capacity_J_per_kg_K = 1000 }";
    format!(
        "{{ density_kg_per_m3 = 2000, frozen = {phase}, unfrozen = {phase}, \
         freezing = {{ law = \"none\", temperature_c = -200 }} }}"
    )
}

impl Sketch {
    /// A body of sharply freezing water at 3 degC without heat exchange, at rest under its method's best settings.
    pub fn new(domain: Domain, spacing_m: f64) -> Self {
        Sketch {
            domain,
            of_water: false,
            duration_s: 3600.0,
            outputs: 1,
            materials: vec![("water", water("law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 334000"))],
            regions: Vec::new(),
            cracks: Vec::new(),
            initial_c: 3.0,
            initial_along: String::new(),
            walls: Vec::new(),
            pipes: Vec::new(),
            excavation: String::new(),
            flow: String::new(),
            anisotropy: String::new(),
            random: String::new(),
            gravity: String::new(),
            watch: String::new(),
            spacing_m,
            numerics: String::new(),
        }
    }

    /// Sets the condition of a wall.
    pub fn wall(mut self, name: &'static str, line: impl Into<String>) -> Self {
        self.walls.retain(|wall| wall.0 != name);
        self.walls.push((name, line.into()));
        self
    }

    /// Adds a line to the method's section.
    pub fn with(mut self, line: &str) -> Self {
        self.numerics.push_str(line);
        self.numerics.push('\n');
        self
    }

    /// The scene file for a method.
    pub fn text(&self, method: &str) -> String {
        let mut text = "title = \"sketch\"\nsource = \"a test\"\n".to_owned();
        if self.of_water {
            text.push_str("balance = \"water\"\n");
        }
        let mut put = |line: std::fmt::Arguments<'_>| text.write_fmt(line).expect("a string takes any text");
        let names: &[&str] = match self.domain {
            Domain::Line { length } => {
                put(format_args!("[domain.line]\nlength_m = {length}\n"));
                &["left", "right"]
            }
            Domain::Rectangle { width, height } => {
                put(format_args!("[domain.rectangle]\nwidth_m = {width}\nheight_m = {height}\n"));
                &["left", "right", "bottom", "top"]
            }
            Domain::Ring { outer_radius, sector } => {
                let sector = match sector {
                    Sector::Quarter => "quarter",
                    Sector::Half => "half",
                    Sector::Whole => "whole",
                };
                put(format_args!("[domain.ring]\nouter_radius_m = {outer_radius}\nsector = \"{sector}\"\n"));
                &["outer"]
            }
            Domain::Radial { symmetry, inner, outer } => {
                let radii = format!("inner_radius_m = {inner}\nouter_radius_m = {outer}");
                put(format_args!("[domain.radial]\nsymmetry = \"{}\"\n{radii}\n", symmetry.name()));
                if inner > 0.0 { &["inner", "outer"] } else { &["outer"] }
            }
            Domain::Axial { inner, outer, height } => {
                let radii = format!("inner_radius_m = {inner}\nouter_radius_m = {outer}");
                put(format_args!("[domain.axial]\n{radii}\nheight_m = {height}\n"));
                if inner > 0.0 { &["inner", "outer", "bottom", "top"] } else { &["outer", "bottom", "top"] }
            }
        };
        put(format_args!("[time]\nduration_s = {}\noutputs = {}\n", self.duration_s, self.outputs));
        let start = match self.of_water {
            // No head of any size is that of dry ground.
            true if !self.initial_along.is_empty() => format!("head_m = {}", self.initial_along),
            false if !self.initial_along.is_empty() => format!("temperature_c = {}", self.initial_along),
            true if self.initial_c.is_infinite() => "saturation = 0".into(),
            true => format!("head_m = {}", self.initial_c),
            false => format!("temperature_c = {}", self.initial_c),
        };
        put(format_args!("[initial]\n{start}\n[materials]\n"));
        for (name, material) in &self.materials {
            put(format_args!("{name} = {material}\n"));
        }
        for region in &self.regions {
            put(format_args!("[[regions]]\n{region}\n"));
        }
        for crack in &self.cracks {
            put(format_args!("[[cracks]]\n{crack}\n"));
        }
        for name in names {
            let line = self.walls.iter().find(|wall| wall.0 == *name).map(|wall| wall.1.as_str());
            put(format_args!("[walls.{name}]\n{}\n", line.unwrap_or("condition = \"symmetry\"")));
        }
        for ring in &self.pipes {
            put(format_args!("[[pipes]]\n{ring}\n"));
        }
        if !self.excavation.is_empty() {
            put(format_args!("[excavation]\n{}\n", self.excavation));
        }
        if !self.anisotropy.is_empty() {
            put(format_args!("[anisotropy]\n{}\n", self.anisotropy));
        }
        if !self.random.is_empty() {
            put(format_args!("[random]\n{}\n", self.random));
        }
        if !self.gravity.is_empty() {
            put(format_args!("[gravity]\n{}\n", self.gravity));
        }
        if !self.flow.is_empty() {
            put(format_args!("[flow]\n{}\n", self.flow));
        }
        if !self.watch.is_empty() {
            put(format_args!("[watch]\n{}\n", self.watch));
        }
        put(format_args!("[method.{method}]\nspacing_m = {}\n{}", self.spacing_m, self.numerics));
        text
    }

    /// The scene, which must be good.
    pub fn scene(&self, kind: &'static MethodKind) -> Scene {
        let text = self.text(kind.name);
        Scene::read(&text, "sketch", "sketch", &[], &[kind])
            .unwrap_or_else(|problems| unreachable!("{problems}\nin\n{text}"))
    }

    /// The plan under a method, on one thread.
    pub fn plan(&self, kind: &'static MethodKind) -> Plan {
        self.plan_with(kind, 1, 1)
    }

    /// The plan under a method.
    pub fn plan_with(&self, kind: &'static MethodKind, threads: usize, seed: u64) -> Plan {
        let scene = self.scene(kind);
        plan::build(&scene, &scene.methods[0], None, threads, seed)
            .unwrap_or_else(|refused| unreachable!("{refused}\nin\n{}", self.text(kind.name)))
    }

    /// The whole run under a method.
    pub fn run(&self, kind: &'static MethodKind) -> RunResult {
        self.run_with(kind, &Options::default())
    }

    /// The whole run under a method, which must end well and keep its balance to a part of the heat exchanged.
    pub fn sound(&self, kind: &'static MethodKind, balance: f64) -> RunResult {
        let result = self.run(kind);
        let RunResult { record, .. } = &result;
        let what = format!("{}: {:?}, in\n{}", kind.name, record.cause, self.text(kind.name));
        assert_eq!(record.outcome, Outcome::Ok, "{what}");
        assert!(record.energy_balance_rel.abs() < balance, "{:e}, {what}", record.energy_balance_rel);
        result
    }

    /// The whole run under a method with options.
    pub fn run_with(&self, kind: &'static MethodKind, options: &Options<'_>) -> RunResult {
        march::run(&self.scene(kind), kind.name, None, options)
            .unwrap_or_else(|refused| unreachable!("{refused}\nin\n{}", self.text(kind.name)))
    }
}

/// Lines of sand's law of freezing, at one temperature.
pub const SHARP: &str = "law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 52875.8";

/// Methods without noise.
pub fn even() -> impl Iterator<Item = &'static MethodKind> {
    methods().iter().copied().filter(|kind| !kind.stochastic)
}

/// Heat through a patch (J/m), output by output, for the part that was run.
pub fn through(result: &RunResult, patch: &str) -> Vec<f64> {
    let column = result.budget_names.iter().position(|name| name == patch).expect("a patch");
    result.budget.iter().map(|row| row.in_j[column]).collect()
}

/// Frozen lengths through pipes and between them (m).
pub fn thicknesses(row: &WallRow) -> [f64; 2] {
    [row.thickness_main_mean_m, row.thickness_interface_mean_m].map(|mean| mean.expect("planes of both kinds"))
}

/// A scene that comes with the program, with some keys set.
pub fn bundled(name: &str, changes: &[(&str, &str)]) -> Scene {
    let bundled = frazil_cases::scenes::find(name).expect("bundled");
    let changes: Vec<(String, String)> =
        changes.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    Scene::read(bundled, bundled.name, bundled.name, &changes, methods()).expect("a scene")
}

/// Makes `count` steps of the length that was planned, from time zero.
pub fn advance(plan: &mut Plan, count: u64) {
    for index in 0..count {
        let clock = Clock { time: plan.step * index as f64, step: plan.step, index, turned: index == 0 };
        plan.method.advance(&mut plan.particles, &clock).expect("a step");
    }
    plan.method.publish(&mut plan.particles);
}

/// The line that takes the noise from a method that has any.
pub fn without_noise(kind: &MethodKind) -> &'static str {
    if kind.stochastic { "noise = false" } else { "" }
}

/// Rates of change of all particles at a state that depends on the place, by one step.
pub fn rates(plan: &mut Plan, state: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let mut start = vec![0.0; plan.particles.len()];
    plan.particles.visit(|i, place| start[i] = state(place.x, place.y));
    plan.particles.enthalpy.copy_from_slice(&start);
    advance(plan, 1);
    plan.particles.enthalpy.iter().zip(&start).map(|(now, before)| (now - before) / plan.step).collect()
}

/// Order in which errors of a wave's rates fall with the spacing, by sketches of ground of [`steady_material`] at a spacing (m): a wave
/// by place that decays at a rate (1/s).
pub fn order_of_decay(
    kind: &'static MethodKind,
    sketch: impl Fn(f64) -> Sketch,
    wave: impl Fn(f64, f64) -> f64,
    decay: f64,
) -> f64 {
    const AMPLITUDE: f64 = 1e6;
    let spacings = [0.025, 0.0125, 0.00625];
    let errors = spacings.map(|spacing_m| {
        let sketch = Sketch { materials: vec![("ground", steady_material())], initial_c: 0.0, ..sketch(spacing_m) };
        let mut plan = sketch.with("integrator = \"euler\"").with(without_noise(kind)).plan(kind);
        let rates = rates(&mut plan, |x, y| AMPLITUDE * wave(x, y));
        let mut worst = 0.0_f64;
        plan.particles.visit(|i, place| {
            worst = worst.max((rates[i] / (-decay * AMPLITUDE) - wave(place.x, place.y)).abs());
        });
        worst
    });
    let order = observed_order(&spacings, &errors).expect("three spacings").order;
    eprintln!("{}: {errors:?}, order {order:.2}", kind.name);
    order
}

/// A wall of one of the kinds that there are, by chance.
pub fn wall_by_chance(random: &mut StdRng, temperature: f64) -> String {
    match random.random_range(0..4) {
        0 => "condition = \"symmetry\"".to_owned(),
        1 => format!("coefficient_W_per_m2_K = 20\nambient_c = {temperature}"),
        _ => format!("temperature_c = {temperature}"),
    }
}
