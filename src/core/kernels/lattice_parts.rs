//! What the sweep over a lattice is made from, and the bound of its step.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::bonds::stencil::Stencil;
use crate::boundary::patch::{Boundary, Side};
use crate::boundary::pipe::Sink;
use crate::kernels::around::Around;
use crate::kernels::corner::CornerPair;
use crate::kernels::irregular::IrregularRows;
use crate::kernels::sweep::{Band, Shape};
use crate::physics::latent_heat::Materials;
use crate::physics::laws::Laws;
use crate::physics::sub_cell::SubCellFront;
use crate::solvers::step::Bound;
use crate::space::lattice::Lattice;
use crate::team::Team;

/// Everything an operator on a lattice is made from.
pub struct LatticeParts {
    /// The lattice.
    pub lattice: Arc<Lattice>,
    /// The weights.
    pub stencil: Stencil,
    /// Fronts inside particles, if they are to be followed.
    pub front: Option<SubCellFront>,
    /// Materials of particles.
    pub materials: Materials,
    /// The walls that the sweep sees: those at irregular rows are mirrors to it.
    pub boundary: Boundary,
    /// Rows that the stencil does not know.
    pub irregular: Option<Box<IrregularRows>>,
    /// Rows at the surfaces through which heat is counted.
    pub observed: Option<Box<IrregularRows>>,
    /// The pipes.
    pub sinks: Vec<Sink>,
    /// How many rings of pipes there are.
    pub rings: usize,
    /// Threads, if more than one.
    pub team: Option<Team>,
    /// The bound of the step, where it is known from elsewhere.
    pub bound: Option<Bound>,
}

/// Bands of rows with about the same number of particles each.
pub(super) fn bands(lattice: &Lattice, count: usize, shape: Shape) -> Vec<Band> {
    let mut cuts: Vec<usize> = (0..=count)
        .map(|k| {
            let wanted = lattice.len() * k / count;
            (0..=lattice.rows).find(|row| lattice.start(*row) >= wanted).unwrap_or(lattice.rows)
        })
        .collect();
    cuts.dedup();
    cuts.windows(2).map(|cut| Band::new((cut[0], cut[1]), shape)).collect()
}

/// What the bound of a step follows from.
pub(super) struct Stiffness<'a, L> {
    pub(super) around: &'a Around<L>,
    pub(super) boundary: &'a Boundary,
    pub(super) irregular: Option<&'a IrregularRows>,
    pub(super) sinks: &'a [Sink],
    pub(super) corners: &'a [CornerPair],
    pub(super) front: Option<&'a SubCellFront>,
}

/// What limits a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Limit {
    /// The maximum principle, by row sums.
    Maximum,
    /// Linear stability: of what pairs alone do, by the largest rate at which they let a wave decay, of what is added to them by row
    /// sums (Weyl). Walls that mirror states, odd or even, leave the waves of a body that goes on.
    Linear,
}

/// The stiffest particle so far.
struct Stiffest {
    /// Row sum times the slope of its law (1/s).
    rate: f64,
    cause: String,
}

impl Stiffest {
    fn meet(&mut self, rate: f64, cause: impl FnOnce() -> String) {
        if rate > self.rate {
            *self = Stiffest { rate, cause: cause() };
        }
    }
}

