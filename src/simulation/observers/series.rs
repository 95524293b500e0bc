//! Observers of one series: rows are read off the state at instants, and left at the end.

use crate::recorded::Recorded;
use frazil_core::saved::{Pass, Saved};
use frazil_record::RunResult;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::observer::{End, Instants, Made, Observer, Schedule, View, room};

struct Recorder<Row, Read, Leave> {
    instants: Instants,
    rows: Vec<Row>,
    /// What is held beside the rows at the end of a run (bytes).
    beside: usize,
    read: Read,
    leave: Leave,
}

/// An observer that adds to `rows`, for which room has been made, by `read`, and leaves them by `leave`; `by_row` and `beside` are
/// what each row and all of them hold besides (bytes).
pub(super) fn series<Row: Serialize + DeserializeOwned + 'static>(
    instants: Instants,
    rows: Vec<Row>,
    (by_row, beside): (usize, usize),
    read: impl FnMut(&View<'_>, &mut Vec<Row>) + 'static,
    leave: impl FnOnce(Vec<Row>, &mut RunResult) + 'static,
) -> Made {
    let beside = beside + rows.capacity() * by_row;
    Some(Box::new(Recorder { instants, rows, beside, read, leave }))
}

impl<Row: Serialize + DeserializeOwned, Read, Leave> Saved for Recorder<Row, Read, Leave> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        Recorded(&mut self.rows).pass(pass);
    }
}

impl<Row, Read, Leave> Observer for Recorder<Row, Read, Leave>
where
    Row: Serialize + DeserializeOwned,
    Read: FnMut(&View<'_>, &mut Vec<Row>),
    Leave: FnOnce(Vec<Row>, &mut RunResult),
{
    fn schedule(&self) -> Schedule {
        Schedule { instants: self.instants, ..Schedule::OUTPUTS }
    }

    fn observe(&mut self, view: &View<'_>) {
        (self.read)(view, &mut self.rows);
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        (self.leave)(self.rows, result);
    }

    fn held_at_the_end(&self) -> usize {
        room(&self.rows) + self.beside
    }
}
