//! Water through assembled particles, neighbours and walls.

use std::sync::Arc;

use glam::DVec2;

use super::{Groundwater, WaterLedger};
use crate::balances::groundwater::advected::AdvectedHeat;
use crate::balances::groundwater::aquifer::Aquifer;
use crate::balances::groundwater::bend::Bend;
use crate::balances::groundwater::carrier::Carrier;
use crate::balances::groundwater::cuts::CutPaths;
use crate::balances::groundwater::displaced::Displaced;
use crate::balances::groundwater::error::GroundwaterError;
use crate::balances::groundwater::ground::{Flow, PressureWall};
use crate::balances::groundwater::network::{Network, NetworkParts, WayOut};
use crate::balances::groundwater::numerics::{Conduction, FlowNumerics};
use crate::balances::groundwater::pressure::Pressure;
use crate::balances::groundwater::surfaces::Crossed;
use crate::boundary::patch::Face;
use crate::kernels::enthalpy_rows::ListBalance;
use crate::kernels::list_parts::ListParts;
use crate::kernels::term::Off;
use crate::ledger::Source;
use crate::ledger::Sum;
use crate::physics::latent_heat::{LatentHeatScheme, Materials, Mushy, scheme};
use crate::physics::material::Material;
use crate::physics::thermal::Thermal;
use crate::solvers::balance::{Balance, BalanceFacts};
use crate::solvers::step::Bound;
use crate::space::domain::Domain;
use crate::space::wall::WallId;

/// What water flows through.
pub struct FlowParts<'a> {
    /// Particles, pairs and walls.
    pub list: ListParts,
    /// Pairs that a curved wall cuts.
    pub ways_out: Vec<WayOut>,
    /// What conducts heat, where that is a lattice.
    pub lattice: Option<Box<dyn Balance>>,
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
    /// How much better water passes the ground of each particle than its material; empty where it passes all as its material.
    pub passes: Arc<[f64]>,
}

impl AdvectedHeat {
    /// Heat beside water through the assembled particles, neighbours and walls of a scene, from these enthalpies (J/m3) on. Heat
    /// is conducted by the pairs, or by the same on a lattice where there is one.
    ///
    /// # Errors
    /// Materials without pores, walls that water cannot pass, pressures that are not found.
    pub fn new(parts: FlowParts<'_>, enthalpy: &[f64]) -> Result<Self, GroundwaterError> {
        let FlowParts { list, ways_out, lattice, ground, domain, flow, numerics, conduction, passes } = parts;
        let bend = (conduction == Conduction::Corrected)
            .then(|| Bend::new(&list.positions, &list.ghosts.position, &list.pairs, list.spacing));
        let (materials, boundary, positions) = (list.materials.clone(), list.boundary.clone(), list.positions.clone());
        let (pairs, surfaces) = (list.pair_count(), list.surfaces.clone());
        let water =
            Groundwater { passes, ..Groundwater::new(&list, ways_out, ground, domain, flow, numerics, conduction)? };
        let mut conduction = lattice.unwrap_or_else(|| {
            let scheme = scheme(LatentHeatScheme::Enthalpy, Mushy::Fraction, &materials, enthalpy, enthalpy.len());
            Box::new(ListBalance::new(list, Off, scheme))
        });
        let patches = conduction.facts().patches.iter().copied().chain([Source::Ice]).collect();
        let crossed = |surface| Crossed::new(surface, &water.network, &water.carrier, flow, &positions);
        let surfaces: Vec<Crossed> = surfaces.iter().map(crossed).collect();
        let own_bound = bound(conduction.as_mut(), bend.as_ref());
        let facts = BalanceFacts { patches, pairs, surfaces: surfaces.len(), bound: own_bound.clone(), turning: 0.0 };
        let mut heat = AdvectedHeat {
            conduction,
            water,
            bend,
            boundary,
            own_bound,
            facts,
            surfaces,
            beside: Vec::new(),
            opening_temperatures: Vec::new(),
            rate: Vec::new(),
            warmed: Vec::new(),
            changes: Vec::new(),
        };
        let expands = flow.density_change && heat.water.aquifers.iter().any(|aquifer| aquifer.expansion() != 0.0);
        heat.water.start(enthalpy, expands)?;
        heat.bind();
        Ok(heat)
    }
}

