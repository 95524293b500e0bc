//! What parts that nothing enters leave of the volumes of particles.

use frazil_core::neighbours::tree::Tree;
use frazil_core::neighbours::{NeighbourSearch, Period};
use frazil_core::space::lattice::Lattice;
use frazil_core::space::volumes::Volumes;
use frazil_scene::Scene;
use frazil_scene::region::Cell;
use glam::DVec2;

/// Spacings within which a particle takes over what is open of cells whose own particle is closed in.
const NEAR: f64 = 2.0;

/// Part of a distance by which nearest particles may be farther than each other, by rounding.
const ROUNDING: f64 = 1e-9;

/// Least share of a cell that a particle in the open has.
const LEAST: f64 = 1e-3;

/// Volumes of particles in a plane with closed parts: of each cell what is open. A particle that stands in a closed part has none, and
/// what is open of its cell belongs to the nearest ones in the open.
pub(super) fn open_volumes(scene: &Scene, lattice: &Lattice, cloud: Option<&[DVec2]>) -> Volumes {
    let stood: Vec<DVec2>;
    let places = match cloud {
        Some(positions) => positions,
        None => {
            stood = lattice.positions();
            &stood
        }
    };
    let open = |place: &DVec2| {
        let cell = Cell::around(*place, lattice.spacing);
        scene.impermeable.iter().map(|shape| 1.0 - shape.share_of(&cell)).product::<f64>()
    };
    let mut shares: Vec<f64> = places.iter().map(open).collect();
    let closed: Vec<bool> = places.iter().map(|place| scene.is_impermeable_at(*place)).collect();
    let cut: Vec<usize> = (0..places.len()).filter(|i| closed[*i] && shares[*i] > 0.0).collect();
    let givers: Vec<DVec2> = cut.iter().map(|i| places[*i]).collect();
    let beside = |place: &DVec2| givers.iter().any(|giver| (*giver - *place).length() <= NEAR * lattice.spacing);
    let takers: Vec<usize> = (0..places.len()).filter(|i| !closed[*i] && beside(&places[*i])).collect();
    let points: Vec<DVec2> = givers.iter().copied().chain(takers.iter().map(|i| places[*i])).collect();
    let list = Tree.neighbours(&points, cut.len(), NEAR * lattice.spacing, Period::NONE);
    for (row, giver) in cut.iter().enumerate() {
        let near = list.of(row).iter().filter_map(|j| (*j as usize).checked_sub(cut.len())).map(|k| takers[k]);
        let distance = |taker: &usize| (places[*taker] - places[*giver]).length();
        let least = near.clone().map(|taker| distance(&taker)).fold(f64::INFINITY, f64::min);
        let nearest: Vec<usize> = near.filter(|taker| distance(taker) <= least * (1.0 + ROUNDING)).collect();
        for taker in &nearest {
            shares[*taker] += shares[*giver] / nearest.len() as f64;
        }
    }
    for (share, closed) in shares.iter_mut().zip(closed) {
        *share = if closed { 0.0 } else { share.max(LEAST) };
    }
    Volumes::by_share(lattice.volume(), shares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use frazil_core::space::domain::Domain;
    use frazil_scene::Shape;

    #[test]
    fn volumes_are_what_closed_parts_leave() {
        let domain = Domain::Rectangle { width: 1.0, height: 1.0 };
        let mut scene = Scene::bare(domain, 1.0, Vec::new());
        scene.impermeable = vec![
            Shape::Circle { centre: DVec2::new(0.31, 0.37), radius: 0.173 },
            Shape::Polygon([(0.61, 0.52), (0.93, 0.6), (0.71, 0.87)].map(DVec2::from).to_vec()),
        ];
        let (lattice, triangle) = (Lattice::new(&domain, 0.02), 0.052);
        let volumes = open_volumes(&scene, &lattice, None);
        let all: f64 = (0..lattice.len()).map(|i| volumes.of(i)).sum();
        assert!((all - (1.0 - std::f64::consts::PI * 0.173_f64.powi(2) - triangle)).abs() < 1e-12, "{all}");
        for i in 0..lattice.len() {
            assert_eq!(volumes.of(i) == 0.0, scene.is_impermeable_at(lattice.position(i)));
        }
    }
}
