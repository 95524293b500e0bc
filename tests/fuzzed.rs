//! Scenes and studies that nobody wrote: bundled ones with keys deleted, copied, renamed, retyped and rescaled. Each is read; some
//! are planned, checked and run for some milliseconds. A case is known by its seed and number alone.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use frazil::parts::parts;
use frazil_core::boundary::condition::Condition;
use frazil_record::{Outcome, RunResult};
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;
use frazil_scene::method::Stepper;
use frazil_simulation::march::{Options, run};
use frazil_simulation::plan;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use toml::{Table, Value};

/// Longest that one case may take.
pub const LONGEST: Duration = Duration::from_secs(5);

/// Particles times neighbours up to which every scene is planned, and up to which one in `RARE` is.
const SMALL: f64 = 3e4;
const LARGE: f64 = 1e6;
const RARE: u32 = 100;

/// One in so many of the scenes that can be planned soon is.
const PLANNED: u32 = 2;

/// One in so many of the scenes that are planned is run, and checked with a trial of its steps.
const RUN: u32 = 8;
const CHECKED: u32 = 200;
/// Wall time that a run is given (s).
const RUN_S: f64 = 0.01;

/// One in so many cases is a study.
const STUDIES: u32 = 30;

/// A file that cases are made of.
struct Source {
    file: Table,
    study: bool,
}

/// What cases are made of.
pub struct Pool {
    scenes: Vec<Source>,
    studies: Vec<Source>,
    /// All keys, and values that are no tables, of all sources.
    keys: Vec<String>,
    values: Vec<Value>,
}

/// How a case ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum End {
    /// Refused by the reader.
    Unread,
    /// Read, and not planned: it is large.
    Read,
    /// Read, and refused by the planner.
    Refused,
    /// Planned.
    Planned,
    /// Run to an end, or as long as it was given.
    Run,
    /// A study that was read.
    Study,
}

/// What must not happen.
#[derive(Debug)]
pub struct Finding {
    /// What happened.
    pub what: String,
    /// The file.
    pub text: String,
}

impl Pool {
    /// The bundled scenes, with spacings so large that most can be planned soon, and studies of few layouts.
    pub fn new() -> Pool {
        let bundled = frazil_cases::scenes::all().iter().chain(frazil_cases::scenes::extreme());
        let texts = bundled.map(|scene| scene.text).chain([include_str!("../cases/bad/region-outside.toml")]);
        let table = |text: &str| text.parse::<Table>().expect("a table");
        let scenes: Vec<Source> = texts.map(|text| Source { file: coarsened(table(text)), study: false }).collect();
        let few = |text: &str| {
            let mut file = table(text);
            for key in ["sweep", "critical"] {
                let lists =
                    file.get_mut(key).and_then(Value::as_table_mut).into_iter().flat_map(|table| table.iter_mut());
                lists.filter_map(|(_, value)| value.as_array_mut()).for_each(|list| list.truncate(2));
            }
            if let Some(deviation) = file.get_mut("deviation").and_then(Value::as_table_mut) {
                deviation.insert("members".into(), Value::Integer(2));
            }
            if let Some(layouts) = file.get_mut("layouts").and_then(Value::as_array_mut) {
                layouts.truncate(2);
            }
            Source { file, study: true }
        };
        let studies: Vec<Source> = frazil_cases::studies::all().iter().map(|study| few(study.text)).collect();
        let (mut keys, mut values) = (Vec::new(), Vec::new());
        for source in scenes.iter().chain(&studies) {
            collect(&Value::Table(source.file.clone()), &mut keys, &mut values);
        }
        keys.sort_unstable();
        keys.dedup();
        Pool { scenes, studies, keys, values }
    }

