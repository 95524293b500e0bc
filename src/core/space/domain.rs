//! The body that is simulated, and surfaces across it.

use glam::DVec2;

use crate::space::symmetry::Symmetry;

/// The body of ground or water that is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Domain {
    /// The interval `0 <= x <= length` (m); walls `left` and `right`.
    Line {
        /// Length (m).
        length: f64,
    },
    /// The box `0 <= x <= width`, `0 <= y <= height` (m); walls `left`, `right`, `bottom`, `top`.
    Rectangle {
        /// Extent in x (m).
        width: f64,
        /// Extent in y (m).
        height: f64,
    },
    /// The plan of a shaft: the disc of `outer_radius` around the origin, or the part of it that its mirror
    /// planes leave. Walls: `outer`; the mirror planes x = 0 and y = 0 need none.
    Ring {
        /// Radius of the outer wall (m).
        outer_radius: f64,
        /// How much of the disc is simulated.
        sector: Sector,
    },
    /// The radii `inner <= r <= outer` (m) of a body of axial or spherical symmetry; walls `inner`, unless its radius is
    /// zero, and `outer`.
    Radial {
        /// What the body does not vary along.
        symmetry: Symmetry,
        /// Inner radius (m).
        inner: f64,
        /// Outer radius (m).
        outer: f64,
    },
    /// The half plane (r, z) of a body around an axis, r as x and z as y: `inner <= r <= outer`, `0 <= z <= height` (m);
    /// walls `inner`, unless its radius is zero, `outer`, `bottom`, `top`.
    Axial {
        /// Inner radius (m).
        inner: f64,
        /// Outer radius (m).
        outer: f64,
        /// Extent along the axis (m).
        height: f64,
    },
}

impl Domain {
    /// Number of space dimensions.
    pub fn dimension(&self) -> usize {
        match self {
            Domain::Line { .. } | Domain::Radial { .. } => 1,
            Domain::Rectangle { .. } | Domain::Ring { .. } | Domain::Axial { .. } => 2,
        }
    }

    /// What the body does not vary along, if it is one of shells.
    pub fn symmetry(&self) -> Option<Symmetry> {
        match *self {
            Domain::Radial { symmetry, .. } => Some(symmetry),
            Domain::Axial { .. } => Some(Symmetry::Axial),
            Domain::Line { .. } | Domain::Rectangle { .. } | Domain::Ring { .. } => None,
        }
    }

    /// Least and greatest coordinates (m) of the simulated body; in y without end on a line and in radial shells.
    pub fn corners(&self) -> (DVec2, DVec2) {
        let flat = |low: f64, high: f64| (DVec2::new(low, f64::NEG_INFINITY), DVec2::new(high, f64::INFINITY));
        match *self {
            Domain::Line { length } => flat(0.0, length),
            Domain::Radial { inner, outer, .. } => flat(inner, outer),
            Domain::Rectangle { width, height } => (DVec2::ZERO, DVec2::new(width, height)),
            Domain::Axial { inner, outer, height } => (DVec2::new(inner, 0.0), DVec2::new(outer, height)),
            Domain::Ring { outer_radius, sector } => {
                let low = match sector {
                    Sector::Quarter => DVec2::ZERO,
                    Sector::Half => DVec2::new(-outer_radius, 0.0),
                    Sector::Whole => DVec2::splat(-outer_radius),
                };
                (low, DVec2::splat(outer_radius))
            }
        }
    }

    /// Inner and outer radius (m) of a body of shells; zeros of others.
    pub fn radii(&self) -> (f64, f64) {
        match *self {
            Domain::Radial { inner, outer, .. } | Domain::Axial { inner, outer, .. } => (inner, outer),
            Domain::Line { .. } | Domain::Rectangle { .. } | Domain::Ring { .. } => (0.0, 0.0),
        }
    }

