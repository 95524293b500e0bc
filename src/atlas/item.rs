//! What the papers show, row by row, and how a row is judged.

use std::path::Path;

use frazil_studies::failure::Failure;
use serde::Deserialize;

use super::read::{NotRead, Number};

/// All rows.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Atlas {
    /// What is run for them.
    pub(super) runs: Vec<Run>,
    /// The papers.
    pub(super) papers: Vec<Paper>,
}

/// A command of the program.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Run {
    /// Name, that of its folder.
    pub(super) name: String,
    /// What is typed after the program's name.
    pub(super) command: String,
    /// Its figures that are shown, by the names of their files.
    #[serde(default)]
    pub(super) figures: Vec<String>,
}

/// A paper.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Paper {
    /// Short name.
    pub(super) key: String,
    /// Authors, year, subject.
    pub(super) title: String,
    /// What it shows.
    pub(super) rows: Vec<Row>,
}

/// Something that a paper shows.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Row {
    /// Section, equation, figure or table.
    pub(super) place: String,
    /// What it shows.
    pub(super) item: String,
    /// The run that has it.
    #[serde(default)]
    pub(super) run: Option<String>,
    /// Where its number is.
    #[serde(default)]
    pub(super) value: Option<Number>,
    /// Its name and unit.
    #[serde(default)]
    pub(super) quantity: String,
    /// Number of the paper.
    #[serde(default)]
    pub(super) printed: Option<f64>,
    /// Number of an independent solution.
    #[serde(default)]
    pub(super) reference: Option<Number>,
    /// How far from the reference, or from what is printed where there is none, it may be, relative.
    #[serde(default)]
    pub(super) within: Option<f64>,
    /// How large it may be at most.
    #[serde(default)]
    pub(super) at_most: Option<f64>,
    /// How small it may be at least.
    #[serde(default)]
    pub(super) at_least: Option<f64>,
    /// Where the bound comes from, why it differs from what is printed, or why there is no number.
    #[serde(default)]
    pub(super) why: String,
}

/// How a row stands.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// Within its bound.
    Agrees,
    /// Beyond it.
    Differs,
    /// Without a number, for the reason that it gives.
    NoNumber,
    /// Its number is not to be had.
    Missing(String),
}

impl Outcome {
    pub(super) fn word(&self) -> &'static str {
        match self {
            Outcome::Agrees => "pass",
            Outcome::Differs => "fail",
            Outcome::NoNumber => "no number",
            Outcome::Missing(_) => "missing",
        }
    }
}

/// A row and what was found of it.
pub(super) struct Judged<'a> {
    pub(super) row: &'a Row,
    pub(super) value: Option<f64>,
    pub(super) reference: Option<f64>,
    pub(super) outcome: Outcome,
}

/// A paper that is not among those of the atlas.
#[derive(Debug, thiserror::Error)]
#[error("no paper {0:?}; there are {1}")]
pub struct UnknownPaper(String, String);

impl Atlas {
    /// The one that comes with the program.
    pub(super) fn read() -> Result<Atlas, Failure> {
        toml::from_str(frazil_cases::atlas::TEXT).map_err(Failure::request)
    }

    /// The papers of these keys; all if none is named.
    pub(super) fn keys_of(&self, named: &[String]) -> Result<Vec<String>, Failure> {
        let known: Vec<&str> = self.papers.iter().map(|paper| paper.key.as_str()).collect();
        if let Some(key) = named.iter().find(|key| !known.contains(&key.as_str())) {
            return Err(Failure::request(UnknownPaper(key.clone(), known.join(", "))));
        }
        let all = || known.iter().map(|key| (*key).to_owned()).collect();
        Ok(if named.is_empty() { all() } else { named.to_vec() })
    }

    /// The runs that rows of some papers need.
    pub(super) fn runs_in_use(&self, of: impl Fn(&Paper) -> bool) -> impl Iterator<Item = &Run> {
        let is_asked = move |run: &&Run| {
            let papers = self.papers.iter().filter(|paper| of(paper));
            papers.flat_map(|paper| &paper.rows).any(|row| row.run.as_ref() == Some(&run.name))
        };
        self.runs.iter().filter(is_asked)
    }

