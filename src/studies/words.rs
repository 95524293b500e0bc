//! A scene in words, as pages say it.

mod of_water;

use frazil_core::balances::heated::Power;
use frazil_core::boundary::condition::Condition;
use frazil_core::boundary::pipe::PipeCondition;
use frazil_core::breakage::crack::{Crack, Growth};
use frazil_core::physics::material::{Material, Phase};
use frazil_core::series::Series;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::PatchId;
use frazil_plots::page::Fact;
use frazil_plots::style::{length, number};
use frazil_scene::region::Ellipse;
use frazil_scene::{PipeRing, ProfileValues, Scene, Shape, Units};
use glam::DVec2;

/// A text with a capital at its beginning.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// A length (m) in words: with a unit where the scene has any.
pub fn length_words(units: Units, value: f64) -> String {
    if units == Units::Si { length(value) } else { number(value, 3) }
}

/// What a scene says, for a page.
pub fn parameters(scene: &Scene) -> Vec<Fact> {
    let words = Words { si: scene.units == Units::Si, scene };
    let duration = match words.si {
        true => format!("{} {}", number(scene.duration / scene.time_unit.seconds(), 4), scene.time_unit.symbol()),
        false => number(scene.duration, 4),
    };
    let mut facts = vec![
        Fact::new("Body", words.body(scene.domain)),
        Fact::new("Duration", duration),
        Fact::new(if scene.of_water { "Start" } else { "Initial temperature" }, words.start()),
    ];
    facts.extend((1..).zip(&scene.regions).map(|(number, region)| {
        let material = region.material.map(|index| format!(", of {}", scene.materials[index].name));
        let start = region.temperature.map(|start| format!(", starts at {}", words.state(start)));
        let heat = region.heat.as_ref().map(|heat| format!(", releases {}", words.power(heat)));
        let all = [Some(words.shape(&region.shape)), material, start, heat].into_iter().flatten().collect::<String>();
        Fact::new(format!("Region {number}"), all)
    }));
    let tight = (1..).zip(&scene.impermeable);
    facts.extend(tight.map(|(number, shape)| Fact::new(format!("Impermeable part {number}"), words.shape(shape))));
    let cracks = (1..).zip(&scene.cracks);
    facts.extend(cracks.map(|(number, crack)| Fact::new(format!("Crack {number}"), words.crack(crack))));
    facts.extend(scene.random.variations().map(|(name, varied)| {
        let (along_x, along_y) = (number(varied.lengths.x, 4), words.with(varied.lengths.y, "m"));
        let (deviation, seed) = (number(varied.log_deviation, 4), varied.seed);
        let all = format!("its logarithm by {deviation}, correlated over {along_x} and {along_y}, seed {seed}");
        Fact::new(format!("Random {name}"), all)
    }));
    let walls = scene.walls.iter();
    facts.extend(walls.map(|wall| Fact::new(format!("Wall {}", wall.wall), words.condition(&wall.condition))));
    facts.extend(scene.wall_parts.iter().enumerate().map(|(number, part)| {
        let patch = PatchId::Part(part.wall, number);
        Fact::new(words.patch(patch), words.condition(&part.condition))
    }));
    facts.extend(scene.gravity.map(|wall| Fact::new("Gravity", format!("towards the wall {wall}"))));
    facts.extend(of_water::solute(&words));
    facts.extend(scene.excavation.iter().map(|shaft| {
        let days = words.with(shaft.start / scene.time_unit.seconds(), scene.time_unit.symbol());
        let (radius, face) = (words.with(shaft.radius, "m"), words.condition(&shaft.condition));
        Fact::new("Shaft", format!("of radius {radius}, excavated after {days}; face: {face}"))
    }));
    facts.extend(scene.rings.iter().map(|ring| Fact::new("Pipes", words.ring(ring))));
    let materials = scene.materials.iter();
    facts.extend(materials.map(|material| Fact::new(format!("Material {}", material.name), words.material(material))));
    facts
}

/// Parts of a scene in words, with units where it has any.
struct Words<'a> {
    si: bool,
    scene: &'a Scene,
}

