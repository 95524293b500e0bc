//! Bands and threads of a solution.

use proptest::prelude::*;

use super::*;
use crate::balances::groundwater::network::MOST_WALLS;

/// Particles of a lattice with paths to all within a reach, and openings along its first row, on diagonals or not.
fn lattice(columns: usize, rows: usize, reach: usize, on_diagonals: bool, weights: &[f64]) -> (Network, Vec<DVec2>) {
    let places: Vec<DVec2> =
        (0..columns * rows).map(|i| DVec2::new((i % columns) as f64, (i / columns) as f64)).collect();
    let mut network = Network { starts: vec![0], ..Network::default() };
    for (i, own) in places.iter().enumerate() {
        let near = |j: &usize| *j != i && own.distance(places[*j]) < reach as f64 + 0.1;
        network.partners.extend((0..places.len()).filter(near).map(|j| j as u32));
        network.starts.push(network.partners.len());
        let row = &network.partners[network.starts[i]..];
        network.laters.push(network.starts[i] + row.partition_point(|j| (*j as usize) < i));
    }
    network.diagonals =
        on_diagonals.then(|| Diagonals::of(&network.starts, &network.partners, &places).expect("diagonals"));
    network.places = network.diagonals.as_ref().map_or(network.partners.len() / 2, Diagonals::slots);
    network.weights = vec![0.0; network.places];
    let mut pairs = Vec::new();
    for i in 0..places.len() {
        for k in network.starts[i]..network.starts[i + 1] {
            let (low, high) = (i.min(network.partners[k] as usize), i.max(network.partners[k] as usize));
            let known = pairs.iter().position(|pair| *pair == (low, high));
            let number = known.unwrap_or(pairs.len());
            if known.is_none() {
                pairs.push((low, high));
            }
            let slot = network.diagonals.as_ref().map_or(number, |diagonals| diagonals.slot(low, high));
            network.slots.push(slot as u32);
            network.weights[slot] = weights[(low + 3 * high) % weights.len()];
        }
    }
    let mut multiples = [0.0; MOST_WALLS];
    multiples[0] = 2.0;
    let opening = |particle: u32| Opening {
        particle,
        image: particle,
        path: NONE,
        wall: 0,
        weight: 1.0,
        sign: -1.0,
        multiples,
        arm: DVec2::ZERO,
    };
    network.openings = (0..columns as u32).map(opening).collect();
    (network, places)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Bands of any size, however thin, find the pressure that one finds, and the same bits on any number of threads. No water
    /// is lost, and what the sweep takes for the inverse is symmetric.
    #[test]
    fn bands_find_the_pressure_of_the_whole(
        (columns, rows, reach) in (4_usize..14, 4_usize..14, 1_usize..3),
        (size, on_diagonals) in (3_usize..90, any::<bool>()),
        weights in prop::collection::vec(0.5_f64..2.0, 29),
        numbers in prop::collection::vec(-1.0_f64..1.0, 31),
    ) {
        let (network, places) = lattice(columns, rows, reach, on_diagonals, &weights);
        let count = network.len();
        let drawn = |from: usize| -> Vec<f64> { (0..count).map(|i| numbers[(i * 7 + from) % 31]).collect() };
        // Ground a thousand times as tight in places.
        let conductivity: Vec<f64> = drawn(2).iter().map(|number| 10f64.powf(-3.0 * number.abs())).collect();
        let taken = drawn(5);
        let solved = |size: usize, threads: usize| {
            let team = Team::new(threads).expect("threads");
            let mut pressure = Pressure::by(&network, &places, Bands::of(&network, size, team));
            pressure.solve(&network, &conductivity, &[3.0], Some(&taken), 0.0, Mean::Harmonic).expect("a pressure");
            pressure
        };
        let (whole, mut banded) = (solved(count, 1), solved(size, 1));
        let range = whole.pressure.iter().fold(1.0_f64, |range, pressure| range.max(pressure.abs()));
        for (one, many) in whole.pressure.iter().zip(&banded.pressure) {
            prop_assert!((one - many).abs() < 1e-6 * range, "{one} is {many} by bands");
        }
        for threads in [2, 3] {
            let shared = solved(size, threads);
            prop_assert!(shared.iterations == banded.iterations);
            prop_assert!(shared.pressure.iter().zip(&banded.pressure).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        let came: f64 = network.openings.iter().zip(&banded.mouths).map(|(opening, mouth)| {
            let own = banded.pressure[opening.particle as usize];
            mouth * (opening.wall_part(&[3.0]) - (1.0 - opening.sign) * own)
        }).sum();
        let scale = taken.iter().map(|taken| taken.abs()).sum::<f64>();
        prop_assert!((came - taken.iter().sum::<f64>()).abs() < 1e-9 * scale, "{came}");
        let mut sweep = |residual: &[f64]| {
            banded.residual.copy_from_slice(residual);
            banded.sweep(&network);
            banded.swept.clone()
        };
        let (a, b) = (drawn(11), drawn(17));
        let (of_a, of_b) = (sweep(&a), sweep(&b));
        let scale = dot(&of_a, &a).abs() + dot(&of_b, &b).abs();
        prop_assert!((dot(&of_a, &b) - dot(&of_b, &a)).abs() < 1e-10 * scale);
        prop_assert!(dot(&of_a, &a) > 0.0);
    }
}
