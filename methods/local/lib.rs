//! The local baseline: cell-centred finite volumes for the enthalpy, nearest neighbours on the lattice.
//!
//! One weight of 1/spacing^2 for each of the 2 d nearest cells is the classical enthalpy method of Voller and
//! Cross; it is second order where the solution is smooth, and the automatic reference where no closed form exists.

use std::sync::Arc;

use frazil_core::bonds::weight::{Normalisation, PairWeight};
use frazil_scene::method::{Discretisation, MethodKind, Stepper};
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

struct NearestNeighbour {
    spacing: f64,
}

impl PairWeight for NearestNeighbour {
    fn reach(&self) -> f64 {
        self.spacing
    }

    fn weight(&self, _distance: f64) -> f64 {
        1.0
    }
}

fn defaults(_setting: Setting) -> Numerics {
    Numerics::default()
}

fn read(_section: &mut Section<'_>, _setting: Setting, numerics: &Numerics, _dimension: usize) -> Discretisation {
    Discretisation {
        weight: Arc::new(NearestNeighbour { spacing: numerics.spacing }),
        normalisation: Normalisation::DiscreteMoment,
        knobs: Vec::new(),
        differences: Vec::new(),
        fluctuation: 0.0,
        stepper: Stepper::Shared,
    }
}
