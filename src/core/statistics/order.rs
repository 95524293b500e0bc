//! Straight lines through logarithms: orders of convergence, and costs at equal error.

use crate::statistics::{Interval, student_t};

/// Least-squares line through points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Slope.
    pub slope: f64,
    /// Value at zero.
    pub intercept: f64,
    /// Share of the variance that the line explains.
    pub r_squared: f64,
    /// Student t interval of the slope; absent for two points.
    pub slope_interval: Option<Interval>,
}

/// Least-squares line. Absent unless two points differ in x and all are finite.
pub fn line(x: &[f64], y: &[f64]) -> Option<Line> {
    let count = x.len();
    if count < 2 || count != y.len() || x.iter().chain(y).any(|value| !value.is_finite()) {
        return None;
    }
    let size = count as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / size, y.iter().sum::<f64>() / size);
    let products = |a: &[f64], mean_a: f64, b: &[f64], mean_b: f64| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum()
    };
    let (xx, xy, yy) = (products(x, mean_x, x, mean_x), products(x, mean_x, y, mean_y), products(y, mean_y, y, mean_y));
    if xx == 0.0 {
        return None;
    }
    let slope = xy / xx;
    let left = (yy - slope * xy).max(0.0);
    let r_squared = if yy > 0.0 { 1.0 - left / yy } else { 1.0 };
    let slope_interval = match count {
        2 => None,
        _ => student_t(size - 2.0).map(|t| Interval::around(slope, t * (left / (size - 2.0) / xx).sqrt())),
    };
    Some(Line { slope, intercept: mean_y - slope * mean_x, r_squared, slope_interval })
}

/// Least share of the variance that a straight line must explain for an order of convergence to be quoted.
const STRAIGHT: f64 = 0.98;

/// Observed order of convergence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Order {
    /// Power of the spacing that the error follows.
    pub order: f64,
    /// Share of the variance explained.
    pub r_squared: f64,
    /// Student t interval of the order.
    pub interval: Interval,
}

/// Observed order of signed errors over spacings by least squares in logarithms.
///
/// None if there are fewer than three points, if the error changes its sign or vanishes, or if the points do not
/// lie on a line (R2 below 0.98): then no order should be quoted.
pub fn observed_order(spacings: &[f64], errors: &[f64]) -> Option<Order> {
    let same_sign = errors.iter().all(|error| *error > 0.0) || errors.iter().all(|error| *error < 0.0);
    if spacings.len() < 3 || !same_sign || spacings.iter().any(|spacing| spacing.is_nan() || *spacing <= 0.0) {
        return None;
    }
    let logarithms = |values: &[f64]| values.iter().map(|value| value.abs().ln()).collect::<Vec<_>>();
    let fit = line(&logarithms(spacings), &logarithms(errors))?;
    let interval = fit.slope_interval?;
    (fit.r_squared >= STRAIGHT).then_some(Order { order: fit.slope, r_squared: fit.r_squared, interval })
}

/// Cost at which an error is reached on a front of (error, cost) points, linear in the logarithms of both between
/// neighbours. None outside the range of the front: nothing is extrapolated.
pub fn cost_at_error(front: &[(f64, f64)], target: f64) -> Option<f64> {
    interpolate_logarithms(front, target)
}

/// Error that is reached at a cost on a front of (error, cost) points, in the same way.
pub fn error_at_cost(front: &[(f64, f64)], cost: f64) -> Option<f64> {
    let turned: Vec<(f64, f64)> = front.iter().map(|&(error, cost)| (cost, error)).collect();
    interpolate_logarithms(&turned, cost)
}

fn interpolate_logarithms(points: &[(f64, f64)], at: f64) -> Option<f64> {
    let is_positive = |value: f64| value > 0.0 && value.is_finite();
    if !is_positive(at) || points.iter().any(|point| !is_positive(point.0) || !is_positive(point.1)) {
        return None;
    }
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let after = points.partition_point(|point| point.0 < at);
    let next = points.get(after)?;
    if next.0 == at {
        return Some(next.1);
    }
    let before = points.get(after.checked_sub(1)?)?;
    let share = (at / before.0).ln() / (next.0 / before.0).ln();
    Some((before.1.ln() + share * (next.1 / before.1).ln()).exp())
}
