//! Maps of outcomes over the step and one parameter, and the boundaries of RKL2.

use frazil_record::Outcome;

use crate::axes::{Axis, Entry, Frame, legend};
use crate::canvas::{Align, Canvas, Colour, Spot, Stroke, text_width};
use crate::sheet::{MARGIN, WIDTH, sheet, title};
use crate::style::{INK, LABEL, Marker, method_style, method_title, percent};

/// A cell of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapCell {
    /// Where the cell stands on the upward axis.
    pub ratio: f64,
    /// How the run ended.
    pub class: Outcome,
    /// Number of its steps, where that is shown.
    pub steps: Option<u64>,
}

/// One parameter value: the cells from below, and what is known of their boundaries, in steps over the bound.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MapColumn {
    /// The value, as it stands on the axis.
    pub name: String,
    /// Cells from short steps or small tolerances on.
    pub cells: Vec<MapCell>,
    /// Linear stability limit.
    pub sharp: Option<f64>,
    /// Least step that is not exact.
    pub first_loss: Option<f64>,
    /// Greatest step that is exact.
    pub last_exact: Option<f64>,
    /// Least step that diverges.
    pub divergence: Option<f64>,
}

/// The map of one method.
#[derive(Debug, Clone, PartialEq)]
pub struct MapPanel {
    /// Method.
    pub method: String,
    /// Columns.
    pub columns: Vec<MapColumn>,
}

/// What the upward axis of a map measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Upward {
    /// Steps of heat, over the bound by row sums.
    Step,
    /// Tolerances of implicit steps of water, over the scene's own.
    Tolerance,
}

impl Upward {
    fn label(self) -> &'static str {
        match self {
            Upward::Step => "step over bound",
            Upward::Tolerance => "tolerance over the scene's own",
        }
    }

    fn ticks(self) -> &'static [f64] {
        match self {
            Upward::Step => &[0.25, 0.5, 1.0, 2.0, 4.0],
            Upward::Tolerance => &[0.01, 0.1, 1.0, 10.0, 100.0, 1000.0],
        }
    }

    /// What is exchanged and balanced, and what must stay within its range.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Upward::Step => ("the data's range", "heat"),
            Upward::Tolerance => ("the heads' range, by their logarithm", "water"),
        }
    }
}

/// Maps of several methods along the same axis.
#[derive(Debug, Clone, PartialEq)]
pub struct StabilityFigure {
    /// Title.
    pub title: String,
    /// Name of the parameter.
    pub axis: String,
    /// What is upward.
    pub upward: Upward,
    /// Ends of the upward axis.
    pub range: (f64, f64),
    /// How far temperatures or heads may leave the range of the data, over that range.
    pub range_tolerance: f64,
    /// How far the balance may be open, over the heat or water exchanged.
    pub balance_tolerance: f64,
    /// Panels.
    pub panels: Vec<MapPanel>,
}

/// How a class is filled: colours differ in lightness and hatching too, so that a grey print can be read.
struct Fill {
    word: &'static str,
    colour: Colour,
    hatch: &'static [Hatch],
    ink: Colour,
}

#[derive(Clone, Copy, PartialEq)]
enum Hatch {
    Rising,
    Falling,
    Level,
    Upright,
}

fn fill(class: Outcome) -> Fill {
    use Hatch::{Falling, Level, Rising, Upright};
    let fill = |word, colour, hatch, ink| Fill { word, colour, hatch, ink };
    match class {
        Outcome::Ok => fill("within tolerance", Colour(0xe6, 0xf2, 0xea), &[], INK),
        Outcome::Oscillating => fill("oscillating", Colour(0xf5, 0xc2, 0x6b), &[Rising], Colour(0x8a, 0x5a, 0x10)),
        Outcome::EnergyDrift => fill("energy drift", Colour(0x8f, 0xbb, 0xdd), &[Level], Colour(0x1b, 0x4f, 0x7a)),
        Outcome::PhaseSkipped => fill("phase skipped", Colour(0xb9, 0x8c, 0xc9), &[Upright], Colour(0x50, 0x1f, 0x66)),
        Outcome::Diverged => fill("diverged", Colour(0x7a, 0x1f, 0x1f), &[Rising, Falling], Colour(0xe0, 0xa0, 0xa0)),
        Outcome::TimedOut | Outcome::Interrupted => {
            fill("timed out", Colour::WHITE, &[Level, Upright], Colour(0x99, 0x99, 0x99))
        }
    }
}

/// Distance of hatch lines (px).
const PITCH: f64 = 9.0;

