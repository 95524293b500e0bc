//! A solute against closed forms, and what must hold whatever the water does.

mod columns;
mod invariants;
mod planes;

use std::sync::Arc;

use glam::DVec2;

use crate::balances::solute::advection::Advection;
use crate::balances::solute::{Entering, Solute, SoluteParts};
use crate::bonds::exchange::Exchange;
use crate::bonds::pair_list::PairList;
use crate::bonds::stencil::Stencil;
use crate::bonds::weight::{Disc, Normalisation};
use crate::boundary::condition::Condition;
use crate::boundary::ghosts::Ghosts;
use crate::boundary::ghosts::passing::Passing;
use crate::boundary::interface::Chains;
use crate::boundary::patch::{Boundary, Patch, Side};
use crate::breakage::cuts::Cuts;
use crate::kernels::list_parts::ListParts;
use crate::neighbours::tree::Tree;
use crate::neighbours::{NeighbourSearch, Period};
use crate::particles::{Particles, Places};
use crate::physics::latent_heat::Materials;
use crate::physics::solute_material::{SoluteMaterial, Tortuosity};
use crate::series::Series;
use crate::solvers::passenger::{Interval, Passenger};
use crate::solvers::solver::Solver;
use crate::solvers::step::Clock;
use crate::space::domain::Domain;
use crate::space::lattice::Lattice;
use crate::space::volumes::Volumes;
use crate::space::wall::{PatchId, WallId};

/// All ways to carry a solute.
const ALL: [Advection; 5] =
    [Advection::Limited, Advection::Fitted, Advection::Central, Advection::Upwind, Advection::Paper];

/// Those that keep the range of the data.
const BOUNDED: [Advection; 3] = [Advection::Limited, Advection::Fitted, Advection::Upwind];

/// A body on a lattice.
struct Body {
    list: ListParts,
    lattice: Arc<Lattice>,
}

impl Body {
    /// A body whose pairs reach over so many cells, with open walls and mirrors left, right, at the bottom and the top, and
    /// parts of walls that are open too.
    fn new(domain: Domain, spacing: f64, reach: usize, open: [bool; 4], parts: &[(WallId, f64, f64)]) -> Self {
        let lattice = Arc::new(Lattice::new(&domain, spacing));
        let walls = [WallId::Left, WallId::Right, WallId::Bottom, WallId::Top];
        let patch = |id: PatchId, open: bool| {
            let condition = if open { Condition::Temperature(Series::Constant(0.0)) } else { Condition::Symmetry };
            Patch { id, condition, layers: false, changes: false, falls: 0.0, exact: None }
        };
        let mut patches: Vec<Patch> =
            walls.iter().zip(open).map(|(wall, open)| patch(PatchId::Whole(*wall), open)).collect();
        let mut found = Vec::new();
        for (number, (wall, from, to)) in parts.iter().enumerate() {
            found.push((*wall, *from, *to, patches.len()));
            patches.push(patch(PatchId::Part(*wall, number), true));
        }
        let sides = std::array::from_fn(Side::Wall);
        let boundary = Boundary { parts: found, books_all: false, patches, sides, curved: None, dug: None };
        let reach_m = reach as f64 * lattice.spacing;
        let positions = lattice.positions();
        let ghosts = Ghosts::new(&positions, &lattice, &boundary, reach_m, false);
        let pairs = pairs(&positions, &ghosts, &lattice, &boundary, reach_m);
        let list = ListParts {
            volumes: Volumes::new(&domain, &lattice, false),
            positions: positions.into(),
            spacing: lattice.spacing,
            materials: Materials::new(Arc::new([]), Vec::new()),
            factors: Arc::new([]),
            pairs,
            chains: Chains::default(),
            cuts: Cuts::default(),
            ghosts,
            boundary,
            rims: Vec::new(),
            touches: Vec::new(),
            sinks: Vec::new(),
            rings: 0,
            surfaces: Vec::new(),
            up: None,
            exchange: Exchange::Potential,
            team: None,
            bound: None,
        };
        Body { list, lattice }
    }

    /// A line.
    fn line(length: f64, cells: usize, reach: usize) -> Self {
        Body::new(Domain::Line { length }, length / cells as f64, reach, [true, true, false, false], &[])
    }

    fn len(&self) -> usize {
        self.list.positions.len()
    }

    /// From the particle to the partner of each entry (m), with its particle.
    fn arms(&self) -> Vec<(usize, DVec2)> {
        let pairs = &self.list.pairs;
        let row = |i: usize| (pairs.starts[i]..pairs.starts[i + 1]).map(move |k| (i, k));
        let entries = (0..self.len()).flat_map(row);
        entries.map(|(i, k)| (i, super::dispersion::arm(&self.list, i, pairs.partners[k] as usize))).collect()
    }

    /// Water of one Darcy velocity (m/s).
    fn even_flow(&self, velocity: DVec2) -> Vec<f64> {
        let weights = &self.list.pairs.weights;
        self.arms().iter().zip(weights).map(|((_, arm), weight)| -weight * velocity.dot(*arm)).collect()
    }

