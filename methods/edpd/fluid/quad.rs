//! Four numbers at once, in double precision and in single: what the pairs of a particle with four others need.
//!
//! All ways give the same bits: sums with products are fused, and the sum of all four is that of the first and third and of the
//! second and fourth.

/// Four numbers in double precision.
pub trait Quad: Copy {
    /// Four numbers in single precision.
    type Single: Copy;

    /// The same number four times.
    fn splat(number: f64) -> Self;
    /// Four numbers.
    fn load(numbers: &[f64; 4]) -> Self;
    /// Writes them down.
    fn store(self, numbers: &mut [f64; 4]);
    /// Sums.
    fn plus(self, other: Self) -> Self;
    /// Differences.
    fn minus(self, other: Self) -> Self;
    /// Products.
    fn times(self, other: Self) -> Self;
    /// `self * by + to`, rounded once.
    fn times_plus(self, by: Self, to: Self) -> Self;
    /// `to - self * by`, rounded once.
    fn times_from(self, by: Self, to: Self) -> Self;
    /// One of them, four times.
    fn one<const LANE: usize>(self) -> Self;
    /// Those after one of them; zeros in place of it and of those before.
    fn after<const LANE: usize>(self) -> Self;
    /// The sum of all, four times.
    fn sum(self) -> Self;
    /// The first of them.
    fn first(self) -> f64;
    /// Rows for columns.
    fn turned(rows: [Self; 4]) -> [Self; 4];
    /// In single precision.
    fn single(self) -> Self::Single;
    /// In double precision.
    fn wide(single: &[f32; 4]) -> Self;

    /// The same number four times.
    fn single_splat(number: f32) -> Self::Single;
    /// Four numbers.
    fn single_load(numbers: &[f32; 4]) -> Self::Single;
    /// Writes them down.
    fn single_store(single: Self::Single, numbers: &mut [f32; 4]);
    /// Sums.
    fn single_plus(a: Self::Single, b: Self::Single) -> Self::Single;
    /// Rows for columns.
    fn single_turned(rows: [Self::Single; 4]) -> [Self::Single; 4];
}

impl Quad for [f64; 4] {
    type Single = [f32; 4];

    #[inline(always)]
    fn splat(number: f64) -> Self {
        [number; 4]
    }

    #[inline(always)]
    fn load(numbers: &[f64; 4]) -> Self {
        *numbers
    }

    #[inline(always)]
    fn store(self, numbers: &mut [f64; 4]) {
        *numbers = self;
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        std::array::from_fn(|lane| self[lane] + other[lane])
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        std::array::from_fn(|lane| self[lane] - other[lane])
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        std::array::from_fn(|lane| self[lane] * other[lane])
    }

    #[inline(always)]
    fn times_plus(self, by: Self, to: Self) -> Self {
        std::array::from_fn(|lane| self[lane].mul_add(by[lane], to[lane]))
    }

    #[inline(always)]
    fn times_from(self, by: Self, to: Self) -> Self {
        std::array::from_fn(|lane| (-self[lane]).mul_add(by[lane], to[lane]))
    }

    #[inline(always)]
    fn one<const LANE: usize>(self) -> Self {
        [self[LANE]; 4]
    }

    #[inline(always)]
    fn after<const LANE: usize>(self) -> Self {
        std::array::from_fn(|lane| if lane > LANE { self[lane] } else { 0.0 })
    }

    #[inline(always)]
    fn sum(self) -> Self {
        [(self[0] + self[2]) + (self[1] + self[3]); 4]
    }

    #[inline(always)]
    fn first(self) -> f64 {
        self[0]
    }

    #[inline(always)]
    fn turned(rows: [Self; 4]) -> [Self; 4] {
        std::array::from_fn(|column| std::array::from_fn(|row| rows[row][column]))
    }

    #[inline(always)]
    fn single(self) -> [f32; 4] {
        self.map(|number| number as f32)
    }

    #[inline(always)]
    fn wide(single: &[f32; 4]) -> Self {
        single.map(f64::from)
    }

    #[inline(always)]
    fn single_splat(number: f32) -> [f32; 4] {
        [number; 4]
    }

    #[inline(always)]
    fn single_load(numbers: &[f32; 4]) -> [f32; 4] {
        *numbers
    }

    #[inline(always)]
    fn single_store(single: [f32; 4], numbers: &mut [f32; 4]) {
        *numbers = single;
    }

    #[inline(always)]
    fn single_plus(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        std::array::from_fn(|lane| a[lane] + b[lane])
    }

    #[inline(always)]
    fn single_turned(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
        std::array::from_fn(|column| std::array::from_fn(|row| rows[row][column]))
    }
}

#[cfg(target_arch = "x86_64")]
pub use wide::Wide;

#[cfg(target_arch = "x86_64")]
mod wide;

#[cfg(test)]
#[cfg(target_arch = "x86_64")]
mod tests {
    use frazil_core::instruction_set::InstructionSet;
    use proptest::prelude::*;

    use super::*;

    /// Whether numbers are the same to the last bit.
    fn bits(numbers: [f64; 4]) -> [u64; 4] {
        numbers.map(f64::to_bits)
    }

    /// What a way makes of twelve numbers and four in single precision.
    fn made<Q: Quad>(rows: [[f64; 4]; 4], singles: [[f32; 4]; 4]) -> (Vec<[u64; 4]>, Vec<[u32; 4]>) {
        let [a, b, c, d] = rows.each_ref().map(Q::load);
        let mut all = vec![a.plus(b), a.minus(b), a.times(b), a.times_plus(b, c), a.times_from(b, c), a.sum()];
        all.extend([a.one::<0>(), a.one::<1>(), a.one::<2>(), a.one::<3>(), Q::splat(a.first()), Q::wide(&singles[0])]);
        all.extend([a.after::<0>(), a.after::<1>(), a.after::<2>(), a.after::<3>()]);
        all.extend(Q::turned([a, b, c, d]));
        let [e, f, g, h] = singles.each_ref().map(Q::single_load);
        let mut some = vec![Q::single_plus(e, f), a.single(), Q::single_splat(singles[0][0])];
        some.extend(Q::single_turned([e, f, g, h]));
        let stored = |quad: Q| {
            let mut numbers = [0.0; 4];
            quad.store(&mut numbers);
            bits(numbers)
        };
        let stored_single = |single: Q::Single| {
            let mut numbers = [0.0; 4];
            Q::single_store(single, &mut numbers);
            numbers.map(f32::to_bits)
        };
        (all.into_iter().map(stored).collect(), some.into_iter().map(stored_single).collect())
    }

    proptest! {
        #[test]
        fn both_ways_make_the_same(
            rows in prop::array::uniform4(prop::array::uniform4(-1e9_f64..1e9)),
            singles in prop::array::uniform4(prop::array::uniform4(-1e9_f32..1e9)),
        ) {
            if InstructionSet::widest() >= InstructionSet::Avx2 {
                prop_assert_eq!(made::<[f64; 4]>(rows, singles), made::<Wide>(rows, singles));
            }
        }
    }
}
