//! Work in parts that do not depend on the number of threads.

use crate::team::Team;

/// Particles that one task handles; fixed, so that results do not depend on the number of threads.
pub(super) const TASK: usize = 2048;

/// Particles from which on threads share them: work on fewer is over before it is shared.
const MANY: usize = 8 * TASK;

/// A column, if it is used.
pub(super) fn when(used: bool, column: &[f64]) -> &[f64] {
    if used { column } else { &[] }
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

/// Does parts of a work on so many rows, side by side if they are many.
pub(super) fn share<P: Send>(
    team: Option<&Team>,
    count: usize,
    parts: impl Iterator<Item = P> + Send,
    one: impl Fn(P) + Sync,
) {
    match team {
        Some(team) if count > MANY => team.take_turns(parts, one),
        _ => parts.for_each(one),
    }
}

/// Does something to each row, in tasks of fixed size.
pub(super) fn each<T: Send>(team: Option<&Team>, rows: &mut [T], one: impl Fn(usize, &mut T) + Sync) {
    tasks(team, rows, |first, rows| rows.iter_mut().enumerate().for_each(|(offset, row)| one(first + offset, row)));
}
