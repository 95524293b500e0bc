//! The two-phase Neumann solution: a half space that freezes or thaws at one temperature.

use std::f64::consts::PI;

use frazil_core::physics::material::Material;

use super::Unsolved;
use super::functions::{decreasing_root, erfc_ratio, erfcx};

/// Conductivity and diffusivity of one side of the front.
#[derive(Debug, Clone, Copy)]
struct FrontSide {
    /// Conductivity (W/mK).
    conductivity: f64,
    /// Volumetric heat capacity (J/m3K).
    capacity: f64,
}

impl FrontSide {
    fn frozen(material: &Material) -> Self {
        FrontSide { conductivity: material.frozen.conductivity, capacity: material.frozen_capacity() }
    }

    fn unfrozen(material: &Material) -> Self {
        FrontSide { conductivity: material.unfrozen.conductivity, capacity: material.unfrozen_capacity() }
    }

    /// Thermal diffusivity (m2/s).
    fn diffusivity(&self) -> f64 {
        self.conductivity / self.capacity
    }
}

/// The front and what lies beyond it.
#[derive(Debug, Clone, Copy)]
struct FarSide {
    /// The phase that was there from the start.
    far: FrontSide,
    /// Temperature of the front.
    change: f64,
    /// Front over twice the root of diffusivity (near side) times time.
    lambda: f64,
    /// `lambda` on the scale of the far side.
    far_lambda: f64,
    /// Whether heat is released: false where only the properties change.
    has_latent_heat: bool,
}

/// Temperature of a half space that starts at one temperature and whose wall is held at another, for material
/// whose phases have the same density and change into each other at one temperature (Carslaw and Jaeger 1959,
/// section 11.2). Without a change of phase between the two temperatures it is plain conduction.
#[derive(Debug, Clone)]
pub struct Neumann {
    near: FrontSide,
    wall: f64,
    initial: f64,
    beyond: Option<FarSide>,
}

impl Neumann {
    /// The solution for a material from the temperatures of wall and start.
    ///
    /// A body that starts at the freezing point itself is unfrozen.
    ///
    /// # Errors
    ///
    /// If the material freezes along a curve, or nothing happens between these temperatures.
    pub fn new(material: &Material, wall: f64, initial: f64) -> Result<Self, Unsolved> {
        if material.has_curve() {
            return Err(Unsolved::Curved(material.name.clone()));
        }
        if !wall.is_finite() || !initial.is_finite() || wall == initial {
            return Err(Unsolved::Unchanged { wall, initial });
        }
        let change = material.freezing_point;
        let (frozen, unfrozen) = (FrontSide::frozen(material), FrontSide::unfrozen(material));
        let (near, far) = if wall < change && initial >= change {
            (frozen, unfrozen)
        } else if wall > change && initial < change {
            (unfrozen, frozen)
        } else {
            let side = if wall.min(initial) >= change { unfrozen } else { frozen };
            return Ok(Neumann { near: side, wall, initial, beyond: None });
        };
        let latent_heat = material.volumetric_latent_heat();
        if latent_heat == 0.0 && initial == change {
            return Ok(Neumann { near, wall, initial, beyond: None });
        }
        let ratio = (near.diffusivity() / far.diffusivity()).sqrt();
        let (near_rise, far_rise) = ((change - wall).abs(), (initial - change).abs());
        // Heat conducted away minus heat arriving minus heat released, over near conductivity: falls from
        // infinity to minus infinity as lambda grows.
        let imbalance = |lambda: f64| {
            near_rise * libm::exp(-lambda * lambda) / libm::erf(lambda)
                - far.conductivity / near.conductivity * ratio * far_rise / erfcx(lambda * ratio)
                - PI.sqrt() * lambda * latent_heat / near.capacity
        };
        let lambda = decreasing_root(0.5, imbalance).ok_or_else(|| Unsolved::NoFront {
            material: material.name.clone(),
            wall,
            initial,
        })?;
        let beyond = FarSide { far, change, lambda, far_lambda: lambda * ratio, has_latent_heat: latent_heat > 0.0 };
        Ok(Neumann { near, wall, initial, beyond: Some(beyond) })
    }

