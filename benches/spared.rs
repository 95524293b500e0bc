//! What a scene pays for what it uses, and that it pays nothing for the rest: conduction alone through the program
//! against a loop written by hand for conduction alone, and each optional term on top.

#![allow(clippy::print_stdout)]

mod by_hand;
mod shared;

use by_hand::ByHand;
use cpu_time::ThreadTime;
use frazil_core::bonds::stencil::Stencil;
use frazil_core::statistics::{median, quartiles};
use frazil_simulation::plan::Plan;
use rand::{RngExt, SeedableRng, rngs::StdRng};
use shared::{Case, ROUNDS, planned, ratio};

/// Particles along each side.
const SIDE: usize = 500;
const SPACING: f64 = 0.002;
/// The body's start, and its left wall.
const TEMPERATURES: (f64, f64) = (3.0, -20.0);

/// A square or a ring in a few words.
#[derive(Clone)]
struct Body {
    walls: [&'static str; 4],
    law: &'static str,
    /// Regions and pipes.
    rest: String,
    ring: bool,
}

const CLOSED: &str = "condition = \"symmetry\"";
const COLD: &str = "temperature_c = -20";
const FILM: &str = "coefficient_W_per_m2_K = 20\nambient_c = -20";
/// Freezes far below anything that occurs.
const NO_CHANGE: &str = "law = \"none\", temperature_c = -200";
const SHARP: &str = "law = \"isothermal\", temperature_c = 0, latent_heat_J_per_kg = 334000";
const CURVE: &str = "law = \"weibull\", temperature_c = 0, latent_heat_J_per_kg = 334000, width_K = 0.5";

impl Body {
    fn plan(&self, method: &str, numerics: &str) -> Plan {
        self.plan_of(SIDE, method, numerics)
    }

