//! Threads that share the steps of a body.
//!
//! A step of a small body is over before a thread that sleeps has woken, or a queue has handed it over. So those of a team look for the
//! next work, which is told by one number, for a while before they sleep, and the one that leads looks for the others to be done in the
//! same way.
//!
//! Nobody waits for a thread that has not come: where other programs keep processors busy, one that is called may come long after
//! the work is over. What it would have done, others do, and only those that have joined a work are waited for.

use std::any::Any;
use std::cell::UnsafeCell;
use std::hint::spin_loop;
use std::io;
use std::marker::PhantomData;
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{Builder, JoinHandle, yield_now};
use std::time::{Duration, Instant};

/// How long a thread looks for others before it sleeps: some times what waking it takes.
const PATIENCE: Duration = Duration::from_micros(100);

/// Looks between two at the clock, after which a thread lets others have its processor.
const LOOKS: u32 = 64;

/// A leader, which is the thread that calls, and those that work beside it.
#[derive(Clone)]
pub struct Team(Arc<Followers>);

/// Threads beside the leader; they end with it.
struct Followers {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
    /// Held by the one that leads: another that shares a work meanwhile, or a part of it that does, works alone.
    leading: Mutex<Room>,
}

/// Room for the parts of a work, which a step finds as the last one has left it.
#[derive(Default)]
struct Room {
    words: Vec<MaybeUninit<Word>>,
    /// The next part of those that are each thread's own.
    turns: Vec<Turn>,
}

/// What parts are kept in.
type Word = u128;

/// A work as it is told: its number, how many followers are called, whether they may still join, and how many have joined and
/// are not done.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Call(u64);

impl Call {
    /// One more that has joined.
    const JOINED: u64 = 1;
    const MOST_JOINED: u64 = (1 << 16) - 1;
    const IS_OPEN: u64 = 1 << 16;
    /// One more that is called.
    const CALLED: u64 = 1 << 17;
    const MOST_CALLED: u64 = (1 << 15) - 1;
    /// The next number.
    const NEXT: u64 = 1 << 32;
    /// That there is no work any more.
    const OVER: Call = Call(u64::MAX);

    /// The next call, of so many followers.
    fn next(self, followers: usize) -> Call {
        let number = self.number().wrapping_add(1).wrapping_mul(Call::NEXT);
        Call(number + followers as u64 * Call::CALLED + Call::IS_OPEN)
    }

    fn number(self) -> u64 {
        self.0 / Call::NEXT
    }

    /// Whether a follower may join.
    fn is_open_to(self, follower: usize) -> bool {
        self.0 & Call::IS_OPEN != 0 && (follower as u64) < (self.0 / Call::CALLED) & Call::MOST_CALLED
    }

    /// Whether all that have joined are done.
    fn is_done(self) -> bool {
        self.0 & Call::MOST_JOINED == 0
    }
}

/// What a leader and its followers tell each other.
#[derive(Default)]
struct Shared {
    /// The last [`Call`].
    call: AtomicU64,
    work: Work,
    /// Whether followers sleep or are about to, and whether the leader does.
    followers_sleep: AtomicBool,
    leader_sleeps: AtomicBool,
    bed: Mutex<()>,
    morning: Condvar,
    done: Condvar,
}

/// The work at hand: what each follower is to do, by its number.
#[derive(Default)]
struct Work(UnsafeCell<Option<*const (dyn Fn(usize) + Sync)>>);

// SAFETY: the leader writes it while no follower has joined a work, and those that do join read it after the leader has told of the next.
unsafe impl Send for Work {}
// SAFETY: as above.
unsafe impl Sync for Work {}

/// Parts of a work, each of which one thread takes, in a room.
struct Parts<P> {
    first: *mut MaybeUninit<Word>,
    count: usize,
    kind: PhantomData<P>,
}

// SAFETY: each part is taken by one thread.
unsafe impl<P: Send> Sync for Parts<P> {}

impl<P> Parts<P> {
    /// Words that a part fills.
    const WORDS: usize = size_of::<P>().div_ceil(size_of::<Word>());

    /// Puts parts into a room.
    fn put(parts: impl Iterator<Item = P>, words: &mut Vec<MaybeUninit<Word>>) -> Self {
        const { assert!(align_of::<P>() <= align_of::<Word>()) };
        words.clear();
        let mut count = 0;
        for part in parts {
            words.resize((count + 1) * Self::WORDS, MaybeUninit::uninit());
            let place: *mut P = words[count * Self::WORDS..].as_mut_ptr().cast();
            // SAFETY: these words are as many as a part fills, and aligned as it is.
            unsafe { place.write(part) };
            count += 1;
        }
        Parts { first: words.as_mut_ptr(), count, kind: PhantomData }
    }

