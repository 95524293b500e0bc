//! Numerical settings of one method on one scene: how, never what.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use crate::method::Discretisation;
use frazil_core::balances::groundwater::numerics::{Conduction, FlowNumerics};
use frazil_core::bonds::exchange::{Exchange, Mean};
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::physics::uptake::{Mushy, Uptake};
use frazil_core::solvers::step::Bound;
use frazil_record::Value;

/// Which of a method's two standard settings is the starting point; keys of the file override it one by one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// What works best here: potential exchange, discrete-moment normalisation, mirror walls.
    Best,
    /// What the method's paper prints.
    Paper,
}

/// Where particles stand at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Layout {
    /// Cell centres of a square lattice.
    Lattice,
    /// Lattice points moved by uniform random shifts of at most this fraction of the spacing in each direction.
    Jittered {
        /// Largest shift over spacing, 0 to 0.5.
        fraction: f64,
    },
    /// Uniformly random points, one for each lattice cell's worth of volume.
    Random,
}

/// Where in a freezing particle its front is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Front {
    /// At its centre, wherever it really is.
    Cell,
    /// Where the frozen fraction says ([`frazil_core::physics::sub_cell`]).
    SubCell,
}

/// How neighbours are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchChoice {
    /// The lattice stencil where the scene allows it, else the tree.
    Auto,
    /// Lattice stencil: no list.
    Lattice,
    /// k-d tree.
    Tree,
    /// Cell list.
    Cells,
    /// Every pair: the oracle.
    AllPairs,
}

/// How time advances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum IntegratorChoice {
    /// Explicit Euler.
    Euler,
    /// Runge-Kutta-Legendre of second order in steps of a fixed number of stages.
    Rkl2 {
        /// Stages, at least 3.
        stages: usize,
    },
    /// Runge-Kutta-Legendre of second order in steps by error.
    ControlledRkl2 {
        /// Estimated error of one step.
        tolerance: f64,
    },
    /// Singly diagonally implicit Runge-Kutta of second order in steps by error.
    Implicit {
        /// Estimated error of one step.
        tolerance: f64,
    },
}

impl IntegratorChoice {
    /// Estimated error of one step, where steps follow it.
    pub fn tolerance(self) -> Option<f64> {
        match self {
            IntegratorChoice::Euler | IntegratorChoice::Rkl2 { .. } => None,
            IntegratorChoice::ControlledRkl2 { tolerance } | IntegratorChoice::Implicit { tolerance } => {
                Some(tolerance)
            }
        }
    }
}

/// How long a step is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StepChoice {
    /// This fraction of the derived bound.
    Fraction(f64),
    /// This many seconds; refused if above the bound of a fixed step, the longest of steps by error.
    Fixed(f64),
}

/// Settings that every method understands.
#[derive(Debug, Clone, PartialEq)]
pub struct Numerics {
    /// Particle spacing (m).
    pub spacing: f64,
    /// Placement.
    pub layout: Layout,
    /// Pair exchange.
    pub exchange: Exchange,
    /// Latent heat.
    pub uptake: Uptake,
    /// How a particle inside the freezing interval conducts. Only pair means read it: the potential is flat there.
    pub mushy: Mushy,
    /// Sharp fronts.
    pub front: Front,
    /// Walls.
    pub walls: WallModel,
    /// Neighbour search.
    pub search: SearchChoice,
    /// Integrator.
    pub integrator: IntegratorChoice,
    /// Step.
    pub step: StepChoice,
    /// Conduction where water flows.
    pub conduction: Conduction,
    /// Flowing water, where the scene has it.
    pub flow: Option<FlowNumerics>,
}

/// Everything a scene says about one method.
#[derive(Clone)]
pub struct MethodSettings {
    /// Name in the registry.
    pub method: &'static str,
    /// The preset.
    pub setting: Setting,
    /// Shared settings.
    pub numerics: Numerics,
    /// The method's own geometry.
    pub discretisation: Arc<Discretisation>,
    /// The bound of an explicit step, where a larger body knows it for this one (a body that is reduced): both then make
    /// the same steps. Derived from the particles if absent.
    pub bound: Option<Bound>,
}

