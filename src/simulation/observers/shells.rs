//! What is read off bodies of shells: fronts as radii.

use frazil_core::physics::material::Material;
use frazil_core::space::domain::Domain;
use frazil_core::space::symmetry::Symmetry;
use frazil_core::space::wall::WallId;
use frazil_scene::Scene;

/// Where the front of a radial body starts, and how it is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RadialFront {
    symmetry: Symmetry,
    inner: f64,
    outer: f64,
    pub(super) from_outer: bool,
}

impl RadialFront {
    /// The front of a scene, if its body is radial and freezes: it starts at the wall that drives harder.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let Domain::Radial { symmetry, inner, outer } = scene.domain else { return None };
        if !scene.materials.iter().any(Material::freezes) {
            return None;
        }
        Some(RadialFront {
            symmetry,
            inner,
            outer,
            from_outer: scene.drive(WallId::Outer) > scene.drive(WallId::Inner),
        })
    }

    /// Radius (m) up to which, or from which on, a frozen volume fills the body.
    pub(super) fn radius(&self, frozen: f64) -> f64 {
        let whole = self.symmetry.volume(self.inner, self.outer);
        self.symmetry.radius(self.inner, if self.from_outer { whole - frozen } else { frozen })
    }
}
