//! Which way fronts lie in the cells that they cross.

use super::numbers::{Kind, Numbers};
use super::window::{NONE, Window};

/// Gradient of the frozen fraction (of eight cells, weighted 1, 2, 1) below which a front has no direction: a plane one has
/// about 4.
const LEAST_GRADIENT: f64 = 1.0;

/// How the fronts in the middle of a window lie.
#[derive(Debug, Clone, Copy)]
pub(super) struct Orientation<N> {
    /// Components along x and y of the normal towards the unfrozen side; zeros where it is not known.
    normal: [N; 2],
    /// How far (spacings) the front moves while it crosses the cell: from one neighbour to the next along the axis that is
    /// nearer to the normal. Heat by the neighbours along both axes freezes a cell in just this time.
    width: N,
    /// What part of its spacings a pair counts as along the normal at least: none, or all where the normal is not known.
    least: N,
    /// Slope of the potential across the front (W/m by spacing), by the shares of both phases in the cell.
    slope: N,
}

impl<N: Numbers> Orientation<N> {
    /// Across the axis of each pair.
    #[inline(always)]
    pub(super) fn flat<const L: usize>(kind: impl Kind<L, Numbers = N>) -> Self {
        let (zero, one) = (kind.of(0.0), kind.of(1.0));
        Orientation { normal: [zero; 2], width: one, least: one, slope: zero }
    }

