//! Scenes, studies and fluids that nobody wrote: bundled ones with keys deleted, copied, renamed, retyped and rescaled, with any key
//! that the reader knows put where it belongs, with sections of others, overrides and broken text. Each is read; some are planned,
//! checked and run for some milliseconds. A case is known by its seed and number alone.

use std::any::Any;
use std::collections::BTreeMap;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use cpu_time::ThreadTime;
use frazil::calibrate::{self, CalibrateRequest, Conduction};
use frazil::parts::parts;
use frazil_core::boundary::condition::Condition;
use frazil_edpd::calibration::Constants;
use frazil_record::{Outcome, RunResult, is_hidden};
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;
use frazil_scene::method::Stepper;
use frazil_scene::read::every_key;
use frazil_simulation::march::{Options, run};
use frazil_simulation::plan;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use toml::{Table, Value};

use crate::counting::most;

#[path = "fuzzed_edits.rs"]
mod edits;

use edits::{Step, at, at_ref, collect, delete, dotted, misspelt, number, odd, paths, pick, rescaled, section, spoilt};

/// Longest that a thread may work on one case.
pub const LONGEST: Duration = Duration::from_secs(2);
/// Most memory that reading a case may take at once (bytes), and most that the rest of it may.
const READING: isize = 64 << 20;
const MAKING: isize = 1 << 30;
/// Longest that what is said of a case may be (letters).
const SAID: usize = 100_000;

/// Particles times neighbours up to which every scene is planned, and up to which one in `RARE` is.
const SMALL: f64 = 3e4;
const LARGE: f64 = 1e6;
const RARE: u32 = 100;

/// One in so many of the scenes that can be planned soon is.
const PLANNED: u32 = 2;

/// One in so many of the scenes that are planned is run, and checked with a trial of its steps.
const RUN: u32 = 8;
const CHECKED: u32 = 50;
/// Wall time that a run is given (s).
const RUN_S: f64 = 0.01;

/// One in so many cases is a study, and one a fluid.
const STUDIES: u32 = 30;
const FLUIDS: u32 = 30;
/// One in so many has broken text, and one is read with an override.
const SPOILT: u32 = 8;
const OVERRIDDEN: u32 = 8;

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Scene,
    Study,
    Fluid,
    /// A fluid as rows.
    Rows,
}

/// A case: a file, and keys that override it.
pub struct Case {
    pub kind: Kind,
    pub text: String,
    pub overrides: Vec<(String, String)>,
}

impl Case {
    /// Where the file would be called so; what overrides it stands in a comment.
    pub fn file(&self) -> String {
        let set: String = self.overrides.iter().map(|(key, value)| format!("# --set {key}={value:?}\n")).collect();
        format!("{set}{}", self.text)
    }

    /// The ending of the file.
    pub fn ending(&self) -> &'static str {
        if self.kind == Kind::Rows { "csv" } else { "toml" }
    }
}

/// What cases are made of.
pub struct Pool {
    scenes: Vec<Table>,
    studies: Vec<Table>,
    fluids: Vec<Table>,
    rows: Vec<&'static str>,
    /// All keys, and values that are no tables, of all sources; values by their keys.
    keys: Vec<String>,
    values: Vec<Value>,
    of: BTreeMap<String, Vec<Value>>,
    /// All keys of scenes that the reader knows, by their sections.
    known: BTreeMap<String, Vec<String>>,
    /// Where fluids, which are read from files, are put.
    place: PathBuf,
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
    /// Planned, tried and forecast, as `check` does.
    Checked,
    /// Run to an end, or as long as it was given.
    Run,
    /// A study that was read.
    Study,
    /// A fluid that was calibrated.
    Fluid,
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
    /// The bundled scenes, with spacings so large that most can be planned soon, studies of few layouts, and fluids, which are put
    /// into a folder one by one.
    pub fn new(folder: &Path) -> Pool {
        let bundled = frazil_cases::scenes::all().iter().chain(frazil_cases::scenes::extreme());
        let texts = bundled.map(|scene| scene.text).chain([include_str!("../cases/bad/region-outside.toml")]);
        let table = |text: &str| text.parse::<Table>().expect("a table");
        let scenes: Vec<Table> = texts.map(|text| coarsened(table(text))).collect();
        let studies: Vec<Table> = frazil_cases::studies::all().iter().map(|study| few(table(study.text))).collect();
        let fluids: Vec<Table> = frazil_cases::fluids::all().iter().map(|fluid| table(fluid.text)).collect();
        let (mut keys, mut values, mut of) = (Vec::new(), Vec::new(), BTreeMap::new());
        for source in scenes.iter().chain(&studies).chain(&fluids) {
            collect(&Value::Table(source.clone()), &mut keys, &mut values, &mut of);
        }
        let mut known: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for (section, key) in every_key(frazil::registry::methods()) {
            keys.push(key.clone());
            known.entry(section).or_default().push(key);
        }
        keys.sort_unstable();
        keys.dedup();
        let rows = vec![include_str!("../cases/bad-fluids/rows.csv"), ROWS];
        Pool { scenes, studies, fluids, rows, keys, values, of, known, place: folder.to_owned() }
    }

