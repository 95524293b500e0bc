//! The tables of the page, in numbers that people can read.

use frazil_core::statistics;
use frazil_plots::page::{Block, Table};
use frazil_plots::style::{duration, number, percent};
use frazil_record::Value;
use frazil_scene::Units;

use crate::compare::analysis::{self, Comparison, Reached, Study};
use crate::compare::curve::Point;
use crate::compare::measured::{Measured, Timing};
use crate::words::length_words;

/// What a curve reaches, in words: a time, or an error.
pub(super) fn reached(value: Reached, show: fn(f64) -> String, within: &str) -> String {
    match value {
        Reached::At(value) => show(value),
        Reached::Within(value) => format!("{within} {}", show(value)),
        Reached::Untold(value) => format!("perhaps {}", show(value)),
        Reached::LeftOut => "left out".into(),
        Reached::Not => "not reached".into(),
    }
}

/// A block of one table.
fn alone(heading: &str, table: Table) -> Block {
    Block { heading: heading.into(), tables: vec![table], ..Block::default() }
}

pub(super) fn equal_error_table(comparison: &Comparison) -> Table {
    let base = comparison.baseline.map(|base| comparison.curves[base].label());
    let heads = std::iter::once("method".into()).chain(analysis::TARGETS.iter().map(|target| percent(*target, 2)));
    let mut rows = Vec::new();
    for (k, curve) in comparison.curves.iter().enumerate() {
        let mut row = vec![curve.label()];
        for target in analysis::TARGETS {
            let Some(entry) = comparison.at(target, k) else {
                row.push(String::new());
                continue;
            };
            let time = reached(entry.time, duration, "at most");
            let speed_up = entry.speed_up.map(|speed_up| {
                if !speed_up.resolved {
                    return "\nno difference".into();
                }
                let faster = speed_up.ratio > 1.0;
                let times = |ratio: f64| number(if faster { ratio } else { 1.0 / ratio }, 3);
                let word = if faster { "faster" } else { "slower" };
                let interval = speed_up.interval.map_or(String::new(), |interval| {
                    let (low, high) = (times(interval.low), times(interval.high));
                    if faster { format!(" ({low} to {high})") } else { format!(" ({high} to {low})") }
                });
                format!("\n{}× {word}{interval}", times(speed_up.ratio))
            });
            let beyond = match (entry.time, entry.error_at_most) {
                (Reached::Within(_) | Reached::Untold(_), Some(error)) => {
                    format!("\nerror at most {}", percent(error, 2))
                }
                _ => String::new(),
            };
            row.push(format!("{time}{beyond}{}", speed_up.unwrap_or_default()));
        }
        rows.push(row);
    }
    let against = base.map_or(String::new(), |base| {
        format!(
            " Below it: how many times faster or slower than {base}, with the 95 % interval of 2000 draws of the \
             repeated runs (and seeds)."
        )
    });
    let marks = "\"At most\": a run is there already, and its error is known to be no greater than said below it: it is the \
                 coarsest, or lies below what the reference resolves. \"Perhaps\": there as measured, but what is known for \
                 sure is the error below it. \"Left out\": only finer runs, which did not fit into the time, could \
                 show it.";
    Table {
        caption: format!("Time to reach an error, by interpolation between neighbouring points. {marks}{against}"),
        heads: heads.collect(),
        rows,
        words: 1,
        csv: Some("equal_error.csv".into()),
    }
}

pub(super) fn equal_time_table(comparison: &Comparison) -> Table {
    // Times below the quickest run and above the longest say nothing.
    let costs = || comparison.curves.iter().flat_map(|curve| &curve.points).filter_map(Point::cost);
    let (least, most) = (costs().fold(f64::INFINITY, f64::min), costs().fold(0.0, f64::max));
    let times: Vec<f64> = analysis::TIMES.into_iter().filter(|time| (least..=most).contains(time)).collect();
    let rows = comparison.curves.iter().enumerate().map(|(k, curve)| {
        let cell = |time: &f64| {
            let entry = comparison.equal_time.iter().find(|(other, curve, _)| other == time && *curve == k);
            entry.map_or(String::new(), |(.., error)| match error {
                Reached::Not => "no run this fast".into(),
                error => reached(*error, |error| percent(error, 2), "at most"),
            })
        };
        std::iter::once(curve.label()).chain(times.iter().map(cell)).collect()
    });
    Table {
        caption:
            "Error reached in a time. \"At most\": the best run took less, or lies below what the reference resolves."
                .into(),
        rows: rows.collect(),
        heads: std::iter::once("method".into()).chain(times.iter().map(|time| duration(*time))).collect(),
        words: 1,
        csv: Some("equal_time.csv".into()),
    }
}

