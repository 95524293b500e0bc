//! Sums and extremes over columns of numbers, several numbers side by side: in the same order, and so to the same bits, whatever vectors
//! a processor has.

use crate::instruction_set::widest;
use crate::ledger::Sum;

/// Numbers that are added or compared side by side.
const LANES: usize = 8;

/// The least and the greatest of some numbers; infinite, the wrong way round, of none. What is no number counts as neither.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MinMax {
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
    /// Whether all are finite.
    pub are_finite: bool,
}

impl MinMax {
    /// Of no numbers.
    pub const NONE: Self = MinMax { least: f64::INFINITY, greatest: f64::NEG_INFINITY, are_finite: true };

    /// Of some numbers.
    pub fn of(values: &[f64]) -> Self {
        let mut all = Self::NONE;
        extremes_widely(values, &mut all);
        all
    }

    /// Of these and others.
    #[must_use]
    pub fn and(self, other: &Self) -> Self {
        MinMax {
            least: self.least.min(other.least),
            greatest: self.greatest.max(other.greatest),
            are_finite: self.are_finite && other.are_finite,
        }
    }

    /// Of all numbers but those at some places, which come in order and count as that of the first number says.
    pub fn without(values: &[f64], (before, places): (usize, &[u32])) -> Self {
        let (mut all, mut first) = (Self::NONE, 0);
        let places = &places[places.partition_point(|place| (*place as usize) < before)..];
        for place in places.iter().map(|place| *place as usize - before).take_while(|place| *place < values.len()) {
            all = all.and(&Self::of(&values[first.min(place)..place]));
            first = place + 1;
        }
        all.and(&Self::of(values.get(first..).unwrap_or_default()))
    }
}

widest!(extremes_widely, extremes_of, (values: &[f64], all: &mut MinMax));

/// Numbers of which extremes are taken side by side: two vectors, which hide each other's latency.
const ABREAST: usize = 2 * LANES;

#[inline(always)]
fn extremes_of(values: &[f64], all: &mut MinMax) {
    let (groups, rest) = values.as_chunks::<ABREAST>();
    // Zero times what is not finite is no number, and stays so.
    let (mut least, mut greatest, mut zeros) = ([all.least; ABREAST], [all.greatest; ABREAST], [0.0; ABREAST]);
    for group in groups {
        take_extremes(group, &mut least, &mut greatest, &mut zeros);
    }
    match values.last_chunk::<ABREAST>() {
        // What is left over of whole groups as the last that is whole, over some of the one before.
        Some(last) => take_extremes(last, &mut least, &mut greatest, &mut zeros),
        None => {
            for value in rest {
                take_extremes(&[*value; ABREAST], &mut least, &mut greatest, &mut zeros);
            }
        }
    }
    // By halves, as vectors do it.
    let mut half = ABREAST / 2;
    while half > 0 {
        for lane in 0..half {
            let (other_least, other_greatest) = (least[lane + half], greatest[lane + half]);
            least[lane] = if other_least < least[lane] { other_least } else { least[lane] };
            greatest[lane] = if other_greatest > greatest[lane] { other_greatest } else { greatest[lane] };
            zeros[lane] += zeros[lane + half];
        }
        half /= 2;
    }
    (all.least, all.greatest) = (least[0], greatest[0]);
    all.are_finite &= zeros[0] == 0.0;
}

#[inline(always)]
fn take_extremes(
    group: &[f64; ABREAST],
    least: &mut [f64; ABREAST],
    greatest: &mut [f64; ABREAST],
    zeros: &mut [f64; ABREAST],
) {
    for lane in 0..ABREAST {
        // Plain comparisons: they need no care for what is no number and become one instruction.
        least[lane] = if group[lane] < least[lane] { group[lane] } else { least[lane] };
        greatest[lane] = if group[lane] > greatest[lane] { group[lane] } else { greatest[lane] };
        zeros[lane] += 0.0 * group[lane];
    }
}

