//! Points of error and cost of one method under one setting, and which of them count.

use frazil_core::statistics::{self, Interval};
use rand::{Rng, RngExt};

use super::measured::{Measured, Status, Timing};
use super::variant::Variant;
use crate::ensemble::runs::Headline;

/// Errors below this multiple of the reference's own do not count: they are bounds.
pub const REFERENCE_MARGIN: f64 = 10.0;
/// Factor within which two norms must go together.
const NORMS_AGREE: f64 = 3.0;

/// Which clock tells the cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// Wall time.
    Wall,
    /// CPU time of the process.
    Cpu,
}

/// Where an error comes from, so that it can be drawn again with its chance.
#[derive(Debug, Clone, PartialEq)]
pub enum Chance {
    /// It has none.
    Fixed,
    /// It is the mean of the errors of single runs.
    Runs(Vec<f64>),
    /// It is the rms over points of the mean of runs: errors by run and point.
    Mean(Vec<Vec<f64>>),
}

/// Error and cost at one resolution.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Number of the resolution.
    pub level: usize,
    /// Particle spacing (m).
    pub spacing: f64,
    /// Error with its sign; absent if the run failed.
    pub signed: Option<f64>,
    /// A second norm of the error.
    pub second: Option<f64>,
    /// Interval of the error.
    pub error_interval: Option<Interval>,
    /// What the error owes to chance.
    pub chance: Chance,
    /// Costs of the repeated runs (s).
    pub costs: Vec<f64>,
    /// Particles updated in all.
    pub updates: Option<f64>,
    /// What became of the run.
    pub status: Status,
    /// Below ten times the error of the reference.
    pub hollow: bool,
    /// Perhaps low by chance.
    pub ringed: bool,
    /// What the true error does not exceed, as far as the reference, finer runs and the other norm tell; absent where
    /// nothing tells.
    pub at_most: Option<f64>,
    /// On the lower left envelope.
    pub on_front: bool,
}

impl Point {
    /// Size of the error.
    pub fn error(&self) -> Option<f64> {
        self.signed.map(f64::abs)
    }

    /// Median cost (s).
    pub fn cost(&self) -> Option<f64> {
        statistics::median(&self.costs)
    }

    /// Whether the point may be read off.
    pub fn counts(&self) -> bool {
        !self.hollow
            && !self.ringed
            && self.error().is_some_and(|error| error > 0.0)
            && self.cost().is_some_and(|c| c > 0.0)
    }

    /// The point as it might have come out: repeated runs and seeds drawn again.
    fn redraw(&self, random: &mut impl Rng) -> Option<(f64, f64)> {
        let costs: Vec<f64> = self.costs.iter().map(|_| self.costs[random.random_range(0..self.costs.len())]).collect();
        let error = match &self.chance {
            Chance::Fixed => self.error()?,
            Chance::Runs(runs) => {
                runs.iter().map(|_| runs[random.random_range(0..runs.len())]).sum::<f64>() / runs.len() as f64
            }
            Chance::Mean(runs) => {
                let drawn: Vec<&Vec<f64>> = runs.iter().map(|_| &runs[random.random_range(0..runs.len())]).collect();
                rms_of_mean(&drawn)?
            }
        };
        (error > 0.0).then_some((error, statistics::median(&costs)?))
    }
}

/// Rms over the points of the mean over the runs.
pub fn rms_of_mean(runs: &[&Vec<f64>]) -> Option<f64> {
    let points = runs.first()?.len();
    let mean = |k: usize| runs.iter().filter_map(|run| run.get(k)).sum::<f64>() / runs.len() as f64;
    (points > 0).then(|| ((0..points).map(|k| mean(k) * mean(k)).sum::<f64>() / points as f64).sqrt())
}

/// What a curve of a stochastic method shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A run without chance.
    Plain,
    /// The error that one run has.
    Single,
    /// The error of the mean of this many runs, at the cost of all.
    MeanOf(usize),
}

