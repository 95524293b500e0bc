//! A drawing as SVG: few elements, tenths of a pixel, no identifiers, so that many fit into one page.

use std::fmt::Write;

use crate::canvas::{Align, Canvas, Colour, Item, Spot};

pub(crate) fn render(canvas: &Canvas) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail; the results below are dropped for that reason.
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" height=\"{h}\" role=\"img\" \
         font-family=\"'Noto Sans', 'Open Sans', 'Liberation Sans', Helvetica, Arial, sans-serif\">\n<title>{title}</title>\n\
         <path fill=\"#fff\" d=\"M0 0H{w}V{h}H0Z\"/>\n",
        w = canvas.width,
        h = canvas.height,
        title = escaped(&canvas.title)
    );
    for item in &canvas.items {
        match item {
            Item::Line { points, stroke } => {
                let _ = write!(
                    out,
                    "<path fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"",
                    hex(stroke.colour),
                    short(stroke.width)
                );
                if !stroke.dash.is_empty() {
                    let dashes: Vec<String> = stroke.dash.iter().map(|length| short(*length)).collect();
                    let _ = write!(out, " stroke-dasharray=\"{}\"", dashes.join(" "));
                }
                let _ = writeln!(out, " d=\"{}\"/>", path(points));
            }
            Item::Area { rings, fill, opacity } => {
                let _ = write!(out, "<path fill=\"{}\" fill-rule=\"evenodd\"", hex(*fill));
                if *opacity < 1.0 {
                    let _ = write!(out, " fill-opacity=\"{}\"", short(*opacity));
                }
                let shape: Vec<String> = rings.iter().map(|ring| format!("{}Z", path(ring))).collect();
                let _ = writeln!(out, " d=\"{}\"/>", shape.concat());
            }
            Item::Text(text) => {
                let (x, y) = text.at;
                let anchor = match text.align {
                    Align::Start => "start",
                    Align::Middle => "middle",
                    Align::End => "end",
                };
                let _ = write!(
                    out,
                    "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\"",
                    short(x),
                    short(y),
                    short(text.size),
                    hex(text.colour)
                );
                if text.align != Align::Start {
                    let _ = write!(out, " text-anchor=\"{anchor}\"");
                }
                if text.bold {
                    out.push_str(" font-weight=\"bold\"");
                }
                if text.upward {
                    let _ = write!(out, " transform=\"rotate(-90 {} {})\"", short(x), short(y));
                }
                let _ = writeln!(out, ">{}</text>", escaped(&text.text));
            }
        }
    }
    out.push_str("</svg>\n");
    out
}

fn path(points: &[Spot]) -> String {
    let mut out = String::new();
    let mut last = None;
    for &(x, y) in points {
        let spot = format!("{} {}", short(x), short(y));
        // Points that fall on the same tenth of a pixel add nothing.
        if last.as_ref() == Some(&spot) {
            continue;
        }
        out.push(if last.is_none() { 'M' } else { 'L' });
        out.push_str(&spot);
        last = Some(spot);
    }
    out
}

fn short(value: f64) -> String {
    let text = format!("{value:.1}");
    match text.strip_suffix(".0") {
        Some("-0") => "0".into(),
        Some(whole) => whole.into(),
        None => text,
    }
}

fn hex(Colour(r, g, b): Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
