//! What is drawn over maps of the plan of a shaft: pipes, the shaft, and the water that crosses it.

use std::f64::consts::TAU;

use crate::axes::Frame;
use crate::canvas::{Align, Canvas, Colour, Spot, Stroke, text_width};
use crate::map::notes_at;
use crate::style::{INK, LABEL, Marker, TICK, number};

/// Least radius at which a pipe is drawn (px).
pub(crate) const LEAST: f64 = 2.2;

/// Length of the arrow along the water (px), and its head.
const ARROW: f64 = 40.0;
const HEAD: f64 = 9.0;

/// Seconds of a day.
const DAY: f64 = 86_400.0;

/// Pipes, shaft and water of a plan.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GroundPlan {
    /// Place and radius of each pipe (m).
    pub pipes: Vec<(f64, f64, f64)>,
    /// The shaft.
    pub shaft: Option<ShaftMark>,
    /// The water that crosses it.
    pub water: Option<WaterMark>,
}

/// The shaft of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShaftMark {
    /// Its radius (m).
    pub radius: f64,
    /// When it is dug (s), if it is during the run.
    pub dug: Option<f64>,
}

/// Groundwater that crosses a plan, as it flows where nothing disturbs it.
#[derive(Debug, Clone, PartialEq)]
pub struct WaterMark {
    /// Its Darcy velocity (m/s) at times (s), increasing: the start, and the instants of maps.
    pub speeds: Vec<(f64, f64)>,
    /// Where it flows to, of length 1.
    pub direction: (f64, f64),
}

impl WaterMark {
    /// Its Darcy velocity in words, at a time (s).
    pub fn words(&self, time: f64) -> String {
        let before = self.speeds.partition_point(|(at, _)| *at <= time).saturating_sub(1);
        let speed = self.speeds.get(before).map_or(0.0, |(_, speed)| *speed);
        format!("{} m/day", number(speed * DAY, 3))
    }
}

impl GroundPlan {
    /// Draws all of it over a map of an instant (s).
    pub(crate) fn draw(&self, canvas: &mut Canvas, frame: &Frame, time: f64) {
        let scale = (frame.right - frame.left) / (frame.x.high - frame.x.low);
        if let Some(shaft) = self.shaft {
            draw_shaft(canvas, frame, scale, shaft, time);
        }
        for (x, y, radius) in &self.pipes {
            // Pipes on the edge of a half or quarter are drawn, however their places are rounded.
            let within = |at: f64, low: f64, high: f64| {
                let room = 1e-9 * (high - low);
                at >= low - room && at <= high + room
            };
            if within(*x, frame.x.low, frame.x.high) && within(*y, frame.y.low, frame.y.high) {
                canvas.marker(frame.spot(*x, *y), Marker::Circle, (scale * radius).max(LEAST), INK, true);
            }
        }
    }

    /// Says under a map which water crosses it.
    pub(crate) fn note(&self, canvas: &mut Canvas, frame: &Frame, time: f64) {
        let Some(water) = &self.water else { return };
        let (middle, y) = (frame.left + 0.5 * ARROW, notes_at(frame) - 0.34 * LABEL);
        arrow_around(canvas, (middle, y), water.direction);
        let words = format!("groundwater, {}", water.words(time));
        canvas.text((frame.left + ARROW + 8.0, y + 0.34 * LABEL), words, LABEL, Align::Start);
    }
}

fn draw_shaft(canvas: &mut Canvas, frame: &Frame, scale: f64, shaft: ShaftMark, time: f64) {
    const PIECES: usize = 120;
    let is_dug = shaft.dug.is_some_and(|dug| time >= dug);
    let point = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / PIECES as f64).sin_cos();
        (shaft.radius * cos, shaft.radius * sin)
    };
    let whole = Stroke::whole(INK, 2.2);
    if is_dug {
        frame.curve(canvas, (0..=PIECES).map(point), whole);
    } else {
        // Dashes of their own, for the map may show a part of the circle.
        for k in (0..PIECES).step_by(3) {
            frame.curve(canvas, [point(k), point(k + 1), point(k + 2)], Stroke::whole(INK, 1.6));
        }
    }
    let text = if is_dug { "shaft, excavated" } else { "shaft" };
    // In the part of the shaft that is drawn.
    let aside = |low: f64, share: f64| if low >= -1e-9 * shaft.radius { share * shaft.radius } else { 0.0 };
    let (x, y) = frame.spot(aside(frame.x.low, 0.48), aside(frame.y.low, 0.4));
    let half = 0.5 * text_width(text, TICK, false) + 4.0;
    if half < 0.5 * scale * shaft.radius {
        canvas.rectangle((x - half, y - 0.95 * TICK), (x + half, y + 0.35 * TICK), Colour::WHITE);
        canvas.text((x, y), text, TICK, Align::Middle);
    }
}

/// An arrow of one length around a point, towards a direction of the plan.
pub(crate) fn arrow_around(canvas: &mut Canvas, (x, y): Spot, direction: (f64, f64)) {
    let arm = (ARROW * direction.0, -ARROW * direction.1);
    arrow(canvas, (x - 0.5 * arm.0, y - 0.5 * arm.1), arm);
}

/// An arrow from a point on, as far as an arm reaches (px).
pub(crate) fn arrow(canvas: &mut Canvas, from: Spot, arm: (f64, f64)) {
    let length = arm.0.hypot(arm.1);
    let head = HEAD.min(0.6 * length);
    let (along, tip) = ((arm.0 / length, arm.1 / length), (from.0 + arm.0, from.1 + arm.1));
    let neck = (tip.0 - head * along.0, tip.1 - head * along.1);
    canvas.line(vec![from, neck], Stroke::whole(INK, 1.4));
    let side = (-0.4 * head * along.1, 0.4 * head * along.0);
    canvas.area(vec![tip, (neck.0 + side.0, neck.1 + side.1), (neck.0 - side.0, neck.1 - side.1), tip], INK);
}
