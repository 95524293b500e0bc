//! The body and its walls.

use super::problem::Read;
use super::range::{Range, all_of, one_of, temperatures};
use super::section::{Key, Section};
use super::shells;
use super::water::Balance;
use crate::region::Region;
use crate::scene::{ReferenceChoice, Wall, WallPart};
use crate::units::Units;
use frazil_core::boundary::condition::Condition;
use frazil_core::physics::film::FILMS;
use frazil_core::physics::material::Material;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::wall::{PatchId, WallId};

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
        periodic_walls(section, &walls);
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
    let refused = match own {
        Condition::Exact => "found \"exact\", but a part of a wall has no exact solution",
        Condition::Periodic => "found \"periodic\", but only whole walls can be periodic",
        _ => return Ok(own),
    };
    Err(part.problem("condition", refused))
}

/// A body goes on at the opposite wall on both sides, and has one that is straight.
fn periodic_walls(section: &mut Section<'_>, walls: &[Wall]) {
    let periodic =
        |wall: WallId| walls.iter().any(|other| other.wall == wall && other.condition == Condition::Periodic);
    for wall in walls.iter().map(|wall| wall.wall).filter(|wall| periodic(*wall)) {
        match wall.opposite() {
            Some(opposite) if periodic(opposite) => {}
            Some(opposite) => {
                section.note(wall.name(), format!("condition \"periodic\" needs the same at the wall \"{opposite}\""));
            }
            None => {
                section.note(wall.name(), "condition \"periodic\" needs the domain \"line\" or \"rectangle\"");
            }
        }
    }
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
        _ => wall.choice(
            "condition",
            &[("symmetry", Condition::Symmetry), ("periodic", Condition::Periodic), ("exact", Condition::Exact)],
        ),
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
