//! Conduction and nothing else, written by hand: explicit steps of one linear material on a plane of even rows, the
//! left wall at a temperature or a symmetry plane, the others symmetry planes.
//!
//! The order of operations is that of the sweep of the program, products fused where it fuses them, so that both give the same
//! bits; but column sums go through a buffer in the first cache. What conduction does not need is gone: in place of a law there
//! is a constant, and there are no general walls, no booking of heat, no pipes, no corners, no bands for threads.

use frazil_core::bonds::stencil::Stencil;

const LANES: usize = 8;
const BLOCK: usize = 256;

/// The body. `REACH` is that of the stencil, whose weights lie in a disc; `WALL` tells whether the left wall has a
/// temperature.
pub struct ByHand<const REACH: usize, const WALL: bool> {
    columns: usize,
    rows: usize,
    /// Enthalpies (J/m3) less those at the start, row by row.
    pub state: Vec<f64>,
    /// Potential per enthalpy (m2/s): the diffusivity.
    diffusivity: f64,
    /// Potential (W/m) of the left wall less that at the start.
    wall: f64,
    step: f64,
    weights: [[f64; 9]; 9],
    sum: f64,
    width: usize,
    ring: Vec<f64>,
    sums: Vec<Sums>,
}

/// Column sums of one distance, on cache lines of their own.
#[derive(Clone)]
#[repr(align(64))]
struct Sums([f64; BLOCK + 32]);

impl<const REACH: usize, const WALL: bool> ByHand<REACH, WALL> {
    /// A body at rest.
    pub fn new(side: usize, stencil: &Stencil, diffusivity: f64, wall: f64, step: f64) -> Self {
        let (columns, rows) = (side, side);
        assert!(stencil.reach == REACH && stencil.fits_disc());
        let mut weights = [[0.0; 9]; 9];
        for (k, by_row) in weights.iter_mut().enumerate() {
            for (dy, weight) in by_row.iter_mut().enumerate() {
                *weight = stencil.at(k, dy);
            }
        }
        let width = (columns + 2 * REACH + 2 * LANES).next_multiple_of(LANES);
        ByHand {
            columns,
            rows,
            state: vec![0.0; columns * rows],
            diffusivity,
            wall,
            step,
            weights,
            sum: stencil.sum(),
            width,
            ring: vec![0.0; (2 * REACH + 1) * width],
            sums: vec![Sums([0.0; BLOCK + 32]); REACH + 1],
        }
    }

    /// One step.
    pub fn step(&mut self) {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
                // SAFETY: the processor has just been asked for these features.
                return unsafe { self.step_avx512() };
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                // SAFETY: as above.
                return unsafe { self.step_avx2() };
            }
        }
        self.rows();
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512vl")]
    fn step_avx512(&mut self) {
        self.rows();
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    fn step_avx2(&mut self) {
        self.rows();
    }

    /// Keeps the potentials of a row in the ring, ghosts included.
    #[inline(always)]
    fn keep(&mut self, row: usize) {
        let own = &self.state[row * self.columns..(row + 1) * self.columns];
        let slot = &mut self.ring[row % (2 * REACH + 1) * self.width..][..self.width];
        for (slot, own) in slot[REACH..REACH + self.columns].iter_mut().zip(own) {
            *slot = self.diffusivity * own;
        }
        for layer in 0..REACH {
            let image = slot[REACH + layer];
            slot[REACH - 1 - layer] = if WALL { 2.0 * self.wall - image } else { image };
            slot[REACH + self.columns + layer] = slot[REACH + self.columns - 1 - layer];
        }
    }

    #[inline(always)]
    fn rows(&mut self) {
        for row in 0..REACH {
            self.keep(row);
        }
        for row in 0..self.rows {
            if row + REACH < self.rows {
                self.keep(row + REACH);
            }
            // Rows beyond the edges are mirror images of rows within.
            let slot = |offset: usize| {
                let place = (row + offset) as isize - REACH as isize;
                let last = self.rows as isize - 1;
                let place = if place < 0 { -1 - place } else { place.min(2 * last + 1 - place) };
                &self.ring[place as usize % (2 * REACH + 1) * self.width..][..self.width]
            };
            let mut near: [&[f64]; 17] = [&[]; 17];
            for (offset, near) in near.iter_mut().enumerate().take(2 * REACH + 1) {
                *near = slot(offset);
            }
            let own = &mut self.state[row * self.columns..(row + 1) * self.columns];
            for (number, own) in own.chunks_mut(BLOCK).enumerate() {
                block::<REACH>(&self.weights, self.sum, &near, number * BLOCK, own, self.step, &mut self.sums);
            }
        }
    }
}

