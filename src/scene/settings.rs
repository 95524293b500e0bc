//! Numerical settings of one method on one scene: how, never what.

use frazil_core::balances::groundwater::numerics::{Advection, Conduction, FlowNumerics};
use frazil_core::balances::solute::advection::Advection as SoluteAdvection;
use frazil_core::bonds::exchange::{Exchange, Mean};
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::physics::latent_heat::{LatentHeatScheme, Mushy};
use frazil_core::solvers::transport::Coupling;
use frazil_record::Value;

use crate::solute::SoluteNumerics;

/// Which of a method's two standard settings is the starting point; keys of the file override it one by one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// What works best here: potential exchange, discrete-moment normalisation, mirror walls.
    Best,
    /// What the method's paper prints.
    Paper,
}

impl Setting {
    /// Both with the words of the file.
    pub const WORDS: [(&str, Setting); 2] = [("best", Setting::Best), ("paper", Setting::Paper)];
}

/// Where particles stand at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Arrangement {
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

impl Front {
    /// Both with the words of the file.
    pub const WORDS: [(&str, Front); 2] = [("cell", Front::Cell), ("sub-cell", Front::SubCell)];
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

impl SearchChoice {
    /// All of them with the words of the file.
    pub const WORDS: [(&str, SearchChoice); 5] = [
        ("auto", SearchChoice::Auto),
        ("lattice", SearchChoice::Lattice),
        ("tree", SearchChoice::Tree),
        ("cells", SearchChoice::Cells),
        ("all-pairs", SearchChoice::AllPairs),
    ];
}

/// How time advances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum IntegratorChoice {
    /// Explicit Euler.
    Euler,
    /// The mean of the state and of two steps of Euler.
    Heun,
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
            IntegratorChoice::Euler | IntegratorChoice::Heun | IntegratorChoice::Rkl2 { .. } => None,
            IntegratorChoice::ControlledRkl2 { tolerance } | IntegratorChoice::Implicit { tolerance } => {
                Some(tolerance)
            }
        }
    }

    /// Whether steps at the bound keep the maximum principle.
    pub fn is_monotone(self) -> bool {
        matches!(self, IntegratorChoice::Euler | IntegratorChoice::Heun)
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
    pub arrangement: Arrangement,
    /// Pair exchange.
    pub exchange: Exchange,
    /// Latent heat.
    pub latent_heat_scheme: LatentHeatScheme,
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
    /// Whether it is the usual one of the scene, which names none.
    pub usual_integrator: bool,
    /// Step.
    pub step: StepChoice,
    /// Conduction where water flows.
    pub conduction: Conduction,
    /// Flowing water, where the scene has it.
    pub flow: Option<FlowNumerics>,
    /// What water carries, where the scene has a solute.
    pub solute: Option<SoluteNumerics>,
}

impl Default for Numerics {
    /// What works best: potential exchange of enthalpies on a lattice with mirror walls, explicit Euler at 0.9 of
    /// its bound. The spacing comes from the file.
    fn default() -> Self {
        Numerics {
            spacing: f64::NAN,
            arrangement: Arrangement::Lattice,
            exchange: Exchange::Potential,
            latent_heat_scheme: LatentHeatScheme::Enthalpy,
            mushy: Mushy::Fraction,
            front: Front::Cell,
            walls: WallModel::Mirror,
            search: SearchChoice::Auto,
            integrator: IntegratorChoice::Euler,
            usual_integrator: true,
            step: StepChoice::Fraction(0.9),
            conduction: Conduction::Plain,
            flow: None,
            solute: None,
        }
    }
}

/// The word of a file for [`Exchange::Upstream`].
pub(crate) const UPSTREAM: &str = "upstream";

/// The word of a file that stands for a choice.
pub(crate) fn word<T: PartialEq>(words: &[(&str, T)], choice: &T) -> Value {
    Value::Text(words.iter().find(|(_, own)| own == choice).map_or("", |(word, _)| word).to_owned())
}

