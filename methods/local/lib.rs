//! The local baseline: cell-centred finite volumes for the enthalpy, nearest neighbours on the lattice.
//!
//! On a line, and with five points in a plane, one weight of 1/spacing^2 for each of the 2 d nearest cells is the classical
//! enthalpy method of Voller and Cross; it is second order where the solution is smooth. With nine points, cells across a corner
//! weigh a quarter of those across a side, which makes the leading error the same in all directions (Collatz 1960, the Numerical
//! Treatment of Differential Equations, table VI): round frozen bodies stay round. It is the automatic reference where no closed
//! form exists.

use std::sync::Arc;

use frazil_core::bonds::weight::{Normalisation, PairWeight};
use frazil_record::Value;
use frazil_scene::method::{Discretisation, MethodKind, SceneFacts, Stepper};
use frazil_scene::{Numerics, Section, Setting};

/// The method as the registry lists it.
pub static METHOD: MethodKind = MethodKind {
    name: "local",
    title: "local finite volumes",
    source: "cell-centred finite-volume enthalpy method on the particle lattice",
    stochastic: false,
    lattice_only: true,
    defaults,
    read,
};

/// Cells of a plane that exchange heat with one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cells {
    /// Those across its sides.
    Five,
    /// Those across its corners too.
    Nine,
}

impl Cells {
    /// Words for them.
    const CHOICES: [(&'static str, Cells); 2] = [("five-point", Cells::Five), ("nine-point", Cells::Nine)];
}

struct NearestNeighbour {
    spacing: f64,
    cells: Cells,
}

impl NearestNeighbour {
    /// Between the distances of cells across a side and across a corner, in spacings.
    const BEYOND_A_SIDE: f64 = 1.2;
    /// Weight across a corner, over that across a side.
    const ACROSS_A_CORNER: f64 = 0.25;
}

impl PairWeight for NearestNeighbour {
    fn reach(&self) -> f64 {
        match self.cells {
            Cells::Five => self.spacing,
            Cells::Nine => std::f64::consts::SQRT_2 * self.spacing,
        }
    }

    fn weight(&self, distance: f64) -> f64 {
        if distance > Self::BEYOND_A_SIDE * self.spacing { Self::ACROSS_A_CORNER } else { 1.0 }
    }
}

fn defaults(_setting: Setting) -> Numerics {
    Numerics::default()
}

fn read(section: &mut Section<'_>, setting: Setting, numerics: &Numerics, facts: &SceneFacts) -> Discretisation {
    // Corners of cells would lead heat past layers that lie along the lattice.
    let default = if setting == Setting::Best && facts.one_material { Cells::Nine } else { Cells::Five };
    let (cells, knobs) = match facts.dimension {
        1 => {
            section.refuse("stencil", "a line has one stencil, of three points");
            (Cells::Five, Vec::new())
        }
        _ => {
            let cells = section.choice_or("stencil", &Cells::CHOICES, default);
            let word = Cells::CHOICES.iter().find(|choice| choice.1 == cells).map_or("", |choice| choice.0);
            (cells, vec![("stencil", Value::Text(word.into()))])
        }
    };
    Discretisation {
        weight: Arc::new(NearestNeighbour { spacing: numerics.spacing, cells }),
        normalisation: Normalisation::DiscreteMoment,
        knobs,
        differences: Vec::new(),
        fluctuation: 0.0,
        stepper: Stepper::Shared,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frazil_core::bonds::stencil::Stencil;

    /// Fourth moments: the leading error of the Laplacian of a plane is `sum w (k . e)^4 / 24` for a wave k, the same in all
    /// directions where `sum w x^4 = 3 sum w x^2 y^2`.
    #[test]
    fn nine_points_err_alike_in_all_directions() {
        let of = |cells: Cells| {
            Stencil::new(&NearestNeighbour { spacing: 0.5, cells }, Normalisation::DiscreteMoment, 0.5, 2)
        };
        let moments = |stencil: &Stencil| {
            let (side, corner) = (stencil.at(1, 0), stencil.at(1, 1));
            (2.0 * side + 4.0 * corner, 4.0 * corner)
        };
        let nine = of(Cells::Nine);
        let (along, across) = moments(&nine);
        assert!((along - 3.0 * across).abs() < 1e-12 * along, "{along} {across}");
        // Classical weights: 2/3 and 1/6 over the square of the spacing.
        assert!((nine.at(1, 0) - 2.0 / 3.0 / 0.25).abs() < 1e-12 && (nine.at(1, 1) - 1.0 / 6.0 / 0.25).abs() < 1e-12);
        let five = of(Cells::Five);
        assert!((five.at(1, 0) - 4.0).abs() < 1e-12 && five.reach == 1 && moments(&five).1 == 0.0);
    }
}