    /// A case by its number.
    pub fn case(&self, seed: u64, case: u64) -> Case {
        let mut random = StdRng::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ case);
        let kind = match random.random_range(0..STUDIES * FLUIDS) {
            draw if draw % STUDIES == 0 => Kind::Study,
            draw if draw / STUDIES == 0 => pick(&[Kind::Fluid, Kind::Rows], &mut random).to_owned(),
            _ => Kind::Scene,
        };
        let source = match kind {
            Kind::Scene => &self.scenes,
            Kind::Study => &self.studies,
            Kind::Fluid => &self.fluids,
            Kind::Rows => {
                let text = spoilt(self.rows[random.random_range(0..self.rows.len())], &mut random);
                return Case { kind, text, overrides: Vec::new() };
            }
        };
        let mut file = Value::Table(pick(source, &mut random).clone());
        let edits = 1 + random.random_range(0..8_u32).trailing_ones() as usize;
        for _ in 0..edits {
            self.edit(&mut file, kind, &mut random);
        }
        let mut overrides = Vec::new();
        if random.random_range(0..OVERRIDDEN) == 0 {
            overrides.push(self.overriding(&file, &mut random));
        }
        let mut text = file.as_table().map(Table::to_string).unwrap_or_default();
        if random.random_range(0..SPOILT) == 0 {
            text = spoilt(&text, &mut random);
        }
        Case { kind, text, overrides }
    }

    /// Does one thing to one place of a file.
    fn edit(&self, file: &mut Value, kind: Kind, random: &mut StdRng) {
        let mut places = Vec::new();
        paths(file, &mut Vec::new(), &mut places);
        if places.is_empty() {
            return;
        }
        let place = pick(&places, random).clone();
        let Some((last, parent)) = place.split_last() else { return };
        let tables = || places.iter().filter(|place| at_ref(file, place).is_table()).collect::<Vec<_>>();
        match random.random_range(0..14) {
            0 => delete(at(file, parent), last),
            1 => {
                let copy = at_ref(file, &place).clone();
                match last {
                    Step::Item(_) => at(file, parent).as_array_mut().expect("a list").push(copy),
                    Step::Key(key) => {
                        let tables = tables();
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
            4 | 5 if kind == Kind::Scene => {
                let tables = tables();
                let to = if tables.is_empty() { Vec::new() } else { (*pick(&tables, random)).clone() };
                let Some(known) = self.known.get(&section(&to)) else { return };
                let key = pick(known, random);
                let value = self.value_of(key, random);
                at(file, &to).as_table_mut().expect("a table").insert(key.clone(), value);
            }
            6 if kind == Kind::Scene => {
                let other = pick(&self.scenes, random);
                let keys: Vec<&String> = other.keys().collect();
                let key = *pick(&keys, random);
                file.as_table_mut().expect("a table").insert(key.clone(), other[key].clone());
            }
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

    /// A key of a file, or one that the reader knows, with a value as `--set` has it.
    fn overriding(&self, file: &Value, random: &mut StdRng) -> (String, String) {
        let mut places = Vec::new();
        paths(file, &mut Vec::new(), &mut places);
        let key = if places.is_empty() || random.random_range(0..4) == 0 {
            let sections: Vec<&String> = self.known.keys().collect();
            let section = *pick(&sections, random);
            let key = pick(&self.known[section], random);
            if section.is_empty() { key.clone() } else { format!("{section}.{key}") }
        } else {
            dotted(&places[random.random_range(0..places.len())])
        };
        let value = self.value(random).to_string();
        (key, if random.random_range(0..4) == 0 { spoilt(&value, random) } else { value })
    }

    /// A value of a file, or one that is odd.
    fn value(&self, random: &mut StdRng) -> Value {
        if random.random() { pick(&self.values, random).clone() } else { odd(random) }
    }

    /// A value of a key, as some file has it or rescaled, where one has it.
    fn value_of(&self, key: &str, random: &mut StdRng) -> Value {
        match self.of.get(key) {
            Some(values) if random.random_range(0..4) != 0 => {
                let value = pick(values, random);
                if number(value).is_some() && random.random() { rescaled(value, random) } else { value.clone() }
            }
            _ => self.value(random),
        }
    }

    /// Makes a case, and says how it ended or what must not happen.
    pub fn end(&self, seed: u64, number: u64) -> Result<End, Box<Finding>> {
        let case = self.case(seed, number);
        let began = ThreadTime::now();
        let (found, held) = most(|| {
            catch_unwind(AssertUnwindSafe(|| match case.kind {
                Kind::Scene => through(&case, seed, number),
                Kind::Study => read_study(&case),
                Kind::Fluid | Kind::Rows => self.calibrate(&case),
            }))
        });
        let took = began.elapsed();
        let what = match found {
            Err(panic) => format!("panic: {}", words(panic.as_ref())),
            Ok(Err(what)) => what,
            Ok(Ok(end)) if took > LONGEST => format!("took {:.1} s ({end:?})", took.as_secs_f64()),
            Ok(Ok(end)) if held > MAKING => format!("took {} MiB ({end:?})", held >> 20),
            Ok(Ok(end)) => return Ok(end),
        };
        Err(Box::new(Finding { what, text: case.file() }))
    }

    /// Calibrates a fluid, which is read from a file.
    fn calibrate(&self, case: &Case) -> Result<End, String> {
        let file = self.place.join(format!("fuzz.{}", case.ending()));
        fs::write(&file, &case.text).map_err(|error| error.to_string())?;
        let request = CalibrateRequest {
            fluid: file.display().to_string(),
            constants: Constants::paper(),
            reference_temperature: 300.0,
            conduction: Conduction::Fluid,
            from: None,
            to: None,
            out: None,
        };
        let (solved, held) = most(|| calibrate::solve(&request));
        let held = if held > READING { Err(format!("reading took {} MiB", held >> 20)) } else { Ok(()) };
        held.and(match solved {
            Ok(solved) => finite(&format!("{:?}", solved.table.rows)).map(|()| End::Fluid),
            Err(failure) => told(&failure.to_string(), &request.fluid).map(|()| End::Unread),
        })
    }
}

/// Rows of a fluid that are well.
const ROWS: &str = "temperature_c,schmidt,kinematic_viscosity_m2_per_s,prandtl\n0,1619.74,1.79e-6,13.5\n10,890.1,1.31e-6,9.4\n\
                    20,520.2,1.0e-6,7.0\n30,320.5,0.8e-6,5.4\n40,210,0.66e-6,4.3\n";

/// A study of two of whatever it has many.
fn few(mut file: Table) -> Table {
    for key in ["sweep", "critical"] {
        let lists = file.get_mut(key).and_then(Value::as_table_mut).into_iter().flat_map(|table| table.iter_mut());
        lists.filter_map(|(_, value)| value.as_array_mut()).for_each(|list| list.truncate(2));
    }
    if let Some(deviation) = file.get_mut("deviation").and_then(Value::as_table_mut) {
        deviation.insert("members".into(), Value::Integer(2));
    }
    if let Some(layouts) = file.get_mut("layouts").and_then(Value::as_array_mut) {
        layouts.truncate(2);
    }
    file
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

/// Whether a refusal says something, in a length that can be read and with a place on its first line, and nothing that is not seen.
fn told(said: &str, file: &str) -> Result<(), String> {
    let shown = |letter: char| letter == '\n' || !is_hidden(letter);
    match said {
        _ if said.trim().is_empty() => Err("refused without a word".into()),
        _ if said.len() > SAID => Err(format!("refused with {} letters", said.len())),
        _ if !said.chars().all(shown) => Err(format!("says what is not seen: {said:?}")),
        _ if !(said.starts_with(file) || said.starts_with("--set") || said.starts_with(&format!("\"{file}"))) => {
            Err(format!("refused without a place: {said}"))
        }
        _ if said.lines().any(|line| line.trim().is_empty()) => Err(format!("says an empty line: {said:?}")),
        _ => Ok(()),
    }
}

/// Whether the planner's refusal says something.
fn refused(said: &str) -> Result<End, String> {
    let shown = |letter: char| letter == '\n' || !is_hidden(letter);
    let well = !said.trim().is_empty() && said.len() < SAID && said.chars().all(shown);
    if well { Ok(End::Refused) } else { Err(format!("refused with {said:?}")) }
}

/// Reads a scene and takes it as far as it costs little.
fn through(case: &Case, seed: u64, number: u64) -> Result<End, String> {
    let read = || Scene::read(&case.text, "fuzz", "fuzz.toml", &case.overrides, frazil::registry::methods());
    let (scene, held) = most(read);
    if held > READING {
        return Err(format!("reading took {} MiB", held >> 20));
    }
    let scene = match scene {
        Ok(scene) => scene,
        Err(problems) => return told(&problems.to_string(), "fuzz.toml").map(|()| End::Unread),
    };
    let mut random = StdRng::seed_from_u64(seed ^ !number);
    let settings = pick(&scene.methods, &mut random);
    let size = size(&scene, settings);
    // Particles that move are left to themselves before the first step, in proportion to the steps of their run: a check does not.
    let moves = matches!(settings.discretisation.stepper, Stepper::Moving(_));
    let costly = size > SMALL || moves;
    if size > LARGE || (costly && random.random_range(0..RARE) != 0) {
        return Ok(End::Read);
    }
    if random.random_range(0..PLANNED) != 0 {
        return Ok(End::Read);
    }
    // Closed forms and tables take longer than most plans.
    let referred =
        scene.walls.iter().any(|wall| wall.condition == Condition::Exact) || random.random_range(0..RUN) == 0;
    let reference = match if referred { frazil::run::reference(&scene) } else { Ok(None) } {
        Ok(reference) => reference,
        Err(failure) => return refused(&failure.to_string()),
    };
    let draw = random.random_range(0..RUN * CHECKED);
    if draw % CHECKED == 0 || moves {
        return match frazil::check::planned(&scene, settings.method, reference.as_ref(), 1, random.random()) {
            Ok((_, said)) => finite(&said).map(|()| End::Checked),
            Err(failure) => refused(&failure.to_string()),
        };
    }
    if draw % RUN == 0 {
        let options = Options { time_limit_s: Some(RUN_S), fields: random.random(), ..Options::default() };
        return match run(&scene, settings.method, reference.as_ref(), &options) {
            Ok(result) if result.record.outcome == Outcome::Ok => {
                finite(&numbers(result)).map(|()| End::Run).map_err(|what| format!("ok, but {what}"))
            }
            Ok(_) => Ok(End::Run),
            Err(failure) => refused(&failure.to_string()),
        };
    }
    match plan::build(&scene, settings, reference.as_ref(), 1, 1) {
        Ok(_) => Ok(End::Planned),
        Err(failure) => refused(&failure.to_string()),
    }
}

/// All numbers of a result but maps, which have none outside the body.
fn numbers(mut result: RunResult) -> String {
    result.fields.clear();
    // Words are not numbers, whatever they say.
    result.record.title.clear();
    result.record.remarks.clear();
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

fn read_study(case: &Case) -> Result<End, String> {
    let read =
        || frazil_layouts::read::parse(&case.text, "fuzz", Path::new("fuzz.toml"), &case.overrides, &parts(false));
    let (study, held) = most(read);
    if held > READING {
        return Err(format!("reading took {} MiB", held >> 20));
    }
    let study = match study {
        Ok(study) => study,
        Err(failure) => return told(&failure.to_string(), "fuzz.toml").map(|()| End::Unread),
    };
    for layout in &study.layouts {
        let method = layout.scene.methods.first().map_or("", |settings| settings.method);
        if let Err(failure) = layout.check(study.shaft_radius, method) {
            return refused(&failure.to_string());
        }
    }
    Ok(End::Study)
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