    /// Takes a part.
    ///
    /// # Safety
    /// Each is taken once, while nothing else is put into the room.
    unsafe fn take(&self, number: usize) -> P {
        debug_assert!(number < self.count);
        // SAFETY: a part was put there, and nobody else takes it.
        unsafe { self.first.add(number * Self::WORDS).cast::<P>().read() }
    }
}

/// The next part of those that are a thread's own, away from that of others in memory.
#[derive(Default)]
#[repr(align(128))]
struct Turn(AtomicUsize);

/// What a part of a work panicked with, if one did.
#[derive(Default)]
struct Panic(Mutex<Option<Box<dyn Any + Send>>>);

impl Panic {
    /// Does a part.
    fn catch(&self, part: impl FnOnce()) {
        if let Err(cause) = catch_unwind(AssertUnwindSafe(part)) {
            *locked(&self.0) = Some(cause);
        }
    }

    /// Goes on with the panic.
    fn resume(self) {
        if let Some(cause) = self.0.into_inner().unwrap_or_else(PoisonError::into_inner) {
            resume_unwind(cause);
        }
    }
}

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
    fn call(&self) -> Call {
        Call(self.call.load(Ordering::SeqCst))
    }

    /// Waits for a call of another number.
    fn next(&self, known: u64) -> Call {
        let is_new = || self.call().number() != known || self.call() == Call::OVER;
        if !await_awake(is_new) {
            let mut bed = locked(&self.bed);
            loop {
                // Said before the last look: a leader that calls after it sees a sleeper.
                self.followers_sleep.store(true, Ordering::SeqCst);
                if is_new() {
                    break;
                }
                bed = self.morning.wait(bed).unwrap_or_else(PoisonError::into_inner);
            }
        }
        self.call()
    }

    /// Tells of a work.
    fn tell(&self, call: Call) {
        self.call.store(call.0, Ordering::SeqCst);
        if self.followers_sleep.swap(false, Ordering::SeqCst) {
            let _bed = locked(&self.bed);
            self.morning.notify_all();
        }
    }

    /// What a follower does until there is no work any more.
    fn follow(&self, follower: usize) {
        let mut call = Call(0);
        loop {
            call = self.next(call.number());
            if call == Call::OVER {
                return;
            }
            if self.join(call.number(), follower) {
                // SAFETY: the leader has written it before it told of the work, and waits for this follower, which has joined, before it
                // writes again or what it points at ends.
                if let Some(work) = unsafe { *self.work.0.get() } {
                    // SAFETY: as above.
                    unsafe { (*work)(follower) };
                }
                let before = Call(self.call.fetch_sub(Call::JOINED, Ordering::SeqCst));
                if Call(before.0 - Call::JOINED).is_done() && self.leader_sleeps.load(Ordering::SeqCst) {
                    let _bed = locked(&self.bed);
                    self.done.notify_all();
                }
            }
        }
    }

    /// Joins the work of a number, if that is the last and open.
    fn join(&self, number: u64, follower: usize) -> bool {
        let may = |call: Call| call.number() == number && call.is_open_to(follower) && call != Call::OVER;
        let joined = |call| may(Call(call)).then_some(call + Call::JOINED);
        self.call.fetch_update(Ordering::SeqCst, Ordering::SeqCst, joined).is_ok()
    }

    /// Lets nobody join any more, and waits until all that have are done.
    fn close(&self) {
        self.call.fetch_and(!Call::IS_OPEN, Ordering::SeqCst);
        let are_done = || self.call().is_done();
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

/// Closes a work, however the leader's own part of it ends.
struct Closing<'a>(&'a Shared);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.0.close();
    }
}

impl Followers {
    /// None yet, of so many threads, their leader among them.
    fn none(threads: usize) -> Self {
        let room = Room { words: Vec::new(), turns: (0..threads).map(|_| Turn::default()).collect() };
        Followers { shared: Arc::new(Shared::default()), threads: Vec::new(), leading: Mutex::new(room) }
    }
}