    /// The file of a case.
    pub fn text(&self, seed: u64, case: u64) -> (String, bool) {
        let mut random = StdRng::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ case);
        let of = if random.random_range(0..STUDIES) == 0 { &self.studies } else { &self.scenes };
        let source = pick(of, &mut random);
        let mut file = Value::Table(source.file.clone());
        let edits = 1 + random.random_range(0..8_u32).trailing_ones() as usize;
        for _ in 0..edits {
            self.edit(&mut file, &mut random);
        }
        (file.as_table().map(Table::to_string).unwrap_or_default(), source.study)
    }

    /// Does one thing to one place of a file.
    fn edit(&self, file: &mut Value, random: &mut StdRng) {
        let mut places = Vec::new();
        paths(file, &mut Vec::new(), &mut places);
        if places.is_empty() {
            return;
        }
        let place = pick(&places, random).clone();
        let Some((last, parent)) = place.split_last() else { return };
        match random.random_range(0..10) {
            0 => delete(at(file, parent), last),
            1 => {
                let copy = at(file, &place).clone();
                match last {
                    Step::Item(_) => at(file, parent).as_array_mut().expect("a list").push(copy),
                    Step::Key(key) => {
                        let tables: Vec<_> = places.iter().filter(|place| at_ref(file, place).is_table()).collect();
                        if !tables.is_empty() {
                            let to = (*pick(&tables, random)).clone();
                            at(file, &to).as_table_mut().expect("a table").insert(key.clone(), copy);
                        }
                    }
                }
            }
            2 => {
                if let (Step::Key(key), Some(table)) = (last, at(file, parent).as_table_mut())
                    && let Some(value) = table.remove(key)
                {
                    let name = if random.random() { pick(&self.keys, random).clone() } else { misspelt(key, random) };
                    table.insert(name, value);
                }
            }
            3 => *at(file, &place) = self.value(random),
            _ => {
                let numbers: Vec<_> = places.iter().filter(|place| number(at_ref(file, place)).is_some()).collect();
                if !numbers.is_empty() {
                    let place = (*pick(&numbers, random)).clone();
                    let value = at(file, &place);
                    *value = rescaled(value, random);
                }
            }
        }
    }

    fn value(&self, random: &mut StdRng) -> Value {
        const ODD: [&str; 24] = [
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
        ];
        if random.random() {
            return pick(&self.values, random).clone();
        }
        let text = format!("value = {}", pick(&ODD, random));
        text.parse::<Table>().ok().and_then(|mut table| table.remove("value")).unwrap_or(Value::Integer(0))
    }

    /// Makes a case, and says how it ended or what must not happen.
    pub fn case(&self, seed: u64, case: u64) -> Result<End, Box<Finding>> {
        let (text, study) = self.text(seed, case);
        let began = Instant::now();
        let found =
            catch_unwind(AssertUnwindSafe(|| if study { read_study(&text) } else { through(&text, seed, case) }));
        let took = began.elapsed();
        let what = match found {
            Err(panic) => format!("panic: {}", words(panic.as_ref())),
            Ok(Err(what)) => what,
            Ok(Ok(_)) if took > LONGEST => format!("took {:.1} s", took.as_secs_f64()),
            Ok(Ok(end)) => return Ok(end),
        };
        Err(Box::new(Finding { what, text }))
    }
}

/// A file with the smallest multiple of its spacings at which every method has few particles.
fn coarsened(file: Table) -> Table {
    let methods: Vec<String> =
        file.get("method").and_then(Value::as_table).map_or_else(Vec::new, |methods| methods.keys().cloned().collect());
    for factor in [1, 2, 4, 5, 8, 10, 16, 20, 25, 32, 40, 50, 64, 80, 100, 125, 200] {
        let mut coarse = file.clone();
        for method in &methods {
            let table =
                coarse.get_mut("method").and_then(|methods| methods.get_mut(method)).and_then(Value::as_table_mut);
            for (key, value) in table.into_iter().flat_map(|table| table.iter_mut()) {
                if key.starts_with("spacing")
                    && let Some(spacing) = number(value)
                {
                    *value = Value::Float(spacing * f64::from(factor));
                }
            }
        }
        let read = Scene::read(&coarse.to_string(), "fuzz", "fuzz.toml", &[], frazil::registry::methods());
        if read.is_ok_and(|scene| scene.methods.iter().all(|settings| size(&scene, settings) <= SMALL)) {
            return coarse;
        }
    }
    file
}

/// Particles times neighbours.
fn size(scene: &Scene, settings: &MethodSettings) -> f64 {
    let dimension = scene.domain.dimension() as i32;
    let spacing = settings.numerics.spacing;
    let reach = (2.0 * settings.discretisation.weight.reach() / spacing + 1.0).powi(dimension);
    scene.domain.size() / spacing.powi(dimension) * reach
}

/// Reads a scene and takes it as far as it costs little.
fn through(text: &str, seed: u64, case: u64) -> Result<End, String> {
    let scene = match Scene::read(text, "fuzz", "fuzz.toml", &[], frazil::registry::methods()) {
        Ok(scene) => scene,
        Err(problems) if problems.problems.is_empty() => return Err("refused without a word".into()),
        Err(_) => return Ok(End::Unread),
    };
    let mut random = StdRng::seed_from_u64(seed ^ !case);
    let settings = pick(&scene.methods, &mut random);
    let size = size(&scene, settings);
    // Particles that move are left to themselves before the first step, which takes as long as a run.
    let costly = size > SMALL || matches!(settings.discretisation.stepper, Stepper::Moving(_));
    if size > LARGE || (costly && random.random_range(0..RARE) != 0) {
        return Ok(End::Read);
    }
    if random.random_range(0..PLANNED) != 0 {
        return Ok(End::Read);
    }
    // Closed forms and tables take longer than most plans.
    let referred =
        scene.walls.iter().any(|wall| wall.condition == Condition::Exact) || random.random_range(0..RUN) == 0;
    let found = if referred { frazil::run::reference(&scene) } else { Ok(None) };
    let Ok(reference) = found else { return Ok(End::Refused) };
    let draw = random.random_range(0..RUN * CHECKED);
    if draw % CHECKED == 0 {
        let said = frazil::check::plan(&scene, settings.method, reference.as_ref(), 1, random.random());
        return match said {
            Ok(said) => finite(&said).map(|()| End::Planned),
            Err(_) => Ok(End::Refused),
        };
    }
    if draw % RUN == 0 {
        let options = Options { time_limit_s: Some(RUN_S), fields: random.random(), ..Options::default() };
        return match run(&scene, settings.method, reference.as_ref(), &options) {
            Ok(result) if result.record.outcome == Outcome::Ok => {
                finite(&numbers(result)).map(|()| End::Run).map_err(|what| format!("ok, but {what}"))
            }
            Ok(_) => Ok(End::Run),
            Err(_) => Ok(End::Refused),
        };
    }
    match plan::build(&scene, settings, reference.as_ref(), 1, 1) {
        Ok(_) => Ok(End::Planned),
        Err(_) => Ok(End::Refused),
    }
}

