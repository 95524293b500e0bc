//! A temperature that a formula prescribes as a reference, as of a manufactured solution.

use frazil_core::formula::Formula;
use frazil_record::ReferenceInfo;
use frazil_scene::{FreezingDirection, Scene};
use frazil_simulation::reference::{Cut, Reference};

/// Relative error of a formula: rounding.
const ERROR: f64 = 1e-15;

/// The temperature that a formula has at every place and time.
pub struct Prescribed {
    formula: Formula,
    direction: Option<FreezingDirection>,
}

impl Prescribed {
    /// That of a scene.
    pub fn of_scene(scene: &Scene, formula: &Formula) -> Self {
        Prescribed { formula: formula.clone(), direction: scene.freezing_direction() }
    }
}

impl Reference for Prescribed {
    fn describe(&self) -> ReferenceInfo {
        ReferenceInfo::new("formula", self.formula.text(), ERROR)
    }

    fn temperature(&self, x: f64, t: f64) -> Option<f64> {
        let Some(direction) = self.direction else { return Some(self.formula.at(&[x, 0.0, t])) };
        // Back from the distance: what is measured from the end is measured to it.
        let along = direction.distance(x);
        let at = if direction.along_y { [0.0, along, t] } else { [along, 0.0, t] };
        Some(self.formula.at(&at))
    }

    fn cut_temperature(&self, cut: Cut, x: f64, t: f64) -> Option<f64> {
        let (x, y) = cut.point(x);
        self.point_temperature(x, y, t)
    }

    fn point_temperature(&self, x: f64, y: f64, t: f64) -> Option<f64> {
        Some(self.formula.at(&[x, y, t]))
    }
}