impl Groundwater {
    /// Water along the pairs of a list.
    fn new(
        list: &ListParts,
        ways_out: Vec<WayOut>,
        ground: &[Material],
        domain: Domain,
        flow: &Flow,
        numerics: FlowNumerics,
        conduction: Conduction,
    ) -> Result<Self, GroundwaterError> {
        let ListParts { positions, pairs, ghosts, boundary, materials, factors, .. } = list;
        let first = &materials.thermals[0];
        let faces: Vec<Face> = boundary.first_faces(&first.curve, first.zero_potential);
        let least_conductivities = least_conductivities(materials, positions.len());
        let mut cuts = (!list.cuts.is_empty()).then(|| CutPaths {
            open: Vec::new(),
            positions: positions.clone(),
            pairs: pairs.clone(),
            cuts: list.cuts.clone(),
            ghosts: ghosts.clone(),
            boundary: boundary.clone(),
            faces: faces.clone(),
            flow: flow.clone(),
            ways_out: ways_out.clone(),
            conduction,
            least_conductivities: least_conductivities.clone(),
            factors: factors.clone(),
        });
        let network = match &mut cuts {
            Some(cuts) => cuts.start()?,
            None => Network::new(&NetworkParts {
                positions,
                pairs,
                ways_out: &ways_out,
                ghosts,
                boundary,
                faces: &faces,
                flow,
                conduction,
                least_conductivities: &least_conductivities,
                factors,
            })?,
        };
        let count = network.len();
        let aquifers = aquifers(ground, materials, flow.viscosity)?;
        let water = aquifers[0].pores;
        let (lifts, heights) = lifts(flow, water.water_density * flow.gravity, domain, positions);
        Ok(Groundwater {
            pressure: Pressure::new(&network, positions, list.team.clone()),
            carrier: Carrier::new(&network, numerics.advection),
            cuts: cuts.map(Box::new),
            aquifers,
            faces,
            flow: flow.clone(),
            numerics,
            volume: list.volumes.unit(),
            across: across(domain, count),
            lifts,
            heights,
            capacity: water.water_density * water.water_heat_capacity,
            team: list.team.clone(),
            temperature: vec![0.0; count],
            permeability: vec![1.0; count],
            passes: Arc::new([]),
            solved: Vec::new(),
            steepness: vec![1.0; count],
            conductivity: vec![0.0; count],
            walls: vec![0.0; flow.walls.len()],
            sums: Vec::new(),
            displaced: Displaced::default(),
            last_solution: 0.0,
            interval: 0.0,
            lasts: f64::INFINITY,
            ledger: WaterLedger { walls: vec![Sum::default(); flow.walls.len()], ..WaterLedger::default() },
            steps: 0,
            seconds: 0.0,
            materials: materials.clone(),
            network,
        })
    }

    /// Fills the columns from the enthalpies at the start, and solves for the first pressures.
    fn start(&mut self, enthalpy: &[f64], expands: bool) -> Result<(), GroundwaterError> {
        self.warm(enthalpy);
        if expands {
            let unfrozen = |i: usize| self.aquifer(i).unfrozen(enthalpy[i], self.temperature[i]);
            self.displaced = Displaced::from((0..enthalpy.len()).map(unfrozen).collect());
        }
        self.permeate(enthalpy);
        self.solve(0.0, enthalpy, false)
    }
}

/// Materials as water of a viscosity (Pa s) sees them.
fn aquifers(ground: &[Material], materials: &Materials, viscosity: f64) -> Result<Vec<Aquifer>, GroundwaterError> {
    let aquifer = |(material, thermal): (&Material, &Thermal)| {
        let pores = material.pores.ok_or_else(|| GroundwaterError::NoPores(material.name.clone()))?;
        let permeability = pores.permeability.ok_or_else(|| GroundwaterError::NoPermeability(material.name.clone()))?;
        Ok(Aquifer::new(thermal, pores, permeability / viscosity, material.is_sharp()))
    };
    ground.iter().zip(materials.thermals.iter()).map(aquifer).collect()
}

/// Least conductivity (W/mK) that the material of each of so many particles can have.
fn least_conductivities(materials: &Materials, count: usize) -> Vec<f64> {
    let by_material: Vec<f64> = materials.thermals.iter().map(|thermal| thermal.curve.least_conductive()).collect();
    (0..count).map(|i| by_material[materials.index(i)]).collect()
}

/// The bound of conduction, corrected for bends or not.
fn bound(conduction: &mut dyn Balance, bend: Option<&Bend>) -> Bound {
    let own = conduction.facts().bound.clone();
    let Some(bend) = bend else { return own };
    let steepest = conduction.tangent().steepest().into_iter().fold(0.0, f64::max);
    let linear = 2.0 / (bend.rate * steepest);
    if linear < own.step {
        return Bound::strict(linear, "linear limit of conduction without its bends");
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
    let lift = |wall: &PressureWall| if wall.wall == WallId::Top { weight * height } else { 0.0 };
    let heights = if weight > 0.0 { places.iter().map(|place| weight * place.y).collect() } else { Vec::new() };
    (flow.walls.iter().map(lift).collect(), heights)
}
