//! Bond-based peridynamic heat conduction (Bobaru and Duangpanya 2010; Nikolaev et al. 2021): the weight of a bond.
//!
//! A bond of length r within the horizon delta carries `w = c omega(r/delta) / r^2`, with the influence function
//! omega constant or falling to the horizon, linearly or with the square of the length. The best setting scales bonds by
//! the discrete second moment of the actual neighbourhood; the paper's uses the printed constant
//! `c = 2 d / (integral of omega dV)`, partial volumes at the rim of the horizon and the self term of a particle's own
//! cell (eqs 38, 39, 48, 49).

use std::f64::consts::PI;
use std::sync::Arc;

use frazil_core::balances::groundwater::numerics::Conduction;
use frazil_core::bonds::exchange::{Exchange, Mean};
use frazil_core::bonds::weight::PairWeight;
use frazil_record::Value;
use frazil_scene::method::{self, Discretisation, MethodKind, SceneFacts, Stepper};
use frazil_scene::{Numerics, Range, Section, Setting};

/// The method as the registry lists it.
pub static METHOD: MethodKind = MethodKind {
    name: "pd",
    title: "Bond-based peridynamics",
    source: "Nikolaev et al. 2021, eqs 38-41; Nikolaev et al. 2023",
    stochastic: false,
    lattice_only: false,
    defaults,
    read,
};

/// Influence of a bond by its length.
#[derive(Debug, Clone, Copy)]
struct Influence {
    /// The word of the file.
    word: &'static str,
    /// By the length of the bond over the horizon, from 0 to 1.
    at: fn(f64) -> f64,
    /// One over the mean of all that over the ball, by its dimension.
    inverse_mean: fn(f64) -> f64,
}

/// All influence functions, the usual one first: a new one is a line here.
const INFLUENCES: [Influence; 3] = [
    Influence { word: "constant", at: |_| 1.0, inverse_mean: |_| 1.0 },
    Influence { word: "triangular", at: |length| 1.0 - length, inverse_mean: |d| d + 1.0 },
    Influence { word: "parabolic", at: |length| 1.0 - length * length, inverse_mean: |d| 0.5 * (d + 2.0) },
];

/// The weight of a bond.
#[derive(Debug, Clone, Copy)]
struct Bond {
    dimension: usize,
    horizon: f64,
    influence: Influence,
    /// Spacing of the lattice whose rim cells and own cell are corrected, in the paper's setting.
    corrected: Option<f64>,
}

impl Bond {
    /// `2 d / (integral of omega dV)` over the horizon (m^-d).
    fn constant(&self) -> f64 {
        let d = self.dimension as f64;
        let volume = if self.dimension == 1 { 2.0 * self.horizon } else { PI * self.horizon * self.horizon };
        2.0 * d * (self.influence.inverse_mean)(d) / volume
    }
}

impl PairWeight for Bond {
    fn reach(&self) -> f64 {
        // Cells on the rim belong to the horizon in part, on whichever side of it their centres lie.
        self.horizon + self.corrected.map_or(0.0, |spacing| 0.5 * spacing)
    }

    fn weight(&self, distance: f64) -> f64 {
        // On the rim rounding must not make it negative.
        let influence = (self.influence.at)(distance / self.horizon).max(0.0);
        let plain = self.constant() * influence / (distance * distance);
        let Some(spacing) = self.corrected else { return plain };
        let inside = ((self.horizon + 0.5 * spacing - distance) / spacing).clamp(0.0, 1.0);
        // The own cell has the mean of the bonds to the 2 (1D) or 8 (2D) nearest particles.
        let own = |neighbour: f64, share: f64| {
            let near = (distance - neighbour * spacing).abs() < 1e-6 * spacing;
            if near { self.constant() * share / (distance * distance) } else { 0.0 }
        };
        let own = match self.dimension {
            1 => own(1.0, 1.0 / 2.0),
            _ => own(1.0, 1.0 / 8.0) + own(2f64.sqrt(), 1.0 / 8.0),
        };
        plain * inside + own
    }
}

fn defaults(setting: Setting) -> Numerics {
    match setting {
        Setting::Best => Numerics { conduction: Conduction::Corrected, ..Numerics::default() },
        Setting::Paper => Numerics { exchange: Exchange::Mean(Mean::Arithmetic), ..Numerics::default() },
    }
}