    /// Water between heads that a hash makes of particles and walls, and what particles gain of it.
    fn uneven_flow(&self, speed: f64) -> (Vec<f64>, Vec<f64>) {
        let (count, pairs, ghosts) = (self.len(), &self.list.pairs, &self.list.ghosts);
        let random = |n: usize| ((n * 7919 + 13) % 1009) as f64 / 1009.0 - 0.5;
        let mut heads: Vec<f64> = (0..count + ghosts.len()).map(random).collect();
        let patches = &self.list.boundary.patches;
        ghosts.fill(&mut heads, |ghost, image| match ghosts.patch[ghost].map(usize::from) {
            Some(patch) if patches[patch].lets_heat_through() => 2.0 * random(patch + 3) - image,
            _ => image,
        });
        let flows: Vec<f64> = self
            .arms()
            .iter()
            .enumerate()
            .map(|(k, (i, _))| {
                let j = pairs.partners[k] as usize;
                let other = j.checked_sub(count).map_or(j, |ghost| ghosts.makers(ghost, count)[0] as usize);
                let eased = 1.0 + random(i * other + i + other);
                speed * self.list.spacing * pairs.weights[k] * eased * (heads[j] - heads[*i])
            })
            .collect();
        let gains = (0..count).map(|i| flows[pairs.starts[i]..pairs.starts[i + 1]].iter().sum()).collect();
        (flows, gains)
    }

    /// A solute with concentrations of walls.
    fn solute(
        &self,
        material: SoluteMaterial,
        walls: &[Option<f64>],
        advection: Advection,
        contents: &[f64],
    ) -> Solute {
        let walls = walls.iter().map(|wall| wall.map(held)).collect();
        let parts = SoluteParts { list: self.list.clone(), materials: vec![material], walls, advection };
        Solute::new(parts, contents).expect("parts that fit")
    }

    /// Particles with these contents.
    fn particles(&self, contents: Vec<f64>) -> Particles {
        Particles {
            factors: [].into(),
            solute: Vec::new(),
            concentration: Vec::new(),
            enthalpy: contents,
            start: Arc::new([]),
            places: Places::Cloud(self.list.positions.clone()),
            velocity: Vec::new(),
            lattice: self.lattice.clone(),
            volumes: self.list.volumes.clone(),
            sub_cell: false,
            shaft: None,
            materials: self.list.materials.clone(),
        }
    }
}

/// Pairs with weights by the offsets of a lattice.
fn pairs(positions: &[DVec2], ghosts: &Ghosts, lattice: &Lattice, boundary: &Boundary, reach: f64) -> PairList {
    let stencil = Stencil::new(&Disc(reach, 2.0), Normalisation::DiscreteMoment, lattice.spacing, lattice.dimension);
    let points = [positions, &ghosts.position].concat();
    let near = Tree.neighbours(&points, positions.len(), reach * (1.0 + 1e-6), Period::NONE);
    let passing = Passing::new(ghosts, positions.len(), lattice, boundary, |beyond| beyond);
    let mut pairs = PairList { starts: vec![0], ..PairList::default() };
    for i in 0..positions.len() {
        for j in near.of(i) {
            let cells = ((points[*j as usize] - points[i]) / lattice.spacing).round().abs();
            let share = (*j as usize).checked_sub(positions.len()).map_or(1.0, |ghost| passing.share(points[i], ghost));
            pairs.partners.push(*j);
            pairs.weights.push(share * stencil.at(cells.x as usize, cells.y as usize));
        }
        pairs.starts.push(pairs.partners.len());
    }
    pairs
}

/// The solute of a wall that holds a concentration.
fn held(concentration: f64) -> Entering {
    Entering { concentration: Series::Constant(concentration), diffuses: true }
}

/// A solute that only diffuses.
fn plain(diffusion: f64) -> SoluteMaterial {
    SoluteMaterial {
        diffusion,
        tortuosity: Tortuosity::None,
        longitudinal_dispersivity: 0.0,
        transverse_dispersivity: 0.0,
        sorption: 0.0,
        decay: 0.0,
    }
}

/// Water that flows on and on.
fn steady(solute: &mut Solute, flows: &[f64], contents: &[f64]) {
    solute.take(&Interval { start: 0.0, step: 1e9, flows, contents: (contents, contents) });
}

/// Makes steps of at most the given length (s) up to a time (s), and looks at the state after each.
fn run(
    solver: &mut dyn Solver,
    particles: &mut Particles,
    (step, end): (f64, f64),
    mut look: impl FnMut(f64, &Particles),
) {
    let steps = (end / step).ceil();
    for index in 0..steps as u64 {
        let time = index as f64 * (end / steps);
        let clock = Clock { time, step: end / steps, index, turned: index == 0 };
        solver.advance(particles, &clock).expect("a step");
        look(time + end / steps, particles);
    }
}

/// The complementary error function's product with an exponential, for solutions whose factors overflow.
fn scaled_erfc(exponent: f64, argument: f64) -> f64 {
    if argument < 20.0 {
        return exponent.exp() * libm::erfc(argument);
    }
    let square = argument * argument;
    (exponent - square).exp() / (argument * std::f64::consts::PI.sqrt()) * (1.0 - 0.5 / square)
}

/// Concentration at a place (m) and time (s) behind a wall of concentration one, in water of velocity (m/s) with dispersion (m2/s), for a
/// solute that is retarded and decays (1/s): Ogata and Banks 1961, and van Genuchten and Alves 1982.
fn half_space(x: f64, t: f64, velocity: f64, diffusion: f64, retardation: f64, decay: f64) -> f64 {
    let root = (velocity * velocity + 4.0 * decay * retardation * diffusion).sqrt();
    let width = 2.0 * (diffusion * retardation * t).sqrt();
    let part = |sign: f64| {
        scaled_erfc((velocity + sign * root) * x / (2.0 * diffusion), (retardation * x + sign * root * t) / width)
    };
    0.5 * (part(-1.0) + part(1.0))
}
