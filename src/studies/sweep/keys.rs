//! Keys of a sweep with their values, as they are typed: `initial.temperature_c=1,2,3`.

use toml::{Table, Value};

/// A key and the values that it takes.
#[derive(Debug, Clone, PartialEq)]
pub struct VariedKey {
    /// Path of the key.
    pub key: String,
    /// Values in the order in which they were given, as TOML.
    pub values: Vec<String>,
}

/// What is no key with values.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "must be KEY=VALUE,VALUE,..., as initial.temperature_c=1,2,3, or KEY=FIRST..LAST:COUNT, as time.duration_h=5..20:4"
)]
pub struct NoKey;

/// Values of a range at most.
const MOST_VALUES: usize = 10_000;

impl VariedKey {
    /// A key with its values from text. Commas within brackets, braces and quotes belong to a value.
    ///
    /// # Errors
    /// Where there is no key, or a value is empty or there twice.
    pub fn read(text: &str) -> Result<Self, NoKey> {
        let (key, list) = text.split_once('=').ok_or(NoKey)?;
        VariedKey::new(key.trim().to_owned(), range(list).unwrap_or_else(|| listed(list)))
    }

    /// A key with its values.
    ///
    /// # Errors
    /// Where there is no key or no value, or a value is empty or there twice.
    pub fn new(key: String, values: Vec<String>) -> Result<Self, NoKey> {
        let is_again = |k: usize| values[..k].contains(&values[k]);
        if key.is_empty() || values.is_empty() || values.iter().any(String::is_empty) || (0..values.len()).any(is_again)
        {
            return Err(NoKey);
        }
        Ok(VariedKey { key, values })
    }

    /// The end of the key that tells it from all others that are varied: its last part, or more of them, and no number at its beginning.
    pub fn short<'a>(&'a self, all: &[VariedKey]) -> &'a str {
        let mut ends = self.key.rmatch_indices('.').map(|(dot, _)| &self.key[dot + 1..]);
        let is_own = |end: &&str| {
            let others = all.iter().filter(|other| other.key.ends_with(end)).count();
            others <= 1 && !end.starts_with(|letter: char| letter.is_ascii_digit())
        };
        ends.find(is_own).unwrap_or(&self.key)
    }

    /// The values as numbers, if all are numbers.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        let number = |value: &String| value.parse::<f64>().ok().filter(|number| number.is_finite());
        self.values.iter().map(number).collect()
    }
}

/// So many values from a first one to a last one.
fn range(list: &str) -> Option<Vec<String>> {
    let (ends, count) = list.split_once(':')?;
    let (first, last) = ends.split_once("..")?;
    let (first, last) = (first.trim().parse::<f64>().ok()?, last.trim().parse::<f64>().ok()?);
    let count = count.trim().parse::<usize>().ok().filter(|count| (2..=MOST_VALUES).contains(count))?;
    let value = |k: usize| {
        let value = first + (last - first) * k as f64 / (count - 1) as f64;
        // To twelve digits: 0.1 + 0.2 is meant to be 0.3.
        format!("{value:.11e}").parse::<f64>().map_or_else(|_| value.to_string(), |rounded| rounded.to_string())
    };
    (first.is_finite() && last.is_finite()).then(|| (0..count).map(value).collect())
}

/// Values between commas: those of a list of TOML, or words without quotes, as they may be typed.
fn listed(list: &str) -> Vec<String> {
    match format!("values = [{list}]").parse::<Table>().as_ref().map(|table| table.get("values")) {
        Ok(Some(Value::Array(values))) => values.iter().map(Value::to_string).collect(),
        _ => list.split(',').map(|value| value.trim().to_owned()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_of_a_value_do_not_part_it() {
        let read = |text: &str| VariedKey::read(text).map(|varied| (varied.key, varied.values));
        let are =
            |key: &str, values: &[&str]| Ok((key.to_owned(), values.iter().map(|one| (*one).to_owned()).collect()));
        assert_eq!(read("a.b = 1, 2,3"), are("a.b", &["1", "2", "3"]));
        assert_eq!(read("a=[1, 2],[3,4]"), are("a", &["[1, 2]", "[3, 4]"]));
        assert_eq!(read("a={x = [1,2], y = 3},\"b,c\""), are("a", &["{ x = [1, 2], y = 3 }", "\"b,c\""]));
        assert_eq!(read("a=0.1..0.4:4"), are("a", &["0.1", "0.2", "0.3", "0.4"]));
        assert_eq!(read("a=-20..-30:3"), are("a", &["-20", "-25", "-30"]));
        assert_eq!(read("a=best,paper"), are("a", &["best", "paper"]));
        for bad in ["a", "=1", "a=", "a=1,,2", "a=1,1", "a=1..1:2"] {
            assert_eq!(read(bad), Err(NoKey), "{bad}");
        }
    }

    #[test]
    fn a_short_name_is_that_of_one_key() {
        let keys = ["pipes.1.temperature_c=1", "initial.temperature_c=1", "time.outputs=1", "outputs=1"];
        let keys = keys.map(|text| VariedKey::read(text).expect("a key"));
        let short = keys.each_ref().map(|key| key.short(&keys));
        assert_eq!(short, ["pipes.1.temperature_c", "initial.temperature_c", "time.outputs", "outputs"]);
    }

    #[test]
    fn values_are_numbers_where_all_of_them_are() {
        let numbers = |text: &str| VariedKey::read(text).expect("a key").numbers();
        assert_eq!(numbers("a=1,-2e3,1_000"), Some(vec![1.0, -2000.0, 1000.0]));
        assert_eq!(numbers("a=1,best"), None);
        assert_eq!(numbers("a=1,inf"), None);
    }
}