pub(super) fn order_table(units: Units, comparison: &Comparison) -> Table {
    let mut rows = Vec::new();
    for (curve, order) in comparison.curves.iter().zip(&comparison.orders) {
        let order = order.map_or("none quoted".into(), |order| {
            format!(
                "{} ({} to {})",
                number(order.order, 3),
                number(order.interval.low, 3),
                number(order.interval.high, 3)
            )
        });
        let points = curve.points.iter().map(|point| {
            let mark = if point.ringed { " (○)" } else { "" };
            let error = point.signed.map_or_else(|| point.status.name().to_owned(), |error| percent(error, 2));
            format!("{}: {error}{mark}", length_words(units, point.spacing))
        });
        rows.push(vec![curve.label(), points.collect::<Vec<_>>().join("; "), order]);
    }
    Table {
        caption: "Signed errors and observed order with its 95 % interval. None is quoted where the error changes its \
                  sign, the points do not lie on a line (R² below 0.98), or fewer than three count."
            .into(),
        heads: vec!["method".into(), "error by spacing".into(), "order".into()],
        rows,
        words: 2,
        csv: Some("convergence.csv".into()),
    }
}

pub(super) fn ensembles(study: &Study) -> Option<Block> {
    let headline = study.comparisons.first()?.headline;
    let rows: Vec<Vec<String>> = study
        .runs
        .measured
        .iter()
        .filter_map(|one| {
            let all = one.ensemble.as_ref()?.split(headline)?;
            let bias = all.bias().map_or("not resolved".into(), |bias| percent(bias, 2));
            Some(vec![
                one.label(),
                one.spacing_words(),
                all.count.to_string(),
                percent(all.run_rms, 3),
                percent(all.mean_rms, 3),
                bias,
                percent(all.variance.sqrt(), 3),
            ])
        })
        .collect();
    (!rows.is_empty()).then(|| Block {
        heading: "Ensembles".into(),
        text: vec![
            "Three different errors: that of one run, that of the mean of these runs, and the systematic one that \
             remains for any number of runs."
                .into(),
        ],
        tables: vec![Table {
            caption: headline.label().into(),
            heads: ["method", "spacing", "seeds", "one run", "mean of the runs", "systematic", "scatter"]
                .map(Into::into)
                .into(),
            rows,
            words: 1,
            csv: None,
        }],
        ..Block::default()
    })
}

pub(super) fn run_table(study: &Study) -> Block {
    let headline = study.comparisons.first().map(|comparison| comparison.headline);
    let rows = study.runs.measured.iter().map(|one| {
        let walls: Vec<f64> = one.timings.iter().map(Timing::wall).collect();
        let cpus: Vec<f64> = one.timings.iter().map(Timing::cpu).collect();
        let setups: Vec<f64> = one.timings.iter().map(|timing| timing.setup_wall).collect();
        let median = |values: &[f64]| statistics::median(values).map_or(String::new(), duration);
        let spread =
            statistics::median_interval(&walls).filter(|_| walls.len() > 1).map_or(String::new(), |interval| {
                let kind = if interval.is_confident() { "" } else { " (range)" };
                format!("{} to {}{kind}", duration(interval.interval.low), duration(interval.interval.high))
            });
        let record = one.result.as_ref().map(|result| &result.record);
        let count = |value: Option<u64>| value.map_or(String::new(), |value| number(value as f64, 3));
        let error = headline.zip(one.errors()).and_then(|(headline, errors)| headline.of(errors));
        vec![
            one.label(),
            one.spacing_words(),
            count(record.map(|record| record.particles)),
            count(record.map(|record| record.steps)),
            count(record.map(|record| record.pair_evaluations)),
            error.map_or(String::new(), |error| percent(error, 3)),
            median(&setups),
            median(&walls),
            spread,
            median(&cpus),
            format!("{}{}", one.timings.len(), if one.cold { " (cold)" } else { "" }),
        ]
    });
    let heads = [
        "method",
        "spacing",
        "particles",
        "steps",
        "pairs evaluated",
        "error",
        "setup",
        "setup + solve",
        "interval",
        "CPU time",
        "runs",
    ];
    let table = Table {
        caption: "Medians of the repeated runs.".into(),
        heads: heads.map(Into::into).into(),
        rows: rows.collect(),
        words: 1,
        csv: Some("comparison.csv".into()),
    };
    alone("All runs", table)
}

