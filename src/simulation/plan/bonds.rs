//! Bonds of particles on a list, and walls around them.

use std::sync::Arc;

use frazil_core::balances::groundwater::network::WayOut;
use frazil_core::bonds::exchange::Exchange;
use frazil_core::bonds::pair_list::PairList;
use frazil_core::bonds::stencil::SHELL_TOLERANCE;
use frazil_core::bonds::weight::Normalisation;
use frazil_core::boundary::curved_wall::{Contacts, Neighbourhood, Rim, cells_behind};
use frazil_core::boundary::ghosts::Ghosts;
use frazil_core::boundary::interface::Chains;
use frazil_core::boundary::patch::Boundary;
use frazil_core::boundary::shells::{Shells, Touch, naive_shells, shells};
use frazil_core::boundary::wall_layers::{Body, WallModel, inner, level};
use frazil_core::breakage::crack::{Barriers, Cuts};
use frazil_core::breakage::excavation;
use frazil_core::kernels::corner::strengthen;
use frazil_core::kernels::list_parts::ListParts;
use frazil_core::neighbours::all_pairs::AllPairs;
use frazil_core::neighbours::cells::Cells;
use frazil_core::neighbours::tree::Tree;
use frazil_core::neighbours::{NeighbourSearch, Period};
use frazil_core::physics::latent_heat::Materials;
use frazil_core::space::lattice::Lattice;
use frazil_core::space::symmetry::Symmetry;
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;
use frazil_scene::settings::SearchChoice;
use glam::DVec2;
use rayon::ThreadPool;

use crate::interface;
use crate::plan::prepared::Prepared;
use crate::refused::{Refused, refuse};

/// The parts of a list, and the bonds through which water leaves at a curved wall.
pub(super) fn list(
    scene: &Scene,
    settings: &MethodSettings,
    prepared: &mut Prepared,
    pool: Option<Arc<ThreadPool>>,
) -> Result<(ListParts, Vec<WayOut>), Refused> {
    let numerics = &settings.numerics;
    let positions = prepared.positions();
    let (bonds, cut) = bonds(scene, settings, prepared, &positions)?;
    let Bonds { mut pairs, mut ghosts, touches } = bonds;
    let (boundary, lattice, materials) = (&prepared.boundary, &prepared.lattice, &prepared.materials);
    let (contacts, ways_out) = cut;
    let outer = boundary.curved.map(|(patch, _)| Rim { patch, from: 0.0, contacts });
    let mut rims: Vec<Rim> = outer.into_iter().collect();
    let cuts = if let Some(dug) = &boundary.dug {
        let (cuts, face) = excavation::face(&pairs, &positions, &ghosts, materials, dug);
        rims.push(face);
        cuts
    } else if scene.cracks.is_empty() {
        Cuts::default()
    } else {
        let barriers = Barriers::new(&scene.cracks, lattice, boundary);
        Cuts::new(&mut pairs, &positions, &ghosts, &barriers)
    };
    let chains = if numerics.exchange == Exchange::Potential {
        let seen = interface::Seen {
            positions: &positions,
            materials,
            pairs: &pairs,
            boundary,
            rims: &rims,
            touches: &touches,
            lattice,
        };
        interface::chains(scene, numerics, &seen, &mut ghosts)
    } else {
        Chains::default()
    };
    let parts = ListParts {
        chains,
        positions,
        volumes: prepared.volumes.clone(),
        spacing: lattice.spacing,
        materials: materials.clone(),
        pairs,
        cuts,
        ghosts,
        boundary: boundary.clone(),
        rims,
        touches,
        surfaces: scene.watch.surfaces.clone(),
        sinks: std::mem::take(&mut prepared.sinks),
        rings: std::mem::take(&mut prepared.rings),
        exchange: numerics.exchange,
        pool,
        bound: settings.bound.clone(),
    };
    Ok((parts, ways_out))
}

/// Bonds with what stands behind walls.
struct Bonds {
    pairs: PairList,
    ghosts: Ghosts,
    /// Where walls touch shells.
    touches: Vec<Touch>,
}

