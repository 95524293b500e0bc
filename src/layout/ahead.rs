//! What a study will try on the way to what it seeks: how many layouts, and how long they take.

use frazil_studies::failure::Failure;

use super::execute::{Coarse, Pair, Work, seconds_of};
use super::study::Study;
use super::variants::Layout;
use super::{critical, search};

/// Tells what is known of a layout, and runs it if that is what it does; none if there is nothing.
pub(super) type Find<'a, T = Pair> = dyn Fn(&Layout) -> Result<Option<T>, Failure> + Sync + 'a;

/// What tells what is known of layouts.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    /// Of a layout, as layouts are run.
    pub(super) layout: &'a Find<'a>,
    /// Of the same at twice the spacing alone.
    pub(super) coarse: &'a Find<'a, Coarse>,
}

/// Time of the run at twice the spacing over that of both runs of a layout.
const COARSE: f64 = 1.0 / 9.0;

/// Layouts that are tried beside those that a study names.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Ahead {
    /// How many, as a rule.
    pub(super) likely: usize,
    /// How many at most.
    pub(super) most: usize,
    /// Time of as many as there are as a rule (s), one after another, as far as first steps tell it.
    pub(super) likely_s: f64,
    /// Time of as many as there are at most (s).
    pub(super) most_s: f64,
    /// Time of as many as there are as a rule (s), as many at once as do not wait for another.
    pub(super) wall_s: f64,
}

impl Ahead {
    /// So many layouts, as a rule and at most, like `example`, after `coarse` others at twice the spacing alone; `at_once` of them do not wait
    /// for each other.
    pub(super) fn of(
        (likely, most): (usize, usize),
        coarse: usize,
        example: &Layout,
        (method, at_once): (&str, usize),
    ) -> Ahead {
        if most == 0 {
            return Ahead::default();
        }
        let each = seconds_of(&example.scene, method).unwrap_or(0.0);
        let time = |count: usize| each * (count as f64 + COARSE * coarse as f64);
        let likely_s = time(likely);
        Ahead { likely, most, likely_s, most_s: time(most), wall_s: likely_s / at_once.max(1) as f64 }
    }

    pub(super) fn and(self, other: Ahead) -> Ahead {
        Ahead {
            likely: self.likely + other.likely,
            most: self.most + other.most,
            likely_s: self.likely_s + other.likely_s,
            most_s: self.most_s + other.most_s,
            wall_s: self.wall_s + other.wall_s,
        }
    }

    /// How many, in words.
    pub(super) fn words(&self) -> String {
        let rule = if self.likely < self.most { format!(" (typically about {})", self.likely) } else { String::new() };
        format!("at most {}{rule} search candidates", self.most)
    }
}

/// All that a study may try where nothing is known yet.
pub(super) fn all(study: &Study<'_>, method: &str, threads: usize) -> Result<Ahead, Failure> {
    beyond(study, method, threads, Known { layout: &|_| Ok(None), coarse: &|_| Ok(None) })
}

/// What it may still try beyond what a folder keeps.
pub(super) fn open(work: &Work<'_>) -> Result<Ahead, Failure> {
    let coarse = |layout: &Layout| Ok(work.known_coarse(layout));
    beyond(work.study, work.method, work.threads, Known { layout: &|layout| Ok(work.kept(layout)), coarse: &coarse })
}

fn beyond(study: &Study<'_>, method: &str, threads: usize, known: Known<'_>) -> Result<Ahead, Failure> {
    let mut ahead = Ahead::default();
    if let Some(wanted) = &study.search {
        ahead = ahead.and(search::ahead(study, wanted, (method, threads), known)?);
    }
    if let Some(wanted) = &study.critical {
        ahead = ahead.and(critical::ahead(study, wanted, (method, threads), known.layout)?);
    }
    Ok(ahead)
}
