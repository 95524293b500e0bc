use super::*;

/// The integral by Gauss and Legendre's rule of order 3 in pieces; `t^2 = rc - r` makes whole and half exponents smooth at the
/// cut-off.
fn quadrature(dimension: usize, cutoff: f64, exponent: f64, power: usize) -> f64 {
    let pieces = 4000;
    let (end, node) = (cutoff.sqrt(), 0.6f64.sqrt());
    let step = end / f64::from(pieces);
    let surface = if dimension == 2 { 2.0 * PI } else { 4.0 * PI };
    let value = |t: f64| {
        let r = cutoff - t * t;
        surface * r.powi((dimension - 1 + power) as i32) * (t * t / cutoff).powf(exponent) * 2.0 * t
    };
    (0..pieces)
        .map(|k| (f64::from(k) + 0.5) * step)
        .map(|t| {
            step * (5.0 * value(t - 0.5 * step * node) + 8.0 * value(t) + 5.0 * value(t + 0.5 * step * node)) / 18.0
        })
        .sum()
}

#[test]
fn moments_are_the_integrals() {
    for dimension in [2, 3] {
        for exponent in [0.0, 0.5, 1.0, 1.5, 2.0, 3.7, 12.0] {
            for power in 0..4 {
                let (exact, sum) =
                    (moment(dimension, 1.96, exponent, power), quadrature(dimension, 1.96, exponent, power));
                // Rounding of 4000 terms; the rule's own error is below that for powers of t that are smooth enough.
                assert!((sum / exact - 1.0).abs() < 1e-11, "{dimension}D, {exponent}, {power}: {sum} {exact}");
            }
        }
    }
}

/// Eqs 12, 13 and 14 as printed for the plane, and the results of Groot and Warren for space with s = 2.
#[test]
fn viscosity_and_diffusivity_are_as_printed() {
    let fluid = Constants::paper();
    let (gamma, rho, rc) = (fluid.friction, fluid.density, fluid.dissipative_cutoff);
    for (s, t) in [(0.3, 0.9), (1.2153, 1.0), (2.6146, 1.2438)] {
        let product = (s + 1.0) * (s + 2.0);
        let more = (s + 3.0) * (s + 4.0);
        let kinetic = t * product / (2.0 * PI * gamma * rho * rc.powi(2));
        let viscosity = 3.0 * PI * gamma * rho * rc.powi(4) / (4.0 * product * more) + kinetic;
        let schmidt =
            0.5 + 3.0 * PI.powi(2) * gamma.powi(2) * rho.powi(2) * rc.powi(6) / (4.0 * t * product.powi(2) * more);
        // Rounding.
        assert!((fluid.viscosity(s, t) / viscosity - 1.0).abs() < 1e-14);
        assert!((fluid.diffusivity(s, t) / (2.0 * kinetic) - 1.0).abs() < 1e-14);
        assert!((fluid.schmidt(s, t) / schmidt - 1.0).abs() < 1e-14);
    }
    let space = Constants { dimension: 3, dissipative_cutoff: 1.1, ..fluid };
    let (cube, fifth) = (1.1f64.powi(3), 1.1f64.powi(5));
    let diffusivity = 45.0 / (2.0 * PI * gamma * rho * cube);
    let viscosity = 0.5 * diffusivity + 2.0 * PI * gamma * rho * fifth / 1575.0;
    assert!((space.diffusivity(2.0, 1.0) / diffusivity - 1.0).abs() < 1e-14);
    assert!((space.viscosity(2.0, 1.0) / viscosity - 1.0).abs() < 1e-14);
}

#[test]
fn a_schmidt_number_comes_back() {
    for dimension in [2, 3] {
        let fluid = Constants { dimension, ..Constants::paper() };
        for schmidt in [0.5000001, 0.6, 1.0, 33.94, 388.2, 10355.66, 1e6, 1e12] {
            for temperature in [0.5, 0.84, 1.0, 1.24, 3.0] {
                let s = fluid.exponent(schmidt, temperature).expect("above a half");
                let again = fluid.schmidt(s, temperature);
                // The excess over 1/2 is what the exponent decides; rounding of that sum and of s + 1 limits it.
                let excess = (again - 0.5) / (schmidt - 0.5) - 1.0;
                assert!(
                    excess.abs() < 1e-13 + 4e-16 / (schmidt - 0.5) + 4e-16 / (s + 1.0),
                    "{dimension}D {schmidt} {temperature}: {again}"
                );
                let rc = fluid.critical_cutoff(schmidt, temperature).expect("above a half");
                let there = Constants { dissipative_cutoff: rc, ..fluid };
                assert!((there.schmidt(0.0, temperature) / schmidt - 1.0).abs() < 1e-13);
                assert_eq!(s >= 0.0, rc <= fluid.dissipative_cutoff);
            }
        }
        for none in [0.5, 0.4, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(fluid.exponent(none, 1.0), None);
            assert_eq!(fluid.critical_cutoff(none, 1.0), None);
        }
    }
}

