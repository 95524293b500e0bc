//! Numbers of several fronts side by side, as a kind of processor holds them.
//!
//! Every kind makes the same of the same numbers, bit by bit: no product is fused with a sum. A kind can only be had where
//! its instructions are known to be there, and numbers only by a kind; both give their best within functions that are
//! compiled for these instructions.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

/// A kind of processor, for `L` numbers side by side.
pub(super) trait Kind<const L: usize>: Copy {
    /// What it holds them in.
    type Numbers: Numbers<Flags = Self::Flags>;
    /// A yes or no for each.
    type Flags: Flags;
    /// The same number for all.
    fn of(self, value: f64) -> Self::Numbers;
    fn load(self, from: &[f64; L]) -> Self::Numbers;
    fn store(self, numbers: Self::Numbers, into: &mut [f64; L]);
    /// Yes where all bits are set, no where none is.
    fn flags(self, from: &[u64; L]) -> Self::Flags;
}

/// Numbers side by side.
pub(super) trait Numbers:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// A yes or no for each.
    type Flags: Flags;
    fn root(self) -> Self;
    fn size(self) -> Self;
    fn is_less(self, than: Self) -> Self::Flags;
    fn differs(self, from: Self) -> Self::Flags;
    /// These where yes, others where no.
    fn or(self, yes: Self::Flags, others: Self) -> Self;
    /// These where they are less than others, and others where not.
    #[inline(always)]
    fn or_less(self, others: Self) -> Self {
        self.or(self.is_less(others), others)
    }
    /// These where they are greater than others, and others where not.
    #[inline(always)]
    fn or_greater(self, others: Self) -> Self {
        self.or(others.is_less(self), others)
    }
}

/// A yes or no for each of several numbers.
pub(super) trait Flags: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    fn any(self) -> bool;
    /// A bit for each, the first the lowest.
    fn bits(self) -> u64;
}

/// Any processor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Portable;

/// One after the other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Each<const L: usize>([f64; L]);

#[derive(Debug, Clone, Copy)]
pub(super) struct EachFlag<const L: usize>([bool; L]);

impl<const L: usize> Kind<L> for Portable {
    type Numbers = Each<L>;
    type Flags = EachFlag<L>;

    #[inline(always)]
    fn of(self, value: f64) -> Each<L> {
        Each([value; L])
    }

    #[inline(always)]
    fn load(self, from: &[f64; L]) -> Each<L> {
        Each(*from)
    }

    #[inline(always)]
    fn store(self, numbers: Each<L>, into: &mut [f64; L]) {
        *into = numbers.0;
    }

    #[inline(always)]
    fn flags(self, from: &[u64; L]) -> EachFlag<L> {
        EachFlag(from.map(|bits| bits != 0))
    }
}

/// Implements operators of two operands, one by one.
macro_rules! each {
    ($kind:ident: $($operator:ident $name:ident $symbol:tt),*) => {
        $(impl<const L: usize> $operator for $kind<L> {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                $kind(std::array::from_fn(|lane| self.0[lane] $symbol other.0[lane]))
            }
        })*
    };
}

each!(Each: Add add +, Sub sub -, Mul mul *, Div div /);
each!(EachFlag: BitAnd bitand &, BitOr bitor |);

impl<const L: usize> Numbers for Each<L> {
    type Flags = EachFlag<L>;

    #[inline(always)]
    fn root(self) -> Self {
        Each(self.0.map(f64::sqrt))
    }

    #[inline(always)]
    fn size(self) -> Self {
        Each(self.0.map(f64::abs))
    }

    #[inline(always)]
    fn is_less(self, than: Self) -> EachFlag<L> {
        EachFlag(std::array::from_fn(|lane| self.0[lane] < than.0[lane]))
    }

    #[inline(always)]
    fn differs(self, from: Self) -> EachFlag<L> {
        EachFlag(std::array::from_fn(|lane| self.0[lane] != from.0[lane]))
    }

    #[inline(always)]
    fn or(self, yes: EachFlag<L>, others: Self) -> Self {
        Each(std::array::from_fn(|lane| if yes.0[lane] { self.0[lane] } else { others.0[lane] }))
    }
}

impl<const L: usize> Not for EachFlag<L> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        EachFlag(self.0.map(|flag| !flag))
    }
}

impl<const L: usize> Flags for EachFlag<L> {
    #[inline(always)]
    fn any(self) -> bool {
        self.0.iter().fold(false, |any, flag| any | flag)
    }

