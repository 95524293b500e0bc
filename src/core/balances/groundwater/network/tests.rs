//! Arms of paths.

use proptest::prelude::*;

use super::*;

/// Rows of particles with paths to all within a reach, of which every so many are seen otherwise from one end.
pub(in super::super) fn rows(lengths: &[usize], reach: usize, odd: usize) -> Network {
    let places: Vec<DVec2> = lengths
        .iter()
        .enumerate()
        .flat_map(|(row, length)| (0..*length).map(move |column| 0.1 * DVec2::new(column as f64, row as f64)))
        .collect();
    let mut network = Network { starts: vec![0], ..Network::default() };
    for (i, own) in places.iter().enumerate() {
        for (j, other) in places.iter().enumerate() {
            if i != j && own.distance(*other) < 0.1 * reach as f64 + 0.01 {
                let more = if network.arms.len().is_multiple_of(odd) { DVec2::new(0.02, -0.03) } else { DVec2::ZERO };
                network.partners.push(j as u32);
                network.arms.push(*other - *own + more);
            }
        }
        network.starts.push(network.partners.len());
    }
    network.pair_up(&places).expect("both directions");
    network
}

/// Values of paths by slot; no water goes where there is no path.
pub(in super::super) fn on_paths(network: &Network, value: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut values = vec![0.0; network.places];
    network.each_path(|_, _, slot| values[slot] = value(slot));
    values
}

proptest! {
    /// Gradients by diagonals, and paths beside them, are those by the arm of each path.
    #[test]
    fn diagonals_and_what_is_bent_have_the_slopes_of_all_arms(
        lengths in prop::collection::vec(20_usize..24, 8..16),
        (reach, odd) in (1_usize..4, 5_usize..200),
        numbers in prop::collection::vec(-1.0_f64..1.0, 31),
    ) {
        let mut network = rows(&lengths, reach, odd);
        let drawn = |i: usize| numbers[i * 7 % 31];
        network.weights = on_paths(&network, |slot| drawn(slot).abs());
        let values: Vec<f64> = (0..network.len()).map(|i| drawn(i + 5)).collect();
        let by_arms = |network: &Network, i: usize| {
            let terms = (network.starts[i]..network.starts[i + 1]).map(|k| {
                let rise = values[network.partners[k] as usize] - values[i];
                0.5 * network.weights[network.slots[k] as usize] * rise * network.arms[k]
            });
            terms.fold((DVec2::ZERO, 0.0), |(sum, size), term| (sum + term, size + term.length()))
        };
        let expected: Vec<(DVec2, f64)> = (0..network.len()).map(|i| by_arms(&network, i)).collect();
        network.straighten();
        prop_assert!(network.arms.is_empty());
        let mut places = vec![0.0; network.diagonals.as_ref().expect("a lattice").padded()];
        let mut found = vec![DVec2::ZERO; network.len()];
        network.slopes(None, (&network.weights, &values), &mut places, &mut found);
        for (found, (expected, size)) in found.iter().zip(&expected) {
            // Arms of one diagonal differ by the rounding of places, some twenty terms by that of their sum.
            prop_assert!(found.distance(*expected) <= 1e-13 * (size + 1.0), "{found} for {expected}");
        }
    }
}
