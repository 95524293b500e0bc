//! A scene in words, as pages say it.

use frazil_core::boundary::condition::Condition;
use frazil_core::breakage::crack::Growth;
use frazil_core::series::Series;
use frazil_core::space::domain::Domain;
use frazil_plots::page::Fact;
use frazil_plots::style::{length, number};
use frazil_scene::{Scene, Shape, Units};

/// A length (m) in words: with a unit where the scene has any.
pub fn length_words(units: Units, value: f64) -> String {
    if units == Units::Si { length(value) } else { number(value, 3) }
}

/// What a scene says, for a page.
pub fn parameters(scene: &Scene) -> Vec<Fact> {
    let si = scene.units == Units::Si;
    let with = |value: f64, unit: &str| if si { format!("{} {unit}", number(value, 4)) } else { number(value, 4) };
    let number_words = |value: f64| number(value, 4);
    let with_point = |x: f64, y: f64| format!("({}, {}){}", number(x, 4), number(y, 4), if si { " m" } else { "" });
    let series = |series: &Series, unit: &str| match series {
        Series::Constant(value) => with(*value, unit),
        Series::Table(rows) => format!("a table of {} instants", rows.len()),
        Series::Repeated { rows, .. } => format!("a repeated table of {} instants", rows.len()),
    };
    let domain = match scene.domain {
        Domain::Line { length } => format!("line of {}", with(length, "m")),
        Domain::Rectangle { width, height } => format!("{} by {}", with(width, "m"), with(height, "m")),
        Domain::Ring { outer_radius, sector } => {
            format!("{} of a disc of radius {}", sector.name(), with(outer_radius, "m"))
        }
        Domain::Radial { symmetry, inner, outer } => {
            format!("{} shells from radius {} to {}", symmetry.name(), with(inner, "m"), with(outer, "m"))
        }
        Domain::Axial { inner, outer, height } => format!(
            "around an axis from radius {} to {}, {} high",
            with(inner, "m"),
            with(outer, "m"),
            with(height, "m")
        ),
    };
    let mut facts = vec![
        Fact::new("Body", domain),
        Fact::new(
            "Duration",
            if si {
                format!("{} {}", number(scene.duration / scene.time_unit.seconds(), 4), scene.time_unit.symbol())
            } else {
                number(scene.duration, 4)
            },
        ),
        Fact::new("Temperature at the start", with(scene.initial_temperature, "°C")),
    ];
    for (number, region) in scene.regions.iter().enumerate() {
        let shape = match &region.shape {
            Shape::Box(cell) if cell.low.y.is_finite() => format!(
                "box from ({}, {}) to {}",
                number_words(cell.low.x),
                number_words(cell.low.y),
                with_point(cell.high.x, cell.high.y)
            ),
            Shape::Box(cell) => format!("from {} to {}", number_words(cell.low.x), with(cell.high.x, "m")),
            Shape::Circle { centre, radius } => {
                format!("circle of radius {} around {}", with(*radius, "m"), with_point(centre.x, centre.y))
            }
            Shape::Polygon(corners) => format!("polygon of {} corners", corners.len()),
        };
        let material = region.material.map(|index| format!(", of {}", scene.materials[index].name));
        let start = region.temperature.map(|temperature| format!(", starts at {}", with(temperature, "°C")));
        let words = [Some(shape), material, start].into_iter().flatten().collect::<String>();
        facts.push(Fact::new(format!("Region {number}"), words));
    }
    for (number, crack) in scene.cracks.iter().enumerate() {
        let seconds = |time: f64| if si { format!("{} s", number_words(time)) } else { number_words(time) };
        let growth = match &crack.growth {
            Growth::Whole { start } if *start == 0.0 => "from the start".to_owned(),
            Growth::Whole { start } => format!("from {} on", seconds(*start)),
            Growth::Steady { start, speed } => {
                format!("grows from {} on at {}", seconds(*start), with(*speed, "m/s"))
            }
            Growth::Table(rows) => format!("grows by a table of {} instants", rows.len()),
        };
        let (from, to) = (with_point(crack.from.x, crack.from.y), with_point(crack.to.x, crack.to.y));
        facts.push(Fact::new(format!("Crack {number}"), format!("{from} to {to}, {growth}")));
    }
    let condition = |condition: &Condition| match condition {
        Condition::Symmetry => "mirror plane, no heat crosses".into(),
        Condition::Temperature(value) => series(value, "°C"),
        Condition::Flux(value) => format!("heat flux into the body: {}", series(value, "W/m²")),
        Condition::Convection { coefficient, ambient } => {
            format!("film coefficient {} to {}", series(coefficient, "W/m²K"), series(ambient, "°C"))
        }
        Condition::Exact => "temperature of the exact solution".into(),
    };
    for wall in &scene.walls {
        facts.push(Fact::new(format!("Wall {}", wall.name), condition(&wall.condition)));
    }
    if let Some(shaft) = &scene.excavation {
        let days = with(shaft.start / scene.time_unit.seconds(), scene.time_unit.symbol());
        let face = condition(&shaft.condition);
        facts
            .push(Fact::new("Shaft", format!("of radius {}, dug after {days}; face: {face}", with(shaft.radius, "m"))));
    }
    for ring in &scene.rings {
        facts.push(Fact::new(
            "Pipes",
            format!(
                "{} on a circle of radius {}, each of radius {}, at {}",
                ring.count,
                with(ring.ring_radius, "m"),
                with(ring.pipe_radius, "m"),
                series(&ring.temperature, "°C")
            ),
        ));
    }
    for material in &scene.materials {
        facts.push(Fact::new(
            format!("Material {}", material.name),
            format!(
                "frozen {}, {}; unfrozen {}, {}; density {}; freezes at {}; latent heat {}",
                with(material.frozen.conductivity, "W/(m K)"),
                with(material.frozen.heat_capacity, "J/(kg K)"),
                with(material.unfrozen.conductivity, "W/(m K)"),
                with(material.unfrozen.heat_capacity, "J/(kg K)"),
                with(material.density, "kg/m³"),
                with(material.freezing_point, "°C"),
                with(material.latent_heat, "J/kg"),
            ),
        ));
    }
    facts
}
