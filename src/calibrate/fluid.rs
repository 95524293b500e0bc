//! Fluids as files: what the real one has at each temperature, and what it is made of.

use std::path::Path;

use frazil_cases::fluids;
use frazil_edpd::calibration;
use frazil_scene::names;
use frazil_scene::{Problem, Problems, Range, Read, Section, Units, read_section};
use frazil_studies::failure::Failure;
use frazil_studies::input;

/// A fluid at one temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Temperature (K).
    pub temperature: f64,
    /// Viscosity over self-diffusivity.
    pub schmidt: f64,
    /// Kinematic viscosity (m2/s).
    pub viscosity: Option<f64>,
    /// Viscosity over thermal diffusivity.
    pub prandtl: Option<f64>,
}

/// What a fluid freezes like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Freezing {
    /// Latent heat (J/kg).
    pub latent_heat: f64,
    /// Freezing point (K).
    pub temperature: f64,
    /// Thermal diffusivity frozen over unfrozen.
    pub diffusivity_ratio: f64,
}

/// A fluid.
#[derive(Debug, Clone, PartialEq)]
pub struct Fluid {
    /// Short name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Where the numbers come from, if the file says so.
    pub source: Option<String>,
    /// By increasing temperature; at least one.
    pub rows: Vec<Row>,
    /// Density and heat capacity, if known.
    pub material: Option<calibration::RealFluid>,
    /// How it freezes, if known.
    pub freezing: Option<Freezing>,
}

/// What is wrong with the Schmidt number of a row, if anything.
pub type Judge<'a> = &'a dyn Fn(&Row) -> Option<String>;

/// What a row of a file may hold.
const COLUMNS: [&str; 7] = [
    "temperature_c",
    "temperature_k",
    "schmidt",
    "self_diffusivity_m2_per_s",
    "kinematic_viscosity_m2_per_s",
    "prandtl",
    "thermal_diffusivity_m2_per_s",
];

/// Absolute zero (degrees Celsius).
const ZERO: f64 = -273.15;
/// The warmest temperature, as in scenes.
const WARMEST: f64 = 1e6;
/// Beyond these sizes products of numbers overflow, as in scenes.
const SIZES: Range = Range::between(1e-30, 1e30);

fn range(column: &str) -> Range {
    match column {
        "temperature_c" => Range::above_to(ZERO, WARMEST),
        "temperature_k" => Range::above_to(0.0, WARMEST),
        _ => SIZES,
    }
}

/// There is no such fluid.
#[derive(Debug, thiserror::Error)]
#[error("\"{asked}\" is neither a file nor a bundled fluid; those are {}", known.join(", "))]
struct Unknown {
    asked: String,
    known: Vec<&'static str>,
}

/// Reads a fluid given by a bundled name or the path of a TOML or CSV file; `judge` adds what it has to say of rows.
pub fn load(argument: &str, judge: Judge<'_>) -> Result<Fluid, Failure> {
    if let Some(bundled) = fluids::find(argument) {
        return Ok(from_toml(bundled.text, argument, &format!("{argument}.toml"), judge)?);
    }
    let path = Path::new(argument);
    if !path.exists() && path.extension().is_none() && path.components().count() == 1 {
        return Err(Failure::request(Unknown {
            asked: argument.to_owned(),
            known: fluids::all().iter().map(|fluid| fluid.name).collect(),
        }));
    }
    let text = input::text(path)?;
    let name = path.file_stem().map_or_else(|| "fluid".into(), |stem| names::of(&stem.to_string_lossy()));
    let table = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
    Ok(if table { from_csv(&text, &name, argument, judge)? } else { from_toml(&text, &name, argument, judge)? })
}

/// The cells of a row, in the order of [`COLUMNS`].
type Cells = [Option<f64>; COLUMNS.len()];

