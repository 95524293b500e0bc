//! Few numbers with noise: what may be said about them.

/// Probability of every interval here.
const CONFIDENCE: f64 = 0.95;

/// A range between two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// The interval of the given half-width around a centre.
    pub fn around(centre: f64, half_width: f64) -> Self {
        Interval { low: centre - half_width, high: centre + half_width }
    }

    /// Whether a number lies inside, ends included.
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Half of the distance between the ends.
    pub fn half_width(&self) -> f64 {
        0.5 * (self.high - self.low)
    }
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// The number below which the given share of a sample lies, linear between its members.
pub fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let sorted = sorted(values);
    let last = sorted.len().checked_sub(1)?;
    let position = share.clamp(0.0, 1.0) * last as f64;
    let below = position.floor() as usize;
    let above = (below + 1).min(last);
    Some(sorted[below] + (sorted[above] - sorted[below]) * (position - below as f64))
}

/// Middle of a sample.
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// Lower quartile, median and upper quartile.
pub fn quartiles(values: &[f64]) -> Option<[f64; 3]> {
    Some([quantile(values, 0.25)?, median(values)?, quantile(values, 0.75)?])
}

/// Two members of a sample that enclose the median of what it was drawn from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MedianInterval {
    /// The two members.
    pub interval: Interval,
    /// Probability that they enclose it, whatever the distribution.
    pub coverage: f64,
}

impl MedianInterval {
    /// Whether it is a 95 % interval; with fewer than six members it is only their range.
    pub fn is_confident(&self) -> bool {
        self.coverage >= CONFIDENCE
    }
}

/// The narrowest symmetric pair of order statistics that encloses the median with 95 %, or the whole range where
/// none does (exact binomial coverage).
pub fn median_interval(values: &[f64]) -> Option<MedianInterval> {
    let sorted = sorted(values);
    let count = sorted.len();
    if count == 0 {
        return None;
    }
    // Logarithm of the chance that exactly `rank - 1` members lie below the median: the power of one half itself
    // would underflow for large samples.
    let mut logarithm = -(count as f64) * std::f64::consts::LN_2;
    let mut outside = 2.0 * logarithm.exp();
    let mut rank = 1;
    let mut coverage = 1.0 - outside;
    while 2 * (rank + 1) <= count {
        logarithm += ((count - rank + 1) as f64 / rank as f64).ln();
        outside += 2.0 * logarithm.exp();
        if 1.0 - outside < CONFIDENCE {
            break;
        }
        coverage = 1.0 - outside;
        rank += 1;
    }
    Some(MedianInterval {
        interval: Interval { low: sorted[rank - 1], high: sorted[count - rank] },
        coverage: coverage.max(0.0),
    })
}

/// Regularised incomplete beta function by its continued fraction (Press et al. 2007, section 6.4).
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, 1.0 - x);
    }
    let logarithm = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * x.ln() + b * libm::log1p(-x);
    let away_from_zero = |value: f64| if value.abs() < 1e-300 { 1e-300 } else { value };
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    for m in 1..1000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = fraction;
        for numerator in [even, odd] {
            d = 1.0 / away_from_zero(1.0 + numerator * d);
            c = away_from_zero(1.0 + numerator / c);
            fraction *= c * d;
        }
        if (fraction - before).abs() < 1e-15 * fraction.abs() {
            break;
        }
    }
    logarithm.exp() * fraction / a
}

