//! Runs of pairs: those of a list whose two ends advance by one particle from each pair to the next, at one weight.
//!
//! On a lattice nearly all pairs lie in such runs, one for each row and offset. A run needs no partners to be read, and each of
//! its pairs is met once, for both ends, in vectors. Bands of particles of fixed number gather what their own particles
//! receive, so neither threads nor vectors change a bit.

use crate::bonds::exchange::{Exchange, Mean};
use crate::bonds::pair_list::PairList;
#[cfg(any(test, target_arch = "x86_64"))]
use crate::instruction_set::InstructionSet;
use crate::kernels::list_parts::ListParts;
use crate::kernels::term::PairTerm;
use crate::memory::{HeapSize, total};
use crate::physics::latent_heat::Fields;
use crate::team::{Team, share};

/// Fewest pairs of a run: shorter ones stay on the list.
const FEWEST: usize = 8;

/// Most pairs that are met at once: what they exchange stays in the first cache.
const MOST: usize = 512;

/// Weights of a run differ by no more than this part: by rounding.
const ALIKE: f64 = 1e-12;

/// Particles of a band; fixed, so that results do not depend on the number of threads. Pairs between two bands are met twice.
const BAND: usize = 8192;

/// Pairs side by side: the first one's ends, how many there are, and their weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// Particle of the first pair: the end of the smaller number.
    pub first: u32,
    /// Its partner.
    pub partner: u32,
    /// Pairs.
    pub count: u32,
    /// Weight by volume (m^-2).
    pub weight: f64,
}

/// Which ends of a run are of the band at hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ends {
    Both,
    Particles,
    Partners,
}

/// A run, and which of its ends are of a band.
type Piece = (Run, Ends);

/// The runs of a list, and the pairs that are in none.
#[derive(Debug, Clone, Default)]
pub struct Runs {
    /// By band, in the order in which its particles stand.
    bands: Vec<Vec<Piece>>,
    /// All other entries of the list.
    pub(super) rest: PairList,
}

impl Runs {
    /// The runs among the pairs of a body of one material whose weights never change; none where there are hardly any.
    pub(super) fn of(parts: &ListParts) -> Option<Self> {
        let fixed = parts.cuts.is_empty() && !parts.materials.mixed() && parts.up.is_none();
        if fixed { Self::among(&parts.pairs, parts.positions.len()) } else { None }
    }

    /// The runs of a list of so many particles and of ghosts.
    fn among(pairs: &PairList, count: usize) -> Option<Self> {
        let mut runs = found(pairs, count);
        runs.retain(|run| run.count as usize >= FEWEST);
        if runs.is_empty() {
            return None;
        }
        let rest = without(pairs, count, &runs);
        let mut bands = vec![Vec::new(); count.div_ceil(BAND)];
        for run in &runs {
            split(run, &mut bands);
        }
        for band in &mut bands {
            band.sort_by_key(|(run, ends)| match ends {
                Ends::Both | Ends::Particles => run.first,
                Ends::Partners => run.partner,
            });
        }
        Some(Runs { bands, rest })
    }

    /// Adds what all runs give (W/m3) at a state of the fields, on some threads if there are any.
    pub(super) fn add<T: PairTerm>(
        &self,
        (exchange, team): (Exchange, Option<&Team>),
        term: &T,
        fields: &Fields,
        rate: &mut [f64],
    ) {
        let task = |(number, (band, rates)): (usize, (&Vec<Piece>, &mut [f64]))| {
            meet(band, exchange, term, fields, (number * BAND, rates));
        };
        let team = team.filter(|_| self.bands.len() > 1);
        share(team, self.bands.iter().zip(rate.chunks_mut(BAND)).enumerate(), task);
    }
}

impl HeapSize for Runs {
    fn heap_size(&self) -> usize {
        let runs = self.bands.iter().map(|band| band.capacity() * size_of::<Piece>()).sum::<usize>();
        runs + total(&[&self.rest.starts, &self.rest.partners, &self.rest.weights])
    }
}

/// Whether two weights are those of one run.
fn alike(one: f64, other: f64) -> bool {
    (other - one).abs() <= ALIKE * one.abs()
}