/// A row from its cells, and what is wrong with it: key and message.
fn complete(cells: &Cells, before: Option<f64>, judge: Judge<'_>) -> Result<Row, (&'static str, String)> {
    let [celsius, kelvin, schmidt, diffusivity, viscosity, prandtl, thermal] = *cells;
    let beside =
        |one: &'static str, other: &str| Err((one, format!("found beside \"{other}\", must be only one of them")));
    let needs = |one: &'static str| Err((one, "needs \"kinematic_viscosity_m2_per_s\" beside it".to_owned()));
    let missing = |one: &str, other: &str| Err(("", format!("missing, must be given as \"{one}\" or \"{other}\"")));
    let (key, temperature) = match (celsius, kelvin) {
        (Some(celsius), None) => (COLUMNS[0], clean(celsius - ZERO)),
        (None, Some(kelvin)) => (COLUMNS[1], kelvin),
        (Some(_), Some(_)) => return beside(COLUMNS[1], COLUMNS[0]),
        (None, None) => return missing(COLUMNS[0], COLUMNS[1]),
    };
    if let Some(before) = before.filter(|before| temperature <= *before) {
        let shown = |kelvin: f64| if key == COLUMNS[0] { clean(kelvin + ZERO) } else { kelvin };
        let (found, least) = (shown(temperature), shown(before));
        return Err((key, format!("found {found} after {least}, temperatures must increase")));
    }
    let (key, schmidt) = match (schmidt, diffusivity, viscosity) {
        (Some(schmidt), None, _) => (COLUMNS[2], schmidt),
        (None, Some(diffusivity), Some(viscosity)) => (COLUMNS[3], viscosity / diffusivity),
        (None, Some(_), None) => return needs(COLUMNS[3]),
        (Some(_), Some(_), _) => return beside(COLUMNS[3], COLUMNS[2]),
        (None, None, _) => return missing(COLUMNS[2], COLUMNS[3]),
    };
    let prandtl = match (prandtl, thermal, viscosity) {
        (prandtl, None, _) => prandtl,
        (None, Some(thermal), Some(viscosity)) => Some(viscosity / thermal),
        (None, Some(_), None) => return needs(COLUMNS[6]),
        (Some(_), Some(_), _) => return beside(COLUMNS[6], COLUMNS[5]),
    };
    let row = Row { temperature, schmidt, viscosity, prandtl };
    judge(&row).map_or(Ok(row), |message| Err((key, message)))
}

/// A temperature without the rounding that a change of scale leaves, so that limits of ranges compare as written.
fn clean(temperature: f64) -> f64 {
    (temperature * 1e9).round() / 1e9
}

fn from_toml(text: &str, name: &str, file: &str, judge: Judge<'_>) -> Result<Fluid, Problems> {
    read_section(text, file, Units::Si, |root| {
        let (title, source) = (root.text("title"), root.text("source"));
        let rows = toml_rows(root, judge);
        let material = root.optional_section("material").map(|mut own| substance(&mut own)).transpose()?;
        let (material, freezing) = material.unzip();
        let freezing = freezing.flatten();
        Ok(Fluid { name: name.to_owned(), title: title?, source: Some(source?), rows, material, freezing })
    })
}

fn toml_rows(root: &mut Section<'_>, judge: Judge<'_>) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    let sections = root.sections("rows");
    if sections.is_empty() {
        root.problem("rows", "found none, must be a list of at least one row");
    }
    for mut section in sections {
        let mut cells = COLUMNS.map(|key| section.optional_number(key, range(key)));
        let mut whole = true;
        for [one, other] in [[0, 1], [2, 3]] {
            match section.only_one(&[COLUMNS[one].into(), COLUMNS[other].into()]) {
                Ok(found) => cells[if found == 0 { other } else { one }] = None,
                Err(_) => whole = false,
            }
        }
        if !whole {
            continue;
        }
        // What is there and was refused is not missing as well.
        if COLUMNS.iter().zip(&cells).any(|(key, cell)| cell.is_none() && section.has(*key)) {
            continue;
        }
        match complete(&cells, rows.last().map(|row| row.temperature), judge) {
            Ok(row) => rows.push(row),
            Err((key, message)) => {
                if key.is_empty() {
                    section.section_problem(message)
                } else {
                    section.problem(key, message)
                };
            }
        }
    }
    rows
}

