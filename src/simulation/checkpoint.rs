//! A run kept while it goes on, so that it goes on from there to the same bits after whatever has ended it.
//!
//! A checkpoint is a file: what tells the run from others, then all fields that change ([`frazil_core::saved`]), then a checksum. Two are kept,
//! each whole or not there; where the newer one is not whole the older one serves.

use std::fmt::Display;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use frazil_record::write_whole;
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::{Xxh3, xxh3_128};

use crate::refused::Refused;

/// The newer file, and the one before it.
const NAMES: [&str; 2] = ["run.checkpoint", "run.checkpoint.before"];

/// What every such file begins with, the version of its form included.
const MAGIC: [u8; 16] = *b"frazil-keeps-1\r\n";

/// Bytes of the checksum at its end.
const CHECKSUM: usize = size_of::<u128>();

/// Whether a run goes on from a checkpoint that is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Going {
    /// It begins anew.
    Anew,
    /// It goes on, and is refused if the checkpoint is of another run.
    On,
    /// It goes on from one of its own, and passes over others: one of many runs of a study, whose folders may be used again.
    OnFromOwn,
}

/// Where and how often a run is kept.
pub struct Checkpoints<'a> {
    folder: &'a Path,
    /// Wall time between two of them.
    pub(crate) every: Duration,
    build: &'a (dyn Fn() -> String + Sync),
    going: Going,
    tell: &'a (dyn Fn(&str) + Sync),
    failed: AtomicBool,
}

impl<'a> Checkpoints<'a> {
    /// Checkpoints in a folder, so far apart in wall time. `build` tells the program from others, once there is one to write or read;
    /// `tell` is told of what does not end the run.
    pub fn new(
        folder: &'a Path,
        every: Duration,
        (build, going): (&'a (dyn Fn() -> String + Sync), Going),
        tell: &'a (dyn Fn(&str) + Sync),
    ) -> Self {
        Checkpoints { folder, every, build, going, tell, failed: AtomicBool::new(false) }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Removes the checkpoints of a run that has come to its end.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn clear(&self) -> io::Result<()> {
        for name in NAMES {
            match fs::remove_file(self.path(name)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        Ok(())
    }

    /// Writes one. That it cannot be written is told once, and does not end the run.
    pub(crate) fn write(&self, header: &Header, fields: &[u8]) {
        let newest = self.path(NAMES[0]);
        // The folder is made by the first of them: most of the runs of a study need none.
        let made = fs::create_dir_all(self.folder);
        let moved = match fs::rename(&newest, self.path(NAMES[1])) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        };
        let written = made.and(moved).and_then(|()| header.bytes()).and_then(|header| {
            let mut checksum = Xxh3::new();
            write_whole(&newest, |writer| {
                for part in [&header[..], fields] {
                    checksum.update(part);
                    writer.write_all(part)?;
                }
                writer.write_all(&checksum.digest128().to_le_bytes())
            })
        });
        if let Err(error) = written
            && !self.failed.swap(true, Ordering::Relaxed)
        {
            (self.tell)(&format!("{}: a checkpoint cannot be written: {error}; the run goes on", newest.display()));
        }
    }
}

/// What a checkpoint says of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    /// What tells the run from others: names and values.
    pub(crate) identity: Vec<(String, String)>,
    pub(crate) standing: Standing,
}

/// Where a run stands that a checkpoint keeps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// Scene and method.
    pub scene: String,
    /// See [`Standing::scene`].
    pub method: String,
    /// Simulated time, and that of the end (s).
    pub time_s: f64,
    /// See [`Standing::time_s`].
    pub duration_s: f64,
    /// Steps made.
    pub steps: u64,
    /// Wall time of the steps (s).
    pub solve_wall_s: f64,
}

impl Header {
    /// The bytes that stand before the fields.
    fn bytes(&self) -> io::Result<Vec<u8>> {
        let header = rmp_serde::to_vec_named(self).map_err(io::Error::other)?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend((header.len() as u64).to_le_bytes());
        bytes.extend(header);
        Ok(bytes)
    }
}

/// A checkpoint that was found.
pub(crate) struct Kept {
    path: PathBuf,
    bytes: Vec<u8>,
    /// Where its fields begin.
    start: usize,
}

impl Kept {
    /// Its fields.
    pub(crate) fn fields(&self) -> &[u8] {
        &self.bytes[self.start..self.bytes.len() - CHECKSUM]
    }

    /// What is wrong with it, where its fields are not those of the run.
    pub(crate) fn foreign(&self, why: impl Display) -> Refused {
        Refused::Checkpoint(self.path.display().to_string(), why.to_string())
    }
}

/// Header and fields of a file; none if it is not whole.
fn parts(bytes: &[u8]) -> Option<(Header, &[u8])> {
    let (body, checksum) = bytes.split_last_chunk::<CHECKSUM>()?;
    if xxh3_128(body) != u128::from_le_bytes(*checksum) {
        return None;
    }
    let (length, rest) = body.strip_prefix(&MAGIC)?.split_first_chunk::<8>()?;
    let (header, fields) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    Some((rmp_serde::from_slice(header).ok()?, fields))
}

/// What tells a run with a seed, and with or without maps, from others that would not come to the same bits.
pub(crate) fn identity(
    kept: &Checkpoints<'_>,
    scene: &Scene,
    settings: &MethodSettings,
    (seed, maps): (u64, bool),
) -> Vec<(String, String)> {
    let values = settings.values().into_iter().map(|(key, value)| format!("{key} = {value:?}"));
    let identity = [
        ("build", (kept.build)()),
        ("scene", format!("{} ({})", scene.name, scene.hash)),
        ("body", format!("{:?}", scene.domain)),
        ("method", settings.method.to_owned()),
        ("settings", values.collect::<Vec<_>>().join(", ")),
        ("seed", seed.to_string()),
        ("maps", maps.to_string()),
    ];
    identity.map(|(name, value)| (name.to_owned(), value)).into()
}

/// The newest whole checkpoint of a run that is to go on; nothing where there is none.
///
/// # Errors
/// A checkpoint of another run, and a file that cannot be read.
pub(crate) fn found(
    kept: &Checkpoints<'_>,
    identity: impl Fn() -> Vec<(String, String)>,
) -> Result<Option<Kept>, Refused> {
    if kept.going == Going::Anew {
        return Ok(None);
    }
    for name in NAMES {
        let path = kept.path(name);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            Err(error) => return Err(Refused::Checkpoint(path.display().to_string(), error.to_string())),
        };
        let Some((header, fields)) = parts(&bytes) else {
            (kept.tell)(&format!("{}: is incomplete and is not used", path.display()));
            continue;
        };
        let own = identity();
        let other = own.iter().zip(&header.identity).find(|(own, other)| own != other);
        if other.is_some() && kept.going == Going::OnFromOwn {
            continue;
        }
        if let Some(((name, own), (_, other))) = other {
            let difference = format!("is of another run: its {name} is {other}, that of this run is {own}");
            return Err(Refused::Checkpoint(path.display().to_string(), difference));
        }
        let start = bytes.len() - CHECKSUM - fields.len();
        return Ok(Some(Kept { path, bytes, start }));
    }
    Ok(None)
}

/// Where the run stands that the checkpoints of a folder keep; nothing where there are none.
///
/// # Errors
/// A file that cannot be read.
pub fn standing(folder: &Path) -> io::Result<Option<Standing>> {
    for name in NAMES {
        match fs::read(folder.join(name)) {
            Ok(bytes) => {
                if let Some((header, _)) = parts(&bytes) {
                    return Ok(Some(header.standing));
                }
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(error),
        }
    }
    Ok(None)
}
