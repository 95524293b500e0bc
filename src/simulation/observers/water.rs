//! The water of a run: what it leaves beside the series of all runs, and how wrong it is.

use crate::recorded::Recorded;
use frazil_core::ledger::Ledger;
use frazil_core::particles::Particles;
use frazil_core::saved::{Pass, Saved};
use frazil_core::solvers::solver::Water;
use frazil_core::space::domain::Domain;
use frazil_record::{CutRow, FlowPoint, RunResult, WaterRecord, WaterRow, WaterSeries};
use frazil_scene::Scene;
use frazil_scene::region::Cell;

use super::observer::{End, Made, Moment, Observer, Schedule, Setup, View, larger_magnitude};
use crate::reference::Reference;

/// Distance (m) over which the pressure beside ice is not compared with a reference: it follows the staircase of the
/// cells there, in the reference as in the run.
const BESIDE_ICE: f64 = 0.015;

/// Share of the duration from which the ice fraction is compared: before, ice is gone from particles that the edge of a
/// region cuts, but not from the shape.
const ICE_FROM: f64 = 1.0 / 60.0;

/// The water of a run.
#[derive(Default)]
struct WaterWatch {
    series: WaterSeries,
    /// Ice of the scene at its start.
    started_with: f64,
    last: Option<Water>,
    /// Whether maps are kept.
    maps: bool,
    /// Instants of output and of profiles, and particles.
    counts: (usize, usize, usize),
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let (scene, particles) = (setup.scene, setup.particles);
    scene.flow.as_ref()?;
    // A particle that the edge of a region cuts starts as a mixture, in which ice has thawed already.
    let mut ice = 0.0;
    particles.visit(|i, place| {
        let porosity = scene.materials[particles.materials.index(i)].pores.map_or(0.0, |pores| pores.porosity);
        let curve = &particles.materials.of(i).curve;
        for (temperature, share) in scene.starts_in(&Cell::around(place, particles.lattice.spacing)) {
            ice += share * porosity * (1.0 - curve.unfrozen_fraction(temperature));
        }
    });
    let counts = (setup.outputs() + 1, setup.profiles() + 1, particles.len());
    let started_with = ice * particles.volumes.unit();
    Some(Box::new(WaterWatch { started_with, maps: setup.maps, counts, ..WaterWatch::default() }))
}

impl Saved for WaterWatch {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        // What was seen last is seen again at the next output.
        Recorded(&mut self.series).pass(pass);
    }
}

impl Observer for WaterWatch {
    fn schedule(&self) -> Schedule {
        Schedule { start: true, ..Schedule::OUTPUTS }
    }

    fn observe(&mut self, view: &View<'_>) {
        let Some(water) = view.method.water(view.particles) else { return };
        self.row(view.particles, &water, view.ledger, view.time);
        if view.moment == Moment::Start {
            self.keep(view);
            return;
        }
        self.last = Some(water);
        if view.is_kept() {
            self.keep(view);
        }
    }

    fn leave(mut self: Box<Self>, end: &End<'_>, result: &mut RunResult) {
        if !self.series.rows.is_empty() {
            result.record.water = Some(self.judge(end.scene, end.reference.map(|found| found.as_ref())));
            result.water = Some(self.series);
        }
    }

    fn held_at_the_end(&self) -> usize {
        let (outputs, profiles, particles) = self.counts;
        let points = if self.maps { profiles * particles } else { 0 };
        outputs * size_of::<WaterRow>() + points * size_of::<FlowPoint>()
    }
}

impl WaterWatch {
    fn row(&mut self, particles: &Particles, water: &Water, ledger: &Ledger, time_s: f64) {
        let coldest = (0..particles.len()).map(|i| particles.temperature(i)).fold(f64::INFINITY, f64::min);
        let walls = ledger.rate().len() - 1;
        self.series.rows.push(WaterRow {
            time_s,
            ice_m3: water.ice,
            liquid_m3: water.liquid,
            ice_fraction: if self.started_with > 0.0 { water.ice / self.started_with } else { 0.0 },
            ice_fraction_ref: None,
            inflow_m3_per_s: water.entering,
            outflow_m3_per_s: water.leaving,
            heat_in_w: ledger.rate()[..walls].iter().sum(),
            least_temperature_c: coldest,
            balance_rel: water.balance,
        });
    }

