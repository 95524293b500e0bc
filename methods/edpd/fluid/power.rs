//! Powers in a form that a compiler turns into vectors: no branch, no table, the same bits on every processor.

/// 1.5 times 2^23: added and taken away, it rounds to a whole number.
const ROUND_SINGLE: f32 = 12_582_912.0;

/// `log2((1 + z)/(1 - z))/z` over the square of `z`, up to root 2 for the quotient: through the Chebyshev points, to 1.2e-7.
const LOGARITHM: [f32; 3] = [0.595_759_6, 0.961_588_9, 2.885_390_5];

/// `2^x` from -1/2 to 1/2, in the same way, to 1e-7.
const POWER: [f32; 6] = [0.001_339_086_4, 0.009_676_032, 0.055_503_57, 0.240_221_07, std::f32::consts::LN_2, 1.0];

/// `base` in [0, 1] to the power `exponent`, 0 to 80; zero for a base of zero. In single precision: what only friction
/// feels, whose balance with noise holds for any weight.
#[inline(always)]
pub fn raise(base: f32, exponent: f32) -> f32 {
    let bits = base.max(f32::MIN_POSITIVE).to_bits();
    // Mantissa in [1/root 2, root 2), and its power of two as bits.
    let whole = bits.wrapping_sub(std::f32::consts::FRAC_1_SQRT_2.to_bits()) & 0xff80_0000;
    let mantissa = f32::from_bits(bits.wrapping_sub(whole));
    let count = (whole.cast_signed() >> 23) as f32;
    let z = (mantissa - 1.0) / (mantissa + 1.0);
    let binary = z.mul_add(series(z * z, LOGARITHM), count);
    // Below, single precision ends.
    let wanted = (binary * exponent).max(-126.0);
    let nearest = wanted + ROUND_SINGLE;
    let fraction = series(wanted - (nearest - ROUND_SINGLE), POWER);
    let scale = f32::from_bits(nearest.to_bits().wrapping_add(127) << 23);
    if base > 0.0 { fraction * scale } else { 0.0 }
}

/// A polynomial, its highest coefficient first.
#[inline(always)]
fn series<const N: usize>(x: f32, coefficients: [f32; N]) -> f32 {
    let mut sum = coefficients[0];
    for coefficient in &coefficients[1..] {
        sum = sum.mul_add(x, *coefficient);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_library() {
        for k in 0..=2000 {
            let base = k as f32 / 2000.0;
            for exponent in [0.0, 0.0068, 0.5, 0.78, 1.0, 2.0, 2.6146, 10.0, 80.0] {
                let own = f64::from(raise(base, exponent));
                let library = f64::from(base).powf(f64::from(exponent));
                let expected = if base == 0.0 { 0.0 } else { library };
                // Some last digits of the result, of the logarithm, times the exponent, and of what comes from cut series;
                // below 2^-126 there is nothing.
                let logarithm = if base > 0.0 { f64::from(base).log2().abs() } else { 0.0 };
                let error = f64::from(f32::EPSILON) * (4.0 + f64::from(exponent) * (2.0 + logarithm));
                assert!((own - expected).abs() <= error * expected + 2e-38, "{base}^{exponent}: {own} {expected}");
            }
        }
    }
}
