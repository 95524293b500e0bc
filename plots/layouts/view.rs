//! A layout as its figures see it, and what they draw alike.

use crate::canvas::{Align, Canvas, Colour, Stroke, text_width};
use crate::ground_plan::WaterMark;
use crate::style::{BLACK, BLUE, DASH_DOT, GREEN, LONG, MARKERS, MethodStyle, ORANGE, PURPLE, SHORT, SKY, WHOLE};
use frazil_record::{LinkRow, RunResult};

/// Seconds of a day.
pub(super) const DAY: f64 = 86400.0;

/// Closures that differ by less, relative to the later, are told apart by no engineer.
pub(super) const ALIKE: f64 = 0.005;

/// Times and lengths that differ by less, relative to the greater, differ by rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// A pipe of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PipeView {
    /// Its name as links give it: ring and pipe, as `1.3`.
    pub name: String,
    /// Place of its axis (m).
    pub x_m: f64,
    /// Place of its axis (m).
    pub y_m: f64,
    /// Radius (m).
    pub radius_m: f64,
}

/// A layout and what a run says of it.
#[derive(Debug, Clone)]
pub struct LayoutView<'a> {
    /// Name.
    pub name: String,
    /// Pipes of the whole plan, also where a part of it was run.
    pub pipes: Vec<PipeView>,
    /// Design places of pipes that are missing (m).
    pub missing: Vec<(f64, f64)>,
    /// Radius of the ground that was reckoned (m).
    pub outer_radius_m: f64,
    /// Radius of the shaft to be sunk (m).
    pub shaft_radius_m: Option<f64>,
    /// When it is dug (s), where it is during the run.
    pub dug_s: Option<f64>,
    /// The water that crosses the plan.
    pub water: Option<WaterMark>,
    /// The run.
    pub result: &'a RunResult,
    /// Load of all pipes together over time (s, W per metre of depth).
    pub load: Vec<(f64, f64)>,
    /// Temperature around the ring through the pipes at the last instant: degrees and temperatures; perhaps none.
    pub axis: Vec<(f64, f64)>,
    /// Temperature along the plane through the weakest gap at the last instant: m from the centre and temperatures; perhaps none.
    pub weakest_plane: Vec<(f64, f64)>,
    /// When a closed wall first stood (s); absent if none did.
    pub closure_s: Option<f64>,
    /// From when to when it stood (s); without an end where it stands at the end.
    pub standing: Vec<(f64, Option<f64>)>,
    /// When thickness and mean temperature were as designed (s); absent if never, or if nothing was asked for.
    pub design: Option<f64>,
    /// When they were so no more (s); absent if they stayed so.
    pub design_left: Option<f64>,
    /// When each gap of the run closes in a reference (s), where it tells of that gap; empty without one.
    pub reference: Vec<Option<f64>>,
}

/// The gap where the wall is weakest at the end, or the widest open one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weakest<'a> {
    pub(super) link: &'a LinkRow,
    /// How many others close within [`ALIKE`] of it, or stay open and are as wide.
    pub(super) others: usize,
    /// Whether all others do.
    pub(super) alike: bool,
}

impl Weakest<'_> {
    /// Its name, and how many others are like it.
    pub(super) fn name(&self) -> String {
        let others = if self.others > 0 { format!(" (+{})", self.others) } else { String::new() };
        format!("{}–{}{others}", self.link.from, self.link.to)
    }
}

impl LayoutView<'_> {
    /// When the first gap closed (s).
    pub(super) fn first_s(&self) -> Option<f64> {
        self.result.links.iter().filter_map(LinkRow::closed_s).min_by(f64::total_cmp)
    }

    /// When the last gap closed (s); absent while one is open.
    pub(super) fn last_s(&self) -> Option<f64> {
        let last = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a.max(b));
        self.result.links.iter().map(LinkRow::closed_s).reduce(last).flatten()
    }

    /// How many gaps are open at the end.
    pub(super) fn open(&self) -> usize {
        self.result.links.iter().filter(|link| link.closed_s().is_none()).count()
    }

    /// Whether the wall stands closed at the end.
    pub(super) fn closed(&self) -> bool {
        self.standing.last().is_some_and(|period| period.1.is_none())
    }

    /// The gap where the wall is weakest; while it has never closed, the widest open gap. Absent where no gaps were watched.
    pub(super) fn weakest(&self) -> Option<Weakest<'_>> {
        let links = &self.result.links;
        let [from, to] = self.result.record.wall.as_ref()?.weakest_gap.as_ref()?;
        let link = links.iter().find(|link| link.from == *from && link.to == *to)?;
        let like = |other: &&LinkRow| match (link.closed_s(), other.closed_s()) {
            (Some(own), Some(time)) => (own - time).abs() <= ALIKE * own,
            // Open gaps can be told apart by their widths only.
            (None, None) => link.distance_m - other.distance_m <= ALIKE * link.distance_m,
            _ => false,
        };
        let count = links.iter().filter(like).count();
        Some(Weakest { link, others: count.saturating_sub(1), alike: count == links.len() })
    }

    /// The last instant that is known (s).
    pub(super) fn end_s(&self) -> f64 {
        let times = self.result.planes.iter().map(|row| row.time_s).chain(self.load.iter().map(|(time, _)| *time));
        let closures = self.result.links.iter().filter_map(|link| link.closure_s);
        let known = times.chain(closures).chain(self.closure_s).chain(self.design);
        known.filter(|time| time.is_finite()).fold(0.0, f64::max)
    }

    /// Load at an instant (W per metre of depth), between the nearest two that are known.
    pub(super) fn load_at(&self, time: f64) -> Option<f64> {
        between(&self.load, time)
    }
}

