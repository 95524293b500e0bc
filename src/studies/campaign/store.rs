//! Findings, a line each, so that a campaign that was killed goes on where it stood.
//!
//! A line is a checksum, a space and JSON. Lines are only ever appended, each by a single write: whatever ends the
//! program leaves whole lines and at most one torn line at the end, which the checksum tells and the next start cuts
//! off. Memory holds where findings stand, and not what they are: whole runs with their maps may be among them.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64;

use crate::failure::Failure;

/// Ending of the files of a store.
const ENDING: &str = "journal";

#[derive(Serialize, Deserialize)]
struct Entry<F> {
    key: String,
    finding: F,
}

/// Where a line stands.
#[derive(Clone)]
struct Place {
    file: PathBuf,
    start: u64,
    length: usize,
}

/// The findings of all journals of a folder, and the one that new findings are added to.
pub struct Store {
    build: String,
    path: PathBuf,
    /// Opened by the first finding: whoever finds nothing leaves no file.
    own: Mutex<Option<File>>,
    places: Mutex<HashMap<String, Place>>,
}

impl Store {
    /// Opens the store of a folder, which adds to the file of this name. What another build has found is not taken for this
    /// one's.
    pub fn open(folder: &Path, name: &str, build: &str) -> Result<Self, Failure> {
        let path = folder.join(name);
        let unreadable = |error| Failure::file(folder, "cannot be read", error);
        let mut places = HashMap::new();
        for entry in fs::read_dir(folder).map_err(unreadable)? {
            let file = entry.map_err(unreadable)?.path();
            if file.extension().is_some_and(|ending| ending == ENDING) {
                let bytes = fs::read(&file).map_err(|error| Failure::file(&file, "cannot be read", error))?;
                let whole = index(&file, &bytes, &mut places);
                if file == path && whole < bytes.len() as u64 {
                    let cut = OpenOptions::new().write(true).open(&path).and_then(|own| own.set_len(whole));
                    cut.map_err(|error| Failure::file(&path, "cannot be written", error))?;
                }
            }
        }
        Ok(Store { build: build.to_owned(), path, own: Mutex::new(None), places: Mutex::new(places) })
    }

    /// What tells the build of the program from others.
    pub fn build(&self) -> &str {
        &self.build
    }

    fn stamped(&self, key: &str) -> String {
        format!("{} {key}", self.build)
    }

    /// What is known under a key.
    pub fn find<F: DeserializeOwned>(&self, key: &str) -> Option<F> {
        let key = self.stamped(key);
        let place = self.places.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned()?;
        let line = place.read().ok()?;
        entry(&line).filter(|entry: &Entry<F>| entry.key == key).map(|entry| entry.finding)
    }

    /// Keeps a finding.
    pub fn add<F: Serialize>(&self, key: &str, finding: &F) -> Result<(), Failure> {
        let cannot = |error| Failure::file(&self.path, "cannot be written", error);
        let entry = Entry { key: self.stamped(key), finding };
        let json = serde_json::to_string(&entry).map_err(|error| cannot(error.into()))?;
        let line = format!("{:016x} {json}\n", xxh3_64(json.as_bytes()));
        let end = self.append(line.as_bytes()).map_err(cannot)?;
        let place = Place { file: self.path.clone(), start: end - line.len() as u64, length: line.len() - 1 };
        self.places.lock().unwrap_or_else(PoisonError::into_inner).insert(entry.key, place);
        Ok(())
    }

    /// Adds a line, and says where it ends.
    fn append(&self, line: &[u8]) -> io::Result<u64> {
        let mut own = self.own.lock().unwrap_or_else(PoisonError::into_inner);
        let file = match own.as_mut() {
            Some(file) => file,
            None => own.insert(OpenOptions::new().create(true).append(true).open(&self.path)?),
        };
        file.write_all(line)?;
        file.stream_position()
    }
}

impl Place {
    fn read(&self) -> io::Result<Vec<u8>> {
        let (mut file, mut line) = (File::open(&self.file)?, vec![0; self.length]);
        file.seek(SeekFrom::Start(self.start))?;
        file.read_exact(&mut line)?;
        Ok(line)
    }
}