impl Drop for Followers {
    fn drop(&mut self) {
        self.shared.tell(Call::OVER);
        for thread in self.threads.drain(..) {
            // What a part panics with is kept for the leader: no follower ends in a panic.
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
        if threads as u64 > Call::MOST_CALLED {
            return Err(io::Error::other(format!("at most {} threads", Call::MOST_CALLED)));
        }
        let mut followers = Followers::none(threads);
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

    /// Does all parts of a work side by side: each thread its own, which follow each other and are the same each time, for what it
    /// has read before is nearer to it than to others; and then those that others have not begun.
    ///
    /// # Panics
    /// As a part does, once all parts are done.
    pub fn share<P: Send>(&self, parts: impl Iterator<Item = P>, one: impl Fn(P) + Sync) {
        let panic = Panic::default();
        let mut leading = match self.0.leading.try_lock() {
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Ok(leading) => leading,
            Err(TryLockError::WouldBlock) => {
                parts.for_each(|part| panic.catch(|| one(part)));
                return panic.resume();
            }
        };
        let Room { words, turns } = &mut *leading;
        let parts = &Parts::put(parts, words);
        let threads = self.threads().min(parts.count);
        let first = |thread: usize| parts.count * thread / threads;
        for (thread, turn) in turns[..threads].iter_mut().enumerate() {
            *turn.0.get_mut() = first(thread);
        }
        let turns = &*turns;
        let work = |own: usize| {
            for thread in (own..threads).chain(0..own) {
                loop {
                    let number = turns[thread].0.fetch_add(1, Ordering::Relaxed);
                    if number >= first(thread + 1) {
                        break;
                    }
                    // SAFETY: each number comes up once, and the room is this work's until it is done.
                    let part = unsafe { parts.take(number) };
                    panic.catch(|| one(part));
                }
            }
        };
        self.lead(threads, &work);
        drop(leading);
        panic.resume();
    }

    /// Does a work by so many threads, of which this is the last.
    fn lead(&self, threads: usize, work: &(dyn Fn(usize) + Sync)) {
        let Some(followers) = threads.checked_sub(1) else { return };
        if followers == 0 {
            return work(followers);
        }
        let shared = &self.0.shared;
        // SAFETY: nobody has joined; those that do are waited for before it ends, and before this is written again. That it lives longer
        // is said to the compiler alone.
        unsafe { *shared.work.0.get() = Some(std::mem::transmute::<&(dyn Fn(usize) + Sync), _>(work)) };
        shared.tell(shared.call().next(followers));
        let _closing = Closing(shared);
        work(followers);
    }
}

/// Does all parts of a work: side by side where there is a team, one after the other where there is none.
pub fn share<P: Send>(team: Option<&Team>, parts: impl Iterator<Item = P>, one: impl Fn(P) + Sync) {
    match team {
        Some(team) => team.share(parts, one),
        None => parts.for_each(one),
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
        team.share(numbers.chunks_mut(7).enumerate(), |(task, numbers)| numbers.fill(task));
        assert!(numbers.iter().enumerate().all(|(place, task)| place / 7 == *task));
        assert!(Team::new(1).expect("threads").is_none());
    }

    /// Followers that do not come, as where other programs keep their processors busy, are not waited for.
    #[test]
    fn a_leader_does_what_nobody_has_begun() {
        let team = Team(Arc::new(Followers::none(3)));
        for round in 1..10_u64 {
            let done = AtomicUsize::new(0);
            team.lead(3, &|own| {
                done.fetch_add(1 + own, Ordering::SeqCst);
                let call = team.0.shared.call();
                assert!(call.number() == round && call.is_open_to(1) && !call.is_open_to(2));
            });
            // One who comes now does not join.
            assert!(!team.0.shared.join(round, 0));
            assert_eq!(done.load(Ordering::SeqCst), 3);
        }
    }

    /// Parts of any size, which are dropped once.
    #[test]
    fn parts_are_handed_over_whole() {
        let team = Team::new(2).expect("threads").expect("a team");
        let done = AtomicUsize::new(0);
        team.share([(); 5].into_iter(), |()| {
            done.fetch_add(1, Ordering::SeqCst);
        });
        assert_eq!(done.into_inner(), 5);
        let counted = Arc::new(());
        let sums = Mutex::new(Vec::new());
        let parts = (0..9_u8).map(|number| (number, [u64::from(number); 7], counted.clone()));
        team.share(parts, |(number, numbers, _counted)| {
            locked(&sums).push((number, numbers.iter().sum::<u64>()));
        });
        let mut sums = sums.into_inner().expect("no panic");
        sums.sort_unstable();
        assert!(sums.iter().enumerate().all(|(place, sum)| *sum == (place as u8, 7 * place as u64)) && sums.len() == 9);
        assert_eq!(Arc::strong_count(&counted), 1);
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
