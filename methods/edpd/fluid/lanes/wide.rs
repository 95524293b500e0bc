//! Places in vectors of AVX2 and of AVX-512.

use std::arch::x86_64::{
    __m256, __m256i, __m512, __m512i, _CMP_LT_OQ, _mm_loadl_epi64, _mm256_add_epi32, _mm256_add_ps, _mm256_cmp_ps,
    _mm256_cvtepu8_epi32, _mm256_loadu_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_epi32, _mm256_set1_ps,
    _mm256_storeu_si256, _mm256_sub_ps, _mm512_add_epi32, _mm512_add_ps, _mm512_loadu_ps, _mm512_mask_cmp_ps_mask,
    _mm512_maskz_compress_epi32, _mm512_mul_ps, _mm512_set1_epi32, _mm512_set1_ps, _mm512_setr_epi32,
    _mm512_storeu_si512, _mm512_sub_ps,
};

use super::{GROUP, Lanes, PACKED};

/// By the instructions of AVX2, which a caller must know to be there.
#[derive(Debug, Clone, Copy)]
pub struct Eight(__m256);

impl Lanes for Eight {
    type Numbers = __m256i;

    const COUNT: usize = GROUP;

    #[inline(always)]
    fn splat(number: f32) -> Self {
        // SAFETY: the processor has these instructions (see the type).
        Eight(unsafe { _mm256_set1_ps(number) })
    }

    #[inline(always)]
    unsafe fn load(first: *const f32) -> Self {
        // SAFETY: as above; the caller has seen to the rest.
        Eight(unsafe { _mm256_loadu_ps(first) })
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        // SAFETY: as above.
        Eight(unsafe { _mm256_sub_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        // SAFETY: as above.
        Eight(unsafe { _mm256_mul_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        // SAFETY: as above.
        Eight(unsafe { _mm256_add_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn below(self, other: Self, among: u32) -> u32 {
        // SAFETY: as above.
        among & unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)) }.cast_unsigned()
    }

    #[inline(always)]
    fn numbers(first: usize) -> __m256i {
        // SAFETY: as above.
        unsafe { _mm256_set1_epi32(first as i32) }
    }

    #[inline(always)]
    fn after(numbers: __m256i) -> __m256i {
        // SAFETY: as above.
        unsafe { _mm256_add_epi32(numbers, _mm256_set1_epi32(Self::COUNT as i32)) }
    }

    #[inline(always)]
    unsafe fn note(among: u32, numbers: __m256i, first: *mut u32) {
        let packed = &PACKED[among as usize % PACKED.len()];
        // SAFETY: as above; a set of the table has eight numbers, and the caller has seen to the rest.
        unsafe {
            let lanes = _mm256_cvtepu8_epi32(_mm_loadl_epi64(packed.as_ptr().cast()));
            _mm256_storeu_si256(first.cast(), _mm256_add_epi32(lanes, numbers));
        }
    }
}

/// By the instructions of AVX-512, which a caller must know to be there.
#[derive(Debug, Clone, Copy)]
pub struct Sixteen(__m512);

impl Lanes for Sixteen {
    type Numbers = __m512i;

    const COUNT: usize = 16;

    #[inline(always)]
    fn splat(number: f32) -> Self {
        // SAFETY: the processor has these instructions (see the type).
        Sixteen(unsafe { _mm512_set1_ps(number) })
    }

    #[inline(always)]
    unsafe fn load(first: *const f32) -> Self {
        // SAFETY: as above; the caller has seen to the rest.
        Sixteen(unsafe { _mm512_loadu_ps(first) })
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        // SAFETY: as above.
        Sixteen(unsafe { _mm512_sub_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        // SAFETY: as above.
        Sixteen(unsafe { _mm512_mul_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        // SAFETY: as above.
        Sixteen(unsafe { _mm512_add_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn below(self, other: Self, among: u32) -> u32 {
        // SAFETY: as above.
        u32::from(unsafe { _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(among as u16, self.0, other.0) })
    }

    #[inline(always)]
    fn numbers(first: usize) -> __m512i {
        // SAFETY: as above.
        unsafe {
            let lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            _mm512_add_epi32(lanes, _mm512_set1_epi32(first as i32))
        }
    }

    #[inline(always)]
    fn after(numbers: __m512i) -> __m512i {
        // SAFETY: as above.
        unsafe { _mm512_add_epi32(numbers, _mm512_set1_epi32(Self::COUNT as i32)) }
    }

    #[inline(always)]
    unsafe fn note(among: u32, numbers: __m512i, first: *mut u32) {
        // SAFETY: as above; the caller has seen to the rest.
        unsafe { _mm512_storeu_si512(first.cast(), _mm512_maskz_compress_epi32(among as u16, numbers)) }
    }
}