fn read(section: &mut Section<'_>, setting: Setting, numerics: &Numerics, facts: &SceneFacts) -> Discretisation {
    let dimension = facts.dimension;
    let ratio = section.number_or("horizon_ratio", 3.0, Range::between(1.0, 12.0));
    let choices = INFLUENCES.map(|influence| (influence.word, influence));
    let influence = section.choice_or("influence", &choices, INFLUENCES[0]);
    let (normalisation, scaled) = method::normalisation(section, setting);
    let paper = setting == Setting::Paper;
    let bond =
        Bond { dimension, horizon: ratio * numerics.spacing, influence, corrected: paper.then_some(numerics.spacing) };
    Discretisation {
        weight: Arc::new(bond),
        normalisation,
        knobs: vec![
            ("horizon_ratio", Value::Number(ratio)),
            ("influence", Value::Text(influence.word.into())),
            ("normalisation", scaled),
        ],
        differences: vec![format!(
            "heat is exchanged over a horizon of {ratio} spacings, also across fronts and near walls"
        )],
        fluctuation: 0.0,
        stepper: Stepper::Shared,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frazil_core::bonds::stencil::Stencil;
    use frazil_core::bonds::weight::Normalisation;

    fn influence(word: &str) -> Influence {
        *INFLUENCES.iter().find(|influence| influence.word == word).expect("an influence function")
    }

    fn moment(ratio: f64, word: &str, dimension: usize, corrected: bool) -> f64 {
        let (spacing, influence) = (0.002, influence(word));
        let bond = Bond { dimension, horizon: ratio * spacing, influence, corrected: corrected.then_some(spacing) };
        Stencil::new(&bond, Normalisation::Nominal, spacing, dimension).moment(spacing)
    }

    /// Means of influence functions, by quadrature over the ball.
    #[test]
    fn influence_functions_have_the_means_that_they_say() {
        for Influence { word, at, inverse_mean } in INFLUENCES {
            for d in [1.0, 2.0] {
                let (count, mut sum) = (20_000, 0.0);
                for k in 0..count {
                    let length = (k as f64 + 0.5) / count as f64;
                    sum += at(length) * d * length.powf(d - 1.0) / count as f64;
                }
                // The midpoint rule, of second order.
                assert!((sum * inverse_mean(d) - 1.0).abs() < 1e-8, "{word}, {d}D: {sum}");
            }
        }
    }

    /// Effective over nominal conductivity of full volumes on a lattice, from independent lattice sums (four
    /// digits).
    #[test]
    fn nominal_constants_misstate_the_conductivity_by_the_known_amounts() {
        for (ratio, word, dimension, known) in [
            (2.0, "constant", 1, 1.0),
            (3.0, "constant", 1, 1.0),
            (2.0, "triangular", 1, 0.5),
            (3.0, "triangular", 1, 0.6667),
            (4.0, "triangular", 1, 0.75),
            (2.0, "constant", 2, 0.9549),
            (3.0, "constant", 2, 0.9903),
            (4.0, "constant", 2, 0.9549),
            (5.0, "constant", 2, 1.0186),
            (8.0, "constant", 2, 0.9748),
            (2.0, "triangular", 2, 0.757),
            (3.0, "triangular", 2, 0.889),
            (5.0, "triangular", 2, 0.957),
        ] {
            let found = moment(ratio, word, dimension, false);
            assert!((found - known).abs() < 6e-4, "m = {ratio}, {word}, {dimension}D: {found}");
        }
        // Partial volumes with the self term restore the whole in 1D.
        assert!((moment(3.0, "constant", 1, true) - 1.0).abs() < 1e-12);
        // In 2D they do so to the linear share of cells on the rim: 0.9686 of all other cells (four digits), and the own
        // one's 1 / (9 pi).
        assert!((moment(3.0, "constant", 2, true) - 0.9686 - 1.0 / (9.0 * PI)).abs() < 6e-5);
    }

    /// Explicit limits by row sums in units of dx^2 / a (three digits, independent symbol analysis).
    #[test]
    fn row_sums_give_the_known_explicit_limits() {
        for (ratio, word, dimension, known) in [
            (2.0, "constant", 1, 0.800),
            (3.0, "constant", 1, 1.102),
            (3.0, "constant", 2, 0.733),
            (4.0, "constant", 2, 1.070),
            (3.0, "triangular", 2, 0.466),
        ] {
            let bond = Bond { dimension, horizon: ratio, influence: influence(word), corrected: None };
            let limit = 1.0 / Stencil::new(&bond, Normalisation::DiscreteMoment, 1.0, dimension).sum();
            assert!((limit - known).abs() < 6e-4, "m = {ratio}, {word}, {dimension}D: {limit}");
        }
    }
}
