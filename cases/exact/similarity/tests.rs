//! What solutions must be, and numbers of others.

use super::medium::CurvePart;
use super::*;
use crate::exact::Neumann;
use crate::table::NumberTable;
use frazil_core::physics::freezing_curve::linear::Linear;
use frazil_core::physics::freezing_curve::weibull::Weibull;
use frazil_core::physics::material::{FreezingLaw, Mixing, Phase};

/// What solutions are checked by, and the program has no use for.
impl Similarity {
    /// Heat that leaves through the wall (W/m2) at time `t > 0` (s); negative when it enters.
    fn wall_flux(&self, t: f64) -> f64 {
        self.nodes.first().map_or(0.0, |node| node.flux / t.sqrt())
    }

    /// Distance (m) from the wall of the place that has the given temperature at time `t` (s); absent unless it
    /// lies strictly between the temperatures of wall and start.
    fn isotherm(&self, temperature: f64, t: f64) -> Option<f64> {
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
}

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
        soil: None,
    }
}

fn weibull(width: f64) -> Material {
    water(Weibull { width, residual: 0.0 }.into())
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
        law: Linear { width: 1.0 }.into(),
        mixing: Mixing::Arithmetic,
        pores: None,
        soil: None,
    };
    let residual = Weibull { width: 0.8, residual: 0.2 }.into();
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
    let table = NumberTable::read(include_str!("../../tables/water-fronts.csv")).expect("table");
    let column = |name: &str| table.column(name).expect("column").to_vec();
    let (times, freezing, half) = (column("time_s"), column("isotherm_freezing_m"), column("isotherm_half_m"));
    assert_eq!(times.len(), 20);
    // Where half of what freezes is frozen.
    let half_frozen = -0.5 * std::f64::consts::LN_2.sqrt();
    for row in 0..times.len() {
        let own = solution.isotherm(0.0, times[row]).expect("isotherm");
        // The table comes from a stiff solver at 1e-11; its own error is the larger.
        assert!((own / freezing[row] - 1.0).abs() < 1e-7, "{own} against {}", freezing[row]);
        let own = solution.isotherm(half_frozen, times[row]).expect("isotherm");
        assert!((own / half[row] - 1.0).abs() < 1e-7, "{own} against {}", half[row]);
    }
}

#[test]
fn profiles_match_the_table() {
    let solution = Similarity::new(&weibull(0.5), -20.0, 8.0).expect("solution");
    let table = NumberTable::read(include_str!("../../tables/water-profiles.csv")).expect("table");
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
    function: impl Fn(f64, f64, CurvePart) -> f64,
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
            let change =
                over_temperature(&solution, ends, |eta, temperature, part| -0.5 * eta * capacity(part, temperature));
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
            for law in [FreezingLaw::from(Weibull { width, residual: 0.0 }), Linear { width }.into()] {
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
        for (x, time) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1e300, 1e-300), (f64::INFINITY, 1.0), (1e-300, 1e9)] {
            assert!(solution.temperature(x, time).is_finite());
        }
    }
}

#[test]
fn awkward_curves_have_solutions_too() {
    let curves = [1e-5, 1e-2, 0.3, 40.0].into_iter().flat_map(|width| {
        let full = FreezingLaw::from(Weibull { width, residual: 0.0 });
        [full, FreezingLaw::from(Weibull { width, residual: 0.9 }), Linear { width }.into()]
    });
    for law in curves {
        let ends = [(-20.0, 8.0), (8.0, -20.0), (-1e-3, 8.0), (-20.0, 1e-3), (1e-3, -20.0), (0.0, 8.0), (0.0, -8.0)];
        for (wall, initial) in ends.into_iter().chain([(-20.0, 0.0), (8.0, 0.0), (-1.0, -20.0), (-20.0, -1.0)]) {
            let solution = Similarity::new(&water(law.clone()), wall, initial);
            let front = solution.as_ref().map(|solution| solution.front(1.0));
            assert!(front.is_ok_and(|front| front.is_finite()), "{law:?}, {wall} to {initial}: {:?}", solution.err());
        }
    }
    assert!(Similarity::new(&weibull(0.5), 8.0, 8.0).is_err());
    assert!(Similarity::new(&weibull(0.0), -20.0, 8.0).is_err());
    assert!(Similarity::new(&water(FreezingLaw::Isothermal), -20.0, 8.0).is_err());
}
