//! Reference tables of layouts of freeze pipes: the days on which gaps close, and the frozen wall on some days.

use frazil_scene::Scene;

use crate::shaft::{PIPES, RING_RADIUS, shaft_differences};
use crate::shells::cubic;
use crate::soils::{CLAY, CLAY_TENTH, SAND, Soil};
use crate::{BadTable, Unfit, groundwater};

/// The table of one ring in sand with pipes of any radius that the others have.
pub const BY_RADIUS: &str = "shaft-single-sand-by-radius";

/// Estimated error of a radius of the wall (m).
pub const RADIUS_ERROR: f64 = 0.01;
/// Of a frozen length (m).
pub const LENGTH_ERROR: f64 = 0.02;
/// Of a mean temperature (K).
pub const TEMPERATURE_ERROR: f64 = 0.03;
/// Of heat, relative.
pub const HEAT_ERROR: f64 = 1e-3;

/// Where frozen bodies join.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gap {
    /// Anywhere half-way between two pipes of one ring.
    Touch,
    /// In the middle of the arc between two outer pipes.
    CircleOuter,
    /// In the middle of the arc between two inner pipes, on the plane through an outer one.
    CircleInnerMain,
    /// In the middle of the arc between two inner pipes, on the plane half-way between two outer ones.
    CircleInnerInterface,
    /// Between an outer and an inner pipe.
    Zigzag,
    /// Between two pipes of one ring, on either side so far around it (degrees) from where groundwater leaves it.
    FromDownstream(f64),
}

impl Gap {
    const NAMED: [(&'static str, Gap); 5] = [
        ("touch", Gap::Touch),
        ("circle_outer", Gap::CircleOuter),
        ("circle_inner_main", Gap::CircleInnerMain),
        ("circle_inner_interface", Gap::CircleInnerInterface),
        ("zigzag", Gap::Zigzag),
    ];

    /// Its name in tables.
    pub fn name(self) -> String {
        match self {
            Gap::FromDownstream(degrees) => format!("from_downstream_{degrees:.0}_deg"),
            named => {
                Gap::NAMED.iter().find(|(_, gap)| *gap == named).map_or_else(String::new, |(name, _)| (*name).into())
            }
        }
    }
}

/// When a gap closes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closure {
    /// The gap.
    pub gap: Gap,
    /// Day.
    pub day: f64,
    /// Estimated error (d).
    pub error: Option<f64>,
}

/// A plane of the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// First and last frozen radius (m).
    pub ends: Option<(f64, f64)>,
    /// Frozen length (m).
    pub length: f64,
    /// Mean temperature between both ends (C), pipes included.
    pub mean: Option<f64>,
}

/// The wall on a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallDay {
    /// Day.
    pub day: f64,
    /// Through an outer pipe.
    pub main: Section,
    /// Half-way between two outer pipes.
    pub interface: Section,
    /// Frozen area of the whole ring without pipes (m2).
    pub area: f64,
    /// Its mean temperature (C).
    pub mean: f64,
    /// Heat taken by a pipe, mean over all (W/m).
    pub heat_per_pipe: f64,
    /// Heat taken by all pipes since the start (MJ/m).
    pub energy: f64,
}

/// What is known of a layout.
#[derive(Debug, Clone, PartialEq)]
pub struct LayoutTable {
    /// Name of the table.
    pub name: String,
    /// Gaps.
    pub closures: Vec<Closure>,
    /// Days.
    pub days: Vec<WallDay>,
}

/// A ring: number of pipes, radius (m), first angle (degrees).
type Ring = (usize, f64, f64);

/// Rings of the inner pipes beside the outer ring of [`PIPES`] on [`RING_RADIUS`].
const INNER: [(&str, Option<Ring>); 3] = [
    ("single", None),
    ("three", Some((PIPES, 4.2, 180.0 / PIPES as f64))),
    ("four", Some((2 * PIPES, 4.2, 90.0 / PIPES as f64))),
];

const SOILS: [(&str, &Soil); 3] = [("sand", &SAND), ("clay", &CLAY), ("clay10", &CLAY_TENTH)];

const CLOSURES: &str = include_str!("tables/shaft-closures.csv");
const DAYS: &str = include_str!("tables/shaft-layouts.csv");

