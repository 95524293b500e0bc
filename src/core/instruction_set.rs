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
        let limit = LIMIT.load(Ordering::Relaxed);
        #[cfg(target_arch = "x86_64")]
        {
            if limit >= InstructionSet::Avx512 as u8
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("popcnt")
            {
                return InstructionSet::Avx512;
            }
            if limit >= InstructionSet::Avx2 as u8
                && is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
            {
                return InstructionSet::Avx2;
            }
        }
        let _ = limit;
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

static LIMIT: AtomicU8 = AtomicU8::new(InstructionSet::Avx512 as u8);

/// Lets kernels use no wider vectors than these from now on, in the whole process: to compare their times, or their results,
/// which do not differ.
pub fn limit(widest: InstructionSet) {
    LIMIT.store(widest as u8, Ordering::Relaxed);
}

/// Compiles a kernel for the vectors of several processors and calls the widest that may be used. A kernel may be generic over
/// flags, or in square brackets over a type.
macro_rules! widest {
    ($name:ident, $body:ident $(<$($flag:ident),*>)? $([$kind:ident: $bound:path])?, ($($argument:ident: $type:ty),*)) => {
        fn $name<$($kind: $bound,)? $($(const $flag: bool),*)?>($($argument: $type),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f,avx512vl")]
                fn avx512<$($kind: $bound,)? $($(const $flag: bool),*)?>($($argument: $type),*) {
                    $body::<$($kind,)? $($($flag),*)?>($($argument),*);
                }
                #[target_feature(enable = "avx2")]
                fn avx2<$($kind: $bound,)? $($(const $flag: bool),*)?>($($argument: $type),*) {
                    $body::<$($kind,)? $($($flag),*)?>($($argument),*);
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
            $body::<$($kind,)? $($($flag),*)?>($($argument),*);
        }
    };
}

pub(crate) use widest;