/// One method under one setting, from coarse to fine.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Method.
    pub method: &'static str,
    /// Setting.
    pub setting: Variant,
    /// What its errors are.
    pub kind: Kind,
    /// Points.
    pub points: Vec<Point>,
}

impl Curve {
    /// The curves of a method under a setting: one, or for ensembles two.
    pub fn of(measured: &[&Measured], headline: Headline, clock: Clock, reference_error: Option<f64>) -> Vec<Curve> {
        let Some(first) = measured.first() else {
            return Vec::new();
        };
        let seeds = measured.iter().filter_map(|one| one.ensemble.as_ref().map(|all| all.runs.len())).max();
        let kinds = match seeds {
            None => vec![Kind::Plain],
            Some(count) => vec![Kind::MeanOf(count), Kind::Single],
        };
        kinds
            .into_iter()
            .map(|kind| {
                let points = measured.iter().map(|one| point(one, headline, clock, kind)).collect();
                let mut curve = Curve { method: first.method, setting: first.setting.clone(), kind, points };
                curve.judge(reference_error);
                curve
            })
            .collect()
    }

    /// Words of the legend.
    pub fn label(&self) -> String {
        let method = frazil_plots::style::method_title(self.method);
        let setting = &self.setting.name;
        match self.kind {
            Kind::Plain => format!("{method} {setting}"),
            Kind::Single => format!("{method} {setting}, single run"),
            Kind::MeanOf(count) => format!("{method} {setting}, mean of {count} runs"),
        }
    }

    /// Marks the points that do not count and the envelope of those that do.
    pub fn judge(&mut self, reference_error: Option<f64>) {
        let unlucky = without_luck(&self.points);
        for (point, unlucky) in self.points.iter_mut().zip(unlucky) {
            let by_chance = matches!(&point.chance, Chance::Runs(runs) if runs.len() == 1);
            point.ringed = unlucky.is_some() || by_chance;
            point.hollow = reference_error
                .zip(point.error())
                .is_some_and(|(reference, error)| error < REFERENCE_MARGIN * reference);
            let own = if point.hollow { reference_error.unwrap_or(0.0) } else { 0.0 };
            // A single seed bounds nothing.
            point.at_most = unlucky.or(point.error()).filter(|_| !by_chance).map(|error| error + own);
        }
        let spots: Vec<Option<(f64, f64)>> =
            self.points.iter().map(|p| if p.counts() { p.error().zip(p.cost()) } else { None }).collect();
        for (point, spot) in self.points.iter_mut().zip(&spots) {
            point.on_front = spot.is_some_and(|(error, cost)| {
                !spots.iter().flatten().any(|(e, c)| *e <= error && *c <= cost && (*e < error || *c < cost))
            });
        }
    }

    /// Error and cost along the envelope.
    pub fn front(&self) -> Vec<(f64, f64)> {
        self.points.iter().filter(|point| point.on_front).filter_map(|point| point.error().zip(point.cost())).collect()
    }

    /// The envelope as it might have come out.
    pub fn redraw(&self, random: &mut impl Rng) -> Vec<(f64, f64)> {
        self.points.iter().filter(|point| point.on_front).filter_map(|point| point.redraw(random)).collect()
    }

    /// Least number of timed runs of a point on the envelope.
    pub fn repeats(&self) -> usize {
        self.points.iter().filter(|point| point.on_front).map(|point| point.costs.len()).min().unwrap_or(0)
    }
}

/// The errors that points would have without luck, for those that may be low by it: a finer one is worse, or two norms do
/// it is far lower than the other norm makes expect.
///
/// Norms are made relative to different things, so what must agree is their ratio with that of the other points. One that is
/// higher than expected is no luck.
fn without_luck(points: &[Point]) -> Vec<Option<f64>> {
    let ratio = |point: &Point| Some(point.error()? / point.second.filter(|second| *second > 0.0)?);
    let ratios: Vec<f64> = points.iter().filter_map(ratio).collect();
    let usual = if ratios.len() > 2 { statistics::median(&ratios) } else { None };
    let one = |(k, point): (usize, &Point)| {
        let error = point.error()?;
        let finer = points[k + 1..].iter().find_map(Point::error).filter(|finer| *finer > error);
        let too_low = |(own, usual): &(f64, f64)| *usual > NORMS_AGREE * own;
        let by_norm =
            ratio(point).zip(usual).filter(too_low).zip(point.second).map(|((_, usual), second)| usual * second);
        let exact = (error == 0.0).then_some(0.0);
        [finer, by_norm, exact].into_iter().flatten().reduce(f64::max).map(|other| other.max(error))
    };
    points.iter().enumerate().map(one).collect()
}

