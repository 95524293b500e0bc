//! Work in parts that do not depend on the number of threads.

use std::sync::Arc;

use rayon::ThreadPool;
use rayon::prelude::*;

/// Particles that one task handles; fixed, so that results do not depend on the number of threads.
const TASK: usize = 2048;

/// A column, if it is used.
pub(super) fn when(used: bool, column: &[f64]) -> &[f64] {
    if used { column } else { &[] }
}

/// Does something to tasks of fixed size, by the number of their first row.
pub(super) fn tasks<T: Send>(pool: Option<&Arc<ThreadPool>>, rows: &mut [T], one: impl Fn(usize, &mut [T]) + Sync) {
    let task = |(number, rows): (usize, &mut [T])| one(number * TASK, rows);
    match pool {
        Some(pool) if rows.len() > 2 * TASK => {
            pool.install(|| rows.par_chunks_mut(TASK).enumerate().for_each(task));
        }
        _ => rows.chunks_mut(TASK).enumerate().for_each(task),
    }
}

/// Does something to each row, in tasks of fixed size.
pub(super) fn each<T: Send>(pool: Option<&Arc<ThreadPool>>, rows: &mut [T], one: impl Fn(usize, &mut T) + Sync) {
    tasks(pool, rows, |first, rows| rows.iter_mut().enumerate().for_each(|(offset, row)| one(first + offset, row)));
}
