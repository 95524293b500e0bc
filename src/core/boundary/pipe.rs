//! Freeze pipes: line sinks of true radius at their exact position.
//!
//! The ground is sampled and the heat spread with one regularised delta. The ground within the delta's own
//! effective radius belongs to the sink; the annulus from there to the pipe's wall is a resistance:
//! `q = (U_sampled - U_pipe) / R`, `R = S - c - ln(r/dx) / 2 pi`, `S = sum a_i a_j g_ij` (lattice Green's function).
//!
//! A film between brine and ground carries the same heat: `q = 2 pi r h (T_wall - T_brine)`, `q = (U_sampled - U(T_wall)) / R`.
//! That is the film of a flat wall with a depth of `2 pi r R`. A pipe of given heat has that heat as its `q`, and its wall
//! the temperature of `U_sampled - q R`. In ground that conducts by direction the annulus is that of an ellipse
//! ([`Green::far_field`]), and a film is one of the mean flux around the pipe.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::DVec2;

use crate::boundary::green::Green;
use crate::memory::HeapSize;
use crate::physics::film::Film;
use crate::physics::thermal::Thermal;
use crate::series::{Schedule, Series};
use crate::space::lattice::Lattice;

/// What is kept up at a pipe while it works.
#[derive(Debug, Clone, PartialEq)]
pub enum PipeCondition {
    /// Its outer wall has this temperature.
    Temperature(Series),
    /// Brine of this temperature flows in it.
    Film {
        /// Heat transfer coefficient between brine and ground (W/m2K), per area of the outer wall.
        coefficient: f64,
        /// Temperature of the brine.
        brine: Series,
    },
    /// The ground receives this heat (W/m): negative where the pipe takes it.
    Heat(Series),
}

impl PipeCondition {
    /// The temperature of its wall or of its brine, where the scene says one.
    pub fn temperature(&self) -> Option<&Series> {
        match self {
            PipeCondition::Temperature(series) | PipeCondition::Film { brine: series, .. } => Some(series),
            PipeCondition::Heat(_) => None,
        }
    }

    /// The heat that the ground receives (W/m), where the scene says it.
    pub fn heat(&self) -> Option<&Series> {
        match self {
            PipeCondition::Heat(series) => Some(series),
            PipeCondition::Temperature(_) | PipeCondition::Film { .. } => None,
        }
    }

    /// Heat transfer coefficient between brine and ground (W/m2K).
    pub fn film(&self) -> Option<f64> {
        match self {
            PipeCondition::Film { coefficient, .. } => Some(*coefficient),
            PipeCondition::Temperature(_) | PipeCondition::Heat(_) => None,
        }
    }

    /// What of it may change in time.
    pub fn series(&self) -> &Series {
        match self {
            PipeCondition::Temperature(series)
            | PipeCondition::Film { brine: series, .. }
            | PipeCondition::Heat(series) => series,
        }
    }
}

/// A freeze pipe: a circle of true radius at an exact position.
#[derive(Debug, Clone, PartialEq)]
pub struct Pipe {
    /// Centre (m).
    pub x: f64,
    /// Centre (m).
    pub y: f64,
    /// Outer radius of the pipe (m); 0 for one that is a single particle.
    pub radius: f64,
    /// Whether it is the particle nearest to its place, and has the radius that the lattice gives it.
    pub one_particle: bool,
    /// What is kept up at it while it works.
    pub condition: PipeCondition,
    /// When it works; always if absent. No heat crosses its wall at other times.
    pub schedule: Option<Arc<Schedule>>,
}

/// Stretches of the delta that are tried, in order.
const STRETCHES: [f64; 14] = [1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0];

/// Least resistance (in units of 1 / conductivity) that is accepted: below, the sink would limit the step.
const LEAST_RESISTANCE: f64 = 0.03;