fn paint(canvas: &mut Canvas, (left, top): Spot, (right, bottom): Spot, class: Outcome) {
    let fill = fill(class);
    canvas.rectangle((left, top), (right, bottom), fill.colour);
    let stroke = Stroke::whole(fill.ink, 1.1);
    let (width, height) = (right - left, bottom - top);
    for hatch in fill.hatch {
        // Lines are counted from the corner of the drawing, so that they run on from cell to cell.
        let lines =
            |from: f64, to: f64| ((from / PITCH).ceil() as i64..=(to / PITCH).floor() as i64).map(|k| k as f64 * PITCH);
        match hatch {
            Hatch::Level => lines(top, bottom).for_each(|y| canvas.line(vec![(left, y), (right, y)], stroke)),
            Hatch::Upright => lines(left, right).for_each(|x| canvas.line(vec![(x, top), (x, bottom)], stroke)),
            // x + y is constant on a rising line, x - y on a falling one.
            Hatch::Rising => {
                for sum in lines(left + top, right + bottom) {
                    let (from, to) = ((sum - bottom).max(left), (sum - top).min(right));
                    canvas.line(vec![(from, sum - from), (to, sum - to)], stroke);
                }
            }
            Hatch::Falling => {
                for difference in lines(left - bottom, left - bottom + width + height) {
                    let (from, to) = ((difference + top).max(left), (difference + bottom).min(right));
                    canvas.line(vec![(from, from - difference), (to, to - difference)], stroke);
                }
            }
        }
    }
}

const BOUND: Stroke = Stroke { colour: INK, width: 2.2, dash: &[9.0, 5.0] };
const SHARP: Stroke = Stroke { colour: INK, width: 3.0, dash: &[] };

/// Draws the maps, two to a row.
pub fn stability(figure: &StabilityFigure) -> Canvas {
    const SIZE: (f64, f64) = (540.0, 430.0);
    let across = figure.panels.len().clamp(1, 2);
    let rows = figure.panels.len().div_ceil(across).max(1);
    let width = (SIZE.0 * across as f64).max(820.0) + 10.0;
    // The legend decides where the panels begin; it is laid out on a sheet of its own first.
    let entries = entries(figure);
    let top = 46.0 + legend(&mut Canvas::new(width, 0.0, ""), (MARGIN, 46.0), width - 2.0 * MARGIN, &entries) + 40.0;
    let top = top + swatches(&mut Canvas::new(width, 0.0, ""), figure, top - 34.0, width);
    let mut canvas = Canvas::new(width, top + SIZE.1 * rows as f64, &figure.title);
    title(&mut canvas, &figure.title);
    let below = 46.0 + legend(&mut canvas, (MARGIN, 46.0), width - 2.0 * MARGIN, &entries);
    swatches(&mut canvas, figure, below + 6.0, width);
    for (k, panel) in figure.panels.iter().enumerate() {
        let left = SIZE.0 * (k % across) as f64;
        let upper = top + SIZE.1 * (k / across) as f64;
        draw_panel(&mut canvas, figure, panel, (left, upper), SIZE);
    }
    canvas
}

fn entries(figure: &StabilityFigure) -> Vec<Entry> {
    let columns = || figure.panels.iter().flat_map(|panel| &panel.columns);
    let (data, exchanged) = figure.upward.words();
    let tolerance = format!(
        "within tolerance: {} of {data}, {} of the {exchanged} exchanged",
        percent(figure.range_tolerance, 2),
        percent(figure.balance_tolerance, 2)
    );
    let mut entries = vec![Entry::note(tolerance)];
    entries.extend(match figure.upward {
        Upward::Step => vec![
            Entry::line("bound by row sums (Gershgorin)", BOUND),
            Entry::line("linear stability limit (sharp)", SHARP),
        ],
        Upward::Tolerance => {
            vec![Entry::line("the scene's own tolerance", BOUND), Entry::note("numbers: steps; blank: refused")]
        }
    });
    if columns().any(|column| column.first_loss.is_some()) {
        entries.push(Entry::mark("measured: first step beyond tolerance", Marker::Wedge, INK, true));
    }
    if columns().any(|column| column.last_exact.is_some()) {
        entries.push(Entry::mark("last step within tolerance", Marker::Triangle, INK, false));
    }
    if columns().any(|column| column.divergence.is_some()) {
        entries.push(Entry::mark("first step that diverges", Marker::Diamond, INK, true));
    }
    entries
}

