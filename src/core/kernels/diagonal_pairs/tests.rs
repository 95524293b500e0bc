//! Pairs by diagonals against the list that they were taken from.

use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::*;

use super::*;
use crate::bonds::pair_list::PairList;
use crate::boundary::ghosts::Ghosts;
use crate::boundary::interface::Chains;
use crate::boundary::patch::{Boundary, Side};
use crate::breakage::cuts::Cuts;
use crate::neighbours::tree::Tree;
use crate::neighbours::{NeighbourSearch, Period};
use crate::physics::latent_heat::Materials;
use crate::space::domain::Domain;
use crate::space::lattice::Lattice;
use crate::space::volumes::Volumes;

/// A body of some columns and rows, each particle moved by up to a part of the spacing, with weights drawn for each pair, or
/// the same for all pairs of one way; or what of it lies within a circle around its corner, so that rows differ in length.
fn body(
    (columns, rows, round): (usize, usize, bool),
    jitter: f64,
    drawn: bool,
    exchange: Exchange,
    numbers: &[f64],
) -> ListParts {
    let domain = Domain::Rectangle { width: columns as f64, height: rows as f64 };
    let lattice = Lattice::new(&domain, 1.0);
    let shift = |k: usize| jitter * (2.0 * numbers[k % numbers.len()] - 1.0);
    let within = |place: &DVec2| !round || place.length() < columns as f64;
    let places = lattice.positions().into_iter().filter(within).enumerate();
    let positions: Vec<DVec2> = places.map(|(i, place)| place + DVec2::new(shift(7 * i), shift(11 * i + 3))).collect();
    let found = Tree.neighbours(&positions, positions.len(), 2.3, Period::NONE);
    let mut weights = Vec::with_capacity(found.partners.len());
    for i in 0..positions.len() {
        weights.extend(found.of(i).iter().map(|j| {
            let (low, high) = (i.min(*j as usize), i.max(*j as usize));
            let number = if drawn { 13 * low + 29 * high } else { high - low };
            1.0 + numbers[number % numbers.len()]
        }));
    }
    let sides = [Side::Mirror; 4];
    ListParts {
        volumes: Volumes::new(&domain, &lattice, false),
        positions: positions.into(),
        spacing: 1.0,
        materials: Materials::new(Arc::new([]), Vec::new()),
        factors: Arc::new([]),
        pairs: PairList { starts: found.starts, partners: found.partners, weights },
        chains: Chains::default(),
        cuts: Cuts::default(),
        ghosts: Ghosts::none(),
        boundary: Boundary { parts: Vec::new(), books_all: false, patches: Vec::new(), sides, curved: None, dug: None },
        rims: Vec::new(),
        touches: Vec::new(),
        sinks: Vec::new(),
        rings: 0,
        surfaces: Vec::new(),
        up: None,
        exchange,
        team: None,
        bound: None,
    }
}

/// What the entries of a list give each particle, and what there is to be rounded.
fn by_list(parts: &ListParts, columns: &Columns<'_>, mean: impl Fn(f64, f64) -> f64) -> Vec<(f64, f64)> {
    let PairList { starts, partners, weights } = &parts.pairs;
    let row = |i: usize| {
        let entries = partners[starts[i]..starts[i + 1]].iter().zip(&weights[starts[i]..starts[i + 1]]);
        entries.fold((0.0, 0.0), |(sum, size), (j, weight)| {
            let j = *j as usize;
            let conducted = mean(columns.conductivity[i], columns.conductivity[j]);
            let flux = weight * conducted * (columns.values[j] - columns.values[i]);
            (sum + flux, size + flux.abs())
        })
    };
    (0..parts.positions.len()).map(row).collect()
}

fn mean_of(exchange: Exchange) -> fn(f64, f64) -> f64 {
    match exchange {
        Exchange::Mean(Mean::Harmonic) => Harmonic::mean,
        Exchange::Mean(Mean::Arithmetic) => Arithmetic::mean,
        Exchange::Mean(Mean::Geometric) => Geometric::mean,
        Exchange::Potential | Exchange::Upstream => Even::mean,
    }
}

/// The rates of all particles without the choice of vectors.
fn portable(own: &DiagonalPairs, columns: &Columns<'_>, rates: &mut [f64]) {
    match own.mean {
        None => gather_rows::<Even>(own, columns, 0, rates),
        Some(Mean::Harmonic) => gather_rows::<Harmonic>(own, columns, 0, rates),
        Some(Mean::Arithmetic) => gather_rows::<Arithmetic>(own, columns, 0, rates),
        Some(Mean::Geometric) => gather_rows::<Geometric>(own, columns, 0, rates),
    }
}

