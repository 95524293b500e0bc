use super::super::soil::Retention;
use super::super::soil::tests::{DAY, yan};
use super::*;

/// A length over the root of time in centimetres and days.
fn in_centimetres(length: f64) -> f64 {
    length * 100.0 * DAY.sqrt()
}

fn absorption(retention: Retention, initial: f64, wall: f64) -> Absorption {
    let soil = Soil::new(retention, 0.05, 0.4, 1e-6).expect("a soil");
    Absorption::new(soil, initial, wall).unwrap_or_else(|error| unreachable!("{retention:?} {initial}: {error}"))
}

#[test]
fn the_dry_column_is_the_published_one() {
    let solution = Absorption::new(yan(), 0.0, 1.0).expect("a solution");
    let found =
        [solution.sorptivity(), solution.position(0.5, 1.0).expect("half"), solution.foot(1.0).expect("a foot")];
    for (found, expected) in found.map(in_centimetres).into_iter().zip([0.264_446, 1.616_05, 1.656_83]) {
        assert!((found / expected - 1.0).abs() < 4e-6, "{found}, must be {expected}");
    }
    assert_eq!(solution.position(1.0, DAY), Some(0.0));
    assert_eq!(solution.saturation(0.0, DAY), 1.0);
    assert_eq!(solution.saturation(solution.foot(DAY).expect("a foot") * (1.0 + 1e-12), DAY), 0.0);
}

/// Finite volumes on 800 cells: front at 5 and 15 d (cm), water at 15 d (cm).
#[test]
fn wet_columns_are_the_published_ones() {
    for (initial, five, fifteen, water) in [
        (1e-4, 3.614, 6.259, 1.0241),
        (1e-3, 3.616, 6.263, 1.0237),
        (1e-2, 3.635, 6.296, 1.0189),
        (0.03, 3.680, 6.374, 1.0082),
        (0.05, 3.726, 6.454, 0.9974),
        (0.1, 3.850, 6.669, 0.9698),
    ] {
        let solution = Absorption::new(yan(), initial, 1.0).expect("a solution");
        let front = |days: f64| solution.position(0.5, days * DAY).expect("a front") * 100.0;
        assert!((front(5.0) - five).abs() < 1e-3, "{initial}: {}", front(5.0));
        assert!((front(15.0) - fifteen).abs() < 1e-3, "{initial}: {}", front(15.0));
        let found = solution.infiltrated(15.0 * DAY) * 100.0;
        assert!((found - water).abs() < 1e-4, "{initial}: {found}");
        assert!(solution.foot(DAY).is_none());
    }
}

/// All soils and states that the other tests go through.
fn each(mut check: impl FnMut(&str, &Absorption)) {
    let mut retentions = Vec::new();
    for n in [1.1, 1.2, 1.53, 2.0, 3.0] {
        retentions.extend([0.1, 1.0, 10.0].map(|alpha| Retention::VanGenuchten { alpha, n }));
    }
    retentions.extend([0.2, 1.0, 4.0].map(|lambda| Retention::BrooksCorey { alpha: 2.0, lambda }));
    for retention in retentions {
        for initial in [0.0, 1e-4, 1e-2, 0.1, 0.6] {
            for wall in [0.61, 0.9, 1.0 - 1e-9, 1.0] {
                let name = format!("{retention:?} from {initial} to {wall}");
                check(&name, &absorption(retention, initial, wall));
            }
        }
    }
}

/// `(F dF/dSe)` vanishes at both ends, so the integral of `lambda^2` over the water is twice the potential across.
#[test]
fn squares_of_places_add_up_to_the_potential() {
    each(|name, solution| {
        let square = |stretch: &Stretch| {
            let values = std::array::from_fn(|node| stretch.position[node].powi(2) * stretch.saturation[node]);
            solution.rule.total(&values)
        };
        let squares: f64 = solution.stretches.iter().map(square).sum();
        let potential: f64 = solution.stretches.iter().map(|stretch| solution.rule.total(&stretch.potential)).sum();
        let ratio = solution.soil.range() * squares / (2.0 * potential);
        assert!((ratio - 1.0).abs() < ERROR, "{name}: {ratio}");
    });
}

