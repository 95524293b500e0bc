//! Loops over pairs in functions of their own, one for each kind of processor.
//!
//! In one function with the search for partners, a compiler has too few registers for all, and loads constants of one loop in
//! another.

use super::coefficients::{PairColumns, PairConstants, ROOM};
use super::meeting::{self, PartnerRow};
use super::particle::Particle;
use super::scan::{self, Kind};

/// What pairs that have been found do, by the instructions of a kind of processor.
pub trait Apart: Kind {
    /// As [`PairColumns::evaluate`].
    fn evaluate<const D: usize, const UNEVEN: bool>(
        pairs: &mut PairColumns<D>,
        constants: &PairConstants,
        count: usize,
    ) -> f64;

    /// As [`meeting::rows_meet`].
    fn rows_meet<const D: usize>(
        pairs: &PairColumns<D>,
        partners: &[u32; ROOM],
        rows: &[PartnerRow],
        own: &mut [Particle<D>],
        next: &mut [Particle<D>],
    );
}

macro_rules! apart {
    ($kind:ty $(, $features:literal)?) => {
        impl Apart for $kind {
            #[inline(always)]
            fn evaluate<const D: usize, const UNEVEN: bool>(
                pairs: &mut PairColumns<D>,
                constants: &PairConstants,
                count: usize,
            ) -> f64 {
                #[inline(never)]
                $(#[target_feature(enable = $features)])?
                fn apart<const D: usize, const UNEVEN: bool>(
                    pairs: &mut PairColumns<D>,
                    constants: &PairConstants,
                    count: usize,
                ) -> f64 {
                    pairs.evaluate::<UNEVEN>(constants, count)
                }
                #[allow(unused_unsafe, reason = "not all kinds have features")]
                // SAFETY: the processor has the features of the kind (see the type).
                unsafe {
                    apart::<D, UNEVEN>(pairs, constants, count)
                }
            }

            #[inline(always)]
            fn rows_meet<const D: usize>(
                pairs: &PairColumns<D>,
                partners: &[u32; ROOM],
                rows: &[PartnerRow],
                own: &mut [Particle<D>],
                next: &mut [Particle<D>],
            ) {
                #[inline(never)]
                $(#[target_feature(enable = $features)])?
                fn apart<const D: usize>(
                    pairs: &PairColumns<D>,
                    partners: &[u32; ROOM],
                    rows: &[PartnerRow],
                    own: &mut [Particle<D>],
                    next: &mut [Particle<D>],
                ) {
                    meeting::rows_meet::<D, <$kind as Kind>::Quad>(pairs, partners, rows, own, next);
                }
                #[allow(unused_unsafe, reason = "not all kinds have features")]
                // SAFETY: as above.
                unsafe {
                    apart(pairs, partners, rows, own, next)
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