impl<L: Laws> Stiffness<'_, L> {
    /// The bound of explicit steps by the row sums of the actual pairs. Nothing is known beyond it where rows have pairs of their own.
    pub(super) fn bound(&self) -> Bound {
        let mut stiffest = self.stiffest(Limit::Maximum);
        let of_front = self.front.map_or(0.0, SubCellFront::own_rate);
        stiffest.meet(of_front, || "the sub-cell front of a particle".to_string());
        let Stiffest { rate, cause } = stiffest;
        if self.irregular.is_some() {
            return Bound::strict(1.0 / rate, cause);
        }
        // A front is near on one side at a time.
        let linear = self.stiffest(Limit::Linear).rate.max(0.5 * of_front);
        Bound { step: 1.0 / rate, slack: (rate / linear).max(1.0), cause }
    }

    /// The particle that limits steps most. Half of the rate of a wave stands for a row sum.
    fn stiffest(&self, limit: Limit) -> Stiffest {
        let Around { lattice, stencil, materials, .. } = self.around;
        // What fronts may add: where they are near on all sides, and on one.
        let [on_all_sides, on_one] = self.front.map_or([0.0; 2], SubCellFront::row_sums);
        let (pairs, beside_fronts) = match limit {
            Limit::Maximum => (stencil.sum(), on_all_sides),
            Limit::Linear => (0.5 * stencil.fastest_wave(), on_one),
        };
        let sum = pairs + beside_fronts;
        let steepest = materials.laws().map(|thermal| thermal.largest_slope).fold(0.0, f64::max);
        let mut stiffest = Stiffest { rate: sum * steepest, cause: "pair exchange inside the body".to_string() };
        self.meet_straight_walls(sum, limit, &mut stiffest);
        self.meet_curved_wall(sum, &mut stiffest);
        let at = |index: usize| {
            let at = lattice.position(index);
            format!("({:.4}, {:.4}) m", at.x, at.y)
        };
        let mut sums = BTreeMap::new();
        if let Some(irregular) = self.irregular {
            for (particle, own) in irregular.particles().iter().zip(irregular.row_sums()) {
                let (particle, own) = (*particle as usize, own + beside_fronts);
                sums.insert(particle, own);
                let cause = || format!("pair exchange of particle {particle} at {}", at(particle));
                stiffest.meet(own * materials.of(particle).largest_slope, cause);
            }
        }
        for sink in self.sinks {
            for (index, row_sum) in sink.row_sums(lattice.spacing) {
                let own = sums.get(&index).copied().unwrap_or(sum);
                stiffest.meet((own + row_sum) * materials.of(index).largest_slope, || {
                    let pipe = sink.extent.centre;
                    let (x, y) = (pipe.x, pipe.y);
                    format!("particle {index} at {}, which the pipe at ({x:.4}, {y:.4}) m cools", at(index))
                });
            }
        }
        stiffest
    }

    fn meet_straight_walls(&self, sum: f64, limit: Limit, stiffest: &mut Stiffest) {
        let (Around { lattice, stencil, faces, .. }, boundary) = (self.around, self.boundary);
        // A particle reaches its own image behind a wall at twice its distance from it.
        let stiffness = |side: usize| match boundary.sides[side] {
            Side::Wall(patch) => faces[patch].stiffness().max(0.0),
            Side::Mirror | Side::Periodic | Side::Curved => 0.0,
        };
        let excess = |near: usize, far: usize, cells: usize| {
            let at = |side: usize, cells: usize| if side < 2 { stencil.at(cells, 0) } else { stencil.at(0, cells) };
            let own = |side: usize, layer: usize| stiffness(side) * at(side, 2 * layer + 1);
            (0..cells).map(|layer| own(near, layer) + own(far, cells - 1 - layer)).fold(0.0, f64::max)
        };
        let across = if lattice.dimension == 1 { 0.0 } else { excess(2, 3, lattice.rows) };
        let wall_excess = excess(0, 1, lattice.columns) + across;
        if wall_excess == 0.0 {
            return;
        }
        let wall_excess = if limit == Limit::Linear { 0.0 } else { wall_excess };
        let mut strengthened = BTreeMap::new();
        for pair in self.corners {
            *strengthened.entry(pair.first).or_insert(0.0) += pair.weight;
            *strengthened.entry(pair.second).or_insert(0.0) += pair.weight;
        }
        let largest = sum + wall_excess + strengthened.values().copied().fold(0.0, f64::max);
        let stiff: Vec<usize> = (0..4).filter(|side| stiffness(*side) > 0.0).collect();
        let slope = stiff.iter().map(|side| self.around.thermal_at(*side).largest_slope).fold(0.0, f64::max);
        stiffest.meet(largest * slope, || {
            let name = |side: &usize| match boundary.sides[*side] {
                Side::Wall(patch) => Some(boundary.patches[patch].id.to_string()),
                Side::Mirror | Side::Periodic | Side::Curved => None,
            };
            let names: Vec<String> = stiff.iter().filter_map(name).collect();
            format!("pair exchange of the particles at wall `{}`", names.join("` and `"))
        });
    }

    fn meet_curved_wall(&self, sum: f64, stiffest: &mut Stiffest) {
        let Some((exterior, (patch, _))) = self.around.exterior.as_ref().zip(self.boundary.curved) else { return };
        let face = &self.around.faces[patch];
        let contacts = exterior.contacts.contacts.iter();
        let added = contacts.map(|contact| face.holds() * contact.stiffness - contact.cut).fold(0.0, f64::max);
        let slope = self.around.thermal_of(patch).largest_slope;
        stiffest.meet((sum + added) * slope, || "pair exchange of the particles at the curved wall".to_string());
    }
}