fn text(word: &str) -> Value {
    Value::Text(word.to_owned())
}

impl Numerics {
    /// All settings by the keys of the file, defaults included.
    pub(crate) fn values(&self) -> Vec<(&'static str, Value)> {
        let mut values =
            vec![("spacing", Value::Number(self.spacing)), ("wall_model", word(&WallModel::WORDS, &self.walls))];
        match self.arrangement {
            Arrangement::Lattice => values.push(("layout", text("lattice"))),
            Arrangement::Random => values.push(("layout", text("random"))),
            Arrangement::Jittered { fraction } => {
                values.extend([("layout", text("jittered")), ("jitter_fraction", Value::Number(fraction))]);
            }
        }
        match self.latent_heat_scheme {
            LatentHeatScheme::Enthalpy => values.push(("scheme", text("enthalpy"))),
            LatentHeatScheme::Flags => values.push(("scheme", text("flags"))),
            LatentHeatScheme::ApparentCapacity { interval } => {
                values.extend([("scheme", text("apparent-capacity")), ("interval_K", Value::Number(interval))]);
            }
        }
        match self.exchange {
            Exchange::Potential => values.push(("exchange", text("potential"))),
            Exchange::Mean(_) | Exchange::Upstream => {
                let mushy = match self.mushy {
                    Mushy::Fraction => Value::Flag(true),
                    Mushy::LastPhase => Value::Flag(false),
                    Mushy::Mean => text("mean"),
                };
                let mean = match self.exchange {
                    Exchange::Mean(mean) => word(&Mean::WORDS, &mean),
                    _ => text(UPSTREAM),
                };
                values.extend([("mean", mean), ("mushy", mushy)]);
            }
        }
        values.push(("front", word(&Front::WORDS, &self.front)));
        self.put_steps(&mut values);
        self.put_flow(&mut values);
        self.put_solute(&mut values);
        values
    }

    fn put_steps(&self, values: &mut Vec<(&'static str, Value)>) {
        let integrator = match self.integrator {
            IntegratorChoice::Euler => "euler",
            IntegratorChoice::Heun => "heun",
            IntegratorChoice::Rkl2 { .. } | IntegratorChoice::ControlledRkl2 { .. } => "rkl2",
            IntegratorChoice::Implicit { .. } => "implicit",
        };
        values.push(("integrator", text(integrator)));
        if let IntegratorChoice::Rkl2 { stages } = self.integrator {
            values.push(("stages", Value::Number(stages as f64)));
        }
        let tolerance = self.integrator.tolerance();
        values.extend(tolerance.map(|tolerance| ("tolerance", Value::Number(tolerance))));
        match self.step {
            // Steps by error know no bound.
            StepChoice::Fraction(_) if tolerance.is_some() => {}
            StepChoice::Fraction(fraction) => values.push(("step_fraction", Value::Number(fraction))),
            StepChoice::Fixed(step) => values.push(("step", Value::Number(step))),
        }
    }

    fn put_solute(&self, values: &mut Vec<(&'static str, Value)>) {
        let Some(solute) = self.solute else { return };
        values.extend([
            ("advection", word(&SoluteAdvection::WORDS, &solute.advection)),
            ("coupling", word(&Coupling::WORDS, &solute.coupling)),
            ("solute_step_fraction", Value::Number(solute.fraction)),
        ]);
    }

    fn put_flow(&self, values: &mut Vec<(&'static str, Value)>) {
        let Some(flow) = self.flow else { return };
        values.extend([
            ("advection", word(&Advection::WORDS, &flow.advection)),
            ("conduction", word(&Conduction::WORDS, &self.conduction)),
            ("permeability_mean", word(&Mean::WORDS, &flow.mean)),
            ("pressure_change", Value::Number(flow.pressure_change)),
        ]);
        if flow.pressure_interval.is_finite() {
            values.push(("pressure_interval", Value::Number(flow.pressure_interval)));
        }
    }
}
