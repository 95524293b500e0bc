//! Energy-conserving dissipative particle dynamics (Ng et al. 2017), particles at rest: collisional and random heat.
//!
//! A pair within the cut-off radius conducts by the weight `(1 - r/rc)^2` and exchanges a random heat of zero mean
//! whose strength follows from it by fluctuation and dissipation: with the pair conductance `K` (W/K),
//! `dQ = sqrt(2 k_B K T_i T_j) dW`. A particle's heat capacity is `heat_capacity_dpd` times k_B, which fixes the
//! Boltzmann constant of the coarse particles, and with it the noise, in any units. Motion and its forces enter
//! through the same step.

pub mod calibration;
pub mod fluid;
pub mod moving;
pub mod properties;
mod random_flux;

use std::f64::consts::PI;
use std::sync::Arc;

use frazil_core::bonds::exchange::{Exchange, Mean};
use frazil_core::bonds::weight::{Normalisation, PairWeight};
use frazil_core::kernels::term::Off;
use frazil_core::solvers::assembly::Assembly;
use frazil_core::solvers::moving::Purpose;
use frazil_core::solvers::solver::Solver;
use frazil_record::{Value, plain};
use frazil_scene::method::MethodSettings;
use frazil_scene::method::{Discretisation, MethodKind, SceneFacts, Stepper};
use frazil_scene::{Numerics, Range, Scene, Section, Setting, Units};
use rayon::ThreadPool;

use random_flux::RandomFlux;

/// The method as the registry lists it.
pub static METHOD: MethodKind = MethodKind {
    name: "edpd",
    title: "Energy-conserving dissipative particle dynamics",
    source: "Ng et al. 2017, eqs 7-9, 20, 27-29",
    stochastic: true,
    lattice_only: false,
    defaults,
    read,
};

/// The weight of a pair.
#[derive(Debug, Clone, Copy)]
struct Collision {
    dimension: usize,
    cutoff: f64,
}

impl PairWeight for Collision {
    fn reach(&self) -> f64 {
        self.cutoff
    }

    fn weight(&self, distance: f64) -> f64 {
        // 2 d over the second moment of (1 - r/rc)^2: rc^3 / 15 on a line, pi rc^4 / 30 in the plane (eq 20).
        let constant = match self.dimension {
            1 => 30.0 / self.cutoff.powi(3),
            _ => 120.0 / (PI * self.cutoff.powi(4)),
        };
        constant * (1.0 - distance / self.cutoff).max(0.0).powi(2)
    }
}

/// Heat capacity of a particle in k_B that the papers take.
const PAPERS_CAPACITY: f64 = 1e5;

/// Fluctuation of a particle's temperature over the range of the data, where a scene does not say: below the errors of
/// temperature that bundled scenes have at their spacings without noise, 0.2 to 4 % of it.
const QUIET: f64 = 1e-3;

/// The heat capacity in k_B with which a particle at the warmest datum is as quiet as [`QUIET`], in two digits. Where the data
/// are one temperature, the range is a degree.
fn quiet_capacity(temperatures: Option<(f64, f64)>, absolute_zero: f64) -> f64 {
    let (low, high) = temperatures.unwrap_or((0.0, 1.0));
    let range = if high > low { high - low } else { 1.0 };
    let wanted = ((high - absolute_zero) / (QUIET * range)).powi(2);
    let digit = 10f64.powf(wanted.log10().floor() - 1.0);
    ((wanted / digit).ceil() * digit).max(PAPERS_CAPACITY)
}

fn defaults(setting: Setting) -> Numerics {
    match setting {
        Setting::Best => Numerics::default(),
        Setting::Paper => Numerics { exchange: Exchange::Mean(Mean::Harmonic), ..Numerics::default() },
    }
}

