//! Numbers of several fronts side by side, as a kind of processor holds them.
//!
//! Every kind makes the same of the same numbers, bit by bit: no product is fused with a sum. A kind can only be had where
//! its instructions are known to be there, and numbers only by a kind; both give their best within functions that are
//! compiled for these instructions.

use std::ops::{Add, BitAnd, Div, Mul, Not, Sub};

/// Fronts that are worked on side by side.
pub(super) const LANES: usize = 8;

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
pub(super) trait Flags: Copy + BitAnd<Output = Self> + Not<Output = Self> {
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
each!(EachFlag: BitAnd bitand &);

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
mod x86;

#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Avx2, Avx512};

/// Compiles a kernel for the vectors of several kinds of processor, and calls it with the widest kind that may be used.
macro_rules! by_kind {
    ($name:ident, $body:ident $([$law:ident: $bound:path])?, ($($argument:ident: $type:ty),*)) => {
        fn $name<$($law: $bound)?>($($argument: $type),*) {
            #[cfg(target_arch = "x86_64")]
            {
                use $crate::instruction_set::InstructionSet;
                use $crate::physics::sub_cell::numbers::{Avx2, Avx512};

                #[target_feature(enable = "avx512f,avx512vl")]
                fn avx512<$($law: $bound)?>($($argument: $type),*) {
                    // SAFETY: this is compiled for what the kind needs.
                    $body(unsafe { Avx512::new() }, $($argument),*);
                }
                #[target_feature(enable = "avx2")]
                fn avx2<$($law: $bound)?>($($argument: $type),*) {
                    // SAFETY: as above.
                    $body(unsafe { Avx2::new() }, $($argument),*);
                }
                match InstructionSet::widest() {
                    // SAFETY: the processor has just been asked for these features.
                    InstructionSet::Avx512 => return unsafe { avx512($($argument),*) },
                    // SAFETY: as above.
                    InstructionSet::Avx2 => return unsafe { avx2($($argument),*) },
                    InstructionSet::Portable => {}
                }
            }
            $body($crate::physics::sub_cell::numbers::Portable, $($argument),*);
        }
    };
}

pub(super) use by_kind;

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
        let flags = [yes, less, one.differs(other), !yes, yes & less];
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
                if InstructionSet::widest() >= InstructionSet::Avx2 {
                    // SAFETY: the processor has just been asked.
                    prop_assert_eq!(&made(unsafe { Avx2::new() }, &numbers, &flags), &expected);
                }
                if InstructionSet::widest() >= InstructionSet::Avx512 {
                    // SAFETY: as above.
                    prop_assert_eq!(&made(unsafe { Avx512::new() }, &numbers, &flags), &expected);
                }
            }
            let _ = expected;
        }
    }
}