/// Draws what fills mean in rows from `top`, and returns their height beyond the first.
fn swatches(canvas: &mut Canvas, figure: &StabilityFigure, top: f64, width: f64) -> f64 {
    const CLASSES: [Outcome; 6] = [
        Outcome::Ok,
        Outcome::Oscillating,
        Outcome::EnergyDrift,
        Outcome::PhaseSkipped,
        Outcome::Diverged,
        Outcome::TimedOut,
    ];
    const SWATCH: Spot = (40.0, 20.0);
    let seen = |class: &Outcome| {
        let mut cells = figure.panels.iter().flat_map(|panel| &panel.columns).flat_map(|column| &column.cells);
        cells.any(|cell| cell.class == *class)
    };
    let (mut x, mut y) = (MARGIN, top);
    for class in CLASSES.into_iter().filter(seen) {
        let word = fill(class).word;
        let needed = SWATCH.0 + 8.0 + text_width(word, LABEL, false);
        if x > MARGIN && x + needed > width - MARGIN {
            (x, y) = (MARGIN, y + 1.7 * LABEL);
        }
        paint(canvas, (x, y), (x + SWATCH.0, y + SWATCH.1), class);
        canvas.outline((x, y), (x + SWATCH.0, y + SWATCH.1), Stroke::whole(INK, 1.0));
        canvas.text((x + SWATCH.0 + 8.0, y + 0.5 * SWATCH.1 + 0.35 * LABEL), word, LABEL, Align::Start);
        x += needed + 26.0;
    }
    y - top
}

fn draw_panel(
    canvas: &mut Canvas,
    figure: &StabilityFigure,
    panel: &MapPanel,
    (left, top): Spot,
    (width, height): Spot,
) {
    let names: Vec<String> = panel.columns.iter().map(|column| column.name.clone()).collect();
    let x = Axis::columns(figure.axis.as_str(), &names);
    let y = Axis::log_between(figure.upward.label(), figure.range, figure.upward.ticks());
    let frame = Frame::inside((left, top + 30.0), (left + width, top + height - 14.0), x, y);
    canvas.bold((frame.left, top + 20.0), method_title(&panel.method), LABEL, Align::Start);
    frame.draw(canvas);
    for (k, column) in panel.columns.iter().enumerate() {
        let (from, to) = (k as f64, k as f64 + 1.0);
        for (place, cell) in column.cells.iter().enumerate() {
            // A cell reaches half-way to its neighbours.
            let half_way = |other: Option<&MapCell>, end: f64| {
                other.map_or(end, |other| (other.ratio * cell.ratio).sqrt()).clamp(figure.range.0, figure.range.1)
            };
            let before = place.checked_sub(1).and_then(|before| column.cells.get(before));
            let low = half_way(before, figure.range.0);
            let high = half_way(column.cells.get(place + 1), figure.range.1);
            paint(canvas, frame.spot(from, high), frame.spot(to, low), cell.class);
            if let Some(steps) = cell.steps {
                let (x, y) = frame.spot(0.5 * (from + to), cell.ratio);
                // Above the line of the scene's own tolerance.
                canvas.text((x, y - 0.35 * LABEL), steps.to_string(), LABEL, Align::Middle);
            }
        }
        if k > 0 {
            let ends = [figure.range.0, figure.range.1].map(|ratio| frame.spot(from, ratio));
            canvas.line(ends.into(), Stroke::whole(INK, 0.6));
        }
    }
    frame.level(canvas, 1.0, BOUND);
    for (k, column) in panel.columns.iter().enumerate() {
        let (from, to) = (k as f64, k as f64 + 1.0);
        if let Some(sharp) = column.sharp {
            frame.curve(canvas, [(from, sharp), (to, sharp)], SHARP);
        }
        // Side by side, for two of them are often one.
        let marks = [
            (column.first_loss, 0.3, Marker::Wedge, true),
            (column.last_exact, 0.7, Marker::Triangle, false),
            (column.divergence, 0.5, Marker::Diamond, true),
        ];
        for (step, place, marker, hollow) in marks {
            let inside = |step: &f64| *step >= figure.range.0 && *step <= figure.range.1;
            if let Some(step) = step.filter(inside) {
                canvas.marker(frame.spot(from + place, step), marker, 5.5, INK, hollow);
            }
        }
    }
    canvas.outline((frame.left, frame.top), (frame.right, frame.bottom), Stroke::whole(INK, 1.3));
}

/// Boundaries of RKL2 for a number of stages, over the stated step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StagesPoint {
    /// Stages.
    pub stages: f64,
    /// Greatest step that is exact.
    pub last_exact: Option<f64>,
    /// Least step that diverges.
    pub divergence: Option<f64>,
    /// Limit of linear stability.
    pub limit: f64,
}