/// Names of all tables of layouts.
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<&str> = lines(CLOSURES).skip(1).filter_map(|line| line.split(',').next()).collect();
    names.dedup();
    names.extend([BY_RADIUS, groundwater::NAME]);
    names
}

/// The table of the given name. `acting` is the radius (m) as which a pipe of one particle acts there.
///
/// # Errors
///
/// If there is none, or it is not about the problem of the scene.
pub fn by_name(name: &str, scene: &Scene, acting: Option<f64>) -> Result<LayoutTable, Unfit> {
    if !names().contains(&name) {
        return Err(Unfit::UnknownLayout { name: name.into(), known: names() });
    }
    if name == groundwater::NAME {
        let closures = groundwater::closures(scene)?;
        return Ok(LayoutTable { name: name.into(), closures, days: Vec::new() });
    }
    // shaft-KIND-SOIL-RADIUSmm
    let mut parts = name.splitn(4, '-').skip(1);
    let mut part = || parts.next().unwrap_or_default();
    let (kind, soil, radius) = (part(), part(), part());
    let wrong = || Unfit::NoLayout(name.into());
    let inner = INNER.iter().find(|(own, _)| *own == kind).ok_or_else(wrong)?.1;
    let soil = SOILS.iter().find(|(own, _)| *own == soil).ok_or_else(wrong)?.1;
    let radius = radius.strip_suffix("mm").and_then(|text| text.parse::<f64>().ok()).map(|radius| 1e-3 * radius);
    let rings: Vec<Ring> = [Some((PIPES, RING_RADIUS, 0.0)), inner].into_iter().flatten().collect();
    if let Some(first) = shaft_differences(soil, &rings, radius, false, scene).into_iter().next() {
        return Err(Unfit::another(name, vec![first]));
    }
    let counts = (PIPES as f64, inner.map_or(0.0, |inner| inner.0 as f64));
    if name == BY_RADIUS {
        let radius = scene.rings.first().map_or(0.0, |ring| ring.pipe_radius);
        let closures = by_radius(acting.unwrap_or(radius))?;
        return Ok(LayoutTable { name: name.into(), closures, days: Vec::new() });
    }
    Ok(LayoutTable { name: name.into(), closures: closures(name)?, days: days(name, counts)? })
}

