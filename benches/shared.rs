//! What the benches share: a freezing square, steps that are timed alone, rounds in which all cases take turns.

// Every bench uses a part of this.
#![allow(dead_code)]

use std::time::Instant;

use cpu_time::ThreadTime;
use frazil_core::instruction_set::{self, InstructionSet};
use frazil_core::solvers::step::Clock;
use frazil_core::statistics::{median, quartiles};
use frazil_scene::Scene;
use frazil_scene::method::MethodKind;
use frazil_simulation::plan::{self, Plan};
use rand::{RngExt, SeedableRng, rngs::StdRng};

/// Rounds in which all cases take turns; medians are over rounds.
pub const ROUNDS: usize = 7;

const SPACING: f64 = 0.002;

/// Of water (J/m3).
const LATENT_HEAT: f64 = 334e6;

/// The steps of lines that are timed one by one, where the default would be steps by error control of several evaluations.
const EULER: &str = "integrator = \"euler\"\n";

/// Fronts of whole cells.
const WHOLE_CELLS: &str = "front = \"cell\"\n";

/// Freezing at one temperature.
pub const ISOTHERMAL: &str = "law = \"isothermal\"";

/// Freezing along a curve.
pub const WEIBULL: &str = "law = \"weibull\", width_K = 0.5";

/// A square of water, `side` particles along each side, with a cold wall.
pub fn square(side: usize, method: &str, numerics: &str, threads: usize) -> Plan {
    freezing_square(ISOTHERMAL, side, method, numerics, threads)
}

/// The same by a law of freezing.
pub fn freezing_square(law: &str, side: usize, method: &str, numerics: &str, threads: usize) -> Plan {
    freezing_rectangle(law, [side; 2], method, numerics, threads)
}

/// The same with so many particles along each side.
pub fn freezing_rectangle(law: &str, sides: [usize; 2], method: &str, numerics: &str, threads: usize) -> Plan {
    let [width, height] = sides.map(|side| side as f64 * SPACING);
    let domain = format!("[domain.rectangle]\nwidth_m = {width}\nheight_m = {height}\n");
    let numerics = format!("{WHOLE_CELLS}{numerics}");
    let text = water((&domain, &["right", "bottom", "top"]), law, (method, &numerics), 24_000);
    let mut plan = planned(&text, method, threads);
    scatter(&mut plan);
    plan
}

/// The same with frozen, freezing and warm particles side by side, a third each, as in a body that freezes from a wall.
pub fn layered_square(law: &str, side: usize, method: &str, threads: usize) -> Plan {
    let mut plan = freezing_square(law, side, method, "", threads);
    let curve = plan.particles.materials.thermals[0].clone();
    for (particle, enthalpy) in plan.particles.enthalpy.iter_mut().enumerate() {
        let share = 3.0 * (particle % side) as f64 / side as f64;
        *enthalpy = match share {
            ..1.0 => curve.enthalpy(-10.0 * (1.0 - share) - 3.0),
            1.0..2.0 => curve.enthalpy(1e-9) - (2.0 - share) * LATENT_HEAT,
            _ => curve.enthalpy(5.0 * (share - 2.0)),
        };
    }
    plan
}

/// A line of `count` particles with a cold wall, planned for so many hours.
pub fn line(count: usize, method: &str, hours: u32) -> Plan {
    let domain = format!("[domain.line]\nlength_m = {}\n", count as f64 * SPACING);
    let numerics = format!("{EULER}{WHOLE_CELLS}");
    let mut plan = planned(&water((&domain, &["right"]), ISOTHERMAL, (method, &numerics), hours), method, 1);
    scatter(&mut plan);
    plan
}

/// A line of `count` particles of which the first half is frozen, with the front inside the next particle.
pub fn freezing_line(count: usize, method: &str, hours: u32) -> Plan {
    let domain = format!("[domain.line]\nlength_m = {}\n", count as f64 * SPACING);
    let mut plan = planned(&water((&domain, &["right"]), ISOTHERMAL, (method, EULER), hours), method, 1);
    let curve = plan.particles.materials.thermals[0].clone();
    let middle = count / 2;
    for (place, enthalpy) in plan.particles.enthalpy.iter_mut().enumerate() {
        *enthalpy = match place.cmp(&middle) {
            std::cmp::Ordering::Less => curve.enthalpy(-20.0 * (1.0 - place as f64 / middle as f64)),
            std::cmp::Ordering::Equal => curve.enthalpy(1e-9) - 0.5 * LATENT_HEAT,
            std::cmp::Ordering::Greater => curve.enthalpy(3.0),
        };
    }
    plan
}

/// A third of the particles are frozen, a third freeze and a third are warm, in random order: no branch can be guessed. Fronts are
/// to be those of whole cells: inside particles there would be one in every third, which no body has.
fn scatter(plan: &mut Plan) {
    let mut random = StdRng::seed_from_u64(1);
    let curve = plan.particles.materials.thermals[0].clone();
    let warm = curve.enthalpy(1e-9);
    for enthalpy in &mut plan.particles.enthalpy {
        *enthalpy = match random.random_range(0..3) {
            0 => curve.enthalpy(random.random_range(-10.0..-3.0)),
            1 => random.random_range(warm - LATENT_HEAT..warm),
            _ => curve.enthalpy(random.random_range(0.0..5.0)),
        };
    }
}

