//! Threads that share the steps of a body.
//!
//! A step of a small body is over before a thread that sleeps has woken, or a queue has handed it over. So those of a team look for the
//! next work, which is told by one number, for a while before they sleep, and the one that leads looks for the others to be done in the
//! same way.

use std::any::Any;
use std::cell::UnsafeCell;
use std::hint::spin_loop;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{Builder, JoinHandle, yield_now};
use std::time::{Duration, Instant};

/// How long a thread looks for others before it sleeps: some times what waking it takes.
const PATIENCE: Duration = Duration::from_micros(100);

/// Looks between two at the clock, after which a thread lets others have its processor.
const LOOKS: u32 = 64;

/// What the number of a work tells beside it: the followers that have a part of it. There are fewer.
const FOLLOWERS: u64 = 1 << 16;

/// That there is no work any more.
const OVER: u64 = u64::MAX;

/// A leader, which is the thread that calls, and those that work beside it.
#[derive(Clone)]
pub struct Team(Arc<Followers>);

/// Threads beside the leader; they end with it.
struct Followers {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
    /// Held by the one that leads: another that shares a work meanwhile, or a part of it that does, works alone.
    leading: Mutex<()>,
}

/// What a leader and its followers tell each other.
#[derive(Default)]
struct Shared {
    /// How many works were begun, times [`FOLLOWERS`], and how many followers have a part of the last one.
    begun: AtomicU64,
    /// Followers that have yet to do their part.
    left: AtomicUsize,
    work: Work,
    /// What a part has panicked with.
    panic: Mutex<Option<Box<dyn Any + Send>>>,
    /// Followers that sleep or are about to, and whether the leader does.
    sleepers: AtomicUsize,
    leader_sleeps: AtomicBool,
    bed: Mutex<()>,
    morning: Condvar,
    done: Condvar,
}

/// The work at hand: what each follower is to do, by its number.
#[derive(Default)]
struct Work(UnsafeCell<Option<*const (dyn Fn(usize) + Sync)>>);

// SAFETY: the leader writes it while no follower has a part, and those that have one read it after the leader has said so.
unsafe impl Send for Work {}
// SAFETY: as above.
unsafe impl Sync for Work {}

/// Parts of a work, each of which one thread takes.
struct Parts<P>(Vec<UnsafeCell<Option<P>>>);

// SAFETY: each part is taken by one thread.
unsafe impl<P: Send> Sync for Parts<P> {}