    #[inline(always)]
    fn bits(self) -> u64 {
        self.0.iter().enumerate().fold(0, |bits, (lane, flag)| bits | u64::from(*flag) << lane)
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Avx2, Avx512};

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m256d, __m512d, __mmask8, _CMP_LT_OQ, _CMP_NEQ_UQ, _mm256_add_pd, _mm256_and_pd, _mm256_andnot_pd,
        _mm256_blendv_pd, _mm256_castsi256_pd, _mm256_cmp_pd, _mm256_div_pd, _mm256_loadu_pd, _mm256_movemask_pd,
        _mm256_mul_pd, _mm256_or_pd, _mm256_set1_epi64x, _mm256_set1_pd, _mm256_sqrt_pd, _mm256_storeu_pd,
        _mm256_sub_pd, _mm256_xor_pd, _mm512_abs_pd, _mm512_add_pd, _mm512_cmp_pd_mask, _mm512_div_pd, _mm512_loadu_pd,
        _mm512_loadu_si512, _mm512_mask_blend_pd, _mm512_mul_pd, _mm512_set1_pd, _mm512_sqrt_pd, _mm512_storeu_pd,
        _mm512_sub_pd, _mm512_test_epi64_mask,
    };
    use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

    use super::{Flags, Kind, Numbers};

    /// A processor with AVX-512.
    #[derive(Debug, Clone, Copy)]
    pub(in super::super) struct Avx512(());

    impl Avx512 {
        /// # Safety
        /// The processor must have AVX-512 (`avx512f` and `avx512vl`).
        #[inline(always)]
        pub(in super::super) unsafe fn new() -> Self {
            Avx512(())
        }
    }

    /// Eight numbers in a register.
    #[derive(Debug, Clone, Copy)]
    pub(in super::super) struct Eight(__m512d);

    /// A bit for each.
    #[derive(Debug, Clone, Copy)]
    pub(in super::super) struct Bits(__mmask8);

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

    impl BitOr for Bits {
        type Output = Self;

        #[inline(always)]
        fn bitor(self, other: Self) -> Self {
            Bits(self.0 | other.0)
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
    pub(in super::super) struct Avx2(());

    impl Avx2 {
        /// # Safety
        /// The processor must have AVX2.
        #[inline(always)]
        pub(in super::super) unsafe fn new() -> Self {
            Avx2(())
        }
    }

    /// Twice four numbers in a register.
    #[derive(Debug, Clone, Copy)]
    pub(in super::super) struct Fours([__m256d; 2]);

    /// All bits of each, or none.
    #[derive(Debug, Clone, Copy)]
    pub(in super::super) struct Masks([__m256d; 2]);

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
    fours!(Masks: BitAnd bitand _mm256_and_pd, BitOr bitor _mm256_or_pd);

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
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::instruction_set::InstructionSet;

    /// What a kind makes of some numbers, by bits.
    fn made(kind: impl Kind<8>, [a, b]: &[[f64; 8]; 2], flags: &[u64; 8]) -> Vec<u64> {
        let (one, other) = (kind.load(a), kind.load(b));
        let yes = kind.flags(flags);
        let less = one.is_less(other);
        let mut found = [one + other, one - other, one * other, one / other]
            .into_iter()
            .chain([one.root(), one.size(), one.or(yes, other), one.or_less(other), one.or_greater(other)])
            .flat_map(|numbers| {
                let mut into = [0.0; 8];
                kind.store(numbers, &mut into);
                // There are many numbers that are none.
                into.map(|number: f64| if number.is_nan() { f64::NAN } else { number }.to_bits())
            })
            .collect::<Vec<u64>>();
        let flags = [yes, less, one.differs(other), !yes, yes & less, yes | less];
        found.extend(flags.into_iter().flat_map(|flags| [flags.bits(), u64::from(flags.any())]));
        found
    }

    proptest! {
        #[test]
        fn every_kind_makes_the_same(
            numbers in prop::array::uniform2(prop::array::uniform8(prop_oneof![
                -2.0..2.0f64, Just(0.0), Just(-0.0), Just(1.0), Just(f64::NAN), Just(f64::INFINITY),
            ])),
            flags in prop::array::uniform8(prop_oneof![Just(0), Just(u64::MAX)]),
        ) {
            let expected = made(Portable, &numbers, &flags);
            #[cfg(target_arch = "x86_64")]
            {
                if InstructionSet::found() >= InstructionSet::Avx2 {
                    // SAFETY: the processor has just been asked.
                    prop_assert_eq!(&made(unsafe { Avx2::new() }, &numbers, &flags), &expected);
                }
                if InstructionSet::found() >= InstructionSet::Avx512 {
                    // SAFETY: as above.
                    prop_assert_eq!(&made(unsafe { Avx512::new() }, &numbers, &flags), &expected);
                }
            }
            let _ = expected;
        }
    }
}