    /// The command of a row.
    pub(super) fn run_of(&self, row: &Row) -> Option<&Run> {
        self.runs.iter().find(|run| Some(&run.name) == row.run.as_ref())
    }
}

impl Row {
    /// Reads its numbers off the folder of its run, and judges them.
    pub(super) fn judge(&self, runs: &Path) -> Judged<'_> {
        let Some((run, value)) = self.run.as_ref().zip(self.value.as_ref()) else {
            return Judged { row: self, value: None, reference: None, outcome: Outcome::NoNumber };
        };
        let folder = runs.join(run);
        let read = || -> Result<(f64, Option<f64>), NotRead> {
            Ok((value.read(&folder)?, self.reference.as_ref().map(|number| number.read(&folder)).transpose()?))
        };
        match read() {
            Ok((value, reference)) => {
                let outcome = if self.holds(value, reference) { Outcome::Agrees } else { Outcome::Differs };
                Judged { row: self, value: Some(value), reference, outcome }
            }
            Err(cause) => {
                Judged { row: self, value: None, reference: None, outcome: Outcome::Missing(cause.to_string()) }
            }
        }
    }

    fn holds(&self, value: f64, reference: Option<f64>) -> bool {
        let near = match (self.within, reference.or(self.printed)) {
            (Some(within), Some(target)) => (value - target).abs() <= within * target.abs(),
            _ => true,
        };
        near && self.at_most.is_none_or(|most| value.abs() <= most) && self.at_least.is_none_or(|least| value >= least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_a_number_with_a_bound_or_a_reason() {
        let atlas = Atlas::read().expect("it is read");
        for run in &atlas.runs {
            let words = run.command.split_whitespace().chain(["--quiet", "--threads", "1", "--out", "out"]);
            crate::cli::understood(std::iter::once("frazil").chain(words)).expect(&run.command);
            assert_eq!(atlas.runs_in_use(|_| true).filter(|other| other.name == run.name).count(), 1, "{}", run.name);
        }
        for row in atlas.papers.iter().flat_map(|paper| &paper.rows) {
            let what = format!("{}: {}", row.place, row.item);
            assert_eq!(row.run.is_some(), row.value.is_some(), "{what}");
            assert!(row.run.is_none() || atlas.run_of(row).is_some(), "{what}");
            let target = row.printed.is_some() || row.reference.is_some();
            let bound = (row.within.is_some() && target) || row.at_most.is_some() || row.at_least.is_some();
            assert_eq!(row.value.is_some(), bound, "{what}");
            assert!(row.value.is_some() || !row.why.is_empty(), "{what}");
        }
    }

    #[test]
    fn rows_are_held_to_their_bounds() {
        let row =
            |bounds: &str| -> Row { toml::from_str(&format!("place = \"1\"\nitem = \"x\"\n{bounds}")).expect("a row") };
        assert!(row("printed = 2.0\nwithin = 0.1").holds(2.1, None));
        assert!(!row("printed = 2.0\nwithin = 0.1").holds(2.1, Some(1.8)));
        assert!(row("at_most = 1e-9").holds(-1e-10, None) && !row("at_most = 1e-9").holds(-1e-8, None));
        assert!(!row("at_least = 3").holds(2.9, None));
    }

    #[test]
    fn papers_have_keys_and_runs_of_their_own() {
        let atlas = Atlas::read().expect("it is read");
        let all = atlas.keys_of(&[]).expect("all");
        assert_eq!(all.len(), 5);
        let unknown = atlas.keys_of(&["nikolaev-1999".into()]).expect_err("there is none").to_string();
        assert!(unknown.contains("nikolaev-1999") && unknown.contains("nikolaev-2021"), "{unknown}");
        let count = |atlas: &Atlas, key: &str| atlas.runs_in_use(|paper| paper.key == key).count();
        let whole = atlas.runs_in_use(|_| true).count();
        assert!(all.iter().all(|key| (1..whole).contains(&count(&atlas, key))));
    }
}
