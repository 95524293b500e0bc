//! When a wall is as designed: closed, as thick as wanted where it is weakest, and as cold there in the mean.

use crate::goals::Design;

/// A wall where it is weakest, as an output tells of it: time (s), whether it is closed, thickness (m), mean temperature (degC).
pub(super) type Weakest = (f64, bool, f64, Option<f64>);

/// Part of the wanted temperature by which readings on a lattice rise now and then although the wall only grows colder: one that is
/// warmer by no more, and gets as cold again, has not been lost.
const SCATTER: f64 = 0.025;

/// When a wall first was as designed (s), and from when it was so no more: from which time it lacks something at the end, or
/// lacks it until it is open, thinner than wanted, or warmer by more than readings scatter. Between two outputs that both tell of a
/// closed wall times are reckoned by its thickness and temperature, else the later of the two is taken to come to it, and the earlier
/// to leave it.
pub(super) fn designed(weakest: &[Weakest], design: Design) -> (Option<f64>, Option<f64>) {
    let scatter = [0.0, SCATTER * design.mean_temperature_c.abs()];
    let mut before: Option<(f64, [f64; 2])> = None;
    let (mut reached, mut left): (Option<f64>, Option<f64>) = (None, None);
    for (time, closed, thickness, temperature) in weakest {
        // How far both are from what is wanted: 0 or less once they are there.
        let lack = temperature
            .filter(|_| *closed)
            .map(|mean| [design.thickness_m - thickness, mean - design.mean_temperature_c]);
        let is_designed = lack.is_some_and(|lack| lack.iter().all(|lack| *lack <= 0.0));
        let was_designed = reached.is_some() && left.is_none();
        if is_designed != was_designed {
            let (last, part) = match (before, lack) {
                (Some((last, lacked)), Some(now)) => (last, crossing(lacked, now, is_designed)),
                (Some((last, _)), None) => (last, 0.0),
                (None, _) => (*time, 1.0),
            };
            let crossed = last + part * (time - last);
            match (is_designed, reached) {
                (false, _) => left = Some(crossed),
                (true, None) => reached = Some(crossed),
                (true, Some(_)) => left = None,
            }
        }
        let is_lost = lack.is_none_or(|lack| lack.iter().zip(scatter).any(|(lack, scatter)| *lack > scatter));
        if left.is_some() && is_lost {
            break;
        }
        before = lack.map(|lack| (*time, lack));
    }
    (reached, left)
}

/// The part of a way between two looks at which the last of what is lacked is there, or the first of what was there is lost.
fn crossing(before: [f64; 2], now: [f64; 2], comes: bool) -> f64 {
    let crossed = before.into_iter().zip(now).filter(|(before, now)| (*before <= 0.0) != (*now <= 0.0));
    let parts = crossed.map(|(before, now)| before / (before - now));
    if comes { parts.fold(0.0, f64::max) } else { parts.fold(1.0, f64::min) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DESIGN: Design = Design { thickness_m: 2.0, mean_temperature_c: -6.0 };

    /// Of a closed wall that is looked at every second.
    fn times(looks: &[(f64, f64)]) -> (Option<f64>, Option<f64>) {
        let look = |(time, (thickness, mean)): (usize, &(f64, f64))| (time as f64, true, *thickness, Some(*mean));
        designed(&looks.iter().enumerate().map(look).collect::<Vec<_>>(), DESIGN)
    }

    #[test]
    fn a_wall_is_as_designed_once_it_is_thick_and_cold() {
        assert_eq!(times(&[(1.0, -5.0), (3.0, -5.5), (4.0, -6.5), (5.0, -7.0)]), (Some(1.5), None));
        assert_eq!(times(&[(1.5, -8.0), (2.5, -8.0)]), (Some(0.5), None));
        assert_eq!(times(&[(1.0, -5.0), (1.5, -5.5)]), (None, None));
    }

    #[test]
    fn readings_that_scatter_do_not_lose_a_wall() {
        assert_eq!(times(&[(2.5, -5.9), (2.5, -6.1), (2.6, -5.9), (2.7, -6.1), (2.8, -6.2)]), (Some(0.5), None));
        // More than they scatter by, or to the end.
        assert_eq!(times(&[(2.5, -6.5), (2.5, -5.5), (2.6, -6.5)]), (Some(0.0), Some(0.5)));
        assert_eq!(times(&[(2.5, -6.1), (2.5, -5.9), (2.5, -5.9)]), (Some(0.0), Some(0.5)));
        assert_eq!(times(&[(2.5, -6.1), (2.5, -5.9), (2.5, -5.5), (2.5, -6.5)]), (Some(0.0), Some(0.5)));
    }

    #[test]
    fn a_wall_that_is_thinner_or_open_is_lost() {
        assert_eq!(times(&[(2.5, -6.5), (1.5, -6.5), (2.5, -6.5)]), (Some(0.0), Some(0.5)));
        let open = [(0.0, true, 2.5, Some(-6.5)), (1.0, false, 0.0, None), (2.0, true, 2.5, Some(-6.5))];
        assert_eq!(designed(&open, DESIGN), (Some(0.0), Some(0.0)));
    }
}
