//! What is read off bodies of shells: fronts as radii.

use frazil_core::physics::material::Material;
use frazil_core::space::domain::Domain;
use frazil_core::space::symmetry::Symmetry;
use frazil_core::space::wall::WallId;
use frazil_scene::Scene;

/// On which side of its front the ice of a radial body lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RadialFront {
    symmetry: Symmetry,
    inner: f64,
    outer: f64,
    pub(super) from_outer: bool,
}

impl RadialFront {
    /// The front of a scene, if its body is radial and freezes. Ice lies at the wall that drives harder, or, if that is warmer
    /// than the start, at the other one.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let Domain::Radial { symmetry, inner, outer } = scene.domain else { return None };
        if !scene.materials.iter().any(Material::freezes) {
            return None;
        }
        let is_outer = scene.drive(WallId::Outer) > scene.drive(WallId::Inner);
        let is_warm = scene.warms(if is_outer { WallId::Outer } else { WallId::Inner });
        Some(RadialFront { symmetry, inner, outer, from_outer: is_outer != is_warm })
    }

    /// Radius (m) up to which, or from which on, a frozen volume fills the body.
    pub(super) fn radius(&self, frozen: f64) -> f64 {
        let whole = self.symmetry.volume(self.inner, self.outer);
        self.symmetry.radius(self.inner, if self.from_outer { whole - frozen } else { frozen })
    }
}
