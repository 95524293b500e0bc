//! How far a campaign is, and how long the rest of it will take.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use crate::progress::{Reporter, clock, countdown};

/// What is done of tasks whose prices are known, in any unit that time is in proportion to.
pub struct Meter {
    reporter: Reporter,
    began: Instant,
    all: f64,
    done: Mutex<Done>,
}

#[derive(Default)]
struct Done {
    /// Price of what was known before: it took no time.
    known: f64,
    made: f64,
}

impl Meter {
    /// For tasks of this price together.
    pub fn new(quiet: bool, all: f64) -> Self {
        Meter { reporter: Reporter::new(quiet), began: Instant::now(), all, done: Mutex::default() }
    }

    /// Takes down what need not be made.
    pub fn skip(&self, price: f64) {
        self.done.lock().unwrap_or_else(PoisonError::into_inner).known += price;
    }

    /// Takes down what was made. `words` tell how far all of it is from the price of what is done.
    pub fn made(&self, price: f64, words: impl FnOnce(f64) -> String) {
        let (known, made) = {
            let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
            done.made += price;
            (done.known, done.made)
        };
        self.reporter.at((known + made) / self.all, || {
            let elapsed = self.began.elapsed().as_secs_f64();
            let left = countdown(elapsed, made / (self.all - known).max(f64::MIN_POSITIVE));
            format!("{}, {}{left}", words(known + made), clock(elapsed))
        });
    }

    /// A task that tells how far it is.
    pub fn task(&self, price: f64) -> Task<'_> {
        Task { meter: self, price, told: Mutex::new(0.0) }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.reporter.finish();
    }
}

/// A task under way.
pub struct Task<'a> {
    meter: &'a Meter,
    price: f64,
    told: Mutex<f64>,
}

impl Task<'_> {
    /// Takes down that this share of it is done.
    pub fn at(&self, share: f64, words: impl FnOnce(f64) -> String) {
        // Whoever counts roughly may come to a little more than all.
        let more = {
            let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
            let before = *told;
            *told = share.clamp(before, 1.0);
            *told - before
        };
        self.meter.made(more * self.price, words);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_is_counted_once_however_often_it_tells() {
        let meter = Meter::new(true, 3.0);
        meter.skip(1.0);
        let task = meter.task(2.0);
        for (share, made) in [(0.25, 0.5), (0.25, 0.5), (0.2, 0.5), (0.75, 1.5), (1.1, 2.0)] {
            task.at(share, |_| String::new());
            assert_eq!(meter.done.lock().expect("whole").made, made);
        }
        assert_eq!(meter.done.lock().expect("whole").known, 1.0);
    }
}