impl Words<'_> {
    fn with(&self, value: f64, unit: &str) -> String {
        if self.si && !unit.is_empty() { format!("{} {unit}", number(value, 4)) } else { number(value, 4) }
    }

    /// What a body or a wall has: a temperature, or a head of water.
    fn state(&self, value: f64) -> String {
        if self.scene.of_water { of_water::state(self, value) } else { self.with(value, "°C") }
    }

    /// The start of the body, outside of regions that have their own.
    fn start(&self) -> String {
        let Some(profile) = &self.scene.initial_profile else { return self.state(self.scene.initial_temperature) };
        let unit = if profile.of_heads { "m" } else { "°C" };
        let words = if profile.of_heads { "pressure head of " } else { "" };
        match &profile.values {
            ProfileValues::Axis { along_y, series: Series::Table(rows) } => {
                let [first, .., last] = &rows[..] else { return String::new() };
                let axis = if *along_y { "y" } else { "x" };
                let at = |row: &(f64, f64)| format!("{} at {axis} = {}", self.with(row.1, unit), self.with(row.0, "m"));
                format!("{words}{} to {}, by a table of {} places", at(first), at(last), rows.len())
            }
            ProfileValues::Axis { series, .. } => format!("{words}{}", self.series(series, unit)),
            ProfileValues::Formula { formula, range: (least, greatest) } => {
                let (least, greatest) = (number(*least, 4), self.with(*greatest, unit));
                format!("{words}{}, {least} to {greatest}", formula.text())
            }
        }
    }

    /// Heat that a region releases.
    fn power(&self, power: &Power) -> String {
        match power {
            Power::Even(series) => self.series(series, "W/m³"),
            Power::Formula(formula) => format!("{}{}", formula.text(), if self.si { " W/m³" } else { "" }),
        }
    }

    /// A wall or a part of one.
    fn patch(&self, patch: PatchId) -> String {
        match patch {
            PatchId::Part(wall, k) => match self.scene.wall_parts.get(k) {
                Some(part) => format!("Wall {wall} from {} to {}", number(part.from, 4), self.with(part.to, "m")),
                None => format!("Wall {wall}"),
            },
            PatchId::Whole(wall) => format!("Wall {wall}"),
            PatchId::Face => "Shaft".into(),
        }
    }

    fn point(&self, place: DVec2) -> String {
        format!("({}, {}){}", number(place.x, 4), number(place.y, 4), if self.si { " m" } else { "" })
    }

    fn series(&self, series: &Series, unit: &str) -> String {
        match series {
            Series::Constant(value) => self.with(*value, unit),
            Series::Table(rows) => format!("a table of {} instants", rows.len()),
            Series::Repeated { rows, .. } => format!("a repeated table of {} instants", rows.len()),
            Series::Formula(formula) => {
                format!("{}{}", formula.text(), if self.si { format!(" {unit}") } else { String::new() })
            }
        }
    }

    fn body(&self, domain: Domain) -> String {
        let metres = |value: f64| self.with(value, "m");
        match domain {
            Domain::Line { length } => format!("line of {}", metres(length)),
            Domain::Rectangle { width, height } => format!("{} by {}", metres(width), metres(height)),
            Domain::Ring { outer_radius, sector } => {
                format!("{} of a disc of radius {}", sector.name(), metres(outer_radius))
            }
            Domain::Radial { symmetry, inner, outer } => {
                format!("{} shells from radius {} to {}", symmetry.name(), metres(inner), metres(outer))
            }
            Domain::Axial { inner, outer, height } => {
                format!("around an axis from radius {} to {}, {} high", metres(inner), metres(outer), metres(height))
            }
        }
    }

    fn shape(&self, shape: &Shape) -> String {
        match shape {
            Shape::Box(cell) if cell.low.y.is_finite() => {
                format!("box from ({}, {}) to {}", number(cell.low.x, 4), number(cell.low.y, 4), self.point(cell.high))
            }
            Shape::Box(cell) => format!("from {} to {}", number(cell.low.x, 4), self.with(cell.high.x, "m")),
            Shape::Circle { centre, radius } => {
                format!("circle of radius {} around {}", self.with(*radius, "m"), self.point(*centre))
            }
            Shape::Ellipse(Ellipse { centre, half_axes, angle }) => {
                let (first, second) = (number(half_axes.x, 4), self.with(half_axes.y, "m"));
                let (turned, centre) = (number(angle.to_degrees(), 4), self.point(*centre));
                format!(
                    "ellipse of half axes {first} and {second}, the first at {turned}° to the x axis, around {centre}"
                )
            }
            Shape::Polygon(corners) => format!("polygon of {} corners", corners.len()),
        }
    }

    fn crack(&self, crack: &Crack) -> String {
        let growth = match &crack.growth {
            Growth::Whole { start } if *start == 0.0 => "from the start".to_owned(),
            Growth::Whole { start } => format!("from {} on", self.with(*start, "s")),
            Growth::Steady { start, speed } => {
                format!("grows from {} on at {}", self.with(*start, "s"), self.with(*speed, "m/s"))
            }
            Growth::Table(rows) => format!("grows by a table of {} instants", rows.len()),
        };
        format!("{} to {}, {growth}", self.point(crack.from), self.point(crack.to))
    }

    fn condition(&self, condition: &Condition) -> String {
        match condition {
            Condition::Periodic => "periodic".into(),
            Condition::Symmetry if self.scene.of_water => "mirror plane, no water crosses".into(),
            Condition::Flux(value) if self.scene.of_water => {
                format!("water flux into the body: {}", self.series(value, "m/s"))
            }
            Condition::Symmetry => "mirror plane, no heat crosses".into(),
            Condition::Temperature(Series::Constant(value)) => self.state(*value),
            Condition::Temperature(value) => self.series(value, "°C"),
            Condition::Flux(value) => format!("heat flux into the body: {}", self.series(value, "W/m²")),
            Condition::Film { kind, strength, ambient } => {
                let (name, unit) = kind.words();
                format!("{name} {} to {}", self.series(strength, unit), self.series(ambient, "°C"))
            }
            Condition::Runoff { rain, ponding } => of_water::runoff(self, rain, ponding),
            Condition::FreeDrainage => "water drains freely".into(),
            Condition::Exact => "temperature of the exact solution".into(),
        }
    }

    fn ring(&self, ring: &PipeRing) -> String {
        let (around, radius) = (self.with(ring.ring_radius, "m"), self.with(ring.pipe_radius, "m"));
        let condition = match &ring.condition {
            PipeCondition::Temperature(series) => format!("at {}", self.series(series, "°C")),
            PipeCondition::Film { coefficient, brine } => {
                format!("brine of {}, {}", self.series(brine, "°C"), self.with(*coefficient, "W/(m² K)"))
            }
            PipeCondition::Heat(series) => format!("heat into the ground: {}", self.series(series, "W/m")),
        };
        let (first, last) = (ring.place(0), ring.place(ring.count - 1));
        let places = match self.scene.domain {
            Domain::Ring { .. } => format!("on a circle of radius {around}"),
            _ => format!("from {} to {}", self.point(first), self.point(last)),
        };
        format!("{} {places}, each of radius {radius}, {condition}", ring.count)
    }

    fn material(&self, material: &Material) -> String {
        if let Some(soil) = &material.soil {
            return of_water::soil(self, soil);
        }
        let phase = |phase: Phase| {
            let (conductivity, capacity) = (phase.conductivity, phase.heat_capacity);
            format!("{}, {}", self.with(conductivity, "W/(m K)"), self.with(capacity, "J/(kg K)"))
        };
        format!(
            "frozen {}; unfrozen {}; density {}; freezes at {}; latent heat {}",
            phase(material.frozen),
            phase(material.unfrozen),
            self.with(material.density, "kg/m³"),
            self.with(material.freezing_point, "°C"),
            self.with(material.latent_heat, "J/kg"),
        )
    }
}