/// Bonds, walls as layers of particles among them, and what became of those that a curved wall cuts.
fn bonds(
    scene: &Scene,
    settings: &MethodSettings,
    prepared: &Prepared,
    positions: &[DVec2],
) -> Result<(Bonds, (Contacts, Vec<WayOut>)), Refused> {
    let Prepared { lattice, boundary, materials, volumes, stencil, printed, .. } = prepared;
    let walls = settings.numerics.walls;
    let (shelled, naive) = (scene.domain.symmetry().is_some() && !printed, walls == WallModel::Naive);
    let (mut bonds, cut) = if shelled {
        let made = if naive { naive_shells } else { shells };
        let Shells { pairs, touches, ghosts } = made(&scene.domain, lattice, stencil, boundary).map_err(refuse)?;
        (Bonds { pairs, ghosts, touches }, (Contacts::default(), Vec::new()))
    } else {
        let reach = settings.discretisation.weight.reach();
        let ghosts = Ghosts::new(positions, lattice, boundary, reach, walls == WallModel::MovingLeastSquares);
        let (mut pairs, contacts, ways_out) = pairs(positions, &ghosts, lattice, boundary, materials, settings);
        match scene.domain.symmetry() {
            Some(symmetry) => print_shapes(&mut pairs, symmetry, positions, &ghosts)?,
            None => {
                let first = &materials.thermals[0];
                let faces = boundary.first_faces(&first.curve, first.initial_potential);
                strengthen(&mut pairs, &ghosts, positions.len(), &faces);
            }
        }
        (Bonds { pairs, ghosts, touches: Vec::new() }, (contacts, ways_out))
    };
    let symmetry = scene.domain.symmetry();
    let body = Body { positions, lattice, boundary, volumes, materials, symmetry };
    if naive && (scene.brings_heat() || shelled) {
        level(&mut bonds.ghosts, &bonds.pairs, &body, shelled);
    }
    if walls == WallModel::InnerLayers {
        bonds.touches = inner(&mut bonds.pairs, &mut bonds.ghosts, &body, stencil.reach).map_err(refuse)?;
    }
    Ok((bonds, cut))
}

/// Pairs with their weights: every partner within reach of every particle, ghosts included; and what became of those
/// that a curved wall cuts, for heat and, where it flows, for water.
fn pairs(
    positions: &[DVec2],
    ghosts: &Ghosts,
    lattice: &Lattice,
    boundary: &Boundary,
    materials: &Materials,
    MethodSettings { numerics, discretisation, .. }: &MethodSettings,
) -> (PairList, Contacts, Vec<WayOut>) {
    let (weight, flows) = (discretisation.weight.as_ref(), numerics.flow.is_some());
    // On a lattice a radius that falls on a shell must not depend on rounding.
    let limit = weight.reach() * (1.0 + SHELL_TOLERANCE);
    let mut points = positions.to_vec();
    points.extend_from_slice(&ghosts.position);
    let count = positions.len();
    let list = match numerics.search {
        SearchChoice::Auto | SearchChoice::Lattice | SearchChoice::Tree => {
            Tree.neighbours(&points, count, limit, Period::NONE)
        }
        SearchChoice::Cells => Cells.neighbours(&points, count, limit, Period::NONE),
        SearchChoice::AllPairs => AllPairs.neighbours(&points, count, limit, Period::NONE),
    };
    // Coincident points exchange nothing: their distance gives no direction.
    let distance = |i: usize, j: u32| (points[j as usize] - points[i]).length();
    let volume = lattice.volume();
    let behind = |i: usize| {
        let curved = boundary.curved.into_iter();
        let cells = curved.flat_map(move |(_, radius)| cells_behind(positions[i], lattice, radius, limit));
        cells.map(|(way, depth)| (way, depth, volume * weight.weight(way.length())))
    };
    let mut weights: Vec<f64> = Vec::with_capacity(list.partners.len());
    let mut scale = vec![1.0; points.len()];
    for i in 0..count {
        let mut moment: f64 = behind(i).map(|(way, _, pair)| pair * way.length_squared()).sum();
        for j in list.of(i) {
            let distance = distance(i, *j);
            let share = (*j as usize).checked_sub(count).map_or(1.0, |ghost| ghosts.share(ghost));
            let pair = if distance > 0.0 { volume * share * weight.weight(distance) } else { 0.0 };
            moment += pair * distance * distance;
            weights.push(pair);
        }
        if discretisation.normalisation == Normalisation::DiscreteMoment {
            scale[i] = if moment > 0.0 { (2 * lattice.dimension) as f64 / moment } else { 0.0 };
        }
    }
    for (ghost, model) in ghosts.model.iter().enumerate() {
        scale[count + ghost] = scale[*model as usize];
    }
    let mut place = 0;
    for i in 0..count {
        for j in list.of(i) {
            weights[place] *= 0.5 * (scale[i] + scale[*j as usize]);
            place += 1;
        }
    }
    let pairs = PairList { starts: list.starts, partners: list.partners, weights };
    let Some((patch, radius)) = boundary.curved else { return (pairs, Contacts::default(), Vec::new()) };
    let layers = boundary.patches[patch].layers;
    let behind = |i: usize| behind(i).map(|(way, depth, pair)| (way, depth, scale[i] * pair)).collect();
    let (contacts, ways_out) = cut_by_curve(positions, ghosts, materials, &pairs, (radius, layers), &behind);
    (pairs, contacts, if flows { ways_out } else { Vec::new() })
}