fn read(section: &mut Section<'_>, setting: Setting, numerics: &Numerics, facts: &SceneFacts) -> Discretisation {
    let dimension = facts.dimension;
    let ratio = section.number_or("cutoff_ratio", 3.92, Range::between(1.2, 8.0));
    let given = section.optional_number("heat_capacity_dpd", Range::at_least(100.0));
    let noise = section.flag_or("noise", true);
    let paper = setting == Setting::Paper;
    let motion = moving::read(section, numerics, ratio);
    let of_papers = paper || motion.is_some() || section.units() != Units::Si;
    let capacity = given.unwrap_or_else(|| match of_papers {
        true => PAPERS_CAPACITY,
        false => quiet_capacity(section.temperatures(), section.units().absolute_zero()),
    });
    let step = move |assembly: Assembly| -> Box<dyn Solver> {
        if !noise {
            return assembly.into_solver(Off);
        }
        let term = RandomFlux::new(&assembly, capacity);
        assembly.into_solver(term)
    };
    if let Some(motion) = motion {
        return with_motion(
            section,
            motion,
            ratio,
            capacity,
            noise,
            Collision { dimension, cutoff: ratio * numerics.spacing },
        );
    }
    let mut differences = vec![
        format!(
            "scales: one DPD length is {} of the scene's units of length (four particles to its square), one particle \
             stores {capacity} k_B per unit of temperature",
            2.0 * numerics.spacing
        ),
        "particles are at rest: no viscous heat, no momentum noise".to_string(),
    ];
    if noise {
        differences.push(format!(
            "thermal noise: the temperature of one particle fluctuates by {} % of its absolute value",
            plain(100.0 / capacity.sqrt(), 3)
        ));
    }
    let constants = if paper { "continuum" } else { "discrete-moment" };
    Discretisation {
        weight: Arc::new(Collision { dimension, cutoff: ratio * numerics.spacing }),
        normalisation: if paper { Normalisation::Nominal } else { Normalisation::DiscreteMoment },
        knobs: vec![
            ("cutoff_ratio", Value::Number(ratio)),
            ("heat_capacity_dpd", Value::Number(capacity)),
            ("noise", Value::Flag(noise)),
            ("normalisation", Value::Text(constants.into())),
        ],
        differences,
        fluctuation: if noise { 1.0 / capacity.sqrt() } else { 0.0 },
        stepper: Stepper::Own(Arc::new(step)),
    }
}

/// Particles that move.
fn with_motion(
    section: &mut Section<'_>,
    motion: moving::Motion,
    ratio: f64,
    capacity: f64,
    noise: bool,
    weight: Collision,
) -> Discretisation {
    if !noise {
        section.problem("noise", "excluded by motion = true: friction without random forces would stop all motion");
    }
    let mut knobs = vec![("cutoff_ratio", Value::Number(ratio)), ("heat_capacity_dpd", Value::Number(capacity))];
    knobs.extend(motion.knobs());
    let build =
        move |scene: &Scene, settings: &MethodSettings, pool: Option<Arc<ThreadPool>>, seed: u64, purpose: Purpose| {
            Ok(moving::build(scene, settings, (&motion, ratio, capacity), pool, seed, purpose)?)
        };
    Discretisation {
        weight: Arc::new(weight),
        normalisation: Normalisation::Nominal,
        knobs,
        differences: vec![format!(
            "particles move: the temperature of one fluctuates by {} % of its absolute value",
            plain(100.0 / capacity.sqrt(), 3)
        )],
        fluctuation: 1.0 / capacity.sqrt(),
        stepper: Stepper::Moving(Arc::new(build)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The continuum second moment is 2 d, so the nominal conductivity is the wanted one.
    #[test]
    fn the_weight_has_its_moment() {
        for dimension in [1, 2] {
            let pair = Collision { dimension, cutoff: 1.7 };
            let count = 20_000;
            let step = pair.cutoff / count as f64;
            let moment: f64 = (0..count)
                .map(|k| (k as f64 + 0.5) * step)
                .map(|r| pair.weight(r) * r * r * if dimension == 1 { 2.0 } else { 2.0 * PI * r } * step)
                .sum();
            // Midpoint rule of 20 000 points.
            assert!((moment - 2.0 * dimension as f64).abs() < 1e-7, "{dimension}D: {moment}");
        }
    }
}
