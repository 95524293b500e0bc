//! Four numbers at once, in double precision and in single: what the pairs of a particle with four others need.
//!
//! All ways give the same bits: sums with products are fused, and the sum of all four is that of the first and third and of the
//! second and fourth.

/// Four numbers in double precision.
pub trait Quad: Copy {
    /// Four numbers in single precision.
    type Single: Copy;

    /// The same number four times.
    fn splat(number: f64) -> Self;
    /// Four numbers.
    fn load(numbers: &[f64; 4]) -> Self;
    /// Writes them down.
    fn store(self, numbers: &mut [f64; 4]);
    /// Sums.
    fn plus(self, other: Self) -> Self;
    /// Differences.
    fn minus(self, other: Self) -> Self;
    /// Products.
    fn times(self, other: Self) -> Self;
    /// `self * by + to`, rounded once.
    fn times_plus(self, by: Self, to: Self) -> Self;
    /// `to - self * by`, rounded once.
    fn times_from(self, by: Self, to: Self) -> Self;
    /// One of them, four times.
    fn one<const LANE: usize>(self) -> Self;
    /// Those after one of them; zeros in place of it and of those before.
    fn after<const LANE: usize>(self) -> Self;
    /// The sum of all, four times.
    fn sum(self) -> Self;
    /// The first of them.
    fn first(self) -> f64;
    /// Rows for columns.
    fn turned(rows: [Self; 4]) -> [Self; 4];
    /// In single precision.
    fn single(self) -> Self::Single;
    /// In double precision.
    fn wide(single: &[f32; 4]) -> Self;

    /// The same number four times.
    fn single_splat(number: f32) -> Self::Single;
    /// Four numbers.
    fn single_load(numbers: &[f32; 4]) -> Self::Single;
    /// Writes them down.
    fn single_store(single: Self::Single, numbers: &mut [f32; 4]);
    /// Sums.
    fn single_plus(a: Self::Single, b: Self::Single) -> Self::Single;
    /// Rows for columns.
    fn single_turned(rows: [Self::Single; 4]) -> [Self::Single; 4];
}

impl Quad for [f64; 4] {
    type Single = [f32; 4];

    #[inline(always)]
    fn splat(number: f64) -> Self {
        [number; 4]
    }

    #[inline(always)]
    fn load(numbers: &[f64; 4]) -> Self {
        *numbers
    }

    #[inline(always)]
    fn store(self, numbers: &mut [f64; 4]) {
        *numbers = self;
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        std::array::from_fn(|lane| self[lane] + other[lane])
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        std::array::from_fn(|lane| self[lane] - other[lane])
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        std::array::from_fn(|lane| self[lane] * other[lane])
    }

    #[inline(always)]
    fn times_plus(self, by: Self, to: Self) -> Self {
        std::array::from_fn(|lane| self[lane].mul_add(by[lane], to[lane]))
    }

    #[inline(always)]
    fn times_from(self, by: Self, to: Self) -> Self {
        std::array::from_fn(|lane| (-self[lane]).mul_add(by[lane], to[lane]))
    }

    #[inline(always)]
    fn one<const LANE: usize>(self) -> Self {
        [self[LANE]; 4]
    }

    #[inline(always)]
    fn after<const LANE: usize>(self) -> Self {
        std::array::from_fn(|lane| if lane > LANE { self[lane] } else { 0.0 })
    }

    #[inline(always)]
    fn sum(self) -> Self {
        [(self[0] + self[2]) + (self[1] + self[3]); 4]
    }

    #[inline(always)]
    fn first(self) -> f64 {
        self[0]
    }

    #[inline(always)]
    fn turned(rows: [Self; 4]) -> [Self; 4] {
        std::array::from_fn(|column| std::array::from_fn(|row| rows[row][column]))
    }

    #[inline(always)]
    fn single(self) -> [f32; 4] {
        self.map(|number| number as f32)
    }

    #[inline(always)]
    fn wide(single: &[f32; 4]) -> Self {
        single.map(f64::from)
    }

    #[inline(always)]
    fn single_splat(number: f32) -> [f32; 4] {
        [number; 4]
    }

    #[inline(always)]
    fn single_load(numbers: &[f32; 4]) -> [f32; 4] {
        *numbers
    }

    #[inline(always)]
    fn single_store(single: [f32; 4], numbers: &mut [f32; 4]) {
        *numbers = single;
    }

    #[inline(always)]
    fn single_plus(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        std::array::from_fn(|lane| a[lane] + b[lane])
    }

    #[inline(always)]
    fn single_turned(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
        std::array::from_fn(|column| std::array::from_fn(|row| rows[row][column]))
    }
}

