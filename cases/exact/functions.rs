//! Error functions without overflow, and bisection to the last bit.

use std::f64::consts::PI;

/// From here on the series beats the product: its eighth term is below 1e-17.
const ASYMPTOTIC_FROM: f64 = 25.0;

/// exp(x^2) erfc(x) for x >= 0, without overflow or underflow (Abramowitz and Stegun 7.1.23 for large x).
pub(super) fn erfcx(x: f64) -> f64 {
    if x.is_infinite() {
        return 0.0;
    }
    if x < ASYMPTOTIC_FROM {
        // The rounding error of x^2 would be magnified by x^2 itself.
        let square = x * x;
        let rounding = x.mul_add(x, -square);
        return libm::erfc(x) * libm::exp(square) * (1.0 + rounding);
    }
    let ratio = 0.5 / (x * x);
    let mut sum = 1.0;
    for odd in [13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
        sum = 1.0 - odd * ratio * sum;
    }
    sum / (x * PI.sqrt())
}

/// erfc(x) / erfc(z) for x >= z >= 0, also where both underflow.
pub(super) fn erfc_ratio(x: f64, z: f64) -> f64 {
    let decay = libm::exp((z - x) * (z + x));
    if decay == 0.0 { 0.0 } else { decay * erfcx(x) / erfcx(z) }
}

/// The positive number below which a decreasing function is positive: a bracket by doubling from `start`, then
/// bisection until no number lies between.
pub(super) fn decreasing_root(start: f64, function: impl Fn(f64) -> f64) -> Option<f64> {
    let (mut low, mut high) = (start, start);
    while function(low) < 0.0 {
        low *= 0.5;
        if low < 1e-200 {
            return None;
        }
    }
    while function(high) > 0.0 {
        high *= 2.0;
        if high > 1e200 {
            return None;
        }
    }
    loop {
        let middle = low + 0.5 * (high - low);
        if middle <= low || middle >= high {
            return Some(middle);
        }
        if function(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn erfcx_agrees_with_values_of_fifty_digits() {
        // Values computed with arbitrary precision; the tolerance is a few units in the last place.
        let rows = [
            (0.0, 1.0),
            (0.5, 0.615_690_344_192_925_9),
            (1.0, 0.427_583_576_155_807),
            (2.0, 0.255_395_676_310_505_74),
            (5.0, 0.110_704_637_733_068_63),
            (10.0, 0.056_140_992_743_822_59),
            (15.0, 0.037_529_606_388_505_76),
            (100.0, 0.005_641_613_782_989_433),
        ];
        for (x, expected) in rows {
            assert!((erfcx(x) / expected - 1.0).abs() < 2e-15, "erfcx({x}) = {}", erfcx(x));
        }
        let below = erfcx(ASYMPTOTIC_FROM.next_down());
        assert!((erfcx(ASYMPTOTIC_FROM) / below - 1.0).abs() < 2e-15, "the two forms meet");
    }

    #[test]
    fn ratios_are_finite_in_the_far_tail() {
        assert_eq!(erfc_ratio(1e6, 1.0), 0.0);
        assert_eq!(erfc_ratio(f64::INFINITY, 1.0), 0.0);
        let deep = erfc_ratio(40.0, 39.9);
        assert!(deep > 0.0 && deep < 1.0, "{deep}");
    }
}
