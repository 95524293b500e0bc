//! The list of methods, one line each.

use std::sync::Arc;

use frazil_core::method::{Discretisation, MethodKind, Normalisation, PairWeight, Stepper};
use frazil_core::record::Value;
use frazil_core::scene::{
    Exchange, IntegratorChoice, Layout, Numerics, PipeModel, Range, SearchChoice, Section, Setting, StepChoice, Uptake,
    WallModel,
};

/// All methods, in the order in which they are shown.
pub fn methods() -> &'static [&'static MethodKind] {
    static METHODS: [&MethodKind; 4] = [&LOCAL, &PD, &SPH, &EDPD];
    &METHODS
}

// Stand-ins until the packages of the methods are connected.

static LOCAL: MethodKind = MethodKind {
    name: "local",
    title: "Local finite volumes",
    source: "",
    stochastic: false,
    lattice_only: true,
    defaults,
    read: |_, _, numerics, _| stand_in(numerics.spacing, Vec::new()),
};

static PD: MethodKind = MethodKind {
    name: "pd",
    title: "Bond-based peridynamics",
    source: "Nikolaev et al. 2021",
    stochastic: false,
    lattice_only: false,
    defaults,
    read: |section, _, numerics, _| {
        let ratio = section.number_or("horizon_ratio", 3.0, Range::between(1.0, 12.0));
        let influence = word(section, "influence", &["constant", "triangular"]);
        stand_in(ratio * numerics.spacing, vec![("horizon_ratio", Value::Number(ratio)), ("influence", influence)])
    },
};

static SPH: MethodKind = MethodKind {
    name: "sph",
    title: "Smoothed particle hydrodynamics",
    source: "Chen and Bai 2016",
    stochastic: false,
    lattice_only: false,
    defaults,
    read: |section, _, numerics, _| {
        let kernel = word(section, "kernel", &["cubic-spline", "quintic-spline", "wendland-c2", "wendland-c4"]);
        let ratio = section.number_or("smoothing_ratio", 1.2, Range::between(0.6, 3.0));
        stand_in(2.0 * ratio * numerics.spacing, vec![("kernel", kernel), ("smoothing_ratio", Value::Number(ratio))])
    },
};

static EDPD: MethodKind = MethodKind {
    name: "edpd",
    title: "Energy-conserving dissipative particle dynamics",
    source: "Ng et al. 2017",
    stochastic: true,
    lattice_only: false,
    defaults,
    read: |section, _, numerics, _| {
        let ratio = section.number_or("cutoff_ratio", 3.92, Range::between(1.2, 8.0));
        let capacity = section.number_or("heat_capacity_dpd", 1e5, Range::POSITIVE);
        let noise = section.flag_or("noise", true);
        stand_in(
            ratio * numerics.spacing,
            vec![
                ("cutoff_ratio", Value::Number(ratio)),
                ("heat_capacity_dpd", Value::Number(capacity)),
                ("noise", Value::Flag(noise)),
            ],
        )
    },
};

fn word(section: &mut Section<'_>, key: &'static str, words: &[&'static str]) -> Value {
    let choices: Vec<_> = words.iter().map(|word| (*word, *word)).collect();
    Value::Text(section.choice_or(key, &choices, words[0]).to_owned())
}

fn defaults(_: Setting) -> Numerics {
    Numerics {
        spacing: 1.0,
        layout: Layout::Lattice,
        exchange: Exchange::Potential,
        uptake: Uptake::Enthalpy,
        mushy: true,
        walls: WallModel::Mirror,
        pipes: PipeModel::Immersed,
        search: SearchChoice::Auto,
        integrator: IntegratorChoice::Euler,
        step: StepChoice::Fraction(0.9),
    }
}

struct Flat(f64);

impl PairWeight for Flat {
    fn reach(&self) -> f64 {
        self.0
    }
    fn weight(&self, _distance: f64) -> f64 {
        1.0
    }
}

fn stand_in(reach: f64, knobs: Vec<(&'static str, Value)>) -> Discretisation {
    Discretisation {
        weight: Arc::new(Flat(reach)),
        normalisation: Normalisation::DiscreteMoment,
        knobs,
        differences: Vec::new(),
        stepper: Stepper::Shared,
    }
}
