//! The similarity solution of conduction with a freezing curve in a half space.
//!
//! With `eta = x / sqrt(t)` the equation `C(T) T_t = (k(T) T_x)_x` becomes
//! `q' + (eta / 2) C(T) T' = 0`, `q = k(T) T'`: an initial-value problem in `eta` whose flux at the wall is found
//! by shooting. Where the curve has a kink the last step before it is taken with `T` as the independent variable
//! (Henon 1982), so that no step straddles one.

use std::f64::consts::PI;

use frazil_core::physics::material::{FreezingLaw, Material, Mixing};

use super::functions::{erfc_ratio, erfcx};

/// Local error of one step, relative to the scale of each variable.
const TOLERANCE: f64 = 1e-13;

/// Beyond a remaining change of this fraction of the width of the curve the body counts as uniform.
const UNIFORM: f64 = 1e-10;

/// Greatest mismatch of the far temperature, over the range, that shooting may leave.
const MISMATCH: f64 = 1e-9;

/// Widths below the freezing point at which a Weibull curve begins to be felt: exp(-49) is beyond the last digit.
const WEIBULL_PEAK: f64 = 7.0;

/// Temperatures closer than this fraction of the range are the same.
const ROUNDING: f64 = 1e-14;

/// Steps after which an integration is given up.
const MOST_STEPS: usize = 400_000;

/// Part of the freezing curve on which it is smooth. Each formula is also meaningful a little outside its part.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    Unfrozen,
    Interval,
    Frozen,
}

/// Properties at one temperature.
#[derive(Debug, Clone, Copy)]
struct Properties {
    /// Apparent heat capacity, latent heat included (J/m3K).
    capacity: f64,
    /// Conductivity (W/mK).
    conductivity: f64,
    frozen_fraction: f64,
}

impl Properties {
    fn diffusivity(&self) -> f64 {
        self.conductivity / self.capacity
    }
}

/// Properties of a material over temperature.
#[derive(Debug, Clone)]
struct Medium {
    material: Material,
}

impl Medium {
    fn properties(&self, part: Part, temperature: f64) -> Properties {
        let material = &self.material;
        let below = temperature - material.freezing_point;
        let (unfrozen, slope) = match (part, material.law) {
            (Part::Unfrozen, _) | (_, FreezingLaw::None) => (1.0, 0.0),
            (Part::Frozen, _) | (_, FreezingLaw::Isothermal) => (0.0, 0.0),
            (Part::Interval, FreezingLaw::Linear { width }) => (1.0 + below / width, 1.0 / width),
            (Part::Interval, FreezingLaw::Weibull { width, residual }) => {
                let free = (1.0 - residual) * libm::exp(-(below / width) * (below / width));
                (residual + free, -2.0 * below / (width * width) * free)
            }
        };
        let frozen = 1.0 - unfrozen;
        let capacity = unfrozen * material.unfrozen_capacity()
            + frozen * material.frozen_capacity()
            + material.volumetric_latent_heat() * slope;
        let (liquid, solid) = (material.unfrozen.conductivity, material.frozen.conductivity);
        let conductivity = match material.mixing {
            Mixing::Arithmetic => unfrozen * liquid + frozen * solid,
            Mixing::Geometric => solid * libm::pow(liquid / solid, unfrozen),
        };
        Properties { capacity, conductivity, frozen_fraction: frozen }
    }

    /// The part that holds temperatures just beside `temperature`, in the direction of `towards`.
    fn part(&self, temperature: f64, towards: f64) -> Part {
        let below = temperature - self.material.freezing_point;
        let is_warming = towards > temperature;
        let is_past = |limit: f64| below > limit || (below == limit && is_warming);
        match self.material.law {
            _ if is_past(0.0) => Part::Unfrozen,
            FreezingLaw::Linear { width } if !is_past(-width) => Part::Frozen,
            _ => Part::Interval,
        }
    }

