//! How far a run is, on standard error.

use std::io::{self, IsTerminal};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use frazil_record::shown;
use frazil_simulation::march::Progress;
use indicatif::{ProgressBar, ProgressStyle};

use crate::failure::{Failure, complain};

/// Lines that nobody watches come this far apart.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// A bar on a terminal, a line now and then elsewhere, or nothing.
pub enum Reporter {
    /// Nothing.
    Quiet,
    /// A bar.
    Bar(ProgressBar),
    /// A line now and then; the instant is that of the last one.
    Lines(Mutex<Instant>),
}

impl Reporter {
    /// What suits standard error.
    pub fn new(quiet: bool) -> Self {
        if quiet {
            return Reporter::Quiet;
        }
        let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}");
        match style {
            Ok(style) if io::stderr().is_terminal() => Reporter::Bar(ProgressBar::new(1000).with_style(style)),
            _ => Reporter::Lines(Mutex::new(Instant::now())),
        }
    }

    /// Shows where a run stands.
    pub fn show(&self, progress: &Progress) {
        self.at(done(progress), || describe(progress));
    }

    /// Shows the share that is done, 0 to 1, and words about it. Whoever is asked is not done yet: all of it is told by the
    /// end alone.
    pub fn at(&self, share: f64, words: impl FnOnce() -> String) {
        let permille = ((1000.0 * share) as u64).min(999);
        match self {
            Reporter::Quiet => {}
            Reporter::Bar(bar) => {
                bar.set_position(permille);
                bar.set_message(shown(&words()).into_owned());
            }
            Reporter::Lines(last) => {
                let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
                if last.elapsed() >= BETWEEN_LINES {
                    *last = Instant::now();
                    complain(&format!("{:3} %  {}", permille / 10, words()));
                }
            }
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Reporter::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

fn done(progress: &Progress) -> f64 {
    (progress.time_s / progress.duration_s).clamp(0.0, 1.0)
}

fn describe(progress: &Progress) -> String {
    let left = countdown(progress.elapsed_s, done(progress));
    format!("{} steps, {}{left}", progress.steps, clock(progress.elapsed_s))
}

/// Share of a task that must be done before the rest of it is told, unless a minute has gone.
const TELLS: f64 = 1e-3;

/// Time left (s) beyond which a number says nothing.
const ENDLESS: f64 = 30.0 * 86_400.0;

/// What is left of a task of which a share is done, as the end of a sentence: that of its beginning, carried on. Nothing where
/// it is too early to tell, or nothing is left to be counted.
pub fn countdown(elapsed_s: f64, share: f64) -> String {
    if elapsed_s < 1.0 || share <= 0.0 || share >= 1.0 || share < TELLS && elapsed_s < 60.0 {
        return String::new();
    }
    left(elapsed_s * (1.0 - share) / share)
}

/// What is left (s), as the end of a sentence.
pub fn left(seconds: f64) -> String {
    if seconds > ENDLESS {
        ", more than a month left at this rate: is this the intended scene?".into()
    } else {
        // It is not over before it is over.
        format!(", about {} left", clock(seconds.max(1.0)))
    }
}

/// Time (s) from which on a command says how long it takes before it starts.
pub const LONG: f64 = 600.0;

/// Says before a command starts that it takes long, if it does: `seconds` are what it will take, as far as that is known.
pub fn forewarn(what: &str, seconds: Option<f64>) {
    if let Some(warning) = seconds.and_then(|seconds| warning(what, seconds)) {
        complain(&warning);
    }
}

fn warning(what: &str, seconds: f64) -> Option<String> {
    let long = if seconds > ENDLESS { "more than a month".into() } else { format!("about {}", clock(seconds)) };
    let words = format!("{what}: this will take {long} on this machine; an interrupt (Ctrl-C) stops it");
    (seconds > LONG).then_some(words)
}

/// What would take longer than anyone waits for.
#[derive(Debug, thiserror::Error)]
#[error(
    "{what}: this would take {} on this machine, more than {} days; --yes starts it anyway; {shorter}",
    clock(*.seconds),
    ENDLESS / 86_400.0
)]
struct Endless {
    what: String,
    seconds: f64,
    shorter: String,
}

/// Refuses what takes longer than 30 days, with what would make it shorter.
///
/// # Errors
/// Where it takes so long.
pub fn bearable(what: &str, seconds: f64, shorter: String) -> Result<(), Failure> {
    if seconds <= ENDLESS {
        return Ok(());
    }
    Err(Failure::request(Endless { what: what.to_owned(), seconds, shorter }))
}

/// A year (s).
const YEAR: f64 = 365.25 * 86_400.0;

/// A span of time as people say it.
pub fn clock(seconds: f64) -> String {
    match seconds {
        s if s < 0.01 => format!("{:.2} ms", 1e3 * s),
        s if s < 0.1 => format!("{:.1} ms", 1e3 * s),
        s if s < 10.0 => format!("{s:.2} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 48.0 * 3600.0 => format!("{:.1} h", s / 3600.0),
        s if s < 1000.0 * 86_400.0 => format!("{:.0} days", s / 86_400.0),
        s if s < 1e6 * YEAR => format!("{:.0} years", s / YEAR),
        s => format!("{:.1e} years", s / YEAR),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_times_keep_their_digits() {
        let said = [0.004_25, 0.0412, 0.123, 9.5, 35.2].map(clock);
        assert_eq!(said, ["4.25 ms", "41.2 ms", "0.12 s", "9.50 s", "35 s"]);
    }

    #[test]
    fn the_time_left_follows_from_the_time_gone() {
        let progress = Progress { time_s: 25.0, duration_s: 100.0, steps: 7, elapsed_s: 20.0 };
        assert_eq!(describe(&progress), "7 steps, 20 s, about 60 s left");
        assert_eq!(describe(&Progress { elapsed_s: 0.5, ..progress }), "7 steps, 0.50 s");
    }

    #[test]
    fn a_countdown_is_neither_zero_before_the_end_nor_endless() {
        let words = |elapsed_s: f64, share: f64| countdown(elapsed_s, share);
        // The end of a study whose last piece is nearly done, and the first step of a run whose steps will grow.
        assert_eq!(words(5000.0, 1.0 - 1e-12), ", about 1.00 s left");
        assert_eq!(words(5000.0, 1.0), "");
        assert_eq!(words(2.0, 1e-12), "");
        for elapsed_s in [0.0, 1.0, 59.0, 61.0, 1e4, 1e7] {
            for share in [0.0, 1e-15, 1e-9, 1e-4, 1e-3, 0.1, 0.999, 1.0 - 1e-9, 1.0] {
                let said = words(elapsed_s, share);
                assert!(!said.contains(" 0.") && !said.contains("years"), "{elapsed_s} {share}: {said}");
            }
        }
        assert!(words(61.0, 1e-12).ends_with("is this the intended scene?"));
    }

    #[test]
    fn what_takes_long_is_said() {
        assert_eq!(warning("a run", 599.0), None);
        let said = warning("a run", 7200.0).expect("a warning");
        assert_eq!(said, "a run: this will take about 2.0 h on this machine; an interrupt (Ctrl-C) stops it");
        assert!(warning("a run", 1e12).is_some_and(|said| said.contains("more than a month")));
    }

    #[test]
    fn a_bar_is_full_at_the_end_alone() {
        let bar = ProgressBar::hidden();
        bar.set_length(1000);
        let reporter = Reporter::Bar(bar.clone());
        for share in [0.9996, 1.0, 1.2] {
            reporter.at(share, String::new);
            assert_eq!(bar.position(), 999);
        }
    }
}