/// All numbers of a result but maps, which have none outside the body.
fn numbers(mut result: RunResult) -> String {
    result.fields.clear();
    format!("{result:?}")
}

/// Whether all numbers of a text are finite.
fn finite(text: &str) -> Result<(), String> {
    let odd = |word: &&str| matches!(*word, "inf" | "NaN" | "-inf" | "nan");
    let separators = |character: char| !(character.is_alphanumeric() || character == '_' || character == '-');
    match text.split(separators).find(odd) {
        Some(word) => {
            let at = text.find(word).unwrap_or(0);
            let from = text[..at].char_indices().rev().nth(80).map_or(0, |(from, _)| from);
            Err(format!("a number is {word}: ...{}", &text[from..at + word.len()]))
        }
        None => Ok(()),
    }
}

fn read_study(text: &str) -> Result<End, String> {
    let Ok(study) = frazil_layouts::read::parse(text, "fuzz", Path::new("fuzz.toml"), &[], &parts(false)) else {
        return Ok(End::Unread);
    };
    for layout in &study.layouts {
        let method = layout.scene.methods.first().map_or("", |settings| settings.method);
        if layout.check(study.shaft_radius, method).is_err() {
            return Ok(End::Refused);
        }
    }
    Ok(End::Study)
}

#[derive(Debug, Clone)]
enum Step {
    Key(String),
    Item(usize),
}

/// All places of a value but its own.
fn paths(value: &Value, path: &mut Vec<Step>, found: &mut Vec<Vec<Step>>) {
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

fn at<'a>(value: &'a mut Value, path: &[Step]) -> &'a mut Value {
    path.iter().fold(value, |value, step| match step {
        Step::Key(key) => value.get_mut(key.as_str()).expect("a key"),
        Step::Item(k) => value.get_mut(*k).expect("an item"),
    })
}

fn at_ref<'a>(value: &'a Value, path: &[Step]) -> &'a Value {
    path.iter().fold(value, |value, step| match step {
        Step::Key(key) => value.get(key.as_str()).expect("a key"),
        Step::Item(k) => value.get(*k).expect("an item"),
    })
}

fn delete(parent: &mut Value, last: &Step) {
    match (parent, last) {
        (Value::Table(table), Step::Key(key)) => drop(table.remove(key)),
        (Value::Array(items), Step::Item(k)) => drop(items.remove(*k)),
        _ => {}
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// Another number: of another size or sign or a little off, and seldom of another kind.
fn rescaled(value: &Value, random: &mut StdRng) -> Value {
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

fn misspelt(key: &str, random: &mut StdRng) -> String {
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

fn collect(value: &Value, keys: &mut Vec<String>, values: &mut Vec<Value>) {
    match value {
        Value::Table(table) => {
            for (key, value) in table {
                keys.push(key.clone());
                collect(value, keys, values);
            }
        }
        other => {
            values.push(other.clone());
            if let Value::Array(items) = other {
                items.iter().for_each(|item| collect(item, keys, values));
            }
        }
    }
}

fn pick<'a, T>(items: &'a [T], random: &mut StdRng) -> &'a T {
    &items[random.random_range(0..items.len())]
}

/// Where the last panic was: what is caught says no place.
static PLACE: Mutex<String> = Mutex::new(String::new());

/// Keeps the places of panics in place of printing them, for a process that does nothing else.
#[allow(dead_code)] // Tests share theirs with others.
pub fn keep_places() {
    std::panic::set_hook(Box::new(|panic| {
        if let (Ok(mut place), Some(location)) = (PLACE.lock(), panic.location()) {
            *place = location.to_string();
        }
    }));
}

fn words(panic: &(dyn Any + Send)) -> String {
    let said = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let said = said.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
    format!("{said} ({})", PLACE.lock().map(|place| place.clone()).unwrap_or_default())
}
