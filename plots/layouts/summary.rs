//! Closure of all layouts as bars from the start: the figure to look at first.

use super::view::{DAY, LayoutView, day, wrapped};
use crate::axes::{Axis, Entry, Frame};
use crate::canvas::{Align, Canvas, Colour, Stroke, text_width};
use crate::sheet::{MARGIN, WIDTH, grown};
use crate::style::{BLUE, INK, LABEL, Marker, TICK, number};

/// Height of a row and of its bar (px).
const ROW: f64 = 52.0;
const BAR: f64 = 20.0;

/// Until the first gap closes, until the wall does, and from then on to the end.
const WAITING: Colour = Colour(0xd3, 0xdc, 0xea);
const CLOSING: Colour = Colour(0x7f, 0x9c, 0xc9);
const GROWING: Colour = BLUE;
/// Where the wall has opened again.
const OPEN: Colour = Colour(0xf2, 0xc4, 0x8a);

/// A column of numbers beside the bars.
struct Column {
    heads: [&'static str; 2],
    cells: Vec<String>,
}

/// One bar a layout, from the start: when its first gap closes, when the wall does, and when the wall is as designed.
/// Beside it stand the day, the gap where the wall is weakest, and the load.
pub fn summary(layouts: &[LayoutView<'_>]) -> Canvas {
    let bars = |top: f64| top + 2.6 * LABEL;
    let bottom = |top: f64| bars(top) + ROW * layouts.len().max(1) as f64;
    let foot = 2.2 * TICK + 1.4 * LABEL;
    let (mut canvas, top) = grown("When the layouts close", &entries(layouts), 4.0, |top| bottom(top) + foot);
    let (bars, bottom) = (bars(top), bottom(top));

    let names: Vec<Vec<String>> = layouts.iter().map(|layout| wrapped(&layout.name, LABEL, true, 210.0)).collect();
    let widest = names.iter().flatten().map(|line| text_width(line, LABEL, true)).fold(60.0, f64::max);
    let columns = columns(layouts);
    let mut right = WIDTH - MARGIN;
    for column in columns.iter().rev() {
        let heads = column.heads.iter().map(|head| text_width(head, TICK, true));
        let cells = column.cells.iter().map(|cell| text_width(cell, LABEL, true));
        let width = heads.chain(cells).fold(0.0, f64::max);
        for (k, head) in column.heads.iter().enumerate() {
            canvas.bold((right, top + (0.9 + 1.2 * k as f64) * TICK), *head, TICK, Align::End);
        }
        for (k, cell) in column.cells.iter().enumerate() {
            canvas.bold((right, bars + (k as f64 + 0.5) * ROW + 0.36 * LABEL), cell.as_str(), LABEL, Align::End);
        }
        right -= width + 18.0;
    }

    let end = layouts.iter().map(LayoutView::end_s).fold(0.0, f64::max) / DAY;
    let high = if end > 0.0 { 1.06 * end } else { 1.0 };
    let frame = Frame {
        left: MARGIN + widest + 14.0,
        top: bars,
        right: right - 4.0,
        bottom,
        x: Axis::between("time since the start of freezing (d)", 0.0, high),
        y: Axis::columns("", &[]),
    };
    grid(&mut canvas, &frame);
    for (k, (layout, name)) in layouts.iter().zip(&names).enumerate() {
        let y = bars + (k as f64 + 0.5) * ROW;
        let first = y + 0.36 * LABEL - 0.6 * LABEL * (name.len() - 1) as f64;
        for (line, text) in name.iter().enumerate() {
            canvas.bold((MARGIN, first + 1.2 * LABEL * line as f64), text.as_str(), LABEL, Align::Start);
        }
        bar(&mut canvas, &frame, layout, y);
    }
    canvas
}

fn entries(layouts: &[LayoutView<'_>]) -> Vec<Entry> {
    let band = |text: &str, colour| Entry::line(text, Stroke::whole(colour, 12.0));
    let mark = |text: &str, marker, hollow| Entry::mark(text, marker, INK, hollow);
    let mut entries = vec![band("all gaps open", WAITING), band("gaps closing", CLOSING), band("wall closed", GROWING)];
    if layouts.iter().any(reopens) {
        entries.push(band("wall open again", OPEN));
    }
    entries.extend([mark("first gap closed", Marker::Triangle, false), mark("last gap closed", Marker::Wedge, false)]);
    if layouts.iter().any(|layout| layout.design.is_some()) {
        entries.push(mark("thick and cold as designed", Marker::Diamond, true));
    }
    if layouts.iter().any(|layout| layout.design_left.is_some()) {
        entries.push(Entry::note("+ no more as designed"));
    }
    if layouts.iter().any(|layout| layout.closure_s.is_some() && layout.open() > 0) {
        entries.push(mark("a gap beside the wall still open", Marker::Wedge, true));
    }
    if layouts.iter().filter_map(LayoutView::weakest).any(|gap| gap.others > 0 && !gap.alike) {
        entries.push(Entry::note("(+n) n more gaps like it"));
    }
    if layouts.iter().any(|layout| !layout.closed()) {
        entries.push(Entry::note("→ wall open at the end"));
    }
    entries
}

/// Whether a wall that had closed is open at some time.
fn reopens(layout: &LayoutView<'_>) -> bool {
    layout.standing.iter().any(|period| period.1.is_some())
}

fn columns(layouts: &[LayoutView<'_>]) -> Vec<Column> {
    let closed = |layout: &LayoutView<'_>| match layout.standing.first() {
        None => "never".into(),
        Some((from, None)) => format!("{} d", day(*from)),
        Some((from, Some(to))) => format!("{} – {} d", day(*from), day(*to)),
    };
    let weakest = |layout: &LayoutView<'_>| match layout.weakest() {
        Some(gap) if gap.alike => "all alike".into(),
        Some(gap) => gap.name(),
        None => "–".into(),
    };
    let load = |layout: &LayoutView<'_>| match layout.closure_s {
        Some(time) => layout.load_at(time).map_or_else(|| "–".into(), |load| format!("{} W/m", number(load, 3))),
        None => layout.load.last().map_or_else(|| "–".into(), |(_, load)| format!("({} W/m)", number(*load, 3))),
    };
    let mut columns = vec![
        Column { heads: ["wall", "closed"], cells: layouts.iter().map(closed).collect() },
        Column { heads: ["weakest", "gap"], cells: layouts.iter().map(weakest).collect() },
        Column { heads: ["load then", "(at the end)"], cells: layouts.iter().map(load).collect() },
    ];
    if layouts.iter().any(|layout| layout.design.is_some()) {
        let design = |layout: &LayoutView<'_>| match (layout.design, layout.design_left) {
            (None, _) => "never".into(),
            (Some(from), None) => format!("{} d", day(from)),
            (Some(from), Some(to)) => format!("{} – {} d", day(from), day(to)),
        };
        columns.push(Column { heads: ["as", "designed"], cells: layouts.iter().map(design).collect() });
    }
    if layouts.iter().all(|layout| layout.closure_s.is_some()) {
        columns[2].heads = ["load", "then"];
    }
    columns
}

