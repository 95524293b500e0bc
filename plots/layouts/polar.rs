//! Closure of every gap at its place around the ring.

use super::view::{DAY, LayoutView, backed, dashed_circle, day, wrapped};
use crate::axes::{Entry, legend, nice_step};
use crate::canvas::{Align, Canvas, Stroke, text_width};
use crate::style::{GRID, INK, LABEL, Marker, REFERENCE, TICK, number};
use frazil_record::LinkRow;

/// Width of the drawing and its margin (px).
const WIDTH: f64 = 500.0;
const LEFT: f64 = 24.0;

/// The circle of the median.
const MEDIAN: Stroke = Stroke { colour: REFERENCE, width: 2.0, dash: &[8.0, 5.0] };

/// Days of a reference, and half the length of their bars (px).
const BESIDE: Stroke = Stroke { colour: INK, width: 2.0, dash: &[] };
const HALF_BAR: f64 = 7.5;

/// Radius of the chart (px).
const RADIUS: f64 = 180.0;

/// How far below the upper edge its centre is (px).
const MIDDLE: f64 = 88.0 + RADIUS;

/// Marks of gaps within a ring and between rings.
const MARKS: [(Marker, bool); 5] = [
    (Marker::Circle, false),
    (Marker::Square, true),
    (Marker::Triangle, false),
    (Marker::Diamond, true),
    (Marker::Wedge, false),
];

/// The rings that a gap lies between, as marks tell them.
fn rings(link: &LinkRow) -> String {
    let ring = |name: &str| name.split_once('.').map_or(name, |(ring, _)| ring).to_owned();
    let (a, b) = (ring(&link.from), ring(&link.to));
    if a == b { format!("ring {a}") } else { format!("rings {}–{}", a.clone().min(b.clone()), a.max(b)) }
}

/// Gaps of which a reference tells the day.
fn known<'a>(layout: &LayoutView<'a>) -> Vec<(&'a LinkRow, f64)> {
    let links: &'a [LinkRow] = &layout.result.links;
    links.iter().zip(&layout.reference).filter_map(|(link, time)| Some((link, (*time)? / DAY))).collect()
}

/// Day on which each gap of a layout closed, outwards from the centre, at its angle; the median as a circle, days of a
/// reference as bars across. Open gaps stand on a rim of their own.
pub fn gaps_polar(layout: &LayoutView<'_>) -> Canvas {
    let links = &layout.result.links;
    let mut groups: Vec<String> = links.iter().map(rings).collect();
    groups.sort();
    groups.dedup();
    let mut days: Vec<f64> = links.iter().filter_map(|link| Some(link.closure_s? / DAY)).collect();
    days.sort_by(f64::total_cmp);
    let open = days.len() < links.len();
    let known = known(layout);
    let most = days.last().copied().into_iter().chain(known.iter().map(|(_, day)| *day)).fold(0.0, f64::max);
    let step = nice_step(if most > 0.0 { most / 4.0 } else { 0.25 });
    let ticks = (1.02 * most / step).ceil().max(1.0);
    let entries = entries(layout, &groups, &days, &known);
    // A legend takes as much room wherever it is drawn.
    let foot = legend(&mut Canvas::new(WIDTH, 100.0, ""), (LEFT, 0.0), WIDTH - 2.0 * LEFT, &entries);
    let chart = Chart { centre: (0.5 * WIDTH, MIDDLE), radius: if open { 0.86 * RADIUS } else { RADIUS }, step, ticks };
    let below = chart.centre.1 + RADIUS + 76.0;
    let name = format!("Closure of the gaps around the ring: {}", layout.name);
    let mut canvas = Canvas::new(WIDTH, (below + foot + 24.0).ceil(), &name);
    for (k, line) in wrapped(&layout.name, LABEL, true, WIDTH - 2.0 * LEFT).iter().enumerate() {
        canvas.bold((LEFT, 26.0 + 1.25 * LABEL * k as f64), line.as_str(), LABEL, Align::Start);
    }
    chart.draw(&mut canvas, open);
    legend(&mut canvas, (LEFT, below), WIDTH - 2.0 * LEFT, &entries);
    if !days.is_empty() {
        dashed_circle(&mut canvas, chart.centre, chart.far(median_of(&days)), MEDIAN);
    }
    for (link, day) in &known {
        let (x, y) = chart.spot(chart.far(*day), angle(link));
        let (sin, cos) = angle(link).sin_cos();
        let end = |side: f64| (x - side * HALF_BAR * sin, y - side * HALF_BAR * cos);
        canvas.line(vec![end(-1.0), end(1.0)], BESIDE);
    }
    let spot = |link: &LinkRow| chart.spot(link.closure_s.map_or(RADIUS, |time| chart.far(time / DAY)), angle(link));
    if let Some(gap) = layout.weakest().filter(|gap| !gap.alike) {
        let at = spot(gap.link);
        canvas.ring(at, 11.0, Stroke::whole(INK, 1.6));
        let marks: Vec<(f64, f64)> = links.iter().map(spot).collect();
        let (x, y) = free_place(at, angle(gap.link), text_width(&gap.name(), TICK, true), &marks);
        backed(&mut canvas, (x, y + 0.36 * TICK), &gap.name(), TICK);
    }
    // Marks that would touch their neighbours are drawn smaller.
    let room =
        days.first().map_or(RADIUS, |first| chart.far(*first)) * std::f64::consts::TAU / links.len().max(1) as f64;
    let size = if room < 12.0 { 3.0 } else { 4.5 };
    for link in links {
        let group = groups.iter().position(|group| *group == rings(link)).unwrap_or(0);
        let (marker, hollow) = MARKS[group % MARKS.len()];
        match link.closure_s {
            Some(_) => canvas.marker(spot(link), marker, size, INK, hollow),
            None => canvas.cross(spot(link), 6.0, Stroke::whole(INK, 2.4)),
        }
    }
    canvas
}