    /// Longest step in temperature (K) from a given one: inside the peak of the apparent capacity, half its width,
    /// lest a step leap over all of it.
    fn longest_step(&self, temperature: f64) -> f64 {
        let below = temperature - self.material.freezing_point;
        match self.material.law {
            FreezingLaw::Linear { width } if below.abs() <= width => 0.5 * width,
            FreezingLaw::Weibull { width, .. } if below.abs() <= WEIBULL_PEAK * width * (1.0 + 1e-9) => 0.5 * width,
            _ => f64::INFINITY,
        }
    }

    /// Kinks of the curve strictly between two temperatures, in the order in which they are met.
    fn kinks(&self, from: f64, to: f64) -> Vec<f64> {
        let freezing_point = self.material.freezing_point;
        let mut kinks = match self.material.law {
            FreezingLaw::Linear { width } => vec![freezing_point - width, freezing_point],
            // No kink, but where the peak of the apparent capacity begins.
            FreezingLaw::Weibull { width, .. } => vec![freezing_point - WEIBULL_PEAK * width, freezing_point],
            FreezingLaw::None | FreezingLaw::Isothermal => vec![freezing_point],
        };
        kinks.retain(|&kink| (kink - from) * (kink - to) < 0.0);
        if to < from {
            kinks.reverse();
        }
        kinks
    }
}

/// A point of the solution and the part of the curve that follows it.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// x / sqrt(t) (m/s^1/2).
    eta: f64,
    temperature: f64,
    /// k dT/d eta (W s^1/2 / m2).
    flux: f64,
    /// Integral of the frozen fraction less its value at infinity (m/s^1/2).
    frozen: f64,
    part: Part,
}

/// The solution for one material, wall temperature and initial temperature.
#[derive(Debug, Clone)]
pub struct Similarity {
    medium: Medium,
    wall: f64,
    initial: f64,
    /// Frozen fraction of the untouched body.
    initial_frozen: f64,
    nodes: Vec<Node>,
    /// Diffusivity beyond the last node (m2/s).
    tail_diffusivity: f64,
    /// Integral of the frozen fraction less its value at infinity, over the half space (m/s^1/2).
    frozen: f64,
}

impl Similarity {
    /// The solution for a material from the temperatures of wall and start.
    pub fn new(material: &Material, wall: f64, initial: f64) -> Result<Self, String> {
        if !wall.is_finite() || !initial.is_finite() || wall == initial {
            return Err(format!("a wall at {wall} does not change a body at {initial}"));
        }
        match material.law {
            FreezingLaw::Linear { width } | FreezingLaw::Weibull { width, .. } if width > 0.0 => {}
            _ => return Err(format!("{} has no freezing curve", material.name)),
        }
        let medium = Medium { material: material.clone() };
        // Seen from the wall, so that a body at the freezing point itself counts as what it is about to become.
        let last_part = medium.part(initial, wall);
        let initial_frozen = medium.properties(last_part, initial).frozen_fraction;
        let shooting = Shooting::new(&medium, wall, initial, initial_frozen);
        let flux = shooting.wall_flux()?;
        let mut nodes = Vec::new();
        let excess = shooting.integrate(flux, Some(&mut nodes))?;
        let last = nodes.last().ok_or("the similarity solution has no points")?;
        if excess.abs() > MISMATCH * (initial - wall).abs() {
            return Err(format!(
                "the similarity solution of {} does not reach {initial}; its curve may be too narrow",
                material.name
            ));
        }
        let tail_diffusivity = medium.properties(last.part, last.temperature).diffusivity();
        let frozen = last.frozen;
        Ok(Similarity { medium, wall, initial, initial_frozen, nodes, tail_diffusivity, frozen })
    }

    /// Temperature at a distance `x` (m) from the wall at time `t` (s).
    pub fn temperature(&self, x: f64, t: f64) -> f64 {
        if x <= 0.0 {
            return self.wall;
        }
        if t <= 0.0 {
            return self.initial;
        }
        self.at(x / t.sqrt())
    }