/// The frame with its days; rows need no lines.
fn grid(canvas: &mut Canvas, frame: &Frame) {
    let unlabelled = Frame { y: Axis::columns("", &[]), ..frame.clone() };
    unlabelled.draw(canvas);
}

fn bar(canvas: &mut Canvas, frame: &Frame, layout: &LayoutView<'_>, y: f64) {
    let place = |time: f64| frame.spot(time / DAY, 0.0).0;
    let end = layout.end_s();
    let first = layout.first_s();
    let (upper, lower) = (y - 0.5 * BAR, y + 0.5 * BAR);
    let mut piece = |from: f64, to: f64, colour| {
        if to > from {
            canvas.rectangle((place(from), upper), (place(to), lower), colour);
        }
    };
    let closed = layout.closure_s.unwrap_or(end);
    let waited = first.unwrap_or(closed).min(closed);
    piece(0.0, waited, WAITING);
    piece(waited, closed, CLOSING);
    if layout.closure_s.is_some() {
        piece(closed, end, OPEN);
    }
    for (from, to) in &layout.standing {
        piece(*from, to.unwrap_or(end), GROWING);
    }
    let rim = Stroke::whole(INK, 1.2);
    let last = place(end);
    let left = place(0.0);
    canvas.outline((left, upper), (last, lower), rim);
    if let Some(time) = first {
        canvas.marker((place(time), lower + 8.5), Marker::Triangle, 5.5, INK, false);
    }
    match layout.last_s() {
        Some(time) => canvas.marker((place(time), upper - 8.5), Marker::Wedge, 5.5, INK, false),
        None if layout.closure_s.is_some() && layout.open() > 0 => {
            canvas.marker((last, upper - 8.5), Marker::Wedge, 5.5, INK, true);
        }
        None => {}
    }
    for time in layout.standing.iter().flat_map(|(from, to)| [Some(*from), *to]).flatten() {
        let x = place(time);
        canvas.line(vec![(x, upper - 2.0), (x, lower + 2.0)], Stroke::whole(INK, 3.6));
    }
    if !layout.closed() {
        let (stroke, tip) = (Stroke::whole(INK, 2.2), place(end) + 16.0);
        canvas.line(vec![(place(end), y), (tip, y)], stroke);
        canvas.line(vec![(tip - 9.0, y - 7.0), (tip, y), (tip - 9.0, y + 7.0)], stroke);
    }
    if let Some(time) = layout.design {
        canvas.marker((place(time), y), Marker::Diamond, 7.0, INK, true);
    }
    if let Some(time) = layout.design_left {
        let (x, white) = (place(time), Stroke::whole(Colour::WHITE, 5.0));
        for stroke in [white, Stroke::whole(INK, 2.4)] {
            canvas.line(vec![(x - 6.0, y), (x + 6.0, y)], stroke);
            canvas.line(vec![(x, y - 6.0), (x, y + 6.0)], stroke);
        }
    }
}
