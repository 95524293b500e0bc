//! Values of Python as values of TOML: a scene that is a dictionary goes through the one reader of files.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PyString, PyTuple};
use toml::{Table, Value};

use crate::errors::SceneError;

/// How deep values lie in each other at most, as in files.
const DEEPEST: usize = 80;

/// The table of a dictionary, at a path of keys. What is wrong with it names its key.
///
/// # Errors
/// Where something in it is no value of TOML.
pub fn table(value: &Bound<'_, PyMapping>, path: &str, deep: usize) -> PyResult<Table> {
    let mut table = Table::new();
    for item in value.items()?.iter() {
        let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let Ok(key) = key.extract::<String>() else {
            return Err(wrong(path, &format!("found the key {}, must be a text", key.repr()?)));
        };
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        table.insert(key, of(&value, &path, deep + 1)?);
    }
    Ok(table)
}

/// A value at a path of keys.
fn of(value: &Bound<'_, PyAny>, path: &str, deep: usize) -> PyResult<Value> {
    if deep > DEEPEST {
        return Err(wrong(path, &format!("lies more than {DEEPEST} deep")));
    }
    // True is a number, too, to Python.
    if value.is_instance_of::<PyBool>() {
        return Ok(Value::Boolean(value.extract()?));
    }
    if value.is_instance_of::<PyInt>() {
        // What does not fit is a number all the same.
        return value.extract().map(Value::Integer).or_else(|_| value.extract().map(Value::Float));
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(Value::Float(value.extract()?));
    }
    if value.is_instance_of::<PyString>() {
        return Ok(Value::String(value.extract()?));
    }
    if let Ok(mapping) = value.cast::<PyMapping>() {
        return Ok(Value::Table(table(mapping, path, deep)?));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.enumerate();
        let items = items.map(|(k, item)| of(&item?, &format!("{path}.{}", k + 1), deep + 1));
        return Ok(Value::Array(items.collect::<PyResult<_>>()?));
    }
    // Numbers and arrays of NumPy.
    if let Ok(plain) = value.call_method0("tolist") {
        return of(&plain, path, deep + 1);
    }
    let kind = value.get_type().name()?;
    Err(wrong(path, &format!("found {kind}, must be a number, a text, true or false, a list or a dictionary")))
}

fn wrong(path: &str, words: &str) -> PyErr {
    SceneError::new_err(if path.is_empty() { words.to_owned() } else { format!("{path}: {words}") })
}

/// Keys and values as `--set` of the command has them.
///
/// # Errors
/// Where a value is none of TOML.
pub fn overrides(set: Option<&Bound<'_, PyMapping>>) -> PyResult<Vec<(String, String)>> {
    let Some(set) = set else { return Ok(Vec::new()) };
    let table = table(set, "", 0)?;
    Ok(table.into_iter().map(|(key, value)| (key, written(value))).collect())
}

/// Keys with lists of values, as `--vary` of the command has them.
///
/// # Errors
/// Where a value is none of TOML, or a key has no list.
pub fn varied(vary: &Bound<'_, PyMapping>) -> PyResult<Vec<(String, Vec<String>)>> {
    // A table would sort the keys, whose order means something.
    let key_of = |item: Bound<'_, PyAny>| {
        let (key, values): (String, Bound<'_, PyAny>) = item.extract()?;
        match of(&values, &key, 0)? {
            Value::Array(values) => Ok((key, values.into_iter().map(written).collect())),
            other => Err(wrong(&key, &format!("found {other}, must be a list of values"))),
        }
    };
    vary.items()?.iter().map(key_of).collect()
}

/// A value as `--set` has it: words need no quotes, but what would be read as something else than a text does.
fn written(value: Value) -> String {
    match value {
        Value::String(word) if format!("value = {word}").parse::<Table>().is_err() => word,
        value => value.to_string(),
    }
}

/// A table as a dictionary.
///
/// # Errors
/// Where Python has no memory for it.
pub fn dictionary<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let dictionary = PyDict::new(py);
    for (key, value) in table {
        dictionary.set_item(key, object(py, value)?)?;
    }
    Ok(dictionary)
}

fn object<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::String(text) => PyString::new(py, text).into_any(),
        Value::Integer(number) => number.into_pyobject(py)?.into_any(),
        Value::Float(number) => PyFloat::new(py, *number).into_any(),
        Value::Boolean(flag) => PyBool::new(py, *flag).to_owned().into_any(),
        // No key of a scene is a date; it is told as any text.
        Value::Datetime(date) => PyString::new(py, &date.to_string()).into_any(),
        Value::Array(items) => {
            let items = items.iter().map(|item| object(py, item)).collect::<PyResult<Vec<_>>>()?;
            PyList::new(py, items)?.into_any()
        }
        Value::Table(table) => dictionary(py, table)?.into_any(),
    })
}
