//! How flowing water spreads a solute, as a factor for each pair.
//!
//! Dispersion is a tensor: `D_L = D + alpha_L |q|` along the Darcy velocity q, `D_T = D + alpha_T |q|` across it. Pairs know it
//! by their direction n alone, as `a + b (n.q/|q|)^2` such that the second moment of weights times factors is twice the tensor:
//! for weights without a preferred direction that is `D_L` on a line, and in the plane `a = (3 D_T - D_L) / 2`,
//! `b = 2 (D_L - D_T)`. Weights on a lattice do prefer some, so a and b follow from the moments of their own pairs.
//!
//! Beyond `D_L = 3 D_T` that a is negative, and with it the factors of pairs across the flow. There the power of the cosine is
//! doubled until a is not, so both spreadings stay right and no factor is negative. Pairs of a lattice have few directions: where
//! even the highest power leaves too much across the flow, or none of the pairs lies along it, a is zero, b is what makes the
//! spreading along the flow right, and that across it is whatever the pairs then make of it.

use glam::DVec2;

use crate::balances::solute::image::Image;
use crate::kernels::list_parts::ListParts;
use crate::physics::solute_material::SoluteMaterial;

/// Powers of the squared cosine between a pair and the flow that are tried in turn.
const POWERS: [i32; 6] = [1, 2, 4, 8, 16, 32];

/// How a solute spreads from a particle (m2/s), by direction n: `across + more (n.along)^(2 power)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    along: DVec2,
    across: f64,
    more: f64,
    power: i32,
}

impl Spread {
    /// The same in all directions.
    fn even(value: f64) -> Self {
        Spread { along: DVec2::X, across: value, more: 0.0, power: 1 }
    }

    /// Of a particle with this molecular diffusion (m2/s) and Darcy velocity (m/s), whose pairs have these directions and shares
    /// in the second moment.
    fn new(
        material: &SoluteMaterial,
        molecular: f64,
        velocity: DVec2,
        on_a_line: bool,
        pairs: impl Iterator<Item = (DVec2, f64)> + Clone,
    ) -> Self {
        let speed = velocity.length();
        let wanted = [material.longitudinal_dispersivity, material.transverse_dispersivity];
        let wanted = wanted.map(|length| molecular + length * speed);
        if on_a_line || wanted[0] == wanted[1] {
            return Spread::even(wanted[0]);
        }
        let along = velocity / speed;
        let mut last = Spread::even(wanted[0]);
        for power in POWERS {
            // Moments along and across the flow of factors one, and of this power.
            let mut moments = [0.0; 4];
            for (direction, share) in pairs.clone() {
                let square = along.dot(direction).powi(2);
                let shaped = square.powi(power);
                let terms = [square, 1.0 - square, square * shaped, (1.0 - square) * shaped];
                moments.iter_mut().zip(terms).for_each(|(moment, term)| *moment += share * term);
            }
            // Half of the second moment is the unit matrix, whose trace in the plane is two.
            let all = moments[0] + moments[1];
            let [even, even_across, shaped, shaped_across] = moments.map(|moment| 2.0 * moment / all);
            let determinant = even * shaped_across - shaped * even_across;
            let across = (wanted[0] * shaped_across - wanted[1] * shaped) / determinant;
            let more = (even * wanted[1] - even_across * wanted[0]) / determinant;
            if across >= 0.0 && across + more >= 0.0 {
                return Spread { along, across, more, power };
            }
            if wanted[0] < wanted[1] {
                break;
            }
            if shaped > 0.0 {
                last = Spread { along, across: 0.0, more: wanted[0] / shaped, power };
            }
        }
        last
    }

    /// In a direction of unit length.
    fn towards(&self, direction: DVec2) -> f64 {
        self.across + self.more * self.along.dot(direction).powi(2).powi(self.power)
    }
}

/// From a particle to a partner (m).
pub(super) fn arm(list: &ListParts, particle: usize, partner: usize) -> DVec2 {
    let place = match partner.checked_sub(list.positions.len()) {
        None => list.positions[partner],
        Some(ghost) => list.ghosts.position[ghost],
    };
    place - list.positions[particle]
}

/// Darcy velocities (m/s) of all particles, from the water that enters along each entry of the list (1/s by volume). The
/// second moment of weights is twice the unit matrix: half of the sum is the velocity.
pub(super) fn velocities(list: &ListParts, flows: &[f64], found: &mut Vec<DVec2>) {
    found.resize(list.positions.len(), DVec2::ZERO);
    let pairs = &list.pairs;
    list.in_tasks(found, |first, found| {
        for (i, velocity) in (first..).zip(found) {
            let row = pairs.starts[i]..pairs.starts[i + 1];
            let out = row.map(|k| -0.5 * flows[k] * arm(list, i, pairs.partners[k] as usize));
            *velocity = out.sum();
        }
    });
}

/// How solute spreads from all particles, by their molecular diffusion (m2/s) and Darcy velocities (m/s).
pub(super) fn spreads(
    list: &ListParts,
    materials: &[SoluteMaterial],
    molecular: &[f64],
    velocities: &[DVec2],
    found: &mut Vec<Spread>,
) {
    found.resize(list.positions.len(), Spread::even(0.0));
    let on_a_line = list.positions.iter().all(|place| place.y == list.positions[0].y)
        && list.ghosts.position.iter().all(|place| place.y == list.positions[0].y);
    let pairs = &list.pairs;
    list.in_tasks(found, |first, found| {
        for (i, spread) in (first..).zip(found) {
            let directions = (pairs.starts[i]..pairs.starts[i + 1]).map(|k| {
                let arm = arm(list, i, pairs.partners[k] as usize);
                (arm.normalize_or_zero(), pairs.weights[k] * arm.length_squared())
            });
            let material = &materials[list.materials.index(i)];
            *spread = Spread::new(material, molecular[i], velocities[i], on_a_line, directions);
        }
    });
}

/// Spreading (m2/s) along a pair, from both ends.
pub(super) fn between(spreads: &[Spread], list: &ListParts, i: usize, j: usize, images: &[Image]) -> (f64, f64) {
    let direction = arm(list, i, j).normalize_or_zero();
    let (other, seen) = match j.checked_sub(list.positions.len()) {
        None => (j, direction),
        Some(ghost) => (images[ghost].original as usize, images[ghost].mirror(direction)),
    };
    (spreads[i].towards(direction), spreads[other].towards(seen))
}
