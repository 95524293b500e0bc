//! All figures of a study.

use super::view::LayoutView;
use super::{axis, gaps_polar, load, maps, mean_temperature, planes, sketches, summary, thickness};
use crate::canvas::Canvas;

/// A figure with its file name (without ending) and caption.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// File name without ending.
    pub stem: String,
    /// One sentence that says what to see.
    pub caption: String,
    /// The figure.
    pub canvas: Canvas,
    /// Whether it shows all layouts, or at least as many as fit.
    pub together: bool,
}

/// Every figure that the layouts have values for, in the order in which they are read.
pub fn drawings(layouts: &[LayoutView<'_>], freezing_c: f64) -> Vec<Drawing> {
    let mut all = Vec::new();
    if layouts.is_empty() {
        return all;
    }
    let mut add = |stem: String, caption: &str, canvas: Canvas, together: bool| {
        all.push(Drawing { stem, caption: caption.into(), canvas, together });
    };
    let caption = "When the first gap of each layout closes, from when to when the wall stands closed, the gap where it is weakest, and \
                   the load when it closes.";
    add("summary".into(), caption, summary(layouts), true);
    for (k, canvas) in sketches(layouts).into_iter().enumerate() {
        let caption = "Pipes, all to one scale: the weakest gap in bold, missing pipes as crosses, the shaft dashed; \
                       pipes too small to be seen are drawn larger.";
        add(if k == 0 { "sketches".into() } else { format!("sketches_{}", k + 1) }, caption, canvas, true);
    }
    let some = |plane: &str| layouts.iter().any(|layout| layout.result.planes.iter().any(|row| row.plane == plane));
    if layouts.iter().any(|layout| layout.closure_s.is_some()) {
        let caption = "Thickness of the wall where it is weakest: frozen length on the least frozen way through it, from the day on which it \
                       closes. The gap that this way crosses at the end stands beside each name.";
        add("thickness".into(), caption, thickness(layouts), true);
    }
    if some("weakest") && layouts.iter().any(|layout| layout.closure_s.is_some()) {
        let caption = "Mean temperature on the least frozen way through the wall, at the gap beside each name.";
        add("mean_temperature".into(), caption, mean_temperature(layouts), true);
    }
    if layouts.iter().any(|layout| !layout.load.is_empty()) {
        let caption =
            "Heat that all pipes together take from a metre of depth; the first hours may lie above the figure.";
        add("load".into(), caption, load(layouts), true);
    }
    // Two charts stand side by side, so that they have the width of all other figures.
    let watched: Vec<&LayoutView<'_>> = layouts.iter().filter(|layout| !layout.result.links.is_empty()).collect();
    for (k, some) in watched.chunks(2).enumerate() {
        let names: Vec<&str> = some.iter().map(|layout| layout.name.as_str()).collect();
        let mut charts: Vec<Canvas> = some.iter().map(|layout| gaps_polar(layout)).collect();
        if let [chart] = &charts[..] {
            charts.push(Canvas::new(chart.width, chart.height, ""));
        }
        let caption =
            format!("{}: the day on which each gap closed, at its place around the ring.", names.join(" and "));
        add(format!("gaps_{}", k + 1), &caption, Canvas::beside(&charts), false);
    }
    if layouts.iter().any(|layout| !layout.result.profiles.is_empty()) {
        let caption = "Temperature from the centre outwards at the last instant, through the first pipe and through the middle of the \
                       weakest gap, which stands beside each name.";
        add("planes".into(), caption, planes(layouts, freezing_c), true);
    }
    if layouts.iter().any(|layout| !layout.axis.is_empty()) {
        let caption = "Temperature on the axis plane, around the ring through the pipes of the first ring, at the last instant: \
                       warmest where the wall is weakest.";
        add("axis".into(), caption, axis(layouts, freezing_c), true);
    }
    for (k, layout) in layouts.iter().enumerate() {
        for (day, canvas) in maps(layout, freezing_c) {
            let caption = format!("{}: temperature after {day} d, the front heavy.", layout.name);
            add(format!("map_{}_{day}d", k + 1), &caption, canvas, false);
        }
    }
    all
}
