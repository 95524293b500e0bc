//! Heat through surfaces inside the body.

use frazil_record::{RunResult, SurfaceRow};

use super::observer::{End, Made, Observer, Schedule, Setup, View, room};

struct Surfaces {
    rows: Vec<SurfaceRow>,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let count = setup.scene.watch.surfaces.len();
    (count > 0).then(|| Box::new(Surfaces { rows: Vec::with_capacity(count * setup.outputs()) }) as _)
}

impl Observer for Surfaces {
    fn schedule(&self) -> Schedule {
        Schedule::OUTPUTS
    }

    fn observe(&mut self, view: &View<'_>) {
        let domain = &view.scene.domain;
        for (surface, heat_w) in view.scene.watch.surfaces.iter().zip(view.across) {
            let flux_w_per_m2 = heat_w / surface.area(domain);
            let (time_s, surface) = (view.time, surface.name(domain));
            self.rows.push(SurfaceRow { time_s, surface, heat_w: *heat_w, flux_w_per_m2 });
        }
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        result.surfaces = self.rows;
    }

    fn held_at_the_end(&self) -> usize {
        room(&self.rows) + self.rows.capacity() * "r=0.001".len()
    }
}