#[cfg(target_arch = "x86_64")]
pub use wide::Wide;

#[cfg(target_arch = "x86_64")]
mod wide {
    use std::arch::x86_64::{
        __m128, __m256d, _mm_add_ps, _mm_loadu_ps, _mm_movehl_ps, _mm_movelh_ps, _mm_set1_ps, _mm_storeu_ps,
        _mm_unpackhi_ps, _mm_unpacklo_ps, _mm256_add_pd, _mm256_blend_pd, _mm256_cvtpd_ps, _mm256_cvtps_pd,
        _mm256_cvtsd_f64, _mm256_fmadd_pd, _mm256_fnmadd_pd, _mm256_loadu_pd, _mm256_mul_pd, _mm256_permute_pd,
        _mm256_permute2f128_pd, _mm256_permute4x64_pd, _mm256_set1_pd, _mm256_setzero_pd, _mm256_storeu_pd,
        _mm256_sub_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd,
    };

    use super::Quad;

    /// By the instructions of AVX2 and fused products, which a caller must know to be there.
    #[derive(Debug, Clone, Copy)]
    pub struct Wide(__m256d);

    impl Quad for Wide {
        type Single = __m128;

        #[inline(always)]
        fn splat(number: f64) -> Self {
            // SAFETY: the processor has these instructions (see the type); what is read and written is as long as that.
            Wide(unsafe { _mm256_set1_pd(number) })
        }

        #[inline(always)]
        fn load(numbers: &[f64; 4]) -> Self {
            // SAFETY: as above.
            Wide(unsafe { _mm256_loadu_pd(numbers.as_ptr()) })
        }

        #[inline(always)]
        fn store(self, numbers: &mut [f64; 4]) {
            // SAFETY: as above.
            unsafe { _mm256_storeu_pd(numbers.as_mut_ptr(), self.0) }
        }

