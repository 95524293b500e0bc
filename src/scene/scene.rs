//! The physics of a run: body, materials, walls, pipes, water, and what is observed.

use frazil_core::balances::groundwater::ground::Flow;
use frazil_core::balances::heated::Power;
use frazil_core::boundary::condition::Condition;
use frazil_core::boundary::pipe::Pipe;
use frazil_core::breakage::crack::{Crack, Growth};
use frazil_core::formula::Formula;
use frazil_core::physics::material::Material;
use frazil_core::series::Series;
use frazil_core::space::domain::{Domain, Surface};
use frazil_core::space::wall::{PatchId, WallId};
use glam::DVec2;

use crate::TimeUnit;
use crate::measured::Measured;
use crate::method::MethodSettings;
use crate::pipe_ring::PipeRing;
use crate::profile::Profile;
use crate::random::RandomGround;
use crate::region::{Region, Shape};
use crate::solute::Solute;
use crate::stream::Stream;
use crate::units::Units;

/// One wall of the domain.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    /// Which one it is.
    pub wall: WallId,
    /// What happens there.
    pub condition: Condition,
}

/// A part of a wall that has a condition of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct WallPart {
    /// The wall.
    pub wall: WallId,
    /// Where it begins along the wall (m): in z on the inner and outer wall, in r on others.
    pub from: f64,
    /// Where it ends (m).
    pub to: f64,
    /// What happens there.
    pub condition: Condition,
}

/// Ground around the centre of a ring that is dug out: a shaft.
#[derive(Debug, Clone, PartialEq)]
pub struct Excavation {
    /// Radius (m) of the shaft.
    pub radius: f64,
    /// When the ground is gone (s).
    pub start: f64,
    /// What happens at the face from then on.
    pub condition: Condition,
}

/// What is observed, and when.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Watch {
    /// Number of evenly spaced output instants up to the end; the start is not one of them.
    pub outputs: usize,
    /// Instants (s) at which profiles are kept.
    pub profiles: Vec<f64>,
    /// Points (m) whose temperature is kept at every output.
    pub probes: Vec<(f64, f64)>,
    /// Surfaces through which heat is counted at every output.
    pub surfaces: Vec<Surface>,
    /// Lines along which profiles are kept, in bodies of two dimensions; [`Scene::cuts`] has those of every scene.
    pub cuts: Vec<Surface>,
    /// Regions over which temperature, frozen fraction and heat are integrated at every output.
    pub regions: Vec<Shape>,
    /// Temperatures whose isotherms are kept at every output.
    pub isotherms: Vec<f64>,
    /// Part of the body (m along x) whose shares of liquid, freezing and solid particles are kept at every output.
    pub phases: Option<(f64, f64)>,
    /// Whether neighbouring pipes and sections of the frozen wall are watched, in a ring.
    pub frozen_wall: bool,
    /// Whether fronts that run from corners between two cold walls are kept at every output.
    pub corner_front: bool,
    /// Profiles and their errors end at this distance (m) from the wall; the whole domain if absent.
    pub profile_length: Option<f64>,
    /// Start (s) of the window over which the front is judged; where it has come some spacings if absent.
    pub front_from: Option<f64>,
    /// Instants (s) at which something was measured that a run is compared with: outputs beside the even ones, in order.
    pub measured: Vec<f64>,
}

/// Where the truth about a scene comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum ReferenceChoice {
    /// A closed form or a similarity solution, if the scene fits one.
    Exact,
    /// A table shipped with the program, by name.
    Table(String),
    /// What instruments have measured.
    Measured(Measured),
    /// A formula of the temperature by place and time.
    Formula(Formula),
    /// The local method on finer lattices, accepted only if shown converged.
    Local,
    /// Whatever of the above fits first, in that order.
    Auto,
    /// Nothing: no errors are asked for.
    None,
}

impl ReferenceChoice {
    /// Whether it may be the exact solution that a wall follows.
    pub fn may_be_exact(&self) -> bool {
        matches!(self, ReferenceChoice::Exact | ReferenceChoice::Auto)
    }
}

