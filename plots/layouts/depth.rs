//! Layouts over depth: what the strata of a shaft differ in.

use super::curves::entry;
use super::view::{DAY, fitted, look};
use crate::axes::{Axis, Entry, Frame};
use crate::canvas::{Align, Canvas, Stroke, text_width};
use crate::sheet::{MARGIN, WIDTH, grown};
use crate::style::{REFERENCE, TICK};

/// A layout in one stratum.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerView {
    /// Name of the stratum.
    pub name: String,
    /// Where the layer begins (m).
    pub from_m: f64,
    /// Where it ends (m).
    pub to_m: f64,
    /// When the wall stood closed (s); absent if it did not.
    pub closure_s: Option<f64>,
    /// Thickness of the wall at the end (m).
    pub thickness_m: f64,
    /// Greatest load (W per metre of depth).
    pub load_w_per_m: f64,
}

/// A layout over all strata, downwards.
#[derive(Debug, Clone, PartialEq)]
pub struct ShaftView {
    /// Name of the layout.
    pub name: String,
    /// Its strata.
    pub layers: Vec<LayerView>,
}

/// One of the quantities that are drawn over depth.
struct Panel {
    label: &'static str,
    value: fn(&LayerView) -> Option<f64>,
}

const PANELS: [Panel; 3] = [
    Panel { label: "wall closed (d)", value: |layer| layer.closure_s.map(|time| time / DAY) },
    Panel { label: "thickness at the end (m)", value: |layer| Some(layer.thickness_m) },
    Panel { label: "greatest load (W/m)", value: |layer| Some(layer.load_w_per_m) },
];

/// Day of closure, thickness and load of each stratum, downwards: one line a layout. Where the wall stays open, a cross stands
/// on the rim.
pub fn over_depth(shafts: &[ShaftView]) -> Canvas {
    const HEIGHT: f64 = 520.0;
    let mut entries: Vec<Entry> = shafts.iter().enumerate().map(|(k, shaft)| entry(k, &shaft.name)).collect();
    let layers = || shafts.iter().flat_map(|shaft| &shaft.layers);
    if layers().any(|layer| layer.closure_s.is_none()) {
        entries.push(Entry::note("× at the rim: not closed"));
    }
    let heading = "Closure, thickness and load over depth";
    let (mut canvas, top) = grown(heading, &entries, 8.0, |top| top + HEIGHT);
    let bands: &[LayerView] = shafts.first().map_or(&[], |shaft| &shaft.layers);
    let names = bands.iter().map(|layer| text_width(&layer.name, TICK, true)).fold(0.0, f64::max).min(150.0);
    let deepest = layers().map(|layer| layer.to_m).fold(0.0, f64::max).max(1e-9);
    // Depth is written once, beside the first panel.
    let depth = |label: &str| {
        let mut axis = Axis::between(label, 0.0, deepest);
        std::mem::swap(&mut axis.low, &mut axis.high);
        axis
    };
    let left = MARGIN + names + 6.0;
    let width = (WIDTH - left - 10.0) / PANELS.len() as f64;
    for (number, panel) in PANELS.iter().enumerate() {
        let values = layers().filter_map(panel.value).chain([0.0]);
        let x = Axis::linear(panel.label, values);
        let from = left + width * number as f64;
        let y = depth(if number == 0 { "depth (m)" } else { "" });
        let frame = Frame::inside((from, top), (from + width, top + HEIGHT), x, y);
        frame.draw(&mut canvas);
        for layer in bands {
            for edge in [layer.from_m, layer.to_m] {
                frame.level(&mut canvas, edge, Stroke::whole(REFERENCE, 1.2));
            }
            if number == 0 {
                let (_, y) = frame.spot(frame.x.low, 0.5 * (layer.from_m + layer.to_m));
                let name = fitted(&layer.name, TICK, true, names);
                canvas.bold((MARGIN, y + 0.36 * TICK), name, TICK, Align::Start);
            }
        }
        for (k, shaft) in shafts.iter().enumerate() {
            let ends = |layer: &LayerView| {
                let value = (panel.value)(layer).unwrap_or(f64::NAN);
                [(value, layer.from_m), (value, layer.to_m)]
            };
            frame.curve(&mut canvas, shaft.layers.iter().flat_map(ends), look(k).stroke(2.4));
            for layer in &shaft.layers {
                let middle = 0.5 * (layer.from_m + layer.to_m);
                match (panel.value)(layer) {
                    Some(value) => {
                        canvas.marker(frame.spot(value, middle), look(k).marker, 5.5, look(k).colour, false);
                    }
                    None => {
                        let (x, y) = frame.spot(frame.x.high, middle);
                        canvas.cross((x - 10.0 - 14.0 * k as f64, y), 6.0, Stroke::whole(look(k).colour, 2.4));
                    }
                }
            }
        }
    }
    canvas
}