/// The sum of what is told for each number from zero to `count`: several sums side by side that keep their rounding errors (two-sum,
/// Knuth 1969), then theirs.
#[inline(always)]
pub fn sum_of(count: usize, term: impl Fn(usize) -> f64) -> f64 {
    let (mut totals, mut lost) = ([0.0; LANES], [0.0; LANES]);
    let whole = count - count % LANES;
    // Loops and a function, no closures: what a compiler does not inline has no vectors.
    for first in (0..whole).step_by(LANES) {
        let mut terms = [0.0; LANES];
        for lane in 0..LANES {
            terms[lane] = term(first + lane);
        }
        add_terms(terms, &mut totals, &mut lost);
    }
    let mut terms = [0.0; LANES];
    for (own, place) in terms.iter_mut().zip(whole..count) {
        *own = term(place);
    }
    add_terms(terms, &mut totals, &mut lost);
    let sum: Sum = totals.into_iter().chain(lost).collect();
    sum.value()
}

/// Adds terms to sums side by side, and what rounding takes from these to what was lost.
#[inline(always)]
fn add_terms(terms: [f64; LANES], totals: &mut [f64; LANES], lost: &mut [f64; LANES]) {
    for lane in 0..LANES {
        let next = totals[lane] + terms[lane];
        let taken = next - totals[lane];
        lost[lane] += (totals[lane] - (next - taken)) + (terms[lane] - taken);
        totals[lane] = next;
    }
}

/// The same where the term of what a column has zeros for is zero: to the same bits, without asking for groups of zeros.
#[inline]
pub fn sum_where(column: &[f64], term: impl Fn(usize) -> f64) -> f64 {
    let groups = column.chunks(LANES).enumerate().filter(|(_, group)| group.iter().any(|value| *value != 0.0));
    let first: Vec<usize> = groups.map(|(number, _)| number * LANES).collect();
    sum_of(first.len() * LANES, |place| {
        let at = first[place / LANES] + place % LANES;
        if at < column.len() { term(at) } else { 0.0 }
    })
}

/// Sum of a column less another, of which there may be none, and of the magnitudes of what it adds: to the bits of [`sum_of`].
pub fn sum_and_size(values: &[f64], less: &[f64]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    match less {
        [] => sums_widely(values, &mut sums),
        less => sums_of_less_widely(values, less, &mut sums),
    }
    sums
}

widest!(sums_widely, sums_of, (values: &[f64], sums: &mut [f64; 2]));
widest!(sums_of_less_widely, sums_of_less, (values: &[f64], less: &[f64], sums: &mut [f64; 2]));

#[inline(always)]
fn sums_of(values: &[f64], sums: &mut [f64; 2]) {
    *sums = [sum_of(values.len(), |i| values[i]), sum_of(values.len(), |i| values[i].abs())];
}

#[inline(always)]
fn sums_of_less(values: &[f64], less: &[f64], sums: &mut [f64; 2]) {
    let less = &less[..values.len()];
    *sums = [sum_of(values.len(), |i| values[i] - less[i]), sum_of(values.len(), |i| (values[i] - less[i]).abs())];
}

/// Fills two columns with a state and with the same a step (s) later, at some rates.
pub fn first_stage(state: &[f64], rates: &[f64], step: f64, columns: [&mut [f64]; 2]) {
    first_stage_widely(state, rates, step, columns);
}

widest!(first_stage_widely, first_stage_of, (state: &[f64], rates: &[f64], step: f64, columns: [&mut [f64]; 2]));

#[inline(always)]
fn first_stage_of(state: &[f64], rates: &[f64], step: f64, [same, later]: [&mut [f64]; 2]) {
    let columns = same.iter_mut().zip(later);
    for ((same, later), (state, rate)) in columns.zip(state.iter().zip(rates)) {
        *same = *state;
        *later = state + step * rate;
    }
}

/// Brings a time (s) to the earliest after now at which a number that changes at a rate (1/s) reaches one of two others.
pub fn first_reached(numbers: &[f64], rates: &[f64], others: (f64, f64), earliest: &mut f64) {
    first_reached_widely(numbers, rates, others, earliest);
}

widest!(first_reached_widely, first_reached_of, (numbers: &[f64], rates: &[f64], others: (f64, f64), earliest: &mut f64));

