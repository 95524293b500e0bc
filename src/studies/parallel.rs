//! Tasks side by side, with answers that do not depend on who did what when.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use frazil_core::memory;

/// Concurrent runs, as [`in_order`]; they share the memory that there is.
pub fn runs<T: Send>(tasks: usize, workers: usize, work: impl Fn(usize) -> Option<T> + Sync) -> Vec<Option<T>> {
    memory::share(workers.clamp(1, tasks.max(1)));
    let answers = in_order(tasks, workers, work);
    memory::share(1);
    answers
}

/// Answers to tasks 0, 1, 2, ... in the order of their numbers. Each of `workers` threads takes the next task that is
/// free; a task without an answer stays empty.
pub fn in_order<T: Send>(tasks: usize, workers: usize, work: impl Fn(usize) -> Option<T> + Sync) -> Vec<Option<T>> {
    let next = AtomicUsize::new(0);
    let answers: Mutex<Vec<Option<T>>> = Mutex::new((0..tasks).map(|_| None).collect());
    let workers = workers.clamp(1, tasks.max(1));
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                loop {
                    let task = next.fetch_add(1, Ordering::Relaxed);
                    if task >= tasks {
                        return;
                    }
                    let answer = work(task);
                    answers.lock().unwrap_or_else(PoisonError::into_inner)[task] = answer;
                }
            });
        }
    });
    answers.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// Threads that the machine can work on at once.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_stand_by_their_number_for_any_number_of_workers() {
        for workers in [0, 1, 3, 50] {
            let answers = in_order(20, workers, |task| (task % 7 != 0).then_some(task * task));
            for (task, answer) in answers.iter().enumerate() {
                assert_eq!(*answer, (task % 7 != 0).then_some(task * task));
            }
        }
        assert!(in_order(0, 2, Some).is_empty());
    }
}
