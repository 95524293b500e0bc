//! Passes over columns of all particles, in parts that threads share.

use crate::side_by_side::{self, MinMax};
use crate::team::{Team, share};

/// Particles of a part; fixed, so that sums do not depend on the number of threads. Five columns of as many stay in the second cache of
/// a core, so that what a pass does with them in turn reads them from memory once.
pub const PART: usize = 1 << 14;

/// Does all parts of a pass over so many particles, side by side if they are several.
pub fn in_parts<P: Send>(team: Option<&Team>, count: usize, parts: impl Iterator<Item = P>, one: impl Fn(P) + Sync) {
    share(team.filter(|_| count > PART), parts, one);
}

/// The least and the greatest of a column but those at some places, which come in order; `found` is room for those of parts.
pub fn extremes(team: Option<&Team>, values: &[f64], places: &[u32], found: &mut Vec<MinMax>) -> MinMax {
    found.resize(values.len().div_ceil(PART), MinMax::NONE);
    in_parts(team, values.len(), found.iter_mut().zip(values.chunks(PART)).enumerate(), |(number, (found, part))| {
        *found = MinMax::without(part, (number * PART, places));
    });
    found.iter().fold(MinMax::NONE, |all, part| all.and(part))
}

/// Fills two columns with a state and with the same a step (s) later, at some rates.
pub fn first_stage(team: Option<&Team>, state: &[f64], rates: &[f64], step: f64, [same, later]: [&mut [f64]; 2]) {
    let parts = same.chunks_mut(PART).zip(later.chunks_mut(PART)).enumerate();
    in_parts(team, state.len(), parts, |(number, (same, later))| {
        let part = number * PART..number * PART + same.len();
        side_by_side::first_stage(&state[part.clone()], &rates[part], step, [same, later]);
    });
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Columns of three parts and some, which wave at some rates, and threads to share them.
    pub fn columns_and_team<const COLUMNS: usize>(rates: [f64; COLUMNS]) -> ([Vec<f64>; COLUMNS], Option<Team>) {
        let column = |rate: f64| (0..3 * PART + 7).map(|i| (rate * i as f64).sin()).collect();
        (rates.map(column), Team::new(3).expect("threads"))
    }

    #[test]
    fn threads_find_the_same() {
        let ([state, rates], team) = columns_and_team([0.3, 0.7]);
        let both = [None, team.as_ref()].map(|team| {
            let [mut same, mut later] = [vec![0.0; state.len()], vec![0.0; state.len()]];
            first_stage(team, &state, &rates, 0.3, [&mut same, &mut later]);
            (same, later, extremes(team, &state, &[0, PART as u32], &mut Vec::new()))
        });
        assert_eq!(both[0], both[1]);
        assert_eq!(both[0].0, state);
        let places = [0, PART as u32];
        assert_eq!(both[0].2, MinMax::without(&state, (0, &places)));
        let plain = state.iter().zip(&rates).map(|(state, rate)| state + 0.3 * rate);
        assert!(both[0].1.iter().copied().eq(plain));
    }
}