/// Where a plane front runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreezingDirection {
    /// Along y instead of x.
    pub along_y: bool,
    /// Length of the domain in that direction (m).
    pub length: f64,
    /// Extent across it (m); 1 on a line.
    pub across: f64,
    /// Whether the front starts at the far wall (right or top).
    pub from_end: bool,
}

impl FreezingDirection {
    /// Distance (m) from the wall at which the front starts to a coordinate (m).
    pub fn distance(&self, coordinate: f64) -> f64 {
        if self.from_end { self.length - coordinate } else { coordinate }
    }
}

/// A whole checked scene.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Short name: the file's stem or the bundled name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Where the parameters come from.
    pub source: String,
    /// Units of all numbers below.
    pub units: Units,
    /// Unit for times in figures and messages.
    pub time_unit: TimeUnit,
    /// Whether it is of unsaturated water instead of heat: what is called temperature is then the place of the pressure head
    /// on the scale of [`frazil_core::physics::retention::scale`].
    pub of_water: bool,
    /// The body.
    pub domain: Domain,
    /// End of the run (s).
    pub duration: f64,
    /// Conductivity along x and along y, over that of the materials.
    pub along: DVec2,
    /// Materials; the first fills the domain.
    pub materials: Vec<Material>,
    /// Parts of other materials or other starts; later ones win.
    pub regions: Vec<Region>,
    /// Segments that no heat crosses.
    pub cracks: Vec<Crack>,
    /// Parts of the body that nothing enters.
    pub impermeable: Vec<Shape>,
    /// Temperature at the start, where regions say nothing else; the middle of the range where it varies.
    pub initial_temperature: f64,
    /// How it varies, if it does.
    pub initial_profile: Option<Profile>,
    /// The walls of the domain that are not mirror planes of a sector.
    pub walls: Vec<Wall>,
    /// Parts of them with conditions of their own; later ones win.
    pub wall_parts: Vec<WallPart>,
    /// Rings of freeze pipes.
    pub rings: Vec<PipeRing>,
    /// The shaft, where it is dug during the run.
    pub excavation: Option<Excavation>,
    /// Groundwater, where it flows.
    pub flow: Option<Flow>,
    /// The wall that gravity pulls unsaturated water towards, where it does.
    pub gravity: Option<WallId>,
    /// What the water carries, in a scene of unsaturated water.
    pub solute: Option<Solute>,
    /// Which properties of the ground vary at random in place.
    pub random: RandomGround,
    /// What drives the liquid itself, where it moves.
    pub stream: Option<Stream>,
    /// Observation.
    pub watch: Watch,
    /// Where the truth comes from.
    pub reference: ReferenceChoice,
    /// Numerical settings for each method that the file names, in the order of the registry.
    pub methods: Vec<MethodSettings>,
    /// Files that it names, as name and text.
    pub files: Vec<(String, String)>,
    /// Hash of the effective file (after `--set`) and of the files that it names, as 16 hexadecimal digits.
    pub hash: String,
    /// What of the file was not taken as it stands, in words.
    pub remarks: Vec<String>,
}

/// Whether any of these conditions is a flux, or any of these pipes of given heat.
pub(crate) fn has_flux<'a>(mut conditions: impl Iterator<Item = &'a Condition>, rings: &[PipeRing]) -> bool {
    conditions.any(|condition| matches!(condition, Condition::Flux(_)))
        || rings.iter().any(|ring| ring.condition.heat().is_some())
}

/// Parts of a scene that name temperatures, beside its start and its walls.
pub(crate) struct Temperatures<'a> {
    pub(crate) profile: Option<&'a Profile>,
    pub(crate) regions: &'a [Region],
    pub(crate) rings: &'a [PipeRing],
    pub(crate) stream: Option<&'a Stream>,
}