fn lines(text: &'static str) -> impl Iterator<Item = &'static str> {
    text.lines().filter(|line| !line.starts_with('#'))
}

/// Rows of a table, in their order; empty cells are none.
fn rows(text: &'static str, name: &str) -> Result<Vec<Vec<&'static str>>, BadTable> {
    let cells = lines(text).skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    let found: Vec<_> = cells.filter(|cells| cells[0] == name).collect();
    let width = lines(text).next().map_or(0, |head| head.split(',').count());
    match found.iter().all(|cells| cells.len() == width) {
        true => Ok(found),
        false => Err(BadTable::Width { table: name.into(), width }),
    }
}

fn number(cell: &str) -> Result<Option<f64>, BadTable> {
    if cell.is_empty() {
        return Ok(None);
    }
    cell.parse().map(Some).map_err(|_| BadTable::Cell(cell.into()))
}

fn closures(name: &str) -> Result<Vec<Closure>, BadTable> {
    let closure = |cells: Vec<&str>| {
        let gap = Gap::NAMED.iter().find(|(own, _)| *own == cells[1]).map(|(_, gap)| *gap);
        let gap = gap.ok_or_else(|| BadTable::NoGap(cells[1].into()))?;
        let day = number(cells[2])?.ok_or(BadTable::NoDay)?;
        Ok(Closure { gap, day, error: number(cells[3])? })
    };
    rows(CLOSURES, name)?.into_iter().map(closure).collect()
}

/// Closure of the single ring in sand by the radius of its pipes, by the cubic through the logarithms of four radii; empty
/// outside all radii.
fn by_radius(radius: f64) -> Result<Vec<Closure>, BadTable> {
    let mut known: Vec<(f64, Vec<Closure>)> = Vec::new();
    for name in names() {
        let radius = name.strip_prefix("shaft-single-sand-").and_then(|rest| rest.strip_suffix("mm"));
        if let Some(radius) = radius.and_then(|text| text.parse::<f64>().ok()) {
            known.push(((1e-3 * radius).ln(), closures(name)?));
        }
    }
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let places: Vec<f64> = known.iter().map(|(place, _)| *place).collect();
    let mut found = Vec::new();
    for gap in [Gap::Touch, Gap::CircleOuter] {
        let of = |closures: &Vec<Closure>| closures.iter().find(|closure| closure.gap == gap).copied();
        let at: Vec<Closure> = known.iter().filter_map(|(_, closures)| of(closures)).collect();
        let days: Vec<f64> = at.iter().map(|closure| closure.day).collect();
        let after = places.partition_point(|place| *place < radius.ln());
        let beside = at.iter().take(after + 1).skip(after.saturating_sub(1));
        let error = beside.filter_map(|closure| closure.error).reduce(f64::max);
        found.extend(cubic(&places, &days, radius.ln()).map(|day| Closure { gap, day, error }));
    }
    Ok(found)
}

fn days(name: &str, (outer, inner): (f64, f64)) -> Result<Vec<WallDay>, BadTable> {
    let day = |cells: Vec<&str>| {
        let at = |column: usize| number(cells[column]);
        let empty = |column: usize| BadTable::EmptyCell { table: name.into(), column };
        let needed = |column: usize| at(column)?.ok_or_else(|| empty(column));
        let section = |first: usize| {
            let ends = at(first)?.zip(at(first + 1)?);
            Ok::<_, BadTable>(Section { ends, length: needed(first + 2)?, mean: at(first + 3)? })
        };
        let both = |first: usize| {
            Ok::<_, BadTable>(outer * needed(first)? + if inner > 0.0 { inner * needed(first + 2)? } else { 0.0 })
        };
        Ok(WallDay {
            day: needed(1)?,
            main: section(2)?,
            interface: section(6)?,
            // Half a spacing of the outer pipes is known.
            area: 2.0 * outer * needed(10)?,
            mean: needed(11)?,
            heat_per_pipe: both(12)? / (outer + inner),
            energy: both(13)?,
        })
    };
    rows(DAYS, name)?.into_iter().map(day).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_reads() {
        for name in names() {
            if [BY_RADIUS, groundwater::NAME].contains(&name) {
                continue;
            }
            let closures = closures(name).unwrap_or_else(|error| unreachable!("{name}: {error}"));
            assert!(!closures.is_empty(), "{name}");
            let days = days(name, (26.0, 0.0)).unwrap_or_else(|error| unreachable!("{name}: {error}"));
            assert!(days.windows(2).all(|pair| pair[0].day < pair[1].day && pair[0].energy < pair[1].energy), "{name}");
        }
    }

    /// The same solution stands in the tables of scenes.
    #[test]
    fn tables_of_layouts_are_those_of_scenes() {
        for case in &crate::shaft::SHAFT_CASES {
            let table = crate::shaft::ShaftTable::bundled(case).unwrap_or_else(|error| unreachable!("{error}"));
            let touch = closures(case.name).unwrap_or_default()[0].day;
            let event = frazil_simulation::reference::Reference::event(&table, "closure_day");
            assert!((event.unwrap_or(0.0) / 86_400.0 - touch).abs() < 1e-9, "{}", case.name);
            let last = days(case.name, (26.0, 0.0)).unwrap_or_default()[5];
            let heat = table.heat_per_pipe(last.day * 86_400.0).unwrap_or(0.0);
            assert!((heat / last.heat_per_pipe - 1.0).abs() < 1e-5, "{}: {heat}", case.name);
        }
    }

    /// Between radii that are left out of the cubic closure is that of their own tables, to their errors and to what
    /// four neighbours cannot tell.
    #[test]
    fn closure_by_radius_passes_through_the_tables() {
        let touch = |radius: f64| by_radius(radius).unwrap_or_default().first().map(|closure| closure.day);
        assert_eq!(touch(0.054).map(|day| (day * 1e3).round()), Some(15398.0));
        let between = touch(0.007).unwrap_or(0.0);
        assert!(between > 34.016 && between < 39.75, "{between}");
        assert_eq!(touch(0.000_9), None);
        assert_eq!(touch(0.11), None);
    }
}
