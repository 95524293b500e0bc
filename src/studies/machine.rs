//! The machine and the build behind the numbers.

use std::fs;
use std::time::{SystemTime, UNIX_EPOCH};

use frazil_core::compiled;
use frazil_plots::page::Fact;
use frazil_record::Provenance;

/// What tells machines apart on which runs take other times.
pub fn identity() -> String {
    format!("{}, {} cores", processor(), crate::parallel::cores())
}

/// What a record says of the machine and the build, and of the time now.
pub fn provenance() -> Provenance {
    let flags = if compiled::FLAGS.is_empty() { String::new() } else { format!(", {}", compiled::FLAGS) };
    Provenance {
        date: utc(SystemTime::now()),
        compiler: compiled::COMPILER.into(),
        compiled: format!("{}{flags}", compiled::optimisation()),
        processor: processor(),
        cores: crate::parallel::cores(),
        system: system(),
        ..Provenance::default()
    }
}

fn processor() -> String {
    value_in("/proc/cpuinfo", "model name").unwrap_or_else(|| std::env::consts::ARCH.into())
}

/// What is known at the start of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    date: String,
    load: String,
}

impl Machine {
    /// Takes down date and load.
    pub fn now() -> Machine {
        Machine { date: utc(SystemTime::now()), load: load() }
    }

    /// Everything, for the page, with how a study used its threads.
    pub fn facts(&self, threads: Fact) -> Vec<Fact> {
        let cores = crate::parallel::cores();
        let memory = value_in("/proc/meminfo", "MemTotal:");
        let memory = memory.as_deref().and_then(|text| text.strip_suffix("kB")?.trim().parse::<f64>().ok());
        let memory = memory.map_or("unknown".into(), |kibibytes| format!("{:.1} GiB", kibibytes / 1_048_576.0));
        vec![
            Fact::new("Processor", processor()),
            Fact::new("Cores to be had", cores.to_string()),
            Fact::new("Memory", memory),
            Fact::new("System", system()),
            Fact::new("Program", format!("frazil {}, {}", env!("CARGO_PKG_VERSION"), compiled::optimisation())),
            Fact::new("Compiler", compiled::COMPILER),
            Fact::new(
                "Flags",
                match compiled::FLAGS {
                    "" => "none beyond the profile",
                    flags => flags,
                },
            ),
            threads,
            Fact::new(
                "Load averages over 1, 5 and 15 minutes at the start; at the end",
                format!("{}; {}", self.load, load()),
            ),
            Fact::new("Date", self.date.clone()),
        ]
    }
}

fn value_in(file: &str, key: &str) -> Option<String> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    Some(line[key.len()..].trim_start_matches([' ', '\t', ':']).trim().into())
}

fn system() -> String {
    let name = value_in("/etc/os-release", "PRETTY_NAME=").map(|name| name.trim_matches('"').to_owned());
    let kernel = fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    format!("{} {}", name.unwrap_or_else(|| std::env::consts::OS.into()), kernel.trim())
}

fn load() -> String {
    let text = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let three: Vec<&str> = text.split_whitespace().take(3).collect();
    if three.is_empty() { "unknown".into() } else { three.join(" ") }
}

/// Date and time of day in UTC.
fn utc(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    // Civil date from days (Hinnant, "chrono-compatible low-level date algorithms"), years beginning in March.
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    format!("{year}-{month:02}-{day:02} {:02}:{:02} UTC", rest / 3600, rest % 3600 / 60)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn dates_are_those_of_the_calendar() {
        let at = |seconds| utc(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(at(0), "1970-01-01 00:00 UTC");
        assert_eq!(at(951_782_400), "2000-02-29 00:00 UTC");
        assert_eq!(at(1_795_245_360), "2026-11-21 07:16 UTC");
    }
}
