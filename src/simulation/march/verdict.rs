//! How a run ended.

use frazil_core::particles::Particles;
use frazil_core::physics::latent_heat::LatentHeatScheme;
use frazil_record::{Outcome, plain};
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;

use crate::terms::fluctuation;

/// How far noise alone may take temperatures out of the range of the data, over that range: eight standard deviations
/// of one particle at the warmest datum, in the material and phase that fluctuates most ([`crate::terms::fluctuation`]). A
/// normal variable stays within 6.5 over a billion looks; steps up to the bound do not add to it (3.3 at most on
/// `stefan-water`, for 0.05 of the bound as for the whole; 4.2 over the 26 000 steps of 17 600 particles of `entry-channel`). It is
/// never more than [`MOST_NOISE`].
pub(super) fn noise(scene: &Scene, settings: &MethodSettings, particles: &Particles) -> f64 {
    let (low, high) = scene.temperature_range();
    let own = settings.discretisation.fluctuation * (high - scene.units.absolute_zero());
    let deviation = particles.materials.laws().map(|law| own * fluctuation(law)).fold(0.0, f64::max);
    if deviation > 0.0 { (8.0 * deviation / (high - low)).min(MOST_NOISE) } else { 0.0 }
}

/// Part of the range of the data by which noise may take temperatures out of it. With more, a particle in the middle of the
/// data could be anywhere in them and beyond: noise would no longer be small beside what it is noise of.
const MOST_NOISE: f64 = 0.5;

/// Heat not accounted for, over that exchanged, up to which a run is `ok`.
pub const BALANCE_TOLERANCE: f64 = 1e-3;

/// How far temperatures of a run that is `ok` may leave the range of the data, over that range.
pub const RANGE_TOLERANCE: f64 = 0.01;

/// How far what can only go one way may go back in a run that is `ok`, over the greatest before.
pub const SETBACK_TOLERANCE: f64 = 0.01;

/// How a run that came to its end is to be called. Balances that rounding explains lie below 1e-10; a lost latent
/// heat shows as more than a thousandth.
///
/// `of_water` tells unsaturated water from heat.
pub(super) fn judge(
    of_water: bool,
    latent_heat_scheme: LatentHeatScheme,
    balance: f64,
    violation: Option<f64>,
    setback: Option<f64>,
    noise: f64,
) -> (Outcome, Option<String>) {
    if balance.abs() > BALANCE_TOLERANCE {
        let moved = if of_water { "water" } else { "heat" };
        let cause = format!("the {moved} balance is off by {} of the {moved} exchanged", plain(balance, 4));
        return match latent_heat_scheme {
            LatentHeatScheme::ApparentCapacity { .. } => {
                (Outcome::PhaseSkipped, Some(format!("{cause}: particles skipped the freezing interval")))
            }
            LatentHeatScheme::Enthalpy | LatentHeatScheme::Flags => (Outcome::EnergyDrift, Some(cause)),
        };
    }
    if let Some(violation) = violation.filter(|violation| *violation > RANGE_TOLERANCE + noise) {
        let what = if of_water { "pressure heads, on a logarithmic scale," } else { "temperatures" };
        let mut cause = format!("{what} left the range of the data by {} % of it", plain(100.0 * violation, 3));
        if noise > 0.0 {
            cause.push_str(&format!(
                ": noise may do so by {} %, eight standard deviations of one particle or half of the range; a larger \
                 heat capacity of particles makes less noise",
                plain(100.0 * noise, 3)
            ));
        }
        return (Outcome::Oscillating, Some(cause));
    }
    // Noise may push a front or a flow back for a moment.
    if let Some(setback) = setback.filter(|setback| *setback > SETBACK_TOLERANCE && noise == 0.0) {
        let cause = format!(
            "the front, or the heat through the coldest or warmest pipes, decreased by {} %",
            plain(100.0 * setback, 3)
        );
        return (Outcome::Oscillating, Some(cause));
    }
    (Outcome::Ok, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_speak_of_what_was_lost_or_left() {
        let cause = |of_water, balance, violation| {
            judge(of_water, LatentHeatScheme::Enthalpy, balance, violation, None, 0.0).1.expect("a cause")
        };
        assert_eq!(cause(false, 0.01, None), "the heat balance is off by 0.01 of the heat exchanged");
        assert_eq!(cause(true, 0.01, None), "the water balance is off by 0.01 of the water exchanged");
        let left = "left the range of the data by 20 % of it";
        assert_eq!(cause(false, 0.0, Some(0.2)), format!("temperatures {left}"));
        assert_eq!(cause(true, 0.0, Some(0.2)), format!("pressure heads, on a logarithmic scale, {left}"));
    }
}
