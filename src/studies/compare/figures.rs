//! From curves to what figures show.

use frazil_core::statistics;
use frazil_plots::canvas::Canvas;
use frazil_plots::comparison::{WorkCurve, WorkFigure, WorkPoint};
use frazil_plots::convergence::{OrderCurve, convergence};
use frazil_scene::Units;

use super::analysis::{Comparison, Study, group};
use super::curve::{Clock, Curve, Kind, Point};

/// What stands on the upward axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    /// The clock that counts.
    Time(Clock),
    /// Particles updated, which no machine changes.
    Updates,
}

impl Cost {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Cost::Time(Clock::Wall) => "wall time",
            Cost::Time(Clock::Cpu) => "CPU time",
            Cost::Updates => "particle updates",
        }
    }
}

/// The diagram of a scene for one measure and one cost.
pub fn work_figure(study: &Study, comparison: &Comparison, cost: Cost) -> WorkFigure {
    let threads =
        study.runs.measured.iter().find_map(|one| one.result.as_ref()).map_or(1, |result| result.record.threads);
    let threads = if threads == 1 { "one thread".into() } else { format!("{threads} threads") };
    let curves: Vec<Curve> = match cost {
        Cost::Time(clock) if clock != study.clock => group(&study.runs.measured)
            .iter()
            .flat_map(|same| {
                Curve::of(same, comparison.headline, clock, study.runs.reference_error(comparison.headline))
            })
            .collect(),
        Cost::Time(_) => comparison.curves.clone(),
        Cost::Updates => comparison
            .curves
            .iter()
            .cloned()
            .map(|mut curve| {
                for point in &mut curve.points {
                    point.costs = point.updates.into_iter().collect();
                }
                curve.judge(study.runs.reference_error(comparison.headline));
                curve
            })
            .collect(),
    };
    let floor = match &study.runs.reference {
        Some(reference) if reference.kind == "measured" => "standard deviation of the instruments",
        _ => "error of the reference",
    };
    WorkFigure {
        title: format!("{}: {}", study.runs.scene.title, comparison.headline.name()),
        error_label: comparison.headline.label().into(),
        cost_label: match cost {
            Cost::Time(_) => format!("{}, setup and solve, {threads} (s)", cost.name()),
            Cost::Updates => cost.name().into(),
        },
        marked: study.runs.reference_error(comparison.headline).map(|error| (error, floor)),
        curves: curves.iter().map(work_curve).collect(),
    }
}

/// Whether a curve is drawn thin: beside the best setting, or a single run beside the mean of several.
pub(super) fn is_second(curve: &Curve) -> bool {
    !curve.setting.is_best() || curve.kind == Kind::Single
}

fn work_curve(curve: &Curve) -> WorkCurve {
    WorkCurve {
        method: curve.method.into(),
        label: curve.label(),
        second: is_second(curve),
        points: curve.points.iter().map(work_point).collect(),
    }
}

fn work_point(point: &Point) -> WorkPoint {
    let pair = |interval: statistics::Interval| (interval.low, interval.high);
    WorkPoint {
        error: point.error(),
        cost: point.cost(),
        error_range: point.error_interval.map(pair),
        cost_range: statistics::median_interval(&point.costs).map(|interval| pair(interval.interval)),
        hollow: point.hollow,
        ringed: point.ringed,
        on_front: point.on_front,
    }
}

/// Error against spacing.
pub fn order_figure(study: &Study, comparison: &Comparison) -> Canvas {
    let spacings = comparison.curves.iter().flat_map(|curve| &curve.points).map(|point| point.spacing);
    let largest = spacings.fold(0.0, f64::max);
    let (scale, label) = match study.runs.scene.units {
        Units::Si if largest < 0.1 => (1e3, "particle spacing (mm)"),
        Units::Si => (1.0, "particle spacing (m)"),
        Units::Dpd | Units::Dimensionless => (1.0, "particle spacing (dimensionless)"),
    };
    let curves: Vec<OrderCurve> = comparison
        .curves
        .iter()
        .map(|curve| OrderCurve {
            method: curve.method.into(),
            label: curve.label(),
            second: is_second(curve),
            points: curve
                .points
                .iter()
                .filter_map(|point| Some((point.spacing, point.error()?, point.hollow)))
                .collect(),
        })
        .collect();
    let title = format!("{}: convergence, {}", study.runs.scene.title, comparison.headline.name());
    convergence(&title, label, scale, comparison.headline.label(), &curves)
}
