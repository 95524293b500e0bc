//! A run kept while it goes on, so that it goes on from there to the same bits after whatever has ended it.
//!
//! A checkpoint is a file: what tells the run from others, then all fields that change ([`Saved`]), then a checksum. Two are kept,
//! each whole or not there; where the newer one is not whole the older one serves.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use frazil_core::saved::{Pass, Saved};
use frazil_record::write_whole;
use frazil_scene::Scene;
use frazil_scene::method::MethodSettings;
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_128;

use super::stopwatch::{Elapsed, Stopwatch};
use super::{Options, Simulation};
use crate::refused::Refused;

/// The newer file, and the one before it.
const NAMES: [&str; 2] = ["run.checkpoint", "run.checkpoint.before"];

/// What every such file begins with, the version of its form included.
const MAGIC: [u8; 16] = *b"frazil-keeps-1\r\n";

/// Bytes of the checksum at its end.
const CHECKSUM: usize = size_of::<u128>();

/// Steps between two looks at the clock, where steps are short.
const LOOK: u64 = 16;

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
    every: Duration,
    build: String,
    going: Going,
    tell: &'a (dyn Fn(&str) + Sync),
    failed: AtomicBool,
}

impl<'a> Checkpoints<'a> {
    /// Checkpoints in a folder, so far apart in wall time. `build` tells the program from others; `tell` is told of what does not
    /// end the run.
    pub fn new(
        folder: &'a Path,
        every: Duration,
        (build, going): (String, Going),
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
    fn write(&self, header: &Header, fields: &[u8]) {
        let newest = self.path(NAMES[0]);
        // The folder is made by the first of them: most of the runs of a study need none.
        let made = fs::create_dir_all(self.folder);
        let moved = match fs::rename(&newest, self.path(NAMES[1])) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        };
        let written = made.and(moved).and_then(|()| {
            let bytes = header.beside(fields)?;
            write_whole(&newest, |writer| writer.write_all(&bytes))
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
struct Header {
    /// What tells the run from others: names and values.
    identity: Vec<(String, String)>,
    standing: Standing,
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
    /// The bytes of a file of these fields.
    fn beside(&self, fields: &[u8]) -> io::Result<Vec<u8>> {
        let header = rmp_serde::to_vec_named(self).map_err(io::Error::other)?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend((header.len() as u64).to_le_bytes());
        bytes.extend(header);
        bytes.extend(fields);
        bytes.extend(xxh3_128(&bytes).to_le_bytes());
        Ok(bytes)
    }
}

/// A checkpoint that was found.
pub(super) struct Kept {
    path: PathBuf,
    fields: Vec<u8>,
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

/// What tells a run from others that would not come to the same bits.
fn identity(
    kept: &Checkpoints<'_>,
    scene: &Scene,
    settings: &MethodSettings,
    options: &Options<'_>,
) -> Vec<(String, String)> {
    let values = settings.values().into_iter().map(|(key, value)| format!("{key} = {value:?}"));
    let identity = [
        ("build", kept.build.clone()),
        ("scene", format!("{} ({})", scene.name, scene.hash)),
        ("body", format!("{:?}", scene.domain)),
        ("method", settings.method.to_owned()),
        ("settings", values.collect::<Vec<_>>().join(", ")),
        ("seed", options.seed.to_string()),
        ("maps", options.fields.to_string()),
    ];
    identity.map(|(name, value)| (name.to_owned(), value)).into()
}

/// The newest whole checkpoint of a run that is to go on; nothing where there is none.
///
/// # Errors
/// A checkpoint of another run, and a file that cannot be read.
pub(super) fn found(
    kept: &Checkpoints<'_>,
    scene: &Scene,
    settings: &MethodSettings,
    options: &Options<'_>,
) -> Result<Option<Kept>, Refused> {
    if kept.going == Going::Anew {
        return Ok(None);
    }
    let own = identity(kept, scene, settings, options);
    for name in NAMES {
        let path = kept.path(name);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            Err(error) => return Err(Refused::Checkpoint(path.display().to_string(), error.to_string())),
        };
        let Some((header, fields)) = parts(&bytes) else {
            (kept.tell)(&format!("{}: is not whole and is not used", path.display()));
            continue;
        };
        let other = own.iter().zip(&header.identity).find(|(own, other)| own != other);
        if other.is_some() && kept.going == Going::OnFromOwn {
            continue;
        }
        if let Some(((name, own), (_, other))) = other {
            let difference = format!("is of another run: its {name} is {other}, and that of this run is {own}");
            return Err(Refused::Checkpoint(path.display().to_string(), difference));
        }
        return Ok(Some(Kept { path, fields: fields.to_vec() }));
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

impl Saved for Elapsed {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        pass.all(&mut [&mut self.wall, &mut self.cpu]);
    }
}

impl Saved for Simulation<'_> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        self.method.pass(pass);
        let mut left = self.pending.len();
        pass.all(&mut [
            &mut self.particles,
            &mut self.longest,
            &mut self.clock.time,
            &mut self.clock.step,
            &mut self.clock.index,
            &mut self.clock.turned,
            &mut self.turn,
            &mut self.landed,
            &mut left,
            &mut self.observers,
            &mut self.guard,
            &mut self.observation,
            &mut self.before,
        ]);
        while self.pending.len() > left {
            self.pending.next();
        }
    }
}

impl Simulation<'_> {
    /// Keeps the run, where it is to be kept and it is time to or it is about to end early.
    pub(super) fn keep(&mut self, ends: bool) {
        let Some(kept) = self.options.checkpoints else { return };
        let looks = self.dense || self.clock.index.is_multiple_of(LOOK);
        if !(ends || looks && self.last_checkpoint.elapsed() >= kept.every) {
            return;
        }
        let seen = Stopwatch::start(self.options.threads);
        // What goes on from here counts its own time from nought.
        let before = std::mem::take(&mut self.before);
        let (wall, cpu) = self.solve.stop();
        self.before = Elapsed { wall: before.wall + wall, cpu: before.cpu + cpu };
        let mut pass = Pass::save();
        self.pass(&mut pass);
        self.before = before;
        let standing = Standing {
            scene: self.scene.name.clone(),
            method: self.settings.method.to_owned(),
            time_s: self.clock.time,
            duration_s: self.scene.duration,
            steps: self.clock.index,
            solve_wall_s: self.solved().0,
        };
        let header = Header { identity: identity(kept, self.scene, self.settings, self.options), standing };
        kept.write(&header, &pass.into_bytes());
        self.observation.add(&seen);
        self.last_checkpoint = Instant::now();
    }

    /// Takes the state that a checkpoint keeps.
    ///
    /// # Errors
    /// Fields that are not those of this run.
    pub(super) fn go_on_from(&mut self, kept: &Kept) -> Result<(), Refused> {
        let mut pass = Pass::load(&kept.fields);
        self.pass(&mut pass);
        pass.end().map_err(|foreign| Refused::Checkpoint(kept.path.display().to_string(), foreign.to_string()))
    }
}