    /// Length of a body on a line, area of one in a plane (m, m2): that of its lattice.
    pub fn size(&self) -> f64 {
        match *self {
            Domain::Line { length } => length,
            Domain::Rectangle { width, height } => width * height,
            Domain::Radial { inner, outer, .. } => outer - inner,
            Domain::Axial { inner, outer, height } => (outer - inner) * height,
            Domain::Ring { outer_radius: r, sector } => std::f64::consts::PI * r * r / sector.images() as f64,
        }
    }

    /// The greatest extent in one direction (m).
    pub fn extent(&self) -> f64 {
        match *self {
            Domain::Line { length } => length,
            Domain::Rectangle { width, height } => width.max(height),
            Domain::Ring { outer_radius, .. } => outer_radius,
            Domain::Radial { outer, .. } => outer,
            Domain::Axial { outer, height, .. } => outer.max(height),
        }
    }

    /// Names of both directions, as people say them.
    pub fn axes(&self) -> (&'static str, &'static str) {
        if self.symmetry().is_some() { ("r", "z") } else { ("x", "y") }
    }
}

/// Part of a ring. The mirror planes are the axes because these, and not the planes of a narrower sector, map
/// a square lattice onto itself: the mirror is exact to the last bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sector {
    /// x >= 0 and y >= 0; the scene is symmetric in both axes.
    Quarter,
    /// y >= 0; the scene is symmetric in the x axis.
    Half,
    /// The whole plan.
    Whole,
}

impl Sector {
    /// Whether a ray from the centre at an angle (radians) lies in the sector, its edges included.
    pub fn holds(self, angle: f64) -> bool {
        let (sin, cos) = angle.sin_cos();
        match self {
            Sector::Quarter => cos > -ON_AXIS && sin > -ON_AXIS,
            Sector::Half => sin > -ON_AXIS,
            Sector::Whole => true,
        }
    }

    /// How many rays of the whole plan a ray of the sector stands for: on a mirror plane fewer than inside.
    pub fn multiplicity(self, angle: f64) -> usize {
        let (sin, cos) = angle.sin_cos();
        let on_edge = sin.abs() < ON_AXIS || (self == Sector::Quarter && cos.abs() < ON_AXIS);
        self.images() / if on_edge && self != Sector::Whole { 2 } else { 1 }
    }

    /// The word used in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Sector::Quarter => "quarter",
            Sector::Half => "half",
            Sector::Whole => "whole",
        }
    }

    /// How many times the sector fits into the whole plan.
    pub fn images(self) -> usize {
        match self {
            Sector::Quarter => 4,
            Sector::Half => 2,
            Sector::Whole => 1,
        }
    }
}

/// Sine or cosine of an angle below which a ray lies on an axis.
const ON_AXIS: f64 = 1e-9;

/// A plane, cylinder or sphere across the body: heat is counted through it, or a profile kept along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// Whether it lies across y or z instead of x or r.
    pub across_y: bool,
    /// Where it lies (m).
    pub at: f64,
}

impl Surface {
    /// Whether a place (m) lies beyond it, towards greater coordinates.
    pub fn is_beyond(&self, place: DVec2) -> bool {
        (if self.across_y { place.y } else { place.x }) >= self.at
    }

    /// Name in the series, as `r=0.3`.
    pub fn name(&self, domain: &Domain) -> String {
        let (x, y) = domain.axes();
        format!("{}={}", if self.across_y { y } else { x }, self.at)
    }

    /// Area (m2; by length of each missing dimension).
    pub fn area(&self, domain: &Domain) -> f64 {
        match *domain {
            Domain::Line { .. } | Domain::Ring { .. } => 1.0,
            Domain::Rectangle { width, height } => {
                if self.across_y {
                    width
                } else {
                    height
                }
            }
            Domain::Radial { symmetry, .. } => symmetry.area(self.at),
            Domain::Axial { inner, outer, .. } if self.across_y => Symmetry::Axial.volume(inner, outer),
            Domain::Axial { height, .. } => Symmetry::Axial.area(self.at) * height,
        }
    }
}
