//! Colours, markers, sizes and numbers, the same in every figure.

use std::sync::OnceLock;

use plotters::style::{FontStyle, register_font};

use crate::PlotError;
use crate::canvas::{Colour, Stroke};

/// Text size of titles (px).
pub const TITLE: f64 = 20.0;
/// Text size of axis labels and legends (px).
pub const LABEL: f64 = 17.0;
/// Text size of tick labels (px).
pub const TICK: f64 = 16.0;
/// Colour of text and frames.
pub const INK: Colour = Colour(0x22, 0x22, 0x22);
/// Colour of grid lines.
pub const GRID: Colour = Colour(0xdd, 0xdd, 0xdd);
/// Colour of references.
pub const REFERENCE: Colour = Colour(0x77, 0x77, 0x77);

/// Name under which the built-in font is known. It goes into every SVG too, so it names what a browser may take.
pub(crate) const FONT: &str = "Noto Sans, Open Sans, Liberation Sans, Helvetica, Arial, sans-serif";

/// Makes the built-in font known, once per process: no figure depends on the fonts of the machine.
pub(crate) fn register() -> Result<(), PlotError> {
    static DONE: OnceLock<bool> = OnceLock::new();
    let done = DONE.get_or_init(|| {
        register_font(FONT, FontStyle::Normal, notosans::REGULAR_TTF).is_ok()
            && register_font(FONT, FontStyle::Bold, notosans::BOLD_TTF).is_ok()
    });
    if *done { Ok(()) } else { Err(PlotError::Font) }
}

/// Shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// A disc.
    Circle,
    /// A square.
    Square,
    /// A triangle that stands on its base.
    Triangle,
    /// A square that stands on its corner.
    Diamond,
    /// A triangle that stands on its tip.
    Wedge,
}

/// How a method looks. Lightness, marker and dashes all differ, so that a grey print can be read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MethodStyle {
    /// Colour of lines and markers.
    pub colour: Colour,
    /// Marker.
    pub marker: Marker,
    /// Dashes of lines (px on, px off, ...); empty for a whole line.
    pub dash: &'static [f64],
}

impl MethodStyle {
    /// A line of this style.
    pub fn stroke(&self, width: f64) -> Stroke {
        Stroke { colour: self.colour, width, dash: self.dash }
    }
}

/// Colours that lines and markers take.
pub(crate) const BLUE: Colour = Colour(0x0b, 0x3c, 0x8c);
pub(crate) const ORANGE: Colour = Colour(0xe0, 0x7b, 0x10);
pub(crate) const GREEN: Colour = Colour(0x1f, 0x95, 0x6c);
pub(crate) const BLACK: Colour = Colour(0x11, 0x11, 0x11);
pub(crate) const PURPLE: Colour = Colour(0x8e, 0x2a, 0x8b);
pub(crate) const SKY: Colour = Colour(0x4b, 0xa3, 0xc7);
pub(crate) const OLIVE: Colour = Colour(0x7a, 0x6a, 0x10);

/// All markers, in the order in which they are taken.
pub(crate) const MARKERS: [Marker; 5] =
    [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Wedge];

/// Dashes of lines.
pub(crate) const WHOLE: &[f64] = &[];
pub(crate) const LONG: &[f64] = &[12.0, 5.0];
pub(crate) const SHORT: &[f64] = &[5.0, 4.0];
pub(crate) const DASH_DOT: &[f64] = &[12.0, 4.0, 2.5, 4.0];

