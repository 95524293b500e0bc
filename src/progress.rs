//! How far a run is, on standard error.

use std::io::{self, IsTerminal};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use frazil_core::march::Progress;
use indicatif::{ProgressBar, ProgressStyle};

use crate::failure::complain;

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

    /// Shows the share that is done, 0 to 1, and words about it.
    pub fn at(&self, share: f64, words: impl FnOnce() -> String) {
        match self {
            Reporter::Quiet => {}
            Reporter::Bar(bar) => {
                bar.set_position((1000.0 * share) as u64);
                bar.set_message(words());
            }
            Reporter::Lines(last) => {
                let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
                if last.elapsed() >= BETWEEN_LINES {
                    *last = Instant::now();
                    complain(&format!("{:3.0} %  {}", 100.0 * share, words()));
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

/// The time left is that of the steps so far, carried on; too early to tell, it is not told.
fn describe(progress: &Progress) -> String {
    let done = done(progress);
    let left = if done > 0.0 && progress.elapsed_s >= 1.0 {
        format!(", about {} left", clock(progress.elapsed_s * (1.0 - done) / done))
    } else {
        String::new()
    };
    format!("{} steps, {}{left}", progress.steps, clock(progress.elapsed_s))
}

/// A span of time as people say it.
pub fn clock(seconds: f64) -> String {
    match seconds {
        s if s < 0.01 => format!("{:.2} ms", 1e3 * s),
        s if s < 10.0 => format!("{s:.2} s"),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_follows_from_the_time_gone() {
        let progress = Progress { time_s: 25.0, duration_s: 100.0, steps: 7, elapsed_s: 20.0 };
        assert_eq!(describe(&progress), "7 steps, 20 s, about 60 s left");
        assert_eq!(describe(&Progress { elapsed_s: 0.5, ..progress }), "7 steps, 0.50 s");
    }
}