#[inline(always)]
fn first_reached_of(numbers: &[f64], rates: &[f64], others: (f64, f64), earliest: &mut f64) {
    /// More than what rounding makes of a product and of a quotient.
    const ROUNDED: f64 = 1.0 + 1e-9;
    let note = |number: f64, rate: f64, earliest: &mut f64| {
        for other in [others.0, others.1] {
            let time = (other - number) / rate;
            if time > 0.0 && time < *earliest {
                *earliest = time;
            }
        }
    };
    let ((numbers, rest), (rates, rest_rates)) = (numbers.as_chunks::<LANES>(), rates.as_chunks::<LANES>());
    for (numbers, rates) in numbers.iter().zip(rates) {
        // Few are so near that they have to be divided.
        let mut near = [false; LANES];
        for lane in 0..LANES {
            let way = ROUNDED * (*earliest * rates[lane]).abs();
            near[lane] = ((others.0 - numbers[lane]).abs() <= way) | ((others.1 - numbers[lane]).abs() <= way);
        }
        if near.contains(&true) {
            for lane in 0..LANES {
                note(numbers[lane], rates[lane], earliest);
            }
        }
    }
    for (number, rate) in rest.iter().zip(rest_rates) {
        note(*number, *rate, earliest);
    }
}

/// What is added up over a step: the start, the end, the rates at the start and at the end.
pub type StepColumns<'a> = [&'a [f64]; 4];

/// Sum of the magnitudes of what a cubic through both ends of a step lacks of being straight, as it estimates the error of a step
/// (Sommeijer, Shampine and Verwer 1998), and of the magnitudes of the end.
pub fn error_and_size(columns: StepColumns<'_>, step: f64) -> (f64, f64) {
    let mut sums = [0.0; 2];
    error_widely(columns, step, &mut sums);
    (sums[0], sums[1])
}

