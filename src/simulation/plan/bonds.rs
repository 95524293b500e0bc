//! Bonds of particles on a list, and walls around them.

use std::sync::Arc;

use frazil_core::balances::groundwater::network::WayOut;
use frazil_core::bonds::exchange::Exchange;
use frazil_core::bonds::pair_list::PairList;
use frazil_core::bonds::stencil::SHELL_TOLERANCE;
use frazil_core::bonds::weight::Normalisation;
use frazil_core::boundary::curved_wall::{Contacts, Neighbourhood, Rim, cells_behind};
use frazil_core::boundary::ghosts::Ghosts;
use frazil_core::boundary::ghosts::passing::Passing;
use frazil_core::boundary::interface::Chains;
use frazil_core::boundary::shells::{Bonds, naive_shells, shells};
use frazil_core::boundary::wall_ends::mirrored_end;
use frazil_core::boundary::wall_layers::{Body, WallModel, inner, level};
use frazil_core::breakage::crack::Barriers;
use frazil_core::breakage::cuts::Cuts;
use frazil_core::breakage::excavation;
use frazil_core::kernels::corner::strengthen;
use frazil_core::kernels::irregular::IrregularRows;
use frazil_core::kernels::list_parts::ListParts;
use frazil_core::neighbours::all_pairs::AllPairs;
use frazil_core::neighbours::cells::Cells;
use frazil_core::neighbours::tree::Tree;
use frazil_core::neighbours::{NeighbourSearch, Period};
use frazil_core::physics::latent_heat::Materials;
use frazil_core::space::domain::Surface;
use frazil_core::space::symmetry::Symmetry;
use frazil_core::space::volumes::Volumes;
use frazil_core::team::Team;
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;
use frazil_scene::settings::{Front, SearchChoice};
use glam::DVec2;

use crate::interface;
use crate::plan::irregular::Selection;
use crate::plan::prepared::Prepared;
use crate::refused::Refused;

/// The particles of a list, of which the first have rows.
struct Members {
    positions: Arc<[DVec2]>,
    materials: Materials,
    volumes: Volumes,
    rows: usize,
    /// Whether weights are those of the stencil: of rows beside a sweep, and where ground conducts by direction.
    by_stencil: bool,
}

/// The parts of a list of all particles, with their pipes, and the bonds through which water leaves at a curved wall.
pub(super) fn list(
    scene: &Scene,
    settings: &MethodSettings,
    prepared: &mut Prepared,
    team: Option<Team>,
) -> Result<(ListParts, Vec<WayOut>), Refused> {
    let (positions, materials, volumes) = (prepared.positions(), prepared.materials.clone(), prepared.volumes.clone());
    let by_stencil = prepared.stencil.along() != DVec2::ONE;
    let members = Members { rows: positions.len(), positions, materials, volumes, by_stencil };
    let (parts, ways_out) = parts(scene, settings, prepared, &members, team)?;
    let (sinks, rings) = (std::mem::take(&mut prepared.sinks), scene.rings.len());
    Ok((ListParts { sinks, rings, bound: settings.bound.clone(), ..parts }, ways_out))
}

/// Rows of some particles of a lattice beside the sweep over all; `surfaces` are those through which heat is counted.
pub(super) fn rows(
    scene: &Scene,
    settings: &MethodSettings,
    prepared: &Prepared,
    selection: Selection,
    surfaces: &[Surface],
    team: Option<Team>,
) -> Result<Box<IrregularRows>, Refused> {
    let Selection { particles, rows, .. } = selection;
    let positions = particles.iter().map(|particle| prepared.lattice.position(*particle as usize)).collect();
    let materials = prepared.materials.of_some(&particles);
    let volumes = prepared.volumes.of_some(&particles);
    let members = Members { positions, materials, volumes, rows, by_stencil: true };
    let (parts, _) = parts(scene, settings, prepared, &members, team)?;
    Ok(Box::new(IrregularRows::new(particles, rows, ListParts { surfaces: surfaces.to_vec(), ..parts })))
}

