//! Few numbers with noise: what may be said about them.

pub mod order;

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

/// How far the ratio of two medians of run times strays from one between identical programs (95 %), for times of
/// the given coefficient of variation and number of repeats. A speed-up closer to one than this is none.
pub fn noise_floor(variation: f64, repeats: usize) -> f64 {
    use std::f64::consts::PI;
    // Standard error of the median of few normal numbers over their deviation: exact for one, asymptotic for many.
    let median_error = (PI / (2.0 * repeats.max(1) as f64 + PI - 2.0)).sqrt();
    (1.96 * std::f64::consts::SQRT_2 * median_error * variation).exp_m1()
}

#[cfg(test)]
mod tests;