widest!(error_widely, error_of, (columns: StepColumns<'_>, step: f64, sums: &mut [f64; 2]));

#[inline(always)]
fn error_of(columns: StepColumns<'_>, step: f64, sums: &mut [f64; 2]) {
    let [start, end, first, last] = columns.map(|column| column.as_chunks::<LANES>());
    let (mut errors, mut sizes) = ([0.0; LANES], [0.0; LANES]);
    for (((start, end), first), last) in start.0.iter().zip(end.0).zip(first.0).zip(last.0) {
        for lane in 0..LANES {
            errors[lane] += error_of_one([start[lane], end[lane], first[lane], last[lane]], step);
            sizes[lane] += end[lane].abs();
        }
    }
    for (((start, end), first), last) in start.1.iter().zip(end.1).zip(first.1).zip(last.1) {
        errors[0] += error_of_one([*start, *end, *first, *last], step);
        sizes[0] += end.abs();
    }
    *sums = [errors.iter().sum(), sizes.iter().sum()];
}

/// The same of one particle.
#[inline(always)]
pub fn error_of_one([start, end, first, last]: [f64; 4], step: f64) -> f64 {
    (0.8 * (start - end) + 0.4 * step * (first + last)).abs()
}

/// Sum of the magnitudes of the differences of two columns.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = 0.0;
    distance_widely(a, b, &mut sum);
    sum
}

widest!(distance_widely, distance_of, (a: &[f64], b: &[f64], sum: &mut f64));

#[inline(always)]
fn distance_of(a: &[f64], b: &[f64], sum: &mut f64) {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            sums[lane] += (a[lane] - b[lane]).abs();
        }
    }
    for (a, b) in a_rest.iter().zip(b_rest) {
        sums[0] += (a - b).abs();
    }
    *sum = sums.iter().sum();
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::instruction_set::{InstructionSet, limit};

    proptest! {
        #[test]
        fn sums_and_extremes_are_those_of_a_plain_loop(
            values in prop::collection::vec(-1e3_f64..1e3, 0..70),
            absent in prop::collection::btree_set(0_u32..70, 0..5),
        ) {
            let other: Vec<f64> = values.iter().rev().copied().collect();
            let places: Vec<u32> = absent.iter().copied().collect();
            let kept = |i: &usize| !absent.contains(&(*i as u32));
            let kept: Vec<f64> = (0..values.len()).filter(kept).map(|i| values[i]).collect();
            let found = MinMax::without(&values, (0, &places));
            let middle = values.len() / 2;
            let parts = [(0, &values[..middle]), (middle, &values[middle..])];
            let in_parts = parts.map(|(before, part)| MinMax::without(part, (before, &places)));
            prop_assert_eq!(in_parts[0].and(&in_parts[1]), found);
            prop_assert_eq!(found.least, kept.iter().copied().fold(f64::INFINITY, f64::min));
            prop_assert_eq!(found.greatest, kept.iter().copied().fold(f64::NEG_INFINITY, f64::max));
            prop_assert!(found.are_finite);
            let plain: f64 = values.iter().zip(&other).map(|(a, b)| (a - b).abs()).sum();
            // Rounding of fewer than a hundred terms.
            let rounding = 100.0 * f64::EPSILON;
            prop_assert!((distance(&values, &other) - plain).abs() <= rounding * plain);
            let columns = [&values[..], &other, &other, &values];
            let (error, size) = error_and_size(columns, 0.5);
            let errors = (0..values.len()).map(|i| error_of_one(columns.map(|column| column[i]), 0.5));
            let (plain, plain_size) = (errors.sum::<f64>(), other.iter().map(|end| end.abs()).sum::<f64>());
            prop_assert!((error - plain).abs() <= rounding * plain && (size - plain_size).abs() <= rounding * plain_size);
        }

        /// On any vectors, and without asking for what is zero.
        #[test]
        fn sums_of_columns_have_the_bits_of_sums_of_terms(
            values in prop::collection::vec(prop_oneof![8 => Just(0.0), 1 => -1e3_f64..1e3], 0..200),
        ) {
            let less: Vec<f64> = values.iter().map(|value| 0.3 * value + 1.0).collect();
            let bits = |sums: [f64; 2]| sums.map(f64::to_bits);
            let of = |term: &dyn Fn(usize) -> f64| [sum_of(values.len(), term), sum_of(values.len(), |i| term(i).abs())];
            prop_assert_eq!(bits(sum_and_size(&values, &[])), bits(of(&|i| values[i])));
            prop_assert_eq!(bits(sum_and_size(&values, &less)), bits(of(&|i| values[i] - less[i])));
            let cubes = |i: usize| values[i].powi(3);
            prop_assert_eq!(sum_where(&values, cubes).to_bits(), sum_of(values.len(), cubes).to_bits());
        }

        /// Among terms that cancel, in whose rounding all others would be lost.
        #[test]
        fn sums_keep_their_rounding_errors(values in prop::collection::vec(-1000_i32..1000, 2..70), great in 0_usize..70) {
            let count = values.len();
            let mut terms: Vec<f64> = values.iter().map(|value| f64::from(*value)).collect();
            let [plus, minus] = [great, great + 1].map(|place| place % count);
            let exact = values.iter().sum::<i32>() - values[plus] - values[minus];
            (terms[plus], terms[minus]) = (1e19, -1e19);
            let found = sum_of(count, |i| terms[i]);
            prop_assert_eq!(found, f64::from(exact));
        }
    }

    proptest! {
        #[test]
        fn times_are_those_of_a_plain_loop(
            states in prop::collection::vec((-2.0..2.0_f64, prop_oneof![-1e-3..1e-3_f64, Just(0.0), Just(f64::NAN)]), 0..70),
            within in prop_oneof![Just(f64::INFINITY), 1.0..1e4_f64],
        ) {
            let (numbers, rates): (Vec<f64>, Vec<f64>) = states.iter().copied().unzip();
            let mut found = within;
            first_reached(&numbers, &rates, (-1.0, 1.0), &mut found);
            let times = states.iter().flat_map(|(number, rate)| [-1.0, 1.0].map(|other| (other - number) / rate));
            let plain = times.filter(|time| *time > 0.0).fold(within, f64::min);
            prop_assert_eq!(found, plain);
        }
    }

    #[test]
    fn what_is_not_finite_is_found_in_any_lane() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for (count, place) in [5, 21, 40].into_iter().flat_map(|count| (0..count).map(move |place| (count, place)))
            {
                let mut values = vec![1.0; count];
                values[place] = bad;
                assert!(!MinMax::of(&values).are_finite, "{bad} at {place} of {count}");
            }
        }
        assert_eq!(MinMax::of(&[]), MinMax::NONE);
    }

    #[test]
    fn all_vectors_give_the_same_bits() {
        let values: Vec<f64> = (0..1003).map(|k| f64::from(k * 7919 % 1009) / 7.0 - 60.0).collect();
        let other: Vec<f64> = values.iter().rev().copied().collect();
        let all = |set| {
            limit(set);
            let found = (error_and_size([&values, &other, &other, &values], 0.3), distance(&values, &other));
            limit(InstructionSet::Avx512);
            found
        };
        let [narrowest, rest @ ..] = InstructionSet::ALL.map(all);
        assert!(rest.iter().all(|found| *found == narrowest));
    }
}
