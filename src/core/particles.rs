//! The particle store.

/// Placeholder-free minimum until the columns are laid.
#[derive(Debug, Clone, Default)]
pub struct Particles {
    /// Enthalpy (J/m3), relative to the initial state.
    pub enthalpy: Vec<f64>,
}
