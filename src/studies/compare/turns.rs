//! Which run comes next, and what time it may take: cheap ones first, whatever their method.
//!
//! Time is shared between curves, each of them a method under a setting from coarse to fine. The next run is always that
//! which is expected to be the cheapest of all, so a costly method comes last and cannot push out the short runs of another.

/// Share of the time for a scene that first runs may take; the rest is for repeated ones.
pub const FIRST_RUNS: f64 = 0.6;

/// A run may take this multiple of what was expected of it before it is cut off, as long as time is left.
const SLACK: f64 = 4.0;

/// Runs shorter than this are too short to tell how cost grows with resolution (s).
const SHORT: f64 = 0.02;

/// What is known of one run of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turn {
    /// To be made.
    Waiting,
    /// Made, in this time (s).
    Made(f64),
    /// Cannot be made.
    Refused,
    /// Not to be made: it would take too long, or a coarser one did.
    LeftOut,
}

/// The runs of a curve from coarse to fine.
#[derive(Debug, Clone)]
pub struct Line {
    /// Runs by level.
    pub turns: Vec<Turn>,
    /// Ratio by which an explicit step makes a run cost more at half the spacing.
    pub growth: f64,
}

impl Line {
    /// The next run that waits.
    fn next(&self) -> Option<usize> {
        self.turns.iter().position(|turn| *turn == Turn::Waiting)
    }

    /// Leaves out what still waits from a level on, and says which levels those are.
    pub fn leave_out(&mut self, level: usize) -> Vec<usize> {
        let waiting = |k: &usize| self.turns[*k] == Turn::Waiting;
        let out: Vec<usize> = (level..self.turns.len()).filter(waiting).collect();
        out.iter().for_each(|k| self.turns[*k] = Turn::LeftOut);
        out
    }

    /// Time of a run from those of coarser ones (s): it grows by the ratio seen, or by that of an explicit step. Zero where
    /// nothing is known.
    pub fn expected(&self, level: usize) -> f64 {
        let time = |level: usize| match self.turns.get(level) {
            Some(Turn::Made(time)) => Some(*time),
            _ => None,
        };
        let Some((last, took)) = (0..level).rev().find_map(|level| Some((level, time(level)?))) else { return 0.0 };
        let before = last.checked_sub(1).and_then(time).filter(|before| *before > SHORT);
        let growth = before.map_or(self.growth, |before| (took / before).clamp(2.0, 2.0 * self.growth));
        took * growth.powi((level - last) as i32)
    }
}

/// The next run: curve, level and expected time (s), the least of all. Of equal ones the first curve's.
pub fn next(lines: &[Line]) -> Option<(usize, usize, f64)> {
    let waiting = lines.iter().enumerate().filter_map(|(k, line)| {
        let level = line.next()?;
        Some((k, level, line.expected(level)))
    });
    waiting.min_by(|a, b| a.2.total_cmp(&b.2).then(a.1.cmp(&b.1)))
}

/// Time that a run may take (s) of what is left for first runs: some multiple of what is expected, and at least an even share
/// with the other curves that wait.
pub fn allowed(lines: &[Line], expected: f64, left: f64) -> f64 {
    let waiting = lines.iter().filter(|line| line.next().is_some()).count().max(1);
    (SLACK * expected).max(left / waiting as f64).min(left)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Works through lines whose runs take known times, and returns what was made of each.
    fn play(times: &[&[f64]], budget: f64) -> Vec<Vec<bool>> {
        let mut lines: Vec<Line> =
            times.iter().map(|line| Line { turns: vec![Turn::Waiting; line.len()], growth: 8.0 }).collect();
        let mut left = budget;
        while let Some((line, level, expected)) = next(&lines) {
            if expected > left {
                lines[line].leave_out(level);
                continue;
            }
            let took = times[line][level].min(allowed(&lines, expected, left));
            left -= took;
            lines[line].turns[level] = Turn::Made(took);
        }
        lines.iter().map(|line| line.turns.iter().map(|turn| matches!(turn, Turn::Made(_))).collect()).collect()
    }

    #[test]
    fn a_long_run_does_not_push_short_ones_of_others_out() {
        // The last run of the second method would take most of the time, and its turn comes by level before the others' last.
        let made = play(&[&[0.02, 0.16, 1.3, 10.0], &[0.3, 2.0, 23.0, 180.0], &[0.02, 0.2, 1.5, 11.0]], 27.0);
        assert_eq!(made[0], [true; 4]);
        assert_eq!(made[2], [true; 4]);
        assert_eq!(made[1], [true, true, false, false]);
    }

    #[test]
    fn a_run_that_takes_longer_than_expected_leaves_the_others_their_share() {
        let lines = vec![Line { turns: vec![Turn::Made(0.1), Turn::Waiting], growth: 8.0 }; 4];
        assert_eq!(allowed(&lines, 0.8, 40.0), 10.0);
        assert_eq!(allowed(&lines, 3.0, 40.0), 12.0);
        assert_eq!(allowed(&lines, 30.0, 40.0), 40.0);
    }

    #[test]
    fn costs_are_foretold_over_a_level_that_is_missing() {
        let line = Line { turns: vec![Turn::Made(1.0), Turn::Made(4.0), Turn::Refused, Turn::Waiting], growth: 8.0 };
        assert_eq!(line.expected(3), 64.0);
        assert_eq!(line.expected(0), 0.0);
        assert_eq!(line.next(), Some(3));
    }
}
