//! What the comparison answers: which method reaches an error soonest, and how much longer the others take.

use frazil_plots::page::{Block, Table};
use frazil_plots::style::{duration, method_title, number, percent};

use super::chart::is_first;
use super::numbers::reached;
use crate::compare::analysis::{AtError, Comparison, Reached, Study, TARGETS};
use crate::compare::curve::{Curve, Kind};

/// The error that is asked for where nothing speaks for another.
const USUAL: f64 = 0.01;

/// What one method does at the error that the answer is about.
struct Entry<'a> {
    curve: &'a Curve,
    at: &'a AtError,
}

impl Entry<'_> {
    /// Method, and of how many runs the mean is meant.
    fn name(&self) -> String {
        let method = method_title(self.curve.method);
        match self.curve.kind {
            Kind::MeanOf(count) => format!("{method} (mean of {count} runs)"),
            Kind::Plain | Kind::Single => method,
        }
    }

    /// The time (s) by which it is surely there.
    fn time(&self) -> Option<f64> {
        match self.at.time {
            Reached::At(time) | Reached::Within(time) => Some(time),
            Reached::Untold(_) | Reached::LeftOut | Reached::Not => None,
        }
    }
}

/// The error at which most methods can be set beside each other, and what each does there, the quickest first.
fn entries(comparison: &Comparison) -> Option<(f64, Vec<Entry<'_>>)> {
    let at = |target: f64| -> Vec<Entry<'_>> {
        let curves = comparison.curves.iter().enumerate().filter(|(_, curve)| is_first(curve));
        curves.filter_map(|(k, curve)| Some(Entry { curve, at: comparison.at(target, k)? })).collect()
    };
    let told = |target: f64| {
        let all = at(target);
        let interpolated = all.iter().filter(|entry| matches!(entry.at.time, Reached::At(_))).count();
        (all.iter().filter_map(Entry::time).count(), interpolated, target == USUAL)
    };
    let target = TARGETS.into_iter().max_by_key(|target| told(*target)).filter(|target| told(*target).0 > 0)?;
    let mut all = at(target);
    let time = |entry: &Entry<'_>| entry.time().unwrap_or(f64::INFINITY);
    all.sort_by(|a, b| time(a).total_cmp(&time(b)));
    Some((target, all))
}

/// How many times as long as the quickest a method takes, in words; nothing where its own time is but a bound.
fn times(entry: &Entry<'_>, quickest: &Entry<'_>) -> Option<String> {
    let Reached::At(own) = entry.at.time else { return None };
    let ratio = |value: f64| number(value, if value < 10.0 { 2 } else { 3 });
    match quickest.at.time {
        Reached::At(least) => {
            let both = entry.at.interval.zip(quickest.at.interval);
            let interval = both.map_or(String::new(), |(own, least)| {
                format!(" ({} to {})", ratio(own.low / least.high), ratio(own.high / least.low))
            });
            Some(format!("{} ×{interval}", ratio(own / least)))
        }
        Reached::Within(least) => Some(format!("at least {} ×", ratio(own / least))),
        Reached::Untold(_) | Reached::LeftOut | Reached::Not => None,
    }
}

/// The answer of a scene in a sentence.
pub(super) fn sentence(study: &Study) -> Option<String> {
    let comparison = study.comparisons.first()?;
    let (label, title) = (comparison.headline.label().trim_start_matches("rms "), &study.runs.scene.title);
    let Some((target, all)) = entries(comparison) else {
        return Some(format!("{title}: no method is known to reach an {label} of {}.", percent(TARGETS[0], 2)));
    };
    let (quickest, others) = all.split_first()?;
    let interval = quickest
        .at
        .interval
        .map_or(String::new(), |interval| format!(" ({} to {})", duration(interval.low), duration(interval.high)));
    let mut text = format!(
        "{title}: {} reaches an {label} of {} in {}{interval}",
        quickest.name(),
        percent(target, 2),
        reached(quickest.at.time, duration, "at most")
    );
    for entry in others {
        let name = entry.name();
        text += &match entry.at.time {
            Reached::At(_) | Reached::Within(_) => {
                let ratio = times(entry, quickest).map_or(String::new(), |ratio| format!(", {ratio} as long"));
                format!("; {name} in {}{ratio}", reached(entry.at.time, duration, "at most"))
            }
            Reached::Not => format!("; {name} does not reach it"),
            Reached::Untold(_) => format!("; not known for {name}"),
            Reached::LeftOut => format!("; not enough time for {name}"),
        };
    }
    Some(text + ".")
}

/// The same in a table, of all scenes.
pub(super) fn table<'s>(studies: impl Iterator<Item = &'s Study>) -> Block {
    let mut rows = Vec::new();
    for study in studies {
        let Some((target, all)) = study.comparisons.first().and_then(entries) else { continue };
        for (place, entry) in all.iter().enumerate() {
            let interval = entry.at.interval;
            let interval = interval
                .map_or(String::new(), |interval| format!("{} to {}", duration(interval.low), duration(interval.high)));
            let ratio = if place == 0 { Some("1 ×".into()) } else { times(entry, &all[0]) };
            let (name, time) = (study.name().to_owned(), reached(entry.at.time, duration, "at most"));
            rows.push(vec![name, entry.name(), percent(target, 2), time, interval, ratio.unwrap_or_default()]);
        }
    }
    let heads = ["scene", "method", "requested error", "time to reach it", "95 % interval", "ratio to the fastest"];
    let table = Table {
        caption: "Time to reach one error, under the best setting of each method. \"At most\": its coarsest run is \
                  there already, or lies below what the reference resolves."
            .into(),
        heads: heads.map(Into::into).into(),
        rows,
        words: 2,
        csv: Some("equal_error.csv".into()),
    };
    Block { tables: vec![table], ..Block::default() }
}
