//! The front over time, in bodies that have one place of it.

use crate::recorded::Recorded;
use frazil_core::particles::Particles;
use frazil_core::saved::{Pass, Saved};
use frazil_record::{FrontRow, RunResult};
use frazil_scene::FreezingDirection;

use super::corners::Corners;
use super::observer::{End, Made, Moment, Observer, Schedule, Setup, View, room};
use super::profiles::layers;
use super::shells::RadialFront;

/// How a front runs.
enum Way {
    Plane(FreezingDirection),
    Radial(RadialFront),
    Corners(Corners),
}

impl Way {
    /// How far it has come (m), in a body of which so much is frozen.
    fn front(&self, particles: &Particles, frozen: f64) -> f64 {
        match self {
            // Where particles move, they may stand closer in one phase than in the other.
            Way::Plane(direction) if particles.move_about() => {
                let rows = layers(particles, direction, direction.length, 0.0, particles.lattice.dimension);
                rows.map(|row| row.frozen_fraction).sum::<f64>() * particles.lattice.spacing
            }
            Way::Plane(direction) => frozen / direction.across,
            Way::Radial(radial) => radial.radius(frozen),
            Way::Corners(corners) => corners.front(particles),
        }
    }
}

struct Front {
    way: Way,
    start: Option<f64>,
    rows: Vec<FrontRow>,
    /// Volume of the body (m^d), where the front is how far water would fill it.
    wets: Option<f64>,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let scene = setup.scene;
    let way = scene.freezing_direction().map(Way::Plane);
    let way = way.or_else(|| RadialFront::of(scene).map(Way::Radial));
    let way = way.or_else(|| Corners::of(scene, setup.particles.lattice.spacing).map(Way::Corners))?;
    let wets = scene.of_water.then(|| setup.particles.integral(|_| 1.0));
    Some(Box::new(Front { way, start: None, rows: Vec::with_capacity(setup.outputs()), wets }))
}

impl Saved for Front {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.start, &mut Recorded(&mut self.rows)]);
    }
}

impl Observer for Front {
    fn schedule(&self) -> Schedule {
        Schedule { start: true, ..Schedule::OUTPUTS }
    }

    fn observe(&mut self, view: &View<'_>) {
        let filled = self.wets.map_or(view.frozen(), |volume| volume - view.frozen());
        let front_m = self.way.front(view.particles, filled);
        match view.moment {
            Moment::Start => self.start = Some(front_m),
            _ => self.rows.push(FrontRow { time_s: view.time, front_m, front_ref_m: None }),
        }
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        (result.front, result.start.front_m) = (self.rows, self.start);
    }

    fn held_at_the_end(&self) -> usize {
        room(&self.rows)
    }
}