/// Measured boundaries of RKL2 for one method.
#[derive(Debug, Clone, PartialEq)]
pub struct StagesCurve {
    /// Method.
    pub method: String,
    /// Boundaries by the number of stages.
    pub points: Vec<StagesPoint>,
}

/// Draws boundaries of RKL2 over the number of stages.
pub fn super_steps(heading: &str, curves: &[StagesCurve]) -> Canvas {
    let mut entries: Vec<Entry> = Vec::new();
    for curve in curves {
        let style = method_style(&curve.method);
        let text = |text: &str| format!("{}: {text}", method_title(&curve.method));
        entries.push(Entry::mark(text("last step within tolerance"), style.marker, style.colour, false));
        entries.push(Entry::mark(text("first that diverges"), style.marker, style.colour, true));
        entries.push(Entry::line(text("limit of linear stability"), style.stroke(1.6)));
    }
    entries.push(Entry::line("stated step", BOUND));
    let (mut canvas, top) = sheet(620.0, (heading, heading), &entries, 8.0);
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let x = Axis::between("stages", 2.0, points().map(|point| point.stages).fold(3.0, f64::max) + 1.0);
    let values = points().flat_map(|point| [point.last_exact, point.divergence, Some(point.limit)]).flatten();
    let y = Axis::between("step over stated step", 0.9, 0.1 + values.fold(1.0, f64::max));
    let frame = Frame::inside((0.0, top), (WIDTH, 612.0), x, y);
    frame.draw(&mut canvas);
    frame.level(&mut canvas, 1.0, BOUND);
    for curve in curves {
        let style = method_style(&curve.method);
        frame.curve(&mut canvas, curve.points.iter().map(|point| (point.stages, point.limit)), style.stroke(1.6));
        for point in &curve.points {
            for (step, hollow) in [(point.divergence, true), (point.last_exact, false)] {
                if let Some(step) = step {
                    canvas.marker(frame.spot(point.stages, step), style.marker, 4.5, style.colour, hollow);
                }
            }
        }
    }
    canvas
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Item;

    const CLASSES: [Outcome; 6] = [
        Outcome::Ok,
        Outcome::Oscillating,
        Outcome::EnergyDrift,
        Outcome::PhaseSkipped,
        Outcome::Diverged,
        Outcome::TimedOut,
    ];

    #[test]
    fn classes_differ_in_hatch_or_by_far_in_lightness() {
        for (k, a) in CLASSES.into_iter().map(fill).enumerate() {
            for b in CLASSES.into_iter().map(fill).skip(k + 1) {
                let apart = (a.colour.lightness() - b.colour.lightness()).abs() > 0.25;
                assert!(apart || a.hatch != b.hatch, "{} {}", a.word, b.word);
                assert_ne!(a.word, b.word);
            }
        }
    }

    #[test]
    fn hatches_stay_inside_their_cell() {
        for class in CLASSES {
            let mut canvas = Canvas::new(200.0, 200.0, "t");
            paint(&mut canvas, (13.0, 20.0), (71.0, 95.0), class);
            let mut lines = 0;
            for item in &canvas.items {
                if let Item::Line { points, .. } = item {
                    lines += 1;
                    for (x, y) in points {
                        assert!((13.0..=71.0).contains(x) && (20.0..=95.0).contains(y), "{class:?} {points:?}");
                    }
                }
            }
            assert_eq!(lines > 0, !fill(class).hatch.is_empty());
        }
    }

    #[test]
    fn cells_of_a_column_cover_the_range_without_gaps() {
        let cells: Vec<MapCell> = [0.25, 1.0, 4.0]
            .into_iter()
            .map(|ratio| MapCell { ratio, class: Outcome::TimedOut, steps: None })
            .collect();
        let column = MapColumn { name: "1".into(), cells, ..MapColumn::default() };
        let panel = MapPanel { method: "pd".into(), columns: vec![column] };
        let (title, axis, range) = ("t".into(), "a".into(), (0.25, 4.0));
        let (upward, panels) = (Upward::Step, vec![panel]);
        let figure =
            StabilityFigure { title, axis, upward, range, range_tolerance: 0.01, balance_tolerance: 1e-3, panels };
        let canvas = stability(&figure);
        // The swatch of the legend comes first.
        let areas: Vec<_> = canvas
            .items
            .iter()
            .filter_map(|item| match item {
                Item::Area { ring, .. } => Some((ring[0].1, ring[2].1)),
                _ => None,
            })
            .skip(1)
            .collect();
        assert_eq!(areas.len(), 3);
        assert!((areas[0].0 - areas[1].1).abs() < 1e-9 && (areas[1].0 - areas[2].1).abs() < 1e-9, "{areas:?}");
    }
}
