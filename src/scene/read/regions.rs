//! Regions: parts of the body with a material, or a start, of their own.

use frazil_record::quoted;
use glam::DVec2;

use super::problem::Read;
use super::range::{Range, one_of, plain, temperatures};
use super::section::{Key, Section};
use super::water::{Balance, CONCENTRATION};
use crate::region::{Cell, Ellipse, Region, Shape, area, edges};
use frazil_core::space::domain::Domain;
use frazil_core::space::segment::{meet, side};

/// Shapes that a section of their own describes.
const SHAPES: [&str; 3] = ["circle", "ellipse", "polygon"];

/// Edges of the polygon around an ellipse by which it is told whether it lies outside a ring.
const AROUND: usize = 720;

/// Corners that a polygon may have: each edge is compared with each other.
const MOST_CORNERS: usize = 1000;

const TEMPERATURE: (&str, &str) = ("temperature", "c");
/// Heat that a region releases.
const HEAT: (&str, &str) = ("heat", "W_per_m3");
const X_MIN: (&str, &str) = ("x_min", "m");
const X_MAX: (&str, &str) = ("x_max", "m");
const Y_MIN: (&str, &str) = ("y_min", "m");
const Y_MAX: (&str, &str) = ("y_max", "m");

/// Reads the regions and checks that every material has a place.
pub(super) fn regions(
    root: &mut Section<'_>,
    materials_section: &mut Section<'_>,
    domain: Option<&Domain>,
    names: &[String],
    balance: &mut Balance,
) -> (Vec<Region>, Vec<Shape>) {
    let mut used = vec![false; names.len()];
    if let Some(first) = used.first_mut() {
        *first = true;
    }
    let (mut regions, mut impermeable) = (Vec::new(), Vec::new());
    for mut section in root.sections("regions") {
        if section.flag_or("impermeable", false) {
            for key in [Key::from("material"), TEMPERATURE.into(), HEAT.into()] {
                section.refuse(key, "the region is impermeable");
            }
            let Some(domain) = domain else {
                section.abandon();
                continue;
            };
            if domain.dimension() == 1 || domain.symmetry().is_some() {
                section.problem("impermeable", "needs a plane");
            }
            impermeable.extend(shape(&mut section, domain));
            continue;
        }
        let named = section.optional_text("material");
        let material = named.as_ref().and_then(|name| {
            let index = names.iter().position(|known| known == name);
            if index.is_none() {
                let allowed = one_of(names.iter().map(String::as_str));
                section.problem("material", format!("found {}, must be {allowed}", quoted(name)));
            }
            index
        });
        if let Some(index) = material {
            used[index] = true;
        }
        let (temperature, starts, what) = match balance {
            Balance::Heat => {
                let coldest = section.units().absolute_zero();
                let temperature = section.optional_number(TEMPERATURE, temperatures(coldest));
                (temperature, section.has(TEMPERATURE), "a temperature at its start, or \"heat\"")
            }
            Balance::Water(heads) => {
                let starts = section.has(("head", "m")) || section.has("saturation");
                let state = heads.optional_state(&mut section);
                heads.solute_region(&mut section);
                (
                    state,
                    starts || section.has(CONCENTRATION),
                    "a head, a saturation or a concentration at its start, or both",
                )
            }
        };
        let heat = section.optional_power(HEAT, Range::ANY);
        if !section.has("material") && !starts && !section.has(HEAT) {
            section.section_problem(format!("must have a \"material\", {what}"));
        }
        let Some(domain) = domain else {
            section.abandon();
            continue;
        };
        if let Ok(shape) = shape(&mut section, domain)
            && named.is_some() == material.is_some()
        {
            regions.push(Region { material, temperature, heat, shape });
        }
    }
    for (name, _) in names.iter().zip(&used).filter(|(_, used)| !**used) {
        materials_section.note(name, "is not used: the first material fills the body, regions name the others");
    }
    (regions, impermeable)
}

/// Regions that are watched: shapes alone.
pub(super) fn watched(section: &mut Section<'_>, domain: Option<&Domain>) -> Vec<Shape> {
    let read = |mut section: Section<'_>| match domain {
        Some(domain) => shape(&mut section, domain).ok(),
        None => {
            section.abandon();
            None
        }
    };
    section.sections("regions").into_iter().filter_map(read).collect()
}

fn shape(section: &mut Section<'_>, domain: &Domain) -> Read<Shape> {
    if domain.dimension() == 1 {
        for key in SHAPES {
            section.refuse(key, "a line has no y");
        }
    } else if let Some(own) = SHAPES.into_iter().find(|key| section.has(*key)) {
        let is = format!("the region is {} {own}", if own == "ellipse" { "an" } else { "a" });
        for key in [X_MIN, X_MAX, Y_MIN, Y_MAX] {
            section.refuse(key, &is);
        }
        for other in SHAPES.into_iter().filter(|other| *other != own) {
            section.refuse(other, &is);
        }
        let shape = match own {
            "circle" => round(section)?,
            "ellipse" => oval(section)?,
            _ => cornered(section)?,
        };
        if is_outside(&shape, domain) {
            return Err(section.problem(own, "lies outside the domain"));
        }
        return Ok(shape);
    }
    let extent = extent(domain);
    let x = span(section, X_MIN, X_MAX, (extent.low.x, extent.high.x));
    let y = if domain.dimension() == 2 {
        span(section, Y_MIN, Y_MAX, (extent.low.y, extent.high.y))
    } else {
        section.refuse(Y_MIN, "a line has no y");
        section.refuse(Y_MAX, "a line has no y");
        Ok((f64::NEG_INFINITY, f64::INFINITY))
    };
    let ((x_min, x_max), (y_min, y_max)) = (x?, y?);
    Ok(Shape::Box(Cell { low: DVec2::new(x_min, y_min), high: DVec2::new(x_max, y_max) }))
}