/// The number that a Student t variable stays within, either side of zero, with 95 %; degrees of freedom need not
/// be whole. Absent below one tenth of a degree.
pub fn student_t(freedom: f64) -> Option<f64> {
    if freedom.is_nan() || freedom < 0.1 {
        return None;
    }
    // Chance of lying outside falls from one to zero.
    let outside = |t: f64| incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + t * t));
    let (mut low, mut high) = (0.0, 2.0);
    while outside(high) > 1.0 - CONFIDENCE {
        low = high;
        high *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if outside(middle) > 1.0 - CONFIDENCE {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

/// Mean, and sample variance (zero for a single member).
pub fn moments(values: &[f64]) -> Option<(f64, f64)> {
    if values.is_empty() {
        return None;
    }
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    Some((mean, if values.len() > 1 { squares / (count - 1.0) } else { 0.0 }))
}

/// Mean of a measure over seeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// Number of seeds.
    pub count: usize,
    /// Mean over the seeds.
    pub mean: f64,
    /// Sample variance over the seeds.
    pub variance: f64,
    /// Interval of the mean by Student's t; absent for a single seed.
    pub interval: Option<Interval>,
}

/// Mean of a measure over seeds with its Student t interval.
pub fn mean(values: &[f64]) -> Option<Mean> {
    let (mean, variance) = moments(values)?;
    let count = values.len();
    let half = if count > 1 { student_t(count as f64 - 1.0).map(|t| half_width(t, variance, count)) } else { None };
    Some(Mean { count, mean, variance, interval: half.map(|half| Interval::around(mean, half)) })
}

fn half_width(t: f64, variance: f64, count: usize) -> f64 {
    t * (variance / count as f64).sqrt()
}

/// Half widths of the Student t intervals of many means, with the quantile for each number of seeds found once.
#[derive(Debug, Clone, PartialEq)]
pub struct HalfWidths(Vec<Option<f64>>);

impl HalfWidths {
    /// For means over at most this many seeds.
    pub fn up_to(seeds: usize) -> Self {
        HalfWidths((0..=seeds).map(|count| if count > 1 { student_t(count as f64 - 1.0) } else { None }).collect())
    }

    /// That of a mean over `count` seeds of a sample variance; absent for a single seed.
    pub fn of(&self, variance: f64, count: usize) -> Option<f64> {
        self.0.get(count).copied().flatten().map(|t| half_width(t, variance, count))
    }
}

/// The same for a skewed positive measure: mean and interval of the logarithms, given back as numbers. The mean
/// is the geometric one; the variance stays that of the logarithms. Absent unless all are positive.
pub fn geometric_mean(values: &[f64]) -> Option<Mean> {
    if values.iter().any(|value| value.is_nan() || *value <= 0.0) {
        return None;
    }
    let logarithms: Vec<f64> = values.iter().map(|value| value.ln()).collect();
    let own = mean(&logarithms)?;
    let interval = own.interval.map(|ends| Interval { low: ends.low.exp(), high: ends.high.exp() });
    Some(Mean { mean: own.mean.exp(), interval, ..own })
}

/// What errors of several seeds say about one setting of a stochastic method. The three errors answer different
/// questions and are not to be mixed: how wrong one run is, how wrong the mean of these runs is, and how wrong
/// the mean of endlessly many would be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ensemble {
    /// Number of seeds.
    pub count: usize,
    /// Rms error of one run.
    pub run_rms: f64,
    /// Rms error of the mean of the runs.
    pub mean_rms: f64,
    /// Variance between runs, mean over the points.
    pub variance: f64,
    /// Unbiased estimate of the squared error that no number of runs removes; may be negative.
    pub bias_squared: f64,
}

impl Ensemble {
    /// Systematic error, if the runs are enough to see it.
    pub fn bias(&self) -> Option<f64> {
        (self.bias_squared > 0.0).then(|| self.bias_squared.sqrt())
    }

    /// Number of runs whose mean has the rms error `target`; absent if none has.
    pub fn runs_for(&self, target: f64) -> Option<f64> {
        let room = target * target - self.bias_squared.max(0.0);
        (room > 0.0).then(|| (self.variance / room).max(1.0))
    }
}

/// Errors by seed, each a row of as many points. Absent for fewer than two seeds or uneven rows.
pub fn ensemble(runs: &[Vec<f64>]) -> Option<Ensemble> {
    let count = runs.len();
    let points = runs.first()?.len();
    if count < 2 || points == 0 || runs.iter().any(|run| run.len() != points) {
        return None;
    }
    let (mut run_square, mut mean_square, mut variance) = (0.0, 0.0, 0.0);
    for point in 0..points {
        let errors: Vec<f64> = runs.iter().map(|run| run[point]).collect();
        let (mean, spread) = moments(&errors)?;
        run_square += errors.iter().map(|error| error * error).sum::<f64>() / count as f64;
        mean_square += mean * mean;
        variance += spread;
    }
    let points = points as f64;
    Some(Ensemble {
        count,
        run_rms: (run_square / points).sqrt(),
        mean_rms: (mean_square / points).sqrt(),
        variance: variance / points,
        bias_squared: (mean_square - variance / count as f64) / points,
    })
}

