//! Sums of many small changes that lose nothing.

use crate::instruction_set::widest;
use crate::memory::HeapSize;
use crate::saved::{Pass, Saved};

/// What rounding takes from contents that change a little many times (Kahan 1965, doi 10.1145/363707.363723).
pub struct Kept {
    /// What it has kept from each content so far.
    pub lost: Vec<f64>,
    /// Rates, where they are not added as they are found.
    rate: Vec<f64>,
}

impl Kept {
    /// Nothing so far, of so many contents.
    pub fn new(count: usize) -> Self {
        Kept { lost: vec![0.0; count], rate: Vec::new() }
    }

    /// Room for the rates of so many contents.
    pub fn rates(&mut self, count: usize) -> &mut [f64] {
        self.rate.resize(count, 0.0);
        &mut self.rate
    }

    /// Adds the changes by these rates over a step (s) to the contents.
    pub fn add(&mut self, contents: &mut [f64], step: f64) {
        add(contents, &self.rate, &mut self.lost, step);
    }
}

widest!(add, add_each, (contents: &mut [f64], rates: &[f64], lost: &mut [f64], step: f64));

#[inline(always)]
fn add_each(contents: &mut [f64], rates: &[f64], lost: &mut [f64], step: f64) {
    for (content, (rate, lost)) in contents.iter_mut().zip(rates.iter().zip(lost)) {
        add_one(content, step * rate, lost);
    }
}

/// Adds a change to a content.
#[inline(always)]
pub fn add_one(content: &mut f64, change: f64, lost: &mut f64) {
    let change = change + *lost;
    let next = *content + change;
    // Exact where the content is the greater, as it is by far when steps are many.
    *lost = change - (next - *content);
    *content = next;
}

impl Saved for Kept {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.lost.pass(pass);
    }
}

impl HeapSize for Kept {
    fn heap_size(&self) -> usize {
        self.lost.heap_size() + self.rate.heap_size()
    }
}