    /// From the frozen fractions around the cells, by Youngs' weights, and from the potentials next to them.
    #[inline(always)]
    pub(super) fn of<const L: usize>(
        kind: impl Kind<L, Numbers = N, Flags = N::Flags>,
        window: &Window<L>,
        interval: (f64, f64),
    ) -> Self {
        let (middle, width) = (window.above.len() / 2, window.width);
        let place = |dx: isize, dy: isize| middle.wrapping_add_signed(dx + dy * width as isize);
        let fraction = |dx: isize, dy: isize| window.frozen_fractions(kind, place(dx, dy), place(-dx, -dy), interval);
        let fractions = kind.load(&window.fractions);
        let (zero, half, one) = (kind.of(0.0), kind.of(0.5), kind.of(1.0));
        let [mut x, mut y] = [zero; 2];
        for (dx, dy, along_x, along_y) in [(1, 0, 2.0, 0.0), (0, 1, 0.0, 2.0), (1, 1, 1.0, 1.0), (1, -1, 1.0, -1.0)] {
            let drop = drop(kind, [fraction(-dx, -dy), fraction(dx, dy)], fractions);
            x = x + kind.of(along_x) * drop;
            y = y + kind.of(along_y) * drop;
        }
        let size = (x * x + y * y).root();
        let is_known = !size.is_less(kind.of(LEAST_GRADIENT));
        let scale = (one / size).or(is_known, zero);
        let normal = [x * scale, y * scale];
        let width = normal[0].size().or_greater(normal[1].size()).or(is_known, one);
        let least = zero.or(is_known, one);
        // The steepest on both sides.
        let [mut frozen, mut unfrozen] = [zero; 2];
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let (above, beyond) = (kind.load(&window.above[place(dx, dy)]), kind.load(&window.above[place(-dx, -dy)]));
            let is_alone = !zero.is_less(above * beyond);
            frozen = above.size().or(above.is_less(zero) & is_alone, zero).or_greater(frozen);
            unfrozen = above.or(zero.is_less(above) & is_alone, zero).or_greater(unfrozen);
        }
        let rest = one - fractions;
        let slope = fractions * (frozen / (half + fractions)) + rest * (unfrozen / (half + rest));
        Orientation { normal, width, least, slope: slope.or(is_known, zero) }
    }

    /// How many times as much as the plain one a pair to an offset carries, over so many spacings, by the potential of its
    /// end above that of the front and by that on the opposite side: the distance is along the pair. Where both sides are in the same phase two fronts move
    /// toward each other, and each has half of the cell.
    #[inline(always)]
    pub(super) fn carried<const L: usize>(
        &self,
        kind: impl Kind<L, Numbers = N, Flags = N::Flags>,
        (offset, cells): ([f64; 2], f64),
        (above, beyond): (N, N),
        frozen: N,
    ) -> N {
        let (zero, half, one, cells) = (kind.of(0.0), kind.of(0.5), kind.of(1.0), kind.of(cells));
        let are_two = zero.is_less(above * beyond);
        let is_frozen = above.is_less(zero);
        let along = self.along_normal(kind, offset);
        let share = frozen.or(is_frozen, one - frozen);
        let along = (zero - along).or(is_frozen, along);
        // The front has left the cell of the end: it is half a width from its centre, or farther.
        let least = (self.width * (one - share)).or_greater(cells * self.least);
        let far = along.or_greater(least);
        let (whole, width) = (cells.or(are_two, far), one.or(are_two, self.width));
        let share = (half * share).or(are_two, share);
        whole / (whole + width * (share - half))
    }

    /// Spacings that pairs over an offset go along the normal from the frozen to the unfrozen side, one way and the other.
    #[inline(always)]
    pub(super) fn spans<const L: usize>(
        &self,
        kind: impl Kind<L, Numbers = N, Flags = N::Flags>,
        offset: [f64; 2],
    ) -> [N; 2] {
        let (zero, along) = (kind.of(0.0), self.along_normal(kind, offset));
        [along.or_greater(zero), (zero - along).or_greater(zero)]
    }

    #[inline(always)]
    fn along_normal<const L: usize>(&self, kind: impl Kind<L, Numbers = N, Flags = N::Flags>, offset: [f64; 2]) -> N {
        self.normal[0] * kind.of(offset[0]) + self.normal[1] * kind.of(offset[1])
    }

    /// Heat by weight (W/m) that comes to the front over a spacing from the end of a pair, by its offset, its spacings along the
    /// axis of the pair, and its potential above that of the front: over a spacing of the normal, or, where that is not known, or two
    /// fronts move toward each other, of the axis.
    #[inline(always)]
    pub(super) fn flows<const L: usize>(
        &self,
        kind: impl Kind<L, Numbers = N, Flags = N::Flags>,
        (offset, cells): ([f64; 2], f64),
        (above, are_two): (N, N::Flags),
        frozen: N,
    ) -> [N; 2] {
        let (zero, half, one) = (kind.of(0.0), kind.of(0.5), kind.of(1.0));
        let (is_frozen, along) = (above.is_less(zero), self.along_normal(kind, offset));
        let share = frozen.or(is_frozen, one - frozen);
        // The front has left the cell of the end: it is half a width from its centre, or farther.
        let along = (zero - along).or(is_frozen, along).or_greater(self.width * (one - share));
        let by_normal = !are_two & self.least.is_less(half);
        let by_axis = kind.of(cells - 0.5) + (half * share).or(are_two, share);
        let flow = above / (along + self.width * (share - half)).or(by_normal, by_axis);
        [flow.or(by_normal, zero), zero.or(by_normal, flow)]
    }

    /// Heat by weight (W/m) that comes along a front, from another cell that it crosses, by the frozen fractions of both: half
    /// of what both exchange, the other half is that of the other front.
    #[inline(always)]
    pub(super) fn along<const L: usize>(
        &self,
        kind: impl Kind<L, Numbers = N, Flags = N::Flags>,
        offset: [f64; 2],
        (frozen, other): (N, N),
    ) -> N {
        let along = self.along_normal(kind, offset);
        let beside = kind.of(4.0) - kind.of(4.0) * along.size() / self.width;
        let (zero, one) = (kind.of(0.0), kind.of(1.0));
        let beside = one.or_less(beside.or_greater(zero));
        kind.of(0.5) * self.slope * (frozen - other) * beside
    }

    /// The part of the heat that comes to a cell on the way of a pair which is that of the next cell on the way, by the frozen
    /// fractions of both: the front cuts the pair between their centres, on average.
    #[inline(always)]
    pub(super) fn part_of_next<const L: usize>(
        &self,
        kind: impl Kind<L, Numbers = N, Flags = N::Flags>,
        (frozen, other): (N, N),
        above: N,
    ) -> N {
        let (zero, half, one) = (kind.of(0.0), kind.of(0.5), kind.of(1.0));
        let both = frozen + other;
        let both = both.or(above.is_less(zero), one + one - both);
        one.or_less((both - half).or_greater(zero))
    }
}

/// Difference of the fractions before and behind a cell from which on it is known which way a front goes that meets another.
const KNOWN: f64 = 0.125;

/// How much the frozen fraction drops from what lies behind cells, with such fractions themselves, to what lies ahead, as far as the
/// front in the cells does it. Another front, which moves toward it, has come from beyond: it adds to the fraction ahead more than
/// goes with those behind and in the middle. Likewise of fronts that move apart.
#[inline(always)]
fn drop<N: Numbers, const L: usize>(kind: impl Kind<L, Numbers = N>, [behind, ahead]: [N; 2], own: N) -> N {
    let (zero, one, twice, plain) = (kind.of(0.0), kind.of(1.0), own + own, behind - ahead);
    let (low, high) = (behind.or_less(ahead), behind.or_greater(ahead));
    let lower = zero.or_greater(low.or_less(twice - high));
    let higher = one.or_less(high.or_greater(twice - low));
    let size = higher - lower;
    let signed = size.or(ahead.is_less(behind), zero - size);
    plain + one.or_less(plain.size() * kind.of(1.0 / KNOWN)) * (signed - plain)
}

