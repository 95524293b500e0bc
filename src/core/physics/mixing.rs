//! How the conductivity of partly frozen material follows from its phases.

/// A mean of two conductivities by the fractions of their phases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mixing {
    /// `S k_u + (1 - S) k_f`.
    Arithmetic,
    /// `k_u^S k_f^(1 - S)` (Nikolaev et al. 2021, eq 12).
    Geometric,
}

impl Mixing {
    /// The conductivity (W/mK) of material of which `fraction` conducts by `one` (W/mK) and the rest by `other`.
    pub fn conductivity(self, fraction: f64, one: f64, other: f64) -> f64 {
        match self {
            Mixing::Arithmetic => fraction * one + (1.0 - fraction) * other,
            Mixing::Geometric => one.powf(fraction) * other.powf(1.0 - fraction),
        }
    }
}
