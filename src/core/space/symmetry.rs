//! What a body does not vary along.

use std::f64::consts::PI;

/// What a body does not vary along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// The angle around an axis.
    Axial,
    /// Both angles around a centre.
    Spherical,
}

impl Symmetry {
    /// The word used in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Symmetry::Axial => "axial",
            Symmetry::Spherical => "spherical",
        }
    }

    /// Area at a radius (m): by length of the axis (m), or of the whole sphere (m2).
    pub fn area(self, radius: f64) -> f64 {
        match self {
            Symmetry::Axial => 2.0 * PI * radius,
            Symmetry::Spherical => 4.0 * PI * radius * radius,
        }
    }

    /// Volume between two radii (m): by length of the axis (m2), or of the whole shell (m3).
    pub fn volume(self, inner: f64, outer: f64) -> f64 {
        match self {
            Symmetry::Axial => PI * (outer - inner) * (outer + inner),
            Symmetry::Spherical => 4.0 / 3.0 * PI * (outer - inner) * (outer * outer + outer * inner + inner * inner),
        }
    }

    /// Radius (m) up to which a volume reaches from the inner radius (m) on.
    pub fn radius(self, inner: f64, volume: f64) -> f64 {
        match self {
            Symmetry::Axial => (inner * inner + volume / PI).max(0.0).sqrt(),
            Symmetry::Spherical => (inner.powi(3) + 0.75 * volume / PI).max(0.0).cbrt(),
        }
    }

    /// Depth (m) at which a plane wall would let as much heat through by area as the steady profile between a wall at
    /// one radius (m) and a particle at another.
    pub fn depth(self, wall: f64, particle: f64) -> f64 {
        match self {
            Symmetry::Axial => wall * (particle / wall).ln().abs(),
            Symmetry::Spherical => wall * (particle - wall).abs() / particle,
        }
    }

    /// The shape factor (m or m2) of a pair of shells, the inner one first.
    pub fn shape(self, inner: f64, outer: f64, spacing: f64) -> f64 {
        match self {
            Symmetry::Axial => {
                let middle = 0.5 * (inner + outer);
                let cells = ((outer - inner) / spacing).round();
                let excess = (cells * cells - 1.0).max(0.0) / 12.0 * spacing * spacing / middle;
                2.0 * PI * (middle - excess).min(2.0 * inner)
            }
            Symmetry::Spherical => {
                let small = 0.25 * spacing * spacing;
                let whole = inner * outer + small;
                let cells = outer - inner;
                let most = cells * (3.0 * inner * inner + small) / (0.5 * (inner + outer));
                4.0 * PI * if 2.0 * inner < cells { whole.min(most) } else { whole }
            }
        }
    }

    /// The shape factor that the papers print for heat from `other` to `own` radius (m), over the particle's volume
    /// (Nikolaev et al. 2023, eqs 10 and 21).
    pub fn printed_factor(self, own: f64, other: f64) -> f64 {
        match self {
            Symmetry::Axial => 2.0 * other / (own + other),
            Symmetry::Spherical => 3.0 * other * other / (own * own + own * other + other * other),
        }
    }
}