/// The entries of a list that are in none of some runs.
fn without(pairs: &PairList, count: usize, runs: &[Run]) -> PairList {
    let mut taken = vec![false; pairs.partners.len()];
    for run in runs {
        for (i, j) in (run.first..run.first + run.count).zip(run.partner..) {
            for (own, other) in [(i, j), (j, i)] {
                let mut row = pairs.starts[own as usize]..pairs.starts[own as usize + 1];
                let is_it =
                    |k: &usize| pairs.partners[*k] == other && alike(run.weight, pairs.weights[*k]) && !taken[*k];
                if let Some(k) = row.find(is_it) {
                    taken[k] = true;
                }
            }
        }
    }
    let left = taken.iter().filter(|taken| !**taken).count();
    let mut rest = PairList {
        starts: Vec::with_capacity(count + 1),
        partners: Vec::with_capacity(left),
        weights: Vec::with_capacity(left),
    };
    rest.starts.push(0);
    for i in 0..count {
        for k in (pairs.starts[i]..pairs.starts[i + 1]).filter(|k| !taken[*k]) {
            rest.partners.push(pairs.partners[k]);
            rest.weights.push(pairs.weights[k]);
        }
        rest.starts.push(rest.partners.len());
    }
    rest
}

/// All runs of a list, of one pair and more. Entries of ghosts are in none, nor are those whose other end does not see them with
/// the same weight.
fn found(pairs: &PairList, count: usize) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut taken = vec![false; pairs.partners.len()];
    // The last run at each offset.
    let mut open: Vec<u32> = Vec::new();
    for i in 0..count {
        open.retain(|run| ends(&runs[*run as usize]) == i);
        let partners = |i: usize| pairs.starts[i]..pairs.starts[i + 1];
        for k in partners(i).filter(|k| (i + 1..count).contains(&(pairs.partners[*k] as usize))) {
            let (j, weight) = (pairs.partners[k], pairs.weights[k]);
            let back = |k: &usize| pairs.partners[*k] as usize == i && alike(weight, pairs.weights[*k]) && !taken[*k];
            let Some(back) = partners(j as usize).find(back) else { continue };
            let goes_on = |run: &Run| run.partner + run.count == j && alike(weight, run.weight) && ends(run) == i;
            let number = match open.iter().copied().find(|run| goes_on(&runs[*run as usize])) {
                Some(number) => number,
                None => {
                    runs.push(Run { first: i as u32, partner: j, count: 0, weight });
                    open.push(runs.len() as u32 - 1);
                    runs.len() as u32 - 1
                }
            };
            runs[number as usize].count += 1;
            (taken[k], taken[back]) = (true, true);
        }
    }
    runs
}

/// The particle after the last of a run.
fn ends(run: &Run) -> usize {
    (run.first + run.count) as usize
}

/// Cuts a run where either end passes into another band, and where it is too long to be met at once.
fn split(run: &Run, bands: &mut [Vec<Piece>]) {
    let Run { mut first, mut partner, count: mut left, weight } = *run;
    while left > 0 {
        let to_next = |particle: u32| BAND - particle as usize % BAND;
        let count = (left as usize).min(MOST).min(to_next(first)).min(to_next(partner)) as u32;
        let piece = Run { first, partner, count, weight };
        let (band, other) = (first as usize / BAND, partner as usize / BAND);
        if band == other {
            bands[band].push((piece, Ends::Both));
        } else {
            bands[band].push((piece, Ends::Particles));
            bands[other].push((piece, Ends::Partners));
        }
        (first, partner, left) = (first + count, partner + count, left - count);
    }
}

/// Particles of a band: the number of the first, and their rates.
type BandRates<'a> = (usize, &'a mut [f64]);