pub(super) fn gates(study: &Study) -> Block {
    let rows = study.runs.measured.iter().filter_map(|one| {
        let record = &one.result.as_ref()?.record;
        Some(vec![
            one.label(),
            one.spacing_words(),
            number(record.energy_balance_rel, 2),
            record.bounds_violation_rel.map_or("not asked".into(), |violation| {
                if violation == 0.0 { "none".into() } else { percent(violation, 2) }
            }),
            if one.repeatable { "yes".into() } else { "NO".into() },
            record.outcome.name().replace('_', " "),
        ])
    });
    let (title, accounts, missing, values) = match study.runs.scene.of_water {
        true => ("Balance and bounds", "Water", "water not accounted for", "pressure heads, on a logarithmic scale,"),
        false => ("Energy and bounds", "Heat", "heat not accounted for", "temperatures"),
    };
    let heads = ["method", "spacing", missing, "beyond the data's range", "repeats to the bit", "outcome"];
    let table = Table {
        caption: format!(
            "{accounts} balance: (stored − in) over exchanged, the largest over all outputs. Bounds: how far {values} leave \
             the range of the scene's data, over that range."
        ),
        heads: heads.map(Into::into).into(),
        rows: rows.collect(),
        words: 1,
        csv: Some("comparison.csv".into()),
    };
    alone(title, table)
}

/// What was left out for lack of time, apart from what failed.
pub(super) fn failures(study: &Study) -> Vec<Block> {
    let told = |one: &Measured| {
        let reason = one.trouble().or_else(|| one.note.clone())?;
        Some(format!("{} at {}: {reason}", one.label(), one.spacing_words()))
    };
    let of = |lack: bool| -> Vec<String> {
        let all = study.runs.measured.iter().filter(|one| one.status().is_lack_of_time() == lack);
        all.filter_map(told).collect()
    };
    let block = |heading: &str, list: Vec<String>, none: &str| Block {
        heading: heading.into(),
        text: if list.is_empty() { vec![none.into()] } else { Vec::new() },
        list,
        ..Block::default()
    };
    vec![
        block("Left out for lack of time", of(true), "None: every run was made."),
        block("Failed or refused", of(false), "No run failed or was refused."),
    ]
}

pub(super) fn settings(study: &Study) -> Block {
    let mut table = Table {
        caption: "Settings of each method including defaults, at its finest run, and its deviations from the scene."
            .into(),
        heads: vec!["method".into(), "settings".into(), "differences".into()],
        words: 3,
        ..Table::default()
    };
    for same in analysis::group(&study.runs.measured) {
        let Some((one, result)) = same.iter().rev().find_map(|one| Some((one, one.result.as_ref()?))) else {
            continue;
        };
        let show = |value: &Value| match value {
            Value::Flag(flag) => flag.to_string(),
            Value::Number(value) => number(*value, 6),
            Value::Text(text) => text.clone(),
        };
        let all: Vec<String> =
            result.record.settings.iter().map(|(key, value)| format!("{key} = {}", show(value))).collect();
        let all = [all, result.record.reduced_from.iter().map(|words| format!("reduced: {words}")).collect()].concat();
        let differences = if result.record.differences.is_empty() {
            "none declared".into()
        } else {
            result.record.differences.join("; ")
        };
        table.rows.push(vec![one.label(), all.join(", "), differences]);
    }
    alone("Settings", table)
}

pub(super) fn overall(studies: &[Study]) -> Block {
    let mut rows = Vec::new();
    for row in analysis::overall(studies) {
        rows.push(vec![
            row.label,
            percent(row.target, 2),
            row.mean.map_or("—".into(), |mean| format!("{}×", number(mean, 3))),
            row.scenes.to_string(),
            row.wins.to_string(),
            row.not_reached.to_string(),
            row.not_told.to_string(),
        ]);
    }
    let heads = [
        "method",
        "error",
        "faster than the baseline",
        "scenes in the mean",
        "quickest in",
        "not reached in",
        "not told in",
    ];
    let table = Table {
        caption: "Geometric mean of the speed-ups over the scenes where both reach the error.".into(),
        heads: heads.map(Into::into).into(),
        rows,
        words: 1,
        csv: Some("equal_error.csv".into()),
    };
    alone("All scenes", table)
}
