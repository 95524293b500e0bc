//! Water through assembled particles, neighbours and walls.

use glam::DVec2;

use super::{FlowMethod, WaterLedger};
use crate::balances::groundwater::aquifer::{Aquifer, Warmth};
use crate::balances::groundwater::bend::Bend;
use crate::balances::groundwater::carrier::Carrier;
use crate::balances::groundwater::ground::{Flow, PressureWall};
use crate::balances::groundwater::network::{Network, WayOut};
use crate::balances::groundwater::numerics::{Conduction, FlowNumerics};
use crate::balances::groundwater::pressure::Pressure;
use crate::kernels::enthalpy_rows::{EnthalpyList, Tangent};
use crate::kernels::list_parts::ListParts;
use crate::kernels::rows::ListOperator;
use crate::kernels::term::Off;
use crate::ledger::{Ledger, Sum};
use crate::physics::latent_heat::{LatentHeatScheme, Materials, Mushy, scheme};
use crate::physics::material::Material;
use crate::physics::thermal::Thermal;
use crate::solvers::operator::Operator;
use crate::solvers::step::Bound;
use crate::space::domain::Domain;

/// What water flows through.
pub struct FlowParts<'a> {
    /// Particles, pairs and walls.
    pub list: ListParts,
    /// Pairs that a curved wall cuts.
    pub ways_out: &'a [WayOut],
    /// What conducts heat, where that is a lattice.
    pub lattice: Option<Box<dyn Operator>>,
    /// Materials, in the order of the particles'.
    pub ground: &'a [Material],
    /// The body.
    pub domain: Domain,
    /// What drives the water.
    pub flow: &'a Flow,
    /// How it is computed.
    pub numerics: FlowNumerics,
    /// Conduction beside it.
    pub conduction: Conduction,
    /// Steps over their bound.
    pub fraction: f64,
}

impl FlowMethod {
    /// Water through the assembled particles, neighbours and walls of a scene, from these enthalpies (J/m3) on. Heat is
    /// conducted by the pairs, or by the same on a lattice where there is one.
    pub fn new(parts: FlowParts<'_>, enthalpy: &[f64]) -> Result<Self, String> {
        let FlowParts { list: parts, ways_out, lattice, ground, domain, flow, numerics, conduction, fraction } = parts;
        let spacing = parts.spacing;
        let (materials, boundary) = (parts.materials.clone(), parts.boundary.clone());
        let first = &materials.thermals[0];
        let faces = boundary.first_faces(&first.curve, first.initial_potential);
        let pairs = (&parts.pairs, ways_out);
        let network = Network::new(&parts.positions, pairs, &parts.ghosts, &boundary, &faces, flow, conduction)?;
        let count = network.len();
        let aquifers = aquifers(ground, &materials, flow.viscosity)?;
        let water = aquifers[0].pores;
        let pressure = Pressure::new(&network, &parts.positions);
        let carrier = Carrier::new(&network, numerics.advection);
        let (volume, pool) = (parts.volumes.unit(), parts.pool.clone());
        let bend = (conduction == Conduction::Corrected)
            .then(|| Bend::new(&parts.positions, &parts.ghosts.position, &parts.pairs, spacing));
        let (lifts, heights) = lifts(flow, water.water_density * flow.gravity, domain, &parts.positions);
        let pairs = parts.pair_count();
        let operator = lattice.unwrap_or_else(|| {
            Box::new(EnthalpyList {
                operator: ListOperator::new(parts, Off),
                scheme: scheme(LatentHeatScheme::Enthalpy, Mushy::Fraction, &materials, enthalpy, count),
                rate: Vec::new(),
                tangent: Tangent::default(),
            })
        });
        let names: Vec<String> = operator.patches().into_iter().chain(["ice".to_owned()]).collect();
        let patches = vec![0.0; names.len()];
        let expands = flow.density_change && aquifers.iter().any(|aquifer| aquifer.expansion() != 0.0);
        let own_bound = bound(operator.as_ref(), bend.as_ref());
        let mut method = FlowMethod {
            pairs,
            pressure,
            carrier,
            bend,
            aquifers,
            boundary,
            faces,
            flow: flow.clone(),
            numerics,
            fraction,
            volume,
            across: across(domain, count),
            lifts,
            heights,
            capacity: water.water_density * water.water_heat_capacity,
            pool,
            temperature: vec![0.0; count],
            permeability: vec![1.0; count],
            solved: Vec::new(),
            conductivity: vec![0.0; count],
            walls: vec![0.0; flow.walls.len()],
            started: Vec::new(),
            asked: if expands { vec![0.0; count] } else { Vec::new() },
            asking: if expands { vec![0.0; count] } else { Vec::new() },
            last_solution: 0.0,
            interval: 0.0,
            ledger: Ledger::new(names),
            water: WaterLedger { walls: vec![Sum::default(); flow.walls.len()], ..WaterLedger::default() },
            rate: vec![0.0; count],
            start: vec![0.0; count],
            patches: [patches.clone(), patches],
            beside: Vec::new(),
            opening_temperatures: Vec::new(),
            bound: own_bound.clone(),
            own_bound,
            steps: 0,
            seconds: 0.0,
            materials,
            network,
            operator,
        };
        method.begin(enthalpy, expands)?;
        Ok(method)
    }

