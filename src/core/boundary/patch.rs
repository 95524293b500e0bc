//! Walls: what a ghost holds. Written once for lattice rows and for lists of ghost particles.
//!
//! Walls lie half-way between particles. A ghost mirrors a particle (or a moving-least-squares value) at the same
//! depth on the other side: odd about the wall's potential for a temperature, even for symmetry, even plus the
//! wanted slope for a flux. A linear profile is met exactly, whatever the reach of the method.

use std::sync::Arc;

use glam::DVec2;

use crate::boundary::condition::Condition;
use crate::boundary::runoff::Runoff;
use crate::physics::curve::Curve;
use crate::physics::film::Film;
use crate::physics::thermal::Thermal;
use crate::space::wall::{PatchId, WallId};

/// Walls and parts of walls that a body may have.
pub const MOST_PATCHES: usize = 24;

/// Share of a spacing that rounding may make of none.
const ROUNDING: f64 = 1e-9;

/// A stretch of a wall: from where to where along it (m), and its patch.
pub type Stretch = (f64, f64, usize);

/// Temperature of a wall at a time (s), where it is known.
pub type WallTemperature = Arc<dyn Fn(f64) -> Option<f64> + Send + Sync>;

/// A wall that heat may cross.
#[derive(Clone)]
pub struct Patch {
    /// Which one it is.
    pub id: PatchId,
    /// Condition.
    pub condition: Condition,
    /// Ghosts hold the wall's own value instead of being mirrored ([`crate::boundary::wall_layers`]).
    pub layers: bool,
    /// Whether the condition changes in time.
    pub changes: bool,
    /// How much of gravity pulls into the body here: 1 at its top, -1 below it.
    pub falls: f64,
    /// The exact solution, for walls that follow it.
    pub exact: Option<WallTemperature>,
}

/// A wall at one instant, in potentials relative to the initial state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Face {
    /// Mirror.
    Even,
    /// Ghosts are twice the wall's value less their image.
    Odd {
        /// Potential (W/m) at the wall.
        wall: f64,
        /// Temperature at the wall.
        temperature: f64,
    },
    /// Ghosts are the wall's value.
    Held {
        /// Potential (W/m) at the wall.
        wall: f64,
        /// Temperature at the wall.
        temperature: f64,
    },
    /// Ghosts carry the slope of a flux (W/m2) into the body.
    Flux(f64),
    /// Ghosts carry the slope of the flux through a film.
    Film {
        /// What passes.
        film: Film,
        /// Depths of a ghost that heat is conducted through behind the film: one to a mirror, and all of two to a layer
        /// of one value.
        through: f64,
    },
    /// Ghosts carry the slope of what of the rain enters, or of what a greatest head lets in or out.
    Runoff(Runoff),
}

impl Face {
    /// Potential of a ghost whose image holds `image`, `depth` (m) behind the wall.
    #[inline(always)]
    pub fn ghost(&self, image: f64, depth: f64, curve: &Curve, zero_potential: f64) -> f64 {
        match *self {
            Face::Even => image,
            Face::Odd { wall, .. } => 2.0 * wall - image,
            Face::Held { wall, .. } => wall,
            Face::Flux(flux) => image + 2.0 * depth * flux,
            Face::Film { ref film, through } => {
                image + 2.0 * depth * curve.film_flux(image + zero_potential, through * depth, film)
            }
            Face::Runoff(ref runoff) => {
                image + 2.0 * depth * runoff.flux(image, runoff.through * depth, curve, zero_potential)
            }
        }
    }

    /// The wall as small changes of potentials meet it.
    pub fn homogeneous(&self) -> Face {
        match *self {
            Face::Even | Face::Flux(_) => Face::Even,
            Face::Odd { .. } => Face::Odd { wall: 0.0, temperature: 0.0 },
            Face::Held { .. } => Face::Held { wall: 0.0, temperature: 0.0 },
            Face::Film { .. } | Face::Runoff(_) => *self,
        }
    }

    /// Change of a ghost with its image, at the same place.
    pub fn ghost_slope(&self, image: f64, depth: f64, curve: &Curve, zero_potential: f64) -> f64 {
        match *self {
            Face::Even | Face::Flux(_) => 1.0,
            Face::Odd { .. } => -1.0,
            Face::Held { .. } => 0.0,
            Face::Film { ref film, through } => {
                1.0 + 2.0 * depth * curve.film_slope(image + zero_potential, through * depth, film)
            }
            Face::Runoff(ref runoff) => {
                1.0 + 2.0 * depth * runoff.slope(image, runoff.through * depth, curve, zero_potential)
            }
        }
    }

