//! Quantities and work that change in time.

use std::sync::Arc;

use crate::formula::OverTime;

/// A quantity that is constant or given as a table in time (linear between rows, constant beyond them) or as a formula.
#[derive(Debug, Clone, PartialEq)]
pub enum Series {
    /// The same at all times.
    Constant(f64),
    /// Times (s, strictly increasing) and values.
    Table(Vec<(f64, f64)>),
    /// A table that repeats: linear from its last row to the first of the next period.
    Repeated {
        /// Times (s, strictly increasing, at most one period) and values.
        rows: Vec<(f64, f64)>,
        /// Length of one period (s).
        period: f64,
    },
    /// A formula of the time.
    Formula(Arc<OverTime>),
}

impl Series {
    /// Value at time `t` (s).
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Series::Constant(value) => *value,
            Series::Table(rows) => {
                let after = rows.partition_point(|row| row.0 <= t);
                if after == 0 {
                    return rows[0].1;
                }
                if after == rows.len() {
                    return rows[after - 1].1;
                }
                between(rows[after - 1], rows[after], t)
            }
            Series::Repeated { rows, period } => {
                let t = t.rem_euclid(*period);
                let after = rows.partition_point(|row| row.0 <= t);
                let (first, last) = (rows[0], rows[rows.len() - 1]);
                if after == 0 {
                    between((last.0 - period, last.1), first, t)
                } else if after == rows.len() {
                    between(last, (first.0 + period, first.1), t)
                } else {
                    between(rows[after - 1], rows[after], t)
                }
            }
            Series::Formula(formula) => formula.at(t),
        }
    }

    /// The series times a factor.
    pub fn scaled(&self, factor: f64) -> Series {
        let scale = |rows: &[(f64, f64)]| rows.iter().map(|(time, value)| (*time, factor * value)).collect();
        match self {
            Series::Constant(value) => Series::Constant(factor * value),
            Series::Table(rows) => Series::Table(scale(rows)),
            Series::Repeated { rows, period } => Series::Repeated { rows: scale(rows), period: *period },
            Series::Formula(formula) => Series::Formula(Arc::new(formula.scaled(factor))),
        }
    }

    /// The first instant after `t` (s) at which the series bends, jumps or, as a formula, turns.
    pub fn next_bend(&self, t: f64) -> Option<f64> {
        match self {
            Series::Constant(_) => None,
            Series::Table(rows) => rows.get(rows.partition_point(|row| row.0 <= t)).map(|row| row.0),
            Series::Repeated { rows, period } => {
                let cycle = (t / period).floor();
                let instants = [cycle - 1.0, cycle, cycle + 1.0].into_iter();
                let instants = instants.flat_map(|cycle| rows.iter().map(move |row| cycle * period + row.0));
                instants.filter(|instant| *instant > t).reduce(f64::min)
            }
            Series::Formula(formula) => formula.next_turn(t),
        }
    }

    /// Integral over time from 0 to `t` (s).
    pub fn integral(&self, t: f64) -> f64 {
        if let Series::Formula(formula) = self {
            return formula.integral(t);
        }
        let (mut sum, mut start) = (0.0, 0.0);
        while start < t {
            let end = self.next_bend(start).map_or(t, |bend| bend.min(t));
            // Straight from one bend to the next, and free of the jumps there.
            sum += self.at(0.5 * (start + end)) * (end - start);
            start = end;
        }
        sum
    }

    /// The value, if it is the same at all times.
    pub fn constant(&self) -> Option<f64> {
        let (least, greatest) = self.range();
        (least == greatest).then_some(least)
    }

    /// Whether the value is not the same at all times.
    pub fn changes(&self) -> bool {
        self.constant().is_none()
    }

    /// Least and greatest value over all times, of a formula over those of the run.
    pub fn range(&self) -> (f64, f64) {
        match self {
            Series::Constant(value) => (*value, *value),
            Series::Table(rows) | Series::Repeated { rows, .. } => {
                rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), row| (lo.min(row.1), hi.max(row.1)))
            }
            Series::Formula(formula) => formula.range(),
        }
    }
}

/// The value at time `t` (s) on the straight line from one row to a later one.
fn between((t0, v0): (f64, f64), (t1, v1): (f64, f64), t: f64) -> f64 {
    if t1 <= t0 { v1 } else { v0 + (v1 - v0) * (t - t0) / (t1 - t0) }
}

/// When a ring of pipes works.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Intervals of work (s): from each first instant up to, but not including, the second. They do not overlap and
    /// stand in order; with a period, the last ends within it.
    pub on: Vec<(f64, f64)>,
    /// Length (s) after which the intervals repeat; they happen once if absent.
    pub period: Option<f64>,
}

