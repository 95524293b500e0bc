//! Numbers side by side, for the vectors of one kind of processor.
//!
//! Every kind makes the same of the same numbers, bit by bit: products are fused with sums where they are asked to be, in
//! software where a processor cannot.

/// Numbers side by side, at most.
pub const LANES: usize = 8;

/// Numbers side by side, as a kind of processor holds them.
///
/// # Safety
/// All functions may only be called where the instructions of the kind are known to be there, and give their best within
/// functions that are compiled for these.
pub(super) trait Lanes: Copy {
    /// One number for all.
    type Factor: Copy;
    /// How many stand side by side.
    const WIDTH: usize = LANES;
    /// A number for all.
    unsafe fn factor(value: f64) -> Self::Factor;
    /// Numbers from memory, as many as stand side by side.
    unsafe fn load(from: *const f64) -> Self;
    /// Numbers into memory, where there is room for as many.
    unsafe fn store(self, into: *mut f64);
    /// Numbers from memory, fewer than there is room for, and zeros behind them.
    #[inline(always)]
    unsafe fn load_some(from: &[f64]) -> Self {
        let mut all = [0.0; LANES];
        all[..from.len()].copy_from_slice(from);
        // SAFETY: as the caller says.
        unsafe { Self::load(all.as_ptr()) }
    }
    /// As many of the numbers into memory as it takes, fewer than there are.
    #[inline(always)]
    unsafe fn store_some(self, into: &mut [f64]) {
        let mut all = [0.0; LANES];
        // SAFETY: as the caller says.
        unsafe { self.store(all.as_mut_ptr()) };
        into.copy_from_slice(&all[..into.len()]);
    }
    /// [`Lanes::load_some`] on a line, which may be as short as what is left over: without a call, which would cost the loops over
    /// rows of a plane registers.
    #[inline(always)]
    unsafe fn load_end(from: &[f64]) -> Self {
        // SAFETY: as the caller says.
        unsafe { Self::load_some(from) }
    }
    /// [`Lanes::store_some`], likewise.
    #[inline(always)]
    unsafe fn store_end(self, into: &mut [f64]) {
        // SAFETY: as the caller says.
        unsafe { self.store_some(into) };
    }
    /// Sums.
    unsafe fn plus(self, other: Self) -> Self;
    /// Differences.
    unsafe fn minus(self, other: Self) -> Self;
    /// Differences from one number.
    unsafe fn less(self, number: Self::Factor) -> Self;
    /// What is less than a number, and that number for the others.
    unsafe fn lesser(self, number: Self::Factor) -> Self;
    /// What is greater than a number, and that number for the others.
    unsafe fn greater(self, number: Self::Factor) -> Self;
    /// The numbers from the last to the first.
    unsafe fn reversed(self) -> Self;
    /// Products.
    unsafe fn times(self, factor: Self::Factor) -> Self;
    /// `self * factor + sum`, rounded once.
    unsafe fn times_plus(self, factor: Self::Factor, sum: Self) -> Self;
    /// The numbers that stand `BY` places (1 to `WIDTH`) before those of `here`, which `before` stands in front of.
    unsafe fn from_before<const BY: usize>(before: Self, here: Self) -> Self;
    /// The numbers that stand `BY` places (1 to `WIDTH`) after those of `here`, which `after` follows.
    unsafe fn from_after<const BY: usize>(here: Self, after: Self) -> Self;
}

/// On every processor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Portable([f64; LANES]);

impl Lanes for Portable {
    type Factor = f64;

    #[inline(always)]
    unsafe fn factor(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: there are as many numbers as are read.
        Portable(unsafe { from.cast::<[f64; LANES]>().read() })
    }

    #[inline(always)]
    unsafe fn store(self, into: *mut f64) {
        // SAFETY: there is room for as many numbers as are written.
        unsafe { into.cast::<[f64; LANES]>().write(self.0) }
    }

    #[inline(always)]
    unsafe fn plus(self, other: Self) -> Self {
        Portable(std::array::from_fn(|lane| self.0[lane] + other.0[lane]))
    }

    #[inline(always)]
    unsafe fn minus(self, other: Self) -> Self {
        Portable(std::array::from_fn(|lane| self.0[lane] - other.0[lane]))
    }

    #[inline(always)]
    unsafe fn less(self, number: f64) -> Self {
        Portable(std::array::from_fn(|lane| self.0[lane] - number))
    }

    #[inline(always)]
    unsafe fn lesser(self, number: f64) -> Self {
        Portable(std::array::from_fn(|lane| if self.0[lane] < number { self.0[lane] } else { number }))
    }

    #[inline(always)]
    unsafe fn greater(self, number: f64) -> Self {
        Portable(std::array::from_fn(|lane| if self.0[lane] > number { self.0[lane] } else { number }))
    }

    #[inline(always)]
    unsafe fn reversed(self) -> Self {
        Portable(std::array::from_fn(|lane| self.0[LANES - 1 - lane]))
    }

    #[inline(always)]
    unsafe fn times(self, factor: f64) -> Self {
        Portable(std::array::from_fn(|lane| self.0[lane] * factor))
    }

    #[inline(always)]
    unsafe fn times_plus(self, factor: f64, sum: Self) -> Self {
        Portable(std::array::from_fn(|lane| self.0[lane].mul_add(factor, sum.0[lane])))
    }

    #[inline(always)]
    unsafe fn from_before<const BY: usize>(before: Self, here: Self) -> Self {
        Portable(std::array::from_fn(|lane| if lane < BY { before.0[LANES - BY + lane] } else { here.0[lane - BY] }))
    }

    #[inline(always)]
    unsafe fn from_after<const BY: usize>(here: Self, after: Self) -> Self {
        let of = |lane: usize| if lane + BY < LANES { here.0[lane + BY] } else { after.0[lane + BY - LANES] };
        Portable(std::array::from_fn(of))
    }
}

#[cfg(target_arch = "x86_64")]
mod x86;

#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Avx2, Avx512, Four};