        #[inline(always)]
        fn plus(self, other: Self) -> Self {
            // SAFETY: as above.
            Wide(unsafe { _mm256_add_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn minus(self, other: Self) -> Self {
            // SAFETY: as above.
            Wide(unsafe { _mm256_sub_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn times(self, other: Self) -> Self {
            // SAFETY: as above.
            Wide(unsafe { _mm256_mul_pd(self.0, other.0) })
        }

        #[inline(always)]
        fn times_plus(self, by: Self, to: Self) -> Self {
            // SAFETY: as above.
            Wide(unsafe { _mm256_fmadd_pd(self.0, by.0, to.0) })
        }

        #[inline(always)]
        fn times_from(self, by: Self, to: Self) -> Self {
            // SAFETY: as above.
            Wide(unsafe { _mm256_fnmadd_pd(self.0, by.0, to.0) })
        }

        #[inline(always)]
        fn one<const LANE: usize>(self) -> Self {
            // SAFETY: as above.
            Wide(unsafe {
                match LANE {
                    0 => _mm256_permute4x64_pd::<0x00>(self.0),
                    1 => _mm256_permute4x64_pd::<0x55>(self.0),
                    2 => _mm256_permute4x64_pd::<0xaa>(self.0),
                    _ => _mm256_permute4x64_pd::<0xff>(self.0),
                }
            })
        }

        #[inline(always)]
        fn after<const LANE: usize>(self) -> Self {
            // SAFETY: as above.
            Wide(unsafe {
                match LANE {
                    0 => _mm256_blend_pd::<0b0001>(self.0, _mm256_setzero_pd()),
                    1 => _mm256_blend_pd::<0b0011>(self.0, _mm256_setzero_pd()),
                    2 => _mm256_blend_pd::<0b0111>(self.0, _mm256_setzero_pd()),
                    _ => _mm256_setzero_pd(),
                }
            })
        }

        #[inline(always)]
        fn sum(self) -> Self {
            // SAFETY: as above.
            unsafe {
                let halves = _mm256_add_pd(self.0, _mm256_permute2f128_pd::<1>(self.0, self.0));
                Wide(_mm256_add_pd(halves, _mm256_permute_pd::<0b0101>(halves)))
            }
        }

        #[inline(always)]
        fn first(self) -> f64 {
            // SAFETY: as above.
            unsafe { _mm256_cvtsd_f64(self.0) }
        }

        #[inline(always)]
        fn turned([a, b, c, d]: [Self; 4]) -> [Self; 4] {
            // SAFETY: as above.
            unsafe {
                let (ab_even, ab_odd) = (_mm256_unpacklo_pd(a.0, b.0), _mm256_unpackhi_pd(a.0, b.0));
                let (cd_even, cd_odd) = (_mm256_unpacklo_pd(c.0, d.0), _mm256_unpackhi_pd(c.0, d.0));
                [
                    Wide(_mm256_permute2f128_pd::<0x20>(ab_even, cd_even)),
                    Wide(_mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd)),
                    Wide(_mm256_permute2f128_pd::<0x31>(ab_even, cd_even)),
                    Wide(_mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd)),
                ]
            }
        }

        #[inline(always)]
        fn single(self) -> __m128 {
            // SAFETY: as above.
            unsafe { _mm256_cvtpd_ps(self.0) }
        }

        #[inline(always)]
        fn wide(single: &[f32; 4]) -> Self {
            // SAFETY: as above.
            Wide(unsafe { _mm256_cvtps_pd(_mm_loadu_ps(single.as_ptr())) })
        }

        #[inline(always)]
        fn single_splat(number: f32) -> __m128 {
            // SAFETY: as above.
            unsafe { _mm_set1_ps(number) }
        }

        #[inline(always)]
        fn single_load(numbers: &[f32; 4]) -> __m128 {
            // SAFETY: as above.
            unsafe { _mm_loadu_ps(numbers.as_ptr()) }
        }

        #[inline(always)]
        fn single_store(single: __m128, numbers: &mut [f32; 4]) {
            // SAFETY: as above.
            unsafe { _mm_storeu_ps(numbers.as_mut_ptr(), single) }
        }

        #[inline(always)]
        fn single_plus(a: __m128, b: __m128) -> __m128 {
            // SAFETY: as above.
            unsafe { _mm_add_ps(a, b) }
        }

        #[inline(always)]
        fn single_turned([a, b, c, d]: [__m128; 4]) -> [__m128; 4] {
            // SAFETY: as above.
            unsafe {
                let (ab_low, ab_high) = (_mm_unpacklo_ps(a, b), _mm_unpackhi_ps(a, b));
                let (cd_low, cd_high) = (_mm_unpacklo_ps(c, d), _mm_unpackhi_ps(c, d));
                [
                    _mm_movelh_ps(ab_low, cd_low),
                    _mm_movehl_ps(cd_low, ab_low),
                    _mm_movelh_ps(ab_high, cd_high),
                    _mm_movehl_ps(cd_high, ab_high),
                ]
            }
        }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use frazil_core::instruction_set::InstructionSet;
    use proptest::prelude::*;

    use super::*;

    /// Whether numbers are the same to the last bit.
    fn bits(numbers: [f64; 4]) -> [u64; 4] {
        numbers.map(f64::to_bits)
    }

    /// What a way makes of twelve numbers and four in single precision.
    fn made<Q: Quad>(rows: [[f64; 4]; 4], singles: [[f32; 4]; 4]) -> (Vec<[u64; 4]>, Vec<[u32; 4]>) {
        let [a, b, c, d] = rows.each_ref().map(Q::load);
        let mut all = vec![a.plus(b), a.minus(b), a.times(b), a.times_plus(b, c), a.times_from(b, c), a.sum()];
        all.extend([a.one::<0>(), a.one::<1>(), a.one::<2>(), a.one::<3>(), Q::splat(a.first()), Q::wide(&singles[0])]);
        all.extend([a.after::<0>(), a.after::<1>(), a.after::<2>(), a.after::<3>()]);
        all.extend(Q::turned([a, b, c, d]));
        let [e, f, g, h] = singles.each_ref().map(Q::single_load);
        let mut some = vec![Q::single_plus(e, f), a.single(), Q::single_splat(singles[0][0])];
        some.extend(Q::single_turned([e, f, g, h]));
        let stored = |quad: Q| {
            let mut numbers = [0.0; 4];
            quad.store(&mut numbers);
            bits(numbers)
        };
        let stored_single = |single: Q::Single| {
            let mut numbers = [0.0; 4];
            Q::single_store(single, &mut numbers);
            numbers.map(f32::to_bits)
        };
        (all.into_iter().map(stored).collect(), some.into_iter().map(stored_single).collect())
    }

    proptest! {
        #[test]
        fn both_ways_make_the_same(
            rows in prop::array::uniform4(prop::array::uniform4(-1e9_f64..1e9)),
            singles in prop::array::uniform4(prop::array::uniform4(-1e9_f32..1e9)),
        ) {
            if InstructionSet::widest() >= InstructionSet::Avx2 {
                prop_assert_eq!(made::<[f64; 4]>(rows, singles), made::<Wide>(rows, singles));
            }
        }
    }
}
