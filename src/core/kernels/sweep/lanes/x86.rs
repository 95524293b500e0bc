//! Numbers side by side in the registers of AVX2 and AVX-512.

use std::arch::x86_64::{
    __m256d, __m512d, _mm_cvtsd_f64, _mm_load_sd, _mm_loadu_pd, _mm_setzero_pd, _mm_storeu_pd, _mm256_add_pd,
    _mm256_castpd256_pd128, _mm256_cvtsd_f64, _mm256_extractf128_pd, _mm256_fmadd_pd, _mm256_loadu_pd, _mm256_max_pd,
    _mm256_min_pd, _mm256_mul_pd, _mm256_permute2f128_pd, _mm256_permute4x64_pd, _mm256_set_m128d, _mm256_set1_pd,
    _mm256_setzero_pd, _mm256_shuffle_pd, _mm256_storeu_pd, _mm256_sub_pd, _mm512_add_pd, _mm512_alignr_epi64,
    _mm512_castpd_si512, _mm512_castsi512_pd, _mm512_fmadd_pd, _mm512_loadu_pd, _mm512_mask_storeu_pd,
    _mm512_maskz_loadu_pd, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd, _mm512_permutexvar_pd, _mm512_set1_pd,
    _mm512_setr_epi64, _mm512_storeu_pd, _mm512_sub_pd,
};

use super::{LANES, Lanes};

/// In one register, by AVX-512.
#[derive(Clone, Copy)]
pub(in super::super) struct Avx512(__m512d);

/// The eight numbers from the one at place `from` on, of which `first` has the first eight and `second` those behind.
#[inline]
#[target_feature(enable = "avx512f")]
fn eight_from(first: __m512d, second: __m512d, from: usize) -> __m512d {
    macro_rules! align {
        ($by:literal) => {{
            let (low, high) = (_mm512_castpd_si512(first), _mm512_castpd_si512(second));
            _mm512_castsi512_pd(_mm512_alignr_epi64::<$by>(high, low))
        }};
    }
    match from {
        0 => first,
        1 => align!(1),
        2 => align!(2),
        3 => align!(3),
        4 => align!(4),
        5 => align!(5),
        6 => align!(6),
        7 => align!(7),
        _ => second,
    }
}

/// A bit for each of the first numbers, of which there are so many.
#[inline(always)]
fn first(count: usize) -> u8 {
    (1 << count.min(LANES - 1)) - 1
}

