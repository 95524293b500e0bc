//! Works in functions of their own, one for each kind of processor.
//!
//! A compiler that has the search for partners, the coefficients of pairs and what rows do in one function has too few registers for all, and loads
//! constants of one loop in another.

use super::scan::{self, Kind};

/// What is done by the instructions of a kind of processor. It must be inlined.
pub trait Work {
    /// What it makes.
    type Made;

    /// Does it.
    fn work<S: Apart>(self) -> Self::Made;
}

/// A kind of processor that does works in functions of their own.
pub trait Apart: Kind {
    /// Does a work.
    fn apart<W: Work>(work: W) -> W::Made;
}

macro_rules! apart {
    ($kind:ty $(, $features:literal)?) => {
        impl Apart for $kind {
            #[inline(always)]
            fn apart<W: Work>(work: W) -> W::Made {
                #[inline(never)]
                $(#[target_feature(enable = $features)])?
                fn apart<W: Work>(work: W) -> W::Made {
                    work.work::<$kind>()
                }
                #[allow(unused_unsafe, reason = "not all kinds have features")]
                // SAFETY: the processor has the features of the kind (see the type).
                unsafe {
                    apart(work)
                }
            }
        }
    };
}

apart!(scan::Portable);
#[cfg(target_arch = "x86_64")]
apart!(scan::Avx2, "avx2,fma,popcnt");
#[cfg(target_arch = "x86_64")]
apart!(scan::Avx512, "avx512f,avx512vl,avx512dq,fma,popcnt");
