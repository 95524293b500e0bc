//! A campaign in several pieces, each by a process of its own, on one machine or many.

/// Which part of a campaign is worked on, of how many.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Its number, from 0.
    pub number: usize,
    /// How many there are.
    pub count: usize,
}

impl Shard {
    /// All of it.
    pub const WHOLE: Shard = Shard { number: 0, count: 1 };

    /// Whether a task is its own.
    pub fn has(self, task: usize) -> bool {
        task % self.count == self.number
    }

    /// The file that it adds findings to: its own, so that folders of several machines can be laid into one.
    pub(super) fn file(self) -> String {
        match self {
            Shard::WHOLE => "runs.journal".into(),
            Shard { number, count } => format!("runs-{}-of-{count}.journal", number + 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_task_is_of_one_shard() {
        for task in 0..20 {
            assert_eq!((0..3).filter(|number| Shard { number: *number, count: 3 }.has(task)).count(), 1);
            assert!(Shard::WHOLE.has(task));
        }
    }
}