/// Where a pipe is at work on particles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Ring to which the pipe belongs.
    pub ring: usize,
    /// Centre (m).
    pub centre: DVec2,
    /// Half width (m) of the particles that the heat is spread over.
    pub half_width: f64,
    /// Share of the pipe that belongs to this sector.
    pub share: f64,
    /// What the spread heat keeps from the field around the pipe (m2): the integral of the potential over the ground is
    /// greater by that much, times the heat that the pipe takes, than if the pipe were a line.
    pub smoothing: f64,
}

impl Extent {
    /// The particles of the sector that lie in it.
    pub fn particles(&self, lattice: &Lattice) -> Vec<u32> {
        let cells = lattice.to_cells(self.centre);
        let reach = (self.half_width / lattice.spacing).ceil() as i64;
        let (column, row) = (cells.x as i64, cells.y as i64);
        (row - reach..=row + reach)
            .flat_map(|row| (column - reach..=column + reach).map(move |column| (column, row)))
            .filter_map(|(column, row)| lattice.index(column, row).map(|index| index as u32))
            .collect()
    }
}

/// A pipe joined to particles.
#[derive(Debug, Clone)]
pub struct Sink {
    /// Ring to which the pipe belongs.
    pub ring: usize,
    /// Particles and the weights with which they are sampled; images behind mirror planes are folded in.
    pub sample: Vec<(u32, f64)>,
    /// Share of the pipe that belongs to this sector: 1/2 on a mirror plane.
    pub share: f64,
    /// Resistance between the sampled ground and the pipe's wall, times conductivity (-).
    pub resistance: f64,
    /// What is kept up at the pipe while it works.
    pub condition: PipeCondition,
    /// Radius of the pipe (m); 0 of a single particle.
    pub radius: f64,
    /// When the pipe works; always if absent.
    pub schedule: Option<Arc<Schedule>>,
    /// Where the delta is at work.
    pub extent: Extent,
}

/// Resistance (in units of 1 / conductivity) between a pipe of one particle and that particle: it makes the particle's
/// radius 3 % smaller than if it were held, and the step of explicit integrators six times shorter than its neighbours need.
const HELD_RESISTANCE: f64 = 0.005;

/// Peskin's four-point delta in one direction, at a distance in cells.
fn peskin(distance: f64) -> f64 {
    let r = distance.abs();
    if r <= 1.0 {
        (3.0 - 2.0 * r + (1.0 + 4.0 * r - 4.0 * r * r).max(0.0).sqrt()) / 8.0
    } else if r <= 2.0 {
        (5.0 - 2.0 * r - (-7.0 + 12.0 * r - 4.0 * r * r).max(0.0).sqrt()) / 8.0
    } else {
        0.0
    }
}

/// Cells and weights of a delta at `centre` (in cells), stretched.
fn delta(centre: DVec2, stretch: f64) -> Vec<((i64, i64), f64)> {
    let half = (2.0 * stretch).ceil() as i64;
    let (x0, y0) = (centre.x.floor() as i64, centre.y.floor() as i64);
    let mut cells: Vec<((i64, i64), f64)> = (y0 - half..=y0 + half + 1)
        .flat_map(|y| (x0 - half..=x0 + half + 1).map(move |x| (x, y)))
        .map(|(x, y)| {
            let weight = peskin((x as f64 - centre.x) / stretch) * peskin((y as f64 - centre.y) / stretch);
            ((x, y), weight)
        })
        .filter(|cell| cell.1 > 0.0)
        .collect();
    let total: f64 = cells.iter().map(|cell| cell.1).sum();
    cells.iter_mut().for_each(|cell| cell.1 /= total);
    cells
}

/// Widest offset between two cells of any delta that may be tried, capped to what the spacing needs.
pub fn green_reach(pipe_radius: f64, spacing: f64) -> usize {
    let stretch = STRETCHES.iter().copied().find(|s| *s >= 1.5 * pipe_radius / spacing + 1.0).unwrap_or(16.0);
    2 * ((2.0 * stretch).ceil() as usize + 1)
}