fn point(one: &Measured, headline: Headline, clock: Clock, kind: Kind) -> Point {
    let times = |timing: &Timing| match clock {
        Clock::Wall => timing.wall(),
        Clock::Cpu => timing.cpu(),
    };
    let usable = if one.is_ok() { one.result.as_ref() } else { None };
    let mut point = Point {
        level: one.level,
        spacing: one.spacing,
        signed: usable.and_then(|result| headline.signed(&result.record.errors)),
        second: usable.and_then(|result| headline.second_of(&result.record.errors)).map(f64::abs),
        error_interval: None,
        chance: Chance::Fixed,
        costs: one.timings.iter().map(times).collect(),
        updates: one.result.as_ref().map(|result| result.record.particle_updates as f64),
        status: one.status(),
        hollow: false,
        ringed: false,
        at_most: None,
        on_front: false,
    };
    if point.costs.is_empty() {
        // A run that failed is drawn at the time that it took.
        point.costs.extend(one.result.as_ref().map(|result| times(&Timing::of(&result.record))));
    }
    if let (Some(ensemble), true) = (&one.ensemble, usable.is_some()) {
        match kind {
            Kind::Plain => {}
            Kind::Single => {
                let errors: Vec<f64> = ensemble.runs.iter().filter_map(|run| Some(headline.of(run)?.abs())).collect();
                // Times of events are skewed: their interval is taken in logarithms.
                let mean = match headline {
                    Headline::Closure => statistics::geometric_mean(&errors),
                    _ => statistics::mean(&errors),
                };
                point.signed = mean.map(|mean| mean.mean);
                point.error_interval = mean.and_then(|mean| mean.interval).map(positive);
                let seconds: Vec<f64> =
                    ensemble.runs.iter().filter_map(|run| Some(headline.second_of(run)?.abs())).collect();
                point.second = statistics::mean(&seconds).map(|mean| mean.mean);
                point.chance = Chance::Runs(errors);
            }
            Kind::MeanOf(_) => {
                let points = ensemble.points_of(headline);
                point.signed = headline.signed(&ensemble.mean);
                point.second = headline.second_of(&ensemble.mean).map(f64::abs);
                point.error_interval = jackknife(points);
                point.chance = Chance::Mean(points.to_vec());
                // The mean costs all its runs; their CPU time counts, as they may run side by side.
                let count = ensemble.runs.len() as f64;
                point.costs = one.timings.iter().map(|timing| count * timing.cpu()).collect();
                point.updates = point.updates.map(|updates| count * updates);
            }
        }
    } else if kind == Kind::Single {
        // One seed: an error, but by chance.
        point.chance = Chance::Runs(point.error().into_iter().collect());
    } else if kind != Kind::Plain {
        point.signed = None;
        point.costs.clear();
    }
    point
}

fn positive(interval: Interval) -> Interval {
    Interval { low: interval.low.max(0.0), high: interval.high }
}

/// Student t interval of the error of the mean, from the means without one run each.
fn jackknife(runs: &[Vec<f64>]) -> Option<Interval> {
    let count = runs.len();
    let whole = rms_of_mean(&runs.iter().collect::<Vec<_>>())?.ln();
    let pseudo: Option<Vec<f64>> = (0..count)
        .map(|out| {
            let rest: Vec<&Vec<f64>> = runs.iter().enumerate().filter(|(k, _)| *k != out).map(|(_, run)| run).collect();
            Some(count as f64 * whole - (count as f64 - 1.0) * rms_of_mean(&rest)?.ln())
        })
        .collect();
    let half = statistics::mean(&pseudo?)?.interval?.half_width();
    half.is_finite().then(|| Interval { low: (whole - half).exp(), high: (whole + half).exp() })
}

