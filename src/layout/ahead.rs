//! What a study will try on the way to what it seeks: how many layouts, and how long they take.

use frazil_studies::failure::Failure;

use super::execute::{Pair, Work, seconds_of};
use super::study::Study;
use super::variants::Layout;
use super::{critical, search};

/// Tells what is known of a layout, and runs it if that is what it does; none if there is nothing.
pub(super) type Find<'a> = dyn Fn(&Layout) -> Result<Option<Pair>, Failure> + Sync + 'a;

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
    /// So many layouts, as a rule and at most, like `example`; `at_once` of them do not wait for each other.
    pub(super) fn of((likely, most): (usize, usize), example: &Layout, method: &str, at_once: usize) -> Ahead {
        if most == 0 {
            return Ahead::default();
        }
        let each = seconds_of(&example.scene, method).unwrap_or(0.0);
        let likely_s = each * likely as f64;
        Ahead { likely, most, likely_s, most_s: each * most as f64, wall_s: likely_s / at_once.max(1) as f64 }
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
        let rule = if self.likely < self.most { format!(" (as a rule some {})", self.likely) } else { String::new() };
        format!("at most {}{rule} to be tried on the way to what is sought", self.most)
    }
}

/// All that a study may try where nothing is known yet.
pub(super) fn all(study: &Study<'_>, method: &str, threads: usize) -> Result<Ahead, Failure> {
    beyond(study, method, threads, &|_| Ok(None))
}

/// What it may still try beyond what a folder keeps.
pub(super) fn open(work: &Work<'_>) -> Result<Ahead, Failure> {
    beyond(work.study, work.method, work.threads, &|layout| Ok(work.kept(layout)))
}

fn beyond(study: &Study<'_>, method: &str, threads: usize, known: &Find<'_>) -> Result<Ahead, Failure> {
    let mut ahead = Ahead::default();
    if let Some(wanted) = &study.search {
        ahead = ahead.and(search::ahead(study, wanted, (method, threads), known)?);
    }
    if let Some(wanted) = &study.critical {
        ahead = ahead.and(critical::ahead(study, wanted, (method, threads), known)?);
    }
    Ok(ahead)
}
