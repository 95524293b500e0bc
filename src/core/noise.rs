//! Counter-based random numbers: a function of seed, step and pair, never of thread or order.

/// Mixes a 64-bit word (the finaliser of splitmix64, Steele, Lea and Flood 2014).
#[inline(always)]
const fn mix(mut word: u64) -> u64 {
    word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

/// The random numbers of one step.
#[derive(Debug, Clone, Copy)]
pub struct StepNoise {
    key: u64,
}

impl StepNoise {
    /// Numbers of a step under a seed.
    pub fn new(seed: u64, step: u64) -> Self {
        StepNoise { key: mix(mix(seed.wrapping_add(0x9e37_79b9_7f4a_7c15)) ^ step.wrapping_mul(0xd1b5_4a32_d192_ed03)) }
    }

    /// Sixty-four random bits, the same for (i, j) and (j, i).
    #[inline(always)]
    pub fn word(&self, i: u32, j: u32, stream: u32) -> u64 {
        let (low, high) = if i < j { (i, j) } else { (j, i) };
        let pair = (u64::from(high) << 32) | u64::from(low);
        mix(mix(pair ^ self.key).wrapping_add(self.key.rotate_left(17) ^ u64::from(stream)))
    }

    /// Two independent numbers of zero mean and unit variance, uniform in [-sqrt 3, sqrt 3], of a pair whose names are the
    /// two halves of a word: of 32 bits each, in a form that a compiler turns into vectors.
    #[inline(always)]
    pub fn two(&self, pair: u64) -> (f64, f64) {
        let word = mix(mix(pair ^ self.key).wrapping_add(self.key.rotate_left(17)));
        // The bits as the mantissa of a number near 2^52, which is then taken away.
        let unit = |bits: u64| f64::from_bits(bits | 0x4330_0000_0000_0000) - 4_503_599_627_370_496.0 - 2_147_483_647.5;
        let scale = 3.464_101_615_137_754_6 / 4_294_967_296.0;
        (unit(word >> 32) * scale, unit(word & 0xffff_ffff) * scale)
    }

    /// A number of zero mean and unit variance, uniform in [-sqrt 3, sqrt 3], the same for (i, j) and (j, i).
    /// Uniform numbers serve schemes of first weak order as well as normal ones (Groot and Warren 1997).
    #[inline(always)]
    pub fn symmetric(&self, i: u32, j: u32, stream: u32) -> f64 {
        let word = self.word(i, j, stream);
        // 53 bits, centred: an odd multiple of 2^-54 in (0, 1).
        let unit = ((word >> 11) as f64 + 0.5) * (1.0 / (1u64 << 53) as f64);
        (unit - 0.5) * 3.464_101_615_137_754_6
    }

    /// The same with a sign that changes when i and j are exchanged; zero for a pair of one.
    #[inline(always)]
    pub fn antisymmetric(&self, i: u32, j: u32, stream: u32) -> f64 {
        let sign = f64::from(u8::from(i < j)) - f64::from(u8::from(j < i));
        sign * self.symmetric(i, j, stream)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_and_correlations_are_those_of_independent_uniform_numbers() {
        let (mut sum, mut square, mut fourth, mut count) = (0.0, 0.0, 0.0, 0.0);
        let (mut next_step, mut next_pair, mut next_seed, mut next_stream) = (0.0, 0.0, 0.0, 0.0);
        let mut bins = [0.0; 64];
        for step in 0..20 {
            let (noise, later, other) = (StepNoise::new(7, step), StepNoise::new(7, step + 1), StepNoise::new(8, step));
            for i in 0..20_000u32 {
                for j in [i + 1, i + 300] {
                    let x = noise.symmetric(i, j, 0);
                    sum += x;
                    square += x * x;
                    fourth += x * x * x * x;
                    next_step += x * later.symmetric(i, j, 0);
                    next_pair += x * noise.symmetric(i + 1, j + 1, 0);
                    next_seed += x * other.symmetric(i, j, 0);
                    next_stream += x * noise.symmetric(i, j, 1);
                    bins[((x / 3f64.sqrt() + 1.0) * 32.0) as usize] += 1.0;
                    count += 1.0;
                }
            }
        }
        // Four standard errors: of a product of unit variance, 1/sqrt(n); of x^2, sqrt(0.8/n); of x^4, sqrt(3.76/n).
        let error = 4.0 / f64::sqrt(count);
        for (what, value) in
            [("mean", sum), ("step", next_step), ("pair", next_pair), ("seed", next_seed), ("stream", next_stream)]
        {
            assert!((value / count).abs() < error, "{what}: {}", value / count);
        }
        assert!((square / count - 1.0).abs() < error);
        assert!((fourth / count - 1.8).abs() < 2.0 * error);
        let expected = count / 64.0;
        let chi: f64 = bins.iter().map(|bin: &f64| (bin - expected).powi(2) / expected).sum();
        // 63 degrees of freedom: 63 +- 4 sqrt(126).
        assert!((chi - 63.0).abs() < 45.0, "chi-square {chi}");
    }

    #[test]
    fn exchange_of_the_pair_keeps_or_turns_the_sign() {
        let noise = StepNoise::new(1, 2);
        for (i, j) in [(0, 1), (5, 3), (1_000_000, 7)] {
            assert_eq!(noise.symmetric(i, j, 3), noise.symmetric(j, i, 3));
            assert_eq!(noise.antisymmetric(i, j, 3), -noise.antisymmetric(j, i, 3));
        }
        assert_eq!(noise.antisymmetric(4, 4, 0), 0.0);
    }
}
