//! Reference tables of bodies of axial and spherical symmetry (Nikolaev et al. 2023, section 3).

use std::collections::BTreeMap;

use frazil_core::boundary::condition::Condition;
use frazil_core::physics::film::FilmKind;
use frazil_core::physics::material::FreezingLaw;
use frazil_core::space::domain::Domain;
use frazil_core::space::symmetry::Symmetry;
use frazil_core::space::wall::WallId;
use frazil_record::ReferenceInfo;
use frazil_scene::region::{Cell, Region, Shape};
use frazil_scene::{Scene, Units};
use frazil_simulation::reference::{Cut, Reference};

use crate::exact::line_sink::LineSink;
use crate::table::{NumberTable, compare, compare_material, interpolate, note};
use crate::{BadTable, Unfit};

/// What happens at a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ShellWall {
    Closed,
    /// Temperature (C).
    Held(f64),
    /// Flux into the body (W/m2).
    Flux(f64),
    /// Film coefficient (W/m2K) and temperature (C) of the surroundings.
    Film(f64, f64),
}

/// A material: density, frozen and unfrozen conductivity and heat capacity, latent heat.
struct ShellMaterial {
    density: f64,
    frozen: (f64, f64),
    unfrozen: (f64, f64),
    latent_heat: Option<f64>,
}

const STEEL: ShellMaterial =
    ShellMaterial { density: 7850.0, frozen: (50.0, 420.0), unfrozen: (50.0, 420.0), latent_heat: None };
const COPPER: ShellMaterial =
    ShellMaterial { density: 8920.0, frozen: (400.0, 385.0), unfrozen: (400.0, 385.0), latent_heat: None };
const WATER: ShellMaterial =
    ShellMaterial { density: 1000.0, frozen: (2.14, 2060.0), unfrozen: (0.6, 4182.0), latent_heat: Some(333e3) };

/// One body for which there is a table.
struct Case {
    name: &'static str,
    material: ShellMaterial,
    domain: Domain,
    initial: f64,
    walls: &'static [(WallId, ShellWall)],
    /// Parts of walls: wall, from, to.
    parts: &'static [(WallId, f64, f64, ShellWall)],
    /// Boxes that start at temperatures (C) of their own: least and greatest r, least and greatest z.
    regions: &'static [([f64; 4], f64)],
    profiles: &'static str,
    /// Whether profiles are smooth, so that a cubic runs through them.
    smooth: bool,
    /// Name of a column and the series that holds it over time.
    series: Option<(&'static str, &'static str)>,
    source: &'static str,
    error_estimate_rel: f64,
    /// Errors of the front (m) and of temperatures (K), where the one above is of something else.
    errors: (Option<f64>, Option<f64>),
}

/// A thick pipe, of which walls and profiles are left open: what most bodies have.
const PIPE: Case = Case {
    name: "",
    material: STEEL,
    domain: Domain::Radial { symmetry: Symmetry::Axial, inner: 0.05, outer: 1.5 },
    initial: 226.85,
    walls: &[],
    parts: &[],
    regions: &[],
    profiles: "",
    smooth: true,
    series: None,
    source: "extrapolated finite volumes, within 3e-6 K of Chebyshev collocation",
    error_estimate_rel: 2e-8,
    errors: (None, None),
};

