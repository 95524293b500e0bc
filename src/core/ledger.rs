//! Heat that has come into the body, by patch: each wall, each ring of pipes, and what else brings heat.

use std::fmt;

use crate::instruction_set::widest;
use crate::saved::{Pass, Saved};
use crate::space::wall::PatchId;

/// A sum that keeps its rounding error (Neumaier's variant of Kahan summation).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sum {
    total: f64,
    lost: f64,
}

impl Sum {
    /// Adds a term.
    #[inline]
    pub fn add(&mut self, term: f64) {
        let next = self.total + term;
        self.lost +=
            if self.total.abs() >= term.abs() { (self.total - next) + term } else { (term - next) + self.total };
        self.total = next;
    }

    /// The sum so far.
    #[inline]
    pub fn value(&self) -> f64 {
        self.total + self.lost
    }
}

impl Saved for Sum {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.total, &mut self.lost]);
    }
}

impl FromIterator<f64> for Sum {
    fn from_iter<I: IntoIterator<Item = f64>>(terms: I) -> Self {
        let mut sum = Sum::default();
        for term in terms {
            sum.add(term);
        }
        sum
    }
}

/// Weights of the cubic through the states at both ends of a step, and the changes that the rates there would make over
/// the whole step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hermite {
    /// Of the state at the start.
    pub start: f64,
    /// Of the state at the end.
    pub end: f64,
    /// Of the rate at the start, times the step.
    pub first: f64,
    /// Of the rate at the end, times the step.
    pub last: f64,
}

impl Hermite {
    /// The weights at a share of the step, 0 to 1.
    pub fn at(share: f64) -> Self {
        let rest = 1.0 - share;
        let start = rest * rest * (1.0 + 2.0 * share);
        Hermite { start, end: 1.0 - start, first: share * rest * rest, last: -share * share * rest }
    }

    /// Their derivatives by the share.
    pub fn slope_at(share: f64) -> Self {
        let rest = 1.0 - share;
        let end = 6.0 * share * rest;
        Hermite { start: -end, end, first: rest * (1.0 - 3.0 * share), last: share * (3.0 * share - 2.0) }
    }

    /// The column between two states.
    pub fn fill(&self, out: &mut [f64], states: (&[f64], &[f64]), rates: (&[f64], &[f64]), step: f64) {
        let weights = [self.start, self.end, step * self.first, step * self.last];
        weigh_widely(out, [states.0, states.1, rates.0, rates.1], weights);
    }
}

widest!(weigh_widely, weigh, (out: &mut [f64], columns: [&[f64]; 4], weights: [f64; 4]));

/// Fills a column with the sum of four others, each by a weight.
#[inline(always)]
fn weigh(out: &mut [f64], [a, b, c, d]: [&[f64]; 4], weights: [f64; 4]) {
    for ((out, (a, b)), (c, d)) in out.iter_mut().zip(a.iter().zip(b)).zip(c.iter().zip(d)) {
        *out = weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d;
    }
}

/// What brings heat into a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A wall, a part of one, or the face of a shaft.
    Patch(PatchId),
    /// The only ring of pipes.
    Ring,
    /// One of several rings of pipes, by its number from 0.
    RingOf(usize),
    /// A region that releases heat, by its number from 0.
    Region(usize),
    /// Ice: the rest of the balance beside water.
    Ice,
    /// Motion of particles.
    Motion,
    /// Decay of a solute.
    Decay,
}

impl Source {
    /// So many rings of pipes.
    pub fn rings(count: usize) -> impl Iterator<Item = Source> {
        (0..count).map(move |ring| if count == 1 { Source::Ring } else { Source::RingOf(ring) })
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Source::Patch(patch) => patch.fmt(f),
            Source::Ring => f.write_str("pipes"),
            Source::RingOf(ring) => write!(f, "pipes_{}", ring + 1),
            Source::Region(region) => write!(f, "region_{}", region + 1),
            Source::Ice => f.write_str("ice"),
            Source::Motion => f.write_str("motion"),
            Source::Decay => f.write_str("decay"),
        }
    }
}

/// Heat in through each patch (J per metre of each missing dimension).
#[derive(Debug, Clone, Default)]
pub struct Ledger {
    sources: Vec<Source>,
    heat: Vec<Sum>,
    rate: Vec<f64>,
}

impl Ledger {
    /// A ledger with these patches.
    pub fn new(sources: Vec<Source>) -> Self {
        let count = sources.len();
        Ledger { sources, heat: vec![Sum::default(); count], rate: vec![0.0; count] }
    }

    /// Books `heat` (J) through a patch over a step of `step` seconds.
    #[inline]
    pub fn book(&mut self, patch: usize, heat: f64, step: f64) {
        // Most walls of most bodies are closed.
        if heat == 0.0 {
            self.rate[patch] = heat;
            return;
        }
        self.heat[patch].add(heat);
        self.rate[patch] = heat / step;
    }

    /// The ledger at `share` of the last step, which brought `heat` (J) over `step` seconds at rates (W) that went from
    /// `first` to `last`: the cubic through all of them.
    pub fn between(&self, share: f64, step: f64, heat: &[f64], first: &[f64], last: &[f64]) -> Ledger {
        let cubic = Hermite::at(share);
        let slope = Hermite::slope_at(share);
        let mut ledger = self.clone();
        for patch in 0..self.sources.len() {
            let (first, last) = (step * first[patch], step * last[patch]);
            // Counted from the end of the step, to which the ledger has come.
            let since = cubic.first * first + cubic.last * last - cubic.start * heat[patch];
            ledger.heat[patch].add(since);
            ledger.rate[patch] = (slope.first * first + slope.last * last - slope.start * heat[patch]) / step;
        }
        ledger
    }

    /// What each patch is.
    pub fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// Heat in so far, by patch (J).
    pub fn heat(&self) -> Vec<f64> {
        self.heat.iter().map(Sum::value).collect()
    }

    /// Rate of the latest step through each ring of pipes (W), in their order.
    pub fn rings(&self) -> impl Iterator<Item = f64> + '_ {
        self.of_rings(&self.rate).copied()
    }

    /// Heat that all pipes have taken so far (J).
    pub fn taken_by_rings(&self) -> f64 {
        // Pipes that take none take no negative zero.
        0.0 - self.of_rings(&self.heat).map(Sum::value).sum::<f64>()
    }

    /// What belongs to rings of pipes, of something by patch.
    fn of_rings<'a, T>(&'a self, by_patch: &'a [T]) -> impl Iterator<Item = &'a T> {
        let is_ring = |source: &Source| matches!(source, Source::Ring | Source::RingOf(_));
        self.sources.iter().zip(by_patch).filter(move |(source, _)| is_ring(source)).map(|(_, own)| own)
    }

    /// Rate of the latest step, by patch (W).
    pub fn rate(&self) -> &[f64] {
        &self.rate
    }
}

impl Saved for Ledger {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.heat, &mut self.rate]);
    }
}
