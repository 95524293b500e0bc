//! The file as a tree of values that know where they were written, and `--set` upon it.

use frazil_record::quoted;
use toml::de::{DeTable, DeValue};
use toml::value::Datetime;
use toml::{Spanned, Value};

use super::problem::{Place, Problem};
use super::size;

/// A value of the file.
#[derive(Debug, Clone)]
pub(super) enum Node {
    Text(String),
    /// As written, as a number, and as an integer where it is one.
    Number(String, f64, Option<i64>),
    Flag(bool),
    Date(Datetime),
    List(Vec<Item>),
    Table(Vec<Entry>),
}

/// An element of a list.
#[derive(Debug, Clone)]
pub(super) struct Item {
    pub(super) place: Place,
    pub(super) node: Node,
}

/// A key and its value.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub(super) key: String,
    pub(super) place: Place,
    pub(super) node: Node,
}

impl Node {
    /// What messages call it.
    pub(super) fn found(&self) -> String {
        match self {
            Node::Text(text) => quoted(text),
            Node::Number(text, ..) if text.len() > 40 => format!("a number of {} digits", text.len()),
            Node::Number(text, ..) => text.clone(),
            Node::Flag(flag) => flag.to_string(),
            Node::Date(_) => "a date".into(),
            Node::List(_) => "a list".into(),
            Node::Table(_) => "a table".into(),
        }
    }

    /// The value without its places.
    pub(super) fn value(&self) -> Value {
        match self {
            Node::Text(text) => Value::String(text.clone()),
            Node::Number(_, _, Some(whole)) => Value::Integer(*whole),
            Node::Number(_, number, None) => Value::Float(*number),
            Node::Flag(flag) => Value::Boolean(*flag),
            Node::Date(date) => Value::Datetime(*date),
            Node::List(items) => Value::Array(items.iter().map(|item| item.node.value()).collect()),
            Node::Table(entries) => {
                Value::Table(entries.iter().map(|entry| (entry.key.clone(), entry.node.value())).collect())
            }
        }
    }
}

/// Parses a file; on failure all syntax errors, or all that is too large.
pub(super) fn parse(text: &str) -> Result<Vec<Entry>, Vec<Problem>> {
    if let Some(problem) = size::of_text(text) {
        return Err(vec![problem]);
    }
    let breaks: Vec<usize> = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect();
    let place = |at: usize| Place::Line(breaks.partition_point(|end| *end < at) + 1);
    let (table, errors) = DeTable::parse_recoverable(text);
    if errors.is_empty() {
        let entries = entries(table.get_ref(), &place);
        let large = size::of_entries(&entries);
        return if large.is_empty() { Ok(entries) } else { Err(large) };
    }
    let mut problems: Vec<Problem> = Vec::new();
    for error in errors {
        let place = match error.span() {
            Some(span) => place(span.start),
            // What is too deep has no place of its own.
            None => Place::Line(deepest(text)),
        };
        let mut message = format!("not valid TOML: {}", error.message().replace('\n', ", "));
        if let (true, Some(found)) = (message.ends_with("duplicate key"), error.span().and_then(|span| text.get(span)))
        {
            message.push_str(&format!(" {}", quoted(found.trim().trim_matches('"'))));
        }
        let problem = Problem::new(&place, "", message);
        // One slip often breaks the rest of its line in several ways; the first says it.
        if problems.last().is_none_or(|last| last.line != problem.line) {
            problems.push(problem);
        }
    }
    Err(problems)
}

/// The line, counted from 1, with most that opens a table or a list.
fn deepest(text: &str) -> usize {
    let opened = |line: &str| line.bytes().filter(|byte| b".[{".contains(byte)).count();
    let lines = (1..).zip(text.lines()).map(|(number, line)| (opened(line), std::cmp::Reverse(number)));
    lines.max().map_or(1, |(_, number)| number.0)
}

fn entries(table: &DeTable<'_>, place: &impl Fn(usize) -> Place) -> Vec<Entry> {
    let mut rows: Vec<_> = table.iter().collect();
    rows.sort_by_key(|(key, _)| key.span().start);
    rows.into_iter()
        .map(|(key, value)| Entry {
            key: key.get_ref().to_string(),
            place: place(key.span().start),
            node: node(value, place),
        })
        .collect()
}

