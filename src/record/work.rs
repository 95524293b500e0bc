//! What steps cost.

use serde::{Deserialize, Serialize};

/// What steps cost, in units that do not depend on the machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// Evaluations of the pair operator: rates, stages, and products with the linearised operator.
    pub evaluations: u64,
    /// Steps that were made again with a shorter length.
    pub rejected_steps: u64,
    /// Steps that were mixed with the backward Euler step, to keep the range of the data.
    pub limited_steps: u64,
    /// Nonlinear systems solved.
    pub newton_solves: u64,
    /// Newton iterations, in all.
    pub newton_iterations: u64,
    /// Median number of Newton iterations of a solve.
    pub newton_median: u32,
    /// Largest number of Newton iterations of a solve.
    pub newton_most: u32,
    /// Solves that had to follow the path of a growing step.
    pub newton_paths: u64,
    /// Iterations of linear solvers, in all.
    pub linear_iterations: u64,
}
