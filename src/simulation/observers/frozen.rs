//! The frozen volume: at the start, and over time in bodies where neither a front nor a wall tells how much is frozen.

use crate::recorded::Recorded;
use frazil_core::saved::{Pass, Saved};
use frazil_record::{FrozenRow, RunResult};

use super::observer::{End, Made, Moment, Observer, Schedule, Setup, View, room};

struct FrozenVolume {
    images: f64,
    /// Whether it is kept over time.
    kept: bool,
    start: f64,
    rows: Vec<FrozenRow>,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let scene = setup.scene;
    let kept = scene.domain.symmetry().is_some() || scene.freezing_direction().is_none() && scene.rings.is_empty();
    let kept = kept && !scene.of_water;
    let rows = Vec::with_capacity(if kept { setup.outputs() } else { 0 });
    Some(Box::new(FrozenVolume { images: setup.images(), kept, start: 0.0, rows }))
}

impl Saved for FrozenVolume {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.start, &mut Recorded(&mut self.rows)]);
    }
}

impl Observer for FrozenVolume {
    fn schedule(&self) -> Schedule {
        Schedule { start: true, ..Schedule::OUTPUTS }
    }

    fn observe(&mut self, view: &View<'_>) {
        match view.moment {
            Moment::Start => self.start = view.frozen() * self.images,
            _ if self.kept => {
                let frozen_volume = view.frozen() * self.images;
                self.rows.push(FrozenRow { time_s: view.time, frozen_volume, frozen_volume_ref: None });
            }
            _ => {}
        }
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        (result.frozen, result.start.frozen_volume) = (self.rows, self.start);
    }

    fn held_at_the_end(&self) -> usize {
        room(&self.rows)
    }
}
