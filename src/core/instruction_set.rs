//! Which vectors of the processor the kernels use.
//!
//! All give the same bits: products are fused with sums in all of them or in none, and every number sees the same operations
//! in the same order.

use std::fmt;
use std::sync::atomic::{AtomicU8, Ordering};

/// Instructions that kernels are compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum InstructionSet {
    /// What all processors of an architecture have.
    Portable,
    /// AVX2 with fused products: four numbers at once.
    Avx2,
    /// AVX-512: eight.
    Avx512,
}

impl InstructionSet {
    /// All, from the narrowest on.
    pub const ALL: [InstructionSet; 3] = [InstructionSet::Portable, InstructionSet::Avx2, InstructionSet::Avx512];

    /// The widest that this processor has, and that [`limit`] allows.
    #[inline]
    pub fn widest() -> Self {
        // Steps of small bodies are as short as a few questions to the processor: the answer is kept.
        match ALLOWED.load(Ordering::Relaxed) {
            PORTABLE => InstructionSet::Portable,
            AVX2 => InstructionSet::Avx2,
            AVX512 => InstructionSet::Avx512,
            _ => {
                let found = InstructionSet::found();
                ALLOWED.store(found as u8, Ordering::Relaxed);
                found
            }
        }
    }

    /// The widest that this processor has.
    fn found() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("popcnt")
            {
                return InstructionSet::Avx512;
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") && is_x86_feature_detected!("popcnt")
            {
                return InstructionSet::Avx2;
            }
        }
        InstructionSet::Portable
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            InstructionSet::Portable => "portable",
            InstructionSet::Avx2 => "avx2",
            InstructionSet::Avx512 => "avx512",
        })
    }
}

const PORTABLE: u8 = InstructionSet::Portable as u8;
const AVX2: u8 = InstructionSet::Avx2 as u8;
const AVX512: u8 = InstructionSet::Avx512 as u8;

/// The widest that may be used, once the processor has been asked; before, a number that stands for none.
static ALLOWED: AtomicU8 = AtomicU8::new(u8::MAX);

/// Lets kernels use no wider vectors than these from now on, in the whole process: to compare their times, or their results,
/// which do not differ.
pub fn limit(widest: InstructionSet) {
    ALLOWED.store(widest.min(InstructionSet::found()) as u8, Ordering::Relaxed);
}

/// Compiles a kernel for the vectors of several processors and calls the widest that may be used. A kernel may be generic over
/// flags, or in square brackets over a type, and `_` for what else its arguments tell.
macro_rules! widest {
    ($name:ident, $body:ident $(<$($flag:ident),*>)? $([$kind:ident: $bound:path $(, $inferred:tt)*])?, ($($argument:ident: $type:ty),*)) => {
        fn $name<$($kind: $bound,)? $($(const $flag: bool),*)?>($($argument: $type),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f,avx512vl")]
                fn avx512<$($kind: $bound,)? $($(const $flag: bool),*)?>($($argument: $type),*) {
                    $body::<$($kind, $($inferred,)*)? $($($flag),*)?>($($argument),*);
                }
                #[target_feature(enable = "avx2")]
                fn avx2<$($kind: $bound,)? $($(const $flag: bool),*)?>($($argument: $type),*) {
                    $body::<$($kind, $($inferred,)*)? $($($flag),*)?>($($argument),*);
                }
                match $crate::instruction_set::InstructionSet::widest() {
                    // SAFETY: the processor has just been asked for these features.
                    $crate::instruction_set::InstructionSet::Avx512 => unsafe {
                        return avx512::<$($kind,)? $($($flag),*)?>($($argument),*);
                    },
                    // SAFETY: as above.
                    $crate::instruction_set::InstructionSet::Avx2 => unsafe {
                        return avx2::<$($kind,)? $($($flag),*)?>($($argument),*);
                    },
                    $crate::instruction_set::InstructionSet::Portable => {}
                }
            }
            $body::<$($kind, $($inferred,)*)? $($($flag),*)?>($($argument),*);
        }
    };
}

pub(crate) use widest;
