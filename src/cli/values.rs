//! Values of options, as several commands take them.

use std::borrow::Cow;

use frazil_record::shown;
use frazil_studies::parallel;

/// The command as it was typed, for a page of results, on which what is hidden is seen.
pub fn command_line() -> String {
    let typed = std::env::args_os().map(|argument| shown(&argument.to_string_lossy()).into_owned());
    typed.collect::<Vec<_>>().join(" ")
}

/// Threads that were asked for; by default one for each core.
pub fn threads(asked: Option<u16>) -> usize {
    asked.map_or_else(parallel::cores, usize::from)
}

/// What a value of an option must be.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("must be {0}")]
pub struct MustBe(pub Cow<'static, str>);

/// A number that passes a test.
pub fn number(text: &str, test: impl Fn(f64) -> bool, must_be: &'static str) -> Result<f64, MustBe> {
    text.parse().ok().filter(|number| test(*number)).ok_or(MustBe(must_be.into()))
}

/// A key path and a value.
pub fn key_and_value(text: &str) -> Result<(String, String), MustBe> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), value.trim().to_owned())),
        _ => Err(MustBe("KEY=VALUE, as time.outputs=20".into())),
    }
}

/// Seconds.
pub fn positive_seconds(text: &str) -> Result<f64, MustBe> {
    number(text, is_positive, "a number of seconds greater than 0")
}

/// A number greater than 0.
pub fn positive(text: &str) -> Result<f64, MustBe> {
    number(text, is_positive, "a number greater than 0")
}

fn is_positive(number: f64) -> bool {
    number.is_finite() && number > 0.0
}

/// A constant of a fluid: products of several of them must stay numbers.
pub fn sized(text: &str) -> Result<f64, MustBe> {
    number(text, |number| (1e-12..=1e12).contains(&number), "a number between 1e-12 and 1e12")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_may_contain_an_equals_sign() {
        assert_eq!(key_and_value("title = a=b"), Ok(("title".into(), "a=b".into())));
        assert!(key_and_value("title").is_err());
        assert!(key_and_value("=3").is_err());
    }
}
