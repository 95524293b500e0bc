//! What a simulation leaves: its record and its tables.

use std::sync::Arc;

use frazil_core::instruction_set::InstructionSet;
use frazil_record::{Record, RunResult};

use super::verdict::{judge, noise};
use super::{Simulation, Stop};
use crate::measure::attach;
use crate::observers::observer::{End, larger_magnitude};
use crate::plan::PlanSummary;
use crate::reference::Reference;

/// What the record says of how a run went.
pub(super) struct Course {
    /// Why it stopped before its end.
    pub(super) stopped: Option<Stop>,
    /// Wall and CPU time of the preparation (s).
    pub(super) setup: (f64, f64),
    /// Wall and CPU time of the steps (s).
    pub(super) solve: (f64, f64),
    /// What was planned.
    pub(super) summary: PlanSummary,
}

impl Simulation<'_> {
    /// The record and the tables, with errors against a reference.
    pub(super) fn leave(self, mut course: Course, reference: Option<&Arc<dyn Reference>>) -> RunResult {
        let stopped = course.stopped.take();
        let mut result = RunResult::bare(self.record(course));
        let end = End { scene: self.scene, particles: &self.particles, reference };
        self.observers.leave(&end, &mut result);
        let record = &mut result.record;
        let balance = result.budget.iter().map(|row| row.balance_rel).fold(0.0, larger_magnitude);
        record.energy_balance_rel = balance;
        (record.outcome, record.cause) = match stopped {
            Some(stop) => (stop.outcome(), Some(stop.to_string())),
            None => {
                let noise = noise(self.scene, self.settings, &self.particles);
                let scheme = self.settings.numerics.latent_heat_scheme;
                let of_water = self.scene.of_water;
                judge(of_water, scheme, balance, record.bounds_violation_rel, record.setback_rel, noise)
            }
        };
        if let Some(reference) = reference {
            attach(self.scene, self.particles.lattice.spacing, &mut result, reference.as_ref());
        }
        result
    }

    /// The record, but for what observers and a reference tell.
    fn record(&self, course: Course) -> Record {
        let (scene, settings) = (self.scene, self.settings);
        let Course { setup, solve, summary, .. } = course;
        let work = self.method.report().work;
        Record {
            frazil_version: env!("CARGO_PKG_VERSION").to_string(),
            scene: scene.name.clone(),
            title: scene.title.clone(),
            scene_hash: scene.hash.clone(),
            method: settings.method.to_string(),
            settings: settings.values(),
            units: scene.units.name().to_string(),
            particles: summary.particles,
            pairs: summary.pairs,
            steps: self.clock.index,
            pair_evaluations: summary.pairs * work.evaluations,
            particle_updates: summary.particles * work.evaluations,
            work,
            step_s: self.longest,
            step_bound_s: self.bound.step,
            step_limit: self.bound.cause.clone(),
            threads: self.options.threads,
            instruction_set: InstructionSet::widest().to_string(),
            seed: self.options.seed,
            setup_wall_s: setup.0,
            setup_cpu_s: setup.1,
            solve_wall_s: solve.0,
            solve_cpu_s: solve.1,
            observation_wall_s: self.observation.wall,
            observation_cpu_s: self.observation.cpu,
            peak_memory_bytes: peak_memory(),
            bounds_violation_rel: self.guard.violation(),
            spared: summary.spared,
            differences: summary.differences,
            remarks: scene.remarks.clone(),
            of_water: scene.of_water,
            state_hash: self.particles.state_hash(),
            ..Record::default()
        }
    }
}

/// Greatest resident memory of the process so far (bytes), where the system tells.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kilobytes| kilobytes * 1024)
}