static CASES: [Case; 7] = [
    Case {
        name: "thick-pipe-temperature",
        walls: &[(WallId::Inner, ShellWall::Held(26.85)), (WallId::Outer, ShellWall::Held(26.85))],
        profiles: include_str!("tables/thick-pipe-temperature.csv"),
        ..PIPE
    },
    Case {
        name: "thick-pipe-flux",
        walls: &[(WallId::Inner, ShellWall::Flux(-1e4)), (WallId::Outer, ShellWall::Flux(-1e4))],
        profiles: include_str!("tables/thick-pipe-flux.csv"),
        ..PIPE
    },
    Case {
        name: "thick-pipe-convection",
        walls: &[(WallId::Inner, ShellWall::Film(500.0, 26.85)), (WallId::Outer, ShellWall::Film(500.0, 26.85))],
        profiles: include_str!("tables/thick-pipe-convection.csv"),
        ..PIPE
    },
    Case {
        name: "copper-sphere",
        material: COPPER,
        domain: Domain::Radial { symmetry: Symmetry::Spherical, inner: 0.0, outer: 0.1 },
        initial: 726.85,
        walls: &[(WallId::Outer, ShellWall::Held(26.85))],
        profiles: include_str!("tables/copper-sphere.csv"),
        source: "closed-form series",
        error_estimate_rel: 1e-9,
        ..PIPE
    },
    Case {
        name: "freezing-annulus",
        material: WATER,
        domain: Domain::Radial { symmetry: Symmetry::Axial, inner: 0.1, outer: 1.1 },
        initial: 8.0,
        walls: &[(WallId::Inner, ShellWall::Flux(-1000.0)), (WallId::Outer, ShellWall::Held(8.0))],
        profiles: include_str!("tables/freezing-annulus.csv"),
        smooth: false,
        series: Some(("front_m", include_str!("tables/freezing-annulus-front.csv"))),
        source: "sharp front, each phase on its own moving grid; front known to 2e-5 m, temperature to 0.07 K",
        error_estimate_rel: 1e-4,
        errors: (Some(2e-5), Some(0.07)),
        ..PIPE
    },
    Case {
        name: "heated-hollow-cylinder",
        domain: Domain::Axial { inner: 0.2, outer: 1.0, height: 0.8 },
        initial: -73.15,
        walls: &[
            (WallId::Inner, ShellWall::Closed),
            (WallId::Outer, ShellWall::Closed),
            (WallId::Bottom, ShellWall::Closed),
            (WallId::Top, ShellWall::Closed),
        ],
        parts: &[(WallId::Outer, 0.3, 0.5, ShellWall::Held(226.85))],
        profiles: include_str!("tables/heated-hollow-cylinder.csv"),
        source: "extrapolated finite volumes; temperature known to 0.15 K up to r = 0.95 m, to 0.6 K beyond",
        error_estimate_rel: 5e-4,
        ..PIPE
    },
    Case {
        name: "ice-in-glass",
        material: WATER,
        domain: Domain::Axial { inner: 0.0, outer: 0.1, height: 0.1 },
        initial: 100.0,
        walls: &[
            (WallId::Outer, ShellWall::Closed),
            (WallId::Bottom, ShellWall::Closed),
            (WallId::Top, ShellWall::Closed),
        ],
        regions: &[([0.0, 0.04, 0.0, 0.04], -5.0)],
        profiles: include_str!("tables/ice-in-glass.csv"),
        smooth: false,
        series: Some(("frozen_volume_m3", include_str!("tables/ice-in-glass-volume.csv"))),
        source: "extrapolated enthalpy finite volumes; temperature known to 0.16 K, volume to 0.002 of the first",
        error_estimate_rel: 2e-3,
        errors: (None, Some(0.16)),
        ..PIPE
    },
];

/// Names of the tables.
pub fn names() -> impl Iterator<Item = &'static str> {
    CASES.iter().map(|case| case.name)
}

/// The table of the given name, if there is one.
///
/// # Errors
///
/// If it is not about the physics of the scene.
pub fn by_name(name: &str, scene: &Scene) -> Option<Result<Box<dyn Reference>, Unfit>> {
    let case = CASES.iter().find(|case| case.name == name)?;
    let table = || -> Result<Box<dyn Reference>, Unfit> {
        Unfit::unless_same(name, case.differences(scene))?;
        Ok(Box::new(ShellTable::new(case, scene)?))
    };
    Some(table())
}

