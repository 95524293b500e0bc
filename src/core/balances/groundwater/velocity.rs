//! Darcy velocities.

use glam::DVec2;

use crate::balances::groundwater::network::Network;
use crate::balances::groundwater::pressure::Pressure;

/// Darcy velocities (m/s) of all particles, from the water of their paths and openings.
pub fn velocities(network: &Network, pressure: &Pressure) -> Vec<DVec2> {
    // The second moment of weights is twice the unit matrix: half of the sum is the velocity.
    let values = &pressure.pressure;
    let mut found: Vec<DVec2> = (0..network.len())
        .map(|i| {
            let paths = network.paths(i).zip(&network.arms[network.starts[i]..network.starts[i + 1]]);
            // A path to an image behind an opening alone has no weight.
            let open = paths.filter(|((_, slot, _), _)| network.weights[*slot] > 0.0);
            open.map(|((j, slot, _), arm)| {
                pressure.conductances[slot] / network.weights[slot] * (values[i] - values[j]) * *arm
            })
            .sum()
        })
        .collect();
    for (opening, conductance) in network.openings.iter().zip(&pressure.mouths) {
        let (own, image) = (values[opening.particle as usize], values[opening.image as usize]);
        let water = conductance * (own - opening.sign * image - pressure.wall_parts(opening));
        found[opening.particle as usize] += 0.5 * water * opening.arm;
    }
    found
}
