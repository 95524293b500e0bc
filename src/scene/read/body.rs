//! The body and what surrounds it: domain, walls, pipes.

use std::sync::Arc;

use glam::DVec2;

use super::problem::Read;
use super::range::{Range, all_of, one_of, plain, temperatures};
use super::section::{Key, Names, Section};
use super::shells;
use super::water::Balance;
use crate::pipe_ring::PipeRing;
use crate::region::Region;
use crate::scene::{ReferenceChoice, Wall, WallPart};
use crate::units::Units;
use frazil_core::boundary::condition::Condition;
use frazil_core::physics::film::FILMS;
use frazil_core::physics::material::Material;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::wall::{PatchId, WallId};

/// Pipes of one ring, and rings, that a scene may have; their distances are checked pair by pair.
const MOST_PIPES: usize = 1000;
const MOST_RINGS: usize = 20;

pub(super) fn domain(root: &mut Section<'_>) -> Read<Domain> {
    let mut section = root.section("domain")?;
    let kinds = ["line", "rectangle", "ring", "radial", "axial"].map(Key::from);
    match section.only_one(&kinds)? {
        0 => {
            let mut line = section.section("line")?;
            Ok(Domain::Line { length: line.positive(("length", "m"))? })
        }
        1 => {
            let mut rectangle = section.section("rectangle")?;
            let (width, height) = (rectangle.positive(("width", "m")), rectangle.positive(("height", "m")));
            Ok(Domain::Rectangle { width: width?, height: height? })
        }
        3 => shells::radial(&mut section.section("radial")?),
        4 => shells::axial(&mut section.section("axial")?),
        _ => {
            let mut ring = section.section("ring")?;
            let outer_radius = ring.positive(("outer_radius", "m"));
            let sectors = [("quarter", Sector::Quarter), ("half", Sector::Half), ("whole", Sector::Whole)];
            let sector = ring.choice("sector", &sectors);
            Ok(Domain::Ring { outer_radius: outer_radius?, sector: sector? })
        }
    }
}

/// The walls that a domain has.
pub(super) fn walls_of(domain: &Domain) -> &'static [WallId] {
    use WallId::{Bottom, Inner, Left, Outer, Right, Top};
    match domain {
        Domain::Line { .. } => &[Left, Right],
        Domain::Rectangle { .. } => &[Left, Right, Bottom, Top],
        Domain::Ring { .. } => &[Outer],
        // At r = 0 is the axis or the centre, and no wall.
        Domain::Radial { inner: 0.0, .. } => &[Outer],
        Domain::Radial { .. } => &[Inner, Outer],
        Domain::Axial { inner: 0.0, .. } => &[Outer, Bottom, Top],
        Domain::Axial { .. } => &[Inner, Outer, Bottom, Top],
    }
}

/// The wall of a domain that a file names.
pub(super) fn wall_named(domain: &Domain, name: &str) -> Option<WallId> {
    walls_of(domain).iter().copied().find(|wall| wall.name() == name)
}

/// The names of the walls that a domain has, as messages list them.
pub(super) fn wall_names(domain: &Domain) -> String {
    all_of(walls_of(domain).iter().map(|wall| wall.name()))
}

