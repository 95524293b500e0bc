//! Heat that has come into the body, by door: each wall, each pipe.

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
    pub fn value(&self) -> f64 {
        self.total + self.lost
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

/// Heat in through each door (J per metre of each missing dimension).
#[derive(Debug, Clone, Default)]
pub struct Ledger {
    names: Vec<String>,
    heat: Vec<Sum>,
    rate: Vec<f64>,
}

impl Ledger {
    /// A ledger with these doors.
    pub fn new(names: Vec<String>) -> Self {
        let count = names.len();
        Ledger { names, heat: vec![Sum::default(); count], rate: vec![0.0; count] }
    }

    /// Books `heat` (J) through a door over a step of `step` seconds.
    #[inline]
    pub fn book(&mut self, door: usize, heat: f64, step: f64) {
        self.heat[door].add(heat);
        self.rate[door] = heat / step;
    }

    /// Names of the doors.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Heat in so far, by door (J).
    pub fn heat(&self) -> Vec<f64> {
        self.heat.iter().map(Sum::value).collect()
    }

    /// Rate of the latest step, by door (W).
    pub fn rate(&self) -> &[f64] {
        &self.rate
    }
}
