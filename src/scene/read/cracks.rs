//! Cracks: segments that no heat crosses.

use glam::DVec2;

use super::problem::Read;
use super::range::{Range, plain};
use super::section::Section;
use frazil_core::breakage::crack::{Crack, Growth};
use frazil_core::series::Series;
use frazil_core::space::domain::{Domain, Sector};

const LENGTH: (&str, &str) = ("length", "m");
const SPEED: (&str, &str) = ("speed", "m_per_s");

pub(super) fn cracks(root: &mut Section<'_>, domain: Option<&Domain>) -> Vec<Crack> {
    let mut sections = root.sections("cracks");
    let not_a_plane = match domain {
        Some(Domain::Line { .. }) => Some("a line"),
        Some(Domain::Radial { .. } | Domain::Axial { .. }) => Some("symmetric about an axis or a centre"),
        _ => None,
    };
    if let (Some(first), Some(found)) = (sections.first_mut(), not_a_plane) {
        first.section_problem(format!("a crack needs a two-dimensional domain, found {found}"));
    }
    sections.iter_mut().flat_map(|section| crack(section, domain)).collect()
}

fn crack(section: &mut Section<'_>, domain: Option<&Domain>) -> Read<Crack> {
    let from = section.point(("from", "m")).map(DVec2::from);
    let to = section.point(("to", "m")).map(DVec2::from);
    let growth = growth(section);
    let (from, to) = (from?, to?);
    if from == to {
        return Err(section.problem(("to", "m"), "found the same point as \"from_m\", must be another"));
    }
    if let Some(domain) = domain.filter(|domain| domain.dimension() == 2) {
        match [from, to].map(|end| wall_before(domain, end)) {
            [None, None] => {}
            [Some(_), Some(_)] => {
                return Err(section.section_problem("lies outside the domain, must begin and end in it"));
            }
            [found, other] => {
                let key = if found.is_some() { ("from", "m") } else { ("to", "m") };
                let wall = found.or(other).unwrap_or_default();
                let message = format!("lies outside the domain: the crack crosses {wall}, must end before it");
                return Err(section.problem(key, message));
            }
        }
    }
    let growth = growth?;
    let length = (to - from).length();
    if let Growth::Table(rows) = &growth {
        if let Some(pair) = rows.windows(2).find(|pair| pair[1].1 < pair[0].1) {
            let message = format!("found {} after {}, must not decrease", plain(pair[1].1), plain(pair[0].1));
            section.problem(LENGTH, message);
        }
        if let Some(row) = rows.iter().find(|row| row.1 > length * (1.0 + 1e-9)) {
            let message = format!("found {}, must be at most {}, the length of the crack", plain(row.1), plain(length));
            section.problem(LENGTH, message);
        }
    }
    Ok(Crack { from, to, growth })
}

/// How a crack comes to be, which is all at once unless a speed or a table says otherwise.
fn growth(section: &mut Section<'_>) -> Read<Growth> {
    if section.has(LENGTH) {
        section.refuse(SPEED, "the growth of the crack is given by the table of lengths");
        section.refuse_time("start", "the time of growth is given by the table of lengths");
        return match section.tabulated(LENGTH, Range::NOT_NEGATIVE)? {
            Series::Table(rows) => Ok(Growth::Table(rows)),
            Series::Constant(_) | Series::Repeated { .. } | Series::Formula(_) => {
                Err(section.problem(LENGTH, "must be a time table without a period"))
            }
        };
    }
    let start = section.optional_duration("start", Range::NOT_NEGATIVE).map_or(0.0, |start| start.seconds);
    Ok(match section.optional_number(SPEED, Range::POSITIVE) {
        Some(speed) => Growth::Steady { start, speed },
        None => Growth::Whole { start },
    })
}

/// The wall behind which a point lies, in words; none for a point in the domain or on its edge.
fn wall_before(domain: &Domain, point: DVec2) -> Option<&'static str> {
    let sides = |low: DVec2, high: DVec2| {
        let beyond = [point.x < low.x, point.x > high.x, point.y < low.y, point.y > high.y];
        let names = ["the left wall", "the right wall", "the bottom wall", "the top wall"];
        names.into_iter().zip(beyond).find(|side| side.1).map(|side| side.0)
    };
    match *domain {
        Domain::Line { .. } | Domain::Radial { .. } | Domain::Axial { .. } => None,
        Domain::Rectangle { width, height } => sides(DVec2::ZERO, DVec2::new(width, height)),
        Domain::Ring { outer_radius, sector } => {
            let mirrored = (sector == Sector::Quarter && point.x < 0.0) || (sector != Sector::Whole && point.y < 0.0);
            if mirrored { Some("a mirror plane") } else { (point.length() > outer_radius).then_some("the outer wall") }
        }
    }
}