/// Points for tests: errors and costs from coarse to fine.
#[cfg(test)]
pub fn made_up(method: &'static str, rows: &[(f64, f64, f64)]) -> Curve {
    let points = rows
        .iter()
        .enumerate()
        .map(|(level, (spacing, signed, cost))| Point {
            level,
            spacing: *spacing,
            signed: Some(*signed),
            second: None,
            error_interval: None,
            chance: Chance::Fixed,
            costs: [0.99, 1.0, 1.0, 1.0, 1.0, 1.01, 1.02].map(|factor| factor * cost).to_vec(),
            updates: None,
            status: Status::Done,
            hollow: false,
            ringed: false,
            at_most: None,
            on_front: false,
        })
        .collect();
    let mut curve =
        Curve { method, setting: Variant::standard(frazil_scene::Setting::Best), kind: Kind::Plain, points };
    curve.judge(None);
    curve
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lucky_zero_crossing_does_not_count() {
        // |80 h^2 - 0.8 h| vanishes at h = 0.01 and is 0.0015 at h = 0.0075.
        let rows: Vec<_> =
            [0.04, 0.02, 0.01, 0.0075].iter().map(|h: &f64| (*h, 80.0 * h * h - 0.8 * h, h.powi(-3))).collect();
        let curve = made_up("pd", &rows);
        let ringed: Vec<bool> = curve.points.iter().map(|point| point.ringed).collect();
        assert_eq!(ringed, [false, false, true, false]);
        assert_eq!(curve.front().len(), 3);
        assert_eq!(curve.points[2].at_most, curve.points[3].error(), "the finer run tells what it is worth");
    }

    #[test]
    fn norms_that_part_ring_a_point() {
        let mut curve = made_up("pd", &[(4.0, 0.08, 1.0), (2.0, 0.04, 8.0), (1.0, 0.002, 64.0), (0.5, 0.001, 512.0)]);
        for (point, second) in curve.points.iter_mut().zip([0.08, 0.04, 0.02, 0.001]) {
            point.second = Some(second);
        }
        curve.judge(None);
        assert_eq!(curve.points.iter().map(|point| point.ringed).collect::<Vec<_>>(), [false, false, true, false]);
        assert_eq!(curve.points[2].at_most, Some(0.02), "as the other norm leads to expect");
        // An error that is higher than the other norm makes expect is not low by chance.
        curve.points[0].signed = Some(0.8);
        curve.judge(None);
        assert!(!curve.points[0].ringed);
    }

    #[test]
    fn errors_near_that_of_the_reference_are_hollow_and_do_not_count() {
        let mut curve = made_up("sph", &[(2.0, 0.02, 1.0), (1.0, 0.005, 8.0)]);
        curve.judge(Some(0.001));
        assert_eq!(curve.points.iter().map(|point| point.hollow).collect::<Vec<_>>(), [false, true]);
        assert_eq!(curve.front(), [(0.02, 1.0)]);
        // What they bound is known as well as the reference is.
        assert_eq!(curve.points.iter().map(|point| point.at_most).collect::<Vec<_>>(), [Some(0.02), Some(0.006)]);
    }

    #[test]
    fn the_mean_of_runs_is_better_than_a_run() {
        let runs = vec![vec![0.02, 0.01], vec![-0.01, 0.03], vec![0.0, -0.02], vec![0.01, 0.01]];
        let interval = jackknife(&runs).map(|interval| (interval.low, interval.high));
        let mean = rms_of_mean(&runs.iter().collect::<Vec<_>>());
        assert!((mean.unwrap_or(0.0) - 0.00637).abs() < 1e-4, "{mean:?}");
        assert!(interval.is_some_and(|(low, high)| low < 0.00637 && high > 0.00637), "{interval:?}");
    }
}
