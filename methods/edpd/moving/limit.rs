//! How long a step of moving particles may be.

use frazil_core::physics::curve::Curve;
use frazil_core::solvers::step::Bound;

use super::map::DpdUnits;
use crate::fluid::Parameters;
use crate::fluid::walls::most_exchanged;

/// Time step of the liquid before the scene begins.
pub const SETTLING_STEP: f64 = 0.01;

/// Share of one over the frequency of a particle among its neighbours that a step may last: the kinetic temperature is then
/// off by some 0.1 %.
const SWING: f64 = 0.3;

/// Friction over one step of the coldest liquid, all partners together: beyond it friction is blurred (a pair's part is
/// exact at any step).
const MOST_FRICTION: f64 = 4.0;

/// Step times diffusivity over the square of the cut-off that conduction allows (mean field: 0.1; relaxed: 0.092): half of the mean
/// field, and less where particles have few neighbours, so that those at walls may exchange more than those in the liquid.
fn conduction(parameters: &Parameters) -> f64 {
    (0.045 * most_exchanged(parameters.heat_neighbours())).min(0.05)
}

/// A liquid that is only to come to rest: steps are bound by its motion alone, and heat, which has nowhere to go, is conducted
/// no faster than they allow.
pub fn settling(parameters: &Parameters, map: &DpdUnits, curve: &Curve, range: (f64, f64), liquid: f64) -> Parameters {
    let [_, (friction, _), (swing, _)] = limits(parameters, map, curve, range, liquid);
    let step = SETTLING_STEP.min(friction).min(swing);
    let allowed = conduction(parameters) * parameters.thermal_cutoff.powi(2) / liquid;
    let heat_friction = parameters.heat_friction * (allowed / step).min(1.0);
    Parameters { step, heat_friction, ..parameters.clone() }
}

/// The longest step: by conduction, by friction of the coldest liquid, by the swing of particles between neighbours.
pub fn bound(parameters: &Parameters, map: &DpdUnits, curve: &Curve, range: (f64, f64), liquid: f64) -> Bound {
    let limits = limits(parameters, map, curve, range, liquid);
    let (step, cause) = limits.into_iter().fold((f64::INFINITY, String::new()), |a, b| if b.0 < a.0 { b } else { a });
    Bound::strict(step * map.time, cause)
}

/// Diffusivity of the best conducting phase, from that of the liquid.
pub fn fastest(curve: &Curve, liquid: f64) -> f64 {
    liquid * curve.largest_diffusivity() / (curve.mixed_conductivity(1.0) / curve.unfrozen_capacity())
}

/// Limits of the step and their causes: by conduction, by friction of the coldest liquid, by the swing of particles.
fn limits(
    parameters: &Parameters,
    map: &DpdUnits,
    curve: &Curve,
    range: (f64, f64),
    liquid: f64,
) -> [(f64, String); 3] {
    let cutoff = parameters.thermal_cutoff;
    let conduction = conduction(parameters) * cutoff * cutoff / fastest(curve, liquid);
    let freezing = map.temperature(curve.freezing_point());
    let coldest = if curve.latent_heat() > 0.0 { range.0.max(freezing) } else { range.0 };
    let friction =
        MOST_FRICTION / parameters.constants(2).friction_rate(parameters.exponent.at(coldest)).max(f64::MIN_POSITIVE);
    // Along one direction, the second derivatives of all pairs of a mean field: a/rc over half of rho pi rc^2 partners.
    let radius = parameters.conservative_cutoff;
    let stiffness = 0.5 * std::f64::consts::PI * parameters.density * parameters.repulsion * radius;
    let swing = SWING / stiffness.sqrt().max(f64::MIN_POSITIVE);
    [
        (conduction, "conduction in its best conducting phase".to_string()),
        (friction, format!("friction of the coldest liquid, at {coldest:.4}")),
        (swing, "the oscillation of particles between their neighbours".to_string()),
    ]
}