    fn plan_of(&self, side: usize, method: &str, numerics: &str) -> Plan {
        let extent = side as f64 * SPACING;
        let domain = if self.ring {
            format!(
                "[domain.ring]\nouter_radius_m = {extent}\nsector = \"quarter\"\n[walls.outer]\n{}\n",
                self.walls[0]
            )
        } else {
            let names = ["left", "right", "bottom", "top"];
            let walls: String =
                names.iter().zip(self.walls).map(|(name, wall)| format!("[walls.{name}]\n{wall}\n")).collect();
            format!("[domain.rectangle]\nwidth_m = {extent}\nheight_m = {extent}\n{walls}")
        };
        let water = "{ conductivity_W_per_m_K = 0.6, heat_capacity_J_per_kg_K = 4182 }";
        let ice = "{ conductivity_W_per_m_K = 2.14, heat_capacity_J_per_kg_K = 2060 }";
        // What never freezes has one phase.
        let phases = format!("frozen = {}\nunfrozen = {water}", if self.law == NO_CHANGE { water } else { ice });
        let second = if self.rest.contains("\"second\"") {
            format!("[materials.second]\ndensity_kg_per_m3 = 2000\n{phases}\nfreezing = {{ {} }}\n", self.law)
        } else {
            String::new()
        };
        let text = format!(
            "title = \"bench\"\nsource = \"a bench\"\n{domain}[time]\nduration_days = 1000\n\
             [materials.water]\ndensity_kg_per_m3 = 1000\n{phases}\nfreezing = {{ {} }}\n{second}\
             [initial]\ntemperature_c = {}\n{}[method.{method}]\nspacing_m = {SPACING}\n{numerics}\n",
            self.law, TEMPERATURES.0, self.rest
        );
        let mut plan = planned(&text, method, 1);
        // Frozen, freezing and warm particles in random order, as far as the law knows them.
        let mut random = StdRng::seed_from_u64(1);
        for (i, enthalpy) in plan.particles.enthalpy.iter_mut().enumerate() {
            let thermal = plan.particles.materials.of(i);
            let freezing = (thermal.enthalpy(-0.4), thermal.enthalpy(0.0));
            *enthalpy = match random.random_range(0..3) {
                0 => thermal.enthalpy(random.random_range(-10.0..-0.5)),
                1 => random.random_range(freezing.0..freezing.1),
                _ => thermal.enthalpy(random.random_range(0.1..5.0)),
            };
        }
        plan
    }
}

/// Conduction alone, in a closed body or with one cold wall.
fn conduction(wall: bool) -> Body {
    square([if wall { COLD } else { CLOSED }, CLOSED, CLOSED, CLOSED], NO_CHANGE)
}

fn square(walls: [&'static str; 4], law: &'static str) -> Body {
    Body { walls, law, rest: String::new(), ring: false }
}

/// Bodies of each kind: where in memory a body lies moves its time by more than what is looked for.
const PLACES: usize = 6;

/// The program's case and the loop by hand, in turns, each at several places in memory.
fn against_by_hand<const REACH: usize, const WALL: bool>(method: &str, side: usize, steps: u64) {
    let mut random = StdRng::seed_from_u64(1);
    let mut between = Vec::new();
    let mut pairs: Vec<(Case, ByHand<REACH, WALL>)> = (0..PLACES)
        .map(|place| {
            between.push(vec![0u8; 5000 * place + 1]);
            let case = Case::new(method, conduction(WALL).plan_of(side, method, ""), steps);
            let thermal = &case.plan.particles.materials.thermals[0];
            let wall = thermal.potential_at(TEMPERATURES.1);
            let stencil = stencil(shared::kind(method));
            let mut hand = ByHand::<REACH, WALL>::new(side, &stencil, thermal.largest_slope, wall, case.plan.step);
            // Both solve the same problem, or the comparison says nothing.
            check_agreement(method, side, &mut hand);
            // Numbers of ordinary size everywhere, as in the program's case.
            hand.state.fill_with(|| random.random_range(-1e7..1e7));
            (case, hand)
        })
        .collect();
    // The thread's own time: what others on the machine do meanwhile is no part of the comparison.
    let timed = |work: &mut dyn FnMut()| {
        let began = ThreadTime::now();
        work();
        began.elapsed().as_secs_f64() / (steps as usize * side * side) as f64
    };
    let (mut program, mut by_hand) = (Vec::new(), Vec::new());
    for _ in 0..3 * ROUNDS {
        for (case, hand) in &mut pairs {
            by_hand.push(timed(&mut || (0..steps).for_each(|_| hand.step())));
            program.push(timed(&mut || case.round()));
        }
    }
    let ratios: Vec<f64> = program.iter().zip(&by_hand).map(|(program, hand)| program / hand).collect();
    let [low, middle, high] = quartiles(&ratios).unwrap_or([f64::NAN; 3]);
    let rate = |times: &[f64]| 1e-6 / median(times).unwrap_or(f64::NAN);
    println!(
        "{method:<6} {side:>5} squared, {}: program {:>8.1} M particle-steps/s, by hand {:>8.1}; time over by hand {middle:.3} ({low:.3} to {high:.3})",
        if WALL { "one wall, its heat booked" } else { "closed" },
        rate(&program),
        rate(&by_hand)
    );
}

/// The stencil of a method's best setting.
fn stencil(kind: &'static frazil_scene::method::MethodKind) -> Stencil {
    let text = format!("spacing_m = {SPACING}");
    let numerics = frazil_scene::Numerics { spacing: SPACING, ..(kind.defaults)(frazil_scene::Setting::Best) };
    let facts = frazil_scene::method::SceneFacts { dimension: 2, one_material: true };
    let discretisation = frazil_scene::read_section(&text, "bench", frazil_scene::Units::Si, |section| {
        section.positive(("spacing", "m"))?;
        Ok((kind.read)(section, frazil_scene::Setting::Best, &numerics, &facts))
    });
    let discretisation = discretisation.unwrap_or_else(|problems| unreachable!("{problems}"));
    Stencil::new(discretisation.weight.as_ref(), discretisation.normalisation, SPACING, 2)
}

/// From the same random start, some steps of both give the same enthalpies, to the last bit.
fn check_agreement<const REACH: usize, const WALL: bool>(method: &str, side: usize, hand: &mut ByHand<REACH, WALL>) {
    let plan = conduction(WALL).plan_of(side, method, "");
    hand.state.copy_from_slice(&plan.particles.enthalpy);
    let mut case = Case::new(method, plan, 19);
    case.round();
    (0..20).for_each(|_| hand.step());
    assert!(hand.state == case.plan.particles.enthalpy, "{method}: the loop by hand solves another problem");
}

fn main() {
    println!("Conduction alone, one thread, 3 x {ROUNDS} turns at {PLACES} places each, median and quartiles");
    for side in [SIDE, 2 * SIDE] {
        let steps = if side == SIDE { 8 } else { 2 };
        against_by_hand::<3, false>("pd", side, steps);
        against_by_hand::<1, false>("local", side, 2 * steps);
        against_by_hand::<3, true>("pd", side, steps);
        against_by_hand::<1, true>("local", side, 2 * steps);
    }

    let closed = square([CLOSED; 4], NO_CHANGE);
    let cold = square([COLD, CLOSED, CLOSED, CLOSED], NO_CHANGE);
    let ring = Body { ring: true, walls: [COLD; 4], ..closed.clone() };
    let extent = SIDE as f64 * SPACING;
    let with_pipes = Body {
        rest: format!(
            "[[pipes]]\ncount = 26\nring_radius_m = {}\npipe_radius_m = 0.001\ntemperature_c = -20\n",
            0.4 * extent
        ),
        ..ring.clone()
    };
    let half = Body {
        rest: format!(
            "[[regions]]\nmaterial = \"second\"\nx_min_m = {}\nx_max_m = {extent}\ny_min_m = 0\ny_max_m = {extent}\n",
            0.5 * extent
        ),
        ..square([COLD, CLOSED, CLOSED, CLOSED], NO_CHANGE)
    };
    let sharp = square([COLD, CLOSED, CLOSED, CLOSED], SHARP);
    let rows: Vec<(&str, Plan, u64, usize)> = vec![
        ("pd, no wall lets heat through", closed.plan("pd", ""), 20, 0),
        ("+ one wall at a temperature", cold.plan("pd", ""), 20, 0),
        ("+ four walls at temperatures", square([COLD; 4], NO_CHANGE).plan("pd", ""), 20, 0),
        ("+ one wall with a film", square([FILM, CLOSED, CLOSED, CLOSED], NO_CHANGE).plan("pd", ""), 20, 0),
        ("+ latent heat, sharp", sharp.plan("pd", ""), 20, 1),
        ("+ latent heat, curve", square([COLD, CLOSED, CLOSED, CLOSED], CURVE).plan("pd", ""), 5, 1),
        ("+ rkl2 of 5 stages, by evaluation", cold.plan("pd", "integrator = \"rkl2\"\nstages = 5"), 4, 1),
        ("pd in a ring, no pipes", ring.plan("pd", ""), 20, 7),
        ("+ 26 pipes", with_pipes.plan("pd", ""), 20, 7),
        ("pd on a list", cold.plan("pd", "search = \"tree\""), 2, 1),
        ("+ second material", half.plan("pd", "search = \"tree\""), 2, 9),
        ("+ flags", sharp.plan("pd", "scheme = \"flags\""), 2, 9),
        ("+ harmonic mean, mushy", sharp.plan("pd", "mean = \"harmonic\""), 2, 9),
        ("+ harmonic mean, last phase", sharp.plan("pd", "mean = \"harmonic\"\nmushy = false"), 2, 9),
        ("edpd without noise", cold.plan("edpd", "noise = false"), 1, 9),
        ("+ noise", cold.plan("edpd", ""), 1, 14),
        ("pd, two materials, swept", half.plan("pd", ""), 5, 1),
    ];
    let (mut cases, bases): (Vec<Case>, Vec<(usize, f64)>) = rows
        .into_iter()
        .map(|(name, plan, steps, base)| {
            let evaluations = if name.contains("rkl2") { 5.0 } else { 1.0 };
            (Case::new(name, plan, steps), (base, evaluations))
        })
        .unzip();
    shared::take_turns(&mut cases);
    println!("\n{:<36} {:>28} {:>8}  of", "case, one thread", "M particle-steps/s", "time");
    for (case, (base, evaluations)) in cases.iter().zip(&bases) {
        let time = ratio(case, &cases[*base]) / evaluations;
        println!("{:<36} {:>28} {:>8.3}  {}", case.name, case.rate(), time, cases[*base].name);
    }
}
