//! Steps by error to the end of a run, from those of a trial.

/// Steps of a trial that tell how the others will be.
pub(super) const FEWEST: usize = 16;

/// Parts in which the rest of a run is summed, each so many times as long as the one before as all are alike.
const PARTS: u32 = 512;

/// The greatest power of time by which steps are taken to grow.
const STEEPEST: f64 = 0.95;

/// How far, as a factor, the last steps of a run may be off that grow by a greater one.
const MOST_OFF: f64 = 2.0;

/// How steps are bounded, and what they cost.
pub(super) struct Lengths<'a> {
    /// The longest (s).
    pub(super) longest: f64,
    /// Evaluations of a step by its length (s).
    pub(super) evaluations: &'a dyn Fn(f64) -> f64,
}

/// The steps of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Course {
    /// How many.
    pub(super) steps: u64,
    /// Evaluations of a step, mean over the run over mean over the trial.
    pub(super) dearer: f64,
}

impl Lengths<'_> {
    /// Steps to the end of a run of `duration` (s) whose first steps ended at `times` (s), if their lengths follow a power
    /// of time, as steps of a given error do after a jump at the start.
    pub(super) fn course(&self, times: &[f64], duration: f64) -> Option<Course> {
        if times.len() < FEWEST {
            return None;
        }
        if let Some(end) = times.iter().position(|time| *time >= duration) {
            return Some(Course { steps: end as u64 + 1, dearer: 1.0 });
        }
        let starts = std::iter::once(0.0).chain(times.iter().copied());
        let tried: f64 = starts.zip(times).map(|(from, to)| (self.evaluations)(to - from)).sum();
        // The later half: the first steps know the jump only.
        let late = &times[times.len() / 2..];
        let points: Vec<(f64, f64)> =
            late.windows(2).map(|pair| ((0.5 * (pair[0] + pair[1])).ln(), (pair[1] - pair[0]).ln())).collect();
        let count = points.len() as f64;
        let mean = points.iter().fold((0.0, 0.0), |sum, point| (sum.0 + point.0 / count, sum.1 + point.1 / count));
        let spread: f64 = points.iter().map(|point| (point.0 - mean.0).powi(2)).sum();
        let slope = points.iter().map(|point| (point.0 - mean.0) * (point.1 - mean.1)).sum::<f64>() / spread;
        let first = *times.last()?;
        // Steps that shrink away follow no such law, nor do those that grow as fast as time itself; but where little is left of the
        // run, as on a fast machine, it matters little how fast they grow.
        if !(-1.0..f64::INFINITY).contains(&slope) || (duration / first).powf(slope - STEEPEST) > MOST_OFF {
            return None;
        }
        // Others are even, whatever it is that makes them differ.
        let slope = slope.clamp(0.0, STEEPEST);
        let scale = (mean.1 - slope * mean.0).exp();
        let growth = (duration / first).powf(1.0 / f64::from(PARTS));
        let (mut steps, mut evaluations, mut from) = (times.len() as f64, tried, first);
        for _ in 0..PARTS {
            let to = from * growth;
            // Many short steps, or the share of a long one.
            let law = (to.powf(1.0 - slope) - from.powf(1.0 - slope)) / (scale * (1.0 - slope));
            let made = law.max((to - from) / self.longest);
            steps += made;
            evaluations += made * (self.evaluations)((to - from) / made);
            from = to;
        }
        let dearer = evaluations / steps / (tried / times.len() as f64);
        // Sums of the parts are a whole number to rounding where steps are even.
        Some(Course { steps: (steps * (1.0 - 1e-9)).ceil() as u64, dearer })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANY: Lengths<'_> = Lengths { longest: f64::INFINITY, evaluations: &|_| 1.0 };

    fn steps(times: &[f64], duration: f64) -> Option<u64> {
        ANY.course(times, duration).map(|course| course.steps)
    }

    /// Steps of a given error after a jump: their ends are at `(k / scale)^(1 / (1 - slope))`.
    #[test]
    fn steps_that_grow_with_a_power_of_time_are_counted_from_their_start() {
        for (slope, duration) in [(0.0, 1e4), (0.5, 1e5), (0.75, 1e6)] {
            let end = |k: u64| (k as f64).powf(1.0 / (1.0 - slope));
            let all = (1..).find(|k| end(*k) >= duration).expect("an end");
            let times: Vec<f64> = (1..=40).map(end).collect();
            let found = steps(&times, duration).expect("a law") as f64;
            // A power between two ends is not quite that of the middle.
            assert!((found / all as f64 - 1.0).abs() < 0.02, "{slope}: {found} of {all}");
        }
        let even = |count: u64| (1..=count).map(|k| k as f64).collect::<Vec<_>>();
        assert_eq!(steps(&even(100), 60.0), Some(60));
        assert_eq!(steps(&even(5), 60.0), None);
        assert_eq!(steps(&even(40), 1000.0), Some(1000));
        let doubling: Vec<f64> = (0..40).map(|k| 2f64.powi(k)).collect();
        assert_eq!(steps(&doubling, 1e30), None);
        // As fast as time, but not for long: a factor of three takes so many steps more.
        let growing: Vec<f64> = (1..=100).map(|k| 1.05f64.powi(k)).collect();
        let found = steps(&growing, 3.0 * 1.05f64.powi(100)).expect("little is left") as f64 - 100.0;
        let all = 3.0f64.ln() / 1.05f64.ln();
        // By that much the power of 0.95 is off, from the middle of the later half on.
        let off = (3.0 * 1.05f64.powi(25)).powf(1.0 - STEEPEST) - 1.0;
        assert!((found / all - 1.0).abs() < off, "{found} of {all}");
        let shrinking: Vec<f64> = (1..40).map(|k| 1.0 - 0.5f64.powi(k)).collect();
        assert_eq!(steps(&shrinking, 2.0), None);
    }

    /// Longer steps have more stages, up to the longest.
    #[test]
    fn long_runs_are_made_of_the_longest_steps() {
        let lengths = Lengths { longest: 10.0, evaluations: &|step| 1.0 + step };
        // Steps grow with the root of time: k^2 / 4 after k, which is the longest at a time of 100.
        let times: Vec<f64> = (1..=16).map(|k| f64::from(k * k) / 4.0).collect();
        let course = lengths.course(&times, 1e6).expect("a law");
        // 20 steps to 100, then all the longest.
        let expected = 20.0 + (1e6 - 100.0) / 10.0;
        assert!((course.steps as f64 / expected - 1.0).abs() < 1e-3, "{course:?}, {expected}");
        // Eleven evaluations each, over one more than the mean length of the trial.
        assert!((course.dearer / (11.0 / (1.0 + 64.0 / 16.0)) - 1.0).abs() < 1e-3, "{course:?}");
    }
}
