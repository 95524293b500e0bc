//! What the runs say: times at equal error, errors at equal time, orders of convergence.

use std::collections::BTreeMap;

use frazil_core::statistics::order::Order;
use frazil_core::statistics::{self, Interval};
use rand::SeedableRng;

use super::curve::{Clock, Curve, Kind, Point};
use super::execute::SceneRuns;
use super::group::alike;
use super::measured::Measured;
use crate::ensemble::runs::Headline;

/// Errors at which times are compared.
pub const TARGETS: [f64; 6] = [0.05, 0.02, 0.01, 0.005, 0.002, 0.001];
/// Times at which errors are compared (s).
pub const TIMES: [f64; 6] = [0.01, 0.1, 1.0, 10.0, 100.0, 1000.0];
/// Draws of the resampling behind intervals of speed-ups.
const DRAWS: usize = 2000;
/// Wall over CPU time of one thread above which the machine was not quiet.
const QUIET: f64 = 1.05;

/// When a method reaches an error, or which error it reaches in a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reached {
    /// There, by interpolation between its points.
    At(f64),
    /// A run is beyond already, at this value: its true error is known to be no greater, but not by how much less.
    Within(f64),
    /// A run is beyond as it was measured, at this value, but neither the reference nor the other runs tell for sure.
    Untold(f64),
    /// Not by the runs that were made; finer ones were left out for lack of time.
    LeftOut,
    /// Not in the range that was run.
    Not,
}

/// A ratio of times with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedUp {
    /// Time of the baseline over that of the method.
    pub ratio: f64,
    /// Its 95 % interval, if there is any scatter to draw it from.
    pub interval: Option<Interval>,
    /// Whether it can be told from one.
    pub resolved: bool,
}

/// What one curve does at one error.
#[derive(Debug, Clone, PartialEq)]
pub struct AtError {
    /// The error.
    pub target: f64,
    /// Index of the curve.
    pub curve: usize,
    /// Time (s).
    pub time: Reached,
    /// What the true error of the run behind a time that is no interpolation does not exceed.
    pub error_at_most: Option<f64>,
    /// Interval of the time.
    pub interval: Option<Interval>,
    /// Against the baseline, where both reach the error.
    pub speed_up: Option<SpeedUp>,
}

/// All curves of a scene for one measure of error.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// The measure.
    pub headline: Headline,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Index of the curve against which speed-ups are taken.
    pub baseline: Option<usize>,
    /// Times at equal error, by error and curve.
    pub equal_error: Vec<AtError>,
    /// Errors at equal time: time, curve, error.
    pub equal_time: Vec<(f64, usize, Reached)>,
    /// Observed orders by curve.
    pub orders: Vec<Option<Order>>,
}

/// A scene with everything that is said about it.
pub struct Study {
    /// Its runs.
    pub runs: SceneRuns,
    /// Which clock counts.
    pub clock: Clock,
    /// Share of the points whose wall time was well above their CPU time.
    pub disturbed: f64,
    /// The comparison by the headline measure, then those by what is read at the points of profiles.
    pub comparisons: Vec<Comparison>,
}

impl Study {
    /// Studies the runs of a scene.
    pub fn of(runs: SceneRuns) -> Study {
        let (clock, disturbed) = clock(&runs.measured);
        let has = |headline: &Headline| {
            runs.measured.iter().filter_map(Measured::errors).any(|errors| headline.of(errors).is_some())
        };
        let known = Headline::ALL.into_iter().filter(has).enumerate();
        let comparisons = known
            .filter(|(place, headline)| *place == 0 || headline.is_of_profiles())
            .map(|(_, headline)| {
                let curves = group(&runs.measured)
                    .iter()
                    .flat_map(|same| Curve::of(same, headline, clock, runs.reference_error(headline)))
                    .collect();
                Comparison::of(headline, curves)
            })
            .collect();
        Study { runs, clock, disturbed, comparisons }
    }