impl Schedule {
    /// All intervals that touch the instants near `t`, repeated ones at their place in time.
    fn near(&self, t: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        // The same sum for a switch and for the question whether it is past: rounding cannot part them.
        let (first, last, period) = match self.period {
            Some(period) => ((t / period).floor() - 1.0, 2, period),
            None => (0.0, 0, 0.0),
        };
        (0..=last).flat_map(move |k| {
            let start = (first + f64::from(k)).max(0.0) * period;
            self.on.iter().map(move |(from, to)| (start + from, start + to))
        })
    }

    /// Whether the pipes work at time `t` (s).
    pub fn works(&self, t: f64) -> bool {
        self.near(t).any(|(from, to)| from <= t && t < to)
    }

    /// How many times the pipes are switched within a time (s), at most.
    pub fn switches(&self, duration: f64) -> f64 {
        2.0 * self.on.len() as f64 * self.period.map_or(1.0, |period| (duration / period).ceil())
    }

    /// The first instant after `t` (s) at which the pipes are switched.
    pub fn next_switch(&self, t: f64) -> Option<f64> {
        self.near(t)
            .flat_map(|(from, to)| [from, to])
            .filter(|instant| *instant > t && instant.is_finite())
            .reduce(f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_end_anywhere_between_bends() {
        let table = Series::Table(vec![(1.0, 2.0), (3.0, 6.0)]);
        assert_eq!([0.0, 1.0, 2.0, 3.0, 5.0].map(|t| table.integral(t)), [0.0, 2.0, 5.0, 10.0, 22.0]);
        let jump = Series::Repeated { rows: vec![(0.0, 0.0), (4.0, 8.0)], period: 4.0 };
        assert_eq!([4.0, 6.0, 8.0].map(|t| jump.integral(t)), [16.0, 20.0, 32.0]);
        assert_eq!(Series::Constant(3.0).integral(2.0), 6.0);
    }

    #[test]
    fn a_repeated_table_is_linear_across_its_ends() {
        let series = Series::Repeated { rows: vec![(1.0, 10.0), (3.0, -10.0)], period: 4.0 };
        // From -10 at 3 to 10 at 5: zero at the turn of the period.
        for (time, value) in [(0.0, 0.0), (1.0, 10.0), (2.0, 0.0), (3.0, -10.0), (3.5, -5.0), (4.0, 0.0), (4.5, 5.0)] {
            for cycle in [0.0, 1.0, 1000.0] {
                assert_eq!(series.at(time + 4.0 * cycle), value, "{time} of cycle {cycle}");
            }
        }
        assert_eq!(series.range(), (-10.0, 10.0));
        let jump = Series::Repeated { rows: vec![(0.0, 0.0), (4.0, 8.0)], period: 4.0 };
        assert_eq!((jump.at(3.0), jump.at(4.0), jump.at(5.0)), (6.0, 0.0, 2.0));
        let constant = Series::Repeated { rows: vec![(1.0, 7.0)], period: 4.0 };
        assert!([0.0, 1.0, 3.9, 4.0, 17.3].iter().all(|time| constant.at(*time) == 7.0) && !constant.changes());
    }

    /// Thirds and tenths have no exact sum, but work begins and ends at the very instants that steps land on.
    #[test]
    fn pipes_work_from_switch_to_switch() {
        for period in [0.1, 1.0 / 3.0, 7200.0] {
            let schedule = Schedule { on: vec![(0.0, 0.2 * period), (0.5 * period, period)], period: Some(period) };
            let (mut time, mut worked, mut switches) = (0.0, 0.0, 0);
            while time < 1000.0 * period {
                let next = schedule.next_switch(time).expect("it repeats");
                assert!(next > time);
                let middle = schedule.works(0.5 * (time + next));
                // Where two switches round to neighbouring numbers there is no middle.
                if next - time > 1e-9 * period {
                    assert_eq!(schedule.works(time), middle, "{period} at {time}");
                    switches += 1;
                }
                worked += if middle { next - time } else { 0.0 };
                time = next;
            }
            // A thousand periods of three stretches, whose lengths sum to the rounding of the last instant.
            assert_eq!(switches, 3 * 1000, "{period}");
            assert!((worked / (700.0 * period) - 1.0).abs() < 1e-9, "{period}: {worked}");
        }
    }

    #[test]
    fn work_without_a_period_happens_once() {
        let late = Schedule { on: vec![(10.0, 20.0), (30.0, f64::INFINITY)], period: None };
        assert!(!late.works(9.9) && late.works(10.0) && !late.works(20.0) && late.works(1e9));
        assert_eq!(late.next_switch(0.0), Some(10.0));
        assert_eq!(late.next_switch(20.0), Some(30.0));
        assert_eq!(late.next_switch(30.0), None);
    }
}