/// Difference of two means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Mean of the first less mean of the second.
    pub difference: f64,
    /// Its interval.
    pub interval: Interval,
    /// Degrees of freedom (Welch 1947).
    pub freedom: f64,
}

impl Difference {
    /// Whether zero is excluded.
    pub fn is_resolved(&self) -> bool {
        !self.interval.contains(0.0)
    }
}

/// Difference of the means of two samples of unequal variance. Absent for fewer than two members in either.
pub fn welch(first: &[f64], second: &[f64]) -> Option<Difference> {
    if first.len() < 2 || second.len() < 2 {
        return None;
    }
    let ((mean_1, variance_1), (mean_2, variance_2)) = (moments(first)?, moments(second)?);
    let (count_1, count_2) = (first.len() as f64, second.len() as f64);
    let (share_1, share_2) = (variance_1 / count_1, variance_2 / count_2);
    let square = share_1 + share_2;
    let difference = mean_1 - mean_2;
    if square == 0.0 {
        let freedom = count_1 + count_2 - 2.0;
        return Some(Difference { difference, interval: Interval::around(difference, 0.0), freedom });
    }
    let freedom = square * square / (share_1 * share_1 / (count_1 - 1.0) + share_2 * share_2 / (count_2 - 1.0));
    let half_width = student_t(freedom)? * square.sqrt();
    Some(Difference { difference, interval: Interval::around(difference, half_width), freedom })
}

/// What a count of failures says about the chance of failing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Failures over trials.
    pub share: f64,
    /// Interval of the chance (Wilson 1927).
    pub interval: Interval,
}

/// Share of failures among trials with its Wilson interval, which holds for few trials and for none that fail. Absent
/// without a trial.
pub fn wilson(failures: usize, trials: usize) -> Option<Share> {
    /// A normal variable stays within this many standard deviations with 95 %.
    const DEVIATIONS: f64 = 1.959_963_984_540_054;
    if trials == 0 || failures > trials {
        return None;
    }
    let (count, share) = (trials as f64, failures as f64 / trials as f64);
    let square = DEVIATIONS * DEVIATIONS;
    let centre = (share + square / (2.0 * count)) / (1.0 + square / count);
    let half_width =
        DEVIATIONS / (1.0 + square / count) * (share * (1.0 - share) / count + square / (4.0 * count * count)).sqrt();
    let ends = Interval::around(centre, half_width);
    // The ends of none and of all are zero and one but for rounding.
    let low = if failures == 0 { 0.0 } else { ends.low };
    let high = if failures == trials { 1.0 } else { ends.high };
    Some(Share { share, interval: Interval { low, high } })
}

/// Least-squares line through points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Slope.
    pub slope: f64,
    /// Value at zero.
    pub intercept: f64,
    /// Share of the variance that the line explains.
    pub r_squared: f64,
    /// Student t interval of the slope; absent for two points.
    pub slope_interval: Option<Interval>,
}

/// Least-squares line. Absent unless two points differ in x and all are finite.
pub fn line(x: &[f64], y: &[f64]) -> Option<Line> {
    let count = x.len();
    if count < 2 || count != y.len() || x.iter().chain(y).any(|value| !value.is_finite()) {
        return None;
    }
    let size = count as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / size, y.iter().sum::<f64>() / size);
    let products = |a: &[f64], mean_a: f64, b: &[f64], mean_b: f64| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum()
    };
    let (xx, xy, yy) = (products(x, mean_x, x, mean_x), products(x, mean_x, y, mean_y), products(y, mean_y, y, mean_y));
    if xx == 0.0 {
        return None;
    }
    let slope = xy / xx;
    let left = (yy - slope * xy).max(0.0);
    let r_squared = if yy > 0.0 { 1.0 - left / yy } else { 1.0 };
    let slope_interval = match count {
        2 => None,
        _ => student_t(size - 2.0).map(|t| Interval::around(slope, t * (left / (size - 2.0) / xx).sqrt())),
    };
    Some(Line { slope, intercept: mean_y - slope * mean_x, r_squared, slope_interval })
}