    /// Heat that leaves through the wall (W/m2) at time `t > 0` (s); negative when it enters.
    pub fn wall_flux(&self, t: f64) -> f64 {
        self.nodes.first().map_or(0.0, |node| node.flux / t.sqrt())
    }

    /// Frozen length (m) that the wall has added by time `t` (s): the integral of the frozen fraction over the
    /// half space less its initial value. Negative where the wall thaws.
    pub fn front(&self, t: f64) -> f64 {
        self.frozen * t.max(0.0).sqrt()
    }

    /// Integral of the frozen fraction (m) over the first `length` (m) of the half space, which the wall is taken
    /// not to have reached through, at time `t` (s).
    pub fn frozen_length(&self, length: f64, t: f64) -> f64 {
        (self.initial_frozen * length + self.front(t)).max(0.0)
    }

    /// Distance (m) from the wall of the place that has the given temperature at time `t` (s); absent unless it
    /// lies strictly between the temperatures of wall and start.
    pub fn isotherm(&self, temperature: f64, t: f64) -> Option<f64> {
        if (temperature - self.wall) * (temperature - self.initial) >= 0.0 {
            return None;
        }
        let rising = self.initial > self.wall;
        let is_reached = |value: f64| if rising { value >= temperature } else { value <= temperature };
        let after = self.nodes.partition_point(|node| !is_reached(node.temperature));
        let mut low = self.nodes[after.saturating_sub(1)].eta;
        let mut high = match self.nodes.get(after) {
            Some(node) => node.eta,
            // 20 diffusion lengths: erfc is below the least number there.
            None => low + 40.0 * self.tail_diffusivity.sqrt(),
        };
        for _ in 0..200 {
            let middle = low + 0.5 * (high - low);
            if middle <= low || middle >= high {
                break;
            }
            if is_reached(self.at(middle)) {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(0.5 * (low + high) * t.max(0.0).sqrt())
    }

    /// Distance (m) from the wall of the place that is frozen half-way between none and all that the curve
    /// allows, at time `t` (s).
    pub fn half_frozen(&self, t: f64) -> Option<f64> {
        let below = match self.medium.material.law {
            FreezingLaw::Linear { width } => 0.5 * width,
            FreezingLaw::Weibull { width, .. } => width * std::f64::consts::LN_2.sqrt(),
            FreezingLaw::None | FreezingLaw::Isothermal => return None,
        };
        self.isotherm(self.medium.material.freezing_point - below, t)
    }

    /// Temperature at `eta = x / sqrt(t)`: one step from the node before it, which is as good as the nodes.
    fn at(&self, eta: f64) -> f64 {
        let after = self.nodes.partition_point(|node| node.eta <= eta);
        let node = self.nodes[after.saturating_sub(1)];
        if after >= self.nodes.len() {
            let scale = 2.0 * self.tail_diffusivity.sqrt();
            return self.initial + (node.temperature - self.initial) * erfc_ratio(eta / scale, node.eta / scale);
        }
        let state = [node.temperature, node.flux, node.frozen];
        let (state, _) = step(node.eta, state, eta - node.eta, |eta, state| {
            along_eta(&self.medium, node.part, self.initial_frozen, eta, state)
        });
        state[0]
    }
}

/// Derivatives of temperature, flux and frozen integral along eta.
fn along_eta(medium: &Medium, part: Part, initial_frozen: f64, eta: f64, state: [f64; 3]) -> [f64; 3] {
    let here = medium.properties(part, state[0]);
    let slope = state[1] / here.conductivity;
    [slope, -0.5 * eta * here.capacity * slope, here.frozen_fraction - initial_frozen]
}

/// Derivatives of eta, flux and frozen integral along temperature.
fn along_temperature(medium: &Medium, part: Part, initial_frozen: f64, temperature: f64, state: [f64; 3]) -> [f64; 3] {
    let here = medium.properties(part, temperature);
    let slope = here.conductivity / state[1];
    [slope, -0.5 * state[0] * here.capacity, (here.frozen_fraction - initial_frozen) * slope]
}

/// One trajectory after another, until the far temperature fits.
struct Shooting<'a> {
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
    fn new(medium: &'a Medium, wall: f64, initial: f64, initial_frozen: f64) -> Self {
        let mut targets = medium.kinks(wall, initial);
        targets.push(initial);
        let at_wall = medium.properties(medium.part(wall, initial), wall);
        let reach = 2.0 * at_wall.diffusivity().sqrt();
        let range = (initial - wall).abs();
        let width = match medium.material.law {
            FreezingLaw::Linear { width } | FreezingLaw::Weibull { width, .. } => width,
            FreezingLaw::None | FreezingLaw::Isothermal => range,
        };
        let resolution = width.clamp(1e-3 * range, range);
        Shooting { medium, wall, initial, initial_frozen, targets, reach, resolution }
    }

    /// The wall flux that leads to the initial temperature: the largest number that does not lead beyond it.
    fn wall_flux(&self) -> Result<f64, String> {
        let direction = (self.initial - self.wall).signum();
        let at_wall = self.medium.properties(self.medium.part(self.wall, self.initial), self.wall);
        let guess = 2.0 * at_wall.conductivity * (self.initial - self.wall).abs() / (self.reach * PI.sqrt());
        let falls_short = |size: f64| Ok::<bool, String>(self.integrate(direction * size, None)? <= 0.0);
        let (mut low, mut high) = (guess, guess);
        while !falls_short(low)? {
            low *= 0.5;
            if low < 1e-100 * guess {
                return Err("no wall flux is small enough".into());
            }
        }
        while falls_short(high)? {
            high *= 2.0;
            if high > 1e100 * guess {
                return Err("no wall flux is large enough".into());
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
    fn integrate(&self, wall_flux: f64, mut record: Option<&mut Vec<Node>>) -> Result<f64, String> {
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
                    nodes.push(Node { eta, temperature: state[0], flux: state[1], frozen: state[2], part });
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
                let is_uniform = is_last && part != Part::Interval;
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
        Err("the similarity solution has no end".into())
    }

    /// One step of fitting length; `length` becomes the proposal for the next.
    fn step_along_eta(
        &self,
        part: Part,
        eta: f64,
        state: [f64; 3],
        length: &mut f64,
        steps: &mut usize,
    ) -> Result<([f64; 3], f64), String> {
        let longest = self.medium.longest_step(state[0]);
        let scales = [self.resolution, state[1].abs(), self.reach];
        loop {
            *steps += 1;
            if *steps > MOST_STEPS {
                return Err("the similarity solution takes too many steps".into());
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
        part: Part,
        (eta, state): (f64, [f64; 3]),
        kink: f64,
        mut record: Option<&mut Vec<Node>>,
        steps: &mut usize,
    ) -> Result<(f64, [f64; 3]), String> {
        let mut temperature = state[0];
        let mut turned = [eta, state[1], state[2]];
        let mut length = kink - temperature;
        while temperature != kink {
            *steps += 1;
            if *steps > MOST_STEPS {
                return Err("the similarity solution takes too many steps".into());
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
                nodes.push(Node { eta: turned[0], temperature, flux: turned[1], frozen: turned[2], part });
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
fn step(x: f64, state: [f64; 3], length: f64, rate: impl Fn(f64, [f64; 3]) -> [f64; 3]) -> ([f64; 3], [f64; 3]) {
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

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::exact::Neumann;
    use crate::table::Table;
    use frazil_core::physics::material::Phase;

    /// Water as in the tables.
    pub(crate) fn water(law: FreezingLaw) -> Material {
        Material {
            name: "water".into(),
            density: 1000.0,
            frozen: Phase { conductivity: 2.14, heat_capacity: 2060.0 },
            unfrozen: Phase { conductivity: 0.6, heat_capacity: 4182.0 },
            freezing_point: 0.0,
            latent_heat: 334_000.0,
            law,
            mixing: Mixing::Geometric,
            pores: None,
        }
    }

    fn weibull(width: f64) -> Material {
        water(FreezingLaw::Weibull { width, residual: 0.0 })
    }

    /// Materials and temperatures that together pass through every branch: freezing and thawing, both laws, both
    /// mixings, a residual, and starts at, inside and beyond the interval.
    fn cases() -> Vec<(Material, f64, f64)> {
        let soil = Material {
            name: "soil".into(),
            density: 1800.0,
            frozen: Phase { conductivity: 2.68, heat_capacity: 1100.0 },
            unfrozen: Phase { conductivity: 1.5, heat_capacity: 1500.0 },
            freezing_point: -0.25,
            latent_heat: 50_000.0,
            law: FreezingLaw::Linear { width: 1.0 },
            mixing: Mixing::Arithmetic,
            pores: None,
        };
        let residual = FreezingLaw::Weibull { width: 0.8, residual: 0.2 };
        vec![
            (weibull(0.5), -20.0, 8.0),
            (weibull(0.5), 8.0, -20.0),
            (weibull(0.5), -20.0, 0.0),
            (weibull(0.5), 3.0, -0.3),
            (soil.clone(), -5.0, 1.0),
            (soil.clone(), 2.0, -5.0),
            (soil.clone(), -5.0, -0.25),
            (soil.clone(), -0.75, 1.0),
            (Material { mixing: Mixing::Geometric, ..soil.clone() }, -5.0, -0.5),
            (Material { law: residual, ..soil }, -10.0, 10.0),
        ]
    }

    #[test]
    fn isotherms_match_the_table() {
        let solution = Similarity::new(&weibull(0.5), -20.0, 8.0).expect("solution");
        let table = Table::read(include_str!("../tables/water-fronts.csv")).expect("table");
        let column = |name: &str| table.column(name).expect("column").to_vec();
        let (times, freezing, half) = (column("time_s"), column("isotherm_freezing_m"), column("isotherm_half_m"));
        assert_eq!(times.len(), 20);
        for row in 0..times.len() {
            let own = solution.isotherm(0.0, times[row]).expect("isotherm");
            // The table comes from a stiff solver at 1e-11; its own error is the larger.
            assert!((own / freezing[row] - 1.0).abs() < 1e-7, "{own} against {}", freezing[row]);
            let own = solution.half_frozen(times[row]).expect("isotherm");
            assert!((own / half[row] - 1.0).abs() < 1e-7, "{own} against {}", half[row]);
        }
    }

    #[test]
    fn profiles_match_the_table() {
        let solution = Similarity::new(&weibull(0.5), -20.0, 8.0).expect("solution");
        let table = Table::read(include_str!("../tables/water-profiles.csv")).expect("table");
        for hours in [2, 4, 6, 8, 10] {
            let positions = table.column("x_m").expect("positions");
            let temperatures = table.column(&format!("mushy_{hours}h")).expect("temperatures");
            for (&x, &expected) in positions.iter().zip(temperatures) {
                let own = solution.temperature(x, 3600.0 * f64::from(hours));
                assert!((own - expected).abs() < 1e-6, "{x} m, {hours} h: {own} against {expected}");
            }
        }
    }

    /// Integral over temperature of a function of eta and the properties there. Kinks end pieces, and points crowd
    /// at the ends of each, where eta may grow like the root of a logarithm: with 4000 points the midpoint rule
    /// is good to about 1e-7.
    fn over_temperature(
        solution: &Similarity,
        (from, to): (f64, f64),
        function: impl Fn(f64, f64, Part) -> f64,
    ) -> f64 {
        let mut ends = vec![from];
        ends.extend(solution.medium.kinks(from, to));
        ends.push(to);
        let points = 4000;
        let piece = |(start, end): (f64, f64)| -> f64 {
            let part = solution.medium.part(0.5 * (start + end), end);
            (0..points)
                .map(|k| {
                    let share = (f64::from(k) + 0.5) / f64::from(points);
                    let temperature = start + (end - start) * share * share * (3.0 - 2.0 * share);
                    let weight = 6.0 * share * (1.0 - share) * (end - start) / f64::from(points);
                    let eta = solution.isotherm(temperature, 1.0).expect("inside");
                    function(eta, temperature, part) * weight
                })
                .sum()
        };
        ends.windows(2).map(|pair| piece((pair[0], pair[1]))).sum()
    }

    #[test]
    fn the_equation_holds_everywhere() {
        for (material, wall, initial) in cases() {
            let solution = Similarity::new(&material, wall, initial).expect("solution");
            // From one isotherm to another the flux changes by -1/2 integral of eta C dT; both sides come from
            // the temperatures alone.
            let at = |share: f64| wall + (initial - wall) * share;
            let flux_at = |temperature: f64| {
                let eta = solution.isotherm(temperature, 1.0).expect("inside");
                let small = 1e-4 * eta;
                let slope = (solution.at(eta - 2.0 * small) - 8.0 * solution.at(eta - small)
                    + 8.0 * solution.at(eta + small)
                    - solution.at(eta + 2.0 * small))
                    / (12.0 * small);
                let part = solution.medium.part(temperature, initial);
                slope * solution.medium.properties(part, temperature).conductivity
            };
            for tenth in 1..9 {
                let from = 0.1 * f64::from(tenth) + 0.003;
                let ends = (at(from), at(from + 0.1));
                let capacity = |part, temperature| solution.medium.properties(part, temperature).capacity;
                let change = over_temperature(&solution, ends, |eta, temperature, part| {
                    -0.5 * eta * capacity(part, temperature)
                });
                let expected = flux_at(ends.1) - flux_at(ends.0);
                // Differences over 1e-4 lose half the digits of the temperatures, which are good to 1e-12.
                let scale = solution.nodes[0].flux.abs();
                assert!(
                    (change - expected).abs() < 1e-6 * scale,
                    "{material:?} {wall} to {initial}, share {from}: {change} against {expected} of {scale}"
                );
            }
            let middle = 0.5 * (wall + initial);
            let place = solution.isotherm(middle, 3600.0).expect("inside");
            assert!((solution.temperature(place, 3600.0) - middle).abs() < 1e-10 * (wall - initial).abs());
        }
    }

    #[test]
    fn heat_through_the_wall_is_the_heat_that_the_body_lost() {
        for (material, wall, initial) in cases() {
            let solution = Similarity::new(&material, wall, initial).expect("solution");
            let medium = &solution.medium;
            let heat = over_temperature(&solution, (wall, initial), |eta, temperature, part| {
                eta * medium.properties(part, temperature).capacity
            });
            // Differences over a millionth of the range: truncation and cancellation below 1e-8.
            let small = 1e-6 * (initial - wall).abs();
            let frozen = over_temperature(&solution, (wall, initial), |eta, temperature, part| {
                let fraction = |temperature| medium.properties(part, temperature).frozen_fraction;
                eta * (fraction(temperature - small) - fraction(temperature + small)) / (2.0 * small)
            });
            let through = 2.0 * solution.wall_flux(1.0);
            assert!((heat / through - 1.0).abs() < 1e-6, "{material:?}: {heat} against {through}");
            assert!((frozen / solution.front(1.0) - 1.0).abs() < 1e-6, "{material:?}: {frozen}");
        }
    }

    #[test]
    fn a_narrow_curve_tends_to_neumann() {
        for (wall, initial) in [(-20.0, 8.0), (8.0, -20.0)] {
            let material = water(FreezingLaw::Isothermal);
            let neumann = Neumann::new(&material, wall, initial).expect("front");
            let front = neumann.front(1.0).expect("front");
            let mut errors = Vec::new();
            for width in [0.1, 0.01, 0.001] {
                for law in [FreezingLaw::Weibull { width, residual: 0.0 }, FreezingLaw::Linear { width }] {
                    let solution = Similarity::new(&water(law), wall, initial).expect("solution");
                    errors.push((solution.front(1.0).abs() / front - 1.0).abs());
                }
            }
            // First order in the width, so each tenth of the width leaves at most a fifth of the error.
            for (wide, narrow) in errors.iter().zip(&errors[2..]) {
                assert!(*narrow < 0.2 * wide, "{errors:?}");
            }
            // Measured: 1.7e-4 when thawing, where the slope of temperature beyond the front is least.
            assert!(errors[4] < 2e-4 && errors[5] < 2e-4, "{errors:?}");
        }
    }

    #[test]
    fn equal_phases_without_latent_heat_are_plain_conduction() {
        let phase = Phase { conductivity: 2.0, heat_capacity: 1000.0 };
        let plain = Material { frozen: phase, unfrozen: phase, latent_heat: 0.0, ..weibull(0.5) };
        let solution = Similarity::new(&plain, -20.0, 8.0).expect("solution");
        let conduction = Neumann::new(&Material { law: FreezingLaw::None, ..plain }, -20.0, 8.0).expect("conduction");
        for x in [0.001, 0.02, 0.1, 0.3, 0.6, 3.0] {
            let (own, exact) = (solution.temperature(x, 3600.0), conduction.temperature(x, 3600.0));
            assert!((own - exact).abs() < 28.0 * 1e-10, "{x} m: {own} against {exact}");
        }
    }

    #[test]
    fn every_place_and_time_has_a_temperature_between_wall_and_start() {
        for (material, wall, initial) in cases() {
            let solution = Similarity::new(&material, wall, initial).expect("solution");
            let (low, high) = (wall.min(initial), wall.max(initial));
            let mut last = wall;
            for k in 0..2000 {
                let value = solution.temperature(f64::from(k) * 1e-3, 3600.0);
                let is_onward = (value - last) * (initial - wall) >= -1e-9;
                assert!(value >= low - 1e-9 && value <= high + 1e-9 && is_onward, "{value} at {k} mm");
                last = value;
            }
            for (x, time) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1e300, 1e-300), (f64::INFINITY, 1.0), (1e-300, 1e9)]
            {
                assert!(solution.temperature(x, time).is_finite());
            }
        }
    }

    #[test]
    fn awkward_curves_have_solutions_too() {
        let curves = [1e-5, 1e-2, 0.3, 40.0].into_iter().flat_map(|width| {
            let full = FreezingLaw::Weibull { width, residual: 0.0 };
            [full, FreezingLaw::Weibull { width, residual: 0.9 }, FreezingLaw::Linear { width }]
        });
        for law in curves {
            let ends =
                [(-20.0, 8.0), (8.0, -20.0), (-1e-3, 8.0), (-20.0, 1e-3), (1e-3, -20.0), (0.0, 8.0), (0.0, -8.0)];
            for (wall, initial) in ends.into_iter().chain([(-20.0, 0.0), (8.0, 0.0), (-1.0, -20.0), (-20.0, -1.0)]) {
                let solution = Similarity::new(&water(law), wall, initial);
                let front = solution.as_ref().map(|solution| solution.front(1.0));
                assert!(
                    front.is_ok_and(|front| front.is_finite()),
                    "{law:?}, {wall} to {initial}: {:?}",
                    solution.err()
                );
            }
        }
        assert!(Similarity::new(&weibull(0.5), 8.0, 8.0).is_err());
        assert!(Similarity::new(&weibull(0.0), -20.0, 8.0).is_err());
        assert!(Similarity::new(&water(FreezingLaw::Isothermal), -20.0, 8.0).is_err());
    }
}
