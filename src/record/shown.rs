//! Text of a user as terminals and messages show it: files, names of files and options may hold anything.

use std::borrow::Cow;

/// Letters up to which a text is quoted in messages.
const LONGEST: usize = 200;

/// Whether a character is not seen, or turns what is beside it: control characters, marks of direction, separators of lines, and
/// others without a shape.
pub fn is_hidden(character: char) -> bool {
    match character {
        // Fillers count as letters, and have no shape.
        '\u{115f}' | '\u{1160}' | '\u{3164}' | '\u{ffa0}' => true,
        _ if character.is_ascii() => character.is_ascii_control(),
        _ if character.is_alphanumeric() => false,
        // What the standard library would escape behind a letter, so that accents stay.
        _ => {
            let mut behind = String::from('a');
            behind.push(character);
            behind.escape_debug().any(|shown| shown == '\\')
        }
    }
}

/// A text as one line shows it: what is hidden, line breaks too, stands there as an escape.
pub fn shown(text: &str) -> Cow<'_, str> {
    escaped(text, is_hidden)
}

/// The same of a text that may have lines.
pub fn shown_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |character| character != '\n' && is_hidden(character))
}

/// A text in quotes, as messages say what was found; of a long one its beginning.
pub fn quoted(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("\"{}...\" ({} letters)", text[..end].escape_debug(), text.chars().count()),
        None => format!("\"{}\"", text.escape_debug()),
    }
}

/// A text as one line shows it; of a long one its beginning.
pub fn brief(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => Cow::Owned(format!("{}...", shown(&text[..end]))),
        None => shown(text),
    }
}

/// A number as people write it: so many digits, and a power of ten only far from one.
pub fn plain(number: f64, digits: usize) -> String {
    // Zero has no sign.
    let short = 0.0 + format!("{number:.*e}", digits.saturating_sub(1)).parse().unwrap_or(number);
    if short == 0.0 || (1e-4..1e7).contains(&short.abs()) { format!("{short}") } else { format!("{short:e}") }
}

/// A number with so many decimals; what rounds to zero has no sign.
pub fn fixed(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    match text.strip_prefix('-') {
        Some(size) if is_zero(size) => size.to_owned(),
        _ => text,
    }
}

/// How far off a number with so many decimals may be, as it stands behind ±: what these do not show is less than the last of them.
pub fn off_by(error: f64, decimals: usize) -> String {
    let text = fixed(error, decimals);
    if error > 0.0 && is_zero(&text) { format!("<{}", fixed(0.1_f64.powi(decimals as i32), decimals)) } else { text }
}

/// Whether a number without a sign is zero as it is written.
fn is_zero(written: &str) -> bool {
    written.bytes().all(|digit| matches!(digit, b'0' | b'.'))
}

fn escaped(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&hidden) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match hidden(character) {
            // A filler is no character that the library would escape.
            true => match character {
                '\n' | '\r' | '\t' => out.extend(character.escape_default()),
                _ => out.extend(character.escape_unicode()),
            },
            false => out.push(character),
        }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_people_write_them() {
        let cases = [
            (1.155_49, 4, "1.155"),
            (5_184_000.0, 4, "5184000"),
            (0.013_33, 3, "0.0133"),
            (7.66e7, 2, "7.7e7"),
            (2e-9, 3, "2e-9"),
            (0.0, 3, "0"),
            (-0.0, 3, "0"),
            (f64::INFINITY, 3, "inf"),
        ];
        for (number, digits, words) in cases {
            assert_eq!(plain(number, digits), words);
        }
    }

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        let cases = [(-1e-14, 2, "0.00"), (-0.0, 0, "0"), (-0.006, 2, "-0.01"), (0.004, 2, "0.00"), (-10.0, 0, "-10")];
        for (number, decimals, words) in cases {
            assert_eq!(fixed(number, decimals), words);
        }
    }

    #[test]
    fn an_error_that_is_not_zero_is_not_told_as_zero() {
        let cases = [(0.004, 2, "<0.01"), (0.006, 2, "0.01"), (0.0, 2, "0.00"), (0.3, 0, "<1"), (f64::NAN, 1, "NaN")];
        for (error, decimals, words) in cases {
            assert_eq!(off_by(error, decimals), words);
        }
    }

    #[test]
    fn what_is_not_seen_is_shown_as_an_escape() {
        let marks =
            ['\u{61c}', '\u{200e}', '\u{200f}', '\u{feff}', '\u{200b}', '\u{ad}', '\u{2028}', '\u{2029}', '\u{3164}'];
        let turned = ('\u{202a}'..='\u{202e}').chain('\u{2066}'..='\u{2069}').chain('\u{e0020}'..='\u{e007f}');
        let control = ('\0'..='\u{1f}').chain('\u{7f}'..='\u{9f}');
        for character in marks.into_iter().chain(turned).chain(control) {
            let text = format!("a{character}b");
            let safe = shown(&text);
            assert!(!safe.contains(character) && safe.starts_with("a\\") && safe.ends_with('b'), "{safe}");
        }
        assert_eq!(shown("a\u{1b}[31m\u{202e}\nb"), "a\\u{1b}[31m\\u{202e}\\nb");
        assert_eq!(shown_lines("a\u{1b}[31m\nb\r"), "a\\u{1b}[31m\nb\\r");
    }

    #[test]
    fn what_is_seen_stays() {
        let text = "Frostkörper, Frostko\u{308}rper, \u{e9}t\u{e9}, лёд, 冰, ثلج, m², −5 °C, \"\\ '";
        assert!(matches!(shown(text), Cow::Borrowed(same) if same == text));
    }

    #[test]
    fn a_long_text_is_quoted_by_its_beginning() {
        assert_eq!(quoted("a\"\n"), "\"a\\\"\\n\"");
        assert_eq!(brief(&"ä".repeat(201)), format!("{}...", "ä".repeat(200)));
        assert_eq!(quoted(&"ä".repeat(1000)), format!("\"{}...\" (1000 letters)", "ä".repeat(200)));
    }
}