impl Temperatures<'_> {
    /// Least and greatest of all of them.
    pub(crate) fn range<'a>(&self, initial: f64, conditions: impl Iterator<Item = &'a Condition>) -> (f64, f64) {
        let mut range = (initial, initial);
        for temperature in self.regions.iter().filter_map(|region| region.temperature) {
            range = (range.0.min(temperature), range.1.max(temperature));
        }
        if let Some((lo, hi)) = self.profile.map(Profile::range) {
            range = (range.0.min(lo), range.1.max(hi));
        }
        let mut widen = |series: &Series| {
            let (lo, hi) = series.range();
            range = (range.0.min(lo), range.1.max(hi));
        };
        for condition in conditions {
            condition.temperature().into_iter().for_each(&mut widen);
        }
        for ring in self.rings {
            ring.condition.temperature().into_iter().for_each(&mut widen);
        }
        if let Some((_, temperature)) = self.stream.and_then(|stream| stream.reset) {
            range = (range.0.min(temperature), range.1.max(temperature));
        }
        range
    }
}

impl Scene {
    /// A body of materials for a time (s), of which the first fills it, at 0 degrees and without anything else: what programs
    /// begin with that make scenes of their own.
    pub fn bare(domain: Domain, duration: f64, materials: Vec<Material>) -> Self {
        Scene {
            name: "bare".into(),
            title: String::new(),
            source: String::new(),
            units: Units::Si,
            time_unit: TimeUnit::Second,
            of_water: false,
            domain,
            duration,
            along: DVec2::ONE,
            materials,
            regions: Vec::new(),
            cracks: Vec::new(),
            impermeable: Vec::new(),
            initial_temperature: 0.0,
            initial_profile: None,
            walls: Vec::new(),
            wall_parts: Vec::new(),
            rings: Vec::new(),
            excavation: None,
            flow: None,
            gravity: None,
            solute: None,
            random: RandomGround::default(),
            stream: None,
            watch: Watch { outputs: 10, ..Watch::default() },
            reference: ReferenceChoice::Auto,
            methods: Vec::new(),
            files: Vec::new(),
            hash: String::new(),
            remarks: Vec::new(),
        }
    }

    /// Whether its ground conducts alike in all directions.
    pub fn conducts_alike(&self) -> bool {
        self.along == DVec2::ONE
    }

    /// Whether anything inside the body stops what moves through it: cracks, or parts that nothing enters.
    pub fn has_barriers(&self) -> bool {
        !self.cracks.is_empty() || !self.impermeable.is_empty()
    }

    /// Whether a part that nothing enters lies on the straight way between two points (m).
    pub fn is_blocked(&self, from: DVec2, to: DVec2) -> bool {
        self.impermeable.iter().any(|shape| shape.stands_between(from, to))
    }

    /// Whether a point (m) lies in a part that nothing enters.
    pub fn is_impermeable_at(&self, point: DVec2) -> bool {
        self.impermeable.iter().any(|shape| shape.contains(point))
    }

    /// Parts of walls at which heat, or water, does something else than at the rest of their wall; none where what differs is
    /// the solute that enters.
    pub fn conducting_parts(&self) -> &[WallPart] {
        let alike = |part: &WallPart| self.wall(part.wall) == Some(&part.condition);
        if self.wall_parts.iter().all(alike) { &[] } else { &self.wall_parts }
    }

    /// What happens at all walls and parts of them, and at the face of the shaft.
    pub fn conditions(&self) -> impl Iterator<Item = &Condition> {
        let parts = self.wall_parts.iter().map(|part| &part.condition);
        let face = self.excavation.iter().map(|shaft| &shaft.condition);
        self.walls.iter().map(|wall| &wall.condition).chain(parts).chain(face)
    }

    /// Least and greatest temperature that data of the scene name: start, walls, pipes.
    pub fn temperature_range(&self) -> (f64, f64) {
        let profile = self.initial_profile.as_ref();
        let data = Temperatures { profile, regions: &self.regions, rings: &self.rings, stream: self.stream.as_ref() };
        data.range(self.initial_temperature, self.conditions())
    }

    /// Whether any of its materials freezes.
    pub fn freezes(&self) -> bool {
        self.materials.iter().any(Material::freezes)
    }

