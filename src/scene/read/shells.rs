//! Bodies of axial and spherical symmetry, and walls in parts.

use super::problem::Read;
use super::range::{Range, plain};
use super::regions::extent;
use super::section::{Key, Section};
use crate::region::Cell;
use crate::scene::WallPart;
use frazil_core::boundary::condition::Condition;
use frazil_core::space::domain::{Domain, Surface};
use frazil_core::space::symmetry::Symmetry;
use frazil_core::space::wall::{PatchId, WallId};

const INNER: (&str, &str) = ("inner_radius", "m");
const OUTER: (&str, &str) = ("outer_radius", "m");

/// Reads `[domain.radial]`.
pub(super) fn radial(section: &mut Section<'_>) -> Read<Domain> {
    let choices = [("axial", Symmetry::Axial), ("spherical", Symmetry::Spherical)];
    let symmetry = section.choice("symmetry", &choices);
    let (inner, outer) = radii(section)?;
    Ok(Domain::Radial { symmetry: symmetry?, inner, outer })
}

/// Reads `[domain.axial]`.
pub(super) fn axial(section: &mut Section<'_>) -> Read<Domain> {
    let height = section.positive(("height", "m"));
    let (inner, outer) = radii(section)?;
    Ok(Domain::Axial { inner, outer, height: height? })
}

fn radii(section: &mut Section<'_>) -> Read<(f64, f64)> {
    let inner = section.number(INNER, Range::NOT_NEGATIVE);
    let outer = section.positive(OUTER);
    let (inner, outer) = (inner?, outer?);
    if inner >= outer {
        let message = format!("found {}, must be less than the outer radius {}", plain(inner), plain(outer));
        return Err(section.problem(INNER, message));
    }
    Ok((inner, outer))
}

/// Extent of a wall along itself (m), if it has any.
pub(super) fn along(domain: &Domain, wall: WallId) -> Option<(f64, f64)> {
    let Cell { low, high } = extent(domain);
    let along = if wall.is_across_y() { (low.x, high.x) } else { (low.y, high.y) };
    matches!(domain, Domain::Axial { .. } | Domain::Rectangle { .. }).then_some(along)
}

/// Reads the parts of a wall that have conditions of their own, which `condition` reads. They are numbered from `first_number` on.
pub(super) fn parts(
    section: &mut Section<'_>,
    (wall, first_number): (WallId, usize),
    domain: &Domain,
    mut condition: impl FnMut(&mut Section<'_>, PatchId) -> Read<Condition>,
) -> Vec<WallPart> {
    const FROM: (&str, &str) = ("from", "m");
    const TO: (&str, &str) = ("to", "m");
    let mut found = Vec::new();
    for mut part in section.sections("parts") {
        let Some((first, last)) = along(domain, wall) else {
            part.section_problem("only walls of the domains \"axial\" and \"rectangle\" have parts");
            part.abandon();
            continue;
        };
        let (from, to) = (part.number(FROM, Range::ANY), part.number(TO, Range::ANY));
        let own = condition(&mut part, PatchId::Part(wall, first_number + found.len()));
        let (Ok(from), Ok(to)) = (from, to) else { continue };
        let mut inside = true;
        for (key, place) in [(FROM, from), (TO, to)] {
            if !(first..=last).contains(&place) {
                let (first, last) = (plain(first), plain(last));
                part.problem(key, format!("found {}, the wall reaches from {first} to {last}", plain(place)));
                inside = false;
            }
        }
        if inside && from >= to {
            part.problem(FROM, format!("found {}, must be less than the end of the part, {}", plain(from), plain(to)));
        } else if let (true, Ok(condition)) = (inside, own) {
            found.push(WallPart { wall, from, to, condition });
        }
    }
    found
}

/// Reads the surfaces through which heat is counted.
pub(super) fn surfaces(section: &mut Section<'_>, domain: Option<&Domain>) -> Vec<Surface> {
    let mut found = Vec::new();
    for mut surface in section.sections("surfaces") {
        let Some(domain) = domain else {
            surface.abandon();
            continue;
        };
        let round = domain.symmetry().is_some();
        let keys: [(&str, &str); 2] = if round { [("r", "m"), ("z", "m")] } else { [("x", "m"), ("y", "m")] };
        if let Domain::Ring { .. } = domain {
            surface.section_problem(
                "the domain \"ring\" has no surfaces: the heat of pipes and of the outer wall is recorded anyway",
            );
            surface.abandon();
            continue;
        }
        let plane = domain.dimension() == 2;
        let axis = if plane { surface.only_one(&keys.map(Key::from)) } else { Ok(0) };
        let Ok(axis) = axis else { continue };
        let Cell { low, high } = extent(domain);
        let (key, across_y, least, most) = (keys[axis], axis == 1, low[axis], high[axis]);
        let Ok(at) = surface.number(key, Range::ANY) else { continue };
        if at > least && at < most {
            found.push(Surface { across_y, at });
        } else {
            let message = format!("found {}, must lie between {} and {}", plain(at), plain(least), plain(most));
            surface.problem(key, message);
        }
    }
    found
}