/// Least share of the variance that a straight line must explain for an order of convergence to be quoted.
const STRAIGHT: f64 = 0.98;

/// Observed order of convergence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Order {
    /// Power of the spacing that the error follows.
    pub order: f64,
    /// Share of the variance explained.
    pub r_squared: f64,
    /// Student t interval of the order.
    pub interval: Interval,
}

/// Observed order of signed errors over spacings by least squares in logarithms.
///
/// None if there are fewer than three points, if the error changes its sign or vanishes, or if the points do not
/// lie on a line (R2 below 0.98): then no order should be quoted.
pub fn observed_order(spacings: &[f64], errors: &[f64]) -> Option<Order> {
    let same_sign = errors.iter().all(|error| *error > 0.0) || errors.iter().all(|error| *error < 0.0);
    if spacings.len() < 3 || !same_sign || spacings.iter().any(|spacing| spacing.is_nan() || *spacing <= 0.0) {
        return None;
    }
    let logarithms = |values: &[f64]| values.iter().map(|value| value.abs().ln()).collect::<Vec<_>>();
    let fit = line(&logarithms(spacings), &logarithms(errors))?;
    let interval = fit.slope_interval?;
    (fit.r_squared >= STRAIGHT).then_some(Order { order: fit.slope, r_squared: fit.r_squared, interval })
}

/// Cost at which an error is reached on a front of (error, cost) points, linear in the logarithms of both between
/// neighbours. None outside the range of the front: nothing is extrapolated.
pub fn cost_at_error(front: &[(f64, f64)], target: f64) -> Option<f64> {
    interpolate_logarithms(front, target)
}

/// Error that is reached at a cost on a front of (error, cost) points, in the same way.
pub fn error_at_cost(front: &[(f64, f64)], cost: f64) -> Option<f64> {
    let turned: Vec<(f64, f64)> = front.iter().map(|&(error, cost)| (cost, error)).collect();
    interpolate_logarithms(&turned, cost)
}

fn interpolate_logarithms(points: &[(f64, f64)], at: f64) -> Option<f64> {
    let is_positive = |value: f64| value > 0.0 && value.is_finite();
    if !is_positive(at) || points.iter().any(|point| !is_positive(point.0) || !is_positive(point.1)) {
        return None;
    }
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let after = points.partition_point(|point| point.0 < at);
    let next = points.get(after)?;
    if next.0 == at {
        return Some(next.1);
    }
    let before = points.get(after.checked_sub(1)?)?;
    let share = (at / before.0).ln() / (next.0 / before.0).ln();
    Some((before.1.ln() + share * (next.1 / before.1).ln()).exp())
}