/// The parts of a list without pipes.
fn parts(
    scene: &Scene,
    settings: &MethodSettings,
    prepared: &Prepared,
    members: &Members,
    team: Option<Team>,
) -> Result<(ListParts, Vec<WayOut>), Refused> {
    let numerics = &settings.numerics;
    let (bonds, cut) = bonds(scene, settings, prepared, members)?;
    let Bonds { mut pairs, mut ghosts, touches } = bonds;
    let (boundary, lattice) = (&prepared.boundary, &prepared.lattice);
    let Members { positions, materials, volumes, .. } = members;
    let (contacts, ways_out) = cut;
    let outer = boundary.curved.map(|(patch, _)| Rim { patch, from: 0.0, contacts });
    let mut rims: Vec<Rim> = outer.into_iter().collect();
    let mut cuts = Cuts::default();
    if scene.has_barriers() {
        let blocked = |from, to| scene.is_blocked(from, to);
        let barriers = Barriers::new(&scene.cracks, &blocked, lattice, boundary);
        cuts = Cuts::new(&mut pairs, volumes, positions, &ghosts, &barriers);
    }
    if let Some(dug) = &boundary.dug {
        let ground = (materials, prepared.stencil.along(), numerics.front == Front::SubCell);
        rims.push(excavation::face(&pairs, positions, &ghosts, ground, dug, &mut cuts));
    }
    let chains = if numerics.exchange == Exchange::Potential {
        let seen =
            interface::Seen { positions, materials, pairs: &pairs, boundary, rims: &rims, touches: &touches, lattice };
        interface::chains(scene, numerics, &seen, &mut ghosts)
    } else {
        Chains::default()
    };
    let parts = ListParts {
        chains,
        positions: positions.clone(),
        volumes: volumes.clone(),
        spacing: lattice.spacing,
        materials: materials.clone(),
        factors: prepared.factors.clone(),
        pairs,
        cuts,
        ghosts,
        boundary: boundary.clone(),
        rims,
        touches,
        surfaces: scene.watch.surfaces.clone(),
        sinks: Vec::new(),
        rings: 0,
        up: scene.gravity.map(|towards| -towards.outwards()),
        exchange: numerics.exchange,
        team,
        bound: None,
    };
    Ok((parts, ways_out))
}

