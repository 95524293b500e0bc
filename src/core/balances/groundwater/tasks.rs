//! Work in parts that do not depend on the number of threads.

use crate::team::Team;

/// Particles that one task handles; fixed, so that results do not depend on the number of threads.
const TASK: usize = 2048;

/// Particles from which on threads share them: work on fewer is over before it is shared.
const MANY: usize = 8 * TASK;

/// A column, if it is used.
pub(super) fn when(used: bool, column: &[f64]) -> &[f64] {
    if used { column } else { &[] }
}

/// Does something to tasks of fixed size, by the number of their first row.
pub(super) fn tasks<T: Send>(team: Option<&Team>, rows: &mut [T], one: impl Fn(usize, &mut [T]) + Sync) {
    let task = |(number, rows): (usize, &mut [T])| one(number * TASK, rows);
    match team {
        Some(team) if rows.len() > MANY => team.take_turns(rows.chunks_mut(TASK).enumerate(), task),
        _ => rows.chunks_mut(TASK).enumerate().for_each(task),
    }
}

/// Does something to each row, in tasks of fixed size.
pub(super) fn each<T: Send>(team: Option<&Team>, rows: &mut [T], one: impl Fn(usize, &mut T) + Sync) {
    tasks(team, rows, |first, rows| rows.iter_mut().enumerate().for_each(|(offset, row)| one(first + offset, row)));
}
