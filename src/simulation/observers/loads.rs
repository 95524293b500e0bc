//! Heat that pipes take, in means over days: by them a refrigeration plant is sized. The load at an instant is without bound where a
//! pipe begins to cool, so the greatest of some instants says more of the instants than of the pipes.

use frazil_core::saved::{Pass, Saved};
use frazil_record::{Role, RunResult, Table, TimeUnit, Unit};
use frazil_scene::Units;

use super::observer::{Cadence, End, Instants, Made, Observer, Schedule, Setup, View};
use crate::recorded::Recorded;

/// Times that are the same, over their size.
const SAME: f64 = 1e-12;

/// Days that are told, at most: a hundred years.
const MOST: f64 = 36_525.0;

/// Its table.
pub const TABLE: &str = "loads.csv";

struct Loads {
    table: Table,
    /// How often the part that is run is in the whole plan.
    images: f64,
    cadence: Cadence,
    /// Time (s) of the last look, and the heat that all pipes had taken (J/m); and that at the end of the last whole day.
    last: (f64, f64),
    day: f64,
    /// How many days are told.
    days: usize,
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let scene = setup.scene;
    let days = (scene.duration / TimeUnit::Day.seconds() * (1.0 + SAME)).floor().min(MOST);
    if scene.rings.is_empty() || scene.units != Units::Si || days < 1.0 {
        return None;
    }
    let columns = [
        ("load_w_per_m", "mean load of the day", Unit::WattPerMetre, Role::Sum),
        ("energy_j_per_m", "heat taken so far", Unit::JoulePerMetre, Role::Sum),
    ];
    let table = Table::over_time(TABLE, "Heat taken by all pipes", &columns, days as usize);
    let (images, cadence) = (setup.images(), Cadence::of(scene));
    Some(Box::new(Loads { table, images, cadence, last: (0.0, 0.0), day: 0.0, days: days as usize }))
}

impl Saved for Loads {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        Recorded(&mut self.table.rows).pass(pass);
        pass.all(&mut [&mut self.cadence, &mut self.last, &mut self.day]);
    }
}

impl Observer for Loads {
    fn schedule(&self) -> Schedule {
        Schedule { start: false, instants: Instants::Outputs, next: self.cadence.next }
    }

    fn observe(&mut self, view: &View<'_>) {
        self.cadence.seen(view.time);
        let (before, had) = self.last;
        let taken = self.images * view.ledger.taken_by_rings();
        let day = TimeUnit::Day.seconds();
        let mut end = (self.table.rows.len() + 1) as f64 * day;
        while self.table.rows.len() < self.days && end <= view.time * (1.0 + SAME) {
            let share = ((end - before) / (view.time - before)).min(1.0);
            let at = had + share * (taken - had);
            self.table.rows.push(vec![Some(end), Some((at - self.day) / day), Some(at)]);
            (self.day, end) = (at, end + day);
        }
        self.last = (view.time, taken);
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        result.tables.push(self.table);
    }

    fn held_at_the_end(&self) -> usize {
        self.table.held_when_full()
    }
}
