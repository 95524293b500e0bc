//! From a scene to what its steps need.

/// Particles, neighbours and walls, ready for a method's step.
pub struct Assembly {}
