//! The same layouts under every method that a scene has settings for: how far their answers lie apart.

use std::path::Path;

use frazil_plots::layouts::{Answer, MethodView, MethodsView};
use frazil_studies::failure::Failure;
use serde::Serialize;

use super::answers::Answers;
use super::execute::Work;
use super::rows::write_rows;
use super::study::Study;
use super::variants::Layout;

/// What stands for all methods of a scene in place of the name of one.
pub(super) const ALL: &str = "all";

/// What a method says of a layout.
#[derive(Debug, Clone)]
pub(super) enum Said {
    /// Its answers, and those at twice the spacing.
    Answers(Box<Answers>, Option<Box<Answers>>),
    /// Why it cannot run it.
    Refused(String),
}

/// A layout under all methods.
#[derive(Debug)]
pub(super) struct Beside<'a> {
    pub(super) layout: &'a Layout,
    pub(super) said: Vec<(&'static str, Said)>,
}

/// One row of `methods.csv`.
#[derive(Debug, Serialize)]
struct MethodRow<'a> {
    layout: &'a str,
    method: &'a str,
    outcome: &'a str,
    closure_days: Option<f64>,
    closure_error_days: Option<f64>,
    closure_apart_days: Option<f64>,
    thickness_weakest_m: Option<f64>,
    thickness_error_m: Option<f64>,
    thickness_apart_m: Option<f64>,
    temperature_weakest_c: Option<f64>,
    temperature_weakest_error_k: Option<f64>,
    temperature_weakest_apart_k: Option<f64>,
    load_w_per_m: Option<f64>,
    load_error_w_per_m: Option<f64>,
    load_apart_w_per_m: Option<f64>,
}

/// All layouts that are compared, under the methods of these works.
pub(super) fn beside<'a>(study: &'a Study<'_>, works: &[Work<'_>]) -> Vec<Beside<'a>> {
    let said = |layout: &Layout, work: &Work<'_>| {
        if let Some(reason) = work.refused(layout) {
            return Some((work.method, Said::Refused(reason)));
        }
        let pair = work.kept(layout)?;
        let of = |kept| Box::new(Answers::of(&layout.scene, kept, study.design_of(layout)));
        Some((work.method, Said::Answers(of(&pair.fine), pair.coarse.as_ref().map(of))))
    };
    study
        .compared()
        .map(|layout| Beside { layout, said: works.iter().filter_map(|work| said(layout, work)).collect() })
        .collect()
}

/// Day of closure; thickness and mean temperature where the wall is weakest, and load, at the end.
pub(super) fn numbers(answers: &Answers) -> [Option<f64>; 4] {
    let end = answers.days.last();
    [
        answers.closure,
        end.map(|day| day.thickness_weakest_m),
        end.and_then(|day| day.temperature_weakest_c),
        end.map(|day| day.heat_per_pipe_w_per_m * answers.pipes as f64),
    ]
}

impl Beside<'_> {
    /// The answers of each method that ran, and what the spacing still changes of them.
    pub(super) fn answers(&self) -> Vec<(&'static str, [Option<Answer>; 4])> {
        let answers = |(method, said): &(&'static str, Said)| {
            let Said::Answers(fine, coarse) = said else { return None };
            let (own, far) = (numbers(fine), coarse.as_ref().map_or([None; 4], |coarse| numbers(coarse)));
            let one = |k: usize| own[k].map(|own| (own, far[k].map(|far| (own - far).abs())));
            Some((*method, [one(0), one(1), one(2), one(3)]))
        };
        self.said.iter().filter_map(answers).collect()
    }

    /// The least and greatest answer of all methods to each question; none where fewer than two have one.
    pub(super) fn range(&self) -> [Option<(f64, f64)>; 4] {
        let all = self.answers();
        [0, 1, 2, 3].map(|k| {
            let values: Vec<f64> = all.iter().filter_map(|(_, answers)| Some(answers[k]?.0)).collect();
            let range = (values.iter().copied().reduce(f64::min)?, values.iter().copied().reduce(f64::max)?);
            (values.len() > 1).then_some(range)
        })
    }

    /// How far its day of closure lies apart, in words.
    pub(super) fn words(&self) -> Option<String> {
        let (name, count) = (&self.layout.name, self.answers().len());
        let (first, last) = self.range()[0]?;
        let refused: Vec<&str> = self.refusals().map(|(method, _)| method).collect();
        let without = if refused.is_empty() { String::new() } else { format!(", without {}", refused.join(", ")) };
        Some(format!("{name}, {count} methods: closes on day {first:.2} to {last:.2}{without}"))
    }

    /// What a figure shows of it.
    pub(super) fn view(&self) -> MethodsView {
        let methods = self.answers().into_iter().map(|(method, answers)| MethodView { method: method.into(), answers });
        MethodsView { layout: self.layout.name.clone(), methods: methods.collect() }
    }

    fn rows(&self) -> Vec<MethodRow<'_>> {
        let apart = self.range().map(|range| range.map(|(least, most)| most - least));
        let answers = self.answers();
        let row = |(method, said): &'_ (&'static str, Said)| {
            let own = answers.iter().find(|(other, _)| other == method).map_or([None; 4], |(_, answers)| *answers);
            let (values, errors) = (own.map(|answer| Some(answer?.0)), own.map(|answer| answer?.1));
            MethodRow {
                layout: &self.layout.name,
                method,
                outcome: match said {
                    Said::Answers(fine, _) => fine.outcome.name(),
                    Said::Refused(_) => "refused",
                },
                closure_days: values[0],
                closure_error_days: errors[0],
                closure_apart_days: apart[0],
                thickness_weakest_m: values[1],
                thickness_error_m: errors[1],
                thickness_apart_m: apart[1],
                temperature_weakest_c: values[2],
                temperature_weakest_error_k: errors[2],
                temperature_weakest_apart_k: apart[2],
                load_w_per_m: values[3],
                load_error_w_per_m: errors[3],
                load_apart_w_per_m: apart[3],
            }
        };
        self.said.iter().map(row).collect()
    }

    /// Methods that cannot run it, with their reasons.
    pub(super) fn refusals(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.said.iter().filter_map(|(method, said)| match said {
            Said::Refused(reason) => Some((*method, reason.as_str())),
            Said::Answers(..) => None,
        })
    }
}

/// Writes the table of methods.
pub(super) fn write(folder: &Path, all: &[Beside<'_>]) -> Result<(), Failure> {
    write_rows(folder, "methods.csv", &all.iter().flat_map(Beside::rows).collect::<Vec<_>>())
}
