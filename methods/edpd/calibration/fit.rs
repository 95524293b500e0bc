//! Polynomials by least squares, to set beside exponents that are solved for.

/// A polynomial by its coefficients, the constant first.
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomial {
    /// Coefficients of the powers 0, 1, 2, ...
    pub coefficients: Vec<f64>,
}

impl Polynomial {
    /// Its value.
    pub fn at(&self, x: f64) -> f64 {
        self.coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
    }

    /// Coefficient of determination on some points, 1 where it passes through all of them.
    pub fn determination(&self, points: &[(f64, f64)]) -> f64 {
        let mean = points.iter().map(|point| point.1).sum::<f64>() / points.len() as f64;
        let left: f64 = points.iter().map(|(x, y)| (y - self.at(*x)).powi(2)).sum();
        let whole: f64 = points.iter().map(|(_, y)| (y - mean).powi(2)).sum();
        if left == 0.0 { 1.0 } else { 1.0 - left / whole }
    }
}

/// The polynomial of a degree with the least sum of squares; `None` unless there are more points of different `x` than
/// the degree.
pub fn least_squares(points: &[(f64, f64)], degree: usize) -> Option<Polynomial> {
    let ends = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (x, _)| (a.min(*x), b.max(*x)));
    let mut different: Vec<f64> = points.iter().map(|point| point.0).collect();
    different.sort_by(f64::total_cmp);
    different.dedup();
    if different.len() <= degree {
        return None;
    }
    // On [-1, 1] the normal equations are well conditioned for the degrees that anyone fits.
    let (middle, half) = (0.5 * (ends.0 + ends.1), (0.5 * (ends.1 - ends.0)).max(f64::MIN_POSITIVE));
    let count = degree + 1;
    let mut matrix = vec![vec![0.0; count + 1]; count];
    for (x, y) in points {
        let t = (x - middle) / half;
        for (i, row) in matrix.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += if j < count { t.powi((i + j) as i32) } else { y * t.powi(i as i32) };
            }
        }
    }
    let scaled = eliminate(matrix);
    // Powers of (x - middle) / half multiplied out.
    let mut coefficients = vec![0.0; count];
    for own in scaled.iter().rev() {
        let mut next = vec![0.0; count];
        for (k, coefficient) in coefficients.iter().enumerate() {
            next[k] -= coefficient * middle / half;
            if k + 1 < count {
                next[k + 1] += coefficient / half;
            }
        }
        next[0] += own;
        coefficients = next;
    }
    Some(Polynomial { coefficients })
}

/// Solves a symmetric positive definite system that is given with its right side as a last column.
fn eliminate(mut matrix: Vec<Vec<f64>>) -> Vec<f64> {
    let count = matrix.len();
    for pivot in 0..count {
        let (above, below) = matrix.split_at_mut(pivot + 1);
        let row = &above[pivot];
        for other in below {
            let factor = other[pivot] / row[pivot];
            for (entry, own) in other.iter_mut().zip(row).skip(pivot) {
                *entry -= factor * own;
            }
        }
    }
    let mut solution = vec![0.0; count];
    for k in (0..count).rev() {
        let known: f64 = (k + 1..count).map(|j| matrix[k][j] * solution[j]).sum();
        solution[k] = (matrix[k][count] - known) / matrix[k][k];
    }
    solution
}
