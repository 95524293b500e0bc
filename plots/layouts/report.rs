//! All figures of a study.

use super::{LayoutView, axis, gaps_polar, load, maps, mean_temperature, planes, sketches, summary, thickness};
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
    let caption = "When the first gap of each layout closes and when the wall does, the gap with which it closes, and \
                   the load then.";
    add("summary".into(), caption, summary(layouts), true);
    for (k, canvas) in sketches(layouts).into_iter().enumerate() {
        let caption = "Pipes, all to one scale: the weakest gap in bold, missing pipes as crosses, the shaft dashed; \
                       pipes too small to be seen are drawn larger.";
        add(if k == 0 { "sketches".into() } else { format!("sketches_{}", k + 1) }, caption, canvas, true);
    }
    let some = |plane: &str| layouts.iter().any(|layout| layout.result.planes.iter().any(|row| row.plane == plane));
    if some("interface") {
        let caption = "Thickness of the wall midway between the places of pipes 1.1 and 1.2, where it is thinnest in a \
                       perfect ring.";
        add("thickness".into(), caption, thickness(layouts), true);
    }
    if some("wall") {
        let caption = "Mean temperature of all ground that is frozen.";
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
        let caption = "Temperature from the centre outwards at the last instant, through the place of pipe 1.1 and \
                       midway to 1.2.";
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