    /// Front over `2 sqrt(a t)` with the diffusivity `a` of the phase at the wall; absent without a front.
    pub fn lambda(&self) -> Option<f64> {
        self.beyond.map(|beyond| beyond.lambda)
    }

    /// Distance (m) of the front from the wall at time `t` (s), where phase change releases or takes up heat.
    pub fn front(&self, t: f64) -> Option<f64> {
        let beyond = self.beyond.filter(|beyond| beyond.has_latent_heat)?;
        Some(2.0 * beyond.lambda * (self.near.diffusivity() * t.max(0.0)).sqrt())
    }

    /// Whether the body was frozen at the start and thaws from the wall.
    pub fn is_thawing(&self) -> bool {
        self.beyond.is_some() && self.wall > self.initial
    }

    /// Temperature at a distance `x` (m) from the wall at time `t` (s).
    pub fn temperature(&self, x: f64, t: f64) -> f64 {
        if x <= 0.0 {
            return self.wall;
        }
        if t <= 0.0 {
            return self.initial;
        }
        let near = x / (2.0 * (self.near.diffusivity() * t).sqrt());
        let Some(beyond) = self.beyond else {
            return self.initial + (self.wall - self.initial) * libm::erfc(near);
        };
        if near <= beyond.lambda {
            return self.wall + (beyond.change - self.wall) * (libm::erf(near) / libm::erf(beyond.lambda));
        }
        let far = (x / (2.0 * (beyond.far.diffusivity() * t).sqrt())).max(beyond.far_lambda);
        self.initial + (beyond.change - self.initial) * erfc_ratio(far, beyond.far_lambda)
    }