fn node(value: &Spanned<DeValue<'_>>, place: &impl Fn(usize) -> Place) -> Node {
    match value.get_ref() {
        DeValue::String(text) => Node::Text(text.to_string()),
        DeValue::Integer(integer) => {
            let whole = i64::from_str_radix(integer.as_str(), integer.radix()).ok();
            let number = whole.map_or_else(|| integer.as_str().parse().unwrap_or(f64::INFINITY), |whole| whole as f64);
            Node::Number(integer.to_string(), number, whole)
        }
        DeValue::Float(float) => {
            Node::Number(float.as_str().to_owned(), float.as_str().parse().unwrap_or(f64::NAN), None)
        }
        DeValue::Boolean(flag) => Node::Flag(*flag),
        DeValue::Datetime(date) => Node::Date(*date),
        DeValue::Array(items) => Node::List(
            items.iter().map(|item| Item { place: place(item.span().start), node: node(item, place) }).collect(),
        ),
        DeValue::Table(table) => Node::Table(entries(table, place)),
    }
}

/// Why a path of keys leads nowhere.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
enum NoPlace {
    #[error("lists count from 1: what was \"{0}.0\" is \"{0}.1\"")]
    Zero(String),
    #[error("\"{part}\" is an empty list, so it has no \"{next}\"")]
    Empty { part: String, next: String },
    #[error("\"{part}\" is a list of {count}, so \"{next}\" must be a number from 1 to {count}")]
    Number { part: String, next: String, count: usize },
    #[error("\"{part}\" is {found}, so it has no key \"{next}\"")]
    Value { part: String, found: String, next: String },
}

/// Keys of a path, as deep as files may be.
const DEEPEST: usize = 80;

/// Applies one `--set KEY=VALUE`. What is no TOML value is taken as text, so that words need no quotes.
pub(super) fn set(root: &mut Vec<Entry>, key: &str, value: &str) -> Result<(), Problem> {
    let place = Place::Set(format!("{key}={value}"));
    let parts: Vec<&str> = key.split('.').collect();
    if parts.iter().any(|part| part.trim().is_empty()) {
        return Err(Problem::new(&place, key, "must be a path of keys joined by dots, as \"time.outputs\""));
    }
    if parts.len() > DEEPEST {
        let message = format!("found a path of {} keys, must be one of at most {DEEPEST}", parts.len());
        return Err(Problem::new(&place, key, message));
    }
    let new = match DeValue::parse(value) {
        Ok(parsed) => node(&parsed, &|_| place.clone()),
        Err(_) => Node::Text(value.to_owned()),
    };
    set_in_table(root, &parts, new, &place).map_err(|wrong| Problem::new(&place, key, wrong.to_string()))
}

fn set_in_table(entries: &mut Vec<Entry>, parts: &[&str], new: Node, place: &Place) -> Result<(), NoPlace> {
    let Some((part, rest)) = parts.split_first() else { return Ok(()) };
    let index = entries.iter().position(|entry| entry.key == *part).unwrap_or_else(|| {
        entries.push(Entry { key: (*part).to_owned(), place: place.clone(), node: Node::Table(Vec::new()) });
        entries.len() - 1
    });
    let entry = &mut entries[index];
    if rest.is_empty() {
        entry.place = place.clone();
    }
    set_in_node(&mut entry.node, part, rest, new, place)
}

fn set_in_node(node: &mut Node, part: &str, rest: &[&str], new: Node, place: &Place) -> Result<(), NoPlace> {
    let Some((next, after)) = rest.split_first() else {
        *node = new;
        return Ok(());
    };
    match node {
        Node::Table(entries) => set_in_table(entries, rest, new, place),
        Node::List(items) => {
            let count = items.len();
            let numbered = next.parse().ok().and_then(|number: usize| items.get_mut(number.checked_sub(1)?));
            let Some(item) = numbered else {
                let (part, next) = (part.to_owned(), (*next).to_owned());
                return Err(match (next.as_str(), count) {
                    ("0", 1..) => NoPlace::Zero(part),
                    (_, 0) => NoPlace::Empty { part, next },
                    _ => NoPlace::Number { part, next, count },
                });
            };
            if after.is_empty() {
                item.place = place.clone();
            }
            set_in_node(&mut item.node, next, after, new, place)
        }
        other => Err(NoPlace::Value { part: part.to_owned(), found: other.found(), next: (*next).to_owned() }),
    }
}