impl MethodSettings {
    /// All settings by the keys of the file, defaults included, as a record shows them.
    pub fn values(&self) -> BTreeMap<String, Value> {
        let text = |word: &str| Value::Text(word.to_string());
        let numerics = &self.numerics;
        let mut values = BTreeMap::new();
        let mut put = |key: &str, value: Value| values.insert(key.to_string(), value);
        put("setting", text(if self.setting == Setting::Best { "best" } else { "paper" }));
        put("spacing", Value::Number(numerics.spacing));
        match numerics.layout {
            Layout::Lattice => put("layout", text("lattice")),
            Layout::Random => put("layout", text("random")),
            Layout::Jittered { fraction } => {
                put("jitter_fraction", Value::Number(fraction));
                put("layout", text("jittered"))
            }
        };
        match numerics.exchange {
            Exchange::Potential => put("exchange", text("potential")),
            Exchange::Mean(Mean::Harmonic) => put("mean", text("harmonic")),
            Exchange::Mean(Mean::Arithmetic) => put("mean", text("arithmetic")),
            Exchange::Mean(Mean::Geometric) => put("mean", text("geometric")),
        };
        match numerics.uptake {
            Uptake::Enthalpy => put("scheme", text("enthalpy")),
            Uptake::Flags => put("scheme", text("flags")),
            Uptake::ApparentCapacity { interval } => {
                put("interval_K", Value::Number(interval));
                put("scheme", text("apparent-capacity"))
            }
        };
        if numerics.exchange != Exchange::Potential {
            let mushy = match numerics.mushy {
                Mushy::Fraction => Value::Flag(true),
                Mushy::LastPhase => Value::Flag(false),
                Mushy::Mean => text("mean"),
            };
            put("mushy", mushy);
        }
        if numerics.front == Front::SubCell {
            put("front", text("sub-cell"));
        }
        let walls = match numerics.walls {
            WallModel::Mirror => "mirror",
            WallModel::MovingLeastSquares => "moving-least-squares",
            WallModel::Naive => "naive",
            WallModel::InnerLayers => "inner-layers",
        };
        put("wall_model", text(walls));
        let integrator = match numerics.integrator {
            // Beside water a step is the mean of two.
            IntegratorChoice::Euler if numerics.flow.is_some() => "heun",
            IntegratorChoice::Euler => "euler",
            IntegratorChoice::Rkl2 { stages } => {
                put("stages", Value::Number(stages as f64));
                "rkl2"
            }
            IntegratorChoice::ControlledRkl2 { .. } => "rkl2",
            IntegratorChoice::Implicit { .. } => "implicit",
        };
        put("integrator", text(integrator));
        if let Some(tolerance) = numerics.integrator.tolerance() {
            put("tolerance", Value::Number(tolerance));
        }
        match numerics.step {
            // Steps by error know no bound.
            StepChoice::Fraction(_) if numerics.integrator.tolerance().is_some() => None,
            StepChoice::Fraction(fraction) => put("step_fraction", Value::Number(fraction)),
            StepChoice::Fixed(step) => put("step", Value::Number(step)),
        };
        if let Some(flow) = numerics.flow {
            put("advection", text(flow.advection.name()));
            let conduction = Conduction::WORDS.iter().find(|word| word.1 == numerics.conduction);
            put("conduction", text(conduction.map_or("", |word| word.0)));
            let mean = match flow.mean {
                Mean::Harmonic => "harmonic",
                Mean::Arithmetic => "arithmetic",
                Mean::Geometric => "geometric",
            };
            put("permeability_mean", text(mean));
            put("pressure_change", Value::Number(flow.pressure_change));
            if flow.pressure_interval.is_finite() {
                put("pressure_interval", Value::Number(flow.pressure_interval));
            }
        }
        for (key, value) in &self.discretisation.knobs {
            put(key, value.clone());
        }
        values
    }
}

impl fmt::Debug for MethodSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MethodSettings")
            .field("method", &self.method)
            .field("setting", &self.setting)
            .field("numerics", &self.numerics)
            .finish_non_exhaustive()
    }
}

impl Default for Numerics {
    /// What works best: potential exchange of enthalpies on a lattice with mirror walls, explicit Euler at 0.9 of
    /// its bound. The spacing comes from the file.
    fn default() -> Self {
        Numerics {
            spacing: f64::NAN,
            layout: Layout::Lattice,
            exchange: Exchange::Potential,
            uptake: Uptake::Enthalpy,
            mushy: Mushy::Fraction,
            front: Front::Cell,
            walls: WallModel::Mirror,
            search: SearchChoice::Auto,
            integrator: IntegratorChoice::Euler,
            step: StepChoice::Fraction(0.9),
            conduction: Conduction::Plain,
            flow: None,
        }
    }
}
