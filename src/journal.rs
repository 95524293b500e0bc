//! Finished runs, a line each, so that a study that was killed goes on where it stood.
//!
//! A line is a checksum, a space and JSON. Lines are only ever appended, each by a single write: whatever ends the
//! program leaves whole lines and at most one torn line at the end, which the checksum tells and the next start cuts
//! off.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64;

use crate::failure::Failure;

#[derive(Serialize, Deserialize)]
struct Entry<F> {
    key: String,
    finding: F,
}

/// The runs that are known, with what each found, and the file that holds them.
pub struct Journal<F> {
    path: PathBuf,
    stamp: String,
    known: Mutex<HashMap<String, F>>,
    file: Mutex<File>,
}

impl<F: Clone + Serialize + DeserializeOwned> Journal<F> {
    /// Opens a journal, or begins one. Runs of another program than the one of `stamp` are not taken for its own.
    pub fn open(path: &Path, stamp: &str) -> Result<Self, Failure> {
        let bytes = match fs::read(path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            read => read.map_err(|error| Failure::file(path, "cannot be read", error))?,
        };
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        let entries = bytes[..whole].split(|byte| *byte == b'\n').filter_map(entry::<F>);
        let known = entries.map(|entry| (entry.key, entry.finding)).collect();
        let cannot = |error| Failure::file(path, "cannot be written", error);
        let file = OpenOptions::new().create(true).append(true).open(path).map_err(cannot)?;
        file.set_len(whole as u64).map_err(cannot)?;
        Ok(Journal { path: path.to_owned(), stamp: stamp.to_owned(), known: Mutex::new(known), file: Mutex::new(file) })
    }

    fn stamped(&self, key: &str) -> String {
        format!("{} {key}", self.stamp)
    }

    /// What is known of a run.
    pub fn find(&self, key: &str) -> Option<F> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).get(&self.stamped(key)).cloned()
    }

    /// Takes down a run.
    pub fn add(&self, key: &str, finding: &F) -> Result<(), Failure> {
        let cannot = |error| Failure::file(&self.path, "cannot be written", error);
        let entry = Entry { key: self.stamped(key), finding: finding.clone() };
        let json = serde_json::to_string(&entry).map_err(|error| cannot(error.into()))?;
        let line = format!("{:016x} {json}\n", xxh3_64(json.as_bytes()));
        self.file.lock().unwrap_or_else(PoisonError::into_inner).write_all(line.as_bytes()).map_err(cannot)?;
        self.known.lock().unwrap_or_else(PoisonError::into_inner).insert(entry.key, entry.finding);
        Ok(())
    }
}

/// The entry of a line; none if the line is not what was written.
fn entry<F: DeserializeOwned>(line: &[u8]) -> Option<Entry<F>> {
    let (checksum, json) = std::str::from_utf8(line).ok()?.split_once(' ')?;
    let checksum = u64::from_str_radix(checksum, 16).ok()?;
    if checksum != xxh3_64(json.as_bytes()) {
        return None;
    }
    serde_json::from_str(json).ok()
}

/// What tells one build of the program from another: its version and a hash of its file.
pub fn stamp() -> String {
    let file = std::env::current_exe().and_then(fs::read).map_or(0, |bytes| xxh3_64(&bytes));
    format!("{}-{file:016x}", env!("CARGO_PKG_VERSION"))
}

#[cfg(test)]
mod tests {
    use frazil_record::Outcome;

    use super::*;
    use crate::stability::cell::Finding;

    fn finding(step_s: f64) -> Finding {
        Finding {
            outcome: Outcome::Oscillating,
            cause: Some("a line\nbreak and \"quotes\"".into()),
            steps: 7,
            step_s,
            violation_rel: Some(0.1 + 0.2),
            setback_rel: None,
            energy_balance_rel: Some(-1e-300),
        }
    }

    #[test]
    fn a_torn_last_line_is_cut_off_and_a_spoilt_one_passed_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("cells.journal");
        // Numbers that a short decimal does not hold.
        let steps = [1.0 / 3.0, f64::from_bits(0x3ff5_5555_5555_5556), 5.133_956_386_292_835];
        let journal = Journal::open(&path, "1").expect("opened");
        for (k, step) in steps.iter().enumerate() {
            journal.add(&format!("run {k}"), &finding(*step)).expect("written");
        }
        drop(journal);
        let whole = fs::read(&path).expect("the file");
        let first_end = whole.iter().position(|byte| *byte == b'\n').expect("a line");
        for cut in [1, 20, whole.len() - first_end - 2] {
            fs::write(&path, &whole[..whole.len() - cut]).expect("written");
            let journal = Journal::open(&path, "1").expect("opened");
            assert_eq!(journal.find("run 0"), Some(finding(steps[0])));
            assert_eq!(journal.find("run 2"), None, "{cut} bytes short");
            journal.add("run 2", &finding(steps[2])).expect("written");
            drop(journal);
            let journal = Journal::open(&path, "1").expect("opened");
            assert_eq!(journal.find("run 2"), Some(finding(steps[2])), "{cut} bytes short");
        }
        let mut spoilt = whole.clone();
        spoilt[first_end - 3] ^= 1;
        fs::write(&path, &spoilt).expect("written");
        let journal = Journal::open(&path, "1").expect("opened");
        assert_eq!(journal.find("run 0"), None);
        assert_eq!(journal.find("run 1"), Some(finding(steps[1])));
    }

    #[test]
    fn runs_of_another_program_are_not_its_own() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("cells.journal");
        Journal::open(&path, "1").expect("opened").add("run", &finding(1.0)).expect("written");
        assert_eq!(Journal::<Finding>::open(&path, "2").expect("opened").find("run"), None);
        assert!(Journal::<Finding>::open(&path, "1").expect("opened").find("run").is_some());
    }
}
