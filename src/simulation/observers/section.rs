//! Where a wall begins and ends along a ray through it, and how it is in between.

use super::rays::{Ray, frozen_length};

/// Mean frozen length over rays (m), each for all that it stands for.
pub(super) fn mean_length(rays: &[Ray], fractions: &[f64]) -> f64 {
    let weights: usize = rays.iter().map(|ray| ray.multiplicity).sum();
    let lengths = rays.iter().map(|ray| ray.multiplicity as f64 * frozen_length(ray, fractions));
    lengths.sum::<f64>() / weights.max(1) as f64
}

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

/// Mean of what is read along a ray between two radii.
pub(super) fn mean(radii: &[f64], values: &[f64], (inner, outer): (f64, f64)) -> Option<f64> {
    let inside: Vec<f64> = radii
        .iter()
        .zip(values)
        .filter(|(radius, _)| (inner..=outer).contains(*radius))
        .map(|(_, value)| *value)
        .collect();
    (!inside.is_empty()).then(|| inside.iter().sum::<f64>() / inside.len() as f64)
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
}