impl Lanes for Avx512 {
    type Factor = __m512d;

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn factor(value: f64) -> __m512d {
        _mm512_set1_pd(value)
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: there are as many numbers as are read.
        Avx512(unsafe { _mm512_loadu_pd(from) })
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn store(self, into: *mut f64) {
        // SAFETY: there is room for as many numbers as are written.
        unsafe { _mm512_storeu_pd(into, self.0) }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn load_some(from: &[f64]) -> Self {
        // SAFETY: no more numbers are read than there are.
        Avx512(unsafe { _mm512_maskz_loadu_pd(first(from.len()), from.as_ptr()) })
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn store_some(self, into: &mut [f64]) {
        // SAFETY: no more numbers are written than there is room for.
        unsafe { _mm512_mask_storeu_pd(into.as_mut_ptr(), first(into.len()), self.0) }
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn plus(self, other: Self) -> Self {
        Avx512(_mm512_add_pd(self.0, other.0))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn minus(self, other: Self) -> Self {
        Avx512(_mm512_sub_pd(self.0, other.0))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn less(self, number: __m512d) -> Self {
        Avx512(_mm512_sub_pd(self.0, number))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn lesser(self, number: __m512d) -> Self {
        Avx512(_mm512_min_pd(self.0, number))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn greater(self, number: __m512d) -> Self {
        Avx512(_mm512_max_pd(self.0, number))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn reversed(self) -> Self {
        Avx512(_mm512_permutexvar_pd(_mm512_setr_epi64(7, 6, 5, 4, 3, 2, 1, 0), self.0))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn times(self, factor: __m512d) -> Self {
        Avx512(_mm512_mul_pd(self.0, factor))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn times_plus(self, factor: __m512d, sum: Self) -> Self {
        Avx512(_mm512_fmadd_pd(self.0, factor, sum.0))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn from_before<const BY: usize>(before: Self, here: Self) -> Self {
        Avx512(eight_from(before.0, here.0, LANES - BY))
    }

    #[inline]
    #[target_feature(enable = "avx512f")]
    unsafe fn from_after<const BY: usize>(here: Self, after: Self) -> Self {
        Avx512(eight_from(here.0, after.0, BY))
    }
}

/// In one register of AVX2: half as many at once leave room for all column sums of short stencils.
#[derive(Clone, Copy)]
pub(in super::super) struct Four(__m256d);

impl Lanes for Four {
    type Factor = __m256d;

    const WIDTH: usize = LANES / 2;

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn factor(value: f64) -> __m256d {
        _mm256_set1_pd(value)
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: there are as many numbers as are read.
        Four(unsafe { _mm256_loadu_pd(from) })
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn store(self, into: *mut f64) {
        // SAFETY: there is room for as many numbers as are written.
        unsafe { _mm256_storeu_pd(into, self.0) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn load_some(from: &[f64]) -> Self {
        Four(some_of_four(from))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn store_some(self, into: &mut [f64]) {
        store_some_of_four(self.0, into);
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn plus(self, other: Self) -> Self {
        Four(_mm256_add_pd(self.0, other.0))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn minus(self, other: Self) -> Self {
        Four(_mm256_sub_pd(self.0, other.0))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn less(self, number: __m256d) -> Self {
        Four(_mm256_sub_pd(self.0, number))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn lesser(self, number: __m256d) -> Self {
        Four(_mm256_min_pd(self.0, number))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn greater(self, number: __m256d) -> Self {
        Four(_mm256_max_pd(self.0, number))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn reversed(self) -> Self {
        Four(_mm256_permute4x64_pd::<0b00_01_10_11>(self.0))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn times(self, factor: __m256d) -> Self {
        Four(_mm256_mul_pd(self.0, factor))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn times_plus(self, factor: __m256d, sum: Self) -> Self {
        Four(_mm256_fmadd_pd(self.0, factor, sum.0))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn from_before<const BY: usize>(before: Self, here: Self) -> Self {
        Four(four_from([before.0, here.0], Self::WIDTH - BY))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn from_after<const BY: usize>(here: Self, after: Self) -> Self {
        Four(four_from([here.0, after.0], BY))
    }
}

/// In two registers, by AVX2 and the fused products that came with it.
#[derive(Clone, Copy)]
pub(in super::super) struct Avx2([Four; 2]);

/// The four numbers from the one at place `from` on, of four times as many as there are registers.
#[inline]
#[target_feature(enable = "avx2")]
fn four_from<const REGISTERS: usize>(numbers: [__m256d; REGISTERS], from: usize) -> __m256d {
    let low = numbers[from / 4];
    if from.is_multiple_of(4) {
        return low;
    }
    let high = numbers[from / 4 + 1];
    let middle = _mm256_permute2f128_pd::<0x21>(low, high);
    match from % 4 {
        1 => _mm256_shuffle_pd::<0b0101>(low, middle),
        2 => middle,
        _ => _mm256_shuffle_pd::<0b0101>(middle, high),
    }
}

/// Fewer than four numbers from memory, and zeros behind them.
#[inline]
#[target_feature(enable = "avx2")]
fn some_of_four(from: &[f64]) -> __m256d {
    // SAFETY: no more numbers are read than there are.
    unsafe {
        let start = from.as_ptr();
        match from.len() {
            0 => _mm256_setzero_pd(),
            1 => _mm256_set_m128d(_mm_setzero_pd(), _mm_load_sd(start)),
            2 => _mm256_set_m128d(_mm_setzero_pd(), _mm_loadu_pd(start)),
            _ => _mm256_set_m128d(_mm_load_sd(start.add(2)), _mm_loadu_pd(start)),
        }
    }
}

/// Fewer than four of the numbers into memory.
#[inline]
#[target_feature(enable = "avx2")]
fn store_some_of_four(numbers: __m256d, into: &mut [f64]) {
    let (low, high) = (_mm256_castpd256_pd128(numbers), _mm256_extractf128_pd::<1>(numbers));
    match into {
        [] => {}
        [first] => *first = _mm256_cvtsd_f64(numbers),
        [_, _] => {
            // SAFETY: there is room for two numbers.
            unsafe { _mm_storeu_pd(into.as_mut_ptr(), low) }
        }
        [.., third] => {
            *third = _mm_cvtsd_f64(high);
            // SAFETY: as above.
            unsafe { _mm_storeu_pd(into.as_mut_ptr(), low) }
        }
    }
}

impl Lanes for Avx2 {
    type Factor = __m256d;

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn factor(value: f64) -> __m256d {
        // SAFETY: as the caller says.
        unsafe { Four::factor(value) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: there are as many numbers as are read.
        Avx2(unsafe { [Four::load(from), Four::load(from.add(Four::WIDTH))] })
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn store(self, into: *mut f64) {
        // SAFETY: there is room for as many numbers as are written.
        unsafe {
            self.0[0].store(into);
            self.0[1].store(into.add(Four::WIDTH));
        }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn load_end(from: &[f64]) -> Self {
        match from.split_first_chunk::<{ LANES / 2 }>() {
            // SAFETY: there are as many numbers as are read.
            Some((low, rest)) => Avx2(unsafe { [Four::load(low.as_ptr()), Four::load_some(rest)] }),
            None => Avx2([Four(some_of_four(from)), Four(_mm256_setzero_pd())]),
        }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn store_end(self, into: &mut [f64]) {
        match into.split_first_chunk_mut::<{ LANES / 2 }>() {
            Some((low, rest)) => {
                // SAFETY: there is room for as many numbers as are written.
                unsafe {
                    self.0[0].store(low.as_mut_ptr());
                    self.0[1].store_some(rest);
                }
            }
            None => store_some_of_four(self.0[0].0, into),
        }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn plus(self, other: Self) -> Self {
        // SAFETY: as the caller says.
        unsafe { Avx2([self.0[0].plus(other.0[0]), self.0[1].plus(other.0[1])]) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn minus(self, other: Self) -> Self {
        // SAFETY: as the caller says.
        unsafe { Avx2([self.0[0].minus(other.0[0]), self.0[1].minus(other.0[1])]) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn less(self, number: __m256d) -> Self {
        // SAFETY: as the caller says.
        unsafe { Avx2([self.0[0].less(number), self.0[1].less(number)]) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn lesser(self, number: __m256d) -> Self {
        // SAFETY: as the caller says.
        unsafe { Avx2([self.0[0].lesser(number), self.0[1].lesser(number)]) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn greater(self, number: __m256d) -> Self {
        // SAFETY: as the caller says.
        unsafe { Avx2([self.0[0].greater(number), self.0[1].greater(number)]) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn reversed(self) -> Self {
        // SAFETY: as the caller says.
        unsafe { Avx2([self.0[1].reversed(), self.0[0].reversed()]) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn times(self, factor: __m256d) -> Self {
        // SAFETY: as the caller says.
        unsafe { Avx2([self.0[0].times(factor), self.0[1].times(factor)]) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn times_plus(self, factor: __m256d, sum: Self) -> Self {
        let Avx2([low, high]) = self;
        // SAFETY: as the caller says.
        unsafe { Avx2([low.times_plus(factor, sum.0[0]), high.times_plus(factor, sum.0[1])]) }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn from_before<const BY: usize>(before: Self, here: Self) -> Self {
        let sixteen = [before.0[0].0, before.0[1].0, here.0[0].0, here.0[1].0];
        Avx2([Four(four_from(sixteen, LANES - BY)), Four(four_from(sixteen, LANES + LANES / 2 - BY))])
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn from_after<const BY: usize>(here: Self, after: Self) -> Self {
        let sixteen = [here.0[0].0, here.0[1].0, after.0[0].0, after.0[1].0];
        Avx2([Four(four_from(sixteen, BY)), Four(four_from(sixteen, LANES / 2 + BY))])
    }
}
