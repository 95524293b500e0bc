//! What the chart of the page shows: all measures and costs of all scenes.

use frazil_core::statistics;
use frazil_plots::chart::{Chart, ChartCost, ChartCurve, ChartError, ChartPoint, ChartScene, CostAxis, Measure};

use crate::compare::analysis::{Study, group};
use crate::compare::curve::{Clock, Curve, Kind, Point};
use crate::compare::figures::is_second;
use crate::compare::measured::Measured;

/// The chart of these scenes; none where no run has an error.
pub(super) fn chart<'s>(studies: impl Iterator<Item = &'s Study>) -> Option<Chart> {
    let scenes: Vec<ChartScene> = studies.filter(|study| !study.comparisons.is_empty()).map(scene).collect();
    (!scenes.is_empty()).then_some(Chart { scenes })
}

fn scene(study: &Study) -> ChartScene {
    let measures = study.comparisons.iter().map(|comparison| Measure {
        label: comparison.headline.label().into(),
        reference: study.runs.reference_error(comparison.headline).map(|error| error as f32),
    });
    let clocks = if study.clock == Clock::Wall { [Clock::Wall, Clock::Cpu] } else { [Clock::Cpu, Clock::Wall] };
    let clock = |clock: Clock| match clock {
        Clock::Wall => CostAxis { label: "wall time, setup and solve".into(), unit: "s" },
        Clock::Cpu => CostAxis { label: "CPU time, setup and solve".into(), unit: "s" },
    };
    let count = |label: &str, unit| CostAxis { label: label.into(), unit };
    let mut costs: Vec<CostAxis> = clocks.map(clock).into();
    costs.extend([count("particle updates", ""), count("peak memory of the process so far", "B")]);
    let runs = group(&study.runs.measured);
    // A curve, or two of an ensemble, for each group of runs, in the order of the comparisons.
    let by_clock = clocks.map(|clock| {
        let headline = study.comparisons[0].headline;
        let of = |same: &Vec<&Measured>| Curve::of(same, headline, clock, study.runs.reference_error(headline));
        runs.iter().map(of).collect::<Vec<_>>()
    });
    let mut curves = Vec::new();
    for (number, same) in runs.iter().enumerate() {
        for part in 0..by_clock[0][number].len() {
            let timed = [&by_clock[0][number][part], &by_clock[1][number][part]];
            let place = curves.len();
            let points = same.iter().enumerate().map(|(k, one)| ChartPoint {
                errors: study.comparisons.iter().map(|all| error(&all.curves[place].points[k])).collect(),
                ..point(study, one, timed.map(|curve| &curve.points[k]))
            });
            curves.push(ChartCurve::of(timed[0].method, timed[0].label(), is_second(timed[0]), points.collect()));
        }
    }
    ChartScene { title: study.runs.scene.title.clone(), measures: measures.collect(), costs, curves }
}

fn error(point: &Point) -> Option<ChartError> {
    let range = point.error_interval.map(|interval| [interval.low as f32, interval.high as f32]);
    Some(ChartError { value: point.signed? as f32, range, hollow: point.hollow, doubtful: point.ringed })
}

fn point(study: &Study, one: &Measured, timed: [&Point; 2]) -> ChartPoint {
    let record = one.result.as_ref().map(|result| &result.record);
    let time = |point: &Point| {
        let range = statistics::median_interval(&point.costs).filter(|_| point.costs.len() > 1);
        let range = range.map(|found| [found.interval.low as f32, found.interval.high as f32]);
        Some(ChartCost { value: point.cost()? as f32, range, runs: point.costs.len() })
    };
    let count = |value: f64| ChartCost { value: value as f32, range: None, runs: 1 };
    let memory = record.and_then(|record| record.peak_memory_bytes);
    let mut costs: Vec<Option<ChartCost>> = timed.map(time).into();
    costs.extend([timed[0].updates.map(count), memory.map(|bytes| count(bytes as f64))]);
    ChartPoint {
        spacing: one.spacing_words(),
        particles: record.map(|record| record.particles),
        steps: record.map(|record| record.steps),
        command: command(study, one),
        trouble: one.trouble(),
        errors: Vec::new(),
        costs,
    }
}

/// The command that makes a run again.
pub(super) fn command(study: &Study, one: &Measured) -> String {
    let (method, spacing) = (one.method, one.spacing);
    let (key, value) = one.setting.key();
    let setting = if one.setting.is_best() { String::new() } else { format!(" --set method.{method}.{key}={value}") };
    format!("frazil run {} --method {method} --set method.{method}.spacing_m={spacing}{setting}", study.name())
}

/// Whether a curve answers for its method: under its best setting, by all its runs.
pub(super) fn is_first(curve: &Curve) -> bool {
    curve.setting.is_best() && curve.kind != Kind::Single
}
