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
    /// Odd: what one word of a pair is from the next.
    stride: u64,
}

/// A number of zero mean and unit variance, uniform in [-sqrt 3, sqrt 3], of 32 random bits: in single precision, which what only
/// noise feels may have. Uniform numbers serve schemes of first weak order as well as normal ones (Groot and Warren 1997).
#[inline(always)]
fn uniform(bits: u32) -> f32 {
    bits.cast_signed() as f32 * (1.732_050_8 / 2_147_483_648.0)
}

impl StepNoise {
    /// Numbers of a step under a seed.
    pub fn new(seed: u64, step: u64) -> Self {
        let key = mix(mix(seed.wrapping_add(0x9e37_79b9_7f4a_7c15)) ^ step.wrapping_mul(0xd1b5_4a32_d192_ed03));
        StepNoise { key, stride: mix(key.wrapping_add(0x9e37_79b9_7f4a_7c15)) | 1 }
    }

    /// Sixty-four random bits of a pair whose names are the two halves of a word, the greater one first: splitmix64, whose
    /// place in its sequence is that word.
    #[inline(always)]
    fn word(&self, pair: u64) -> u64 {
        mix(pair.wrapping_mul(self.stride).wrapping_add(self.key))
    }

    /// Two independent numbers of zero mean and unit variance of a pair whose names are the two halves of a word, the
    /// greater one first, in a form that a compiler turns into vectors.
    #[inline(always)]
    pub fn two(&self, pair: u64) -> (f32, f32) {
        let word = self.word(pair);
        (uniform((word >> 32) as u32), uniform(word as u32))
    }

    /// One such number.
    #[inline(always)]
    pub fn one(&self, pair: u64) -> f32 {
        uniform((self.word(pair) >> 32) as u32)
    }

    /// One number with a sign that changes when i and j are exchanged; zero for a pair of one. That of the first stream is
    /// [`StepNoise::one`] where i is the smaller name.
    #[inline(always)]
    pub fn antisymmetric(&self, i: u32, j: u32, stream: u32) -> f32 {
        let sign = f32::from(u8::from(i < j)) - f32::from(u8::from(j < i));
        let stream = u64::from(stream).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let word = mix(pair_of(i, j).wrapping_mul(self.stride).wrapping_add(self.key ^ stream));
        sign * uniform((word >> 32) as u32)
    }
}

/// The two names of a pair as the halves of a word, the greater one first.
#[inline(always)]
pub const fn pair_of(i: u32, j: u32) -> u64 {
    let (low, high) = if i < j { (i, j) } else { (j, i) };
    ((high as u64) << 32) | low as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_and_correlations_are_those_of_independent_uniform_numbers() {
        let (mut sum, mut square, mut fourth, mut count) = (0.0, 0.0, 0.0, 0.0);
        let (mut next_step, mut next_pair, mut next_seed, mut next_stream) = (0.0, 0.0, 0.0, 0.0);
        let mut next_half = 0.0;
        let mut bins = [0.0; 64];
        for step in 0..20 {
            let (noise, later, other) = (StepNoise::new(7, step), StepNoise::new(7, step + 1), StepNoise::new(8, step));
            for i in 0..20_000u32 {
                for j in [i + 1, i + 300] {
                    let number = |noise: &StepNoise, i, j, stream| f64::from(noise.antisymmetric(i, j, stream));
                    let x = number(&noise, i, j, 0);
                    sum += x;
                    square += x * x;
                    fourth += x * x * x * x;
                    next_step += x * number(&later, i, j, 0);
                    next_pair += x * number(&noise, i + 1, j + 1, 0);
                    next_seed += x * number(&other, i, j, 0);
                    let (first, second) = noise.two(pair_of(i, j));
                    assert_eq!((x, x), (f64::from(first), f64::from(noise.one(pair_of(i, j)))));
                    next_half += x * f64::from(second);
                    next_stream += x * number(&noise, i, j, 1);
                    bins[((x / 3f64.sqrt() + 1.0) * 32.0) as usize] += 1.0;
                    count += 1.0;
                }
            }
        }
        // Four standard errors: of a product of unit variance, 1/sqrt(n); of x^2, sqrt(0.8/n); of x^4, sqrt(3.76/n).
        let error = 4.0 / f64::sqrt(count);
        for (what, value) in [
            ("mean", sum),
            ("step", next_step),
            ("pair", next_pair),
            ("seed", next_seed),
            ("stream", next_stream),
            ("half", next_half),
        ] {
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
    fn exchange_of_the_pair_turns_the_sign() {
        let noise = StepNoise::new(1, 2);
        for (i, j) in [(0, 1), (5, 3), (1_000_000, 7)] {
            assert_eq!(noise.antisymmetric(i, j, 3), -noise.antisymmetric(j, i, 3));
        }
        assert_eq!(noise.antisymmetric(4, 4, 0), 0.0);
    }
}
