//! Cracks of the problems: segments along y that nothing passes.

use super::{CENTIMETRE, Case, DAY};

/// A crack, in the coordinates of its table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slit {
    /// Where it is along x (m).
    pub x: f64,
    /// Where it begins along y (m).
    pub from: f64,
    /// Where it ends at the latest (m).
    pub to: f64,
    /// Speed of its tip (m/s); none of a crack that is whole from the start.
    pub speed: Option<f64>,
}

const fn slit(x: f64, from: f64, to: f64, speed: Option<f64>) -> Slit {
    Slit { x: x * CENTIMETRE, from: from * CENTIMETRE, to: to * CENTIMETRE, speed }
}

const FIXED: [Slit; 2] = [slit(-2.0, -3.5, -1.5, None), slit(1.0, 1.5, 3.5, None)];

const SPEED: Option<f64> = Some(0.3 * CENTIMETRE / DAY);
const GROWING: [Slit; 2] = [slit(-2.0, -3.5, 2.5, SPEED), slit(1.0, 3.5, -2.5, SPEED)];

/// The cracks of a problem.
pub fn slits(case: Case) -> &'static [Slit] {
    match case {
        Case::Cracks => &FIXED,
        Case::GrowingCracks => &GROWING,
        _ => &[],
    }
}

impl Slit {
    /// Its lower and its upper end (m) at a time (s).
    pub fn ends(&self, t: f64) -> (f64, f64) {
        let length = (self.to - self.from).abs();
        let open = self.speed.map_or(length, |speed| length.min(speed * t));
        let tip = self.from + open.copysign(self.to - self.from);
        (self.from.min(tip), self.from.max(tip))
    }
}
