//! Roots of functions of one number.

/// Root of an increasing function between two bounds by Newton's method, kept inside by bisection.
pub(crate) fn solve_increasing(residual: impl Fn(f64) -> (f64, f64), low: f64, high: f64) -> f64 {
    solve_increasing_from(residual, 0.5 * (low + high), low, high)
}

/// The same from a guess between the bounds.
pub(crate) fn solve_increasing_from(
    residual: impl Fn(f64) -> (f64, f64),
    mut guess: f64,
    mut low: f64,
    mut high: f64,
) -> f64 {
    for _ in 0..200 {
        let (value, slope) = residual(guess);
        if value == 0.0 {
            return guess;
        }
        if value > 0.0 {
            high = guess;
        } else {
            low = guess;
        }
        let newton = guess - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == guess || (high - low) <= f64::EPSILON * high.abs().max(low.abs()) {
            return next;
        }
        guess = next;
    }
    guess
}
