//! What the sweep over a lattice is made from, and the bound of its step.

use std::sync::Arc;

use rayon::ThreadPool;

use crate::bonds::stencil::Stencil;
use crate::boundary::patch::{Boundary, Face, Side};
use crate::boundary::pipe::Sink;
use crate::kernels::corner::CornerPair;
use crate::kernels::exterior::Exterior;
use crate::kernels::sweep::{Band, Shape};
use crate::physics::sub_cell::SubCellFront;
use crate::physics::thermal::Thermal;
use crate::solvers::step::Bound;
use crate::space::lattice::Lattice;

/// Everything an operator on a lattice is made from.
#[derive(Clone)]
pub struct LatticeParts {
    /// The lattice.
    pub lattice: Arc<Lattice>,
    /// The weights.
    pub stencil: Stencil,
    /// Fronts inside particles, if they are to be followed.
    pub front: Option<SubCellFront>,
    /// The one material.
    pub thermal: Thermal,
    /// The walls.
    pub boundary: Boundary,
    /// The pipes.
    pub sinks: Vec<Sink>,
    /// Names of pipe rings.
    pub rings: Vec<String>,
    /// Threads, if more than one.
    pub pool: Option<Arc<ThreadPool>>,
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

#[allow(clippy::too_many_arguments)]
pub(super) fn bound(
    lattice: &Lattice,
    stencil: &Stencil,
    sum: f64,
    thermal: &Thermal,
    boundary: &Boundary,
    faces: &[Face],
    exterior: Option<&Exterior>,
    sinks: &[Sink],
    corners: &[CornerPair],
) -> Bound {
    let mut largest = sum;
    let mut cause = "pair exchange inside the body".to_string();
    // A particle reaches its own image behind a wall at twice its distance from it.
    let stiffness = |side: usize| match boundary.sides[side] {
        Side::Wall(patch) => faces[patch].stiffness().max(0.0),
        Side::Mirror | Side::Curved => 0.0,
    };
    let excess = |near: usize, far: usize, cells: usize| {
        let own = |side: usize, layer: usize| stiffness(side) * stencil.at(2 * layer + 1, 0);
        (0..cells).map(|layer| own(near, layer) + own(far, cells - 1 - layer)).fold(0.0, f64::max)
    };
    let across = if lattice.dimension == 1 { 0.0 } else { excess(2, 3, lattice.rows) };
    let wall_excess = excess(0, 1, lattice.columns) + across;
    if wall_excess > 0.0 {
        let mut strengthened = std::collections::BTreeMap::new();
        for pair in corners {
            *strengthened.entry(pair.first).or_insert(0.0) += pair.weight;
            *strengthened.entry(pair.second).or_insert(0.0) += pair.weight;
        }
        largest = sum + wall_excess + strengthened.values().copied().fold(0.0, f64::max);
        let stiff: Vec<&str> = (0..4)
            .filter(|side| stiffness(*side) > 0.0)
            .filter_map(|side| match boundary.sides[side] {
                Side::Wall(patch) => Some(boundary.patches[patch].name.as_str()),
                Side::Mirror | Side::Curved => None,
            })
            .collect();
        cause = format!("pair exchange of the particles at wall `{}`", stiff.join("` and `"));
    }
    if let (Some(exterior), Some((patch, _))) = (exterior, boundary.curved) {
        let contacts = exterior.contacts.contacts.iter();
        let added = contacts.map(|contact| faces[patch].holds() * contact.stiffness - contact.cut).fold(0.0, f64::max);
        if sum + added > largest {
            largest = sum + added;
            cause = "pair exchange of the particles at the curved wall".to_string();
        }
    }
    for sink in sinks {
        for (index, row_sum) in sink.row_sums(lattice.spacing) {
            if sum + row_sum > largest {
                largest = sum + row_sum;
                let at = lattice.position(index);
                cause = format!(
                    "particle {index} at ({:.4}, {:.4}) m, which the pipe at ({:.4}, {:.4}) m cools",
                    at.x, at.y, sink.extent.centre.x, sink.extent.centre.y
                );
            }
        }
    }
    Bound { step: 1.0 / (largest * thermal.largest_slope), cause }
}