    /// The direction in which a plane front runs, if the scene has one: along a line, or along the one axis of a
    /// rectangle in which nothing varies across it. It starts at the wall that drives harder.
    pub fn freezing_direction(&self) -> Option<FreezingDirection> {
        let (along_y, length, across) = match self.domain {
            Domain::Line { length } => (false, length, 1.0),
            Domain::Rectangle { width, height } if self.is_even_along(true) => (false, width, height),
            Domain::Rectangle { width, height } if self.is_even_along(false) => (true, height, width),
            _ => return None,
        };
        let [near, far] = WallId::ends(along_y);
        // A wall that drives the front has a temperature of its own; the colder of two is the start.
        Some(FreezingDirection { along_y, length, across, from_end: self.drive(far) > self.drive(near) })
    }

    /// Whether it has one front, whose place is kept over time.
    pub fn has_front(&self) -> bool {
        let radial = matches!(self.domain, Domain::Radial { .. });
        radial || self.watch.corner_front || self.freezing_direction().is_some()
    }

    /// How hard a wall drives the front: by its temperature, or that of its surroundings, against the start (K), or else by its
    /// flux (W/m2).
    pub fn drive(&self, wall: WallId) -> f64 {
        let Some(condition) = self.wall(wall) else { return 0.0 };
        match (condition.temperature(), condition) {
            (Some(series), _) => (series.at(self.duration) - self.initial_temperature).abs(),
            (None, Condition::Flux(series)) => series.range().0.abs().max(series.range().1.abs()),
            (None, _) => 0.0,
        }
    }

    /// Whether a wall is warmer at the end than the start, or brings heat in.
    pub fn warms(&self, wall: WallId) -> bool {
        let Some(condition) = self.wall(wall) else { return false };
        match (condition.temperature(), condition) {
            (Some(series), _) => series.at(self.duration) > self.initial_temperature,
            (None, Condition::Flux(series)) => series.at(self.duration) > 0.0,
            (None, _) => false,
        }
    }

    /// Whether nothing in a rectangle varies along y, or along x: no heat and no water crosses its walls there, regions
    /// reach from one to the other, and there are neither ground that varies nor cracks nor parts of walls with other conditions nor
    /// parts of the body that are driven.
    fn is_even_along(&self, y: bool) -> bool {
        let Domain::Rectangle { width, height } = self.domain else { return false };
        let ends = WallId::ends(y);
        let dry = |flow: &Flow| {
            let through = flow.walls.iter().any(|wall| ends.contains(&wall.wall));
            !through && (flow.gravity == 0.0 || !y)
        };
        let reaches = |region: &Region| match &region.shape {
            Shape::Box(cell) if y => cell.low.y <= 0.0 && cell.high.y >= height,
            Shape::Box(cell) => cell.low.x <= 0.0 && cell.high.x >= width,
            Shape::Circle { .. } | Shape::Ellipse(_) | Shape::Polygon(_) => false,
        };
        let driven = |stream: &Stream| stream.pump.is_some() || stream.reset.is_some();
        ends.into_iter().all(|wall| self.is_closed(wall))
            && self.flow.as_ref().is_none_or(dry)
            && !self.gravity.is_some_and(|towards| ends.contains(&towards))
            && !self.initial_profile.as_ref().is_some_and(|profile| profile.varies_along(y))
            && self.regions.iter().all(reaches)
            && !self.has_barriers()
            && self.rings.is_empty()
            && self.random.is_even()
            && self.conducting_parts().is_empty()
            && !self.stream.as_ref().is_some_and(driven)
    }

    /// Lines along which profiles are kept: those that the scene names, or, in a rectangle without a plane front, those
    /// through its middle.
    pub fn cuts(&self) -> Vec<Surface> {
        match self.domain {
            Domain::Rectangle { width, height }
                if self.watch.cuts.is_empty() && self.freezing_direction().is_none() =>
            {
                vec![Surface { across_y: true, at: 0.5 * height }, Surface { across_y: false, at: 0.5 * width }]
            }
            _ => self.watch.cuts.clone(),
        }
    }

    /// Whether a flux condition, a source of heat, pipes of given heat or the weight of water can drive temperatures beyond
    /// [`Scene::temperature_range`].
    pub fn has_flux(&self) -> bool {
        self.gravity.is_some() || self.has_heat_sources() || has_flux(self.conditions(), &self.rings)
    }

    /// Whether a wall or a part of one has a flux or a film.
    pub fn brings_heat(&self) -> bool {
        self.conditions().any(Condition::brings_heat)
    }