/// What becomes of pairs that a curved wall of a radius (m) cuts; `behind` gives the way, depth and weight of those of a particle.
fn cut_by_curve(
    positions: &[DVec2],
    ghosts: &Ghosts,
    materials: &Materials,
    pairs: &PairList,
    (radius, layers): (f64, bool),
    behind: &dyn Fn(usize) -> Vec<(DVec2, f64, f64)>,
) -> (Contacts, Vec<WayOut>) {
    let count = positions.len();
    let (mut contacts, mut ways_out) = (Contacts::default(), Vec::new());
    for i in 0..count {
        let mut near = Neighbourhood::new(radius - positions[i].length());
        let mut sum = 0.0;
        for (way, depth, weight) in behind(i) {
            near.cut(weight, if layers { 0.0 } else { depth });
            sum += weight;
            ways_out.push(WayOut { particle: i as u32, weight, way });
        }
        if sum == 0.0 {
            continue;
        }
        for k in pairs.starts[i]..pairs.starts[i + 1] {
            // Beside a curved wall there are mirror planes alone, whose ghosts are their particles.
            let partner = pairs.partners[k] as usize;
            let particle = partner.checked_sub(count).map_or(partner as u32, |ghost| ghosts.model[ghost]);
            sum += pairs.weights[k];
            // A neighbour of another material pulls by the potential of the interface, not by its own.
            if materials.index(particle as usize) == materials.index(i) {
                near.pair(particle, pairs.weights[k], radius - positions[particle as usize].length());
            }
        }
        contacts.add(i as u32, &near, sum);
    }
    (contacts, ways_out)
}

/// Multiplies pairs by the shape factors that the papers print.
fn print_shapes(pairs: &mut PairList, symmetry: Symmetry, positions: &[DVec2], ghosts: &Ghosts) -> Result<(), Refused> {
    let radius =
        |j: usize| j.checked_sub(positions.len()).map_or_else(|| positions[j].x, |ghost| ghosts.position[ghost].x);
    for i in 0..positions.len() {
        for k in pairs.starts[i]..pairs.starts[i + 1] {
            let other = radius(pairs.partners[k] as usize);
            if other <= 0.0 {
                return Err(refuse(format!(
                    "the mirrored layers behind the wall \"inner\" reach across the axis, to r = {other:.6} m: in the \
                     paper setting pairs must reach less than the inner radius"
                )));
            }
            pairs.weights[k] *= symmetry.printed_factor(positions[i].x, other);
        }
    }
    Ok(())
}