    /// Fills the columns from the enthalpies at the start, and solves for the first pressures.
    fn begin(&mut self, enthalpy: &[f64], expands: bool) -> Result<(), String> {
        self.warm(enthalpy);
        if expands {
            self.started =
                (0..enthalpy.len()).map(|i| self.aquifer(i).unfrozen(enthalpy[i], self.temperature[i])).collect();
        }
        self.permeate(enthalpy);
        self.solve(0.0, enthalpy)
    }
}

/// Materials as water of a viscosity (Pa s) sees them.
fn aquifers(ground: &[Material], materials: &Materials, viscosity: f64) -> Result<Vec<Aquifer>, String> {
    let aquifer = |(material, thermal): (&Material, &Thermal)| {
        let pores = material.pores.ok_or_else(|| format!("\"{}\" has no pores", material.name))?;
        let permeability = pores.permeability.ok_or_else(|| format!("\"{}\" has no permeability", material.name))?;
        Ok(Aquifer {
            warmth: Warmth::new(thermal),
            thermal: thermal.clone(),
            pores,
            open: permeability / viscosity,
            least_conductivity: thermal.curve.least_conductive(),
            by_enthalpy: material.is_sharp(),
        })
    };
    ground.iter().zip(materials.thermals.iter()).map(aquifer).collect()
}

/// The bound of conduction, corrected for bends or not.
fn bound(operator: &dyn Operator, bend: Option<&Bend>) -> Bound {
    let own = operator.bound();
    let Some(bend) = bend else { return own };
    let steepest = operator.steepest().into_iter().fold(0.0, f64::max);
    let linear = 2.0 / (bend.rate * steepest);
    if linear < own.step {
        return Bound { step: linear, cause: "linear limit of conduction without its bends".into() };
    }
    own
}

/// Particles across the body, of a ring as it is on the whole plan.
fn across(domain: Domain, count: usize) -> f64 {
    match domain {
        Domain::Line { .. } => 1.0,
        Domain::Ring { sector, .. } => (count as f64 / sector.images() as f64).sqrt(),
        _ => (count as f64).sqrt(),
    }
}

/// What the weight of water (N/m3) adds to the pressure of walls, and to that of particles (Pa; none without gravity): of one
/// density, p + rho g y takes the place of the pressure.
fn lifts(flow: &Flow, weight: f64, domain: Domain, places: &[DVec2]) -> (Vec<f64>, Vec<f64>) {
    let height = if let Domain::Rectangle { height, .. } = domain { height } else { 0.0 };
    let lift = |wall: &PressureWall| if wall.name == "top" { weight * height } else { 0.0 };
    let heights = if weight > 0.0 { places.iter().map(|place| weight * place.y).collect() } else { Vec::new() };
    (flow.walls.iter().map(lift).collect(), heights)
}