/// The style of a method; methods that are not known yet get one from their name.
pub fn method_style(name: &str) -> MethodStyle {
    match name {
        "pd" => MethodStyle { colour: BLUE, marker: Marker::Circle, dash: WHOLE },
        "sph" => MethodStyle { colour: ORANGE, marker: Marker::Square, dash: LONG },
        "edpd" => MethodStyle { colour: GREEN, marker: Marker::Triangle, dash: SHORT },
        "local" => MethodStyle { colour: BLACK, marker: Marker::Diamond, dash: DASH_DOT },
        other => {
            const COLOURS: [Colour; 5] = [PURPLE, Colour(0xb0, 0x30, 0x30), SKY, OLIVE, Colour(0xd4, 0x6a, 0x9e)];
            const OTHERS: [Marker; 5] =
                [Marker::Wedge, Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond];
            const DASHES: [&[f64]; 4] = [WHOLE, SHORT, LONG, DASH_DOT];
            let hash = other
                .bytes()
                .fold(0xcbf2_9ce4_8422_2325u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
            let pick = |shift: u32, count: usize| ((hash >> shift) % count as u64) as usize;
            MethodStyle {
                colour: COLOURS[pick(0, COLOURS.len())],
                marker: OTHERS[pick(16, OTHERS.len())],
                dash: DASHES[pick(32, DASHES.len())],
            }
        }
    }
}

/// The name of a method as people write it.
pub fn method_title(name: &str) -> String {
    match name {
        "pd" => "PD".into(),
        "sph" => "SPH".into(),
        "edpd" => "eDPD".into(),
        other => other.into(),
    }
}

/// A number with this many significant digits, without an exponent wherever that is shorter to read.
pub fn number(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return if value.is_nan() { "not a number".into() } else { "infinite".into() };
    }
    let decade = value.abs().log10().floor() as i32;
    if !(-4..=6).contains(&decade) {
        let mantissa = value / 10f64.powi(decade);
        let places = digits.saturating_sub(1);
        return format!("{} · 10{}", minus(&trimmed(&format!("{mantissa:.places$}"))), superscript(decade));
    }
    let places = (digits as i32 - 1 - decade).max(0) as usize;
    minus(&trimmed(&format!("{value:.places$}")))
}

/// A fraction as per cent.
pub fn percent(value: f64, digits: usize) -> String {
    format!("{} %", number(value * 100.0, digits))
}

/// A length (m) in the unit that suits it.
pub fn length(value: f64) -> String {
    if value < 0.0995 { format!("{} mm", number(value * 1e3, 3)) } else { format!("{} m", number(value, 3)) }
}

/// A time (s) in the unit that suits it.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{} µs", number(s * 1e6, 3)),
        s if s < 1.0 => format!("{} ms", number(s * 1e3, 3)),
        s if s < 600.0 => format!("{} s", number(s, 3)),
        s if s < 36_000.0 => format!("{} min", number(s / 60.0, 3)),
        s => format!("{} h", number(s / 3600.0, 3)),
    }
}

/// Ten to a power, as text with a raised exponent.
pub fn power_of_ten(exponent: i32) -> String {
    match exponent {
        0 => "1".into(),
        1 => "10".into(),
        other => format!("10{}", superscript(other)),
    }
}

fn superscript(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '0' => '⁰',
            digit => char::from_u32('⁰' as u32 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
        })
        .collect()
}

fn trimmed(text: &str) -> String {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text.into() }
}

/// A true minus sign: wide enough to be seen on an axis.
fn minus(text: &str) -> String {
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_people_write_them() {
        assert_eq!(number(1e-5, 2), "1 · 10⁻⁵");
        assert_eq!(number(0.00123456, 3), "0.00123");
        assert_eq!(number(-12.5, 3), "−12.5");
        assert_eq!(number(1234.0, 2), "1234");
        assert_eq!(percent(0.0067, 2), "0.67 %");
        assert_eq!(length(0.0005), "0.5 mm");
        assert_eq!(duration(0.0213), "21.3 ms");
        assert_eq!(power_of_ten(-3), "10⁻³");
    }

    #[test]
    fn known_methods_differ_in_marker_dash_and_lightness() {
        let styles: Vec<_> = ["pd", "sph", "edpd", "local"].map(method_style).to_vec();
        for (i, a) in styles.iter().enumerate() {
            for b in &styles[i + 1..] {
                assert_ne!(a.marker, b.marker);
                assert_ne!(a.dash, b.dash);
                assert!((a.colour.lightness() - b.colour.lightness()).abs() > 0.04, "{a:?} {b:?}");
            }
        }
    }
}
