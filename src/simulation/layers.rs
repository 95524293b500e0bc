//! Layers that a spacing does not resolve, and by how much.

use frazil_core::bonds::exchange::{Exchange, Mean};
use frazil_core::bonds::stencil::Stencil;
use frazil_core::physics::thermal::Thermal;
use frazil_core::space::lattice::Lattice;
use frazil_scene::region::Shape;
use frazil_scene::{Numerics, Scene};

/// Part of the heat through a layer at rest by which it may be off without a word.
const TOLD: f64 = 0.01;

/// Error of heat into ground behind a layer as thick as a spacing while it changes, where pairs know what lies between them.
/// It falls with the square of the particles across: `tests/interfaces.rs` finds at most 1.55 % at two.
const CHANGING: f64 = 0.07;

/// Part of that heat by which it may be off without a word.
const TOLD_CHANGING: f64 = 0.02;

/// Particles across above which a layer is resolved under every mean.
const MANY: f64 = 64.0;

/// What to say of the layers of a scene.
pub fn unresolved(
    scene: &Scene,
    numerics: &Numerics,
    lattice: &Lattice,
    stencil: &Stencil,
    thermals: &[Thermal],
) -> Vec<String> {
    let mut told = Vec::new();
    let moved = if scene.of_water { "water" } else { "heat" };
    for (number, region) in scene.regions.iter().enumerate() {
        let Some(material) = region.material else { continue };
        let (from, thickness) = across(&region.shape, lattice);
        let cells = thickness / lattice.spacing;
        let conductivity = |material: usize| thermals[material].curve.conductivity(scene.initial_temperature);
        let around = if material == 0 { scene.materials.len() - 1 } else { 0 };
        if !(cells > 0.0 && cells < MANY) || around == material {
            continue;
        }
        let layer = format!("region {number} is {cells:.1} spacings thick");
        match numerics.exchange {
            Exchange::Potential => {
                let error = CHANGING / (cells * cells);
                if error > TOLD_CHANGING {
                    told.push(format!(
                        "{layer}: {moved} through it is exact in the steady state, and within about {:.0} % in transients; \
                         with two spacings within 2 %",
                        100.0 * error
                    ));
                }
            }
            // Which end is upstream changes with the flow.
            Exchange::Upstream => {}
            Exchange::Mean(mean) => {
                let ground = (conductivity(around), conductivity(material));
                let error = heat_through(&stencil.collapsed(false), lattice.spacing, ground, (from, cells), mean);
                if error.abs() > TOLD {
                    told.push(format!(
                        "{layer}: with a mean of conductivities the steady heat flux through it is off by {:+.1} %",
                        100.0 * error
                    ));
                }
            }
        }
    }
    told
}

/// Where a shape begins between particles in the direction in which it is thinnest, and how thick it is there (m). Only
/// boxes know where.
fn across(shape: &Shape, lattice: &Lattice) -> (f64, f64) {
    let extent = shape.extent();
    let low = lattice.corner;
    let high = lattice.far();
    match shape {
        Shape::Box(_) => {
            let (from, to) = (extent.low.max(low), extent.high.min(high));
            let sizes =
                if lattice.dimension == 1 { (to.x - from.x, f64::INFINITY) } else { (to.x - from.x, to.y - from.y) };
            let (start, size) = if sizes.0 <= sizes.1 { (from.x - low.x, sizes.0) } else { (from.y - low.y, sizes.1) };
            ((start / lattice.spacing).fract(), size)
        }
        Shape::Circle { radius, .. } => (0.0, 2.0 * radius),
        Shape::Ellipse(ellipse) => (0.0, 2.0 * ellipse.half_axes.min_element()),
        Shape::Polygon(corners) => {
            let edges = (0..corners.len()).map(|k| corners[(k + 1) % corners.len()] - corners[k]);
            let width = |edge: glam::DVec2| {
                let normal = edge.perp().normalize();
                let depths = corners.iter().map(|corner| corner.dot(normal));
                let ends = depths.fold((f64::INFINITY, f64::NEG_INFINITY), |ends, d| (ends.0.min(d), ends.1.max(d)));
                ends.1 - ends.0
            };
            (0.0, edges.map(width).fold(f64::INFINITY, f64::min))
        }
    }
}

