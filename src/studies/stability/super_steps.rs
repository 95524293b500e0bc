//! What theory says of RKL2 beyond its stated step.

use super::search;

/// Steps over the stated one that are tried: from the stated one itself to four times it.
pub fn grid() -> Vec<f64> {
    search::grid(1.0, 4.0, 7)
}

/// How far the stability of RKL2 on the negative real axis reaches beyond `(s^2 + s - 2)/2`, which its stated step fills
/// (Meyer, Balsara and Aslam 2014): one for even stages. With an odd number the polynomial `1 - b + b P_s(x)` ends near
/// zero there and passes -1 only further on.
pub fn limit(stages: usize) -> f64 {
    if stages.is_multiple_of(2) {
        return 1.0;
    }
    let s = stages as f64;
    let b = (s * s + s - 2.0) / (2.0 * s * (s + 1.0));
    let beyond = |x: f64| 1.0 - b + b * legendre(stages, x) < -1.0;
    // P_s falls without end below -1.
    let (mut inside, mut outside) = (-1.0, -2.0);
    while outside < inside {
        let middle = 0.5 * (inside + outside);
        if middle == inside || middle == outside {
            break;
        }
        if beyond(middle) { outside = middle } else { inside = middle }
    }
    0.5 * (1.0 - inside)
}

/// Legendre polynomial by its recursion.
fn legendre(degree: usize, x: f64) -> f64 {
    let (mut before, mut own) = (1.0, x);
    for k in 2..=degree {
        let k = k as f64;
        (before, own) = (own, ((2.0 * k - 1.0) * x * own - (k - 1.0) * before) / k);
    }
    if degree == 0 { before } else { own }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_stages_reach_a_little_further() {
        // s = 3: b = 5/12, so P_3 = (5 x^3 - 3 x)/2 = -19/5, that is 5 x^3 - 3 x + 38/5 = 0.
        let x = 1.0 - 2.0 * limit(3);
        assert!((5.0 * x.powi(3) - 3.0 * x + 7.6).abs() < 1e-12, "{x}");
        assert_eq!(limit(4), 1.0);
        let odd: Vec<f64> = (3..=39).step_by(2).map(limit).collect();
        assert!(odd.windows(2).all(|pair| 1.0 < pair[1] && pair[1] < pair[0]), "{odd:?}");
    }
}
