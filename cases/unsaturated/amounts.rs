//! Water and solute that have entered.

use super::{CENTIMETRE, Case, DAY};
use crate::BadTable;

/// What has entered a body by a time: a line per unit of its cross-section (m), a square per unit of its depth (m2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amount {
    /// Time (s).
    pub time: f64,
    /// Volume of water.
    pub water: f64,
    /// Volume of water at the wall's concentration that holds as much solute.
    pub solute: f64,
    /// Estimated error of the water, a bound from the difference to a grid half as fine.
    pub water_error: f64,
    /// Estimated error of the solute.
    pub solute_error: f64,
}

/// The shipped amounts of a problem, by time; none where the table has none.
///
/// # Errors
///
/// If the table cannot be read.
pub fn amounts(case: Case) -> Result<Vec<Amount>, BadTable> {
    let text = include_str!("../tables/unsaturated-amounts.csv");
    let unit = if case.is_line() { CENTIMETRE } else { CENTIMETRE * CENTIMETRE };
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let mut found = Vec::new();
    for row in reader.records() {
        let row = row?;
        let number = |column: usize| {
            let cell = row.get(column).unwrap_or_default();
            cell.parse::<f64>().map_err(|_| BadTable::Cell(cell.into()))
        };
        if row.get(0) == Some(case.name()) {
            found.push(Amount {
                time: number(1)? * DAY,
                water: number(2)? * unit,
                solute: number(3)? * unit,
                water_error: number(4)? * unit,
                solute_error: number(5)? * unit,
            });
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unsaturated::profiles::{Cut, Profiles};

    #[test]
    fn amounts_grow_and_are_given_at_the_times_of_profiles() {
        for case in Case::ALL {
            let (amounts, times) =
                (amounts(case).expect("amounts"), Profiles::of_case(case).expect("profiles").times());
            assert_eq!(amounts.is_empty(), matches!(case, Case::TwoSided | Case::ZoneClosed), "{case:?}");
            for pair in amounts.windows(2) {
                assert!(
                    pair[0].time < pair[1].time && pair[0].water < pair[1].water && pair[0].solute < pair[1].solute
                );
            }
            for amount in amounts {
                assert!(times.contains(&amount.time), "{case:?}");
                let errors = [amount.water_error / amount.water, amount.solute_error / amount.solute];
                assert!(errors.iter().all(|error| (0.0..5e-3).contains(error)), "{case:?}: {errors:?}");
            }
        }
    }

    /// Water and solute (m) of a line by the trapezoidal rule.
    fn stored(profiles: &Profiles, t: f64) -> (f64, f64) {
        let cut = Cut::AlongX { y: 0.0 };
        let places = profiles.places(cut, t).expect("places");
        let content = |place: f64| {
            let sample = profiles.at(cut, place, t).expect("a sample");
            let water = 0.177 * sample.saturation;
            (water, (0.186 + water) * sample.concentration)
        };
        places.windows(2).fold((0.0, 0.0), |(water, solute), pair| {
            let (left, right) = (content(pair[0]), content(pair[1]));
            let half = 0.5 * (pair[1] - pair[0]);
            (water + half * (left.0 + right.0), solute + half * (left.1 + right.1))
        })
    }

    #[test]
    fn amounts_of_lines_are_the_integrals_of_profiles() {
        let profiles = Profiles::of_case(Case::OneSided).expect("profiles");
        let amounts = amounts(Case::OneSided).expect("amounts");
        assert_eq!(amounts.len(), 3);
        for amount in &amounts {
            let (water, solute) = stored(&profiles, amount.time);
            // Trapezoids of 0.05 cm lose a little at the sharp front.
            assert!((water / amount.water - 1.0).abs() < 1e-3, "{water} of {}", amount.water);
            assert!((solute / amount.solute - 1.0).abs() < 1e-3, "{solute} of {}", amount.solute);
        }
        let (water, solute) = stored(&Profiles::of_case(Case::TwoSided).expect("profiles"), 15.0 * DAY);
        assert!((water - 0.0177).abs() < 1e-9, "full: {water}");
        assert!((solute - 0.011_190_8).abs() < 1e-6, "{solute}");
    }

    #[test]
    fn water_of_a_line_is_what_a_half_space_absorbs() {
        use crate::exact::unsaturated::philip::Absorption;
        use crate::exact::unsaturated::soil::{Retention, Soil};
        let soil = Soil::new(Retention::VanGenuchten { alpha: 1.0, n: 1.53 }, 0.186, 0.363, 1e-9).expect("a soil");
        let exact = Absorption::new(soil, 0.0, 1.0).expect("a solution");
        for amount in amounts(Case::OneSided).expect("amounts") {
            let expected = exact.infiltrated(amount.time);
            assert!((amount.water - expected).abs() < amount.water_error, "{} of {expected}", amount.water);
        }
        let profiles = Profiles::of_case(Case::OneSided).expect("profiles");
        let cut = Cut::AlongX { y: 0.0 };
        for t in [DAY, 5.0 * DAY, 10.0 * DAY, 15.0 * DAY, 20.0 * DAY] {
            let places = profiles.places(cut, t).expect("places");
            let (mut difference, mut error) = (0.0, 0.0);
            for &place in places {
                let sample = profiles.at(cut, place, t).expect("a sample");
                difference += (sample.saturation - exact.saturation(place, t)).abs();
                error += sample.saturation_error;
            }
            // Nearly all of it is the one row beside the foot of the front.
            assert!(difference < 2.0 * error, "{t} s: {difference}, estimated {error}");
        }
    }
}
