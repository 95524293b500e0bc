//! Threads that share the steps of a body.
//!
//! A step of a small body is over before a thread that sleeps has woken. So those of a team look for the next step for a while before
//! they sleep, and the one that leads looks for the others to be done in the same way.

use std::hint::spin_loop;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::yield_now;
use std::time::{Duration, Instant};

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// How long a thread looks for others before it sleeps: some times what waking it takes.
const PATIENCE: Duration = Duration::from_micros(100);

/// Looks in which a thread that has done its part leaves the work.
const FAREWELL: u32 = 8;

/// Looks between two at the clock, after which a thread lets others have its processor.
const LOOKS: u32 = 64;

/// A leader, which is the thread that calls, and those that work beside it.
#[derive(Clone)]
pub struct Team {
    followers: Arc<ThreadPool>,
    /// How many works were begun.
    begun: Arc<AtomicU64>,
}

/// Waits until something is so, for as long as threads have patience.
fn await_awake(is_so: impl Fn() -> bool) {
    let mut since = None;
    loop {
        for _ in 0..LOOKS {
            if is_so() {
                return;
            }
            spin_loop();
        }
        if since.get_or_insert_with(Instant::now).elapsed() > PATIENCE {
            return;
        }
        // Where others want this processor, one of them may be the thread that is waited for.
        yield_now();
    }
}

impl Team {
    /// A team of so many threads, its leader among them; none of one.
    ///
    /// # Errors
    /// Threads that the system does not give.
    pub fn new(threads: usize) -> Result<Option<Self>, ThreadPoolBuildError> {
        if threads <= 1 {
            return Ok(None);
        }
        let followers = ThreadPoolBuilder::new().num_threads(threads - 1).build()?;
        Ok(Some(Team { followers: Arc::new(followers), begun: Arc::default() }))
    }

    /// Its threads.
    pub fn threads(&self) -> usize {
        self.followers.current_num_threads() + 1
    }

    /// Does all parts of a work side by side, one for each thread, the last by the leader.
    pub fn share<P: Send>(&self, mut parts: impl DoubleEndedIterator<Item = P>, one: impl Fn(P) + Sync) {
        let Some(own) = parts.next_back() else { return };
        let (one, left) = (&one, &AtomicUsize::new(0));
        self.followers.in_place_scope(|scope| {
            let mut followers = 0;
            for part in parts {
                left.fetch_add(1, Ordering::Relaxed);
                followers += 1;
                scope.spawn(move |_| {
                    one(part);
                    left.fetch_sub(1, Ordering::Release);
                });
            }
            let now = self.begun.fetch_add(1, Ordering::Release) + 1;
            // Those that have done their part look for the next work.
            for _ in 0..followers {
                let begun = self.begun.clone();
                self.followers.spawn(move || await_awake(|| begun.load(Ordering::Acquire) != now));
            }
            one(own);
            await_awake(|| left.load(Ordering::Acquire) == 0);
            // The last of them has yet to say so to the scope, which sleeps at once where it has not.
            (0..FAREWELL).for_each(|_| spin_loop());
        });
    }

    /// Does the parts of a work, of which each thread takes the next one whenever it has done one.
    pub fn take_turns<P: Send>(&self, parts: impl Iterator<Item = P> + Send, one: impl Fn(P) + Sync) {
        let parts = Mutex::new(parts);
        let next = || parts.lock().unwrap_or_else(PoisonError::into_inner).next();
        self.share(0..self.threads(), |_| {
            while let Some(part) = next() {
                one(part);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_is_done_once_whether_threads_sleep_or_not() {
        let team = Team::new(3).expect("threads").expect("a team");
        let mut counts = [0_u32; 3];
        for round in 0..200 {
            team.share(counts.iter_mut(), |count| *count += 1);
            if round % 50 == 0 {
                std::thread::sleep(3 * PATIENCE);
            }
        }
        assert_eq!(counts, [200; 3]);
        let mut numbers = [0; 1000];
        team.take_turns(numbers.chunks_mut(7).enumerate(), |(task, numbers)| numbers.fill(task));
        assert!(numbers.iter().enumerate().all(|(place, task)| place / 7 == *task));
        assert!(Team::new(1).expect("threads").is_none());
    }
}