pub(super) fn walls(
    section: &mut Section<'_>,
    domain: Option<&Domain>,
    balance: &mut Balance,
) -> (Vec<Wall>, Vec<WallPart>) {
    let (mut walls, mut parts) = (Vec::new(), Vec::new());
    let mut given = Vec::new();
    for (name, mut wall) in section.named_sections() {
        if let Some(domain) = domain {
            let Some(known) = wall_named(domain, &name) else {
                let kind = match domain {
                    Domain::Line { .. } => "line",
                    Domain::Rectangle { .. } => "rectangle",
                    Domain::Ring { .. } => "ring",
                    Domain::Radial { .. } => "radial one",
                    Domain::Axial { .. } => "axial one",
                };
                let axis = if name == "inner" && domain.symmetry().is_some() { " from r = 0 on" } else { "" };
                let names = wall_names(domain);
                wall.section_problem(format!("the domain has no such wall, a {kind}{axis} has {names}"));
                wall.abandon();
                continue;
            };
            let own = condition_of(&mut wall, balance);
            let numbered = (known, parts.len());
            parts.extend(match balance {
                Balance::Heat => shells::parts(&mut wall, numbered, domain, |part, _| condition_of_part(part)),
                Balance::Water(heads) => {
                    heads.concentration(&mut wall, PatchId::Whole(known), &own);
                    shells::parts(&mut wall, numbered, domain, |part, patch| heads.part(part, patch, &own))
                }
            });
            if let Ok(condition) = own {
                walls.push(Wall { wall: known, condition });
            }
        } else {
            // Its problems are recorded.
            let _ = condition_of(&mut wall, balance);
            wall.sections("parts").iter_mut().for_each(Section::abandon);
        }
        given.push(name);
    }
    if let Some(domain) = domain {
        let all = walls_of(domain);
        for wall in all.iter().filter(|wall| !given.iter().any(|given| given == wall.name())) {
            section.note(wall.name(), "missing, every wall of the domain must have a condition");
        }
        walls.sort_by_key(|wall| all.iter().position(|known| *known == wall.wall));
    }
    (walls, parts)
}

/// What happens at a wall.
fn condition_of(wall: &mut Section<'_>, balance: &Balance) -> Read<Condition> {
    match balance {
        Balance::Heat => condition(wall),
        Balance::Water(heads) => heads.condition(wall),
    }
}

/// What happens to heat at a part of a wall.
fn condition_of_part(part: &mut Section<'_>) -> Read<Condition> {
    let own = condition(part)?;
    if own == Condition::Exact {
        part.problem("condition", "found \"exact\", but a part of a wall has no exact solution");
    }
    Ok(own)
}

/// What happens to heat at a wall.
pub(super) fn condition(wall: &mut Section<'_>) -> Read<Condition> {
    const TEMPERATURE: (&str, &str) = ("temperature", "c");
    const FLUX: (&str, &str) = ("flux", "W_per_m2");
    const AMBIENT: (&str, &str) = ("ambient", "c");
    let films: Vec<Key> = FILMS.iter().map(|kind| kind.key().into()).collect();
    let keys = [&[TEMPERATURE.into(), FLUX.into()][..], &films, &["condition".into()]].concat();
    let found = wall.only_one(&keys);
    let film = found.ok().and_then(|index| FILMS.get(index.checked_sub(2)?));
    if film.is_none() {
        let words: Vec<String> = films.iter().map(|key| key.written(wall.units())).collect();
        let words = one_of(words.iter().map(String::as_str));
        wall.refuse(AMBIENT, &format!("only a wall with {words} has surroundings"));
    }
    for rain in super::water::RAINS {
        wall.refuse(rain, "rain needs balance = \"water\"");
    }
    let allowed = temperatures(wall.units().absolute_zero());
    match (found?, film) {
        (_, Some(kind)) => {
            let (low, high) = kind.range();
            let strength = wall.series(kind.key(), Range::of(low, high));
            let ambient = wall.series(AMBIENT, allowed);
            if kind.needs_si() && wall.units() != Units::Si {
                let units = wall.units().name();
                let message = format!("found beside units = \"{units}\", needs units = \"si\" for its constants");
                return Err(wall.problem(kind.key(), message));
            }
            Ok(Condition::Film { kind: *kind, strength: strength?, ambient: ambient? })
        }
        (0, _) => wall.series(TEMPERATURE, allowed).map(Condition::Temperature),
        (1, _) => wall.series(FLUX, Range::ANY).map(Condition::Flux),
        _ => wall.choice("condition", &[("symmetry", Condition::Symmetry), ("exact", Condition::Exact)]),
    }
}

