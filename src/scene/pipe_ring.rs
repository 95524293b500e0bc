//! Rings and rows of freeze pipes.

use std::sync::Arc;

use frazil_core::boundary::pipe::{Pipe, PipeCondition};
use frazil_core::series::Schedule;
use glam::DVec2;

/// A ring of evenly spaced pipes, from which pipes and gaps follow. A row, or pipes at any places, is a ring all of whose pipes are moved.
#[derive(Debug, Clone, PartialEq)]
pub struct PipeRing {
    /// Number of pipes on the full circle.
    pub count: usize,
    /// Radius of the circle (m).
    pub ring_radius: f64,
    /// Angle of the first pipe from the x axis (radians).
    pub first_angle: f64,
    /// Pipes that do not stand in their places, by number, and how far they stand from them (m).
    pub moved: Vec<(usize, DVec2)>,
    /// Pipes that are missing, by number.
    pub missing: Vec<usize>,
    /// Radius of one pipe (m); 0 where each is a single particle.
    pub pipe_radius: f64,
    /// Whether each pipe is the particle nearest to its place.
    pub one_particle: bool,
    /// What is kept up at each of them while they work.
    pub condition: PipeCondition,
    /// When they work; always if absent. No heat crosses their walls at other times.
    pub schedule: Option<Arc<Schedule>>,
}

impl PipeRing {
    /// Angle of pipe `k` (radians).
    pub fn angle(&self, k: usize) -> f64 {
        self.first_angle + std::f64::consts::TAU * k as f64 / self.count as f64
    }

    /// Angle of the middle of the gap between pipe `k` and the next (radians).
    pub fn gap_angle(&self, k: usize) -> f64 {
        self.first_angle + std::f64::consts::TAU * (k as f64 + 0.5) / self.count as f64
    }

    /// Where pipe `k` stands (m).
    pub fn place(&self, k: usize) -> DVec2 {
        let moved = self.moved.iter().find(|(number, _)| *number == k).map_or(DVec2::ZERO, |(_, way)| *way);
        self.ring_radius * DVec2::from_angle(self.angle(k)) + moved
    }

    /// Direction from the first pipe to the last, of a row; along x for one pipe.
    pub fn direction(&self) -> DVec2 {
        let mut numbers = self.numbers();
        let first = numbers.next().unwrap_or_default();
        let last = numbers.last().unwrap_or(first);
        (self.place(last) - self.place(first)).try_normalize().unwrap_or(DVec2::X)
    }

    /// Numbers of the pipes that are there, in order of their angle.
    pub fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.count).filter(|k| !self.missing.contains(k))
    }

    /// Whether all pipes are there and in their places.
    pub fn is_even(&self) -> bool {
        self.moved.is_empty() && self.missing.is_empty()
    }

    /// The pipes themselves, in order of their angle.
    pub fn pipes(&self) -> Vec<Pipe> {
        self.numbers()
            .map(|k| {
                let place = self.place(k);
                Pipe {
                    x: place.x,
                    y: place.y,
                    radius: self.pipe_radius,
                    one_particle: self.one_particle,
                    condition: self.condition.clone(),
                    schedule: self.schedule.clone(),
                }
            })
            .collect()
    }
}