/// How a pipe takes hold of particles.
struct Hold {
    /// Particles and weights.
    sample: Vec<(u32, f64)>,
    /// Resistance between them and the pipe's wall, times conductivity (-).
    resistance: f64,
    /// Half width of the delta, in cells.
    half_width: f64,
    /// What the spread heat keeps from the field around the pipe, in cells.
    smoothing: f64,
}

/// How far the heat of a pipe is spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Delta {
    /// As little as leaves a resistance.
    Narrow,
    /// So far, where there is room, that it flattens the field around the pipe as much as the stencil makes it steeper, or more: a
    /// front within the horizon of the pipe gets too much heat otherwise.
    Flat,
}

/// Joins a pipe to the particles of a lattice, if it lies in their sector. `mirrors` tells for x and y whether the axis is a
/// mirror plane.
///
/// # Errors
/// A pipe too close to a wall, or too wide for the spacing.
pub fn immerse(
    pipe: &Pipe,
    ring: usize,
    lattice: &Lattice,
    mirrors: (bool, bool),
    (green, width): (&Green, Delta),
) -> Result<Option<Sink>, PipeError> {
    let centre = DVec2::new(pipe.x, pipe.y);
    let tolerance = 1e-9 * (centre.length() + lattice.spacing);
    if (mirrors.0 && centre.x < -tolerance) || (mirrors.1 && centre.y < -tolerance) {
        return Ok(None);
    }
    let on_plane = |mirror: bool, distance: f64| mirror && distance.abs() <= tolerance;
    let share =
        if on_plane(mirrors.0, centre.x) { 0.5 } else { 1.0 } * if on_plane(mirrors.1, centre.y) { 0.5 } else { 1.0 };
    let (hold, radius) = match pipe.one_particle {
        true => (hold_one(pipe, lattice, green)?, 0.0),
        false => (spread(pipe, lattice, mirrors, (green, width))?, pipe.radius),
    };
    let smoothing = hold.smoothing * lattice.spacing * lattice.spacing;
    Ok(Some(Sink {
        ring,
        sample: hold.sample,
        share,
        resistance: hold.resistance,
        condition: pipe.condition.clone(),
        radius,
        schedule: pipe.schedule.clone(),
        extent: Extent { ring, centre, half_width: hold.half_width * lattice.spacing, share, smoothing },
    }))
}

/// The hold of a pipe that is one particle.
fn hold_one(pipe: &Pipe, lattice: &Lattice, green: &Green) -> Result<Hold, PipeError> {
    let place = lattice.to_cells(DVec2::new(pipe.x, pipe.y)).round();
    let index = lattice.index(place.x as i64, place.y as i64).ok_or_else(|| outside(pipe, lattice, 1.0))?;
    let sample = vec![(index as u32, 1.0)];
    Ok(Hold { sample, resistance: HELD_RESISTANCE, half_width: 1.0, smoothing: -green.spread })
}

/// The hold of a pipe on particles around it, by the narrowest delta that leaves a resistance, or one that is flat.
fn spread(
    pipe: &Pipe,
    lattice: &Lattice,
    mirrors: (bool, bool),
    (green, width): (&Green, Delta),
) -> Result<Hold, PipeError> {
    let centre = lattice.to_cells(DVec2::new(pipe.x, pipe.y));
    let mut narrowest = None;
    for stretch in STRETCHES {
        let cells = delta(centre, stretch);
        let widest = cells
            .iter()
            .map(|((x, y), _)| ((*x as f64 - centre.x).abs().max((*y as f64 - centre.y).abs())).ceil() as usize);
        if 2 * widest.max().unwrap_or(0) > green.reach() + 1 {
            break;
        }
        let own: f64 = cells
            .iter()
            .flat_map(|((x, y), a)| cells.iter().map(move |((u, v), b)| a * b * green.at(x - u, y - v)))
            .sum();
        let resistance = own - green.far_constant - green.far_field(pipe.radius / lattice.spacing);
        if resistance < LEAST_RESISTANCE {
            continue;
        }
        // Both the delta and the stencil leave a field that is flatter, or steeper, than that of a line: in Fourier space
        // (1 - M k^2 / 4) (1/k^2 + c) for 1/k^2, M the second moment of the delta.
        let moment: f64 =
            cells.iter().map(|((x, y), a)| a * DVec2::new(*x as f64, *y as f64).distance_squared(centre)).sum();
        let smoothing = 0.25 * moment / green.conducts() - green.spread;
        let Some(sample) = folded(&cells, lattice, mirrors) else {
            return narrowest.ok_or_else(|| outside(pipe, lattice, stretch));
        };
        let hold = Hold { sample, resistance, half_width: 2.0 * stretch, smoothing };
        if width == Delta::Narrow || smoothing >= 0.0 {
            return Ok(hold);
        }
        narrowest = narrowest.or(Some(hold));
    }
    let too_wide = PipeError::TooWide { radius: pipe.radius, spacing: lattice.spacing, needed: pipe.radius / 6.0 };
    narrowest.ok_or(too_wide)
}