/// Error of the conductance of a layer at rest under a mean of conductivities, by the weights of columns (m^-2): a line of
/// particles between two walls far away, solved as it is. The layer begins at a place between particles and is so many
/// spacings thick; `ground` conducts around it and in it (W/mK).
fn heat_through(weights: &[f64], spacing: f64, ground: (f64, f64), (from, cells): (f64, f64), mean: Mean) -> f64 {
    let reach = weights.len();
    let pad = 2 * reach;
    let count = 2 * pad + (from + cells).ceil() as usize;
    let ends = (pad as f64 + from, pad as f64 + from + cells);
    let slack = 1e-9 * count as f64;
    let conductivity = |k: usize| {
        let place = k as f64 + 0.5;
        if place >= ends.0 - slack && place < ends.1 - slack { ground.1 } else { ground.0 }
    };
    let pair = |a: f64, b: f64| match mean {
        Mean::Harmonic => 2.0 * a * b / (a + b),
        Mean::Arithmetic => 0.5 * (a + b),
        Mean::Geometric => (a * b).sqrt(),
    };
    // Rows of the balance, with walls at 1 and 0 seen by odd mirrors; the last column is what walls give.
    let mut rows = vec![vec![0.0; count + 1]; count];
    for (i, row) in rows.iter_mut().enumerate() {
        for (k, weight) in weights.iter().enumerate() {
            for offset in [-(k as i64) - 1, k as i64 + 1] {
                let j = i as i64 + offset;
                let (partner, wall, sign) = if j < 0 {
                    ((-1 - j) as usize, 1.0, -1.0)
                } else if j >= count as i64 {
                    (2 * count - 1 - j as usize, 0.0, -1.0)
                } else {
                    (j as usize, 0.0, 1.0)
                };
                let strength = weight * spacing * spacing * pair(conductivity(i), conductivity(partner));
                row[i] += strength;
                row[partner] -= sign * strength;
                row[count] += if sign < 0.0 { 2.0 * wall * strength } else { 0.0 };
            }
        }
    }
    let Some(temperature) = solved(rows) else { return f64::NAN };
    let mut heat = 0.0;
    for (i, own) in temperature.iter().enumerate().take(reach) {
        for (k, weight) in weights.iter().enumerate().skip(i) {
            let image = k - i;
            let strength = weight * spacing * spacing * pair(conductivity(i), conductivity(image));
            heat += strength * (2.0 - temperature[image] - own);
        }
    }
    // What is left of the resistance beside the ground around is the layer's.
    cells / ground.1 / (1.0 / heat - (count as f64 - cells) / ground.0) - 1.0
}

/// The solution of a small system whose rows end with their right sides, by elimination without pivots: rows are those of an
/// exchange, whose diagonal dominates.
fn solved(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let count = rows.len();
    for k in 0..count {
        let (above, below) = rows.split_at_mut(k + 1);
        let pivot = above.last()?;
        for row in below.iter_mut().filter(|row| row[k] != 0.0) {
            let factor = row[k] / pivot[k];
            for (value, own) in row[k..].iter_mut().zip(&pivot[k..]) {
                *value -= factor * own;
            }
        }
    }
    let mut found = vec![0.0; count];
    for k in (0..count).rev() {
        let known: f64 = (k + 1..count).map(|j| rows[k][j] * found[j]).sum();
        found[k] = (rows[k][count] - known) / rows[k][k];
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nearest neighbours in closed form: of a layer of 4 particles both outer pairs conduct by the mean, 3 by its own
    /// conductivity; half a pair on each side belongs to the ground around. `tests/interfaces.rs` holds long pairs against runs.
    #[test]
    fn nearest_neighbours_are_off_as_resistances_in_series_say() {
        let layer = |mean: f64| 40.0 / (3.0 / 0.1 + 2.0 / mean - 1.0) - 1.0;
        for (mean, own) in [(Mean::Harmonic, 2.0 / 11.0), (Mean::Arithmetic, 0.55), (Mean::Geometric, 0.1f64.sqrt())] {
            let found = heat_through(&[1.0], 1.0, (1.0, 0.1), (0.0, 4.0), mean);
            assert!((found - layer(own)).abs() < 1e-10, "{mean:?}: {found}");
        }
        let long = [1.0, 4.0, 9.0].map(|square| 1.0 / (3.0 * square));
        assert!(heat_through(&long, 1.0, (2.0, 2.0), (0.3, 4.2), Mean::Geometric).abs() < 1e-10);
    }
}