impl<const L: usize> Window<L> {
    /// Frozen fractions at a place, by the enthalpies (J/m3) between which particles freeze.
    #[inline(always)]
    pub(super) fn frozen_fraction<K: Kind<L>>(
        &self,
        kind: K,
        place: usize,
        (frozen, unfrozen): (f64, f64),
    ) -> K::Numbers {
        let above = kind.of(unfrozen) - kind.load(&self.enthalpies[place]);
        let fraction = above * kind.of(1.0 / (unfrozen - frozen));
        kind.of(1.0).or_less(kind.of(0.0).or_greater(fraction))
    }

    /// Where the front at a place is another one than that which an end with such a potential above it sees first: behind the place there is
    /// more again of the phase of the end.
    #[inline(always)]
    pub(super) fn meets<K: Kind<L>>(
        &self,
        kind: K,
        above: K::Numbers,
        [place, behind]: [u32; 2],
        interval: (f64, f64),
    ) -> K::Flags {
        let (zero, behind) = (kind.of(0.0), behind as usize);
        let missing = !kind.load(&self.above[behind]).differs(zero) & !kind.flags(&self.freezing[behind]);
        let here = self.frozen_fraction(kind, place as usize, interval);
        let behind = self.frozen_fraction(kind, behind, interval);
        let is_frozen = above.is_less(zero);
        let [less, more] = [here.or(is_frozen, behind), behind.or(is_frozen, here)];
        !missing & (less + kind.of(KNOWN)).is_less(more)
    }

    /// The same. Where there is no particle they go on as from the opposite place to the middle.
    #[inline(always)]
    fn frozen_fractions<K: Kind<L>>(&self, kind: K, place: usize, opposite: usize, interval: (f64, f64)) -> K::Numbers {
        let fractions = self.frozen_fraction(kind, place, interval);
        if self.are_whole {
            return fractions;
        }
        let [mut found, mut beyond] = [[0.0; L]; 2];
        kind.store(fractions, &mut found);
        kind.store(self.frozen_fraction(kind, opposite, interval), &mut beyond);
        for lane in (0..self.count).filter(|lane| !self.is_whole[*lane]) {
            if self.particles[place][lane] == NONE {
                let is_missing = self.particles[opposite][lane] == NONE;
                let beyond = if is_missing { self.fractions[lane] } else { beyond[lane] };
                found[lane] = (2.0 * self.fractions[lane] - beyond).clamp(0.0, 1.0);
            }
        }
        kind.load(&found)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_4;

    use proptest::prelude::*;

    use super::super::numbers::Portable;
    use super::*;

    proptest! {
        /// To a plane front at any angle, each pair carries the heat that flows along it through the phase of its end.
        #[test]
        fn a_pair_carries_what_flows_to_a_plane_front(
            angle in -FRAC_PI_4..FRAC_PI_4, (dx, dy) in (-3..=3_i32, -3..=3_i32), frozen in 0.0..1.0_f64, is_frozen in any::<bool>(),
        ) {
            let normal = [angle.cos(), angle.sin()];
            let one = |number: f64| Portable.load(&[number]);
            let width = normal[0];
            let lies =
                Orientation { normal: normal.map(one), width: one(width), least: one(0.0), slope: one(0.0) };
            let (offset, cells) = ([f64::from(dx), f64::from(dy)], f64::from(dx.abs().max(dy.abs())));
            // Of an end on the frozen side the front lies ahead, of one on the other side behind.
            let (share, ahead) = if is_frozen { (frozen, -1.0) } else { (1.0 - frozen, 1.0) };
            let along = ahead * (normal[0] * offset[0] + normal[1] * offset[1]);
            let distance = along + width * (share - 0.5);
            // Nearer ends are not all in their phase yet.
            prop_assume!(cells > 0.0 && distance >= 0.5 * width);
            let carried = lies.carried(Portable, (offset, cells), (one(ahead * distance), one(0.0)), one(frozen));
            let mut flows = [0.0];
            Portable.store(carried, &mut flows);
            prop_assert!((flows[0] * distance - along).abs() < 1e-12, "{} for {along}", flows[0] * distance);
        }
    }
}