/// Whether walls that hold the exact solution have one: a similarity solution of a half-space.
pub(super) fn exact_walls(
    section: &mut Section<'_>,
    domain: &Domain,
    walls: &[Wall],
    (materials, regions): (&[Material], &[Region]),
    reference: &ReferenceChoice,
) {
    if walls.len() < walls_of(domain).len() {
        return;
    }
    for wall in walls.iter().filter(|wall| wall.condition == Condition::Exact) {
        let opposite = wall.wall.opposite();
        let constant = |other: &Wall| matches!(&other.condition, Condition::Temperature(series) if series.range().0 == series.range().1);
        let reason = if matches!(domain, Domain::Ring { .. }) {
            Some("a ring has no exact solution".to_owned())
        } else if domain.symmetry().is_some() {
            Some("a body of shells has no exact solution".to_owned())
        } else if let Some(opposite) = opposite
            && !walls.iter().any(|other| other.wall == opposite && constant(other))
        {
            Some(format!("the wall \"{opposite}\" must have a constant temperature"))
        } else if let Some(other) = walls.iter().find(|other| {
            other.wall != wall.wall && Some(other.wall) != opposite && other.condition != Condition::Symmetry
        }) {
            Some(format!("the wall \"{}\" must be a symmetry plane", other.wall))
        } else if regions.iter().any(|region| region.temperature.is_some()) {
            Some("the body must start at one temperature".to_owned())
        } else if !regions.is_empty() || materials.len() > 1 {
            Some("the body must be of one material".to_owned())
        } else if !reference.may_be_exact() {
            Some("the reference must be \"exact\" or \"auto\"".to_owned())
        } else {
            None
        };
        if let Some(reason) = reason {
            section.note(wall.wall.name(), format!("condition \"exact\" needs an exact solution: {reason}"));
        }
    }
}

pub(super) fn pipes(root: &mut Section<'_>, domain: Option<&Domain>) -> Vec<PipeRing> {
    let mut rings: Vec<PipeRing> = Vec::new();
    let mut complete = true;
    let mut sections = root.sections("pipes");
    let elsewhere = domain.is_some_and(|domain| !matches!(domain, Domain::Ring { .. }));
    if let (Some(first), true) = (sections.first_mut(), elsewhere) {
        first.section_problem("a ring of pipes needs the domain \"ring\"");
        complete = false;
    }
    if sections.len() > MOST_RINGS {
        root.problem("pipes", format!("found {} rings, must be at most {MOST_RINGS}", sections.len()));
        complete = false;
    }
    for (number, section) in sections.iter_mut().enumerate() {
        let Ok(ring) = ring(section, number) else {
            complete = false;
            continue;
        };
        if let (Some(Domain::Ring { outer_radius, sector }), true) = (domain, complete) {
            ring_in_domain(section, number, &ring, *outer_radius, *sector);
            for (other_number, other) in (1..).zip(&rings) {
                if overlap(&ring, other) {
                    section.section_problem(format!("its pipes overlap those of \"pipes.{other_number}\""));
                }
            }
        }
        rings.push(ring);
    }
    rings
}

const FILM: (&str, &str) = ("coefficient", "W_per_m2_K");
/// Key of the places of pipes that stand on no circle.
const PLACES: (&str, &str) = ("places", "m");

/// Where the pipes of a ring stand: how many, on a circle of which radius, from which angle (radians) on, and those that stand
/// beside their places on it.
type Circle = (usize, f64, f64, Vec<(usize, DVec2)>);