impl Case {
    /// What about a scene is not as in the table.
    fn differences(&self, scene: &Scene) -> Vec<String> {
        let mut differences = Vec::new();
        note(&mut differences, &[(scene.units != Units::Si, "units are si there")]);
        if !same_body(&self.domain, &scene.domain) {
            differences.push("the body is another one there".into());
            return differences;
        }
        let mixed = scene.regions.iter().any(|region| region.material.is_some_and(|material| material != 0));
        let own = scene.materials.first().filter(|_| !mixed);
        let material = &self.material;
        compare_material(&mut differences, own, material.density, [material.frozen, material.unfrozen]);
        let mut number = |what: &str, own: Option<f64>, expected: f64| compare(&mut differences, what, own, expected);
        number("the initial temperature", Some(scene.initial_temperature), self.initial);
        let law = match material.latent_heat {
            None => FreezingLaw::None,
            Some(latent_heat) => {
                number("the latent heat", own.map(|own| own.latent_heat), latent_heat);
                number("the freezing point", own.map(|own| own.freezing_point), 0.0);
                FreezingLaw::Isothermal
            }
        };
        let is_other = own.is_some_and(|own| own.law != law);
        note(&mut differences, &[(is_other, "the law of freezing is another one there")]);
        for (name, wall) in self.walls {
            if !scene.wall(*name).is_some_and(|condition| wall.is(condition)) {
                differences.push(format!("the wall {name} has another condition there"));
            }
        }
        let colder = |(own, (extent, expected)): (&Region, &([f64; 4], f64))| {
            let same = |Cell { low, high }: &Cell| {
                let extents = [low.x, high.x, low.y, high.y].into_iter().zip(*extent);
                extents.into_iter().all(|(own, expected)| close(own, expected))
            };
            own.temperature.is_some_and(|own| close(own, *expected))
                && matches!(&own.shape, Shape::Box(own) if same(own))
        };
        let regions: Vec<&Region> = scene.regions.iter().filter(|region| region.temperature.is_some()).collect();
        if regions.len() != self.regions.len() || !regions.into_iter().zip(self.regions).all(colder) {
            differences.push("regions start at other temperatures there".into());
        }
        let parts = &scene.wall_parts;
        let same = |(own, expected): (&frazil_scene::WallPart, &(WallId, f64, f64, ShellWall))| {
            own.wall == expected.0
                && close(own.from, expected.1)
                && close(own.to, expected.2)
                && expected.3.is(&own.condition)
        };
        if parts.len() != self.parts.len() || !parts.iter().zip(self.parts).all(same) {
            differences.push("walls have other parts there".into());
        }
        differences
    }
}

impl ShellWall {
    fn is(self, condition: &Condition) -> bool {
        match (self, condition) {
            (ShellWall::Closed, Condition::Symmetry) => true,
            (ShellWall::Held(expected), Condition::Temperature(series))
            | (ShellWall::Flux(expected), Condition::Flux(series)) => {
                series.constant().is_some_and(|own| close(own, expected))
            }
            (ShellWall::Film(film, expected), Condition::Film { kind: FilmKind::Convection, strength, ambient }) => {
                strength.constant().is_some_and(|own| close(own, film))
                    && ambient.constant().is_some_and(|own| close(own, expected))
            }
            _ => false,
        }
    }
}

fn close(own: f64, expected: f64) -> bool {
    (own - expected).abs() <= 1e-6 * expected.abs().max(1e-6)
}

fn same_body(a: &Domain, b: &Domain) -> bool {
    match (*a, *b) {
        (
            Domain::Radial { symmetry, inner, outer },
            Domain::Radial { symmetry: other, inner: b_inner, outer: b_outer },
        ) => symmetry == other && close(b_inner, inner) && close(b_outer, outer),
        (
            Domain::Axial { inner, outer, height },
            Domain::Axial { inner: b_inner, outer: b_outer, height: b_height },
        ) => close(b_inner, inner) && close(b_outer, outer) && close(b_height, height),
        _ => false,
    }
}