/// Takes down where the lines of a file stand, and says up to where it has whole ones.
fn index(file: &Path, bytes: &[u8], places: &mut HashMap<String, Place>) -> u64 {
    let mut start = 0;
    for line in bytes.split_inclusive(|byte| *byte == b'\n').filter_map(|line| line.strip_suffix(b"\n")) {
        if let Some(entry) = entry::<IgnoredAny>(line) {
            places.insert(entry.key, Place { file: file.to_owned(), start, length: line.len() });
        }
        start += line.len() as u64 + 1;
    }
    start
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

/// How many findings the journals of a folder hold.
pub fn count_of_findings(folder: &Path) -> usize {
    let mut places = HashMap::new();
    for file in fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()) {
        if file.extension().is_some_and(|ending| ending == ENDING) {
            index(&file, &fs::read(&file).unwrap_or_default(), &mut places);
        }
    }
    places.len()
}

/// The file of this program, whatever stands in its place by now: who installs another does not change runs that go on.
///
/// # Errors
/// Where the system does not tell.
pub fn program() -> io::Result<PathBuf> {
    let held = Path::new("/proc/self/exe");
    if held.exists() { Ok(held.into()) } else { std::env::current_exe() }
}

/// What tells one build of the program from another: its version and a hash of its file.
pub fn build() -> String {
    let file = program().and_then(fs::read).map_or(0, |bytes| xxh3_64(&bytes));
    format!("{}-{file:016x}", env!("CARGO_PKG_VERSION"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that a short decimal does not hold, and a text with a line break.
    fn finding(number: f64) -> (f64, String) {
        (number, "a line\nbreak and \"quotes\"".into())
    }

    fn open(folder: &Path, name: &str, build: &str) -> Store {
        Store::open(folder, name, build).expect("opened")
    }

    const NAME: &str = "runs.journal";

    #[test]
    fn a_torn_last_line_is_cut_off_and_a_spoilt_one_passed_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let (folder, path) = (folder.path(), folder.path().join(NAME));
        let numbers = [1.0 / 3.0, f64::from_bits(0x3ff5_5555_5555_5556), 5.133_956_386_292_835];
        let store = open(folder, NAME, "1");
        for (k, number) in numbers.iter().enumerate() {
            store.add(&format!("run {k}"), &finding(*number)).expect("written");
            assert_eq!(store.find(&format!("run {k}")), Some(finding(*number)));
        }
        drop(store);
        let whole = fs::read(&path).expect("the file");
        let first_end = whole.iter().position(|byte| *byte == b'\n').expect("a line");
        for cut in [1, 20, whole.len() * 2 / 3 - first_end] {
            fs::write(&path, &whole[..whole.len() - cut]).expect("written");
            let store = open(folder, NAME, "1");
            assert_eq!(store.find("run 0"), Some(finding(numbers[0])));
            assert_eq!(store.find::<(f64, String)>("run 2"), None, "{cut} bytes short");
            store.add("run 2", &finding(numbers[2])).expect("written");
            assert_eq!(store.find("run 2"), Some(finding(numbers[2])), "{cut} bytes short");
            drop(store);
            assert_eq!(open(folder, NAME, "1").find("run 2"), Some(finding(numbers[2])), "{cut} bytes short");
        }
        let mut spoilt = whole.clone();
        spoilt[first_end - 3] ^= 1;
        fs::write(&path, &spoilt).expect("written");
        let store = open(folder, NAME, "1");
        assert_eq!(store.find::<(f64, String)>("run 0"), None);
        assert_eq!(store.find("run 1"), Some(finding(numbers[1])));
    }

    #[test]
    fn findings_of_another_build_are_not_its_own_and_those_of_another_shard_are() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        open(folder, NAME, "1").add("run", &1).expect("written");
        assert_eq!(open(folder, NAME, "2").find::<u8>("run"), None);
        open(folder, "runs-2-of-3.journal", "1").add("other", &2).expect("written");
        let store = open(folder, NAME, "1");
        assert_eq!((store.find::<u8>("run"), store.find::<u8>("other")), (Some(1), Some(2)));
    }
}
