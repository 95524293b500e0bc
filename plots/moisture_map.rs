//! Maps of unsaturated water and of what it carries, with what stands in the ground.

use frazil_record::Field;

use crate::axes::Frame;
use crate::canvas::{Align, Canvas, Colour, Spot, Stroke, text_width};
use crate::grid::Grid;
use crate::ground_plan::GroundPlan;
use crate::map::{Beside, Look, along, blank, draw_over, extremes, notes_at};
use crate::style::{DASH_DOT, INK, LABEL, SHORT, TICK, WHOLE, number};
use crate::words::Words;

/// What stands in ground of unsaturated water.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outlines {
    /// Rims of parts of other soils, closed (m).
    pub regions: Vec<Vec<(f64, f64)>>,
    /// Cracks.
    pub cracks: Vec<CrackMark>,
}

/// A crack.
#[derive(Debug, Clone, PartialEq)]
pub struct CrackMark {
    /// Where it begins (m).
    pub from: (f64, f64),
    /// Where its tip is (m) at times (s), increasing: the instants of maps. Before the first of them there is none.
    pub tips: Vec<(f64, (f64, f64))>,
}

/// Colours from dry sand to wet, and from water without a solute to water full of it: darker all the way.
const MOIST: [Colour; 5] = [
    Colour(0xf8, 0xef, 0xd9),
    Colour(0xd3, 0xdc, 0xd6),
    Colour(0x86, 0xb4, 0xd4),
    Colour(0x2f, 0x6f, 0xb3),
    Colour(0x0b, 0x2c, 0x66),
];
const LOADED: [Colour; 5] = [
    Colour(0xfd, 0xf8, 0xf3),
    Colour(0xf9, 0xcf, 0xac),
    Colour(0xe5, 0x82, 0x66),
    Colour(0xa3, 0x31, 0x5f),
    Colour(0x45, 0x10, 0x48),
];

/// Bands of one colour.
const BANDS: usize = 25;

/// A line of one value.
struct Level {
    value: f64,
    width: f64,
    dash: &'static [f64],
}

/// How values are shown.
struct Show {
    heading: String,
    kind: &'static str,
    label: &'static str,
    ramp: &'static [Colour],
    /// The value of the last colour.
    most: f64,
    levels: Vec<Level>,
    /// What the line of one half is called below the map.
    half: Option<&'static str>,
}

/// The effective saturation; beside it, where the reference has one, that and the difference.
pub(crate) fn saturation_map(field: &Field, outlines: &Outlines, words: &Words) -> Canvas {
    let Some(beside) = Beside::of(field) else { return plain_map(field, outlines, words) };
    let named = |name: &str| format!("{name}, {}", words.instant(field.time_s));
    let difference = Look {
        heading: named("Difference"),
        kind: "Saturation",
        label: "difference (1)".into(),
        range: Some((-beside.most, beside.most)),
        zero: Some(0.0),
    };
    let without_front = Field { frozen_fraction: Vec::new(), ..beside.difference.clone() };
    Canvas::beside(&[
        plain_map(field, outlines, words),
        draw(&beside.reference, outlines, words, &Show::saturation(named("Reference"))),
        draw_over(&without_front, &GroundPlan::default(), words, &difference),
    ])
}

/// The effective saturation without a reference, as the frames of an animation show it.
pub(crate) fn plain_map(field: &Field, outlines: &Outlines, words: &Words) -> Canvas {
    draw(field, outlines, words, &Show::saturation(format!("{}, {}", words.heading, words.instant(field.time_s))))
}

/// The concentration of the solute; none where water carries none.
pub(crate) fn concentration_map(field: &Field, outlines: &Outlines, words: &Words) -> Option<Canvas> {
    let (_, high) = extremes(&field.concentration);
    if !high.is_finite() {
        return None;
    }
    let show = Show {
        heading: format!("{}, {}", words.heading, words.instant(field.time_s)),
        kind: "Concentration",
        label: "concentration (1)",
        ramp: &LOADED,
        most: high.max(1.0),
        levels: [(0.1, SHORT), (0.5, WHOLE), (0.9, DASH_DOT)]
            .map(|(value, dash)| Level { value, width: 1.8, dash })
            .into(),
        half: None,
    };
    let values = Field { temperature_c: field.concentration.clone(), ..field.clone() };
    Some(draw(&values, outlines, words, &show))
}