/// The balance of water between a place and infinity, from saturations and potentials of places alone.
#[test]
fn saturations_obey_the_balance_of_water() {
    each(|name, solution| {
        let (soil, half) = (&solution.soil, 0.5 * (solution.initial + solution.wall));
        let far = solution.position(half, 1.0).expect("half");
        let last = solution.foot(1.0).unwrap_or(10.0 * far);
        for share in [0.25, 0.5, 0.9] {
            let at = share * far;
            let step = 1e-4 * far;
            let potential = |at: f64| soil.potential(solution.saturation(at, 1.0));
            let slope = (potential(at - step) - potential(at + step)) / (2.0 * step);
            let flux = solution.flux(at, 1.0);
            assert!((slope / flux - 1.0).abs() < 1e-6, "{name} at {share}: {slope} against {flux}");
        }
        let steps = 1000;
        let width = last / f64::from(steps);
        let sum: f64 = (0..steps).map(|step| solution.saturation((f64::from(step) + 0.5) * width, 1.0)).sum();
        let stored = soil.range() * (sum * width - solution.initial * last);
        let entered = solution.infiltrated(1.0);
        assert!((stored / entered - 1.0).abs() < 2e-3, "{name}: {stored} stored, {entered} entered");
    });
}

/// Above air entry the identity of the squares has the potential of the saturated soil beside that of the rest.
#[test]
fn a_head_above_air_entry_keeps_soil_saturated() {
    let retentions =
        [Retention::BrooksCorey { alpha: 2.0, lambda: 0.7 }, Retention::VanGenuchten { alpha: 2.0, n: 1.6 }];
    for (retention, head) in retentions.into_iter().zip([0.0, 0.5]) {
        for initial in [0.0, 0.1] {
            let soil = Soil::new(retention, 0.05, 0.4, 1e-6).expect("a soil");
            let solution = Absorption::under_head(soil, initial, head).expect("a solution");
            let length = solution.saturated_length(1.0);
            let squares: f64 = solution
                .stretches
                .iter()
                .map(|stretch| {
                    let values = std::array::from_fn(|node| stretch.position[node].powi(2) * stretch.saturation[node]);
                    solution.rule.total(&values)
                })
                .sum();
            let potential = soil.potential(1.0) - soil.potential(initial) + 0.5 * 1e-6;
            let ratio = soil.range() * squares / (2.0 * potential);
            assert!((ratio - 1.0).abs() < ERROR, "{retention:?} from {initial}: {ratio}");
            // Through saturated soil water flows by Darcy's law.
            let flux = 0.5 * 1e-6 / length;
            assert!((solution.flux(0.5 * length, 1.0) / flux - 1.0).abs() < ERROR, "{retention:?}");
            assert_eq!(solution.saturation(0.999 * length, 1.0), 1.0);
            let beside = solution.saturation(1.001 * length, 1.0);
            assert!(beside < 1.0 && beside > 0.99, "{retention:?}: {beside}");
            assert!((solution.position(1.0, 1.0).expect("its end") / length - 1.0).abs() < ERROR);
        }
    }
}

#[test]
fn heads_below_air_entry_are_saturations() {
    let soil = yan();
    let (head, saturation) = (-0.3, soil.saturation(-0.3));
    let found = Absorption::under_head(soil, 1e-3, head).expect("a solution").sorptivity();
    let expected = Absorption::new(soil, 1e-3, saturation).expect("a solution").sorptivity();
    assert!((found / expected - 1.0).abs() < 1e-12);
}

#[test]
fn far_soils_settle_too() {
    for n in [1.02, 1.05, 5.0, 10.0] {
        for (initial, wall) in [(0.0, 1.0), (1e-8, 1.0), (0.3, 0.300_001), (0.999, 1.0)] {
            let solution = absorption(Retention::VanGenuchten { alpha: 1.0, n }, initial, wall);
            // Drier soil stands within rounding of the foot where n is near one.
            let wet = 0.03 * initial + 0.97 * wall;
            let place = solution.position(wet, 1.0).expect("a place");
            assert!((solution.saturation(place, 1.0) - wet).abs() < 1e-9, "{n} from {initial}");
        }
    }
}

#[test]
fn saturations_out_of_order_are_named() {
    let error = Absorption::new(yan(), 0.5, 0.4).expect_err("no such problem");
    assert_eq!(error.to_string(), "the saturation at the wall is 0.4, it must be above the initial one and at most 1");
    assert!(Absorption::new(yan(), -0.1, 1.0).is_err() && Absorption::new(yan(), 0.1, 1.1).is_err());
    let solution = Absorption::new(yan(), 0.1, 0.9).expect("a solution");
    assert_eq!((solution.position(0.1, DAY), solution.position(0.95, DAY)), (None, None));
    assert_eq!((solution.saturation(0.01, 0.0), solution.saturation(0.0, 0.0)), (0.1, 0.9));
    assert!((solution.saturation(10.0, DAY) - 0.1).abs() < 1e-12);
}
