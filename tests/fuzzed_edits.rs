//! What is done to files that are well, so that nobody would have written them.

use std::collections::BTreeMap;

use rand::RngExt;
use rand::rngs::StdRng;
use toml::{Table, Value};

#[derive(Debug, Clone)]
pub enum Step {
    Key(String),
    Item(usize),
}

/// All places of a value but its own.
pub fn paths(value: &Value, path: &mut Vec<Step>, found: &mut Vec<Vec<Step>>) {
    let mut below = |step: Step, value: &Value| {
        path.push(step);
        found.push(path.clone());
        paths(value, path, found);
        path.pop();
    };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| below(Step::Key(key.clone()), value)),
        Value::Array(items) => items.iter().enumerate().for_each(|(k, value)| below(Step::Item(k), value)),
        _ => {}
    }
}

pub fn at<'a>(value: &'a mut Value, path: &[Step]) -> &'a mut Value {
    path.iter().fold(value, |value, step| match step {
        Step::Key(key) => value.get_mut(key.as_str()).expect("a key"),
        Step::Item(k) => value.get_mut(*k).expect("an item"),
    })
}

pub fn at_ref<'a>(value: &'a Value, path: &[Step]) -> &'a Value {
    path.iter().fold(value, |value, step| match step {
        Step::Key(key) => value.get(key.as_str()).expect("a key"),
        Step::Item(k) => value.get(*k).expect("an item"),
    })
}

pub fn delete(parent: &mut Value, last: &Step) {
    match (parent, last) {
        (Value::Table(table), Step::Key(key)) => drop(table.remove(key)),
        (Value::Array(items), Step::Item(k)) => drop(items.remove(*k)),
        _ => {}
    }
}

pub fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// Another number: of another size or sign or a little off, and seldom of another kind.
pub fn rescaled(value: &Value, random: &mut StdRng) -> Value {
    let number = number(value).unwrap_or(0.0);
    let new = match random.random_range(0..8) {
        0 => -number,
        1 => 0.0,
        2 | 3 => number * random.random_range(0.2..5.0),
        4 => number * 10f64.powi(random.random_range(-3..4)),
        5 => number * 10f64.powi(random.random_range(-12..13)),
        6 => number + 1.0,
        _ => number * f64::from(random.random_range(2..9_u8)),
    };
    let whole = value.is_integer() != (random.random_range(0..8) == 0);
    if whole && new.abs() < 1e15 { Value::Integer(new.round() as i64) } else { Value::Float(new) }
}

pub fn misspelt(key: &str, random: &mut StdRng) -> String {
    let mut letters: Vec<char> = key.chars().collect();
    if letters.len() < 2 {
        return format!("{key}x");
    }
    let k = random.random_range(0..letters.len() - 1);
    match random.random_range(0..3) {
        0 => drop(letters.remove(k)),
        1 => letters.swap(k, k + 1),
        _ => letters.insert(k, 'x'),
    }
    letters.into_iter().collect()
}

pub fn collect(value: &Value, keys: &mut Vec<String>, values: &mut Vec<Value>, of: &mut BTreeMap<String, Vec<Value>>) {
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                keys.push(key.clone());
                of.entry(key.clone()).or_default().push(value.clone());
                collect(value, keys, values, of);
            }
        }
        other => {
            values.push(other.clone());
            if let Value::Array(items) = other {
                items.iter().for_each(|item| collect(item, keys, values, of));
            }
        }
    }
}

pub fn pick<'a, T>(items: &'a [T], random: &mut StdRng) -> &'a T {
    &items[random.random_range(0..items.len())]
}

/// The path of a table as the reader knows it: without numbers of lists, and without names that are free.
pub fn section(path: &[Step]) -> String {
    let keys: Vec<&str> = path
        .iter()
        .filter_map(|step| match step {
            Step::Key(key) => Some(key.as_str()),
            Step::Item(_) => None,
        })
        .collect();
    let free = keys.first().is_some_and(|first| ["materials", "walls"].contains(first));
    let kept = keys.iter().enumerate().filter(|(k, _)| !(free && *k == 1)).map(|(_, key)| *key);
    kept.collect::<Vec<_>>().join(".")
}

/// A path as `--set` writes it.
pub fn dotted(path: &[Step]) -> String {
    let step = |step: &Step| match step {
        Step::Key(key) => key.clone(),
        Step::Item(k) => (k + 1).to_string(),
    };
    path.iter().map(step).collect::<Vec<_>>().join(".")
}

/// A value that is odd wherever it stands.
pub fn odd(random: &mut StdRng) -> Value {
    const ODD: [&str; 28] = [
        "\"\"",
        "\"x\"",
        "0",
        "1",
        "-1",
        "3",
        "0.5",
        "1e-30",
        "1e30",
        "1e300",
        "nan",
        "inf",
        "-inf",
        "true",
        "false",
        "[]",
        "[[]]",
        "[1, 2]",
        "[[1, 2, 3]]",
        "{}",
        "{ a = { b = 1 } }",
        "{ times_h = [0, 1], values = [1, 2] }",
        "1979-05-27",
        "9223372036854775807",
        "5e-324",
        "\"\\u001b[2J\"",
        "\"../../x\"",
        "[nan, inf, -1e308]",
    ];
    let text = format!("value = {}", pick(&ODD, random));
    text.parse::<Table>().ok().and_then(|mut table| table.remove("value")).unwrap_or(Value::Integer(0))
}

/// A text with bytes that do not belong there, pieces twice and pieces left out.
pub fn spoilt(text: &str, random: &mut StdRng) -> String {
    const PIECES: [&str; 28] = [
        "\"",
        "'",
        "\"\"\"",
        "[",
        "]",
        "[[",
        "{",
        "}",
        "=",
        ",",
        ".",
        "\n",
        "\r",
        "\t",
        "\0",
        "#",
        "\u{1b}[2J",
        "\u{202e}",
        "\u{feff}",
        "\\u0000",
        "\\",
        "1e999",
        "-",
        "0x",
        "nan",
        "ä",
        "[a.b.c]\n",
        "[[pipes]]\n",
    ];
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..random.random_range(1..5) {
        let (from, length) = (random.random_range(0..=bytes.len()), random.random_range(0..60_usize));
        let to = (from + length).min(bytes.len());
        match random.random_range(0..6) {
            0 => drop(bytes.drain(from..to)),
            1 => {
                let piece = bytes[from..to].to_vec();
                bytes.splice(to..to, piece.repeat(random.random_range(1..4)));
            }
            2 if from < bytes.len() => bytes[from] ^= 1 << random.random_range(0..8),
            3 => bytes.truncate(from.max(1)),
            _ => drop(bytes.splice(from..from, pick(&PIECES, random).bytes())),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