const EXCHANGES: [Exchange; 4] = [
    Exchange::Potential,
    Exchange::Mean(Mean::Harmonic),
    Exchange::Mean(Mean::Arithmetic),
    Exchange::Mean(Mean::Geometric),
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// Diagonals and what is left on the list give what the whole list gave: to rounding, and for uneven weights in short to
    /// theirs. What particles gain others lose. Wide vectors and shares of any size give the same bits.
    #[test]
    fn diagonals_give_what_the_list_gave(
        size in (1_usize..70, 1_usize..40, any::<bool>()),
        (jitter, drawn) in (prop_oneof![Just(0.0), 0.0..0.4_f64], any::<bool>()),
        exchange in prop::sample::select(&EXCHANGES[..]),
        numbers in prop::collection::vec(0.0..1.0_f64, 211),
        share in 1_usize..900,
    ) {
        let mut parts = body(size, jitter, drawn, exchange, &numbers);
        let count = parts.positions.len();
        let values: Vec<f64> = (0..count).map(|i| 1e3 * numbers[(17 * i + 5) % 211] - 500.0).collect();
        let conductivity: Vec<f64> = (0..count).map(|i| 0.5 + numbers[(23 * i + 1) % 211]).collect();
        let columns = Columns { values: &values, conductivity: &conductivity };
        let mean = mean_of(exchange);
        let whole = by_list(&parts, &columns, mean);
        let Some(own) = DiagonalPairs::split(&mut parts) else {
            prop_assert!(parts.pairs.partners.is_empty() || count < 64);
            return Ok(());
        };
        let left = by_list(&parts, &columns, mean);
        let mut rates = vec![f64::NAN; count];
        own.gather(&columns, 0, &mut rates);

        let uneven = own.diagonals.iter().any(|diagonal| diagonal.uneven);
        // A short number has 24 binary digits; sums have some thirty terms.
        let accuracy = if uneven { 1.2e-7 } else { 1e-14 };
        for i in 0..count {
            let (sum, size) = whole[i];
            prop_assert!((rates[i] + left[i].0 - sum).abs() <= accuracy * size, "{i}: {} {sum}", rates[i]);
        }
        let total: f64 = rates.iter().sum();
        let size: f64 = whole.iter().map(|own| own.1).sum();
        prop_assert!(total.abs() <= 1e-14 * size, "{total} of {size}");

        let mut plain = vec![f64::NAN; count];
        portable(&own, &columns, &mut plain);
        prop_assert_eq!(&plain, &rates);
        let mut shared = vec![f64::NAN; count];
        for (number, part) in shared.chunks_mut(share).enumerate() {
            own.gather(&columns, number * share, part);
        }
        prop_assert_eq!(&shared, &rates);
    }

    /// A weight in short is as near as such numbers come, and not more than the weight.
    #[test]
    fn weights_in_short_are_not_more(weight in 1e-30..1e30_f64) {
        let short = f64::from(short(weight));
        prop_assert!(short <= weight && short >= weight * (1.0 - 1.2e-7));
    }
}

/// Rows of a lattice have few kinds of blocks, however long they are; particles that stand unevenly have as many as there are.
#[test]
fn a_lattice_keeps_each_kind_of_block_once() {
    let numbers: Vec<f64> = (0..1009).map(|k| (43758.5 * f64::from(k).sin()).rem_euclid(1.0)).collect();
    let even = DiagonalPairs::split(&mut body((211, 190, false), 0.0, false, Exchange::Potential, &numbers))
        .expect("diagonals");
    assert!(even.uneven.is_empty() && even.heap_size() < 8 * even.count, "{} bytes", even.heap_size());
    let drawn = DiagonalPairs::split(&mut body((211, 190, false), 0.2, true, Exchange::Potential, &numbers))
        .expect("diagonals");
    // The next in a row are partners of all.
    assert!(drawn.diagonals[0].uneven && drawn.heap_size() < 6 * drawn.count * drawn.diagonals.len());
    let scattered = DiagonalPairs::split(&mut body((40, 40, false), 20.0, true, Exchange::Potential, &numbers));
    assert!(scattered.is_none(), "particles at random have no diagonals");
}