/// How far the ratio of two medians of run times strays from one between identical programs (95 %), for times of
/// the given coefficient of variation and number of repeats. A speed-up closer to one than this is none.
pub fn noise_floor(variation: f64, repeats: usize) -> f64 {
    use std::f64::consts::PI;
    // Standard error of the median of few normal numbers over their deviation: exact for one, asymptotic for many.
    let median_error = (PI / (2.0 * repeats.max(1) as f64 + PI - 2.0)).sqrt();
    (1.96 * std::f64::consts::SQRT_2 * median_error * variation).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_of_small_samples() {
        assert_eq!(quartiles(&[4.0, 1.0, 3.0, 2.0, 5.0]), Some([2.0, 3.0, 4.0]));
        assert_eq!(quartiles(&[1.0, 2.0]), Some([1.25, 1.5, 1.75]));
        assert_eq!(median(&[]), None);
    }

    #[test]
    fn the_interval_of_a_median_has_exact_coverage() {
        // Ranks and coverage from the binomial distribution.
        let rows = [(5, 1, 0.9375), (6, 1, 0.968_75), (9, 2, 0.960_937_5), (15, 4, 0.964_843_75), (1, 1, 0.0)];
        for (count, rank, coverage) in rows {
            let values: Vec<f64> = (1..=count).rev().map(f64::from).collect();
            let found = median_interval(&values).expect("members");
            assert!((found.coverage - coverage).abs() < 1e-12, "{count}: {found:?}");
            let expected = Interval { low: f64::from(rank), high: f64::from(count + 1 - rank) };
            assert_eq!(found.interval, expected, "{count}");
            assert_eq!(found.is_confident(), count >= 6);
        }
        // Many members: the normal approximation puts the ranks at n/2 -+ 0.98 sqrt(n).
        let values: Vec<f64> = (1..=10_000).map(f64::from).collect();
        let found = median_interval(&values).expect("members").interval;
        assert!((found.half_width() - 98.0).abs() < 2.0, "{found:?}");
    }

    #[test]
    fn student_t_matches_printed_tables() {
        // Three decimals are printed; for one and two degrees there are closed forms.
        let rows = [(3.0, 3.182), (4.0, 2.776), (5.0, 2.571), (9.0, 2.262), (14.0, 2.145), (29.0, 2.045), (1e6, 1.960)];
        for (freedom, printed) in rows {
            let own = student_t(freedom).expect("enough freedom");
            assert!((own - printed).abs() < 6e-4, "{freedom}: {own}");
        }
        let cauchy = (std::f64::consts::PI * 0.475).tan();
        assert!((student_t(1.0).expect("one") / cauchy - 1.0).abs() < 1e-10);
        let two = 0.95 * (2.0 / (1.0 - 0.95_f64 * 0.95)).sqrt();
        assert!((student_t(2.0).expect("two") / two - 1.0).abs() < 1e-10);
        assert_eq!(student_t(0.0), None);
    }

    #[test]
    fn the_mean_of_five_seeds() {
        let found = mean(&[1.0, 2.0, 3.0, 4.0, 5.0]).expect("seeds");
        assert_eq!((found.count, found.mean, found.variance), (5, 3.0, 2.5));
        // 2.776 sqrt(2.5/5).
        assert!((found.interval.expect("interval").half_width() - 1.963).abs() < 1e-3);
        assert_eq!(mean(&[1.0]).and_then(|found| found.interval), None);
        let widths = HalfWidths::up_to(5);
        let half = widths.of(2.5, 5).expect("five seeds");
        assert_eq!(found.interval, Some(Interval::around(3.0, half)));
        assert_eq!((widths.of(2.5, 1), widths.of(2.5, 6)), (None, None));
        let found = geometric_mean(&[1.0, 10.0, 100.0]).expect("positive");
        assert!((found.mean - 10.0).abs() < 1e-12);
        let ends = found.interval.expect("interval");
        assert!((ends.low * ends.high - 100.0).abs() < 1e-9, "symmetric in the logarithm");
        assert_eq!(geometric_mean(&[1.0, -1.0]), None);
    }

    #[test]
    fn the_estimate_of_the_bias_has_no_bias_of_its_own() {
        // Every sample of three from a fair coin of +-1 around a bias of one half: the mean of the estimates over
        // all of them must be a quarter exactly, whatever the noise.
        let (bias, mut sum) = (0.5, 0.0);
        let mut naive = 0.0;
        for bits in 0..8_u32 {
            let runs: Vec<Vec<f64>> =
                (0..3).map(|run| vec![bias + if bits >> run & 1 == 1 { 1.0 } else { -1.0 }]).collect();
            let found = ensemble(&runs).expect("three runs");
            sum += found.bias_squared / 8.0;
            naive += found.mean_rms * found.mean_rms / 8.0;
        }
        assert!((sum - bias * bias).abs() < 1e-14, "{sum}");
        assert!(naive > 2.0 * bias * bias, "the square of the mean is too large: {naive}");
        assert_eq!(ensemble(&[vec![1.0]]), None);
        assert_eq!(ensemble(&[vec![1.0], vec![]]), None);
    }

    #[test]
    fn runs_that_reach_a_target() {
        let found = Ensemble { count: 5, run_rms: 0.0, mean_rms: 0.0, variance: 4.0, bias_squared: 1.0 };
        assert_eq!(found.runs_for(2.0_f64.sqrt()).map(|runs| (runs * 1e9).round() / 1e9), Some(4.0));
        assert_eq!(found.runs_for(0.9), None);
        assert_eq!(found.bias(), Some(1.0));
        assert_eq!(Ensemble { bias_squared: -1.0, ..found }.bias(), None);
    }

    #[test]
    fn welch_agrees_with_its_closed_form_for_equal_samples() {
        let (first, second) = ([1.0, 2.0, 3.0], [2.0, 3.0, 4.0]);
        let found = welch(&first, &second).expect("enough");
        assert!((found.freedom - 4.0).abs() < 1e-12 && (found.difference + 1.0).abs() < 1e-15);
        // 2.776 sqrt(2/3).
        assert!((found.interval.half_width() - 2.2669).abs() < 1e-3);
        assert!(!found.is_resolved());
        assert!(welch(&[1.0, 1.0], &[2.0, 2.0]).is_some_and(|found| found.is_resolved()));
        assert_eq!(welch(&[1.0], &second), None);
    }

    #[test]
    fn few_failures_leave_much_open() {
        let found = |failures, trials| wilson(failures, trials).expect("trials").interval;
        // Without a failure the upper end is z^2 / (n + z^2).
        for (trials, upper) in [(5, 0.4345), (10, 0.2775), (20, 0.1611)] {
            let none = found(0, trials);
            assert!(none.low == 0.0 && (none.high - upper).abs() < 5e-5, "{trials}: {none:?}");
            let all = found(trials, trials);
            assert!(all.high == 1.0 && (all.low - (1.0 - upper)).abs() < 5e-5, "{trials}: {all:?}");
        }
        // Four digits as printed by Newcombe (1998, table I, method 3).
        for (failures, trials, low, high) in
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (1, 29, 0.0061, 0.1718)]
        {
            let some = found(failures, trials);
            assert!((some.low - low).abs() < 6e-5 && (some.high - high).abs() < 6e-5, "{failures}/{trials}: {some:?}");
        }
        assert_eq!(wilson(0, 0), None);
        assert_eq!(wilson(3, 2), None);
    }

    #[test]
    fn an_order_is_quoted_only_where_there_is_one() {
        let spacings = [0.08, 0.04, 0.02, 0.01];
        let errors = spacings.map(|h| -3.0 * h * h);
        let found = observed_order(&spacings, &errors).expect("clean second order");
        assert!((found.order - 2.0).abs() < 1e-12 && found.r_squared > 1.0 - 1e-12);
        assert!(found.interval.half_width() < 1e-6);
        assert_eq!(observed_order(&spacings, &[0.1, 0.05, -0.01, 0.02]), None, "changes sign");
        assert_eq!(observed_order(&spacings, &[0.1, 0.01, 0.05, 0.02]), None, "scatters");
        assert_eq!(observed_order(&spacings[..2], &errors[..2]), None, "two points always lie on a line");
        assert_eq!(observed_order(&spacings, &[0.1, 0.05, 0.0, 0.02]), None, "vanishes");
    }

    #[test]
    fn costs_are_read_along_a_line_of_equal_error() {
        let front = [(0.1, 1.0), (0.01, 100.0), (0.001, 1000.0)];
        let cost = |target: f64| cost_at_error(&front, target);
        assert!((cost(0.031_622_776_601_683_79).expect("inside") - 10.0).abs() < 1e-9);
        assert_eq!(cost(0.01), Some(100.0));
        assert_eq!((cost(0.2), cost(0.0005), cost(f64::NAN)), (None, None, None));
        assert!((error_at_cost(&front, 10.0).expect("inside") - 0.031_622_776_6).abs() < 1e-9);
        assert_eq!(cost_at_error(&[(0.1, 0.0)], 0.1), None);
    }

    #[test]
    fn the_noise_floor_matches_simulated_medians() {
        // Ratios of medians of seven, simulated: 0.75 %, 4.8 % and 13.5 % at these variations; the formula for
        // the error of a median is good to a few per cent for seven.
        for (variation, simulated) in [(0.006, 0.0075), (0.036, 0.048), (0.1, 0.135)] {
            let own = noise_floor(variation, 7);
            assert!((own / simulated - 1.0).abs() < 0.05, "{variation}: {own}");
        }
    }
}
