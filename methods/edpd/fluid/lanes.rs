//! Several places at once along one direction, in single precision: what the search for neighbours needs.
//!
//! Whether a place is near cannot be guessed: all numbers of a vector are written, the near ones first, and what is beyond them is written
//! over by the next.

/// Several numbers in single precision.
pub trait Lanes: Copy {
    /// Numbers of the places in a vector.
    type Numbers: Copy;

    /// How many there are.
    const COUNT: usize;

    /// The same number in all of them.
    fn splat(number: f32) -> Self;
    /// Those from one on.
    ///
    /// # Safety
    /// All must lie within what can be read.
    unsafe fn load(first: *const f32) -> Self;
    /// Differences.
    fn minus(self, other: Self) -> Self;
    /// Products.
    fn times(self, other: Self) -> Self;
    /// Sums.
    fn plus(self, other: Self) -> Self;
    /// Which of some are below others, as bits.
    fn below(self, other: Self, among: u32) -> u32;
    /// The numbers of places from one on.
    fn numbers(first: usize) -> Self::Numbers;
    /// Those of the next vector.
    fn after(numbers: Self::Numbers) -> Self::Numbers;
    /// Writes down those numbers that are among some, one after the other.
    ///
    /// # Safety
    /// There must be room for numbers of all places in a vector.
    unsafe fn note(among: u32, numbers: Self::Numbers, first: *mut u32);
}

/// Places in a vector where no instruction packs the near ones together.
const GROUP: usize = 8;

/// For each set of near places in a group, which they are, the first ones first.
const PACKED: [[u8; GROUP]; 1 << GROUP] = {
    let mut packed = [[0; GROUP]; 1 << GROUP];
    let mut set = 0;
    while set < packed.len() {
        let (mut lane, mut count) = (0, 0);
        while lane < GROUP {
            if set >> lane & 1 == 1 {
                packed[set][count] = lane as u8;
                count += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    packed
};

impl Lanes for [f32; GROUP] {
    type Numbers = u32;

    const COUNT: usize = GROUP;

    #[inline(always)]
    fn splat(number: f32) -> Self {
        [number; GROUP]
    }

    #[inline(always)]
    unsafe fn load(first: *const f32) -> Self {
        // SAFETY: the caller has seen to it.
        unsafe { first.cast::<Self>().read() }
    }

    #[inline(always)]
    fn minus(mut self, other: Self) -> Self {
        for lane in 0..GROUP {
            self[lane] -= other[lane];
        }
        self
    }

    #[inline(always)]
    fn times(mut self, other: Self) -> Self {
        for lane in 0..GROUP {
            self[lane] *= other[lane];
        }
        self
    }

    #[inline(always)]
    fn plus(mut self, other: Self) -> Self {
        for lane in 0..GROUP {
            self[lane] += other[lane];
        }
        self
    }

    #[inline(always)]
    fn below(self, other: Self, among: u32) -> u32 {
        let mut set = 0;
        for lane in 0..GROUP {
            set |= u32::from(self[lane] < other[lane]) << lane;
        }
        set & among
    }

    #[inline(always)]
    fn numbers(first: usize) -> u32 {
        first as u32
    }

    #[inline(always)]
    fn after(numbers: u32) -> u32 {
        numbers + GROUP as u32
    }

    #[inline(always)]
    unsafe fn note(among: u32, numbers: u32, first: *mut u32) {
        let mut noted = [numbers; GROUP];
        for lane in 0..GROUP {
            noted[lane] += u32::from(PACKED[among as usize % PACKED.len()][lane]);
        }
        // SAFETY: the caller has seen to it.
        unsafe { first.cast::<[u32; GROUP]>().write(noted) }
    }
}

#[cfg(target_arch = "x86_64")]
pub use wide::{Eight, Sixteen};

#[cfg(target_arch = "x86_64")]
mod wide;
