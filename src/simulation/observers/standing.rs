//! When a closed wall has stood: from when to when, and whether it stands.

use frazil_core::saved::{Pass, Saved};

/// The times between which a closed wall stood (s). Without an end it stands still.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Standing {
    pub(super) periods: Vec<(f64, Option<f64>)>,
    /// When it first closed (s), which may be told by means of gaps: it may have been seen open after.
    pub(super) closure: Option<f64>,
    /// The last time (s) at which not all of its gaps had closed.
    open: f64,
    /// The last two looks: times and thicknesses (m), 0 while it was open.
    looks: Vec<(f64, f64)>,
}

impl Saved for Standing {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.periods, &mut self.closure, &mut self.open, &mut self.looks]);
    }
}

impl Standing {
    /// Whether the wall stands.
    pub(super) fn stands(&self) -> bool {
        self.periods.last().is_some_and(|period| period.1.is_none())
    }

    /// Takes that not all of its gaps have closed at a time (s).
    pub(super) fn is_open(&mut self, time: f64) {
        self.open = time;
    }

    /// Takes how thick the wall is at a time (m), none where it is open. `joined`: when the frozen bodies of its pipes first joined all around, which is
    /// known more closely than by looks.
    pub(super) fn look(&mut self, time: f64, thickness: Option<f64>, joined: f64) {
        let before = self.looks.last().copied();
        if thickness.is_some() && !self.stands() {
            // A look since then that found it open knows better.
            let open = before.is_some_and(|(before, _)| before >= joined);
            let from = if open || !self.periods.is_empty() { time } else { joined };
            self.closure.get_or_insert(from);
            self.periods.push((if self.open < from { from } else { self.open.next_up() }, None));
        } else if thickness.is_none() && self.stands() {
            let end = self.opened(time);
            if let Some(period) = self.periods.last_mut() {
                period.1 = Some(end.max(period.0));
            }
        }
        self.looks = before.into_iter().chain([(time, thickness.unwrap_or(0.0))]).collect();
    }

    /// When a wall opened that stood at the last look and is open now: when it would have lost its thickness as it did before, but not
    /// later than now.
    fn opened(&self, now: f64) -> f64 {
        let [.., (earlier, thicker), (last, thick)] = self.looks[..] else { return now };
        let lost = (thicker - thick) / (last - earlier);
        if lost > 0.0 { (last + thick / lost).min(now) } else { now }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_that_thaws_opens_when_its_thickness_is_gone_and_may_close_again() {
        let mut standing = Standing::default();
        standing.look(10.0, Some(1.0), 8.5);
        assert_eq!(standing.periods, [(8.5, None)]);
        standing.look(20.0, Some(0.5), 8.5);
        // Half a metre in ten seconds: the other half is gone at 30, not at 35.
        standing.look(35.0, None, 8.5);
        assert_eq!(standing.periods, [(8.5, Some(30.0))]);
        assert!(!standing.stands());
        standing.look(40.0, Some(0.2), 8.5);
        assert_eq!(standing.periods, [(8.5, Some(30.0)), (40.0, None)]);
    }

    #[test]
    fn a_wall_stands_only_after_it_was_last_seen_open() {
        for (open, from) in [(8.0, 8.5), (9.0, 9.0_f64.next_up())] {
            let mut standing = Standing::default();
            standing.is_open(open);
            standing.look(10.0, Some(0.3), 8.5);
            assert_eq!((standing.closure, &standing.periods[..]), (Some(8.5), &[(from, None)][..]));
        }
    }

    #[test]
    fn a_look_that_finds_a_way_outweighs_pipes_that_have_joined() {
        let mut standing = Standing::default();
        standing.look(10.0, None, 8.5);
        standing.look(20.0, Some(0.3), 8.5);
        assert_eq!(standing.periods, [(20.0, None)]);
        // It would not have opened before the next look.
        standing.look(30.0, Some(0.4), 8.5);
        standing.look(40.0, None, 8.5);
        assert_eq!(standing.periods, [(20.0, Some(40.0))]);
    }
}
