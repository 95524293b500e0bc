//! Darcy velocities.

use glam::DVec2;

use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::pressure::Pressure;

/// Darcy velocities (m/s) of all particles, from the water of their paths and openings.
pub fn velocities(network: &Network, pressure: &Pressure) -> Vec<DVec2> {
    let values = &pressure.pressure;
    let mut found = vec![DVec2::ZERO; network.len()];
    let mut places = network.diagonals.as_ref().map_or(Vec::new(), |diagonals| vec![0.0; diagonals.padded()]);
    network.slopes(None, (&pressure.conductances, values), &mut places, &mut found);
    found.iter_mut().for_each(|slope| *slope = -*slope);
    for (opening, conductance) in network.openings.iter().zip(&pressure.mouths) {
        let (own, image) = (values[opening.particle as usize], values[opening.image as usize]);
        let water = conductance * (own - opening.sign * image - pressure.wall_parts(opening));
        found[opening.particle as usize] += 0.5 * water * opening.arm;
    }
    found
}
