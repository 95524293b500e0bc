//! Trajectories from the wall, one after another, until the far temperature fits.

use std::f64::consts::PI;

use super::medium::{CurvePart, Medium};
use crate::exact::Unsolved;
use crate::exact::functions::erfcx;

/// Local error of one step, relative to the scale of each variable.
const TOLERANCE: f64 = 1e-13;

/// Beyond a remaining change of this fraction of the width of the curve the body counts as uniform.
const UNIFORM: f64 = 1e-10;

/// Temperatures closer than this fraction of the range are the same.
const ROUNDING: f64 = 1e-14;

/// Steps after which an integration is given up.
const MOST_STEPS: usize = 400_000;

/// A point of the solution and the part of the curve that follows it.
#[derive(Debug, Clone, Copy)]
pub struct TrajectoryPoint {
    /// x / sqrt(t) (m/s^1/2).
    pub eta: f64,
    /// Temperature.
    pub temperature: f64,
    /// k dT/d eta (W s^1/2 / m2).
    pub flux: f64,
    /// Integral of the frozen fraction less its value at infinity (m/s^1/2).
    pub frozen: f64,
    /// The part that follows.
    pub part: CurvePart,
}

/// Derivatives of temperature, flux and frozen integral along eta.
pub fn along_eta(medium: &Medium, part: CurvePart, initial_frozen: f64, eta: f64, state: [f64; 3]) -> [f64; 3] {
    let here = medium.properties(part, state[0]);
    let slope = state[1] / here.conductivity;
    [slope, -0.5 * eta * here.capacity * slope, here.frozen_fraction - initial_frozen]
}

/// Derivatives of eta, flux and frozen integral along temperature.
fn along_temperature(
    medium: &Medium,
    part: CurvePart,
    initial_frozen: f64,
    temperature: f64,
    state: [f64; 3],
) -> [f64; 3] {
    let here = medium.properties(part, temperature);
    let slope = here.conductivity / state[1];
    [slope, -0.5 * state[0] * here.capacity, (here.frozen_fraction - initial_frozen) * slope]
}

/// One trajectory after another, until the far temperature fits.
pub struct Shooting<'a> {
    medium: &'a Medium,
    wall: f64,
    initial: f64,
    initial_frozen: f64,
    /// The kinks on the way, then the initial temperature.
    targets: Vec<f64>,
    /// Scale of eta (m/s^1/2).
    reach: f64,
    /// Scale of temperature (K): the width of a narrow curve, on which properties change.
    resolution: f64,
}

impl<'a> Shooting<'a> {
    /// From a wall into a body of another temperature.
    pub fn new(medium: &'a Medium, wall: f64, initial: f64, initial_frozen: f64) -> Self {
        let mut targets = medium.kinks(wall, initial);
        targets.push(initial);
        let at_wall = medium.properties(medium.part(wall, initial), wall);
        let reach = 2.0 * at_wall.diffusivity().sqrt();
        let range = (initial - wall).abs();
        let resolution = medium.width().clamp(1e-3 * range, range);
        Shooting { medium, wall, initial, initial_frozen, targets, reach, resolution }
    }

    /// The wall flux that leads to the initial temperature: the largest number that does not lead beyond it.
    pub fn wall_flux(&self) -> Result<f64, Unsolved> {
        let direction = (self.initial - self.wall).signum();
        let at_wall = self.medium.properties(self.medium.part(self.wall, self.initial), self.wall);
        let guess = 2.0 * at_wall.conductivity * (self.initial - self.wall).abs() / (self.reach * PI.sqrt());
        let falls_short = |size: f64| Ok::<bool, Unsolved>(self.integrate(direction * size, None)? <= 0.0);
        let (mut low, mut high) = (guess, guess);
        while !falls_short(low)? {
            low *= 0.5;
            if low < 1e-100 * guess {
                return Err(Unsolved::FluxTooLarge);
            }
        }
        while falls_short(high)? {
            high *= 2.0;
            if high > 1e100 * guess {
                return Err(Unsolved::FluxTooSmall);
            }
        }
        loop {
            let middle = low + 0.5 * (high - low);
            if middle <= low || middle >= high {
                return Ok(direction * low);
            }
            if falls_short(middle)? {
                low = middle;
            } else {
                high = middle;
            }
        }
    }

    /// How far the temperature at infinity lies beyond the initial one (K, negative if it falls short).
    pub fn integrate(&self, wall_flux: f64, mut record: Option<&mut Vec<TrajectoryPoint>>) -> Result<f64, Unsolved> {
        let direction = (self.initial - self.wall).signum();
        let mut eta = 0.0;
        let mut state = [self.wall, wall_flux, 0.0];
        let mut length = 1e-4 * self.reach;
        let mut steps = 0;
        for (index, &target) in self.targets.iter().enumerate() {
            let is_last = index + 1 == self.targets.len();
            let part = self.medium.part(state[0], target);
            loop {
                if let Some(nodes) = record.as_deref_mut() {
                    nodes.push(TrajectoryPoint { eta, temperature: state[0], flux: state[1], frozen: state[2], part });
                }
                let here = self.medium.properties(part, state[0]);
                // What a body of these properties still has to come: exact where they no longer change.
                let diffusivity = here.diffusivity();
                let to_come =
                    state[1] / here.conductivity * (PI * diffusivity).sqrt() * erfcx(eta / (2.0 * diffusivity.sqrt()));
                let excess = (state[0] + to_come - self.initial) * direction;
                // Before a kink, though, however little is to come may be enough to pass it.
                let is_stuck = is_last || (state[0] + to_come - target) * direction < 0.0;
                let is_settled = to_come.abs() < UNIFORM * self.resolution && is_stuck;
                let is_uniform = is_last && part != CurvePart::Interval;
                if is_settled || is_uniform || (state[0] - self.initial) * direction > 0.0 {
                    return Ok(excess);
                }
                let (next, used) = self.step_along_eta(part, eta, state, &mut length, &mut steps)?;
                if is_last || (next[0] - target) * direction < 0.0 {
                    (eta, state) = (eta + used, next);
                    continue;
                }
                (eta, state) = self.reach_kink(part, (eta, state), target, record.as_deref_mut(), &mut steps)?;
                break;
            }
        }
        Err(Unsolved::NoEnd)
    }