fn circle(section: &mut Section<'_>) -> Read<Circle> {
    if !section.has(PLACES) {
        // Known to those who misspell it.
        section.optional_points(PLACES, Some(2));
        let count = section.integer("count", 1..=MOST_PIPES);
        let radius = section.number(("ring_radius", "m"), Range::NOT_NEGATIVE);
        let first_angle = section.number_or(("first_angle", "deg"), 0.0, Range::ANY);
        return Ok((count?, radius?, first_angle.to_radians(), Vec::new()));
    }
    for key in [Key::from("count"), ("ring_radius", "m").into(), ("first_angle", "deg").into()] {
        section.refuse(key, "the positions of all pipes are given");
    }
    let places: Vec<DVec2> =
        section.points(PLACES, Some(2))?.iter().map(|place| DVec2::new(place[0], place[1])).collect();
    if places.is_empty() || places.len() > MOST_PIPES {
        return Err(section.problem(PLACES, format!("found {} places, must be 1 to {MOST_PIPES}", places.len())));
    }
    // They stand around the circle of their mean distance from the centre, each beside its place on it.
    let radius = places.iter().map(|place| place.length()).sum::<f64>() / places.len() as f64;
    let first_angle = if places[0] == DVec2::ZERO { 0.0 } else { places[0].to_angle() };
    let step = std::f64::consts::TAU / places.len() as f64;
    let beside = |(k, place): (usize, &DVec2)| (k, *place - radius * DVec2::from_angle(first_angle + step * k as f64));
    Ok((places.len(), radius, first_angle, places.iter().enumerate().map(beside).collect()))
}

fn ring(section: &mut Section<'_>, number: usize) -> Read<PipeRing> {
    let circle = circle(section);
    let one_particle = section.flag_or("one_particle", false);
    let pipe_radius = if one_particle {
        section.refuse(("pipe_radius", "m"), "the radius of a pipe of one particle follows from the lattice");
        Ok(0.0)
    } else {
        section.positive(("pipe_radius", "m"))
    };
    let temperature = section.series(("temperature", "c"), temperatures(section.units().absolute_zero()));
    let film = if one_particle {
        section.refuse(FILM, "a pipe of one particle has no wall");
        None
    } else {
        section.optional_number(FILM, Range::POSITIVE)
    };
    let schedule = section.optional_schedule().map(Arc::new);
    let (count, ring_radius, first_angle, moved) = circle?;
    let mut ring = PipeRing {
        count,
        ring_radius,
        first_angle,
        one_particle,
        moved,
        missing: Vec::new(),
        pipe_radius: pipe_radius?,
        temperature: temperature?,
        film,
        schedule,
    };
    as_built(section, number, &mut ring);
    Ok(ring)
}

/// Pipes that are missing, and those that do not stand in their places.
fn as_built(section: &mut Section<'_>, number: usize, ring: &mut PipeRing) {
    let names = Names { ring: number, count: ring.count };
    ring.missing = section.optional_pipes("missing", names).unwrap_or_default();
    if ring.missing.len() == ring.count {
        section.problem("missing", "found all pipes, at least one must remain");
    }
    for (k, [x, y]) in section.optional_pipe_points(("moved", "m"), names).unwrap_or_default() {
        match ring.moved.iter_mut().find(|(other, _)| *other == k) {
            Some((_, way)) => *way += DVec2::new(x, y),
            None => ring.moved.push((k, DVec2::new(x, y))),
        }
    }
}