/// Where the middle of a name of this width stands beside a mark: towards the centre or away from it, as near as no
/// other mark is covered.
fn free_place((x, y): (f64, f64), angle: f64, width: f64, marks: &[(f64, f64)]) -> (f64, f64) {
    let (sin, cos) = angle.sin_cos();
    let (half, tall) = (0.5 * width, 0.5 * TICK);
    let near = 18.0 + half * cos.abs() + tall * sin.abs();
    let place = |away: f64| (x + away * cos, y - away * sin);
    let free = |(px, py): &(f64, f64)| {
        let inside = *px > half + 4.0 && *px < WIDTH - half - 4.0 && (*py - MIDDLE).abs() < RADIUS + 8.0;
        inside && !marks.iter().any(|(mx, my)| (mx - px).abs() < half + 8.0 && (my - py).abs() < tall + 8.0)
    };
    let tried = (0..12).map(|k| near + 12.0 * f64::from(k)).flat_map(|far| [place(-far), place(far)]);
    tried.into_iter().find(free).unwrap_or_else(|| place(-near))
}

/// Angle at which a gap is seen from the centre.
fn angle(link: &LinkRow) -> f64 {
    link.y_m.atan2(link.x_m)
}

/// The round frame.
struct Chart {
    centre: (f64, f64),
    /// Radius of the last day (px).
    radius: f64,
    /// Days between two circles, and how many of them.
    step: f64,
    ticks: f64,
}

impl Chart {
    /// How far from the centre a day is (px).
    fn far(&self, day: f64) -> f64 {
        self.radius * day / (self.step * self.ticks)
    }

    fn spot(&self, far: f64, angle: f64) -> (f64, f64) {
        (self.centre.0 + far * angle.cos(), self.centre.1 - far * angle.sin())
    }

    /// Circles with the days on a ruler below, where no mark can cover them; `open` adds the rim of open gaps.
    fn draw(&self, canvas: &mut Canvas, open: bool) {
        let (cx, cy) = self.centre;
        let (grid, ink) = (Stroke::whole(GRID, 1.2), Stroke::whole(INK, 1.3));
        for k in 0..4 {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(k);
            canvas.line(vec![self.centre, self.spot(self.radius, angle)], grid);
        }
        let ruler = cy + RADIUS + 26.0;
        canvas.line(vec![(cx, ruler), (cx + self.radius, ruler)], ink);
        for k in 0..=self.ticks as usize {
            let far = self.far(k as f64 * self.step);
            if k > 0 {
                canvas.ring(self.centre, far, if k == self.ticks as usize { ink } else { grid });
            }
            canvas.line(vec![(cx + far, ruler - 5.0), (cx + far, ruler + 5.0)], ink);
            canvas.text((cx + far, ruler + 1.5 * TICK), number(k as f64 * self.step, 3), TICK, Align::Middle);
        }
        canvas.text((cx - 12.0, ruler + 0.36 * TICK), "day of closure", LABEL, Align::End);
        if open {
            dashed_circle(canvas, self.centre, RADIUS, Stroke { colour: INK, width: 1.3, dash: &[3.0, 4.0] });
        }
        canvas.text((cx + RADIUS + 16.0, cy + 0.36 * TICK), "x", TICK, Align::Start);
        canvas.text((cx, cy - RADIUS - 14.0), "y", TICK, Align::Middle);
    }
}

/// The middle one of sorted values, or the mean of the middle two.
fn median_of(sorted: &[f64]) -> f64 {
    0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2])
}

fn entries(layout: &LayoutView<'_>, groups: &[String], days: &[f64], known: &[(&LinkRow, f64)]) -> Vec<Entry> {
    let mark = |(k, group): (usize, &String)| {
        let (marker, hollow) = MARKS[k % MARKS.len()];
        Entry::mark(group.as_str(), marker, INK, hollow)
    };
    let mut entries: Vec<Entry> = groups.iter().enumerate().map(mark).collect();
    if !days.is_empty() {
        entries.push(Entry::line(format!("median {} d", day(DAY * median_of(days))), MEDIAN));
    }
    let mut told: Vec<String> = known.iter().map(|(link, _)| rings(link)).collect();
    told.sort();
    told.dedup();
    if !told.is_empty() {
        let of = if told.len() < groups.len() { format!(" of {}", told.join(", ")) } else { String::new() };
        entries.push(Entry::line(format!("reference{of}"), BESIDE));
    }
    let open = layout.open();
    if open > 0 {
        let count = if open == layout.result.links.len() { "all".into() } else { open.to_string() };
        entries.push(Entry::note(format!("× on the dotted rim: {count} open at the end")));
    }
    match layout.weakest() {
        Some(gap) if gap.alike => entries.push(Entry::note("all gaps alike")),
        Some(gap) => match gap.link.closed_s() {
            Some(time) => entries.push(Entry::note(format!("ringed: weakest, {}, {} d", gap.name(), day(time)))),
            None => entries.push(Entry::note(format!("ringed: widest open, {}", gap.name()))),
        },
        None => entries.push(Entry::note("no gaps watched")),
    }
    entries
}
