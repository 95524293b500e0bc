//! Rings and rows of freeze pipes.

use std::sync::Arc;

use glam::DVec2;

use super::problem::Read;
use super::range::{Range, plain, temperatures};
use super::section::{Key, Names, Section};
use crate::pipe_ring::PipeRing;
use frazil_core::boundary::pipe::PipeCondition;
use frazil_core::space::domain::{Domain, Sector};

/// Pipes of one ring, and rings, that a scene may have; their distances are checked pair by pair.
const MOST_PIPES: usize = 1000;
const MOST_RINGS: usize = 20;

pub(super) fn pipes(root: &mut Section<'_>, domain: Option<&Domain>) -> Vec<PipeRing> {
    let mut rings: Vec<PipeRing> = Vec::new();
    let mut complete = true;
    let mut sections = root.sections("pipes");
    let elsewhere = domain.is_some_and(|domain| !matches!(domain, Domain::Ring { .. } | Domain::Rectangle { .. }));
    if let (Some(first), true) = (sections.first_mut(), elsewhere) {
        first.section_problem("pipes need the domain \"ring\", or \"rectangle\" for a row");
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
        match domain.filter(|_| complete) {
            Some(Domain::Ring { outer_radius, sector }) => {
                ring_in_domain(section, number, &ring, *outer_radius, *sector);
            }
            Some(Domain::Rectangle { width, height }) => {
                row_in_domain(section, number, &ring, DVec2::new(*width, *height));
            }
            _ => {}
        }
        for (other_number, other) in (1..).zip(&rings).filter(|_| complete) {
            if overlap(&ring, other) {
                section.section_problem(format!("its pipes overlap those of \"pipes.{other_number}\""));
            }
        }
        rings.push(ring);
    }
    rings
}

const TEMPERATURE: (&str, &str) = ("temperature", "c");
const FILM: (&str, &str) = ("coefficient", "W_per_m2_K");
/// Key of the heat that ground receives from each pipe.
const HEAT: (&str, &str) = ("heat", "W_per_m");
/// Key of the places of pipes that stand on no circle.
const PLACES: (&str, &str) = ("places", "m");
/// Keys of the first and the last pipe of a row.
const ROW: [(&str, &str); 2] = [("from", "m"), ("to", "m")];

/// Where the pipes of a ring stand: how many, on a circle of which radius, from which angle (radians) on, and those that stand
/// beside their places on it.
type Circle = (usize, f64, f64, Vec<(usize, DVec2)>);

fn circle(section: &mut Section<'_>) -> Read<Circle> {
    let places = if section.has(PLACES) {
        for key in ROW.map(Key::from).into_iter().chain([Key::from("count")]).chain(CIRCLE.map(Key::from)) {
            section.refuse(key, "the positions of all pipes are given");
        }
        let points = section.points(PLACES, Some(2))?;
        if points.is_empty() || points.len() > MOST_PIPES {
            return Err(section.problem(PLACES, format!("found {} places, must be 1 to {MOST_PIPES}", points.len())));
        }
        points.iter().map(|place| DVec2::new(place[0], place[1])).collect()
    } else if is_row(section) {
        for key in CIRCLE.map(Key::from) {
            section.refuse(key, "the ends of a row are given");
        }
        row(section)?
    } else {
        // Known to those who misspell them.
        section.optional_points(PLACES, Some(2));
        let count = section.integer("count", 1..=MOST_PIPES);
        let radius = section.number(CIRCLE[0], Range::NOT_NEGATIVE);
        let first_angle = section.number_or(CIRCLE[1], 0.0, Range::ANY);
        return Ok((count?, radius?, first_angle.to_radians(), Vec::new()));
    };
    // They stand around the circle of their mean distance from the centre, each beside its place on it.
    let radius = places.iter().map(|place| place.length()).sum::<f64>() / places.len() as f64;
    let first_angle = if places[0] == DVec2::ZERO { 0.0 } else { places[0].to_angle() };
    let step = std::f64::consts::TAU / places.len() as f64;
    let beside = |(k, place): (usize, &DVec2)| (k, *place - radius * DVec2::from_angle(first_angle + step * k as f64));
    Ok((places.len(), radius, first_angle, places.iter().enumerate().map(beside).collect()))
}