    /// Heat flux (W/m2) into the body by the linear profile through the wall and a particle of this potential (W/m,
    /// relative) at a depth (m).
    #[inline]
    pub fn flux(&self, potential: f64, depth: f64, thermal: &Thermal) -> f64 {
        match *self {
            Face::Even => 0.0,
            Face::Odd { wall, .. } | Face::Held { wall, .. } => (wall - potential) / depth,
            Face::Flux(flux) => flux,
            Face::Film { ref film, .. } => thermal.curve.film_flux(potential + thermal.zero_potential, depth, film),
            Face::Runoff(ref runoff) => runoff.flux(potential, depth, &thermal.curve, thermal.zero_potential),
        }
    }

    /// How the flux follows the potential (1/m).
    pub fn flux_slope(&self, potential: f64, depth: f64, thermal: &Thermal) -> f64 {
        match *self {
            Face::Even | Face::Flux(_) => 0.0,
            Face::Odd { .. } | Face::Held { .. } => -1.0 / depth,
            Face::Film { ref film, .. } => thermal.curve.film_slope(potential + thermal.zero_potential, depth, film),
            Face::Runoff(ref runoff) => runoff.slope(potential, depth, &thermal.curve, thermal.zero_potential),
        }
    }

    /// The same where a particle of this temperature conducts by its own conductivity (W/mK).
    #[inline]
    pub fn flux_by_temperature(&self, inside: f64, conductivity: f64, depth: f64, curve: &Curve) -> f64 {
        match *self {
            Face::Even => 0.0,
            Face::Odd { temperature, .. } | Face::Held { temperature, .. } => {
                conductivity * (curve.driver(temperature) - inside) / depth
            }
            Face::Flux(flux) => flux,
            Face::Film { ref film, .. } => {
                let coefficient = film.coefficient_before(inside, conductivity, depth);
                coefficient / (1.0 + coefficient * depth / conductivity) * (film.ambient - inside)
            }
            Face::Runoff(ref runoff) => runoff.flux_by_head(inside, conductivity, depth, curve),
        }
    }

    /// One where the flux falls with the potential inside, zero where it does not.
    pub fn holds(&self) -> f64 {
        match self {
            Face::Even | Face::Flux(_) => 0.0,
            Face::Odd { .. } | Face::Held { .. } | Face::Film { .. } | Face::Runoff(_) => 1.0,
        }
    }

    /// Whether ghosts follow their images in a way of their own at each state.
    pub fn bends(&self) -> bool {
        matches!(self, Face::Film { .. } | Face::Runoff(_))
    }

    /// How strongly a ghost falls when its image rises: what a ghost adds to its own image's row sum.
    pub fn stiffness(&self) -> f64 {
        match self {
            Face::Even => -1.0,
            Face::Flux(_) => -1.0,
            Face::Held { .. } => 0.0,
            // Behind a layer the flux never reverses a rise of its images.
            Face::Film { through, .. } if *through > 1.0 => 0.0,
            Face::Runoff(runoff) if runoff.through > 1.0 => 0.0,
            Face::Odd { .. } | Face::Film { .. } | Face::Runoff(_) => 1.0,
        }
    }
}

impl Patch {
    /// The wall at a time, in potentials of the given material curve.
    pub fn face(&self, time: f64, curve: &Curve, zero_potential: f64) -> Face {
        let at = |temperature: f64| {
            let wall = curve.potential(temperature) - zero_potential;
            if self.layers { Face::Held { wall, temperature } } else { Face::Odd { wall, temperature } }
        };
        let through = if self.layers { 2.0 } else { 1.0 };
        match &self.condition {
            // Heads are even there, and heights are not.
            Condition::Symmetry | Condition::Periodic | Condition::FreeDrainage => Face::Even,
            Condition::Temperature(series) => at(series.at(time)),
            Condition::Flux(series) => Face::Flux(series.at(time)),
            Condition::Film { kind, strength, ambient } => {
                let film = Film { kind: *kind, strength: strength.at(time), ambient: ambient.at(time) };
                Face::Film { film, through }
            }
            Condition::Runoff { rain, ponding } => {
                let place = ponding.at(time);
                let wall = curve.potential(place) - zero_potential;
                Face::Runoff(Runoff { rain: rain.at(time), wall, place, through, falls: self.falls })
            }
            Condition::Exact => match self.exact.as_ref().and_then(|exact| exact(time)) {
                Some(temperature) => at(temperature),
                None => Face::Even,
            },
        }
    }

    /// Whether the wall is held at a temperature, however its heat flows.
    pub fn is_held(&self) -> bool {
        matches!(self.condition, Condition::Temperature(_) | Condition::Exact)
    }

    /// Whether no heat passes but what the condition itself brings.
    pub fn is_closed(&self) -> bool {
        matches!(self.condition, Condition::Symmetry | Condition::Periodic | Condition::Flux(_))
    }