fn substance(section: &mut Section<'_>) -> Read<(calibration::RealFluid, Option<Freezing>)> {
    let density = section.number("density_kg_per_m3", SIZES);
    let heat_capacity = section.number("heat_capacity_J_per_kg_K", SIZES);
    if !section.has("latent_heat_J_per_kg") {
        for key in ["freezing_temperature_c", "frozen_diffusivity_ratio"] {
            section.refuse(key, "as there is no \"latent_heat_J_per_kg\"");
        }
    }
    let freezing = section.optional_number("latent_heat_J_per_kg", SIZES).map(|latent_heat| {
        let point = section.number("freezing_temperature_c", range("temperature_c"));
        let diffusivity_ratio = section.number_or("frozen_diffusivity_ratio", 1.0, Range::between(1e-6, 1e6));
        Ok(Freezing { latent_heat, temperature: clean(point? - ZERO), diffusivity_ratio })
    });
    Ok((calibration::RealFluid { density: density?, heat_capacity: heat_capacity? }, freezing.transpose()?))
}

fn from_csv(text: &str, name: &str, file: &str, judge: Judge<'_>) -> Result<Fluid, Problems> {
    let mut problems: Vec<Problem> = Vec::new();
    let rows = csv_rows(text, judge, &mut |line, key: &str, message| {
        problems.push(Problem { key: key.to_owned(), line, set: None, beside: None, message });
    });
    if rows.is_empty() && problems.is_empty() {
        let message = "found no rows, must be a line of column names and at least one row".into();
        problems.push(Problem { key: String::new(), line: None, set: None, beside: None, message });
    }
    if !problems.is_empty() {
        return Err(Problems { file: file.to_owned(), problems });
    }
    Ok(Fluid { name: name.to_owned(), title: name.to_owned(), source: None, rows, material: None, freezing: None })
}

/// Reads rows of comma-separated numbers under a line of names; empty cells are absent ones, and lines that begin with `#` are
/// comments.
fn csv_rows(text: &str, judge: Judge<'_>, refuse: &mut dyn FnMut(Option<usize>, &str, String)) -> Vec<Row> {
    let mut lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'))
        .map(|(index, line)| {
            let cells = line.split(',').map(|cell| cell.trim().trim_matches('"')).collect::<Vec<&str>>();
            (Some(index + 1), cells)
        });
    let Some((at, names)) = lines.next() else { return Vec::new() };
    let mut places = Vec::with_capacity(names.len());
    for (k, name) in names.iter().enumerate() {
        match COLUMNS.iter().position(|column| column == name) {
            None => refuse(at, name, format!("unknown column, known are {}", COLUMNS.join(", "))),
            Some(_) if names[..k].contains(name) => refuse(at, name, "found twice, must be there once".into()),
            Some(place) => places.push(place),
        }
    }
    // Without all names the cells mean nothing.
    if places.len() < names.len() {
        return Vec::new();
    }
    let mut rows: Vec<Row> = Vec::new();
    for (at, texts) in lines {
        if texts.len() != places.len() {
            let message = format!("found {} cells, must be {} as in the line of names", texts.len(), places.len());
            refuse(at, "", message);
            continue;
        }
        let mut cells: Cells = Default::default();
        let mut good = true;
        for (cell, place) in texts.iter().zip(&places).filter(|(cell, _)| !cell.is_empty()) {
            let column = COLUMNS[*place];
            match cell.parse::<f64>() {
                Ok(number) if range(column).contains(number) => cells[*place] = Some(number),
                Ok(_) => refuse(at, column, format!("found {cell}, must be {}", range(column))),
                Err(_) => refuse(at, column, format!("found \"{cell}\", must be a number")),
            }
            good &= cells[*place].is_some();
        }
        if !good {
            continue;
        }
        match complete(&cells, rows.last().map(|row| row.temperature), judge) {
            Ok(row) => rows.push(row),
            Err((key, message)) => refuse(at, key, message),
        }
    }
    rows
}