/// Keys of a circle.
const CIRCLE: [(&str, &str); 2] = [("ring_radius", "m"), ("first_angle", "deg")];

fn is_row(section: &Section<'_>) -> bool {
    ROW.into_iter().any(|end| section.has(end))
}

/// Places of a row: evenly from one end to the other, with a pipe at both.
fn row(section: &mut Section<'_>) -> Read<Vec<DVec2>> {
    let count = section.integer("count", 2..=MOST_PIPES);
    let ends = ROW.map(|end| section.point(end).map(|(x, y)| DVec2::new(x, y)));
    let [from, to] = ends;
    let (count, from, to) = (count?, from?, to?);
    Ok((0..count).map(|k| from.lerp(to, k as f64 / (count - 1) as f64)).collect())
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
    let condition = condition(section, one_particle);
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
        condition: condition?,
        schedule,
    };
    as_built(section, number, &mut ring);
    Ok(ring)
}

/// What is kept up at the pipes: a temperature of their walls or of brine, or heat.
fn condition(section: &mut Section<'_>, one_particle: bool) -> Read<PipeCondition> {
    let given = section.only_one(&[TEMPERATURE.into(), HEAT.into()]);
    let is_heat = given == Ok(1);
    if is_heat && one_particle {
        section.problem(
            HEAT,
            "a pipe of one particle has a temperature: remove \"one_particle\" and give a \"pipe_radius_m\"",
        );
    }
    let film = if one_particle || is_heat {
        let reason = if is_heat { "the heat of the pipes is given" } else { "a pipe of one particle has no wall" };
        section.refuse(FILM, reason);
        None
    } else {
        section.optional_number(FILM, Range::POSITIVE)
    };
    if given? == 1 {
        return section.series(HEAT, Range::ANY).map(PipeCondition::Heat);
    }
    let series = section.series(TEMPERATURE, temperatures(section.units().absolute_zero()))?;
    Ok(match film {
        Some(coefficient) => PipeCondition::Film { coefficient, brine: series },
        None => PipeCondition::Temperature(series),
    })
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
    if section.has(PLACES) || is_row(section) {
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
    let (places, names) = (key_of_places(section), Names { ring: number, count: ring.count });
    apart(section, number, ring);
    for k in &numbers {
        let name = names.of(*k);
        let place = ring.place(*k);
        if place.length() + ring.pipe_radius >= outer_radius {
            let message = format!("pipe {name} must lie inside the outer radius {}", plain(outer_radius));
            section.problem(places, message);
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

/// The key that says where pipes stand which are on no circle.
fn key_of_places(section: &Section<'_>) -> Key {
    match section.has(PLACES) {
        true => PLACES.into(),
        false if is_row(section) => ROW[1].into(),
        false => ("moved", "m").into(),
    }
}

/// Pipes of a ring or a row must stand apart.
fn apart(section: &mut Section<'_>, number: usize, ring: &PipeRing) {
    let (places, names) = (key_of_places(section), Names { ring: number, count: ring.count });
    let numbers: Vec<usize> = ring.numbers().collect();
    for (at, k) in numbers.iter().enumerate() {
        for other in &numbers[..at] {
            let distance = ring.place(*k).distance(ring.place(*other));
            if distance <= 2.0 * ring.pipe_radius {
                let message = format!(
                    "pipes {} and {} overlap: their axes are {distance:.4} apart, must be more than {}",
                    names.of(*other),
                    names.of(*k),
                    plain(2.0 * ring.pipe_radius)
                );
                section.problem(places, message);
            }
        }
    }
}

/// Pipes in a rectangle: at places or in a row, apart, and inside.
fn row_in_domain(section: &mut Section<'_>, number: usize, row: &PipeRing, size: DVec2) {
    if !section.has(PLACES) && !is_row(section) {
        section
            .problem(CIRCLE[0], "a circle of pipes needs the domain \"ring\": give \"from\" and \"to\", or \"places\"");
        return;
    }
    apart(section, number, row);
    let (places, names) = (key_of_places(section), Names { ring: number, count: row.count });
    let radius = DVec2::splat(row.pipe_radius);
    for k in row.numbers() {
        let place = row.place(k);
        if (place - radius).cmple(DVec2::ZERO).any() || (place + radius).cmpge(size).any() {
            section.problem(places, format!("pipe {} must lie inside the rectangle", names.of(k)));
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
