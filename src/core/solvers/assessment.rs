//! What a step by error is judged by, in one pass over its columns.

use crate::parts::{PART, in_parts};
use crate::side_by_side::{StepColumns, error_and_size, error_of_one};
use crate::solvers::control::{EnthalpyRange, taken_up};
use crate::space::volumes::Volumes;
use crate::team::Team;

/// What a step, or a part of it, is judged by.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Assessment {
    /// Sum over particles, by their volumes, of the estimated error of their enthalpy (J/m3).
    pub error: f64,
    /// Sum of the magnitudes of what they have taken up since the start (J/m3).
    pub size: f64,
    /// How far, over its scale, the worst has left the range of the data.
    pub excess: f64,
}

/// Room for what is found of the parts of so many particles.
pub fn room(count: usize) -> Vec<Assessment> {
    vec![Assessment::default(); count.div_ceil(PART)]
}

/// A step that was made.
pub struct MadeStep<'a> {
    /// States and rates at both ends.
    pub columns: StepColumns<'a>,
    /// Its length (s).
    pub step: f64,
    /// Enthalpies (J/m3) from which all started, or none where those are zero.
    pub started: &'a [f64],
    /// Volumes of particles.
    pub volumes: &'a Volumes,
    /// The range of the data, if anybody asks for it.
    pub range: Option<&'a EnthalpyRange>,
}

impl MadeStep<'_> {
    /// Assesses the step; `found` is room for its parts.
    pub fn assess(&self, team: Option<&Team>, found: &mut [Assessment]) -> Assessment {
        let [_, end, ..] = self.columns;
        in_parts(team, end.len(), found.iter_mut().enumerate(), |(number, found)| {
            *found = self.part(number * PART);
        });
        found.iter().fold(Assessment::default(), |all, part| Assessment {
            error: all.error + part.error,
            size: all.size + part.size,
            excess: all.excess.max(part.excess),
        })
    }

    /// The part from a particle on.
    fn part(&self, first: usize) -> Assessment {
        let until = (first + PART).min(self.columns[0].len());
        let columns = self.columns.map(|column| &column[first..until]);
        let [_, end, ..] = columns;
        let (error, by_state) = if self.volumes.is_even() {
            error_and_size(columns, self.step)
        } else {
            let mut sums = (0.0, 0.0);
            for (i, own) in end.iter().enumerate() {
                let share = self.volumes.share(first + i);
                sums.0 += share * error_of_one(columns.map(|column| column[i]), self.step);
                sums.1 += share * own.abs();
            }
            sums
        };
        let size = taken_up(end, self.started.get(first..until).unwrap_or_default(), by_state);
        Assessment { error, size, excess: self.range.map_or(0.0, |range| range.excess_from(first, end)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::tests::columns_and_team;

    #[test]
    fn threads_find_the_same() {
        let (columns, team) = columns_and_team([0.3, 0.7, 1.1, 1.3]);
        let count = columns[0].len();
        let shells = Volumes::by_share(1.0, (1..100).map(f64::from).collect());
        for (started, volumes) in [(&[][..], &Volumes::even(1.0)), (&columns[2], &shells)] {
            let [start, end, first, last] = columns.each_ref().map(|column| &column[..]);
            let made = MadeStep { columns: [start, end, first, last], step: 0.2, started, volumes, range: None };
            let (mut alone, mut shared) = (room(count), room(count));
            let found = made.assess(None, &mut alone);
            assert_eq!(found, made.assess(team.as_ref(), &mut shared));
            let errors =
                (0..count).map(|i| volumes.share(i) * error_of_one([start, end, first, last].map(|c| c[i]), 0.2));
            // Rounding of as many terms.
            let plain: f64 = errors.sum();
            assert!((found.error - plain).abs() <= count as f64 * f64::EPSILON * plain);
        }
    }
}
