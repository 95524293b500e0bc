//! Numbers side by side in the registers of AVX-512 and of AVX2.

use std::arch::x86_64::{
    __m256d, __m512d, __mmask8, _CMP_LT_OQ, _CMP_NEQ_UQ, _mm256_add_pd, _mm256_and_pd, _mm256_andnot_pd,
    _mm256_blendv_pd, _mm256_castsi256_pd, _mm256_cmp_pd, _mm256_div_pd, _mm256_loadu_pd, _mm256_movemask_pd,
    _mm256_mul_pd, _mm256_or_pd, _mm256_set1_epi64x, _mm256_set1_pd, _mm256_sqrt_pd, _mm256_storeu_pd, _mm256_sub_pd,
    _mm256_xor_pd, _mm512_abs_pd, _mm512_add_pd, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_loadu_pd,
    _mm512_loadu_si512, _mm512_mask_blend_pd, _mm512_mul_pd, _mm512_set1_pd, _mm512_sqrt_pd, _mm512_storeu_pd,
    _mm512_sub_pd, _mm512_test_epi64_mask,
};
use std::ops::{Add, BitAnd, Div, Mul, Not, Sub};

use super::{Flags, Kind, Numbers};

/// A processor with AVX-512.
#[derive(Debug, Clone, Copy)]
pub struct Avx512(());

impl Avx512 {
    /// # Safety
    /// The processor must have AVX-512 (`avx512f` and `avx512vl`).
    #[inline(always)]
    pub unsafe fn new() -> Self {
        Avx512(())
    }
}

/// Eight numbers in a register.
#[derive(Debug, Clone, Copy)]
pub struct Eight(__m512d);

/// A bit for each.
#[derive(Debug, Clone, Copy)]
pub struct Bits(__mmask8);

// SAFETY of all that follows: the kind, or the numbers that it has made, show that the instructions are there.
impl Kind<8> for Avx512 {
    type Numbers = Eight;
    type Flags = Bits;

    #[inline(always)]
    fn of(self, value: f64) -> Eight {
        // SAFETY: as above.
        Eight(unsafe { _mm512_set1_pd(value) })
    }

    #[inline(always)]
    fn load(self, from: &[f64; 8]) -> Eight {
        // SAFETY: as above, and there are eight.
        Eight(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, numbers: Eight, into: &mut [f64; 8]) {
        // SAFETY: as above, and there is room for eight.
        unsafe { _mm512_storeu_pd(into.as_mut_ptr(), numbers.0) }
    }

    #[inline(always)]
    fn flags(self, from: &[u64; 8]) -> Bits {
        // SAFETY: as above, and there are eight.
        Bits(unsafe {
            let bits = _mm512_loadu_si512(from.as_ptr().cast());
            _mm512_test_epi64_mask(bits, bits)
        })
    }
}

/// Implements operators of two operands.
macro_rules! eight {
    ($($operator:ident $name:ident $instruction:ident),*) => {
        $(impl $operator for Eight {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                // SAFETY: as above.
                Eight(unsafe { $instruction(self.0, other.0) })
            }
        })*
    };
}

eight!(Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd);

impl Numbers for Eight {
    type Flags = Bits;

    #[inline(always)]
    fn root(self) -> Self {
        // SAFETY: as above.
        Eight(unsafe { _mm512_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn size(self) -> Self {
        // SAFETY: as above.
        Eight(unsafe { _mm512_abs_pd(self.0) })
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> Bits {
        // SAFETY: as above.
        Bits(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, than.0) })
    }

    #[inline(always)]
    fn differs(self, from: Self) -> Bits {
        // SAFETY: as above.
        Bits(unsafe { _mm512_cmp_pd_mask::<_CMP_NEQ_UQ>(self.0, from.0) })
    }

    #[inline(always)]
    fn or(self, yes: Bits, others: Self) -> Self {
        // SAFETY: as above.
        Eight(unsafe { _mm512_mask_blend_pd(yes.0, others.0, self.0) })
    }
}

impl BitAnd for Bits {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Bits(self.0 & other.0)
    }
}

impl Not for Bits {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Bits(!self.0)
    }
}