    /// The first instant after `t` (s) at which pipes are switched or the shaft is dug: steps land on it.
    pub fn next_switch(&self, t: f64) -> Option<f64> {
        let schedules = self.rings.iter().filter_map(|ring| ring.schedule.as_ref());
        let dug = self.excavation.iter().map(|shaft| shaft.start).filter(|start| *start > t);
        schedules.filter_map(|schedule| schedule.next_switch(t)).chain(dug).reduce(f64::min)
    }

    /// The first instant after `t` (s) at which the temperature, flux or film of a wall, the temperature or heat of pipes or a source
    /// of heat bends, jumps or turns, or a crack opens or begins to grow: long steps land on it.
    pub fn next_bend(&self, t: f64) -> Option<f64> {
        let walls = self.conditions().flat_map(Condition::series);
        let rings = self.rings.iter().map(|ring| ring.condition.series());
        let sources = self.regions.iter().filter_map(|region| match &region.heat {
            Some(Power::Even(series)) => Some(series),
            Some(Power::Formula(_)) | None => None,
        });
        let bends = walls.chain(rings).chain(sources).filter_map(|series| series.next_bend(t));
        let cracks = self.cracks.iter().flat_map(|crack| match &crack.growth {
            Growth::Whole { start } | Growth::Steady { start, .. } => vec![*start],
            Growth::Table(rows) => rows.iter().map(|row| row.0).collect(),
        });
        bends.chain(cracks.filter(|instant| *instant > t)).reduce(f64::min)
    }

    /// All pipes of all rings.
    pub fn pipes(&self) -> Vec<Pipe> {
        self.rings.iter().flat_map(PipeRing::pipes).collect()
    }

    /// The condition at a wall.
    pub fn wall(&self, wall: WallId) -> Option<&Condition> {
        self.walls.iter().find(|other| other.wall == wall).map(|wall| &wall.condition)
    }

    /// The condition at a place (m) along a wall: that of the last of its parts there, or else of the wall.
    pub fn wall_at(&self, wall: WallId, along: f64) -> Option<&Condition> {
        let is_there = |part: &&WallPart| part.wall == wall && along >= part.from && along < part.to;
        let part = self.wall_parts.iter().rev().find(is_there);
        part.map(|part| &part.condition).or_else(|| self.wall(wall))
    }

    /// Area of a wall of a line or a rectangle without its parts, or of a part without those that win over it (m2 across a line,
    /// m by depth of a plane).
    pub fn area_of(&self, patch: PatchId) -> Option<f64> {
        let (Domain::Line { .. } | Domain::Rectangle { .. }) = self.domain else { return None };
        let wall = patch.wall()?;
        let Domain::Rectangle { width, height } = self.domain else { return Some(1.0) };
        let length = if wall.is_across_y() { width } else { height };
        let parts = || self.conducting_parts().iter().enumerate().filter(|(_, part)| part.wall == wall);
        let mut ends: Vec<f64> = parts().flat_map(|(_, part)| [part.from, part.to]).chain([0.0, length]).collect();
        ends.sort_by(f64::total_cmp);
        let owner = |middle: f64| {
            let part = parts().rfind(|(_, part)| (part.from..part.to).contains(&middle));
            part.map_or(PatchId::Whole(wall), |(number, _)| PatchId::Part(wall, number))
        };
        let own = ends.windows(2).filter(|ends| owner(0.5 * (ends[0] + ends[1])) == patch);
        Some(own.map(|ends| ends[1] - ends[0]).sum())
    }

    /// Whether no heat leaves through a wall and its parts, or the domain has no such wall.
    pub fn is_closed(&self, wall: WallId) -> bool {
        let mut parts = self.wall_parts.iter().filter(|part| part.wall == wall);
        let closed = |condition: &Condition| matches!(condition, Condition::Symmetry | Condition::Periodic);
        self.wall(wall).is_none_or(closed) && parts.all(|part| part.condition == Condition::Symmetry)
    }

    /// The settings of a method, if the scene has them.
    pub fn method(&self, name: &str) -> Option<&MethodSettings> {
        self.methods.iter().find(|method| method.method == name)
    }
}
