//! Heat that water carries through surfaces.

use glam::DVec2;

use crate::balances::groundwater::carrier::{Carrier, Mouth};
use crate::balances::groundwater::ground::Flow;
use crate::balances::groundwater::network::Network;
use crate::memory::HeapSize;
use crate::space::domain::Surface;
use crate::space::wall::WallId;

/// What of the water's ways passes a surface.
pub struct Crossed {
    /// Paths across it: the end beyond it, the one before it, and the slot.
    paths: Vec<(u32, u32, u32)>,
    /// Mouths of particles that the surface parts from their wall, and the sign of what enters there.
    mouths: Vec<(u32, f64)>,
}

impl Crossed {
    /// The ways across a surface.
    pub fn new(surface: &Surface, network: &Network, carrier: &Carrier, flow: &Flow, positions: &[DVec2]) -> Self {
        let beyond = |i: usize| surface.is_beyond(positions[i]);
        let mut paths = Vec::new();
        for i in (0..network.len()).filter(|i| beyond(*i)) {
            let before = network.paths(i).filter(|(j, ..)| !beyond(*j));
            paths.extend(before.map(|(j, slot, _)| (i as u32, j as u32, slot as u32)));
        }
        let faced = WallId::ends(surface.across_y);
        let sign = |mouth: &Mouth| {
            let wall = flow.walls[mouth.wall as usize].wall;
            match (wall == faced[0], wall == faced[1], beyond(mouth.particle as usize)) {
                (true, _, true) => Some(1.0),
                (_, true, false) => Some(-1.0),
                _ => None,
            }
        };
        let mouths = carrier.mouths.iter().enumerate();
        Crossed { paths, mouths: mouths.filter_map(|(k, mouth)| Some((k as u32, sign(mouth)?))).collect() }
    }

    /// Heat (W by volume of a particle) towards greater coordinates: what paths bring to their ends beyond, by `of_path`,
    /// and what enters at mouths, by `of_mouth`.
    pub fn heat(&self, of_path: impl Fn(usize, usize, usize) -> f64, of_mouth: impl Fn(usize) -> f64) -> f64 {
        let paths = self.paths.iter().map(|(i, j, slot)| of_path(*i as usize, *j as usize, *slot as usize));
        paths.sum::<f64>() + self.mouths.iter().map(|(mouth, sign)| sign * of_mouth(*mouth as usize)).sum::<f64>()
    }
}

impl HeapSize for Crossed {
    fn heap_size(&self) -> usize {
        self.paths.heap_size() + self.mouths.capacity() * size_of::<(u32, f64)>()
    }
}
