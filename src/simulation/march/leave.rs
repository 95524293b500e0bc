//! What a simulation leaves: its record and its tables.

use std::sync::Arc;

use frazil_record::{Errors, Outcome, Record, RunResult};

use super::Simulation;
use super::verdict::{judge, noise};
use crate::measure::attach;
use crate::plan::PlanSummary;
use crate::reference::Reference;

/// What the record says of how a run went.
pub(super) struct Course {
    /// Why it stopped before its end.
    pub(super) stopped: Option<(Outcome, String)>,
    /// Wall and CPU time of the preparation (s).
    pub(super) setup: (f64, f64),
    /// Wall and CPU time of the steps (s).
    pub(super) solve: (f64, f64),
    /// What was planned.
    pub(super) summary: PlanSummary,
}

impl Simulation<'_> {
    /// The record and the tables, with errors against a reference.
    pub(super) fn leave(mut self, course: Course, reference: Option<&Arc<dyn Reference>>) -> RunResult {
        let gaps = self.watches.gap_rows();
        let (stream, mut sections) = self.watches.stream(&self.particles);
        let mut record = self.record(course);
        record.water = self.water.as_mut().map(|water| water.judge(self.scene, reference.map(|found| found.as_ref())));
        record.stream = crate::stream::judge(self.scene, &stream, &mut sections);
        let (links, planes) = self.watches.wall();
        let watches = self.watches;
        let mut result = RunResult {
            record,
            front: watches.front,
            start: watches.start,
            beside: Vec::new(),
            frozen: watches.frozen,
            phases: watches.phases,
            stream,
            sections,
            surfaces: watches.surfaces,
            profiles: watches.profiles,
            probes: watches.probe_rows,
            budget_names: self.method.ledger().names().to_vec(),
            budget: watches.budget,
            walls: watches.walls,
            gaps,
            links,
            planes,
            fields: watches.fields,
            water: self.water.map(|water| water.series),
        };
        if let Some(reference) = reference {
            attach(self.scene, self.particles.lattice.spacing, &mut result, reference.as_ref());
        }
        result
    }

    fn record(&self, course: Course) -> Record {
        let (scene, settings, watches) = (self.scene, self.settings, &self.watches);
        let Course { stopped, setup, solve, summary } = course;
        let balance = watches.budget.iter().map(|row| row.balance_rel).fold(0.0, larger_magnitude);
        let setback = watches.monotonicity.setback();
        let violation = self.guard.violation();
        let (outcome, cause) = match stopped {
            Some((outcome, cause)) => (outcome, Some(cause)),
            None => {
                let noise = noise(scene, settings, &self.particles);
                judge(settings.numerics.latent_heat_scheme, balance, violation, setback, noise)
            }
        };
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
            seed: self.options.seed,
            setup_wall_s: setup.0,
            setup_cpu_s: setup.1,
            solve_wall_s: solve.0,
            solve_cpu_s: solve.1,
            observation_wall_s: self.observation.wall,
            observation_cpu_s: self.observation.cpu,
            peak_memory_bytes: peak_memory(),
            outcome,
            cause,
            energy_balance_rel: balance,
            bounds_violation_rel: violation,
            setback_rel: setback,
            errors: Errors::default(),
            reference: None,
            reduced_from: None,
            water: None,
            stream: None,
            wall: watches.wall_record(),
            spared: summary.spared,
            differences: summary.differences,
            remarks: scene.remarks.clone(),
            state_hash: self.particles.state_hash(),
        }
    }
}

fn larger_magnitude(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

/// Greatest resident memory of the process so far (bytes), where the system tells.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kilobytes| kilobytes * 1024)
}