    /// Keeps the cut and the map.
    fn keep(&mut self, view: &View<'_>) {
        let View { scene, particles, time: time_s, .. } = *view;
        let Some((pressure, velocity)) = view.method.water_fields() else { return };
        if let (Some(y), Domain::Rectangle { .. }) = (scene.flow.as_ref().and_then(|flow| flow.cut), scene.domain) {
            let lattice = &particles.lattice;
            let row = ((y - lattice.corner.y) / lattice.spacing - 0.5).clamp(0.0, lattice.rows as f64 - 1.0);
            let (below, part) = (row.floor() as i64, row - row.floor());
            for column in 0..lattice.columns as i64 {
                let index = |row: i64| lattice.index(column, row.min(lattice.rows as i64 - 1)).unwrap_or(0);
                let (low, high) = (index(below), index(below + 1));
                let mean = |of: &dyn Fn(usize) -> f64| (1.0 - part) * of(low) + part * of(high);
                self.series.cut.push(CutRow {
                    time_s,
                    x_m: lattice.centre(column, below).x,
                    temperature_c: mean(&|i| particles.temperature(i)),
                    temperature_ref_c: None,
                    frozen_fraction: mean(&|i| particles.frozen_fraction(i)),
                    pressure_pa: mean(&|i| pressure[i]),
                    pressure_ref_pa: None,
                    velocity_x_m_per_s: mean(&|i| velocity[i].x),
                });
            }
        }
        if self.maps {
            particles.visit(|i, place| {
                self.series.maps.push(FlowPoint {
                    time_s,
                    x_m: place.x,
                    y_m: place.y,
                    temperature_c: particles.temperature(i),
                    frozen_fraction: particles.frozen_fraction(i),
                    pressure_pa: pressure[i],
                    velocity_x_m_per_s: velocity[i].x,
                    velocity_y_m_per_s: velocity[i].y,
                });
            });
        }
    }

    /// What the record says of the water; fills the columns of the reference.
    fn judge(&mut self, scene: &Scene, reference: Option<&dyn Reference>) -> WaterRecord {
        let mut record = WaterRecord::default();
        if let Some(water) = &self.last {
            record.owed_rel = water.owed;
            record.pressure_solutions = water.solutions;
            record.pressure_iterations = water.iterations;
            record.pressure_wall_s = water.seconds;
        }
        record.balance_rel = self.series.rows.iter().map(|row| row.balance_rel).fold(0.0, larger_magnitude);
        let thawed = self.thawed(scene.materials[0].freezing_point);
        record.events_s.extend(thawed.map(|time| ("thawed".to_owned(), time)));
        let Some(reference) = reference else { return record };
        for row in &mut self.series.rows {
            row.ice_fraction_ref = reference.ice(row.time_s);
        }
        for row in &mut self.series.cut {
            let found = reference.cut(row.x_m, row.time_s);
            (row.temperature_ref_c, row.pressure_ref_pa) =
                (found.map(|found| found.0), found.and_then(|found| found.1));
        }
        let mut note = |name: &str, error: Option<f64>| {
            record.errors.extend(error.filter(|error| error.is_finite()).map(|error| (name.to_owned(), error)));
        };
        let (low, high) = scene.temperature_range();
        let range = high - low;
        note("cut_temperature_rms_rel", self.worst(|row| Some((row.temperature_c - row.temperature_ref_c?) / range)));
        let (low, high) = scene.flow.as_ref().map_or((0.0, 0.0), |flow| flow.pressures());
        let freezing = scene.materials[0].freezing_point;
        let is_open = |row: &CutRow| {
            [-1.0, -0.5, 0.0, 0.5, 1.0].iter().all(|part| {
                let near = reference.cut(row.x_m + part * BESIDE_ICE, row.time_s);
                near.is_none_or(|near| near.0 > freezing)
            })
        };
        note(
            "cut_pressure_rms_rel",
            self.worst(|row| Some((row.pressure_pa - row.pressure_ref_pa?) / (high - low)).filter(|_| is_open(row))),
        );
        let later = self.series.rows.iter().filter(|row| row.time_s >= ICE_FROM * scene.duration);
        let ice = later.filter_map(|row| Some((row.ice_fraction - row.ice_fraction_ref?).abs()));
        note("ice_fraction_max", ice.reduce(f64::max));
        note("thawed", thawed.zip(reference.event("thawed")).map(|(own, expected)| own / expected - 1.0));
        record
    }

    /// Rms over the points of the cut that count, the greatest over its instants after the start.
    fn worst(&self, error: impl Fn(&CutRow) -> Option<f64>) -> Option<f64> {
        let instants = self.series.cut.chunk_by(|a, b| a.time_s == b.time_s).filter(|rows| rows[0].time_s > 0.0);
        let rms = instants.filter_map(|rows| {
            let errors: Vec<f64> = rows.iter().filter_map(&error).collect();
            let squares: f64 = errors.iter().map(|error| error * error).sum();
            (!errors.is_empty()).then(|| (squares / errors.len() as f64).sqrt())
        });
        rms.reduce(f64::max)
    }

    /// When the coldest particle came above the freezing point, for the last time.
    fn thawed(&self, freezing: f64) -> Option<f64> {
        let last = self.series.rows.iter().rposition(|row| row.least_temperature_c < freezing)?;
        let (before, after) = (&self.series.rows[last], self.series.rows.get(last + 1)?);
        let (cold, warm) = (freezing - before.least_temperature_c, after.least_temperature_c - freezing);
        Some(before.time_s + (after.time_s - before.time_s) * cold / (cold + warm))
    }
}