fn ring_in_domain(section: &mut Section<'_>, number: usize, ring: &PipeRing, outer_radius: f64, sector: Sector) {
    if ring.one_particle && sector != Sector::Whole {
        let message = "mirror planes may lie between particles: set domain.ring.sector = \"whole\"";
        section.problem("one_particle", message);
        return;
    }
    if section.has(PLACES) {
        return uneven_in_domain(section, number, ring, outer_radius, sector);
    }
    if ring.ring_radius + ring.pipe_radius >= outer_radius {
        let message = format!(
            "found {}, the pipes must lie inside the outer radius {}",
            plain(ring.ring_radius),
            plain(outer_radius)
        );
        section.problem(("ring_radius", "m"), message);
    }
    let chord = 2.0 * ring.ring_radius * (std::f64::consts::PI / ring.count as f64).sin();
    if ring.count > 1 && chord <= 2.0 * ring.pipe_radius {
        let message = format!(
            "found {}, must be less than half of {}, the distance of neighbouring pipes",
            plain(ring.pipe_radius),
            plain(chord)
        );
        section.problem(("pipe_radius", "m"), message);
    }
    if ring.count == 1 && ring.ring_radius == 0.0 {
        return;
    }
    // A mirror maps the angle a to -a or to 180 degrees - a; the ring repeats every 360 / count degrees.
    let step = 360.0 / ring.count as f64;
    let first = ring.first_angle.to_degrees();
    let whole = |turns: f64| (turns - turns.round()).abs() < 1e-9 * turns.abs().max(1.0);
    let across_x_axis = whole(2.0 * first / step);
    let across_y_axis = whole((180.0 - 2.0 * first) / step);
    let symmetric = match sector {
        Sector::Whole => true,
        Sector::Half => across_x_axis,
        Sector::Quarter => across_x_axis && across_y_axis,
    };
    if !ring.is_even() {
        return uneven_in_domain(section, number, ring, outer_radius, sector);
    }
    if symmetric {
        return;
    }
    if sector == Sector::Quarter && !ring.count.is_multiple_of(2) {
        let message = format!("found {}, must be even for the mirror planes of a quarter", ring.count);
        section.problem("count", message);
    } else {
        let message = format!(
            "found {}, must be a multiple of {}, half the angle between pipes, for the mirror planes of the sector",
            plain(first),
            plain(step / 2.0)
        );
        section.problem(("first_angle", "deg"), message);
    }
}

/// A ring with pipes that are missing or out of place: all stand apart, inside the domain, and each has its image in mirrors.
fn uneven_in_domain(section: &mut Section<'_>, number: usize, ring: &PipeRing, outer_radius: f64, sector: Sector) {
    let numbers: Vec<usize> = ring.numbers().collect();
    let places: Key = if section.has(PLACES) { PLACES.into() } else { ("moved", "m").into() };
    let names = Names { ring: number, count: ring.count };
    for (at, k) in numbers.iter().enumerate() {
        let name = names.of(*k);
        let place = ring.place(*k);
        if place.length() + ring.pipe_radius >= outer_radius {
            let message = format!("pipe {name} must lie inside the outer radius {}", plain(outer_radius));
            section.problem(places, message);
        }
        for other in &numbers[..at] {
            let distance = place.distance(ring.place(*other));
            if distance <= 2.0 * ring.pipe_radius {
                let message = format!(
                    "pipes {} and {name} overlap: their axes are {distance:.4} apart, must be more than {}",
                    names.of(*other),
                    plain(2.0 * ring.pipe_radius)
                );
                section.problem(places, message);
            }
        }
        let mirrors: &[DVec2] = match sector {
            Sector::Whole => &[],
            Sector::Half => &[DVec2::new(1.0, -1.0)],
            Sector::Quarter => &[DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0)],
        };
        let has_image = |mirror: &DVec2| {
            numbers.iter().any(|other| ring.place(*other).distance(place * *mirror) < 1e-9 * outer_radius)
        };
        if !mirrors.iter().all(has_image) {
            let message = format!(
                "pipe {name} has no image in the mirror planes of the sector: set domain.ring.sector = \"whole\""
            );
            if ring.moved.is_empty() {
                section.problem("missing", message);
            } else {
                section.problem(places, message);
            }
            return;
        }
    }
}

fn overlap(a: &PipeRing, b: &PipeRing) -> bool {
    let reach = a.pipe_radius + b.pipe_radius;
    if a.is_even() && b.is_even() && (a.ring_radius - b.ring_radius).abs() > reach {
        return false;
    }
    let others = b.pipes();
    a.pipes().iter().any(|pipe| others.iter().any(|other| (pipe.x - other.x).hypot(pipe.y - other.y) <= reach))
}
