//! Which way fronts lie in the cells that they cross.

use super::pairs::distance;
use super::window::{NONE, Window};

/// Gradient of the frozen fraction (of eight cells, weighted 1, 2, 1) below which a front has no direction: a plane one has
/// about 4.
const LEAST_GRADIENT: f64 = 1.0;

/// How the fronts in the middle of a window lie.
#[derive(Debug, Clone, Copy)]
pub(super) struct Orientation<const L: usize> {
    /// Components along x and y of the normal towards the unfrozen side; zeros where it is not known.
    pub(super) normal: [[f64; L]; 2],
    /// How far (spacings) the front moves while it crosses the cell: from one neighbour to the next along the axis that is
    /// nearer to the normal. Heat by the neighbours along both axes freezes a cell in just this time.
    pub(super) width: [f64; L],
    /// The least distance (spacings) along the normal, by spacings of a pair, that a pair counts as.
    pub(super) least: [f64; L],
    /// Slope of the potential across the front (W/m by spacing), by the shares of both phases in the cell.
    pub(super) slope: [f64; L],
}

impl<const L: usize> Orientation<L> {
    /// Across the axis of each pair.
    pub(super) const FLAT: Self =
        Orientation { normal: [[0.0; L]; 2], width: [1.0; L], least: [1.0; L], slope: [0.0; L] };

    /// From the frozen fractions around the cells, by Youngs' weights, and from the potentials next to them.
    #[inline(always)]
    pub(super) fn of(window: &Window<L>, interval: (f64, f64)) -> Self {
        let mut found = Self::FLAT;
        let (middle, width) = (window.above.len() / 2, window.width);
        let place = |dx: isize, dy: isize| middle.wrapping_add_signed(dx + dy * width as isize);
        let fraction = |dx: isize, dy: isize| window.frozen_fractions(place(dx, dy), place(-dx, -dy), interval);
        let mut gradient = [[0.0; L]; 2];
        for (dx, dy, along_x, along_y) in [(1, 0, 2.0, 0.0), (0, 1, 0.0, 2.0), (1, 1, 1.0, 1.0), (1, -1, 1.0, -1.0)] {
            let (behind, ahead) = (fraction(-dx, -dy), fraction(dx, dy));
            for lane in 0..L {
                let drop = behind[lane] - ahead[lane];
                gradient[0][lane] += along_x * drop;
                gradient[1][lane] += along_y * drop;
            }
        }
        for lane in 0..L {
            let (x, y) = (gradient[0][lane], gradient[1][lane]);
            let size = (x * x + y * y).sqrt();
            let is_known = size >= LEAST_GRADIENT;
            let scale = if is_known { 1.0 / size } else { 0.0 };
            (found.normal[0][lane], found.normal[1][lane]) = (x * scale, y * scale);
            let width = (x * scale).abs().max((y * scale).abs());
            found.width[lane] = if is_known { width } else { 1.0 };
            found.least[lane] = if is_known { 0.5 * width } else { 1.0 };
        }
        let mut slopes = [[0.0; L]; 2];
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let (above, beyond) = (window.above[place(dx, dy)], window.above[place(-dx, -dy)]);
            for lane in 0..L {
                let frozen = above[lane] < 0.0;
                let share = if frozen { window.fractions[lane] } else { 1.0 - window.fractions[lane] };
                let slope =
                    if above[lane] * beyond[lane] > 0.0 { 0.0 } else { above[lane].abs() / distance(1.0, share) };
                slopes[0][lane] = if frozen && slope > slopes[0][lane] { slope } else { slopes[0][lane] };
                slopes[1][lane] = if !frozen && slope > slopes[1][lane] { slope } else { slopes[1][lane] };
            }
        }
        for lane in 0..L {
            let frozen = window.fractions[lane];
            let slope = frozen * slopes[0][lane] + (1.0 - frozen) * slopes[1][lane];
            found.slope[lane] = if found.least[lane] < 1.0 { slope } else { 0.0 };
        }
        found
    }

    /// How many times as much as the plain one a pair to an offset carries, over so many spacings, by the potential of its
    /// end above that of the front and by that on the opposite side: the distance is along the pair. Where both sides are in
    /// the same phase two fronts move toward each other, and each has half of the cell.
    #[inline(always)]
    pub(super) fn carried(
        &self,
        (offset, cells): ([f64; 2], f64),
        (above, beyond): (f64, f64),
        frozen: f64,
        lane: usize,
    ) -> f64 {
        let two = above * beyond > 0.0;
        let along = self.normal[0][lane] * offset[0] + self.normal[1][lane] * offset[1];
        let (share, along) = if above < 0.0 { (frozen, -along) } else { (1.0 - frozen, along) };
        let least = cells * self.least[lane];
        let far = if along > least { along } else { least };
        let (whole, width, share) = if two { (cells, 1.0, 0.5 * share) } else { (far, self.width[lane], share) };
        let (part, nearest) = (whole + width * (share - 0.5), whole * (0.5 / cells));
        whole / if part > nearest { part } else { nearest }
    }

    /// Heat by weight (W/m) that comes along a front, from another cell that it crosses, by the frozen fractions of both: half
    /// of what both exchange, the other half is that of the other front. None comes from a front that lies ahead or behind.
    #[inline(always)]
    pub(super) fn along(&self, offset: [f64; 2], (frozen, other): (f64, f64), lane: usize) -> f64 {
        0.5 * self.slope[lane] * (frozen - other) * self.beside(offset, lane)
    }

    /// How much a cell counts as beside this one and not ahead or behind.
    #[inline(always)]
    pub(super) fn beside(&self, offset: [f64; 2], lane: usize) -> f64 {
        let along = self.normal[0][lane] * offset[0] + self.normal[1][lane] * offset[1];
        let beside = 4.0 - 4.0 * along.abs() / self.width[lane];
        if beside > 1.0 {
            1.0
        } else if beside > 0.0 {
            beside
        } else {
            0.0
        }
    }
}

impl<const L: usize> Window<L> {
    /// Frozen fraction at a place, by the enthalpies (J/m3) between which particles freeze.
    #[inline(always)]
    pub(super) fn frozen_fraction(&self, place: usize, lane: usize, (frozen, unfrozen): (f64, f64)) -> f64 {
        let fraction = (unfrozen - self.enthalpies[place][lane]) * (1.0 / (unfrozen - frozen));
        fraction.clamp(0.0, 1.0)
    }

    /// Frozen fractions at a place. Where there is no particle they go on as from the opposite place to the middle.
    #[inline(always)]
    fn frozen_fractions(&self, place: usize, opposite: usize, interval: (f64, f64)) -> [f64; L] {
        let mut fractions = [0.0; L];
        for lane in 0..L {
            fractions[lane] = self.frozen_fraction(place, lane, interval);
        }
        for lane in (0..self.count).filter(|lane| !self.is_whole[*lane]) {
            if self.particles[place][lane] == NONE {
                let beyond = if self.particles[opposite][lane] == NONE {
                    self.fractions[lane]
                } else {
                    self.frozen_fraction(opposite, lane, interval)
                };
                fractions[lane] = (2.0 * self.fractions[lane] - beyond).clamp(0.0, 1.0);
            }
        }
        fractions
    }
}
