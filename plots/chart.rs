//! What the chart of a page shows: errors against costs, of all scenes, measures and clocks at once.
//!
//! The page draws it, so it holds numbers and looks, no drawing. Numbers are single precision: they are read off a screen.

use serde::Serialize;

use crate::PlotError;
use crate::style::{MethodStyle, method_style};

/// A chart.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Chart {
    /// Scenes, of which one is seen.
    pub scenes: Vec<ChartScene>,
}

/// A scene of a chart.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ChartScene {
    /// Title.
    pub title: String,
    /// Measures of the error.
    pub measures: Vec<Measure>,
    /// Costs, the one that counts first.
    pub costs: Vec<CostAxis>,
    /// Curves.
    pub curves: Vec<ChartCurve>,
}

/// A measure of the error.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Measure {
    /// Words of its axis.
    pub label: String,
    /// Error of the reference.
    pub reference: Option<f32>,
}

/// A cost.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct CostAxis {
    /// Words of its axis, without the unit.
    pub label: String,
    /// Unit: `s`, `B`, or none of a count.
    pub unit: &'static str,
}

/// One method under one setting, from coarse to fine.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ChartCurve {
    /// Words of the legend.
    pub label: String,
    /// Colour of line and markers, as `#rrggbb`.
    pub colour: String,
    /// Dashes of the line (px).
    pub dash: &'static [f64],
    /// Shape of the markers.
    pub marker: String,
    /// Whether it is thin: the second curve of a method.
    pub second: bool,
    /// Points.
    pub points: Vec<ChartPoint>,
}

impl ChartCurve {
    /// A curve in the look of a method.
    pub fn of(method: &str, label: String, second: bool, points: Vec<ChartPoint>) -> Self {
        let MethodStyle { colour, marker, dash } = method_style(method);
        let colour = format!("#{:02x}{:02x}{:02x}", colour.0, colour.1, colour.2);
        ChartCurve { label, colour, dash, marker: format!("{marker:?}").to_lowercase(), second, points }
    }
}

/// One run, or the runs that were made alike.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ChartPoint {
    /// Spacing in words.
    pub spacing: String,
    /// Number of particles.
    pub particles: Option<u64>,
    /// Number of steps.
    pub steps: Option<u64>,
    /// The command that makes it again.
    pub command: String,
    /// How it ended, where not as it should.
    pub trouble: Option<String>,
    /// Error by measure.
    pub errors: Vec<Option<ChartError>>,
    /// Cost by axis.
    pub costs: Vec<Option<ChartCost>>,
}

/// An error.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct ChartError {
    /// With its sign, relative.
    pub value: f32,
    /// 95 % interval of its size.
    pub range: Option<[f32; 2]>,
    /// Whether it is below ten times the error of the reference: a bound.
    pub hollow: bool,
    /// Whether it is lower than other runs lead to expect: it may be so by chance.
    pub doubtful: bool,
}

/// A cost.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct ChartCost {
    /// Median.
    pub value: f32,
    /// 95 % interval of the median, or the range of few runs.
    pub range: Option<[f32; 2]>,
    /// Runs that were timed.
    pub runs: usize,
}

impl Chart {
    /// As JSON that may stand within an element of a page: no letter of it ends one.
    pub(crate) fn json(&self) -> Result<String, PlotError> {
        Ok(serde_json::to_string(self)?.replace('<', "\\u003c"))
    }
}