    /// Whether heat may cross.
    pub fn lets_heat_through(&self) -> bool {
        !matches!(self.condition, Condition::Symmetry | Condition::Periodic)
    }
}

/// One side of the box around a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// A straight wall: index into the patches.
    Wall(usize),
    /// A mirror plane of the domain.
    Mirror,
    /// The body goes on at the opposite side.
    Periodic,
    /// The domain ends in a curved wall before this side.
    Curved,
}

/// The walls of a body.
#[derive(Clone)]
pub struct Boundary {
    /// Parts of walls: wall, from and to along it (m), and patch. Later ones win.
    pub parts: Vec<(WallId, f64, f64, usize)>,
    /// Whether heat through closed walls is booked: mirrored shells leak, by the papers' shape factors.
    pub books_all: bool,
    /// All walls that the scene names.
    pub patches: Vec<Patch>,
    /// Left, right, bottom, top.
    pub sides: [Side; 4],
    /// The curved outer wall: its patch and radius (m).
    pub curved: Option<(usize, f64)>,
    /// The face of a shaft that is dug.
    pub dug: Option<Dug>,
}

/// The face of a shaft, from when it is dug on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dug {
    /// Its patch.
    pub patch: usize,
    /// Radius (m).
    pub radius: f64,
    /// When (s).
    pub start: f64,
}

impl Boundary {
    /// The patch of a whole wall, if the body has the wall.
    pub fn whole(&self, wall: WallId) -> Option<usize> {
        self.patches.iter().position(|patch| patch.id == PatchId::Whole(wall))
    }

    /// Whether heat may cross a wall, given by the patch of the whole wall, and all of its parts.
    pub fn is_open(&self, whole: usize) -> bool {
        let wall = self.patches[whole].id.wall();
        self.patches.iter().filter(|patch| patch.id.wall() == wall).all(Patch::lets_heat_through)
    }

    /// Whether what lies beyond a side is the mirror image of the body.
    pub fn mirrors(&self, side: Side) -> bool {
        match side {
            Side::Wall(patch) => !self.patches[patch].lets_heat_through(),
            Side::Mirror => true,
            Side::Periodic | Side::Curved => false,
        }
    }

    /// Whether the body goes on at the opposite side, along x and along y.
    pub fn repeats(&self) -> [bool; 2] {
        [0, 2].map(|side| self.sides[side] == Side::Periodic)
    }

    /// Whether it goes on there in any direction.
    pub fn repeats_anywhere(&self) -> bool {
        self.repeats() != [false; 2]
    }

    /// Whether walls are in parts.
    pub fn has_parts(&self) -> bool {
        !self.parts.is_empty()
    }

    /// The patch at a place (m) along a wall, given by the patch of the whole wall.
    pub fn patch_at(&self, patch: usize, along: f64) -> usize {
        let id = self.patches[patch].id;
        let is_here =
            |part: &&(WallId, f64, f64, usize)| PatchId::Whole(part.0) == id && along >= part.1 && along < part.2;
        let part = self.parts.iter().rev().find(is_here);
        part.map_or(patch, |part| part.3)
    }

    /// The patches of a wall, given by that of the whole wall, within a distance (m) of a place (m) along it and between its
    /// ends. The papers' layers have that of the place alone.
    pub fn patches_near(&self, whole: usize, along: f64, distance: f64, (low, high): (f64, f64)) -> Vec<usize> {
        if self.parts_between(whole, (low, high)).is_empty() {
            return vec![self.patch_at(whole, along)];
        }
        let wall = self.patches[whole].id.wall();
        let (from, to) = ((along - distance).max(low), (along + distance).min(high));
        let near = wall.map_or_else(Vec::new, |wall| self.stretches(wall, from, to));
        let mut near: Vec<usize> = near.iter().map(|stretch| stretch.2).collect();
        near.sort_unstable();
        near.dedup();
        near
    }

    /// The stretches between the ends (m) of a wall whose parts pairs pass, given by the patch of the whole wall; empty where it
    /// is in one, and at the papers' layers.
    pub fn parts_between(&self, whole: usize, (low, high): (f64, f64)) -> Vec<Stretch> {
        match self.patches[whole].id {
            PatchId::Whole(wall) if !self.books_all && self.parts.iter().any(|part| part.0 == wall) => {
                self.stretches(wall, low, high)
            }
            _ => Vec::new(),
        }
    }