    /// One step of fitting length; `length` becomes the proposal for the next.
    fn step_along_eta(
        &self,
        part: CurvePart,
        eta: f64,
        state: [f64; 3],
        length: &mut f64,
        steps: &mut usize,
    ) -> Result<([f64; 3], f64), Unsolved> {
        let longest = self.medium.longest_step(state[0]);
        let scales = [self.resolution, state[1].abs(), self.reach];
        loop {
            *steps += 1;
            if *steps > MOST_STEPS {
                return Err(Unsolved::TooManySteps);
            }
            let used = *length;
            let (next, error) =
                step(eta, state, used, |eta, state| along_eta(self.medium, part, self.initial_frozen, eta, state));
            let (accepted, factor) = judge(error, scales);
            if (next[0] - state[0]).abs() > longest {
                *length = 0.5 * used;
                continue;
            }
            *length = used * factor;
            if accepted {
                return Ok((next, used));
            }
        }
    }

    /// From a point close before a kink to the kink itself.
    fn reach_kink(
        &self,
        part: CurvePart,
        (eta, state): (f64, [f64; 3]),
        kink: f64,
        mut record: Option<&mut Vec<TrajectoryPoint>>,
        steps: &mut usize,
    ) -> Result<(f64, [f64; 3]), Unsolved> {
        let mut temperature = state[0];
        let mut turned = [eta, state[1], state[2]];
        let mut length = kink - temperature;
        while temperature != kink {
            *steps += 1;
            if *steps > MOST_STEPS {
                return Err(Unsolved::TooManySteps);
            }
            let longest = self.medium.longest_step(temperature);
            length = length.clamp(-longest, longest);
            let is_final = length.abs() >= (kink - temperature).abs();
            let used = if is_final { kink - temperature } else { length };
            let (next, error) = step(temperature, turned, used, |temperature, state| {
                along_temperature(self.medium, part, self.initial_frozen, temperature, state)
            });
            let (accepted, factor) = judge(error, [self.reach, turned[1].abs(), self.reach]);
            length = used * factor;
            if !accepted {
                if length.abs() < ROUNDING * (self.initial - self.wall).abs() {
                    // The flux dies out just before the kink: there is no telling whether it is reached.
                    break;
                }
                continue;
            }
            turned = next;
            temperature = if is_final { kink } else { temperature + used };
            if let Some(nodes) = record.as_deref_mut().filter(|_| !is_final) {
                nodes.push(TrajectoryPoint { eta: turned[0], temperature, flux: turned[1], frozen: turned[2], part });
            }
        }
        Ok((turned[0], [kink, turned[1], turned[2]]))
    }
}

/// Whether a step is good enough, and the factor for the length of the next.
fn judge(error: [f64; 3], scales: [f64; 3]) -> (bool, f64) {
    let worst = error.iter().zip(scales).map(|(error, scale)| error.abs() / (TOLERANCE * scale)).fold(0.0, f64::max);
    if !worst.is_finite() || error.iter().any(|error| error.is_nan()) {
        return (false, 0.1);
    }
    (worst <= 1.0, (0.9 * worst.max(1e-10).powf(-0.2)).clamp(0.2, 4.0))
}

/// One step of the embedded fifth-order pair of Dormand and Prince (1980): new state and estimated error.
pub fn step(x: f64, state: [f64; 3], length: f64, rate: impl Fn(f64, [f64; 3]) -> [f64; 3]) -> ([f64; 3], [f64; 3]) {
    const NODES: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
    const STAGES: [[f64; 6]; 7] = [
        [0.0; 6],
        [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
        [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
        [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
        [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
        [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
    ];
    const ERRORS: [f64; 7] =
        [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];
    let mut rates = [[0.0; 3]; 7];
    let mut stage_state = state;
    for stage in 0..7 {
        stage_state = state;
        for (earlier, &weight) in STAGES[stage].iter().enumerate().take(stage) {
            for component in 0..3 {
                stage_state[component] += length * weight * rates[earlier][component];
            }
        }
        rates[stage] = rate(x + NODES[stage] * length, stage_state);
    }
    let mut error = [0.0; 3];
    for (weight, rate) in ERRORS.iter().zip(&rates) {
        for component in 0..3 {
            error[component] += length * weight * rate[component];
        }
    }
    (stage_state, error)
}