/// A scene of water with a cold wall.
fn water((domain, closed): (&str, &[&str]), law: &str, (method, numerics): (&str, &str), hours: u32) -> String {
    let closed: String = closed.iter().map(|wall| format!("[walls.{wall}]\ncondition = \"symmetry\"\n")).collect();
    format!(
        "title = \"water\"\nsource = \"a bench\"\n\
         {domain}\
         [time]\nduration_h = {hours}\n\
         [materials.water]\ndensity_kg_per_m3 = 1000\n\
         frozen = {{ conductivity_W_per_m_K = 2.14, heat_capacity_J_per_kg_K = 2060 }}\n\
         unfrozen = {{ conductivity_W_per_m_K = 0.6, heat_capacity_J_per_kg_K = 4182 }}\n\
         freezing = {{ {law}, temperature_c = 0, latent_heat_J_per_kg = 334000 }}\n\
         [initial]\ntemperature_c = 3\n\
         [walls.left]\ntemperature_c = -20\n\
         {closed}\
         [method.{method}]\nspacing_m = {SPACING}\n{numerics}\n"
    )
}

/// The plan of a scene file.
pub fn planned(text: &str, method: &str, threads: usize) -> Plan {
    let scene =
        Scene::read(text, "bench", "bench", &[], &[kind(method)]).unwrap_or_else(|problems| unreachable!("{problems}"));
    plan::build(&scene, &scene.methods[0], None, threads, 1).unwrap_or_else(|refused| unreachable!("{refused}"))
}

/// A method of the registry.
pub fn kind(name: &str) -> &'static MethodKind {
    let found = frazil::registry::methods().iter().find(|kind| kind.name == name);
    found.unwrap_or_else(|| unreachable!("no method {name}"))
}

/// A plan that is stepped, and the times that its steps took.
pub struct Case {
    /// What the table calls it.
    pub name: String,
    /// Particles, and what they do.
    pub plan: Plan,
    steps: u64,
    made: u64,
    /// The vectors that its steps may use.
    pub widest: InstructionSet,
    /// Whether several threads work, whose time is that of the clock on the wall; that of one is its own.
    pub shared: bool,
    /// Seconds per particle and step, by round.
    pub times: Vec<f64>,
}

impl Case {
    /// A case that makes `steps` steps a round; the first step is made now and not timed.
    pub fn new(name: impl Into<String>, plan: Plan, steps: u64) -> Self {
        let mut case = Case {
            name: name.into(),
            plan,
            steps,
            made: 0,
            widest: InstructionSet::Avx512,
            shared: false,
            times: Vec::new(),
        };
        case.advance(1);
        case
    }

    /// Makes some steps.
    pub fn advance(&mut self, steps: u64) {
        for _ in 0..steps {
            let step = self.plan.step;
            let clock = Clock { time: step * self.made as f64, step, index: self.made, turned: self.made == 0 };
            self.plan.method.advance(&mut self.plan.particles, &clock).expect("a step");
            self.made += 1;
        }
    }

    /// Particles.
    pub fn len(&self) -> usize {
        self.plan.particles.len()
    }

    /// One round.
    pub fn round(&mut self) {
        instruction_set::limit(self.widest);
        let (began, own) = (Instant::now(), ThreadTime::now());
        self.advance(self.steps);
        let taken = if self.shared { began.elapsed() } else { own.elapsed() };
        self.times.push(taken.as_secs_f64() / (self.steps as f64 * self.len() as f64));
    }

    /// Median seconds per particle and step.
    pub fn median(&self) -> f64 {
        median(&self.times).unwrap_or(f64::NAN)
    }

    /// `million particle-steps a second, quartiles`.
    pub fn rate(&self) -> String {
        let [low, middle, high] = quartiles(&self.times).unwrap_or([f64::NAN; 3]);
        format!("{:8.1} ({:.1} to {:.1})", 1e-6 / middle, 1e-6 / high, 1e-6 / low)
    }
}

/// Lets all cases take turns, so that whatever slows the machine for a while slows all of them.
pub fn take_turns(cases: &mut [Case]) {
    for round in 0..ROUNDS {
        for case in cases.iter_mut() {
            case.round();
        }
        eprintln!("round {} of {ROUNDS}", round + 1);
    }
}

/// Median over rounds of the ratio of two cases' times in the same round.
pub fn ratio(slow: &Case, fast: &Case) -> f64 {
    let ratios: Vec<f64> = slow.times.iter().zip(&fast.times).map(|(slow, fast)| slow / fast).collect();
    median(&ratios).unwrap_or(f64::NAN)
}

/// Resident memory of this process (bytes), where the system tells.
pub fn resident() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kilobytes| kilobytes * 1024.0)
}
