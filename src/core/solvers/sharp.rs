//! The sharp limit of explicit steps: two over the largest rate of decay, by power iteration.

use crate::solvers::balance::Tangent;

/// Iterations, and the relative change of the estimate at which they end. The largest rates lie close together, so the
/// vector keeps turning long after its rate is known.
const ITERATIONS: usize = 2000;
const SETTLED: f64 = 1e-7;

/// Longest step (s) for which explicit Euler is linearly stable, if every particle conducts with its slope dU/dH
/// (m2/s). `act` gives the rates that changes of potentials cause.
fn stable_step(slopes: &[f64], mut act: impl FnMut(&[f64], &mut [f64])) -> f64 {
    let count = slopes.len();
    let roots: Vec<f64> = slopes.iter().map(|slope| slope.sqrt()).collect();
    // Neighbours of opposite sign decay fastest; a little unevenness lets every pattern grow.
    let mut vector: Vec<f64> = (0..count).map(|i| 0.5 - ((i * 7919) % 1009) as f64 / 1009.0).collect();
    let (mut shaped, mut image) = (vec![0.0; count], vec![0.0; count]);
    let (mut rate, mut settled): (f64, u32) = (0.0, 0);
    for _ in 0..ITERATIONS {
        let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
        if length == 0.0 {
            return f64::INFINITY;
        }
        for ((shaped, vector), root) in shaped.iter_mut().zip(&mut vector).zip(&roots) {
            *vector /= length;
            *shaped = root * *vector;
        }
        act(&shaped, &mut image);
        let mut next = 0.0;
        for ((vector, image), root) in vector.iter_mut().zip(&image).zip(&roots) {
            let turned = -root * image;
            next += *vector * turned;
            *vector = turned;
        }
        settled = if (next - rate).abs() <= SETTLED * next { settled + 1 } else { 0 };
        rate = next;
        if settled == 10 {
            break;
        }
    }
    if rate > 0.0 { 2.0 / rate } else { f64::INFINITY }
}

/// The sharp limit of a balance's explicit steps (s).
pub fn sharp_step(tangent: &mut dyn Tangent) -> f64 {
    let slopes = tangent.steepest();
    let state = vec![0.0; slopes.len()];
    tangent.linearise(&state, 0.0, &mut slopes.clone());
    stable_step(&slopes, |potentials, rate| tangent.act(potentials, rate))
}

/// How far before its end, over its length, a step takes its last rates: walls that jump and pipes that are switched at
/// the end do so after the step.
const BEFORE_THE_END: f64 = 1e-6;

/// The time (s) at which a step from `time` on takes its last rates.
pub(crate) fn just_before(time: f64, step: f64) -> f64 {
    time + step * (1.0 - BEFORE_THE_END)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second difference on a line of n particles between held ends has the largest rate 4 sin^2(n pi / 2 (n+1)).
    #[test]
    fn a_known_spectrum_is_found() {
        for count in [1usize, 2, 17, 200] {
            let act = |v: &[f64], out: &mut [f64]| {
                for i in 0..count {
                    let left = if i == 0 { 0.0 } else { v[i - 1] };
                    let right = v.get(i + 1).copied().unwrap_or(0.0);
                    out[i] = left - 2.0 * v[i] + right;
                }
            };
            let n = count as f64;
            let rate = 4.0 * (n * std::f64::consts::FRAC_PI_2 / (n + 1.0)).sin().powi(2);
            let found = stable_step(&vec![1.0; count], act);
            // Rayleigh quotients settle to the change that ends the iteration, times the number of iterations left.
            assert!((found * rate / 2.0 - 1.0).abs() < 1e-3, "{count}: {found} {}", 2.0 / rate);
        }
    }
}