/// Particles and weights of cells, those behind mirror planes with their images; none if one lies outside.
fn folded(cells: &[((i64, i64), f64)], lattice: &Lattice, mirrors: (bool, bool)) -> Option<Vec<(u32, f64)>> {
    let fold = |mirror: bool, cell: i64| if mirror && cell < 0 { -1 - cell } else { cell };
    let mut sample: Vec<(u32, f64)> = Vec::with_capacity(cells.len());
    for ((x, y), weight) in cells {
        let index = lattice.index(fold(mirrors.0, *x), fold(mirrors.1, *y))?;
        match sample.iter_mut().find(|entry| entry.0 as usize == index) {
            Some(entry) => entry.1 += weight,
            None => sample.push((index as u32, *weight)),
        }
    }
    sample.sort_unstable_by_key(|entry| entry.0);
    Some(sample)
}

fn outside(pipe: &Pipe, lattice: &Lattice, stretch: f64) -> PipeError {
    let spacing = lattice.spacing;
    PipeError::AtWall { x: pipe.x, y: pipe.y, spacing, needed: (2.0 * stretch + 1.0) * spacing }
}

/// Why particles cannot stand for a pipe (lengths in m).
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PipeError {
    /// Particles around it lie beyond a wall.
    #[error(
        "the pipe at ({x:.4}, {y:.4}) m lies too close to a wall for particles {spacing} m apart: {needed:.3} m are needed"
    )]
    AtWall {
        /// Its place.
        x: f64,
        /// Its place.
        y: f64,
        /// Distance of particles.
        spacing: f64,
        /// Distance from walls that it needs.
        needed: f64,
    },
    /// It would hold more particles than a line of heat stands for.
    #[error(
        "the pipe of radius {radius} m is too wide for a line sink on particles {spacing} m apart; a spacing of at least \
         {needed:.3} m is needed"
    )]
    TooWide {
        /// Its radius.
        radius: f64,
        /// Distance of particles.
        spacing: f64,
        /// The one that it needs.
        needed: f64,
    },
}

/// Radius (m) as which a pipe of one particle acts: that of a particle held at the pipe's temperature, less what the
/// resistance between both takes off.
pub fn radius_of_one_particle(green: &Green, spacing: f64) -> f64 {
    spacing * green.one_particle_radius() * (-TAU * green.conducts() * HELD_RESISTANCE).exp()
}

impl HeapSize for Sink {
    fn heap_size(&self) -> usize {
        self.sample.heap_size()
    }
}

impl Sink {
    /// Whether heat crosses the pipe's wall in a step that begins at `time` (s). Steps land on switches.
    #[inline]
    pub fn works(&self, time: f64) -> bool {
        self.schedule.as_ref().is_none_or(|schedule| schedule.works(time))
    }

    /// What the pipe sees of a quantity of its particles.
    #[inline]
    pub fn sampled(&self, value: impl Fn(usize) -> f64) -> f64 {
        self.sample.iter().map(|(index, weight)| weight * value(*index as usize)).sum()
    }

    /// Area of the ground in whose place the pipe stands (m2).
    pub fn area(&self) -> f64 {
        PI * self.radius * self.radius
    }