impl Show {
    fn saturation(heading: String) -> Show {
        let level = |value: f64| Level { value, width: if value == 0.5 { 3.2 } else { 0.9 }, dash: WHOLE };
        Show {
            heading,
            kind: "Saturation",
            label: "effective saturation (1)",
            ramp: &MOIST,
            most: 1.0,
            levels: [0.1, 0.3, 0.5, 0.7, 0.9].map(level).into(),
            half: Some("half saturated"),
        }
    }

    fn colour(&self, value: f64) -> Colour {
        along(self.ramp, value / self.most)
    }

    /// Lines are light where the ground is dark.
    fn stroke(&self, level: &Level) -> Stroke {
        let dark = self.colour(level.value).lightness() < 0.42;
        Stroke { colour: if dark { Colour::WHITE } else { INK }, width: level.width, dash: level.dash }
    }
}

fn draw(field: &Field, outlines: &Outlines, words: &Words, show: &Show) -> Canvas {
    let field = Field { frozen_fraction: Vec::new(), ..field.clone() };
    let (mut canvas, frame) = blank(&field, words, &show.heading, show.kind);
    let grid = Grid::thinned(&field);
    let edges: Vec<f64> = (0..=BANDS).map(|k| show.most * k as f64 / BANDS as f64).collect();
    let bands: Vec<Colour> = edges.windows(2).map(|band| show.colour(0.5 * (band[0] + band[1]))).collect();
    grid.paint_bands(&mut canvas, &frame, &edges[1..BANDS], &bands);
    for level in &show.levels {
        grid.draw_level(&mut canvas, &frame, &grid.values, level.value, show.stroke(level));
    }
    grid.cover_outside(&mut canvas, &frame);
    outlines.draw(&mut canvas, &frame, field.time_s);
    bar(&mut canvas, &frame, show, &bands);
    if let Some(half) = show.half {
        let (y, swatch) = (notes_at(&frame), 44.0);
        let left = frame.right + 38.0 - swatch - text_width(half, LABEL, false);
        let ends: Vec<Spot> = [left, left + swatch].map(|x| (x, y - 0.34 * LABEL)).into();
        canvas.line(ends, Stroke::whole(INK, 3.2));
        canvas.text((left + swatch + 8.0, y), half, LABEL, Align::Start);
    }
    canvas.outline((frame.left, frame.top), (frame.right, frame.bottom), Stroke::whole(INK, 1.3));
    canvas
}

/// The colours, and the lines on them with their values.
fn bar(canvas: &mut Canvas, frame: &Frame, show: &Show, bands: &[Colour]) {
    let (left, right) = (frame.right + 30.0, frame.right + 56.0);
    let height = |share: f64| frame.bottom - share * (frame.bottom - frame.top);
    for (k, colour) in bands.iter().enumerate() {
        let share = |k: usize| k as f64 / bands.len() as f64;
        canvas.rectangle((left, height(share(k + 1))), (right, height(share(k)) + 0.5), *colour);
    }
    canvas.outline((left, frame.top), (right, frame.bottom), Stroke::whole(INK, 1.3));
    for level in &show.levels {
        let y = height(level.value / show.most);
        canvas.line(vec![(left, y), (right, y)], show.stroke(level));
    }
    for value in show.levels.iter().map(|level| level.value).chain([0.0, show.most]) {
        let y = height(value / show.most) + 0.36 * TICK;
        canvas.text((right + 8.0, y), number(value, 3), TICK, Align::Start);
    }
    canvas.upward((right + 8.0 + 3.4 * TICK, 0.5 * (frame.top + frame.bottom)), show.label);
}

impl Outlines {
    /// Draws what is there at an instant (s), in ink on white, so that it is seen on any colour.
    fn draw(&self, canvas: &mut Canvas, frame: &Frame, time: f64) {
        let mut line = |points: &[(f64, f64)], width: f64| {
            for stroke in [Stroke::whole(Colour::WHITE, width + 2.4), Stroke::whole(INK, width)] {
                frame.curve(canvas, points.iter().copied(), stroke);
            }
        };
        self.regions.iter().for_each(|rim| line(rim, 1.4));
        for crack in &self.cracks {
            if let Some((_, tip)) = crack.tips.iter().rev().find(|(at, _)| *at <= time) {
                line(&[crack.from, *tip], 3.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_darken_all_the_way_so_that_grey_ones_can_be_read() {
        for ramp in [MOIST, LOADED] {
            assert!(ramp.windows(2).all(|pair| pair[0].lightness() > pair[1].lightness() + 0.04), "{ramp:?}");
        }
    }
}
