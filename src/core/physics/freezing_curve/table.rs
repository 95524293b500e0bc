//! A freezing curve given by points.

use std::sync::Arc;

use super::shape::{Given, InScenes, Parameter, Quantity, Refusal, UnfrozenFraction};
use crate::memory::shared;

/// Points of the unfrozen fraction, between which it is linear; above the first and below the last it keeps its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// From the freezing point down: kelvin above it (never positive), unfrozen fraction, and its integral from the freezing
    /// point (K).
    points: Arc<[(f64, f64, f64)]>,
}

impl Table {
    /// The two points around a temperature that is neither above the first nor below the last.
    fn around(&self, below: f64) -> [(f64, f64, f64); 2] {
        let k = self.points.partition_point(|point| point.0 > below).clamp(1, self.points.len() - 1);
        [self.points[k - 1], self.points[k]]
    }

    /// dS/dT (1/K) between two points.
    fn slope([high, low]: [(f64, f64, f64); 2]) -> f64 {
        (high.1 - low.1) / (high.0 - low.0)
    }
}

impl InScenes for Table {
    const WORD: &'static str = "table";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter { name: "temperatures", quantity: Quantity::Temperatures },
        Parameter { name: "unfrozen_fractions", quantity: Quantity::Fractions },
    ];

    fn new(given: &Given) -> Result<Self, Refusal> {
        let (temperatures, fractions) = (&given.values[0], &given.values[1]);
        let refuse = |parameter, value, message| Err(Refusal { parameter, value, message });
        if temperatures.len() < 2 {
            return refuse(0, None, format!("found {} temperatures, must be at least 2", temperatures.len()));
        }
        if fractions.len() != temperatures.len() {
            let (found, wanted) = (fractions.len(), temperatures.len());
            return refuse(1, None, format!("found {found} fractions for {wanted} temperatures, must be as many"));
        }
        for k in 1..temperatures.len() {
            let after = |values: &[f64]| format!("found {} after {}", values[k], values[k - 1]);
            if temperatures[k] <= temperatures[k - 1] {
                return refuse(0, Some(k), format!("{}, must increase strictly", after(temperatures)));
            }
            if fractions[k] < fractions[k - 1] {
                return refuse(
                    1,
                    Some(k),
                    format!("{}, must not decrease: what is warmer is less frozen", after(fractions)),
                );
            }
        }
        let last = temperatures.len() - 1;
        if temperatures[last] != given.freezing_point {
            let (found, wanted) = (temperatures[last], given.freezing_point);
            return refuse(0, Some(last), format!("found {found}, must end at the freezing point, {wanted}"));
        }
        if fractions[last] != 1.0 {
            return refuse(1, Some(last), format!("found {}, must end with 1, at the freezing point", fractions[last]));
        }
        if fractions[0] == 1.0 {
            return refuse(1, Some(0), "found 1, must begin with less than 1: something must freeze".into());
        }
        let mut points = vec![(0.0, 1.0, 0.0)];
        for k in (0..last).rev() {
            let above = points[last - 1 - k];
            let (below, unfrozen) = (temperatures[k] - given.freezing_point, fractions[k]);
            points.push((below, unfrozen, above.2 + 0.5 * (above.1 + unfrozen) * (below - above.0)));
        }
        Ok(Table { points: points.into() })
    }
}

impl UnfrozenFraction for Table {
    fn unfrozen(&self, below: f64) -> f64 {
        if below <= self.end() {
            return self.points[self.points.len() - 1].1;
        }
        let around = self.around(below);
        around[0].1 + (below - around[0].0) * Table::slope(around)
    }

    fn frozen(&self, below: f64) -> f64 {
        if below <= self.end() {
            return 1.0 - self.unfrozen(below);
        }
        let around = self.around(below);
        (1.0 - around[0].1) - (below - around[0].0) * Table::slope(around)
    }

    fn integral(&self, below: f64) -> f64 {
        let last = self.points[self.points.len() - 1];
        if below <= last.0 {
            return last.2 + last.1 * (below - last.0);
        }
        let around = self.around(below);
        let down = below - around[0].0;
        around[0].2 + (around[0].1 + 0.5 * Table::slope(around) * down) * down
    }

    fn release(&self, below: f64) -> f64 {
        if below > self.end() { Table::slope(self.around(below)) } else { 0.0 }
    }

    fn end(&self) -> f64 {
        self.points[self.points.len() - 1].0
    }

    fn pieces(&self) -> Vec<f64> {
        self.points[1..].iter().map(|point| point.0).collect()
    }

    fn heap_size(&self) -> usize {
        shared(&self.points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::freezing_curve::linear::Linear;

    fn table(rows: &[(f64, f64)]) -> Result<Table, Refusal> {
        let values = vec![rows.iter().map(|row| row.0).collect(), rows.iter().map(|row| row.1).collect()];
        Table::new(&Given { freezing_point: -0.5, absolute_zero: -273.15, values })
    }

    #[test]
    fn points_of_the_linear_curve_give_the_linear_curve() {
        let linear = Linear { width: 2.0 };
        for rows in [&[(-2.5, 0.0), (-0.5, 1.0)][..], &[(-2.5, 0.0), (-2.0, 0.25), (-1.0, 0.75), (-0.5, 1.0)]] {
            let table = table(rows).expect("a curve");
            assert_eq!(table.end(), linear.end());
            for k in 0..300 {
                let below = -0.01 * f64::from(k);
                let pairs = [
                    (table.unfrozen(below), linear.unfrozen(below)),
                    (table.frozen(below), linear.frozen(below)),
                    (table.integral(below), linear.integral(below)),
                    (table.release(below), linear.release(below)),
                ];
                // A few roundings of numbers up to 1.
                assert!(pairs.iter().all(|(own, other)| (own - other).abs() <= 1e-15), "{below}: {pairs:?}");
            }
        }
    }

    #[test]
    fn its_integral_and_its_slope_are_those_of_its_points() {
        let table = table(&[(-10.5, 0.05), (-3.5, 0.1), (-1.5, 0.1), (-0.5, 1.0)]).expect("a curve");
        for (below, unfrozen) in [(-0.5, 0.55), (-1.0, 0.1), (-2.0, 0.1), (-6.5, 0.075), (-20.0, 0.05)] {
            assert!((table.unfrozen(below) - unfrozen).abs() < 1e-15, "{below}");
        }
        // Trapezoids: 0.55, then 2 of 0.1, then 7 of 0.075, then 0.05.
        assert!((table.integral(-12.0) + 0.55 + 0.2 + 0.525 + 0.1).abs() < 1e-15);
        assert_eq!(table.release(-2.0), 0.0);
        assert!((table.release(-0.2) - 0.9).abs() < 1e-15);
    }

    #[test]
    fn what_is_no_curve_is_refused_with_its_place() {
        let refused = |rows: &[(f64, f64)]| table(rows).map_err(|refusal| (refusal.parameter, refusal.value)).err();
        assert_eq!(refused(&[(-2.0, 0.0), (-2.0, 0.5), (-0.5, 1.0)]), Some((0, Some(1))));
        assert_eq!(refused(&[(-3.0, 0.6), (-2.0, 0.5), (-0.5, 1.0)]), Some((1, Some(1))));
        assert_eq!(refused(&[(-3.0, 0.6), (-2.0, 1.0)]), Some((0, Some(1))));
        assert_eq!(refused(&[(-3.0, 0.6), (-0.5, 0.9)]), Some((1, Some(1))));
        assert_eq!(refused(&[(-3.0, 1.0), (-0.5, 1.0)]), Some((1, Some(0))));
    }
}