/// Profiles at instants, and a front or a frozen volume over time.
struct ShellTable {
    source: String,
    error_estimate_rel: f64,
    smooth: bool,
    places: Vec<f64>,
    /// Cut (none along the radius), time (s) and temperatures of each profile.
    profiles: Vec<(Option<Cut>, f64, Vec<f64>)>,
    /// A line sink of the same power as a wall that takes a flux.
    beside: Option<LineSink>,
    /// Times (s), and radii of the front (m) or volumes (m3).
    series: Option<(&'static str, Vec<f64>, Vec<f64>)>,
    /// Radius (m) from which a front starts.
    front_start: Option<f64>,
    /// Errors of measures that are known better or worse than the one above, in their terms.
    errors: BTreeMap<String, f64>,
}

impl ShellTable {
    fn new(case: &Case, scene: &Scene) -> Result<Self, BadTable> {
        let table = NumberTable::read(case.profiles)?;
        let mut profiles = Vec::new();
        for name in table.names().iter().skip(1) {
            let wrong = || BadTable::Unnamed { column: name.clone(), what: "cut and instant" };
            let (plane, time) = name.split_once('@').ok_or_else(wrong)?;
            let cut = match plane.contains('=') {
                false => None,
                true => Some(Cut::named(plane).ok_or_else(wrong)?),
            };
            profiles.push((cut, time.parse().map_err(|_| wrong())?, table.column(name)?.to_vec()));
        }
        let series = match case.series {
            None => None,
            Some((column, text)) => {
                let table = NumberTable::read(text)?;
                Some((column, table.column("time_s")?.to_vec(), table.column(column)?.to_vec()))
            }
        };
        let beside = match (case.domain, case.walls.first()) {
            (Domain::Radial { symmetry: Symmetry::Axial, inner, .. }, Some((_, ShellWall::Flux(flux)))) => scene
                .materials
                .first()
                .filter(|material| material.is_sharp())
                .map(|material| LineSink::new(material, case.initial, -flux * Symmetry::Axial.area(inner))),
            _ => None,
        };
        let mut errors = BTreeMap::new();
        let front_start = match (&series, case.domain) {
            (Some(("front_m", times, radii)), Domain::Radial { inner, .. }) => {
                // Over how far the front has come once it is judged.
                let judged = times.partition_point(|time| *time < scene.watch.front_from.unwrap_or(0.0));
                let radius = radii.get(judged).copied().unwrap_or(f64::NAN);
                errors.extend(case.errors.0.map(|error| ("front".to_owned(), error / (radius - inner))));
                Some(inner)
            }
            _ => None,
        };
        if let Some(kelvin) = case.errors.1 {
            let (mut least, mut greatest) = scene.temperature_range();
            if scene.has_flux() {
                // A flux drives temperatures beyond the data, and errors are over what it makes of them.
                let all = profiles.iter().flat_map(|(.., temperatures): &(_, f64, Vec<f64>)| temperatures);
                (least, greatest) = all.fold((least, greatest), |(low, high), t| (low.min(*t), high.max(*t)));
            }
            errors.insert("temperature".to_owned(), kelvin / (greatest - least));
        }
        Ok(ShellTable {
            beside,
            front_start,
            errors,
            source: format!("table {}: {}", case.name, case.source),
            error_estimate_rel: case.error_estimate_rel,
            smooth: case.smooth,
            places: table.column("place_m")?.to_vec(),
            profiles,
            series,
        })
    }

    /// Known at the instants of the profiles alone.
    fn profile(&self, cut: Option<Cut>, x: f64, t: f64) -> Option<f64> {
        let same = |own: &&(Option<Cut>, f64, Vec<f64>)| own.0 == cut && (own.1 - t).abs() < 1e-9 * t;
        let values = &self.profiles.iter().find(same)?.2;
        if self.smooth { cubic(&self.places, values, x) } else { interpolate(&self.places, values, x) }
    }

    fn over_time(&self, column: &str, t: f64) -> Option<f64> {
        let (own, times, values) = self.series.as_ref()?;
        if *own == column { interpolate(times, values, t) } else { None }
    }
}

/// The cubic through the four nodes around a place; `None` outside the nodes.
pub(crate) fn cubic(x: &[f64], y: &[f64], at: f64) -> Option<f64> {
    let count = x.len();
    // A place that is a node to rounding is inside.
    let slack = 1e-9 * (x[count - 1] - x[0]);
    if count < 4 || at < x[0] - slack || at > x[count - 1] + slack {
        return None;
    }
    let first = x.partition_point(|node| *node <= at).saturating_sub(2).min(count - 4);
    let nodes = first..first + 4;
    Some(
        nodes
            .clone()
            .map(|k| y[k] * nodes.clone().filter(|l| *l != k).map(|l| (at - x[l]) / (x[k] - x[l])).product::<f64>())
            .sum(),
    )
}

impl Reference for ShellTable {
    fn describe(&self) -> ReferenceInfo {
        ReferenceInfo {
            errors: self.errors.clone(),
            ..ReferenceInfo::new("table", self.source.clone(), self.error_estimate_rel)
        }
    }

    fn temperature(&self, x: f64, t: f64) -> Option<f64> {
        self.profile(None, x, t)
    }

    fn cut_temperature(&self, cut: Cut, x: f64, t: f64) -> Option<f64> {
        self.profile(Some(cut), x, t)
    }

    fn front(&self, t: f64) -> Option<f64> {
        self.over_time("front_m", t).or(self.front_start.filter(|_| t == 0.0))
    }

    fn beside(&self, t: f64) -> Option<(&'static str, f64)> {
        Some(("a line sink of the same power", self.beside?.front(t)))
    }

    fn frozen_volume(&self, t: f64) -> Option<f64> {
        self.over_time("frozen_volume_m3", t)
    }
}
