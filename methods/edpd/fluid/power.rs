//! Powers in a form that a compiler turns into vectors: no branch, no table, the same bits on every processor.

/// 1.5 times 2^52: added and taken away, it rounds to a whole number.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Rounds to the nearest whole number, up to 2^51.
#[inline(always)]
pub fn round(x: f64) -> f64 {
    (x + ROUND) - ROUND
}

/// Mantissa in [1/root 2, root 2) and exponent of two of a number that is not negative; of the least one for zero.
#[inline(always)]
pub fn parts(base: f64) -> (f64, f64) {
    let bits = base.max(f64::MIN_POSITIVE).to_bits();
    // Mantissa in [1/root 2, root 2), and its power of two as bits.
    let shifted = bits.wrapping_sub(0x3fe6_a09e_667f_3bcd);
    let whole = shifted & 0xfff0_0000_0000_0000;
    let mantissa = f64::from_bits(bits.wrapping_sub(whole));
    // The power of two as a number: its bits, less the sign's two's complement, in the mantissa of a large number.
    let count =
        f64::from_bits(((whole >> 52).wrapping_add(0x800) & 0xfff) | 0x4330_0000_0000_0000) - 4_503_599_627_372_544.0;
    (mantissa, count)
}

/// `base` in [0, 1] to the power `exponent`, 0 to 80; zero for a base of zero. `count` is its exponent of two, `z` is
/// `(m - 1)/(m + 1)` of its mantissa `m` ([`parts`]): a caller with other divisions at hand makes one of all. The logarithm is
/// good to 1e-9, the exponential to 1e-8: what only friction feels, whose balance with noise holds for any weight.
#[inline(always)]
pub fn raise(base: f64, (count, z): (f64, f64), exponent: f64) -> f64 {
    let z2 = z * z;
    let series = 1.0 + z2 * (1.0 / 3.0 + z2 * (0.2 + z2 * (1.0 / 7.0 + z2 * (1.0 / 9.0))));
    let binary = count + z * series * (2.0 * std::f64::consts::LOG2_E);
    let wanted = (binary * exponent).max(-1000.0);
    let nearest = wanted + ROUND;
    let rest = (wanted - (nearest - ROUND)) * std::f64::consts::LN_2;
    let cubic = 1.0 / 6.0 + rest * (1.0 / 24.0 + rest * (1.0 / 120.0 + rest * (1.0 / 720.0 + rest * (1.0 / 5040.0))));
    let fraction = 1.0 + rest * (1.0 + rest * (0.5 + rest * cubic));
    let scale = f64::from_bits(nearest.to_bits().wrapping_add(1023) << 52);
    if base > 0.0 { fraction * scale } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_library() {
        for k in 0..=2000 {
            let base = f64::from(k) / 2000.0;
            for exponent in [0.0, 0.0068, 0.5, 0.78, 1.0, 2.0, 2.6146, 10.0, 80.0] {
                let (mantissa, count) = parts(base);
                let own = raise(base, (count, (mantissa - 1.0) / (mantissa + 1.0)), exponent);
                let library = base.powf(exponent);
                let expected = if base == 0.0 { 0.0 } else { library };
                // As the words say: the absolute error of the logarithm comes times the exponent.
                let error = 1e-8 + 1e-9 * exponent;
                assert!((own - expected).abs() <= error * expected, "{base}^{exponent}: {own} {expected}");
            }
        }
        for x in [-2.5, -0.4, 0.0, 0.6, 7.49, 1e6] {
            assert_eq!(round(x), f64::round_ties_even(x));
        }
    }
}
