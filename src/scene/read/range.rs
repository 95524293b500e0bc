//! Ranges of numbers that keys allow, and how messages speak of numbers.

use std::fmt;
use std::ops::Bound;

/// The finite numbers that a key allows. Its display completes "must be ...".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    low: Option<End>,
    high: Option<End>,
    /// Whether its ends are those of one scene's body, so that another scene has others.
    of_body: bool,
}

/// One end of a range.
#[derive(Debug, Clone, Copy, PartialEq)]
struct End {
    value: f64,
    included: bool,
}

impl End {
    /// In the range.
    const fn at(value: f64) -> End {
        End { value, included: true }
    }

    /// Just out of it.
    const fn beyond(value: f64) -> End {
        End { value, included: false }
    }
}

impl Range {
    /// Any finite number.
    pub const ANY: Range = Range::to(None, None);
    /// Greater than zero.
    pub const POSITIVE: Range = Range::above(0.0);
    /// Zero or greater.
    pub const NOT_NEGATIVE: Range = Range::at_least(0.0);
    /// From 0 to 1, both included.
    pub const FRACTION: Range = Range::between(0.0, 1.0);

    const fn to(low: Option<End>, high: Option<End>) -> Range {
        Range { low, high, of_body: false }
    }

    /// Greater than `low`.
    pub const fn above(low: f64) -> Range {
        Range::to(Some(End::beyond(low)), None)
    }

    /// `low` or greater.
    pub const fn at_least(low: f64) -> Range {
        Range::to(Some(End::at(low)), None)
    }

    /// From `low` to `high`, both included.
    pub const fn between(low: f64, high: f64) -> Range {
        Range::to(Some(End::at(low)), Some(End::at(high)))
    }

    /// Greater than `low`, up to and including `high`.
    pub const fn above_to(low: f64, high: f64) -> Range {
        Range::to(Some(End::beyond(low)), Some(End::at(high)))
    }

    /// From `low`, included, up to but not including `high`.
    pub const fn from_to_below(low: f64, high: f64) -> Range {
        Range::to(Some(End::at(low)), Some(End::beyond(high)))
    }

    /// Between `low` and `high`, neither included.
    pub const fn inside(low: f64, high: f64) -> Range {
        Range::to(Some(End::beyond(low)), Some(End::beyond(high)))
    }

    /// From `low` to `high`, both included, where a scene's own body ends.
    pub(super) const fn within_body(low: f64, high: f64) -> Range {
        Range { of_body: true, ..Range::between(low, high) }
    }

    /// Between two ends.
    pub fn of(low: Bound<f64>, high: Bound<f64>) -> Range {
        let end = |bound: Bound<f64>| match bound {
            Bound::Included(value) => Some(End::at(value)),
            Bound::Excluded(value) => Some(End::beyond(value)),
            Bound::Unbounded => None,
        };
        Range::to(end(low), end(high))
    }

    /// The ends that the range has in every scene, and whether they are in it.
    pub(super) fn ends(&self) -> [Option<(f64, bool)>; 2] {
        [self.low, self.high].map(|end| end.filter(|_| !self.of_body).map(|end| (end.value, end.included)))
    }

    /// Whether a number is finite and in the range.
    pub fn contains(&self, number: f64) -> bool {
        number.is_finite()
            && self.low.is_none_or(|end| number > end.value || (end.included && number == end.value))
            && self.high.is_none_or(|end| number < end.value || (end.included && number == end.value))
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let low_word = |end: End| if end.included { "at least" } else { "greater than" };
        match (self.low, self.high) {
            (None, None) => write!(f, "a finite number"),
            (Some(low), None) => write!(f, "{} {}", low_word(low), plain(low.value)),
            (None, Some(high)) if high.included => write!(f, "at most {}", plain(high.value)),
            (None, Some(high)) => write!(f, "less than {}", plain(high.value)),
            (Some(low), Some(high)) if low.included && high.included => {
                write!(f, "between {} and {}", plain(low.value), plain(high.value))
            }
            (Some(low), Some(high)) => {
                let high_word = if high.included { "at most" } else { "less than" };
                write!(f, "{} {} and {high_word} {}", low_word(low), plain(low.value), plain(high.value))
            }
        }
    }
}

/// The warmest temperature that a scene may name: far beyond any ground, and near enough to the others to leave them
/// their digits.
const WARMEST: f64 = 1e6;

/// What a temperature of a scene may be.
pub(super) const fn temperatures(absolute_zero: f64) -> Range {
    Range::above_to(absolute_zero, WARMEST)
}

/// Size of the largest number of a file, and of the inverse of the smallest: products of three of them with squares of
/// lengths neither overflow nor vanish.
const LARGEST: f64 = 1e30;

/// What a number must be whatever its range, if it is not.
pub(super) fn unfit(number: f64) -> Option<&'static str> {
    if !number.is_finite() {
        return Some("a finite number");
    }
    let size = number.abs();
    let fits = size == 0.0 || (1.0 / LARGEST..=LARGEST).contains(&size);
    (!fits).then_some("0 or of a size between 1e-30 and 1e30")
}

/// A number as people write it: at most nine digits, powers of ten only far from one.
pub(super) fn plain(number: f64) -> String {
    if number == 0.0 {
        return "0".into();
    }
    let short = format!("{number:.8e}").parse().unwrap_or(number);
    if (1e-4..1e9).contains(&short.abs()) { format!("{short}") } else { format!("{short:e}") }
}

/// Words in quotes, joined by commas and a last `or`.
pub(super) fn one_of<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    join(words, "or")
}

/// Words in quotes, joined by commas and a last `and`.
pub(super) fn all_of<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    join(words, "and")
}

fn join<'a>(words: impl IntoIterator<Item = &'a str>, last: &str) -> String {
    let quoted: Vec<String> = words.into_iter().map(|word| format!("\"{word}\"")).collect();
    match quoted.split_last() {
        None => "nothing".into(),
        Some((only, [])) => only.clone(),
        Some((end, rest)) => format!("{} {last} {end}", rest.join(", ")),
    }
}
