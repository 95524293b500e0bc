//! Watching over the range of temperatures while a run goes on.

use frazil_core::boundary::pipe::Sink;
use frazil_core::particles::Particles;
use frazil_core::parts::extremes;
use frazil_core::physics::retention::scale::{DRY, head};
use frazil_core::saved::{Pass, Saved};
use frazil_core::side_by_side::MinMax;
use frazil_core::solvers::step::{Bound, Clock};
use frazil_core::team::Team;
use frazil_record::plain;
use frazil_scene::Scene;
use glam::DVec2;

/// What is wrong with a particle.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Fault {
    /// Its enthalpy is no number.
    #[error("is not finite")]
    NotFinite,
    /// Its head of unsaturated water is far from all data.
    #[error("has a pressure head far outside the range of the data: {}, range {} to {}", words(*.found), words(*.low), words(*.high))]
    HeadOutOfRange {
        /// Its place on the scale of heads.
        found: f64,
        /// The least of the data.
        low: f64,
        /// The greatest of them.
        high: f64,
    },
    /// Its temperature is far from all data.
    #[error("has the temperature {temperature}, outside {low} to {high} by ten times this range")]
    OutOfRange {
        /// What it has.
        temperature: f64,
        /// The least of the data.
        low: f64,
        /// The greatest of them.
        high: f64,
    },
}

/// A pressure head in words, by its place on the scale of heads.
fn words(place: f64) -> String {
    match place {
        place if place < DRY => "drier than dry".into(),
        place if place == DRY => "dry".into(),
        // No sign before a zero.
        place => format!("{} m", head(place) + 0.0),
    }
}

/// A particle that cannot be, and the step that made it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "particle {particle} at ({:.6}, {:.6}) m {fault} by step {} of {} s (bound {} s, set by {})",
    .place.x, .place.y, .clock.index, plain(.clock.step, 6), plain(.bound.step, 6), .bound.cause
)]
pub struct Absurd {
    particle: usize,
    place: DVec2,
    fault: Fault,
    clock: Clock,
    bound: Box<Bound>,
}

impl Absurd {
    fn new(particles: &Particles, particle: usize, clock: &Clock, bound: &Bound, fault: Fault) -> Self {
        Absurd { particle, place: particles.position(particle), fault, clock: *clock, bound: Box::new(bound.clone()) }
    }
}

/// Watches over the range of temperatures.
pub struct Guard {
    range: (f64, f64),
    /// Whether they are places of heads of unsaturated water.
    of_water: bool,
    /// Whether fluxes may drive temperatures beyond any data.
    open: bool,
    seen: (f64, f64),
    /// Particles inside the sinks of pipes, which stand for the pipe and not for ground.
    inside_pipes: Vec<u32>,
    /// Extremes of parts of the particles.
    found: Vec<MinMax>,
}

impl Saved for Guard {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.seen.pass(pass);
    }
}

impl Guard {
    /// A guard for a scene; `pipes` are the places where pipes are at work.
    pub fn new(scene: &Scene, particles: &Particles, pipes: &[Sink]) -> Self {
        let lattice = &particles.lattice;
        let mut inside_pipes = Vec::new();
        for pipe in pipes {
            inside_pipes.extend(pipe.extent.particles(lattice));
        }
        inside_pipes.sort_unstable();
        inside_pipes.dedup();
        let range = scene.temperature_range();
        let seen = (f64::INFINITY, f64::NEG_INFINITY);
        Guard { range, of_water: scene.of_water, open: scene.has_flux(), seen, inside_pipes, found: Vec::new() }
    }

    /// Takes note of the extremes, which threads find side by side if there are more than one, and refuses what cannot be.
    ///
    /// # Errors
    /// A particle that is no number, or far from all data.
    pub fn look(
        &mut self,
        team: Option<&Team>,
        particles: &Particles,
        clock: &Clock,
        bound: &Bound,
    ) -> Result<(), Absurd> {
        let enthalpy = &particles.enthalpy;
        let outside = extremes(team, enthalpy, &self.inside_pipes, &mut self.found);
        if !outside.are_finite || !self.inside_pipes.iter().all(|i| enthalpy[*i as usize].is_finite()) {
            let first = enthalpy.iter().position(|enthalpy| !enthalpy.is_finite()).unwrap_or_default();
            return Err(Absurd::new(particles, first, clock, bound, Fault::NotFinite));
        }
        let (low, high) = self.extremes(particles, outside);
        if low > high {
            return Ok(());
        }
        self.seen = (self.seen.0.min(low), self.seen.1.max(high));
        let width = self.range.1 - self.range.0;
        if !self.open && width > 0.0 {
            for temperature in [low, high] {
                if temperature < self.range.0 - 10.0 * width || temperature > self.range.1 + 10.0 * width {
                    let kept = |i: &usize| self.inside_pipes.binary_search(&(*i as u32)).is_err();
                    let has_it = |i: &usize| particles.temperature(*i) == temperature;
                    let index = (0..particles.len()).filter(kept).find(has_it).unwrap_or_default();
                    return Err(Absurd::new(particles, index, clock, bound, self.out_of_range(temperature)));
                }
            }
        }
        Ok(())
    }

    /// Least and greatest temperature outside pipes, where the enthalpies are so.
    fn extremes(&self, particles: &Particles, MinMax { least, greatest, .. }: MinMax) -> (f64, f64) {
        if !particles.materials.mixed() {
            // Temperature rises with enthalpy: within one material the extremes are those of the enthalpy.
            let temperature = |enthalpy: f64| particles.materials.of(0).temperature(enthalpy);
            return if least > greatest { (least, greatest) } else { (temperature(least), temperature(greatest)) };
        }
        let mut skip = self.inside_pipes.iter().copied().peekable();
        let kept = (0..particles.len()).filter(|i| skip.next_if_eq(&(*i as u32)).is_none());
        let wider = |(low, high): (f64, f64), temperature: f64| (low.min(temperature), high.max(temperature));
        kept.map(|i| particles.temperature(i)).fold((f64::INFINITY, f64::NEG_INFINITY), wider)
    }

    fn out_of_range(&self, found: f64) -> Fault {
        let (low, high) = self.range;
        match self.of_water {
            true => Fault::HeadOutOfRange { found, low, high },
            false => Fault::OutOfRange { temperature: found, low, high },
        }
    }

    /// How far temperatures left the range of the data, over that range.
    pub fn violation(&self) -> Option<f64> {
        let width = self.range.1 - self.range.0;
        let seen = self.seen.0 <= self.seen.1;
        (!self.open && width > 0.0 && seen)
            .then(|| (self.range.0 - self.seen.0).max(self.seen.1 - self.range.1).max(0.0) / width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_out_of_range_are_said_in_metres() {
        let fault = Fault::HeadOutOfRange { found: -2e4, low: DRY, high: -0.0 };
        assert_eq!(
            fault.to_string(),
            "has a pressure head far outside the range of the data: drier than dry, range dry to 0 m"
        );
    }
}