/// The value of a series at a place, linear between the nearest two points; absent outside the series. Of points at the same
/// place the first counts; places that differ by rounding are the same.
pub fn between(series: &[(f64, f64)], at: f64) -> Option<f64> {
    let (first, last) = (series.first()?.0, series.last()?.0);
    let room = ROUNDING * at.abs().max(last.abs());
    if !(at >= first - room && at <= last + room) {
        return None;
    }
    let at = at.clamp(first, last);
    let after = series.partition_point(|(x, _)| *x < at);
    let (x1, y1) = series[after];
    let Some((x0, y0)) = after.checked_sub(1).filter(|_| x1 > at).map(|before| series[before]) else { return Some(y1) };
    Some(y0 + (y1 - y0) * (at - x0) / (x1 - x0))
}

/// The look of the k-th layout. Colours come again after six, dashes and markers after five: no look comes twice in
/// thirty.
pub(super) fn look(k: usize) -> MethodStyle {
    const COLOURS: [Colour; 6] = [BLUE, ORANGE, BLACK, GREEN, PURPLE, SKY];
    const DASHES: [&[f64]; 5] = [WHOLE, LONG, SHORT, DASH_DOT, &[20.0, 4.0, 2.5, 4.0, 2.5, 4.0]];
    MethodStyle {
        colour: COLOURS[k % COLOURS.len()],
        marker: MARKERS[k % MARKERS.len()],
        dash: DASHES[k % DASHES.len()],
    }
}

/// A day, to the tenth, so that days stand below each other.
pub(super) fn day(seconds: f64) -> String {
    format!("{:.1}", seconds / DAY)
}

/// A text that is no wider than this (px): what is too much is taken from its middle, for names of a kind differ at
/// their ends.
pub(super) fn fitted(text: &str, size: f64, bold: bool, width: f64) -> String {
    if text_width(text, size, bold) <= width {
        return text.into();
    }
    let letters: Vec<char> = text.chars().collect();
    (1..letters.len())
        .rev()
        .map(|keep| {
            let (head, tail) = (keep.div_ceil(2), keep / 2);
            letters[..head].iter().chain(&['…']).chain(&letters[letters.len() - tail..]).collect::<String>()
        })
        .find(|short| text_width(short, size, bold) <= width)
        .unwrap_or_else(|| "…".into())
}

/// A text in at most two lines that are no wider than this (px).
pub(super) fn wrapped(text: &str, size: f64, bold: bool, width: f64) -> Vec<String> {
    if text_width(text, size, bold) <= width {
        return vec![text.into()];
    }
    let mut breaks = text.match_indices(' ').map(|(at, _)| at);
    let split = breaks.rfind(|at| text_width(&text[..*at], size, bold) <= width);
    match split {
        Some(at) => vec![text[..at].into(), fitted(text[at..].trim_start(), size, bold, width)],
        None => vec![fitted(text, size, bold, width)],
    }
}

/// A dashed circle.
pub(super) fn dashed_circle(canvas: &mut Canvas, (x, y): (f64, f64), radius: f64, stroke: Stroke) {
    const PIECES: usize = 120;
    let at = |k: usize| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / PIECES as f64).sin_cos();
        (x + radius * cos, y + radius * sin)
    };
    canvas.line((0..=PIECES).map(at).collect(), stroke);
}

/// A label on white ground, so that it can be read over lines.
pub(super) fn backed(canvas: &mut Canvas, (x, y): (f64, f64), text: &str, size: f64) {
    let half = 0.5 * text_width(text, size, true) + 3.0;
    canvas.rectangle((x - half, y - 0.95 * size), (x + half, y + 0.3 * size), Colour::WHITE);
    canvas.bold((x, y), text, size, Align::Middle);
}