    /// Enthalpy (J/m3) that what stands in the place of ground of a material and an enthalpy has at the start: that at the pipe's
    /// temperature; in a pipe that only takes heat, that at which the ground would have given off its latent heat; else that of the
    /// ground.
    pub fn content(&self, thermal: &Thermal, ground: f64) -> f64 {
        match &self.condition {
            PipeCondition::Temperature(series) | PipeCondition::Film { brine: series, .. } => {
                thermal.enthalpy(series.at(0.0))
            }
            PipeCondition::Heat(given) if given.range().1 <= 0.0 && thermal.curve.latent_heat() > 0.0 => {
                let frozen = thermal.enthalpy(thermal.curve.freezing_point()) - thermal.curve.latent_heat();
                frozen.min(ground)
            }
            PipeCondition::Heat(_) => ground,
        }
    }

    /// Perimeter of the pipe (m).
    fn perimeter(&self) -> f64 {
        TAU * self.radius
    }

    /// Potential (W/m, relative) of what is kept up at `time` (s), where that is a temperature.
    #[inline]
    pub fn own_potential(&self, time: f64, thermal: &Thermal) -> f64 {
        self.condition.temperature().map_or(0.0, |series| thermal.potential_at(series.at(time)))
    }

    /// Heat (W/m) that the whole pipe takes from the ground at `time` (s), by what it sees of potentials (W/m, relative)
    /// and the potential of its own temperature.
    #[inline]
    pub fn heat(&self, sampled: f64, own: f64, time: f64, thermal: &Thermal) -> f64 {
        match &self.condition {
            PipeCondition::Temperature(_) => (sampled - own) / self.resistance,
            PipeCondition::Film { coefficient, brine } => {
                let film = Film::convection(*coefficient, brine.at(time));
                let inside = sampled + thermal.zero_potential;
                -self.perimeter() * thermal.curve.film_flux(inside, self.perimeter() * self.resistance, &film)
            }
            PipeCondition::Heat(given) => -given.at(time),
        }
    }

    /// Temperature of the pipe's outer wall at `time` (s), by what it sees of potentials (W/m, relative).
    pub fn wall_temperature(&self, sampled: f64, time: f64, thermal: &Thermal) -> f64 {
        let taken =
            if self.works(time) { self.heat(sampled, self.own_potential(time, thermal), time, thermal) } else { 0.0 };
        thermal.curve.temperature_of_potential(sampled + thermal.zero_potential - taken * self.resistance)
    }

    /// Resistance with which small changes around a state meet the pipe.
    pub fn resistance_to_changes(&self, sampled: f64, time: f64, thermal: &Thermal) -> f64 {
        match &self.condition {
            PipeCondition::Temperature(_) => self.resistance,
            PipeCondition::Film { coefficient, brine } => {
                let film = Film::convection(*coefficient, brine.at(time));
                let inside = sampled + thermal.zero_potential;
                let slope = thermal.curve.film_slope(inside, self.perimeter() * self.resistance, &film);
                -1.0 / (self.perimeter() * slope)
            }
            PipeCondition::Heat(_) => f64::INFINITY,
        }
    }

    /// Whether small changes meet the pipe alike at all times and in all states.
    pub fn is_constant(&self) -> bool {
        self.condition.film().is_none() && (self.schedule.is_none() || self.condition.heat().is_some())
    }

    /// The sink for small changes around a state.
    pub(crate) fn still(&self) -> Sink {
        Sink { condition: PipeCondition::Temperature(Series::Constant(0.0)), ..self.clone() }
    }

    /// What the sink adds to the row sum of a particle (m^-2), by particle.
    pub fn row_sums(&self, spacing: f64) -> impl Iterator<Item = (usize, f64)> + '_ {
        let is_held = self.condition.heat().is_none();
        let scale = if is_held { self.share / (self.resistance * spacing * spacing) } else { 0.0 };
        self.sample.iter().map(move |(index, weight)| (*index as usize, weight * weight * scale))
    }
}

#[cfg(test)]
mod tests;
