//! Values of options, as several commands take them.

use frazil_studies::parallel;

/// The command as it was typed, for a page of results.
pub fn command_line() -> String {
    std::env::args().collect::<Vec<_>>().join(" ")
}

/// Threads that were asked for; by default one for each core.
pub fn threads(asked: Option<u16>) -> usize {
    asked.map_or_else(parallel::cores, usize::from)
}

/// A key path and a value.
pub fn key_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().to_owned(), value.trim().to_owned())),
        _ => Err("must be KEY=VALUE, as time.outputs=20".into()),
    }
}

/// Seconds.
pub fn positive_seconds(text: &str) -> Result<f64, String> {
    positive(text).map_err(|_| "must be a number of seconds greater than 0".into())
}

/// A number greater than 0.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => Err("must be a number greater than 0".into()),
    }
}

/// A constant of a fluid: products of several of them must stay numbers.
pub fn sized(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (1e-12..=1e12).contains(&number) => Ok(number),
        _ => Err("must be a number between 1e-12 and 1e12".into()),
    }
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
