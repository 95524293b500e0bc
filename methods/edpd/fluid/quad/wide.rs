//! Four numbers in a vector of AVX2.

use std::arch::x86_64::{
    __m128, __m256d, _mm_add_ps, _mm_loadu_ps, _mm_movehl_ps, _mm_movelh_ps, _mm_set1_ps, _mm_storeu_ps,
    _mm_unpackhi_ps, _mm_unpacklo_ps, _mm256_add_pd, _mm256_blend_pd, _mm256_cvtpd_ps, _mm256_cvtps_pd,
    _mm256_cvtsd_f64, _mm256_fmadd_pd, _mm256_fnmadd_pd, _mm256_loadu_pd, _mm256_mul_pd, _mm256_permute_pd,
    _mm256_permute2f128_pd, _mm256_permute4x64_pd, _mm256_set1_pd, _mm256_setzero_pd, _mm256_storeu_pd, _mm256_sub_pd,
    _mm256_unpackhi_pd, _mm256_unpacklo_pd,
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
