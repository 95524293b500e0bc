//! What fronts tell of the cells that they cross.

use crate::instruction_set::widest;
use crate::space::lattice::Lattice;

/// Neighbours along both axes, on either side.
const AXES: [[(i64, i64); 2]; 2] = [[(-1, 0), (1, 0)], [(0, -1), (0, 1)]];

/// Temperature at the centre of a cell with a front in it, less that of freezing: on the line from the front to the neighbour in the
/// phase in which the centre is, along the axis along which it lies farthest behind the front. `temperature` tells that of a
/// particle, less that of freezing. Between two fronts that move toward each other, of which neither has passed the centre, it is none.
pub fn at_the_centre(lattice: &Lattice, index: usize, fraction: f64, temperature: impl Fn(usize) -> f64) -> f64 {
    let (column, row) = lattice.cell(index);
    let (share, sign) = if fraction > 0.5 { (fraction, -1.0) } else { (1.0 - fraction, 1.0) };
    let own = sign * temperature(index);
    let along = |axis: [(i64, i64); 2]| {
        let neighbours = axis.map(|(dx, dy)| lattice.index(column + dx, row + dy));
        let around = neighbours.map(|other| other.map_or(0.0, |other| sign * temperature(other)));
        let shares = shares_of_fronts(around, own, share);
        let behind = |side: usize| (shares[side] - 0.5).max(0.0);
        let of_one = |side: usize| around[side] * behind(side) / (behind(side) + 1.0);
        of_one(0).max(of_one(1))
    };
    let [across, upwards] = AXES.map(along);
    sign * across.max(upwards)
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
    let [[left, right], [below, above]] = around;
    let (least, most) = (left.min(right).min(below.min(above)), left.max(right).max(below.max(above)));
    if own >= 1.0 && least >= 1.0 || own <= 0.0 && most <= 0.0 {
        return own.clamp(0.0, 1.0);
    }
    let fraction = own.clamp(0.0, 1.0);
    let cold = sensible(around.map(|axis| axis.map(|other| other - 1.0)), own - 1.0, fraction);
    let warm = sensible(around.map(|axis| axis.map(|other| -other)), -own, 1.0 - fraction);
    (own - cold + warm).clamp(0.0, 1.0)
}

/// Cells in which a front may lie elsewhere than heat alone says, by index, column and row, in order: those beside which the frozen
/// fraction is another. In the others there is no front, or they are as their neighbours are.
pub fn cells_with_fronts(lattice: &Lattice, fractions: &[f64]) -> Vec<(usize, (i64, i64))> {
    let mut marks = vec![0; fractions.len()];
    let mut differ = vec![0; lattice.columns];
    for row in 0..lattice.rows {
        let (start, (first, end)) = (lattice.start(row), lattice.span(row));
        // Beside a curved wall a row may be without a cell.
        let Some(along) = (end - first).checked_sub(1) else { continue };
        let (own, next) = (&fractions[start..start + along], &fractions[start + 1..start + 1 + along]);
        differ[..along].fill(0);
        mark_widely(own, next, &mut differ[..along], &mut marks[start..start + along]);
        for (mark, differs) in marks[start + 1..start + 1 + along].iter_mut().zip(&differ) {
            *mark |= differs;
        }
        let Some(below) = row.checked_sub(1) else { continue };
        let (first_below, end_below) = lattice.span(below);
        let from = first.max(first_below);
        let Some(both) = end.min(end_below).checked_sub(from) else { continue };
        let (own, other) = (start + from - first, lattice.start(below) + from - first_below);
        let (marks_below, marks) = marks.split_at_mut(start);
        let (marks, marks_below) = (&mut marks[own - start..][..both], &mut marks_below[other..][..both]);
        mark_widely(&fractions[own..][..both], &fractions[other..][..both], marks, marks_below);
    }
    let mut found = Vec::new();
    for row in 0..lattice.rows {
        let (start, first) = (lattice.start(row), lattice.span(row).0);
        let mut add = |place: usize| found.push((place, ((first + place - start) as i64, row as i64)));
        let (words, rest) = marks[start..lattice.start(row + 1)].as_chunks::<8>();
        for (number, word) in words.iter().enumerate() {
            // Few cells are marked.
            if u64::from_ne_bytes(*word) != 0 {
                (0..8).filter(|place| word[*place] != 0).for_each(|place| add(start + 8 * number + place));
            }
        }
        let from = start + 8 * words.len();
        (0..rest.len()).filter(|place| rest[*place] != 0).for_each(|place| add(from + place));
    }
    found
}

widest!(mark_widely, mark, (some: &[f64], others: &[f64], marks: &mut [u8], other_marks: &mut [u8]));

/// Marks numbers that differ from others, and these.
#[inline(always)]
fn mark(some: &[f64], others: &[f64], marks: &mut [u8], other_marks: &mut [u8]) {
    for ((one, other), (mark, other_mark)) in some.iter().zip(others).zip(marks.iter_mut().zip(other_marks)) {
        let differs = u8::from(one != other);
        *mark |= differs;
        *other_mark |= differs;
    }
}

/// Sensible heat of the share of a cell that is in one phase, by that of the neighbours in this phase and of the particle itself, all
/// in units of the latent heat, and negative in the other phase. The front lies across one axis.
fn sensible(around: [[f64; 2]; 2], own: f64, share: f64) -> f64 {
    let along = |axis: [f64; 2]| {
        let shares = shares_of_fronts(axis, own, share);
        let of_one = |side: usize| axis[side] * 0.5 * shares[side] * shares[side] / (0.5 + shares[side]);
        of_one(0) + of_one(1)
    };
    let [across, upwards] = around.map(along);
    across.max(upwards)
}

/// Parts of the share of a cell that is in one phase, by the neighbours on an axis before which they lie: of two in this phase each has
/// a front before it, by how much farther than the particle it is from freezing. What is told of neighbours and of the particle
/// itself is negative in the other phase.
fn shares_of_fronts(around: [f64; 2], own: f64, share: f64) -> [f64; 2] {
    let beyond = around.map(|neighbour| (neighbour - own.max(0.0)).max(0.0));
    let both = beyond[0] + beyond[1];
    if both > 0.0 { beyond.map(|beyond| share * beyond / both) } else { [0.0; 2] }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::space::domain::{Domain, Sector};

    proptest! {
        /// No cell is left out, however rows of a body begin and end.
        #[test]
        fn all_cells_with_fronts_are_found(
            outer_radius in 1.0..8.0_f64,
            is_ring in any::<bool>(),
            lacks in prop::collection::vec(prop_oneof![Just(-0.2), -0.5..1.5_f64, Just(0.4), Just(1.3)], 17 * 17),
        ) {
            let domain = match is_ring {
                true => Domain::Ring { outer_radius, sector: Sector::Whole },
                false => Domain::Line { length: outer_radius },
            };
            let lattice = Lattice::new(&domain, 1.0);
            let by_heat: Vec<f64> = lacks[..lattice.len()].iter().map(|lacked| lacked.clamp(0.0, 1.0)).collect();
            let found = cells_with_fronts(&lattice, &by_heat);
            prop_assert!(found.windows(2).all(|pair| pair[0].0 < pair[1].0));
            for index in 0..lattice.len() {
                let told = front_fraction(&lattice, lattice.cell(index), |index| lacks[index]);
                let is_found = found.contains(&(index, lattice.cell(index)));
                prop_assert!(is_found || told == by_heat[index], "{told} for {}", lacks[index]);
            }
        }
    }
}