    /// Name of the scene.
    pub fn name(&self) -> &str {
        &self.runs.scene.name
    }
}

/// Configurations of one method and setting, in the order in which they first occur, each from coarse to fine.
pub fn group(measured: &[Measured]) -> Vec<Vec<&Measured>> {
    alike(measured, |a, b| a.method == b.method && a.setting == b.setting)
}

/// CPU time counts for all, if too many wall times were disturbed.
fn clock(measured: &[Measured]) -> (Clock, f64) {
    let single = |one: &&Measured| one.result.as_ref().is_some_and(|result| result.record.threads == 1);
    let timed: Vec<bool> = measured
        .iter()
        .filter(single)
        .filter_map(|one| {
            let walls: Vec<f64> = one.timings.iter().map(|timing| timing.wall()).collect();
            let cpus: Vec<f64> = one.timings.iter().map(|timing| timing.cpu()).collect();
            let (wall, cpu) = (statistics::median(&walls)?, statistics::median(&cpus)?);
            (cpu > 0.0).then_some(wall / cpu > QUIET)
        })
        .collect();
    let disturbed = timed.iter().filter(|disturbed| **disturbed).count() as f64 / timed.len().max(1) as f64;
    (if disturbed > 0.2 { Clock::Cpu } else { Clock::Wall }, disturbed)
}

impl Comparison {
    /// Compares curves.
    pub fn of(headline: Headline, curves: Vec<Curve>) -> Comparison {
        let baseline = baseline(&curves);
        let drawn: Vec<Vec<Vec<(f64, f64)>>> = curves.iter().enumerate().map(|(k, curve)| draws(curve, k)).collect();
        let variation = variation(&curves);
        let mut equal_error = Vec::new();
        for target in TARGETS {
            for (k, curve) in curves.iter().enumerate() {
                let costs = |k: usize| -> Vec<Option<f64>> {
                    drawn[k].iter().map(|front| statistics::order::cost_at_error(front, target)).collect()
                };
                let (time, error_at_most) = time_at(curve, target);
                let interval = match time {
                    Reached::At(_) => spread(costs(k).into_iter()),
                    _ => None,
                };
                let speed_up = baseline.filter(|base| *base != k).and_then(|base| {
                    let (Reached::At(own), Reached::At(other)) = (time, time_at(&curves[base], target).0) else {
                        return None;
                    };
                    let ratio = other / own;
                    let ratios = costs(base).into_iter().zip(costs(k)).map(|(other, own)| Some(other? / own?));
                    let interval = spread(ratios);
                    let repeats = curve.repeats().min(curves[base].repeats()).max(1);
                    let floor = statistics::noise_floor(variation, repeats);
                    // Single timings have no interval; the floor then stands for what a machine may do.
                    let within = interval.is_some_and(|interval| interval.contains(1.0));
                    Some(SpeedUp { ratio, interval, resolved: !within && (ratio - 1.0).abs() > floor })
                });
                equal_error.push(AtError { target, curve: k, time, error_at_most, interval, speed_up });
            }
        }
        let equal_time = TIMES
            .iter()
            .flat_map(|time| curves.iter().enumerate().map(move |(k, curve)| (*time, k, error_in(curve, *time))))
            .collect();
        let orders = curves.iter().map(order).collect();
        Comparison { headline, curves, baseline, equal_error, equal_time, orders }
    }

    /// What one curve does at one error.
    pub fn at(&self, target: f64, curve: usize) -> Option<&AtError> {
        self.equal_error.iter().find(|entry| entry.target == target && entry.curve == curve)
    }
}

