//! Errors of runs whose truth nobody knows, by what ever finer ones differ (Richardson 1911, doi 10.1098/rsta.1911.0009), with
//! the factors of safety of Roache (1994, doi 10.1115/1.2910291).

/// Factor from an estimate to a promise where three spacings show an order.
const SAFETY: f64 = 1.25;
/// The same where they do not.
const SAFETY_WITHOUT_ORDER: f64 = 3.0;
/// The least order that is believed.
const LEAST: f64 = 0.5;
/// How much more than the formal order asks for differences may fall and still show it: beyond that, the first is of a run that is too
/// coarse for any order, or the last is small by luck.
const LUCK: f64 = 2.0;
/// Halvings of the range of orders.
const HALVINGS: usize = 60;

/// What runs of one method at ever finer spacings tell of their errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Observed order, within those that are believed.
    pub order: f64,
    /// Factor from what runs differ by to what is promised.
    pub safety: f64,
    /// Error that is promised of each run, from coarse to fine.
    pub promised: Vec<f64>,
}

impl Estimate {
    /// From spacings, from coarse to fine, and what the run at each differs from the next; none with less than two runs. No order
    /// above the formal one is believed: coarse runs often seem better than they are.
    pub fn of(spacings: &[f64], differences: &[f64], formal: f64) -> Option<Estimate> {
        let last = *differences.last()?;
        let finest = spacings.len().checked_sub(1).filter(|finest| *finest == differences.len())?;
        let observed = finest.checked_sub(2).and_then(|k| {
            let spacings = [spacings[k], spacings[k + 1], spacings[k + 2]];
            order(spacings, differences[k] / last, formal)
        });
        // First order is the cautious guess.
        let order = observed.unwrap_or(formal.min(1.0));
        let safety = if observed.is_some() { SAFETY } else { SAFETY_WITHOUT_ORDER };
        let mut error = last / ((spacings[finest - 1] / spacings[finest]).powf(order) - 1.0);
        let mut promised = vec![safety * error];
        for difference in differences.iter().rev() {
            error += difference;
            promised.push(safety * error);
        }
        promised.reverse();
        Some(Estimate { order, safety, promised })
    }

    /// The spacing at which an error is promised, by the finest run.
    pub fn spacing_for(&self, finest: f64, error: f64) -> f64 {
        let promised = self.promised.last().copied().unwrap_or(f64::INFINITY);
        finest * (error / promised).powf(1.0 / self.order)
    }
}

/// What is promised of a run, by what it differs from one at so many times its spacing, at an order that is known.
pub fn of_two(difference: f64, ratio: f64, order: f64) -> f64 {
    SAFETY * difference / (ratio.powf(order) - 1.0)
}

/// The order at which differences of three runs are in a ratio, up to the formal one; none where they fall slower or faster than is
/// believed.
fn order(spacings: [f64; 3], ratio: f64, formal: f64) -> Option<f64> {
    let of = |order: f64| {
        let [coarse, middle, fine] = spacings.map(|spacing| spacing.powf(order));
        (coarse - middle) / (middle - fine)
    };
    let (mut low, mut high) = (LEAST, formal);
    if !(of(low)..=LUCK * of(high)).contains(&ratio) {
        return None;
    }
    if ratio >= of(high) {
        return Some(high);
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if of(middle) < ratio {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Errors that follow a power of the spacing are told as they are, whatever the spacings.
        #[test]
        fn powers_are_found(power in 0.6_f64..2.0, first in 1.2_f64..4.0, second in 1.2_f64..4.0, size in 1e-3_f64..1e3) {
            let spacings = [first * second, second, 1.0];
            let errors = spacings.map(|spacing: f64| size * spacing.powf(power));
            let found = Estimate::of(&spacings, &[errors[0] - errors[1], errors[1] - errors[2]], 2.0).expect("three runs");
            prop_assert!((found.order - power).abs() < 1e-6, "{found:?}");
            for (promised, error) in found.promised.iter().zip(errors) {
                prop_assert!((promised / (SAFETY * error) - 1.0).abs() < 1e-5, "{found:?}");
            }
            let spacing = found.spacing_for(1.0, SAFETY * size * 0.25);
            prop_assert!((spacing.powf(power) - 0.25).abs() < 1e-5);
        }
    }

    #[test]
    fn what_shows_no_order_is_promised_with_care() {
        assert_eq!(Estimate::of(&[1.0], &[], 2.0), None);
        let two = Estimate::of(&[2.0, 1.0], &[0.1], 2.0).expect("two runs");
        assert_eq!((two.order, two.promised[1]), (1.0, 0.1 * SAFETY_WITHOUT_ORDER));
        // Differences that grow.
        let grown = Estimate::of(&[4.0, 2.0, 1.0], &[0.1, 0.2], 2.0).expect("three runs");
        assert_eq!((grown.order, grown.promised[2]), (1.0, 0.2 * SAFETY_WITHOUT_ORDER));
        assert_eq!(of_two(0.1, 2.0, 1.0), 0.1 * SAFETY);
        // Better than is believed.
        assert_eq!(Estimate::of(&[4.0, 2.0, 1.0], &[0.3, 0.1], 1.0).expect("three runs").order, 1.0);
        // So much better that it shows nothing.
        let lucky = Estimate::of(&[4.0, 2.0, 1.0], &[1.0, 0.01], 2.0).expect("three runs");
        assert_eq!((lucky.order, lucky.promised[2]), (1.0, 0.01 * SAFETY_WITHOUT_ORDER));
    }
}
