//! Where a wall begins and ends along a ray through it, and how it is in between.

/// First and last radius at which a ray is frozen; none where nothing is.
pub(super) fn ends(radii: &[f64], fraction: &[f64]) -> Option<(f64, f64)> {
    let first = fraction.iter().position(|f| *f >= 0.5)?;
    let last = fraction.iter().rposition(|f| *f >= 0.5)?;
    let between = |a: usize, b: usize| {
        let part = (0.5 - fraction[a]) / (fraction[b] - fraction[a]);
        radii[a] + part * (radii[b] - radii[a])
    };
    let inner = if first == 0 { radii[0] } else { between(first - 1, first) };
    let outer = if last + 1 == radii.len() { radii[last] } else { between(last, last + 1) };
    Some((inner, outer))
}

/// Ends of a wall that is read as too thick by some length (m), which lies at both; none where nothing is left.
pub(super) fn narrowed((inner, outer): (f64, f64), excess: f64) -> Option<(f64, f64)> {
    let (inner, outer) = (inner + 0.5 * excess, outer - 0.5 * excess);
    (inner < outer).then_some((inner, outer))
}

/// Mean of what is read along a ray between two radii, straight from each reading to the next.
pub(super) fn mean(radii: &[f64], values: &[f64], (inner, outer): (f64, f64)) -> Option<f64> {
    let pieces = radii.windows(2).zip(values.windows(2));
    let integrals = pieces.filter_map(|(radii, values)| {
        let (from, to) = (inner.max(radii[0]), outer.min(radii[1]));
        let middle = (0.5 * (from + to) - radii[0]) / (radii[1] - radii[0]);
        (from < to).then(|| (to - from, (to - from) * (values[0] + middle * (values[1] - values[0]))))
    });
    let (length, integral) = integrals.fold((0.0, 0.0), |sums, piece| (sums.0 + piece.0, sums.1 + piece.1));
    (length > 0.0).then(|| integral / length)
}

/// Readings along a ray, and between them along straight lines, so close that the field of a pipe is told by them.
pub(super) fn refined(radii: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    const PARTS: usize = 8;
    let between = |pair: &[f64]| {
        let (from, step) = (pair[0], (pair[1] - pair[0]) / PARTS as f64);
        (0..PARTS).map(move |part| from + part as f64 * step)
    };
    let fine = |all: &[f64]| all.windows(2).flat_map(between).chain(all.last().copied()).collect();
    (fine(radii), fine(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_lie_between_samples() {
        let radii = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(ends(&radii, &[0.0, 1.0, 1.0, 0.0]), Some((1.5, 3.5)));
        assert_eq!(ends(&radii, &[0.0; 4]), None);
        assert_eq!(ends(&radii, &[1.0, 0.0, 0.0, 1.0]), Some((1.0, 4.0)));
    }

    #[test]
    fn means_are_those_of_lines_from_reading_to_reading() {
        let (radii, values) = ([1.0, 2.0, 3.0, 4.0], [0.0, 2.0, 2.0, 0.0]);
        assert_eq!(mean(&radii, &values, (1.0, 4.0)), Some(4.0 / 3.0));
        assert_eq!(mean(&radii, &values, (1.5, 2.0)), Some(1.5));
        assert_eq!(mean(&radii, &values, (2.25, 2.5)), Some(2.0));
        assert_eq!(mean(&radii, &values, (2.0, 2.0)), None);
        let (fine, of_them) = refined(&radii, &values);
        assert_eq!((fine.len(), fine[0], fine[4], fine[24]), (25, 1.0, 1.5, 4.0));
        assert_eq!((of_them[4], of_them[12], of_them[20]), (1.0, 2.0, 1.0));
    }
}