/// The local method with its best setting, or else the curve that is slowest at the easiest error it shares.
fn baseline(curves: &[Curve]) -> Option<usize> {
    let local = |curve: &Curve| curve.method == "local" && curve.setting.is_best() && !curve.front().is_empty();
    curves.iter().position(local).or_else(|| {
        TARGETS.iter().find_map(|target| {
            let times: Vec<(usize, f64)> = curves
                .iter()
                .enumerate()
                .filter_map(|(k, curve)| Some((k, statistics::order::cost_at_error(&curve.front(), *target)?)))
                .collect();
            if times.len() < 2 { None } else { times.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k) }
        })
    })
}

/// When a curve reaches an error, and what the true error of the run does not exceed that tells so.
pub fn time_at(curve: &Curve, target: f64) -> (Reached, Option<f64>) {
    let cheapest = |reaches: &dyn Fn(&Point) -> bool| {
        let runs = curve.points.iter().filter(|point| reaches(point)).filter_map(|point| Some((point.cost()?, point)));
        runs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(cost, point)| (cost, point.at_most))
    };
    let bounded = cheapest(&|point| point.at_most.is_some_and(|error| error <= target));
    match (statistics::order::cost_at_error(&curve.front(), target), bounded) {
        (Some(time), None) => (Reached::At(time), None),
        (Some(time), Some((cost, _))) if time <= cost => (Reached::At(time), None),
        (_, Some((cost, error))) => (Reached::Within(cost), error),
        (None, None) => match cheapest(&|point| point.error().is_some_and(|error| error <= target)) {
            Some((cost, error)) => (Reached::Untold(cost), error),
            None if curve.points.iter().any(|point| point.status.is_lack_of_time()) => (Reached::LeftOut, None),
            None => (Reached::Not, None),
        },
    }
}

/// Which error a curve reaches in a time.
pub fn error_in(curve: &Curve, time: f64) -> Reached {
    let in_time = curve.points.iter().filter(|point| point.cost().is_some_and(|cost| cost <= time));
    let bound = in_time.filter_map(|point| point.at_most).reduce(f64::min);
    match (statistics::order::error_at_cost(&curve.front(), time), bound) {
        (Some(error), bound) if bound.is_none_or(|bound| error <= bound) => Reached::At(error),
        (_, Some(bound)) => Reached::Within(bound),
        _ => Reached::Not,
    }
}

fn draws(curve: &Curve, stream: usize) -> Vec<Vec<(f64, f64)>> {
    // One fixed stream for each curve: the same runs give the same intervals.
    let mut random = rand::rngs::StdRng::seed_from_u64(1 + stream as u64);
    (0..DRAWS).map(|_| curve.redraw(&mut random)).collect()
}

/// Middle 95 % of draws; absent if most draws have no value or all are the same.
fn spread(values: impl Iterator<Item = Option<f64>>) -> Option<Interval> {
    let (mut count, mut present) = (0, Vec::new());
    for value in values {
        count += 1;
        present.extend(value.filter(|value| value.is_finite()));
    }
    if 2 * present.len() < count {
        return None;
    }
    let (low, high) = (statistics::quantile(&present, 0.025)?, statistics::quantile(&present, 0.975)?);
    (high > low).then_some(Interval { low, high })
}

/// Typical variation of repeated times: half the interquartile range as a standard deviation, over the median.
fn variation(curves: &[Curve]) -> f64 {
    const NORMAL: f64 = 1.349;
    let all: Vec<f64> = curves
        .iter()
        .flat_map(|curve| &curve.points)
        .filter(|point| point.costs.len() > 2)
        .filter_map(|point| statistics::quartiles(&point.costs))
        .map(|[low, middle, high]| (high - low) / NORMAL / middle)
        .collect();
    // Without repetitions nothing is known; one tenth is what a shared machine may do.
    statistics::median(&all).unwrap_or(0.1)
}

fn order(curve: &Curve) -> Option<Order> {
    let usable = curve.points.iter().filter(|point| !point.hollow);
    let (spacings, errors): (Vec<f64>, Vec<f64>) =
        usable.filter_map(|point| Some((point.spacing, point.signed?))).unzip();
    statistics::order::observed_order(&spacings, &errors)
}