/// Looks whether something is so, for as long as threads have patience; whether it is.
fn await_awake(is_so: impl Fn() -> bool) -> bool {
    let mut since = None;
    loop {
        for _ in 0..LOOKS {
            if is_so() {
                return true;
            }
            spin_loop();
        }
        if since.get_or_insert_with(Instant::now).elapsed() > PATIENCE {
            return false;
        }
        // Where others want this processor, one of them may be the thread that is waited for.
        yield_now();
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Waits for the next work after one; its number.
    fn next(&self, known: u64) -> u64 {
        let is_new = || self.begun.load(Ordering::SeqCst) != known;
        if !await_awake(is_new) {
            let mut bed = locked(&self.bed);
            self.sleepers.fetch_add(1, Ordering::SeqCst);
            while !is_new() {
                bed = self.morning.wait(bed).unwrap_or_else(PoisonError::into_inner);
            }
            self.sleepers.fetch_sub(1, Ordering::SeqCst);
        }
        self.begun.load(Ordering::SeqCst)
    }

    /// Tells of a work.
    fn begin(&self, number: u64) {
        self.begun.store(number, Ordering::SeqCst);
        if self.sleepers.load(Ordering::SeqCst) > 0 {
            let _bed = locked(&self.bed);
            self.morning.notify_all();
        }
    }

    /// What a follower does until there is no work any more.
    fn follow(&self, follower: usize) {
        let mut known = 0;
        loop {
            known = self.next(known);
            if known == OVER {
                return;
            }
            if follower as u64 >= known % FOLLOWERS {
                continue;
            }
            // SAFETY: the leader has written it before it told of the work, and waits for this follower before it writes again or what
            // it points at ends.
            if let Some(work) = unsafe { *self.work.0.get() } {
                // SAFETY: as above.
                let part = AssertUnwindSafe(|| unsafe { (*work)(follower) });
                if let Err(panic) = catch_unwind(part) {
                    *locked(&self.panic) = Some(panic);
                }
            }
            if self.left.fetch_sub(1, Ordering::SeqCst) == 1 && self.leader_sleeps.load(Ordering::SeqCst) {
                let _bed = locked(&self.bed);
                self.done.notify_all();
            }
        }
    }

    /// Waits until all followers have done their part.
    fn wait(&self) {
        let are_done = || self.left.load(Ordering::SeqCst) == 0;
        if !await_awake(are_done) {
            let mut bed = locked(&self.bed);
            self.leader_sleeps.store(true, Ordering::SeqCst);
            while !are_done() {
                bed = self.done.wait(bed).unwrap_or_else(PoisonError::into_inner);
            }
            self.leader_sleeps.store(false, Ordering::SeqCst);
        }
    }
}

impl Drop for Followers {
    fn drop(&mut self) {
        self.shared.begin(OVER);
        for thread in self.threads.drain(..) {
            // What a follower panics with is kept for the leader: none ends in one.
            let _ = thread.join();
        }
    }
}

impl Team {
    /// A team of so many threads, its leader among them; none of one.
    ///
    /// # Errors
    /// Threads that the system does not give.
    pub fn new(threads: usize) -> io::Result<Option<Self>> {
        if threads <= 1 {
            return Ok(None);
        }
        if threads as u64 >= FOLLOWERS {
            return Err(io::Error::other(format!("at most {} threads", FOLLOWERS - 1)));
        }
        let mut followers =
            Followers { shared: Arc::new(Shared::default()), threads: Vec::new(), leading: Mutex::new(()) };
        for follower in 0..threads - 1 {
            let shared = followers.shared.clone();
            followers.threads.push(Builder::new().spawn(move || shared.follow(follower))?);
        }
        Ok(Some(Team(Arc::new(followers))))
    }

    /// Its threads.
    pub fn threads(&self) -> usize {
        self.0.threads.len() + 1
    }

    /// Does all parts of a work side by side, one for each thread, the last by the leader.
    pub fn share<P: Send>(&self, parts: impl Iterator<Item = P>, one: impl Fn(P) + Sync) {
        let parts = Parts(parts.map(|part| UnsafeCell::new(Some(part))).collect());
        let Some(others) = parts.0.len().checked_sub(1) else { return };
        let parts = &parts;
        let followers = others.min(self.0.threads.len());
        let take = |number: usize| {
            // SAFETY: each number is asked for once.
            if let Some(part) = unsafe { (*parts.0[number].get()).take() } {
                one(part);
            }
        };
        let leading = match followers {
            0 => None,
            _ => match self.0.leading.try_lock() {
                // Whoever led before has panicked, after its work was done.
                Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
                free => free.ok(),
            },
        };
        let Some(_leading) = leading else {
            (0..=others).for_each(take);
            return;
        };
        let work = |follower: usize| (follower..others).step_by(followers).for_each(take);
        let work: &(dyn Fn(usize) + Sync) = &work;
        let shared = &self.0.shared;
        // SAFETY: followers are waited for before it ends, and before this is written again; that it lives longer is said to the
        // compiler alone.
        unsafe { *shared.work.0.get() = Some(std::mem::transmute::<&(dyn Fn(usize) + Sync), _>(work)) };
        shared.left.store(followers, Ordering::SeqCst);
        shared.begin((shared.begun.load(Ordering::SeqCst) / FOLLOWERS + 1) * FOLLOWERS + followers as u64);
        let own = catch_unwind(AssertUnwindSafe(|| take(others)));
        shared.wait();
        // Taken in any case: none is left for the next work.
        let of_others = locked(&shared.panic).take();
        if let Some(panic) = own.err().or(of_others) {
            resume_unwind(panic);
        }
    }

    /// Does the parts of a work, of which each thread takes the next one whenever it has done one.
    pub fn take_turns<P: Send>(&self, parts: impl Iterator<Item = P> + Send, one: impl Fn(P) + Sync) {
        let parts = Mutex::new(parts);
        let next = || locked(&parts).next();
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

    /// More parts than threads, fewer, none, and parts that share a work themselves.
    #[test]
    fn works_of_any_number_of_parts_are_done() {
        let team = Team::new(3).expect("threads").expect("a team");
        for count in [0, 1, 2, 3, 4, 17] {
            let mut counts = vec![0_u32; count];
            team.share(counts.iter_mut(), |count| {
                let mut within = [0; 4];
                team.share(within.iter_mut(), |within| *within += 1);
                *count += within.iter().sum::<u32>();
            });
            assert_eq!(counts, vec![4; count]);
        }
    }

    /// A panic of a part reaches the leader once all parts are done, and the team works on.
    #[test]
    fn a_panic_reaches_the_leader() {
        let team = Team::new(3).expect("threads").expect("a team");
        for bad in 0..3 {
            let done = AtomicUsize::new(0);
            let work = AssertUnwindSafe(|| {
                team.share(0..3, |part| {
                    assert_ne!(part, bad);
                    done.fetch_add(1, Ordering::SeqCst);
                });
            });
            assert!(catch_unwind(work).is_err());
            assert_eq!(done.load(Ordering::SeqCst), 2);
        }
        let all = AssertUnwindSafe(|| team.share(0..3, |part| assert_eq!(part, 3)));
        assert!(catch_unwind(all).is_err());
        team.share(0..3, |_| {});
    }
}
