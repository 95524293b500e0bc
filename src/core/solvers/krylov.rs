//! Iterative solution of linear systems of any size: conjugate gradients where the matrix is symmetric, stabilised
//! bi-conjugate gradients (van der Vorst 1992) elsewhere, both preconditioned by a diagonal.
//!
//! Sums run over particles in order, so the result does not depend on the number of threads.

use crate::memory::HeapSize;

/// Iterations after which a solve gives up: its caller shortens the step.
const MOST_ITERATIONS: usize = 3000;

/// Work columns of a solver.
#[derive(Debug, Clone)]
pub struct Krylov {
    symmetric: bool,
    residual: Vec<f64>,
    direction: Vec<f64>,
    shaped: Vec<f64>,
    image: Vec<f64>,
    /// For unsymmetric systems alone.
    shadow: Vec<f64>,
    second_image: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    // Four sums side by side, in an order of their own that never changes.
    let mut sums = [0.0; 4];
    let (a4, a_rest) = a.as_chunks::<4>();
    let (b4, b_rest) = b.as_chunks::<4>();
    for (a, b) in a4.iter().zip(b4) {
        for lane in 0..4 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

impl Krylov {
    /// Columns for `count` unknowns.
    pub fn new(count: usize, symmetric: bool) -> Self {
        let column = || vec![0.0; count];
        let extra = || if symmetric { Vec::new() } else { vec![0.0; count] };
        Krylov {
            symmetric,
            residual: column(),
            direction: column(),
            shaped: column(),
            image: column(),
            shadow: extra(),
            second_image: extra(),
        }
    }

    /// Solves `matrix * solution = right` until the residual has fallen to `relative` of the right side, and returns the
    /// number of products with the matrix. `diagonal` divides residuals.
    pub fn solve(
        &mut self,
        matrix: impl FnMut(&[f64], &mut [f64]),
        diagonal: &[f64],
        right: &[f64],
        solution: &mut [f64],
        relative: f64,
    ) -> u64 {
        solution.fill(0.0);
        let target = relative * dot(right, right).sqrt();
        if target == 0.0 {
            return 0;
        }
        self.residual.copy_from_slice(right);
        if self.symmetric {
            self.conjugate_gradients(matrix, diagonal, solution, target)
        } else {
            self.stabilised(matrix, diagonal, solution, target)
        }
    }

    fn conjugate_gradients(
        &mut self,
        mut matrix: impl FnMut(&[f64], &mut [f64]),
        diagonal: &[f64],
        solution: &mut [f64],
        target: f64,
    ) -> u64 {
        let Krylov { residual, direction, shaped, image, .. } = self;
        let mut product = 0.0;
        for iteration in 0..MOST_ITERATIONS {
            for (shaped, (residual, diagonal)) in shaped.iter_mut().zip(residual.iter().zip(diagonal)) {
                *shaped = residual / diagonal;
            }
            let next = dot(residual, shaped);
            let turn = if iteration == 0 { 0.0 } else { next / product };
            product = next;
            for (direction, shaped) in direction.iter_mut().zip(shaped.iter()) {
                *direction = shaped + turn * if iteration == 0 { 0.0 } else { *direction };
            }
            matrix(direction, image);
            let length = product / dot(direction, image);
            for (solution, direction) in solution.iter_mut().zip(direction.iter()) {
                *solution += length * direction;
            }
            for (residual, image) in residual.iter_mut().zip(image.iter()) {
                *residual -= length * image;
            }
            if dot(residual, residual).sqrt() <= target {
                return iteration as u64 + 1;
            }
        }
        MOST_ITERATIONS as u64
    }

    fn stabilised(
        &mut self,
        mut matrix: impl FnMut(&[f64], &mut [f64]),
        diagonal: &[f64],
        solution: &mut [f64],
        target: f64,
    ) -> u64 {
        let Krylov { residual, direction, shaped, image, shadow, second_image, .. } = self;
        shadow.copy_from_slice(residual);
        direction.copy_from_slice(residual);
        let mut product = dot(shadow, residual);
        let mut products = 0;
        while products < MOST_ITERATIONS as u64 {
            for (shaped, (direction, diagonal)) in shaped.iter_mut().zip(direction.iter().zip(diagonal)) {
                *shaped = direction / diagonal;
            }
            matrix(shaped, image);
            let alpha = product / dot(shadow, image);
            for (solution, shaped) in solution.iter_mut().zip(shaped.iter()) {
                *solution += alpha * shaped;
            }
            for (residual, image) in residual.iter_mut().zip(image.iter()) {
                *residual -= alpha * image;
            }
            for (shaped, (residual, diagonal)) in shaped.iter_mut().zip(residual.iter().zip(diagonal)) {
                *shaped = residual / diagonal;
            }
            matrix(shaped, second_image);
            products += 2;
            let square = dot(second_image, second_image);
            let omega = if square > 0.0 { dot(second_image, residual) / square } else { 0.0 };
            for (solution, shaped) in solution.iter_mut().zip(shaped.iter()) {
                *solution += omega * shaped;
            }
            for (residual, image) in residual.iter_mut().zip(second_image.iter()) {
                *residual -= omega * image;
            }
            if dot(residual, residual).sqrt() <= target {
                break;
            }
            let next = dot(shadow, residual);
            if omega == 0.0 || next.abs() < 1e-30 * product.abs() || !next.is_finite() {
                // The two sequences have lost each other: start again from here.
                shadow.copy_from_slice(residual);
                direction.copy_from_slice(residual);
                product = dot(shadow, residual);
                continue;
            }
            let beta = next / product * alpha / omega;
            product = next;
            for (direction, (residual, image)) in direction.iter_mut().zip(residual.iter().zip(image.iter())) {
                *direction = residual + beta * (*direction - omega * image);
            }
        }
        products
    }
}

impl HeapSize for Krylov {
    fn heap_size(&self) -> usize {
        let columns = [&self.residual, &self.direction, &self.shaped, &self.image, &self.shadow, &self.second_image];
        columns.into_iter().map(HeapSize::heap_size).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Both solvers meet their target on dominated matrices, symmetric and not.
        #[test]
        fn residuals_fall_to_the_target(
            numbers in prop::collection::vec(-1.0..0.0f64, 12 * 12),
            right in prop::collection::vec(-1.0..1.0f64, 12),
            symmetric: bool,
        ) {
            let entry = |i: usize, j: usize| {
                if i == j {
                    13.0
                } else if symmetric {
                    numbers[i.min(j) * 12 + i.max(j)]
                } else {
                    numbers[i * 12 + j]
                }
            };
            let matrix = |vector: &[f64], out: &mut [f64]| {
                for (i, out) in out.iter_mut().enumerate() {
                    *out = (0..12).map(|j| entry(i, j) * vector[j]).sum();
                }
            };
            let mut solution = vec![0.0; 12];
            Krylov::new(12, symmetric).solve(matrix, &[13.0; 12], &right, &mut solution, 1e-10);
            let mut image = vec![0.0; 12];
            matrix(&solution, &mut image);
            let missing = image.iter().zip(&right).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
            // Ten times the target, for the residual is carried along and not computed anew.
            prop_assert!(missing <= 1e-9 * dot(&right, &right).sqrt(), "{missing:e}");
        }
    }
}