    /// Heat that leaves through the wall (W/m2) at time `t > 0` (s); negative when it enters.
    pub fn wall_flux(&self, t: f64) -> f64 {
        let (rise, reach) = match self.beyond {
            Some(beyond) => (beyond.change - self.wall, libm::erf(beyond.lambda)),
            None => (self.initial - self.wall, 1.0),
        };
        self.near.conductivity * rise / reach / (PI * self.near.diffusivity() * t).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::similarity::tests::water;
    use crate::table::NumberTable;
    use frazil_core::physics::material::{FreezingLaw, Mixing, Phase};

    /// Library functions are good to a unit in the last place; the fronts compared carry about ten of them.
    const LAST_DIGITS: f64 = 1e-12;

    fn sharp_water() -> Material {
        Material { law: FreezingLaw::Isothermal, ..water(FreezingLaw::None) }
    }

    /// Water in units of dissipative particle dynamics.
    fn edpd(latent_heat: f64, ratio: f64) -> Material {
        Material {
            name: "water".into(),
            density: 4.0,
            frozen: Phase { conductivity: 4.0 * 1e5 * 1.1 * ratio, heat_capacity: 1e5 },
            unfrozen: Phase { conductivity: 4.0 * 1e5 * 1.1, heat_capacity: 1e5 },
            freezing_point: 0.9105,
            latent_heat,
            law: FreezingLaw::Isothermal,
            mixing: Mixing::Arithmetic,
            pores: None,
            soil: None,
        }
    }

    fn cases() -> Vec<Neumann> {
        vec![
            Neumann::new(&sharp_water(), -20.0, 8.0).expect("freezing"),
            Neumann::new(&sharp_water(), 8.0, -20.0).expect("thawing"),
            Neumann::new(&sharp_water(), -5.0, 0.0).expect("one phase"),
            Neumann::new(&edpd(26800.0, 4.08), 0.85, 0.95).expect("particles"),
            Neumann::new(&water(FreezingLaw::None), -20.0, 8.0).expect("kink alone"),
        ]
    }

    #[test]
    fn fronts_of_water_match_the_table() {
        let solution = Neumann::new(&sharp_water(), -20.0, 8.0).expect("water freezes");
        let lambda = solution.lambda().expect("front");
        assert!((lambda / 0.226_220_945_599_501 - 1.0).abs() < LAST_DIGITS, "{lambda}");
        let table = NumberTable::read(include_str!("../tables/water-fronts.csv")).expect("table");
        let (times, fronts) = (table.column("time_s").expect("times"), table.column("front_sharp_m").expect("fronts"));
        assert_eq!(times.len(), 20);
        for (&time, &front) in times.iter().zip(fronts) {
            let own = solution.front(time).expect("front");
            assert!((own / front - 1.0).abs() < LAST_DIGITS, "{time} s: {own} against {front}");
        }
    }

    #[test]
    fn profiles_of_water_match_the_table() {
        let solution = Neumann::new(&sharp_water(), -20.0, 8.0).expect("water freezes");
        let table = NumberTable::read(include_str!("../tables/water-profiles.csv")).expect("table");
        for hours in [2, 4, 6, 8, 10] {
            let positions = table.column("x_m").expect("positions");
            let temperatures = table.column(&format!("sharp_{hours}h")).expect("temperatures");
            for (&x, &expected) in positions.iter().zip(temperatures) {
                let own = solution.temperature(x, 3600.0 * f64::from(hours));
                assert!((own - expected).abs() < 28.0 * LAST_DIGITS, "{x} m, {hours} h: {own} against {expected}");
            }
        }
    }

    #[test]
    fn fronts_in_particle_units_match_the_table() {
        let table = NumberTable::read(include_str!("../tables/edpd-fronts.csv")).expect("table");
        let column = |name: &str| table.column(name).expect("column").to_vec();
        let (latent, ratio, lambda) = (column("latent_heat"), column("diffusivity_ratio"), column("lambda"));
        let (time, front) = (column("time"), column("front"));
        assert_eq!(time.len(), 24);
        for row in 0..time.len() {
            let solution = Neumann::new(&edpd(latent[row], ratio[row]), 0.85, 0.95).expect("front");
            let own = solution.lambda().expect("front");
            // The temperatures differ by little more than a tenth, so their last digits cost one of ours.
            assert!((own / lambda[row] - 1.0).abs() < 10.0 * LAST_DIGITS, "row {row}: {own}");
            let own = solution.front(time[row]).expect("front");
            assert!((own / front[row] - 1.0).abs() < 10.0 * LAST_DIGITS, "row {row}: {own}");
        }
    }

    #[test]
    fn the_dimensionless_case_has_lambda_one_half() {
        let phase = Phase { conductivity: 1.0, heat_capacity: 1.0 };
        let material = Material {
            name: "unit".into(),
            density: 1.0,
            frozen: phase,
            unfrozen: phase,
            freezing_point: 1.0,
            latent_heat: 1.0,
            law: FreezingLaw::Isothermal,
            mixing: Mixing::Arithmetic,
            pores: None,
            soil: None,
        };
        let solution = Neumann::new(&material, 0.190_602_422_788_870_63, 1.2).expect("front");
        assert!((solution.lambda().expect("front") - 0.5).abs() < LAST_DIGITS);
        assert!((solution.front(0.1).expect("front") / 0.1_f64.sqrt() - 1.0).abs() < LAST_DIGITS);
    }

    #[test]
    fn the_heat_equation_holds_on_both_sides() {
        for solution in cases() {
            let beyond = solution.beyond.expect("front");
            let time = 100.0;
            let front = 2.0 * beyond.lambda * (solution.near.diffusivity() * time).sqrt();
            for (x, side) in [(0.5 * front, solution.near), (1.5 * front, beyond.far)] {
                if beyond.change == solution.initial && x > front {
                    continue;
                }
                // Fourth-order differences over 1e-3: truncation 1e-12, cancellation about 1e-9 of the second
                // derivative over the value.
                let (dx, dt) = (1e-3 * front, 1e-3 * time);
                let value = |i: f64, j: f64| solution.temperature(x + i * dx, time + j * dt);
                let rate =
                    (value(0.0, -2.0) - 8.0 * value(0.0, -1.0) + 8.0 * value(0.0, 1.0) - value(0.0, 2.0)) / (12.0 * dt);
                let curvature = (16.0 * (value(-1.0, 0.0) + value(1.0, 0.0))
                    - value(-2.0, 0.0)
                    - value(2.0, 0.0)
                    - 30.0 * value(0.0, 0.0))
                    / (12.0 * dx * dx);
                let residual = rate - side.diffusivity() * curvature;
                assert!(residual.abs() < 1e-5 * rate.abs(), "{residual} of {rate}");
            }
        }
    }

    #[test]
    fn heat_crossing_the_front_balances_its_advance() {
        let material = sharp_water();
        for (wall, initial) in [(-20.0, 8.0), (8.0, -20.0), (-5.0, 0.0)] {
            let solution = Neumann::new(&material, wall, initial).expect("front");
            let time = 3600.0;
            let front = solution.front(time).expect("front");
            let beyond = solution.beyond.expect("front");
            // One-sided second-order differences over 1e-5 of the front: truncation far below the tolerance,
            // cancellation 1e-16/1e-5.
            let step = 1e-5 * front;
            let slope = |side: f64| {
                let value = |k: f64| solution.temperature(front + side * (k * step + 1e-12 * front), time);
                side * (-3.0 * value(0.0) + 4.0 * value(1.0) - value(2.0)) / (2.0 * step)
            };
            let jump = solution.near.conductivity * slope(-1.0) - beyond.far.conductivity * slope(1.0);
            let advance = front / (2.0 * time);
            let sign = if wall < initial { 1.0 } else { -1.0 };
            let expected = sign * material.volumetric_latent_heat() * advance;
            assert!((jump / expected - 1.0).abs() < 1e-6, "{jump} against {expected}");
        }
    }

    #[test]
    fn heat_through_the_wall_is_the_heat_that_the_body_lost() {
        let material = sharp_water();
        for (wall, initial) in [(-20.0, 8.0), (8.0, -20.0)] {
            let solution = Neumann::new(&material, wall, initial).expect("front");
            let (time, beyond) = (3600.0, solution.beyond.expect("front"));
            let front = solution.front(time).expect("front");
            // Simpson's rule with 2000 intervals on each side: error below 1e-10 of the sum.
            let integral = |from: f64, to: f64, of: &dyn Fn(f64) -> f64| {
                let step = (to - from) / 2000.0;
                let inner: f64 =
                    (1..2000).map(|k| of(from + f64::from(k) * step) * if k % 2 == 1 { 4.0 } else { 2.0 }).sum();
                (of(from) + inner + of(to)) * step / 3.0
            };
            let near = integral(0.0, front, &|x| beyond.change - solution.temperature(x, time));
            let end = front + 16.0 * (beyond.far.diffusivity() * time).sqrt();
            let far = integral(front, end, &|x| initial - solution.temperature(x, time));
            let sign = if wall < initial { 1.0 } else { -1.0 };
            let lost = solution.near.capacity * near
                + beyond.far.capacity * (far + (initial - beyond.change) * front)
                + sign * material.volumetric_latent_heat() * front;
            let through = 2.0 * solution.wall_flux(time) * time;
            assert!((through / lost - 1.0).abs() < 1e-9, "{through} against {lost}");
        }
    }

    #[test]
    fn every_place_and_time_has_a_temperature_between_wall_and_start() {
        for solution in cases() {
            let (low, high) = (solution.wall.min(solution.initial), solution.wall.max(solution.initial));
            for time in [0.0, 1e-300, 1e-9, 1.0, 1e9, 1e300] {
                for x in [0.0, 1e-300, 1e-9, 1.0, 1e9, 1e300, f64::INFINITY] {
                    let value = solution.temperature(x, time);
                    assert!(value >= low - 1e-12 && value <= high + 1e-12, "{value} at {x} m, {time} s");
                }
            }
        }
    }

    #[test]
    fn without_phase_change_it_is_an_error_function() {
        let solution = Neumann::new(&sharp_water(), 2.0, 8.0).expect("conduction");
        assert_eq!(solution.front(1.0), None);
        let diffusivity: f64 = 0.6 / 4.182e6;
        let x = 2.0 * (diffusivity * 50.0).sqrt();
        // erf(1) to its last digit.
        let expected = 2.0 + 6.0 * 0.842_700_792_949_714_9;
        assert!((solution.temperature(x, 50.0) - expected).abs() < 1e-13);
        assert!(Neumann::new(&sharp_water(), 8.0, 8.0).is_err());
    }
}