    /// The stretches of a wall from one place (m) along it to another, each with its patch.
    pub fn stretches(&self, wall: WallId, low: f64, high: f64) -> Vec<Stretch> {
        let Some(whole) = self.whole(wall) else { return Vec::new() };
        let mut places = vec![low, high];
        let ends = self.parts.iter().filter(|part| part.0 == wall).flat_map(|part| [part.1, part.2]);
        places.extend(ends.filter(|end| *end > low && *end < high));
        places.sort_by(f64::total_cmp);
        places.dedup();
        let patch = |ends: &[f64]| self.patch_at(whole, 0.5 * (ends[0] + ends[1]));
        places.windows(2).map(|ends| (ends[0], ends[1], patch(ends))).collect()
    }

    /// Whether ghosts follow their images in the same way at all states and times.
    pub fn is_linear(&self) -> bool {
        let follows = |patch: &Patch| {
            matches!(patch.condition, Condition::Film { .. } | Condition::Runoff { .. } | Condition::Exact)
        };
        !self.patches.iter().any(follows)
    }

    /// Takes the walls as they are from now on, whatever the time.
    pub fn hold_still(&mut self) {
        for patch in &mut self.patches {
            patch.changes = false;
        }
    }

    /// All walls at time zero.
    pub fn first_faces(&self, curve: &Curve, zero_potential: f64) -> Vec<Face> {
        self.patches.iter().map(|patch| patch.face(0.0, curve, zero_potential)).collect()
    }

    /// Brings the walls that change to a later time.
    #[inline]
    pub fn update_faces(&self, faces: &mut [Face], time: f64, curve: &Curve, zero_potential: f64) {
        for (face, patch) in faces.iter_mut().zip(&self.patches).filter(|(_, patch)| patch.changes) {
            *face = patch.face(time, curve, zero_potential);
        }
    }
}

/// The part of a stretch of a wall, as long as `width` (m) and around a place (m), that lies in a patch. Outermost patches go on
/// beyond the ends of the wall.
pub fn share_of(stretches: &[Stretch], patch: usize, at: f64, width: f64) -> f64 {
    let last = stretches.len().saturating_sub(1);
    let overlap = |(number, (low, high, _)): (usize, &Stretch)| {
        let low = if number == 0 { f64::NEG_INFINITY } else { *low };
        let high = if number == last { f64::INFINITY } else { *high };
        (high.min(at + 0.5 * width) - low.max(at - 0.5 * width)).max(0.0)
    };
    let own: f64 = stretches.iter().enumerate().filter(|(_, stretch)| stretch.2 == patch).map(overlap).sum();
    let share = own / width;
    // Ends at the edges of cells cut none.
    if share < ROUNDING {
        0.0
    } else if share > 1.0 - ROUNDING {
        1.0
    } else {
        share
    }
}

/// Moving least squares: weights with which values at `points` give a linear fit's value at `target`.
///
/// Gaussian weights of scale `scale` (m). Exact for linear fields; falls back to the nearest point where the points
/// do not span the space.
pub fn moving_least_squares(target: DVec2, points: &[DVec2], scale: f64, dimension: usize) -> Vec<f64> {
    let weight: Vec<f64> = points.iter().map(|p| (-(*p - target).length_squared() / (scale * scale)).exp()).collect();
    let unknowns = dimension + 1;
    let basis = |p: &DVec2| [1.0, (p.x - target.x) / scale, (p.y - target.y) / scale];
    let mut matrix = [[0.0; 4]; 3];
    for (point, w) in points.iter().zip(&weight) {
        let b = basis(point);
        for r in 0..unknowns {
            for c in 0..unknowns {
                matrix[r][c] += w * b[r] * b[c];
            }
        }
    }
    // Coefficients of the row that picks the constant: matrix * a = e_0.
    matrix[0][3] = 1.0;
    for pivot in 0..unknowns {
        let best = (pivot..unknowns).max_by(|a, b| matrix[*a][pivot].abs().total_cmp(&matrix[*b][pivot].abs()));
        let Some(best) = best.filter(|row| matrix[*row][pivot].abs() > 1e-10 * weight.iter().sum::<f64>()) else {
            let nearest = (0..points.len()).min_by(|a, b| {
                (points[*a] - target).length_squared().total_cmp(&(points[*b] - target).length_squared())
            });
            return (0..points.len()).map(|k| if Some(k) == nearest { 1.0 } else { 0.0 }).collect();
        };
        matrix.swap(pivot, best);
        for row in 0..unknowns {
            if row != pivot {
                let factor = matrix[row][pivot] / matrix[pivot][pivot];
                for column in pivot..4 {
                    matrix[row][column] -= factor * matrix[pivot][column];
                }
            }
        }
    }
    let coefficients: Vec<f64> = (0..unknowns).map(|row| matrix[row][3] / matrix[row][row]).collect();
    points
        .iter()
        .zip(&weight)
        .map(|(point, w)| {
            let b = basis(point);
            w * coefficients.iter().zip(b).map(|(c, b)| c * b).sum::<f64>()
        })
        .collect()
}
