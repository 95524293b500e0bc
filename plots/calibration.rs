//! A calibrated fluid: exponents and Schmidt numbers over temperature, and what fits make of them.

use crate::axes::{Axis, Entry, Frame, align};
use crate::canvas::{Canvas, Colour, Stroke};
use crate::sheet::{WIDTH, sheet};
use crate::style::{BLUE, INK, LONG, Marker, ORANGE, REFERENCE, SHORT};

/// A fit, sampled over temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct FitCurve {
    /// Words of the legend.
    pub label: String,
    /// Temperature, exponent, Schmidt number that it gives; infinite where there is none.
    pub samples: Vec<(f64, f64, f64)>,
    /// Temperature and relative error of the Schmidt number, at the rows.
    pub errors: Vec<(f64, f64)>,
}

/// What the figure shows.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationFigure {
    /// Title.
    pub title: String,
    /// Temperature, exponent that is solved for, Schmidt number that is wanted.
    pub points: Vec<(f64, f64, f64)>,
    /// Fits.
    pub fits: Vec<FitCurve>,
}

const LOOKS: [(Colour, &[f64], Marker); 2] = [(ORANGE, LONG, Marker::Square), (BLUE, SHORT, Marker::Triangle)];

/// Draws exponents above, Schmidt numbers below them, and the errors of the fits at the bottom, where there are fits.
pub fn calibration(figure: &CalibrationFigure) -> Canvas {
    let height = if figure.fits.is_empty() { 760.0 } else { 1000.0 };
    let looks = || figure.fits.iter().zip(LOOKS.iter().cycle());
    let mut entries = vec![Entry::mark("target, solved", Marker::Circle, INK, true)];
    for (fit, (colour, dash, _)) in looks() {
        entries.push(Entry::line(fit.label.as_str(), Stroke { colour: *colour, width: 2.2, dash }));
    }
    let (mut canvas, top) = sheet(height, (&figure.title, &figure.title), &entries, 10.0);
    let label = "temperature over the reference temperature";
    let x = |last: bool| Axis::linear(if last { label } else { "" }, figure.points.iter().map(|point| point.0));
    let samples = || figure.fits.iter().flat_map(|fit| &fit.samples);
    let exponents = figure.points.iter().map(|point| point.1).chain(samples().map(|sample| sample.1));
    // Fits that leave the targets far behind leave the frame, too.
    let numbers = figure.points.iter().map(|point| point.2);
    let mut axes = vec![Axis::linear("exponent s", exponents), Axis::log("Schmidt number", numbers)];
    if !figure.fits.is_empty() {
        let errors = figure.fits.iter().flat_map(|fit| &fit.errors).map(|error| 100.0 * error.1);
        axes.push(Axis::linear("error of Sc (%)", errors.chain([0.0])));
    }
    let gap = 18.0;
    let foot = 60.0;
    let each = (height - top - foot) / axes.len() as f64;
    let count = axes.len();
    let mut frames: Vec<Frame> = axes
        .into_iter()
        .enumerate()
        .map(|(k, y)| {
            let last = k + 1 == count;
            let from = top + each * k as f64;
            let bottom = from + each - gap + if last { foot + gap } else { 0.0 };
            Frame::inside((0.0, from), (WIDTH, bottom), x(last), y)
        })
        .collect();
    align(&mut frames);
    frames.iter().for_each(|frame| frame.draw(&mut canvas));
    for (fit, (colour, dash, marker)) in looks() {
        let stroke = Stroke { colour: *colour, width: 2.2, dash };
        frames[0].curve(&mut canvas, fit.samples.iter().map(|sample| (sample.0, sample.1)), stroke);
        frames[1].curve(&mut canvas, fit.samples.iter().map(|sample| (sample.0, sample.2)), stroke);
        if let Some(frame) = frames.get(2) {
            frame.level(&mut canvas, 0.0, Stroke::whole(REFERENCE, 1.5));
            frame.curve(&mut canvas, fit.errors.iter().map(|error| (error.0, 100.0 * error.1)), stroke);
            for (at, error) in fit.errors.iter().filter(|error| error.1.is_finite()) {
                canvas.marker(frame.spot(*at, 100.0 * error), *marker, 4.0, *colour, false);
            }
        }
    }
    for (temperature, exponent, schmidt) in &figure.points {
        canvas.marker(frames[0].spot(*temperature, *exponent), Marker::Circle, 4.5, INK, true);
        canvas.marker(frames[1].spot(*temperature, *schmidt), Marker::Circle, 4.5, INK, true);
    }
    canvas
}
