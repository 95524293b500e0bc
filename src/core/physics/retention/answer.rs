//! How far the content of a particle goes when the linearised system of all wants a change of it.
//!
//! A particle's own potential, and its own conductivity where gravity pulls, hold back its content: with f(H) for both, times what a
//! step has of them, its equation is `H + f(H) = known`, where its neighbours are known. Potential and conductivity bend so much
//! near saturation that a step along their tangent may lead anywhere. The content whose sum with f changes by as much as on the
//! tangent leads to the same place where f is straight, and to the solution at once where neighbours stand still (after the
//! parametrisation of Brenner and Cancès 2017, SIAM J. Numer. Anal. 55).

/// Change of 1 + df/dH by a factor below which the tangent is as good.
const BENDS: f64 = 1.25;

/// Accuracy of the answer, over the change on the tangent: what is left is for the next iteration.
const ACCURACY: f64 = 1e-6;

/// Steps towards it. A bracket halves in each at worst.
const MOST_STEPS: u32 = 60;

/// The content after a change on the tangent, where `holds` gives f and df/dH at a content; `slope` is df/dH before.
pub fn answer(content: f64, change: f64, slope: f64, holds: impl Fn(f64) -> (f64, f64)) -> f64 {
    let on_tangent = content + change;
    let (_, beyond) = holds(on_tangent);
    let bends = (1.0 + beyond) / (1.0 + slope);
    if bends < BENDS && bends > 1.0 / BENDS {
        return on_tangent;
    }
    let (wanted, (own, _)) = (change * (1.0 + slope), holds(content));
    let missing = |at: f64| {
        let (held, slope) = holds(at);
        (at - content + held - own - wanted, 1.0 + slope)
    };
    // f rises, so the answer lies between the content and what the sum would be without it.
    let (mut low, mut high) = if change > 0.0 { (content, content + wanted) } else { (content + wanted, content) };
    let mut at = on_tangent;
    for _ in 0..MOST_STEPS {
        let (off, slope) = missing(at);
        if off > 0.0 {
            high = at
        } else {
            low = at
        }
        let next = at - off / slope;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - at).abs() <= ACCURACY * change.abs() {
            return next;
        }
        at = next;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The sum changes by as much as on the tangent, whatever bends.
        #[test]
        fn sums_change_as_on_the_tangent(content in -1.0..1.0f64, change in -1.0..1.0f64, stiffness in 1e-3..1e6f64) {
            // Flat below, steep above, with a kink.
            let holds = |at: f64| if at < 0.0 { (stiffness * at.exp(), stiffness * at.exp()) } else { (stiffness * (1.0 + 9.0 * at), 9.0 * stiffness) };
            let (before, slope) = holds(content);
            let found = answer(content, change, slope, holds);
            let (after, _) = holds(found);
            let (sum, wanted) = (found - content + after - before, change * (1.0 + slope));
            let bent = (1.0 + holds(content + change).1) / (1.0 + slope);
            if (1.0 / BENDS..BENDS).contains(&bent) {
                prop_assert_eq!(found, content + change);
            } else {
                prop_assert!((sum - wanted).abs() <= 2.0 * ACCURACY * change.abs() * (1.0 + 9.0 * stiffness), "{sum} {wanted}");
            }
            prop_assert!((found - content) * change >= 0.0);
        }
    }
}