/// Lets the runs of a band act, by the widest vectors.
fn meet<T: PairTerm>(runs: &[Piece], exchange: Exchange, term: &T, fields: &Fields, rates: BandRates<'_>) {
    #[cfg(target_arch = "x86_64")]
    match InstructionSet::widest() {
        // SAFETY: the processor has just been asked for these features.
        InstructionSet::Avx512 => return unsafe { meet_avx512(runs, exchange, term, fields, rates) },
        // SAFETY: as above.
        InstructionSet::Avx2 => return unsafe { meet_avx2(runs, exchange, term, fields, rates) },
        InstructionSet::Portable => {}
    }
    meet_by(runs, exchange, term, fields, rates);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq")]
fn meet_avx512<T: PairTerm>(runs: &[Piece], exchange: Exchange, term: &T, fields: &Fields, rates: BandRates<'_>) {
    meet_by(runs, exchange, term, fields, rates);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn meet_avx2<T: PairTerm>(runs: &[Piece], exchange: Exchange, term: &T, fields: &Fields, rates: BandRates<'_>) {
    meet_by(runs, exchange, term, fields, rates);
}

#[inline(always)]
fn meet_by<T: PairTerm>(runs: &[Piece], exchange: Exchange, term: &T, fields: &Fields, (begin, rates): BandRates<'_>) {
    let mut fluxes = [0.0; MOST];
    for (run, ends) in runs {
        let fluxes = &mut fluxes[..run.count as usize];
        conduct(run, exchange, fields, fluxes);
        term.give(run, fields, fluxes);
        if *ends != Ends::Partners {
            let own = &mut rates[run.first as usize - begin..][..fluxes.len()];
            own.iter_mut().zip(&*fluxes).for_each(|(rate, flux)| *rate += flux);
        }
        if *ends != Ends::Particles {
            let other = &mut rates[run.partner as usize - begin..][..fluxes.len()];
            other.iter_mut().zip(&*fluxes).for_each(|(rate, flux)| *rate -= flux);
        }
    }
}

/// What the pairs of a run conduct (W/m), from partner to particle.
#[inline(always)]
fn conduct(run: &Run, exchange: Exchange, fields: &Fields, conducted: &mut [f64]) {
    match exchange {
        Exchange::Potential => {
            let (own, other) = both(&fields.potential, run);
            for ((conducted, own), other) in conducted.iter_mut().zip(own).zip(other) {
                *conducted = other - own;
            }
        }
        Exchange::Mean(Mean::Harmonic) => by_conductivity(run, fields, conducted, |a, b, _| 2.0 * a * b / (a + b)),
        Exchange::Mean(Mean::Arithmetic) => by_conductivity(run, fields, conducted, |a, b, _| 0.5 * (a + b)),
        Exchange::Mean(Mean::Geometric) => by_conductivity(run, fields, conducted, |a, b, _| (a * b).sqrt()),
        Exchange::Upstream => by_conductivity(run, fields, conducted, |a, b, way| if way > 0.0 { b } else { a }),
    }
}

#[inline(always)]
fn by_conductivity(run: &Run, fields: &Fields, conducted: &mut [f64], of_pair: impl Fn(f64, f64, f64) -> f64) {
    let ((own, other), (a, b)) = (both(&fields.temperature, run), both(&fields.conductivity, run));
    let conductivities = a.iter().zip(b);
    for (((conducted, own), other), (a, b)) in conducted.iter_mut().zip(own).zip(other).zip(conductivities) {
        let difference = other - own;
        *conducted = of_pair(*a, *b, difference) * difference;
    }
}

/// The values of a column at both ends of a run.
#[inline(always)]
pub fn both<'a, V>(column: &'a [V], run: &Run) -> (&'a [V], &'a [V]) {
    let of = |first: u32| &column[first as usize..][..run.count as usize];
    (of(run.first), of(run.partner))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::instruction_set;
    use crate::kernels::term::PairView;
    use crate::noise::{StepNoise, pair_of};
    use crate::solvers::step::Clock;

    /// A random part that conductivities and temperatures have a hand in.
    #[derive(Clone)]
    struct Shaken(StepNoise);

    impl HeapSize for Shaken {
        fn heap_size(&self) -> usize {
            0
        }
    }

    impl PairTerm for Shaken {
        const ACTIVE: bool = true;

        fn begin(&mut self, _: &Fields, _: &Clock) {}

        fn add(&self, pair: &PairView<'_>) -> f64 {
            let (i, j) = pair.indices;
            let strength = pair.fields.conductivity[i] * pair.fields.conductivity[j];
            strength * f64::from(self.0.antisymmetric(pair.names.0, pair.names.1, pair.stream))
        }

        #[inline(always)]
        fn give(&self, run: &Run, fields: &Fields, fluxes: &mut [f64]) {
            let (a, b) = both(&fields.conductivity, run);
            for (k, flux) in fluxes.iter_mut().enumerate() {
                let number = self.0.one(pair_of(run.first + k as u32, run.partner + k as u32));
                *flux = run.weight * *flux + a[k] * b[k] * f64::from(number);
            }
        }
    }

    /// Rows of particles under a stencil of reach 2, of which some pairs have other weights and some are seen from one end alone;
    /// the last column has ghosts.
    fn list(rows: &[usize], odd: &[usize]) -> (PairList, usize) {
        let starts: Vec<usize> = rows.iter().scan(0, |sum, row| Some(std::mem::replace(sum, *sum + row))).collect();
        let count: usize = rows.iter().sum();
        let mut pairs = PairList { starts: vec![0], ..PairList::default() };
        for (row, length) in rows.iter().enumerate() {
            for column in 0..*length {
                let i = starts[row] + column;
                for (dx, dy) in (-2..=2i64).flat_map(|dy| (-2..=2i64).map(move |dx| (dx, dy))) {
                    let (x, y) = (column as i64 + dx, row as i64 + dy);
                    let square = (dx * dx + dy * dy) as f64;
                    let inside = (0..rows.len() as i64).contains(&y) && (0..rows[y as usize] as i64).contains(&x);
                    if square == 0.0 || square > 5.0 || !inside {
                        continue;
                    }
                    let j = starts[y as usize] + x as usize;
                    let weight = 1.0 / square;
                    let (low, high) = (i.min(j), i.max(j));
                    let weight = match odd.iter().position(|odd| (low + high) % 509 == odd % 509) {
                        Some(which) if which % 2 == 0 => 1.5 * weight,
                        Some(_) if i == low => 0.5 * weight,
                        _ => weight * (1.0 + 1e-15 * (low % 3) as f64),
                    };
                    pairs.partners.push(j as u32);
                    pairs.weights.push(weight);
                }
                if column + 1 == *length {
                    pairs.partners.push((count + row) as u32);
                    pairs.weights.push(2.0);
                }
                pairs.starts.push(pairs.partners.len());
            }
        }
        (pairs, count)
    }

    /// What the pairs of a list give its particles, one by one, and the sum of the sizes of what is rounded: both parts of a
    /// pair, which may cancel.
    fn one_by_one(pairs: &PairList, (count, total): (usize, usize), term: &Shaken, fields: &Fields) -> Vec<(f64, f64)> {
        let row = |i: usize| {
            let mut sums = (0.0, 0.0);
            for k in pairs.starts[i]..pairs.starts[i + 1] {
                let (j, weight) = (pairs.partners[k] as usize, pairs.weights[k]);
                let conducted = fields.potential[j] - fields.potential[i];
                let (names, indices) = ((i as u32, j as u32), (i, j));
                let view = PairView { names, stream: 0, weight, conducted, between: None, indices, fields };
                let (conducted, added) = (weight * conducted, term.add(&view));
                sums = (sums.0 + (conducted + added), sums.1 + conducted.abs() + added.abs());
            }
            sums
        };
        assert!(pairs.partners.iter().all(|j| (*j as usize) < total));
        (0..count).map(row).collect()
    }

    proptest! {
        /// Runs and what is left beside them give what the list gives, whatever the vectors and threads.
        #[test]
        fn runs_and_the_rest_are_the_list(
            rows in prop::collection::vec(1_usize..700, 1..30),
            odd in prop::collection::vec(0_usize..509, 0..5),
            seed in 0_u64..1000,
        ) {
            let (pairs, count) = list(&rows, &odd);
            let total = count + rows.len();
            let noise = StepNoise::new(seed, 1);
            let column = |stream| (0..total as u32).map(|i| f64::from(noise.antisymmetric(i, u32::MAX, stream))).collect();
            let fields = Fields { potential: column(1), temperature: column(2), conductivity: column(3) };
            let term = Shaken(noise);
            let expected = one_by_one(&pairs, (count, total), &term, &fields);
            let Some(runs) = Runs::among(&pairs, count) else { return Ok(()) };
            let whole: usize = runs.bands.iter().flatten().map(|(run, ends)| match ends {
                Ends::Both => 2 * run.count as usize,
                Ends::Particles | Ends::Partners => run.count as usize,
            }).sum();
            prop_assert_eq!(whole + runs.rest.partners.len(), pairs.partners.len());
            let beside = one_by_one(&runs.rest, (count, total), &term, &fields);
            let team = Team::new(2).expect("two threads").expect("a team");
            let mut first: Option<Vec<f64>> = None;
            for set in InstructionSet::ALL {
                instruction_set::limit(set);
                for team in [None, Some(&team)] {
                    let mut rate: Vec<f64> = beside.iter().map(|sums| sums.0).collect();
                    runs.add((Exchange::Potential, team), &term, &fields, &mut rate);
                    for (rate, (expected, size)) in rate.iter().zip(&expected) {
                        // Weights of a run differ by rounding, and sums of some twenty terms round, in another order.
                        prop_assert!((rate - expected).abs() <= 4e-14 * size, "{rate} {expected}");
                    }
                    let bits = |rate: &[f64]| rate.iter().map(|rate| rate.to_bits()).collect::<Vec<u64>>();
                    let first = first.get_or_insert_with(|| rate.clone());
                    prop_assert_eq!(bits(first), bits(&rate));
                }
            }
        }
    }
}
