//! A retention curve given by points.

use std::ops::Bound;
use std::sync::Arc;

use super::shape::{InScenes, RetentionCurve};
use crate::physics::freezing_curve::shape::{Given, Parameter, Quantity, Refusal};

/// Points of the effective saturation and the relative conductivity by suction. Between them the saturation is linear and the
/// conductivity geometric in the suction; beyond the last nothing drains and nothing is conducted.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Suction (m), effective saturation, relative conductivity, from 0, 1, 1 on.
    points: Arc<[(f64, f64, f64)]>,
}

impl Table {
    /// The suction (m) at which nothing more drains.
    pub fn driest(&self) -> f64 {
        self.points[self.points.len() - 1].0
    }

    /// The two points around a suction; none beyond the last.
    fn around(&self, suction: f64) -> Option<[(f64, f64, f64); 2]> {
        let k = self.points.partition_point(|point| point.0 <= suction).max(1);
        Some([self.points[k - 1], *self.points.get(k)?])
    }
}

const fn list(name: &'static str, unit: &'static str, low: f64, high: f64) -> Parameter {
    let range = (Bound::Included(low), Bound::Included(high));
    Parameter { name, quantity: Quantity::Numbers { unit, range } }
}

impl InScenes for Table {
    const WORD: &'static str = "table";
    const PARAMETERS: &'static [Parameter] = &[
        list("suctions", "m", 0.0, 1e9),
        list("saturations", "", 0.0, 1.0),
        list("relative_conductivities", "", 0.0, 1.0),
    ];

    fn new(given: &Given) -> Result<Self, Refusal> {
        let [suctions, saturations, conductivities] = [&given.values[0], &given.values[1], &given.values[2]];
        let refuse = |parameter, value, message| Err(Refusal { parameter, value, message });
        if suctions.len() < 2 {
            return refuse(0, None, format!("found {} suctions, must be at least 2", suctions.len()));
        }
        for (parameter, list) in [(1, saturations), (2, conductivities)] {
            if list.len() != suctions.len() {
                let (found, wanted) = (list.len(), suctions.len());
                return refuse(parameter, None, format!("found {found} values for {wanted} suctions, must be as many"));
            }
            if list[0] != 1.0 {
                return refuse(
                    parameter,
                    Some(0),
                    format!("found {}, must begin with 1: ground is saturated", list[0]),
                );
            }
        }
        if suctions[0] != 0.0 {
            return refuse(0, Some(0), format!("found {}, must begin with 0: ground is saturated", suctions[0]));
        }
        for k in 1..suctions.len() {
            let after = |values: &[f64]| format!("found {} after {}", values[k], values[k - 1]);
            if suctions[k] <= suctions[k - 1] {
                return refuse(0, Some(k), format!("{}, must increase strictly", after(suctions)));
            }
            if saturations[k] >= saturations[k - 1] {
                return refuse(1, Some(k), format!("{}, must decrease strictly with the suction", after(saturations)));
            }
            if conductivities[k] > conductivities[k - 1] || conductivities[k] <= 0.0 {
                let message = format!("{}, must not increase with the suction, and be above 0", after(conductivities));
                return refuse(2, Some(k), message);
            }
        }
        let last = suctions.len() - 1;
        if saturations[last] != 0.0 {
            let message = format!("found {}, must end with 0, at the residual water content", saturations[last]);
            return refuse(1, Some(last), message);
        }
        let points = suctions.iter().zip(saturations).zip(conductivities);
        Ok(Table { points: points.map(|((suction, se), kr)| (*suction, *se, *kr)).collect() })
    }
}

impl RetentionCurve for Table {
    fn saturation(&self, suction: f64) -> f64 {
        1.0 - self.deficit(suction)
    }

    fn deficit(&self, suction: f64) -> f64 {
        let Some([a, b]) = self.around(suction) else { return 1.0 };
        (1.0 - a.1) + (a.1 - b.1) * (suction - a.0) / (b.0 - a.0)
    }

    fn suction(&self, deficit: f64) -> f64 {
        let k = self.points.partition_point(|point| 1.0 - point.1 < deficit).max(1);
        let Some(b) = self.points.get(k) else { return f64::INFINITY };
        let a = self.points[k - 1];
        a.0 + (deficit - (1.0 - a.1)) / (a.1 - b.1) * (b.0 - a.0)
    }

    fn release(&self, suction: f64) -> f64 {
        self.around(suction).map_or(0.0, |[a, b]| (a.1 - b.1) / (b.0 - a.0))
    }

    fn relative_conductivity(&self, suction: f64) -> f64 {
        let Some([a, b]) = self.around(suction) else { return 0.0 };
        let share = (suction - a.0) / (b.0 - a.0);
        libm::exp(libm::log(a.2) + share * libm::log(b.2 / a.2))
    }

    fn bends(&self) -> Vec<f64> {
        self.points[1..].iter().map(|point| point.0).collect()
    }
}