fn round(section: &mut Section<'_>) -> Read<Shape> {
    let mut circle = section.section("circle")?;
    let (x, y) = (circle.number(("x", "m"), Range::ANY), circle.number(("y", "m"), Range::ANY));
    let radius = circle.positive(("radius", "m"));
    Ok(Shape::Circle { centre: DVec2::new(x?, y?), radius: radius? })
}

fn oval(section: &mut Section<'_>) -> Read<Shape> {
    const HALF_AXES: (&str, &str) = ("half_axes", "m");
    let mut ellipse = section.section("ellipse")?;
    let (x, y) = (ellipse.number(("x", "m"), Range::ANY), ellipse.number(("y", "m"), Range::ANY));
    let half_axes = ellipse.numbers(HALF_AXES, Range::POSITIVE);
    let angle = ellipse.number_or(("angle", "deg"), 0.0, Range::between(-360.0, 360.0)).to_radians();
    let half_axes = half_axes?;
    let [a, b] = half_axes[..] else {
        return Err(ellipse.problem(HALF_AXES, format!("found {} half axes, must be 2", half_axes.len())));
    };
    Ok(Shape::Ellipse(Ellipse { centre: DVec2::new(x?, y?), half_axes: DVec2::new(a, b), angle }))
}

fn cornered(section: &mut Section<'_>) -> Read<Shape> {
    const POINTS: (&str, &str) = ("points", "m");
    let mut polygon = section.section("polygon")?;
    let points = polygon.points(POINTS, Some(2))?;
    if !(3..=MOST_CORNERS).contains(&points.len()) {
        let message = format!("found {} points, must be between 3 and {MOST_CORNERS}", points.len());
        return Err(polygon.problem(POINTS, message));
    }
    let corners: Vec<DVec2> = points.iter().map(|point| DVec2::new(point[0], point[1])).collect();
    if let Some(message) = fault(&corners) {
        return Err(polygon.problem(POINTS, message));
    }
    Ok(Shape::Polygon(corners))
}

/// Why corners are not those of a polygon that encloses one area, if they are not.
fn fault(corners: &[DVec2]) -> Option<String> {
    let count = corners.len();
    let edges: Vec<(DVec2, DVec2)> = edges(corners).collect();
    for (k, edge) in edges.iter().enumerate() {
        let next = edges[(k + 1) % count];
        if edge.0 == edge.1 {
            return Some(format!("points {} and {} are the same, must differ", k + 1, (k + 1) % count + 1));
        }
        if side(*edge, next.1).is_eq() && (edge.1 - edge.0).dot(next.1 - next.0) < 0.0 {
            return Some(format!("the polygon reverses its direction at point {}", (k + 1) % count + 1));
        }
    }
    for (k, edge) in edges.iter().enumerate() {
        // Neighbouring edges share a corner.
        let others = k + 2..count - usize::from(k == 0);
        if let Some(other) = others.into_iter().find(|other| meet(*edge, edges[*other])) {
            let (from, to, first, last) = (k + 1, k + 2, other + 1, (other + 1) % count + 1);
            return Some(format!("the polygon crosses itself: points {from} to {to} meet points {first} to {last}"));
        }
    }
    (area(corners) == 0.0).then(|| "the polygon encloses no area".to_owned())
}

/// The box around the simulated body.
pub(super) fn extent(domain: &Domain) -> Cell {
    let (low, high) = domain.corners();
    Cell { low, high }
}

/// Whether no part of a shape lies in the body.
fn is_outside(shape: &Shape, domain: &Domain) -> bool {
    let nearest = |corners: &[DVec2]| {
        let nearest = |(a, b): (DVec2, DVec2)| {
            let along = (-a).dot(b - a) / (b - a).length_squared();
            (a + along.clamp(0.0, 1.0) * (b - a)).length()
        };
        edges(corners).map(nearest).fold(f64::INFINITY, f64::min)
    };
    let beyond = match (domain, shape) {
        (Domain::Ring { outer_radius, .. }, Shape::Circle { centre, radius }) => {
            centre.length() - radius >= *outer_radius
        }
        (Domain::Ring { outer_radius, .. }, Shape::Ellipse(ellipse)) => {
            !shape.contains(DVec2::ZERO) && nearest(&ellipse.around(AROUND)) >= *outer_radius
        }
        (Domain::Ring { outer_radius, .. }, Shape::Polygon(corners)) => {
            !shape.contains(DVec2::ZERO) && nearest(corners) >= *outer_radius
        }
        _ => false,
    };
    let (own, body) = (shape.extent(), extent(domain));
    // Of what both extents share, so that a small shape in a large body is seen.
    let common = Cell { low: own.low.max(body.low), high: own.high.min(body.high) };
    beyond || common.low.cmpge(common.high).any() || shape.share_of(&common) == 0.0
}

fn span(
    section: &mut Section<'_>,
    low: (&'static str, &'static str),
    high: (&'static str, &'static str),
    extent: (f64, f64),
) -> Read<(f64, f64)> {
    let allowed = Range::within_body(extent.0, extent.1);
    let (from, to) = (section.number(low, allowed), section.number(high, allowed));
    let (from, to) = (from?, to?);
    if from >= to {
        return Err(section.problem(high, format!("found {}, must be greater than {}", plain(to), plain(from))));
    }
    Ok((from, to))
}
