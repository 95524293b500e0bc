//! Corners of two walls with temperatures of their own: where odd images would outweigh a neighbour.
//!
//! At one wall a particle is nearer to its neighbour than to the neighbour's odd image, so the neighbour wins and the
//! maximum principle holds. Where a particle sees two images of one neighbour at once, and the double image that would
//! make up for them lies beyond the reach, the images can win. There the pair itself is strengthened until they just
//! do not: a handful of symmetric pairs at a corner, so heat is conserved, and smooth fields feel it as little as the
//! corner's own share of the body.

use std::collections::BTreeMap;

use crate::bonds::pair_list::PairList;
use crate::bonds::stencil::Stencil;
use crate::boundary::ghosts::Ghosts;
use crate::boundary::patch::Face;
use crate::space::lattice::Lattice;

/// A strengthened pair of particles on a lattice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerPair {
    /// Particle with the lower index.
    pub first: u32,
    /// The other.
    pub second: u32,
    /// Weight by volume to be added (m^-2).
    pub weight: f64,
}

/// The pairs of a lattice that need it. `stiffness` is that of the faces left, right, bottom, top; none for a side
/// that does not mirror.
pub fn lattice_pairs(lattice: &Lattice, stencil: &Stencil, stiffness: [Option<f64>; 4]) -> Vec<CornerPair> {
    let (columns, rows, reach) = (lattice.columns as i64, lattice.rows as i64, stencil.reach as i64);
    let stiff = |side: usize| stiffness[side].is_some_and(|stiffness| stiffness > 0.0);
    if (0..4).filter(|side| stiff(*side)).count() < 2 {
        return Vec::new();
    }
    // Cells that a stiff wall is within reach of, by direction.
    let near = |low: usize, high: usize, cell: i64, count: i64| {
        usize::from(stiff(low) && cell < reach) + usize::from(stiff(high) && count - 1 - cell < reach)
    };
    // Signed distances of a neighbour and its images along one direction.
    let images = |low: usize, high: usize, a: i64, b: i64, count: i64| {
        let image = |side: usize, distance: i64| stiffness[side].map(|stiffness| (-stiffness, distance));
        [Some((1.0, (a - b).abs())), image(low, a + b + 1), image(high, 2 * count - 1 - a - b)]
    };
    let mut pairs = Vec::new();
    for row in 0..rows {
        let across = if lattice.dimension == 1 { 0 } else { near(2, 3, row, rows) };
        for column in 0..columns {
            if near(0, 1, column, columns) + across < 2 {
                continue;
            }
            for (other_column, other_row) in neighbourhood(column, row, reach, columns, rows) {
                if (other_row, other_column) <= (row, column) {
                    continue;
                }
                let along = images(0, 1, column, other_column, columns);
                let up = if lattice.dimension == 1 {
                    [Some((1.0, 0)), None, None]
                } else {
                    images(2, 3, row, other_row, rows)
                };
                let net: f64 = along
                    .iter()
                    .flatten()
                    .flat_map(|x| up.iter().flatten().map(move |y| x.0 * y.0 * stencil.at(x.1 as usize, y.1 as usize)))
                    .sum();
                let ends = lattice.index(column, row).zip(lattice.index(other_column, other_row));
                if let (true, Some((first, second))) = (net < 0.0, ends) {
                    pairs.push(CornerPair { first: first as u32, second: second as u32, weight: -net });
                }
            }
        }
    }
    pairs
}

/// Cells within reach of a cell.
fn neighbourhood(column: i64, row: i64, reach: i64, columns: i64, rows: i64) -> impl Iterator<Item = (i64, i64)> {
    let down = (row - reach).max(0)..(row + reach + 1).min(rows);
    down.flat_map(move |y| ((column - reach).max(0)..(column + reach + 1).min(columns)).map(move |x| (x, y)))
}

/// Strengthens the pairs of a list that need it, judged by the ghosts that mirror particles.
pub fn strengthen(pairs: &mut PairList, ghosts: &Ghosts, count: usize, faces: &[Face]) {
    let mirrored = ghosts.mirrored(count, faces);
    if !mirrored.iter().any(|image| image.is_some_and(|image| image.1 < 0.0)) {
        return;
    }
    let mut missing: BTreeMap<(u32, u32), f64> = BTreeMap::new();
    for i in 0..count {
        let range = pairs.starts[i]..pairs.starts[i + 1];
        let patches = range.clone().filter(|k| pairs.partners[*k] as usize >= count).count();
        if patches < 2 {
            continue;
        }
        let mut net: BTreeMap<u32, f64> = BTreeMap::new();
        for k in range {
            let (partner, weight) = (pairs.partners[k], pairs.weights[k]);
            match (partner as usize).checked_sub(count) {
                None => *net.entry(partner).or_default() += weight,
                Some(ghost) => {
                    if let Some((particle, sign)) = mirrored[ghost] {
                        *net.entry(particle).or_default() += sign * weight;
                    }
                }
            }
        }
        for (j, net) in net {
            if net < 0.0 && j as usize != i {
                let pair = (j.min(i as u32), j.max(i as u32));
                let entry = missing.entry(pair).or_default();
                *entry = entry.max(-net);
            }
        }
    }
    for ((first, second), weight) in missing {
        for (own, partner) in [(first, second), (second, first)] {
            let range = pairs.starts[own as usize]..pairs.starts[own as usize + 1];
            if let Some(k) = range.into_iter().find(|k| pairs.partners[*k] == partner) {
                pairs.weights[k] += weight;
            }
        }
    }
}
