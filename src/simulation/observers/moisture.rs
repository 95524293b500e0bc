//! Unsaturated water and its solute: what the body holds, what of the solute came in through each wall, and what ran off.

use crate::recorded::Recorded;
use frazil_core::boundary::condition::Condition;
use frazil_core::ledger::{Ledger, Source, Sum};
use frazil_core::saved::{Pass, Saved};
use frazil_core::series::Series;
use frazil_core::space::wall::{PatchId, WallId};
use frazil_record::{Column, Role, RunResult, Table, Unit};
use frazil_scene::Scene;

use super::observer::{End, Made, Moment, Observer, Schedule, Setup, View, larger_magnitude};

/// Its table.
pub(super) const TABLE: &str = "moisture.csv";

struct Moisture {
    table: Table,
    /// What the body holds of the solute at the start.
    start: f64,
    /// Greatest part of the solute exchanged that is not accounted for.
    missing: f64,
    carries: bool,
    /// What solute comes in through that the table tells of, by the number in the ledger.
    told: Vec<usize>,
    rained: Vec<Rained>,
}

/// A wall or a part of one with rain, or at which water seeps out.
struct Rained {
    /// Its number in the ledger.
    number: usize,
    rain: Series,
    /// Its area (m2 across a line, m by depth of a plane).
    area: f64,
}

impl Rained {
    /// What did not enter, or seeped out, up to a time (s), where this much came in (m3).
    fn ran_off(&self, time: f64, came: f64) -> f64 {
        let fell = self.area * self.rain.integral(time);
        // Both are sums over many steps.
        if (fell - came).abs() <= 1e-12 * fell { 0.0 } else { fell - came }
    }
}

/// Walls of which what does not enter runs off.
fn rained(scene: &Scene, sources: &[Source]) -> Vec<(PatchId, Rained)> {
    let whole = scene.walls.iter().map(|wall| (PatchId::Whole(wall.wall), &wall.condition));
    let parts = scene.conducting_parts().iter().enumerate();
    let all = whole.chain(parts.map(|(k, part)| (PatchId::Part(part.wall, k), &part.condition)));
    let of = |(patch, condition): (PatchId, &Condition)| {
        let Condition::Runoff { rain, .. } = condition else { return None };
        let number = sources.iter().position(|source| *source == Source::Patch(patch))?;
        Some((patch, Rained { number, rain: rain.clone(), area: scene.area_of(patch)? }))
    };
    all.filter_map(of).collect()
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    if !setup.scene.of_water {
        return None;
    }
    // By area across a line, by depth of a plane.
    let amount = if setup.scene.domain.dimension() == 1 { Unit::Metre } else { Unit::SquareMetre };
    let columns = [
        ("water_taken_up_m3", "water taken up", amount, Role::Sum),
        ("saturation_mean", "mean effective saturation", Unit::One, Role::Value),
    ];
    let mut table = Table::over_time(TABLE, "Water and solute", &columns, setup.outputs());
    let carries = setup.scene.solute.is_some();
    let mut told = Vec::new();
    if let Some(solute) = setup.method.passenger() {
        let column = |name: String, doc: String, unit, role| Column { name, doc, unit, role };
        table.columns.push(column("solute_taken_up_m3".into(), "solute taken up".into(), amount, Role::Sum));
        let sources = solute.ledger().sources();
        let closed = |wall: WallId| setup.scene.wall(wall) == Some(&Condition::Symmetry);
        let open = |source: &Source| !matches!(source, Source::Patch(PatchId::Whole(wall)) if closed(*wall));
        told = (0..sources.len()).filter(|number| open(&sources[*number])).collect();
        for source in told.iter().map(|number| sources[*number]) {
            let (name, doc) = (format!("solute_in_{source}_m3"), format!("solute in through {source}"));
            table.columns.push(column(name, doc, amount, Role::Sum));
        }
        table.columns.push(column(
            "solute_balance_rel".into(),
            "solute not accounted for".into(),
            Unit::One,
            Role::Value,
        ));
    }
    let mut ran = Vec::new();
    for (patch, own) in rained(setup.scene, setup.method.ledger().sources()) {
        table.columns.push(Column {
            name: format!("ran_off_{patch}_m3"),
            doc: format!(
                "water {} at {patch}",
                if own.rain.constant() == Some(0.0) { "seeped out" } else { "run off" }
            ),
            unit: amount,
            role: Role::Sum,
        });
        ran.push(own);
    }
    Some(Box::new(Moisture { table, start: 0.0, missing: 0.0, carries, told, rained: ran }))
}

/// What all particles hold of the solute.
fn held(view: &View<'_>) -> f64 {
    view.particles.integral(|i| view.particles.solute[i])
}

impl Moisture {
    /// What came of the solute, by walls, and what is not accounted for.
    fn solute(&mut self, view: &View<'_>, ledger: &Ledger) -> Vec<f64> {
        let taken = held(view) - self.start;
        let came = ledger.heat();
        let all: Sum = came.iter().copied().collect();
        let exchanged = came.iter().map(|amount| amount.abs()).sum::<f64>().max(taken.abs());
        let missing = if exchanged > 0.0 { (taken - all.value()) / exchanged } else { 0.0 };
        self.missing = larger_magnitude(self.missing, missing);
        let told = self.told.iter().map(|number| came[*number]);
        [taken].into_iter().chain(told).chain([missing]).collect()
    }
}

impl Saved for Moisture {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut Recorded(&mut self.table.rows), &mut self.start, &mut self.missing]);
    }
}

impl Observer for Moisture {
    fn schedule(&self) -> Schedule {
        Schedule { start: true, ..Schedule::OUTPUTS }
    }

    fn observe(&mut self, view: &View<'_>) {
        if view.moment == Moment::Start {
            self.start = if self.carries { held(view) } else { 0.0 };
            return;
        }
        let particles = view.particles;
        let started = |i: usize| particles.start.get(i).copied().unwrap_or(0.0);
        let taken = particles.integral(|i| particles.enthalpy[i] - started(i));
        let volume = particles.integral(|_| 1.0);
        let mut row = vec![view.time, taken, 1.0 - view.frozen() / volume];
        if let Some(passenger) = view.method.passenger() {
            row.extend(self.solute(view, passenger.ledger()));
        }
        let came = view.ledger.heat();
        row.extend(self.rained.iter().map(|own| own.ran_off(view.time, came[own.number])));
        self.table.rows.push(row.into_iter().map(Some).collect());
    }

    fn leave(self: Box<Self>, _: &End<'_>, result: &mut RunResult) {
        result.record.solute_balance_rel = self.carries.then_some(self.missing);
        result.tables.push(self.table);
    }

    fn held_at_the_end(&self) -> usize {
        self.table.held_when_full()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_have_names_that_columns_can_have() {
        assert_eq!(format!("solute_in_{}_m3", Source::Decay), "solute_in_decay_m3");
    }
}