#[inline(always)]
fn groups_of(values: &[f64], groups: usize) -> &[[f64; LANES]] {
    &values[..groups * LANES].as_chunks::<LANES>().0[..groups]
}

/// Whether the row itself is all that carries weight at a distance, so that its column sum waits for its weight.
#[inline(always)]
const fn is_bare<const REACH: usize>(k: usize) -> bool {
    k * k + 1 > REACH * REACH
}

#[inline(always)]
fn block<const REACH: usize>(
    weights: &[[f64; 9]; 9],
    sum: f64,
    near: &[&[f64]; 17],
    column: usize,
    own: &mut [f64],
    step: f64,
    sums: &mut [Sums],
) {
    let groups = (own.len() + 2 * REACH).div_ceil(LANES);
    let mut rows = [&[][..]; 17];
    for (row, near) in rows.iter_mut().zip(near).take(2 * REACH + 1) {
        *row = groups_of(&near[column..], groups);
    }
    let sums = &mut sums[..REACH + 1];
    for group in 0..groups {
        // As in the program: keeps the compiler from a second, slower vectorisation across groups.
        if REACH < 3 && std::hint::black_box(false) {
            break;
        }
        let mut folded = [[0.0; LANES]; 9];
        folded[0] = rows[REACH][group];
        for dy in 1..=REACH {
            for lane in 0..LANES {
                folded[dy][lane] = rows[REACH - dy][group][lane] + rows[REACH + dy][group][lane];
            }
        }
        for k in 0..=REACH {
            let mut total = [0.0; LANES];
            for lane in 0..LANES {
                total[lane] = match k {
                    0 => -(sum * folded[0][lane]),
                    _ if is_bare::<REACH>(k) => folded[0][lane],
                    _ => weights[k][0] * folded[0][lane],
                };
            }
            for dy in 1..=REACH {
                if k * k + dy * dy <= REACH * REACH {
                    for lane in 0..LANES {
                        total[lane] = weights[k][dy].mul_add(folded[dy][lane], total[lane]);
                    }
                }
            }
            sums[k].0[group * LANES..(group + 1) * LANES].copy_from_slice(&total);
        }
    }
    // Every particle adds the column sums from its left and right.
    let whole = own.len() / LANES;
    let (mut left, mut right) = ([&[][..]; 9], [&[][..]; 9]);
    for k in 0..=REACH {
        left[k] = groups_of(&sums[k].0[REACH - k..], whole);
        right[k] = groups_of(&sums[k].0[REACH + k..], whole);
    }
    let (groups, rest) = own.as_chunks_mut::<LANES>();
    for (group, own) in groups.iter_mut().enumerate() {
        if REACH < 3 && std::hint::black_box(false) {
            break;
        }
        let mut total = left[0][group];
        for k in 1..=REACH {
            for lane in 0..LANES {
                let pair = left[k][group][lane] + right[k][group][lane];
                total[lane] =
                    if is_bare::<REACH>(k) { weights[k][0].mul_add(pair, total[lane]) } else { total[lane] + pair };
            }
        }
        for lane in 0..LANES {
            own[lane] = step.mul_add(total[lane], own[lane]);
        }
    }
    for (i, own) in rest.iter_mut().enumerate() {
        let place = REACH + whole * LANES + i;
        let mut total = sums[0].0[place];
        for (k, sums) in sums.iter().enumerate().skip(1) {
            let pair = sums.0[place - k] + sums.0[place + k];
            total = if is_bare::<REACH>(k) { weights[k][0].mul_add(pair, total) } else { total + pair };
        }
        *own = step.mul_add(total, *own);
    }
}
