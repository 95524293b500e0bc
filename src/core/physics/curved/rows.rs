//! Potentials along a freezing curve by AVX2, whose gathers take longer than whole rows of two nodes that are turned into columns.
//!
//! Same operations in the same order as [`super::Curved::look_up_group`], so the same bits.

use std::arch::x86_64::{
    __m128i, __m256d, _CMP_GE_OQ, _CMP_GT_OQ, _CMP_LE_OQ, _mm_add_epi32, _mm_and_si128, _mm_loadu_pd, _mm_set1_epi32,
    _mm_storeu_si128, _mm256_add_pd, _mm256_blendv_pd, _mm256_castpd_si256, _mm256_castsi256_si128, _mm256_cmp_pd,
    _mm256_cvtepi32_pd, _mm256_cvttpd_epi32, _mm256_loadu_pd, _mm256_max_pd, _mm256_min_pd, _mm256_mul_pd,
    _mm256_permutevar8x32_epi32, _mm256_set_m128d, _mm256_set1_pd, _mm256_setr_epi32, _mm256_setzero_pd,
    _mm256_sqrt_pd, _mm256_storeu_pd, _mm256_sub_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd, _mm256_xor_pd,
};

use super::{Curved, GROUP, Nodes, TABLE_NODES};
use crate::physics::curve::TABLE_INTERVALS;

/// Numbers in a register.
const FOUR: usize = 4;

/// Potentials of a group of enthalpies. Where all nodes stand is found before any is read, so that reads do not wait for each other.
#[target_feature(enable = "avx2")]
pub(super) fn look_up_group(law: &Curved, enthalpy: &[f64; GROUP], potentials: &mut [f64; GROUP]) {
    let (mut firsts, mut shares) = ([[0; FOUR]; GROUP / FOUR], [[0.0; FOUR]; GROUP / FOUR]);
    let enthalpy = enthalpy.as_chunks::<FOUR>().0;
    for (enthalpy, (firsts, shares)) in enthalpy.iter().zip(firsts.iter_mut().zip(&mut shares)) {
        find(law, absolute(law, enthalpy), firsts, shares);
    }
    let potentials = potentials.as_chunks_mut::<FOUR>().0.iter_mut();
    for ((enthalpy, potentials), (firsts, shares)) in enthalpy.iter().zip(potentials).zip(firsts.iter().zip(&shares)) {
        // SAFETY: there is room for four numbers, and as many are read. Nodes are what was found.
        unsafe {
            let mixed = cubic(columns(&law.nodes, firsts), _mm256_loadu_pd(shares.as_ptr()));
            _mm256_storeu_pd(potentials.as_mut_ptr(), choose(law, absolute(law, enthalpy), mixed));
        }
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn absolute(law: &Curved, enthalpy: &[f64; FOUR]) -> __m256d {
    // SAFETY: there are as many numbers as are read.
    let enthalpy = unsafe { _mm256_loadu_pd(enthalpy.as_ptr()) };
    _mm256_add_pd(enthalpy, _mm256_set1_pd(law.initial.0))
}

/// Finds the first of the two nodes around each enthalpy, and the share of the way to the second.
#[inline]
#[target_feature(enable = "avx2")]
fn find(law: &Curved, absolute: __m256d, firsts: &mut [u32; FOUR], shares: &mut [f64; FOUR]) {
    let is_warm = _mm256_cmp_pd::<_CMP_GT_OQ>(absolute, _mm256_set1_pd(law.middle));
    let warm = _mm256_xor_pd(absolute, _mm256_set1_pd(-0.0));
    let cold = _mm256_sub_pd(absolute, _mm256_set1_pd(law.coldest.0));
    let root = _mm256_sqrt_pd(_mm256_blendv_pd(cold, warm, is_warm));
    let place = _mm256_mul_pd(root, _mm256_set1_pd(law.per_interval));
    // Both give the second where one is no number, so that beyond both ends any interval does.
    let within = _mm256_min_pd(place, _mm256_set1_pd((TABLE_INTERVALS - 1) as f64));
    let interval = _mm256_cvttpd_epi32(_mm256_max_pd(within, _mm256_setzero_pd()));
    let share = _mm256_sub_pd(place, _mm256_cvtepi32_pd(interval));
    let halves = _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6);
    let is_warm = _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(_mm256_castpd_si256(is_warm), halves));
    let table = _mm_and_si128(is_warm, _mm_set1_epi32(TABLE_NODES as i32));
    // SAFETY: there is room for four of each.
    unsafe {
        _mm_storeu_si128(firsts.as_mut_ptr().cast::<__m128i>(), _mm_add_epi32(interval, table));
        _mm256_storeu_pd(shares.as_mut_ptr(), share);
    }
}

/// Value and derivative at the first nodes and at those behind them.
///
/// # Safety
/// The first nodes must not be the last of the tables.
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn columns(nodes: &Nodes, firsts: &[u32; FOUR]) -> [__m256d; 4] {
    // SAFETY: as the caller says; a node is two numbers.
    let pairs = |one: usize, other: usize, later: usize| unsafe {
        let node = |which: usize| _mm_loadu_pd(nodes.as_ptr().add(firsts[which] as usize + later).cast());
        _mm256_set_m128d(node(other), node(one))
    };
    let (even, odd) = (pairs(0, 2, 0), pairs(1, 3, 0));
    let (even_after, odd_after) = (pairs(0, 2, 1), pairs(1, 3, 1));
    [
        _mm256_unpacklo_pd(even, odd),
        _mm256_unpackhi_pd(even, odd),
        _mm256_unpacklo_pd(even_after, odd_after),
        _mm256_unpackhi_pd(even_after, odd_after),
    ]
}

/// [`super::cubic`].
#[inline]
#[target_feature(enable = "avx2")]
fn cubic([u0, d0, u1, d1]: [__m256d; 4], s: __m256d) -> __m256d {
    let (two, three) = (_mm256_set1_pd(2.0), _mm256_set1_pd(3.0));
    let rise = _mm256_sub_pd(u1, u0);
    let square = _mm256_sub_pd(_mm256_sub_pd(_mm256_mul_pd(three, rise), _mm256_mul_pd(two, d0)), d1);
    let cube = _mm256_sub_pd(_mm256_add_pd(d0, d1), _mm256_mul_pd(two, rise));
    let slope = _mm256_add_pd(d0, _mm256_mul_pd(s, _mm256_add_pd(square, _mm256_mul_pd(s, cube))));
    _mm256_add_pd(u0, _mm256_mul_pd(s, slope))
}

/// Potentials less the initial one, of which `mixed` are those between both ends.
#[inline]
#[target_feature(enable = "avx2")]
fn choose(law: &Curved, absolute: __m256d, mixed: __m256d) -> __m256d {
    let coldest = _mm256_set1_pd(law.coldest.0);
    let frozen = _mm256_mul_pd(_mm256_set1_pd(law.frozen_slope), _mm256_sub_pd(absolute, coldest));
    let frozen = _mm256_add_pd(_mm256_set1_pd(law.coldest.1), frozen);
    let unfrozen = _mm256_mul_pd(_mm256_set1_pd(law.unfrozen_slope), absolute);
    let below = _mm256_blendv_pd(mixed, frozen, _mm256_cmp_pd::<_CMP_LE_OQ>(absolute, coldest));
    let is_unfrozen = _mm256_cmp_pd::<_CMP_GE_OQ>(absolute, _mm256_setzero_pd());
    let potential = _mm256_blendv_pd(below, unfrozen, is_unfrozen);
    _mm256_sub_pd(potential, _mm256_set1_pd(law.initial.1))
}