impl Flags for Bits {
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != 0
    }

    #[inline(always)]
    fn bits(self) -> u64 {
        u64::from(self.0)
    }
}

/// A processor with AVX2.
#[derive(Debug, Clone, Copy)]
pub struct Avx2(());

impl Avx2 {
    /// # Safety
    /// The processor must have AVX2.
    #[inline(always)]
    pub unsafe fn new() -> Self {
        Avx2(())
    }
}

/// Twice four numbers in a register.
#[derive(Debug, Clone, Copy)]
pub struct Fours([__m256d; 2]);

/// All bits of each, or none.
#[derive(Debug, Clone, Copy)]
pub struct Masks([__m256d; 2]);

impl Kind<8> for Avx2 {
    type Numbers = Fours;
    type Flags = Masks;

    #[inline(always)]
    fn of(self, value: f64) -> Fours {
        // SAFETY: as above.
        Fours([unsafe { _mm256_set1_pd(value) }; 2])
    }

    #[inline(always)]
    fn load(self, from: &[f64; 8]) -> Fours {
        // SAFETY: as above, and there are twice four.
        Fours([0, 4].map(|first| unsafe { _mm256_loadu_pd(from.as_ptr().add(first)) }))
    }

    #[inline(always)]
    fn store(self, numbers: Fours, into: &mut [f64; 8]) {
        // SAFETY: as above, and there is room for twice four.
        unsafe {
            _mm256_storeu_pd(into.as_mut_ptr(), numbers.0[0]);
            _mm256_storeu_pd(into.as_mut_ptr().add(4), numbers.0[1]);
        }
    }

    #[inline(always)]
    fn flags(self, from: &[u64; 8]) -> Masks {
        // SAFETY: as above, and there are twice four.
        Masks([0, 4].map(|first| unsafe { _mm256_loadu_pd(from.as_ptr().cast::<f64>().add(first)) }))
    }
}

/// Implements operators of two operands.
macro_rules! fours {
    ($kind:ident: $($operator:ident $name:ident $instruction:ident),*) => {
        $(impl $operator for $kind {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                // SAFETY: as above.
                $kind([0, 1].map(|half| unsafe { $instruction(self.0[half], other.0[half]) }))
            }
        })*
    };
}

fours!(Fours: Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd);
fours!(Masks: BitAnd bitand _mm256_and_pd);

impl Numbers for Fours {
    type Flags = Masks;

    #[inline(always)]
    fn root(self) -> Self {
        // SAFETY: as above.
        Fours(self.0.map(|half| unsafe { _mm256_sqrt_pd(half) }))
    }

    #[inline(always)]
    fn size(self) -> Self {
        // SAFETY: as above.
        Fours(self.0.map(|half| unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), half) }))
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> Masks {
        // SAFETY: as above.
        Masks([0, 1].map(|half| unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0[half], than.0[half]) }))
    }

    #[inline(always)]
    fn differs(self, from: Self) -> Masks {
        // SAFETY: as above.
        Masks([0, 1].map(|half| unsafe { _mm256_cmp_pd::<_CMP_NEQ_UQ>(self.0[half], from.0[half]) }))
    }

    #[inline(always)]
    fn or(self, yes: Masks, others: Self) -> Self {
        // SAFETY: as above.
        Fours([0, 1].map(|half| unsafe { _mm256_blendv_pd(others.0[half], self.0[half], yes.0[half]) }))
    }
}

impl Not for Masks {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: as above.
        Masks(self.0.map(|half| unsafe { _mm256_xor_pd(half, _mm256_castsi256_pd(_mm256_set1_epi64x(-1))) }))
    }
}

impl Flags for Masks {
    #[inline(always)]
    fn any(self) -> bool {
        // SAFETY: as above.
        unsafe { _mm256_movemask_pd(_mm256_or_pd(self.0[0], self.0[1])) != 0 }
    }

    #[inline(always)]
    fn bits(self) -> u64 {
        // SAFETY: as above.
        let [low, high] = self.0.map(|half| unsafe { _mm256_movemask_pd(half) } as u64);
        low | high << 4
    }
}
