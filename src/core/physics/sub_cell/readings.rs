//! What fronts tell of the cells that they cross.

use crate::side_by_side::MinMax;
use crate::space::lattice::Lattice;

/// Neighbours along both axes, on either side.
const AXES: [[(i64, i64); 2]; 2] = [[(-1, 0), (1, 0)], [(0, -1), (0, 1)]];

/// Temperature at the centre of a freezing particle, less that of freezing: on the line from the front in its cell to the
/// neighbours in the phase in which the centre is. `temperature` tells that of a particle, less that of freezing.
pub fn at_the_centre(lattice: &Lattice, index: usize, fraction: f64, temperature: impl Fn(usize) -> f64) -> f64 {
    let (column, row) = lattice.cell(index);
    let frozen_side = fraction > 0.5;
    let depth = (fraction - 0.5).abs();
    let (mut sum, mut count) = (0.0, 0.0);
    for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().take(2 * lattice.dimension) {
        if let Some(other) = lattice.index(column + dx, row + dy) {
            let above = temperature(other);
            if above != 0.0 && (above < 0.0) == frozen_side {
                sum += above * depth / (depth + 1.0);
                count += 1.0;
            }
        }
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Frozen fraction of a cell by where the front in it lies: the heat that the cell lacks is not all latent. What is frozen of
/// it is colder than the front, and what is not is warmer, by the slope from the front to the neighbour on that side. So a
/// cell that has given off its latent heat is not yet frozen through, and two fronts meet later than the heat of their cells
/// says, by a part of a spacing that grows with the spacing.
///
/// `lacked` tells the heat that a particle lacks against the unfrozen state at the freezing point, in units of the latent
/// heat: more than one of a frozen particle, less than none of an unfrozen one. Where there is no particle, the body goes on as it is.
pub fn front_fraction(lattice: &Lattice, (column, row): (i64, i64), lacked: impl Fn(usize) -> f64) -> f64 {
    let Some(index) = lattice.index(column, row) else { return 0.0 };
    let own = lacked(index);
    from_around(own, AXES.map(|axis| axis.map(|(dx, dy)| lattice.index(column + dx, row + dy).map_or(own, &lacked))))
}

/// The same by what is lacked by a cell itself and by its neighbours on either side along both axes. A cell that is at an end of the
/// freezing interval or beyond has a front only if there is one on its face.
fn from_around(own: f64, around: [[f64; 2]; 2]) -> f64 {
    let [least, most] = extremes(own, around);
    if own >= 1.0 && least >= 1.0 || own <= 0.0 && most <= 0.0 {
        return own.clamp(0.0, 1.0);
    }
    let fraction = own.clamp(0.0, 1.0);
    let cold = sensible(around.map(|axis| axis.map(|other| other - 1.0)), own - 1.0, fraction);
    let warm = sensible(around.map(|axis| axis.map(|other| -other)), -own, 1.0 - fraction);
    (own - cold + warm).clamp(0.0, 1.0)
}

/// The least and the most of what is lacked by a cell and by its neighbours.
fn extremes(own: f64, around: [[f64; 2]; 2]) -> [f64; 2] {
    around.into_iter().flatten().fold([own; 2], |[least, most], other| [least.min(other), most.max(other)])
}

/// Sensible heat of a cell over that of its neighbour, at most, from which on no front is in it: that of one that a front has just
/// crossed is a third.
const CROSSED: f64 = 1.0 / 3.0;

/// Puts the same of all cells in the place of fractions that are told by heat alone, by the enthalpies (J/m3) of particles of one
/// material, of which `lacked` tells what they lack.
pub fn tell_front_fractions(lattice: &Lattice, enthalpy: &[f64], lacked: impl Fn(f64) -> f64, fractions: &mut [f64]) {
    let MinMax { least: coldest, greatest: warmest, .. } = MinMax::of(enthalpy);
    let in_question = CROSSED * lacked(warmest).min(0.0)..=1.0 + CROSSED * (lacked(coldest) - 1.0).max(0.0);
    for row in 0..lattice.rows {
        let (start, end) = (lattice.start(row), lattice.start(row + 1));
        let first = lattice.span(row).0 as i64;
        let in_row = enthalpy[start..end].iter().map(|enthalpy| lacked(*enthalpy));
        for (number, own) in in_row.enumerate().filter(|(_, own)| in_question.contains(own)) {
            let (index, column) = (start + number, first + number as i64);
            let upright = [-1, 1].map(|dy| lattice.index(column, row as i64 + dy).unwrap_or(index));
            let around = [[index.max(start + 1) - 1, (index + 1).min(end - 1)], upright];
            fractions[index] = from_around(own, around.map(|axis| axis.map(|other| lacked(enthalpy[other]))));
        }
    }
}

/// Sensible heat of the share of a cell that is in one phase, by that of the neighbours in this phase and of the particle itself, all
/// in units of the latent heat, and negative in the other phase. The front lies across one axis. Of two neighbours in this phase
/// each has a front before it, by how much farther than the particle it is from freezing.
fn sensible(around: [[f64; 2]; 2], own: f64, share: f64) -> f64 {
    let along = |[one, other]: [f64; 2]| {
        let beyond = |neighbour: f64| (neighbour - own.max(0.0)).max(0.0);
        let both = beyond(one) + beyond(other);
        let of_one = |neighbour: f64| {
            if both > 0.0 {
                let depth = share * beyond(neighbour) / both;
                neighbour * 0.5 * depth * depth / (0.5 + depth)
            } else {
                0.0
            }
        };
        of_one(one) + of_one(other)
    };
    let [across, upwards] = around.map(along);
    across.max(upwards)
}
