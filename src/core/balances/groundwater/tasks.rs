//! Work in parts that do not depend on the number of threads.

use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::Relaxed;

use crate::balances::groundwater::diagonals;
use crate::team::{self, Team};

/// Particles that one task handles; fixed, so that results do not depend on the number of threads.
pub(super) const TASK: usize = 2048;

/// Particles from which on threads share them: work on fewer is over before it is shared.
const MANY: usize = 8 * TASK;

/// A column, if it is used.
pub(super) fn when(used: bool, column: &[f64]) -> &[f64] {
    if used { column } else { &[] }
}

/// Those of some particles, ascending, that are among so many from one on.
pub(super) fn among(particles: &[u32], first: usize, count: usize) -> impl Iterator<Item = usize> + '_ {
    let before = particles.partition_point(|particle| (*particle as usize) < first);
    particles[before..].iter().map(|particle| *particle as usize).take_while(move |particle| *particle < first + count)
}

/// Does something to tasks of fixed size, by the number of their first row.
pub(super) fn tasks<T: Send>(team: Option<&Team>, rows: &mut [T], one: impl Fn(usize, &mut [T]) + Sync) {
    let count = rows.len();
    share(team, count, rows.chunks_mut(TASK).enumerate(), |(number, rows)| one(number * TASK, rows));
}

/// The same to two columns at once.
pub(super) fn tasks_of_two<T: Send, U: Send>(
    team: Option<&Team>,
    (rows, others): (&mut [T], &mut [U]),
    one: impl Fn(usize, &mut [T], &mut [U]) + Sync,
) {
    let count = rows.len();
    let parts = rows.chunks_mut(TASK).zip(others.chunks_mut(TASK)).enumerate();
    share(team, count, parts, |(number, (rows, others))| one(number * TASK, rows, others));
}

/// The sum of so many terms, task by task; `sums` is room for those of tasks.
pub(super) fn sum(team: Option<&Team>, sums: &mut Vec<f64>, count: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    sums.resize(count.div_ceil(TASK), 0.0);
    share(team, count, sums.iter_mut().enumerate(), |(number, sum)| {
        let first = number * TASK;
        *sum = diagonals::sum(TASK.min(count - first), |i| term(first + i));
    });
    sums.iter().sum()
}

/// Whether something is so of any of so many numbers.
pub(super) fn any(team: Option<&Team>, count: usize, is_so: impl Fn(usize) -> bool + Sync) -> bool {
    let found = AtomicBool::new(false);
    share(team, count, (0..count).step_by(TASK), |first| {
        if !found.load(Relaxed) && (first..count.min(first + TASK)).any(&is_so) {
            found.store(true, Relaxed);
        }
    });
    found.into_inner()
}

/// Does parts of a work on so many rows, side by side if they are many.
pub(super) fn share<P: Send>(
    team: Option<&Team>,
    count: usize,
    parts: impl Iterator<Item = P> + Send,
    one: impl Fn(P) + Sync,
) {
    team::share(team.filter(|_| count > MANY), parts, one);
}

/// Does something to each row, in tasks of fixed size.
pub(super) fn each<T: Send>(team: Option<&Team>, rows: &mut [T], one: impl Fn(usize, &mut T) + Sync) {
    tasks(team, rows, |first, rows| rows.iter_mut().enumerate().for_each(|(offset, row)| one(first + offset, row)));
}