/// Section 3: all to the four places that are printed, and to half a unit of the fifth.
#[test]
fn critical_cutoffs_are_those_of_the_paper() {
    let cutoff = |friction, schmidt, temperature| {
        let fluid = Constants { friction, ..Constants::paper() };
        fluid.critical_cutoff(schmidt, temperature).expect("above a half")
    };
    for (friction, schmidt, temperature, printed) in [
        (4.5, 10355.66, 253.15 / 300.0, 2.3648),
        (8.0, 10355.66, 253.15 / 300.0, 1.9521),
        (4.5, 1619.74, 273.15 / 300.0, 1.7579),
    ] {
        let own = cutoff(friction, schmidt, temperature);
        assert!((own - printed).abs() < 5e-5, "{own} {printed}");
    }
}

#[test]
fn heat_friction_is_that_of_the_paper() {
    let fluid = Constants::paper();
    // The five digits that are known of it, and 1.3195 of section 4.3.
    assert!((fluid.heat_friction(1.1) - 7.1177e-6).abs() < 5e-11);
    let short = Constants { thermal_cutoff: 1.0, ..fluid };
    assert!((short.thermal_diffusivity(1.26e-4) - 1.3195).abs() < 5e-5);
    for dimension in [2, 3] {
        let fluid = Constants { dimension, thermal_cutoff: 1.3, ..fluid };
        let spread = quadrature(dimension, 1.3, 2.0, 2);
        let expected = 2.0 * dimension as f64 * 0.7 / (4.0 * 1e5 * spread);
        assert!((fluid.heat_friction(0.7) / expected - 1.0).abs() < 1e-11);
    }
}

/// In space at a cut-off of 1 the mean-field pressure has pi/30 a rho^2 where Groot and Warren measure 0.101 a rho^2.
#[test]
fn stiffness_is_that_of_the_mean_field() {
    let space = Constants { dimension: 3, density: 3.0, conservative_cutoff: 1.0, ..Constants::paper() };
    let a = space.printed_repulsion(1.0);
    assert_eq!(a, 25.0);
    assert!((space.stiffness(a, 1.0) / (1.0 + 2.0 * PI / 30.0 * 3.0 * a) - 1.0).abs() < 1e-14);
    assert!((space.repulsion(space.stiffness(a, 1.0), 1.0) / a - 1.0).abs() < 1e-14);
}

#[test]
fn scales_of_water_are_those_of_the_paper() {
    let water = RealFluid { density: 1000.0, heat_capacity: 4180.0 };
    let scales = Scales::new(&Constants::paper(), &water, 300.0);
    // 334000/4180 * 1e5/300, to rounding; printed as 2.68e4 from a length rounded to 11 nm.
    assert!((scales.latent_heat(334_000.0) - 26634.77).abs() < 5e-3, "{}", scales.latent_heat(334_000.0));
    // 10.974 nm with the Boltzmann constant as printed.
    let printed = scales.length * (1.381e-23 / BOLTZMANN).cbrt();
    assert!((printed - 10.974e-9).abs() < 5e-13, "{printed}");
    let rounded = 1000.0 * 11e-9f64.powi(3) * 334_000.0 / (4.0 * scales.energy);
    assert!((rounded - 26833.0).abs() < 1.0, "{rounded}");
    // A cube of the unit of length weighs what its particles weigh, and stores what they store.
    let cube = scales.length.powi(3);
    assert!((1000.0 * cube / (4.0 * scales.mass) - 1.0).abs() < 1e-14);
    assert!((1000.0 * 4180.0 * cube / (4.0 * 1e5 * BOLTZMANN) - 1.0).abs() < 1e-14);
    let velocity = scales.length / scales.time;
    assert!((scales.mass * velocity * velocity / scales.energy - 1.0).abs() < 1e-14);
}

#[test]
fn polynomials_are_found_again() {
    let truth = Polynomial { coefficients: vec![-10.665, 20.016, -11.443, 2.5548] };
    let points: Vec<_> = (0..9).map(|k| 0.84 + 0.05 * f64::from(k)).map(|x| (x, truth.at(x))).collect();
    let found = least_squares(&points, 3).expect("enough points");
    for (own, expected) in found.coefficients.iter().zip(&truth.coefficients) {
        // Rounding, enlarged by the shift from [0.84, 1.24] to 0: (1/0.2)^3 times a few.
        assert!((own - expected).abs() < 1e-10, "{own} {expected}");
    }
    assert!((found.determination(&points) - 1.0).abs() < 1e-14);
    assert_eq!(least_squares(&points[..3], 3), None);
    assert_eq!(least_squares(&[points[0]; 5], 1), None);
    assert_eq!(least_squares(&points[..1], 0).map(|constant| constant.at(7.0)), Some(points[0].1));
    // The residual of the best line is orthogonal to 1 and x.
    let line = least_squares(&points, 1).expect("enough points");
    let left = |power: i32| points.iter().map(|(x, y)| (y - line.at(*x)) * x.powi(power)).sum::<f64>();
    assert!(left(0).abs() < 1e-12 && left(1).abs() < 1e-12);
}
