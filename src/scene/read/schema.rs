//! The schema of scene files: what the reader asks for, as JSON Schema has it.

use std::collections::BTreeMap;
use std::iter;
use std::ops::RangeInclusive;

use serde_json::{Map, Value, json};

use super::problem::KeyOf;
use super::range::Range;
use crate::TimeUnit;

/// What the value of a key may be.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    Number(Range),
    Integer(RangeInclusive<usize>),
    Text,
    Words(Vec<String>),
    Flag,
    FlagOr(String),
    Table,
    Tables,
    /// The section itself: tables by names that are free.
    Named,
    Numbers(Range),
    Texts,
    Points,
    Point,
    Along,
    /// Whether it may be a formula.
    Series(Range, bool),
    AlongAxis(Range),
    Formula,
    Schedule,
}

impl Shape {
    pub(super) fn words<T>(choices: &[(&str, T)]) -> Self {
        Shape::Words(choices.iter().map(|(word, _)| (*word).to_owned()).collect())
    }

    /// What a value of a key must be; `inner` is the path of the section that a table is.
    fn value(&self, inner: &str) -> Value {
        let list = |items: Value| json!({ "type": "array", "items": items });
        let any = || json!({ "type": "number" });
        match self {
            Shape::Number(range) => number(range),
            Shape::Integer(range) => json!({ "type": "integer", "minimum": range.start(), "maximum": range.end() }),
            Shape::Text => json!({ "type": "string", "minLength": 1 }),
            Shape::Words(words) => json!({ "enum": words }),
            Shape::Flag => json!({ "type": "boolean" }),
            Shape::FlagOr(word) => json!({ "enum": [true, false, word] }),
            Shape::Table => json!({ "$ref": format!("#/definitions/{}", named(inner)) }),
            Shape::Tables => list(json!({ "$ref": format!("#/definitions/{}", named(inner)) })),
            Shape::Named => json!({ "type": "object" }),
            Shape::Numbers(range) => list(number(range)),
            Shape::Texts => list(json!({ "type": "string" })),
            Shape::Points => list(list(any())),
            Shape::Point => json!({ "type": "array", "items": any(), "minItems": 2, "maxItems": 2 }),
            Shape::Along => json!({ "anyOf": [number(&Range::POSITIVE), list(number(&Range::POSITIVE))] }),
            Shape::Series(range, with_formula) => {
                let mut table = table_or_file();
                let keys = ["times", "period"]
                    .into_iter()
                    .flat_map(|base| endings().map(move |ending| (base, format!("{base}{ending}"))));
                let time = |base: &str| match base {
                    "times" => list(number(&Range::NOT_NEGATIVE)),
                    _ => number(&Range::POSITIVE),
                };
                table["properties"] = keys.map(|(base, key)| (key, time(base))).collect::<Map<String, Value>>().into();
                table["properties"]["values"] = list(number(range));
                table["properties"]["file"] = json!({ "type": "string", "minLength": 1 });
                let values: Vec<Value> = [number(range), table].into_iter().chain(with_formula.then(formula)).collect();
                json!({ "anyOf": values })
            }
            Shape::AlongAxis(range) => {
                let mut table = table_or_file();
                let places = ["x_m", "y_m", "x", "y"].map(|key| (key.to_owned(), list(any())));
                table["properties"] = places.into_iter().collect::<Map<String, Value>>().into();
                table["properties"]["values"] = list(number(range));
                table["properties"]["file"] = json!({ "type": "string", "minLength": 1 });
                json!({ "anyOf": [number(range), table, formula()] })
            }
            Shape::Formula => formula(),
            Shape::Schedule => list(list(number(&Range::NOT_NEGATIVE))),
        }
    }
}

/// A table with a formula.
fn formula() -> Value {
    json!({
        "type": "object",
        "properties": { "formula": { "type": "string", "minLength": 1 } },
        "required": ["formula"],
        "additionalProperties": false,
    })
}

/// A table with values, or with a file of them.
fn table_or_file() -> Value {
    let required = ["values", "file"].map(|key| json!({ "required": [key] }));
    json!({ "type": "object", "oneOf": required, "additionalProperties": false })
}

/// Endings of the keys of times, without one where a scene has no units.
fn endings() -> impl Iterator<Item = String> {
    let units = TimeUnit::ALL.iter().map(|unit| format!("_{}", unit.ending()));
    iter::once(String::new()).chain(units)
}

fn number(range: &Range) -> Value {
    let mut value = json!({ "type": "number" });
    let words = [["exclusiveMinimum", "minimum"], ["exclusiveMaximum", "maximum"]];
    for (end, words) in range.ends().into_iter().zip(words) {
        if let Some((end, included)) = end {
            value[words[usize::from(included)]] = json!(end);
        }
    }
    value
}

/// Name of the definition of a section.
fn named(path: &str) -> &str {
    if path.is_empty() { "scene" } else { path }
}

/// The schema of what values may be; a key of which nothing is known may be anything.
pub(super) fn schema(shapes: Vec<(KeyOf, Shape)>, every: &[KeyOf]) -> Value {
    // Values that keys may have, by section; and the sections whose keys are free names.
    let mut sections: BTreeMap<String, BTreeMap<String, Vec<Value>>> = BTreeMap::new();
    let mut free: Vec<String> = Vec::new();
    for KeyOf { key, base, section } in every {
        let keys = sections.entry(section.clone()).or_default();
        keys.entry(key.clone()).or_default();
        keys.entry(base.clone()).or_default();
    }
    for (KeyOf { key, base, section }, shape) in shapes {
        if shape == Shape::Named {
            free.push(section);
            continue;
        }
        let inner = if section.is_empty() { key.clone() } else { format!("{section}.{key}") };
        let value = shape.value(&inner);
        if matches!(shape, Shape::Table | Shape::Tables) {
            sections.entry(inner).or_default();
        }
        let keys = sections.entry(section).or_default();
        for name in [key, base] {
            let values = keys.entry(name).or_default();
            if !values.contains(&value) {
                values.push(value.clone());
            }
        }
    }
    // A section under a free name has the keys that any of its kind has.
    for section in &free {
        let own = sections.get(section).cloned().unwrap_or_default();
        let is_inner = |path: &String| {
            path.strip_prefix(&format!("{section}.")).is_some_and(|name| !name.contains('.') && !own.contains_key(name))
        };
        let inner: Vec<String> = sections.keys().filter(|path| is_inner(path)).cloned().collect();
        for path in inner {
            let keys = sections.remove(&path).unwrap_or_default();
            sections.entry(section.clone()).or_default().extend(keys);
        }
    }
    let mut definitions = Map::new();
    for (section, keys) in &sections {
        let properties: Map<String, Value> = keys.iter().map(|(key, values)| (key.clone(), any_of(values))).collect();
        let own = json!({ "type": "object", "properties": properties, "additionalProperties": false });
        let own = match free.contains(section) {
            true => json!({ "type": "object", "additionalProperties": own }),
            false => own,
        };
        definitions.insert(named(section).to_owned(), own);
    }
    let required = ["title", "source", "domain", "time", "materials", "initial", "walls"];
    if let Some(scene) = definitions.get_mut("scene") {
        scene["required"] = json!(required);
    }
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "Scene of frazil",
        "$ref": "#/definitions/scene",
        "definitions": definitions,
    })
}

fn any_of(values: &[Value]) -> Value {
    match values {
        [] => json!({}),
        [one] => one.clone(),
        several => json!({ "anyOf": several }),
    }
}