/// How a method fares over several scenes at one error.
#[derive(Debug, Clone, PartialEq)]
pub struct Overall {
    /// Method and setting.
    pub label: String,
    /// The error.
    pub target: f64,
    /// Geometric mean of the speed-ups over the baseline, where both reach the error.
    pub mean: Option<f64>,
    /// Scenes in that mean.
    pub scenes: usize,
    /// Scenes where the method was the quickest to reach the error.
    pub wins: usize,
    /// Scenes where it did not reach the error, with no run left out.
    pub not_reached: usize,
    /// Scenes where it is not told: runs were left out, or the reference is not known well enough.
    pub not_told: usize,
}

/// Takes scenes together, by headline measure.
pub fn overall(studies: &[Study]) -> Vec<Overall> {
    // Ratios, and numbers of wins, of errors not reached, and of those not told.
    let mut rows: BTreeMap<(usize, String), (Vec<f64>, [usize; 3])> = BTreeMap::new();
    for comparison in studies.iter().filter_map(|study| study.comparisons.first()) {
        for (t, target) in TARGETS.iter().enumerate() {
            let entries: Vec<&AtError> =
                (0..comparison.curves.len()).filter_map(|k| comparison.at(*target, k)).collect();
            let time = |entry: &AtError| match entry.time {
                Reached::At(time) | Reached::Within(time) => Some(time),
                Reached::Untold(_) | Reached::LeftOut | Reached::Not => None,
            };
            let best = entries.iter().filter_map(|entry| time(entry)).fold(f64::INFINITY, f64::min);
            for entry in entries {
                let curve = &comparison.curves[entry.curve];
                if curve.kind == Kind::Single {
                    continue;
                }
                let method = frazil_plots::style::method_title(curve.method);
                let row = rows.entry((t, format!("{method} {}", curve.setting.name))).or_default();
                row.0.extend(entry.speed_up.map(|speed_up| speed_up.ratio));
                match (time(entry), entry.time) {
                    (Some(time), _) => row.1[0] += usize::from(time <= best),
                    (None, Reached::Not) => row.1[1] += 1,
                    (None, _) => row.1[2] += 1,
                }
            }
        }
    }
    rows.into_iter()
        .map(|((t, label), (ratios, [wins, not_reached, not_told]))| Overall {
            label,
            target: TARGETS[t],
            mean: statistics::geometric_mean(&ratios).map(|mean| mean.mean),
            scenes: ratios.len(),
            wins,
            not_reached,
            not_told,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::curve::made_up;
    use super::super::measured::Status;
    use super::*;

    /// Error = constant times spacing to the order, cost = constant over spacing cubed.
    fn sloped(method: &'static str, constant: f64, order: i32, cost: f64) -> Curve {
        let rows: Vec<_> =
            [4.0, 2.0, 1.0, 0.5].iter().map(|h: &f64| (*h, constant * h.powi(order), cost * h.powi(-3))).collect();
        made_up(method, &rows)
    }

    #[test]
    fn times_at_equal_error_follow_known_slopes() {
        // Second order against first: error e is reached at h = sqrt(e / 0.01) and h = e / 0.01.
        let comparison =
            Comparison::of(Headline::Front, vec![sloped("local", 0.01, 1, 1.0), sloped("pd", 0.01, 2, 2.0)]);
        let local = comparison.at(0.02, 0).map(|entry| entry.time);
        assert!(matches!(local, Some(Reached::At(time)) if (time - 0.125).abs() < 1e-9), "{local:?}");
        let pd = comparison.at(0.02, 1);
        let expected = 2.0 * f64::sqrt(2.0).powi(-3);
        assert!(
            matches!(pd.map(|e| e.time), Some(Reached::At(time)) if (time / expected - 1.0).abs() < 1e-9),
            "{pd:?}"
        );
        let speed_up = pd.and_then(|entry| entry.speed_up).map(|s| (s.ratio, s.resolved, s.interval));
        let ratio = 0.125 / expected;
        assert!(
            speed_up.is_some_and(|(own, resolved, interval)| (own / ratio - 1.0).abs() < 1e-9
                && resolved
                && interval.is_some_and(|interval| interval.contains(ratio))),
            "{speed_up:?}"
        );
        let orders: Vec<f64> = comparison.orders.iter().flatten().map(|order| order.order).collect();
        assert!((orders[0] - 1.0).abs() < 1e-9 && (orders[1] - 2.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_outside_the_range_is_not_extrapolated() {
        let comparison =
            Comparison::of(Headline::Front, vec![sloped("local", 0.01, 1, 1.0), sloped("sph", 0.001, 1, 1.0)]);
        assert_eq!(comparison.at(0.001, 0).map(|entry| entry.time), Some(Reached::Not));
        let within = comparison.at(0.05, 1).map(|entry| entry.time);
        assert!(matches!(within, Some(Reached::Within(time)) if (time - 1.0 / 64.0).abs() < 1e-9), "{within:?}");
        assert_eq!(comparison.at(0.05, 1).and_then(|entry| entry.speed_up), None);
        assert_eq!(error_in(&comparison.curves[0], 1e-6), Reached::Not);
        assert!(matches!(error_in(&comparison.curves[0], 1e6), Reached::Within(error) if error == 0.005));
    }

    /// A run below what the reference resolves has reached every error down to that: each cell that a run reaches says so.
    #[test]
    fn what_the_reference_does_not_resolve_is_reached_at_most_in_a_time() {
        // As of the closure of a shaft: 29, 1.2, 0.3 and 0.05 % beside a table that is known to 0.2 %.
        let mut curve =
            made_up("local", &[(0.4, 0.29, 0.01), (0.2, 0.012, 0.05), (0.1, 0.003, 0.2), (0.05, 0.0005, 3.0)]);
        curve.judge(Some(0.002));
        let times: Vec<_> = TARGETS.iter().map(|target| time_at(&curve, *target)).collect();
        let within = |time: f64, error: f64| (Reached::Within(time), Some(error));
        assert_eq!(times[..4], [within(0.05, 0.014), within(0.05, 0.014), within(0.2, 0.005), within(0.2, 0.005)]);
        // 0.05 % was measured: 0.2 and 0.1 % are reached as far as the reference tells, which is 0.25 %.
        assert_eq!(times[4..], [(Reached::Untold(3.0), Some(0.0025)); 2]);
        assert_eq!(error_in(&curve, 1.0), Reached::Within(0.005));
        // Without a run below, there is nothing to say.
        let mut coarse = made_up("pd", &[(0.4, 0.3, 0.01), (0.2, 0.07, 0.05)]);
        coarse.judge(Some(0.002));
        assert_eq!(time_at(&coarse, 0.01), (Reached::Not, None));
        coarse.points[1].status = Status::LeftOut;
        assert_eq!(time_at(&coarse, 0.01), (Reached::LeftOut, None));
    }

    #[test]
    fn equal_programs_are_not_told_apart() {
        let comparison =
            Comparison::of(Headline::Front, vec![sloped("local", 0.01, 1, 1.0), sloped("sph", 0.01, 1, 1.002)]);
        let speed_up = comparison.at(0.02, 1).and_then(|entry| entry.speed_up);
        assert!(speed_up.is_some_and(|speed_up| !speed_up.resolved), "{speed_up:?}");
    }

    #[test]
    fn no_order_is_quoted_for_an_error_that_changes_its_sign() {
        let rows: Vec<_> = [0.04, 0.02, 0.01, 0.005].map(|h: f64| (h, 80.0 * h * h - 0.7 * h, 1.0 / h)).to_vec();
        assert_eq!(order(&made_up("pd", &rows)), None);
    }
}