/// Bonds, walls as layers of particles among them, and what became of those that a curved wall cuts.
fn bonds(
    scene: &Scene,
    settings: &MethodSettings,
    prepared: &Prepared,
    members: &Members,
) -> Result<(Bonds, (Contacts, Vec<WayOut>)), Refused> {
    let Prepared { lattice, boundary, stencil, printed, .. } = prepared;
    let Members { positions, materials, volumes, .. } = members;
    let walls = settings.numerics.walls;
    let (shelled, naive) = (scene.domain.symmetry().is_some() && !printed, walls == WallModel::Naive);
    let (mut bonds, cut) = if shelled {
        let made = if naive { naive_shells } else { shells };
        (made(&scene.domain, lattice, stencil, boundary)?, (Contacts::default(), Vec::new()))
    } else {
        let reach = settings.reach();
        let mut ghosts = Ghosts::new(positions, lattice, boundary, reach, walls == WallModel::MovingLeastSquares);
        let (mut pairs, mut contacts, ways_out) = pairs(members, &ghosts, prepared, settings);
        ghosts.conduct(stencil.along());
        contacts.conduct(stencil.along(), |particle| positions[particle]);
        match scene.domain.symmetry() {
            Some(symmetry) => print_shapes(&mut pairs, symmetry, positions, &ghosts)?,
            None => {
                let first = &materials.thermals[0];
                let faces = boundary.first_faces(&first.curve, first.zero_potential);
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
        bonds.touches = inner(&mut bonds.pairs, &mut bonds.ghosts, &body, stencil.reach)?;
    }
    Ok((bonds, cut))
}

/// Pairs with their weights: every partner within reach of every particle, ghosts included; and what became of those
/// that a curved wall cuts, for heat and, where it flows, for water.
fn pairs(
    members: &Members,
    ghosts: &Ghosts,
    prepared: &Prepared,
    settings: &MethodSettings,
) -> (PairList, Contacts, Vec<WayOut>) {
    let Prepared { lattice, boundary, stencil, .. } = prepared;
    let Members { positions, rows, by_stencil, .. } = members;
    let MethodSettings { numerics, discretisation, .. } = settings;
    let (weight, flows) = (discretisation.weight.as_ref(), numerics.flow.is_some());
    // On a lattice a radius that falls on a shell must not depend on rounding.
    let limit = settings.reach() * (1.0 + SHELL_TOLERANCE);
    let mut points = positions.to_vec();
    points.extend_from_slice(&ghosts.position);
    let (count, rows) = (positions.len(), *rows);
    let list = match numerics.search {
        SearchChoice::Auto | SearchChoice::Lattice | SearchChoice::Tree => {
            Tree.neighbours(&points, rows, limit, Period::NONE)
        }
        SearchChoice::Cells => Cells.neighbours(&points, rows, limit, Period::NONE),
        SearchChoice::AllPairs => AllPairs.neighbours(&points, rows, limit, Period::NONE),
    };
    // Coincident points exchange nothing: their distance gives no direction.
    let distance = |i: usize, j: u32| (points[j as usize] - points[i]).length();
    let volume = lattice.volume();
    let at = |way: DVec2| {
        let cells = (way / lattice.spacing).round().abs();
        stencil.at(cells.x as usize, cells.y as usize)
    };
    let behind = |i: usize| {
        let curved = boundary.curved.into_iter();
        let cells = curved.flat_map(move |(_, radius)| cells_behind(positions[i], lattice, radius, limit));
        cells.map(|(way, depth)| (way, depth, if *by_stencil { at(way) } else { volume * weight.weight(way.length()) }))
    };
    let mut weights: Vec<f64> = Vec::with_capacity(list.partners.len());
    let mut scale = vec![1.0; points.len()];
    let mirrors = numerics.walls == WallModel::Mirror;
    let cover = |beyond: f64| if mirrors { mirrored_end(stencil, lattice.spacing, beyond) } else { beyond };
    let passing = Passing::new(ghosts, count, lattice, boundary, cover);
    for i in 0..rows {
        let mut moment: f64 = behind(i).map(|(way, _, pair)| pair * way.length_squared()).sum();
        for j in list.of(i) {
            let distance = distance(i, *j);
            let share = (*j as usize).checked_sub(count).map_or(1.0, |ghost| passing.share(points[i], ghost));
            let pair = if *by_stencil {
                share * at(points[*j as usize] - points[i])
            } else if distance > 0.0 {
                volume * share * weight.weight(distance)
            } else {
                0.0
            };
            moment += pair * distance * distance;
            weights.push(pair);
        }
        if discretisation.normalisation == Normalisation::DiscreteMoment && !by_stencil {
            scale[i] = if moment > 0.0 { (2 * lattice.dimension) as f64 / moment } else { 0.0 };
        }
    }
    for (ghost, model) in ghosts.model.iter().enumerate() {
        scale[count + ghost] = scale[*model as usize];
    }
    let mut place = 0;
    for i in 0..rows {
        for j in list.of(i) {
            weights[place] *= 0.5 * (scale[i] + scale[*j as usize]);
            place += 1;
        }
    }
    let mut starts = list.starts;
    starts.resize(count + 1, list.partners.len());
    let pairs = PairList { starts, partners: list.partners, weights };
    let Some((patch, radius)) = boundary.curved else { return (pairs, Contacts::default(), Vec::new()) };
    let layers = boundary.patches[patch].layers;
    let behind = |i: usize| behind(i).map(|(way, depth, pair)| (way, depth, scale[i] * pair)).collect();
    let (contacts, ways_out) =
        cut_by_curve(members, ghosts, &pairs, (radius, layers), numerics.front == Front::SubCell, &behind);
    (pairs, contacts, if flows { ways_out } else { Vec::new() })
}

/// What becomes of pairs that a curved wall of a radius (m) cuts, where fronts inside particles may be followed; `behind` gives the way, depth and weight of those of a particle.
fn cut_by_curve(
    Members { positions, materials, rows, .. }: &Members,
    ghosts: &Ghosts,
    pairs: &PairList,
    (radius, layers): (f64, bool),
    followed: bool,
    behind: &dyn Fn(usize) -> Vec<(DVec2, f64, f64)>,
) -> (Contacts, Vec<WayOut>) {
    let count = positions.len();
    let (mut contacts, mut ways_out) = (Contacts::default(), Vec::new());
    for i in 0..*rows {
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
        contacts.add(i as u32, &near, sum, (materials, followed));
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
                return Err(Refused::AcrossTheAxis(other));
            }
            pairs.weights[k] *= symmetry.printed_factor(positions[i].x, other);
        }
    }
    Ok(())
}
