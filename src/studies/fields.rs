//! Whole states at outputs, on request: files that ParaView opens, and frames of an animation.
//!
//! Files are made while a run goes on, in a folder that nobody sees; it is moved to its place when all are there.

mod vtu;

use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use frazil_core::particles::Particles;
use frazil_core::physics::retention::scale::head;
use frazil_plots::frame;
use frazil_plots::movie::movie;
use frazil_scene::Scene;
use frazil_simulation::march::outputs;
use frazil_simulation::observers;

use crate::failure::Failure;
use crate::figure_options;
use crate::output::{make_folder, remove as remove_file, write_whole};
use vtu::Grid;

/// Folder of states, the file that lists them with their times, folder of frames, and the movie of them.
pub const NAMES: [&str; 4] = ["fields", "fields.pvd", "frames", "movie.png"];

/// Folder in which both are made: it stays after a run that was killed, for it to go on.
const HIDDEN: &str = ".fields";

/// Frames were asked for of a line.
#[derive(Debug, thiserror::Error)]
#[error("--frames draws planes, but the domain of `{0}` is a line")]
struct NoPlane(String);

/// What a run leaves at each output beside its series.
pub struct Snapshots<'a> {
    scene: &'a Scene,
    method: &'a str,
    fields: bool,
    frames: bool,
    hidden: PathBuf,
    /// Instants of all states.
    times: Vec<f64>,
    failure: Mutex<Option<Failure>>,
}

impl<'a> Snapshots<'a> {
    /// Snapshots of a scene under a method, made beside the place where they will be. `goes_on`: those of the run that goes on from
    /// a checkpoint stay.
    pub fn new(
        scene: &'a Scene,
        method: &'a str,
        (fields, frames): (bool, bool),
        (folder, goes_on): (&Path, bool),
    ) -> Result<Self, Failure> {
        if frames && scene.domain.dimension() == 1 {
            return Err(Failure::request(NoPlane(scene.name.clone())));
        }
        let hidden = folder.join(HIDDEN);
        let times = std::iter::once(0.0).chain(outputs(scene)).collect();
        let made = Snapshots { scene, method, fields, frames, hidden, times, failure: Mutex::default() };
        for name in [NAMES[0], NAMES[2]] {
            let (path, shown) = (made.hidden.join(name), folder.join(name));
            // A run that was interrupted has shown what there was.
            if goes_on && shown.is_dir() && !path.is_dir() {
                make_folder(&made.hidden)?;
                std::fs::rename(&shown, &path).map_err(|error| Failure::file(&shown, "cannot be moved", error))?;
            }
            make_folder(&path)?;
        }
        Ok(made)
    }

    /// Takes the state at an output. After a failure nothing more is tried: the run itself goes on.
    pub fn see(&self, particles: &Particles, time: f64) {
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        if failure.is_none() {
            let number = self.times.partition_point(|other| *other < time);
            *failure = self.write(particles, time, number).err();
        }
    }

    fn write(&self, particles: &Particles, time: f64, number: usize) -> Result<(), Failure> {
        let place = |folder: &str| self.hidden.join(folder).join(file_name(folder, number));
        if self.fields {
            let path = place(NAMES[0]);
            let failed = |error: io::Error| Failure::file(&path, "cannot be written", error);
            let file = std::fs::File::create(&path).map_err(failed)?;
            write_state(self.scene, particles, BufWriter::new(file)).map_err(failed)?;
        }
        if self.frames {
            let field = observers::map(self.scene, particles, time);
            let options = figure_options::of(self.scene, std::slice::from_ref(&field));
            let names = (self.scene.title.as_str(), self.method, self.scene.units.name());
            let range = if self.scene.of_water { (0.0, 1.0) } else { self.scene.temperature_range() };
            let png = frame(&field, names, &options, range).png()?;
            let path = place(NAMES[2]);
            std::fs::write(&path, png).map_err(|error| Failure::file(&path, "cannot be written", error))?;
        }
        Ok(())
    }

    /// Removes what was made for a run that is not to be.
    pub fn give_up(self) {
        // What stays is removed by the next run.
        let _ = remove(&self.hidden);
    }

    /// Moves everything to its place, or says what failed.
    pub fn finish(self, folder: &Path) -> Result<(), Failure> {
        if let Some(failure) = self.failure.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(failure);
        }
        // A run that goes on may have been without them before.
        let is_there = |number: &usize| self.hidden.join(NAMES[0]).join(file_name(NAMES[0], *number)).exists();
        let numbers: Vec<usize> = (0..self.times.len()).filter(is_there).collect();
        for (name, wanted) in [(NAMES[0], self.fields), (NAMES[2], self.frames)] {
            let place: PathBuf = folder.join(name);
            if wanted {
                // A longer run may have been here before.
                for number in self.times.len().. {
                    let later = self.hidden.join(name).join(file_name(name, number));
                    if !later.exists() {
                        break;
                    }
                    remove_file(&later)?;
                }
                let moved = std::fs::rename(self.hidden.join(name), &place);
                moved.map_err(|error| Failure::file(&place, "cannot be moved to its place", error))?;
            }
        }
        remove(&self.hidden)?;
        if self.frames {
            film(&folder.join(NAMES[2]), &folder.join(NAMES[3]))?;
        }
        let times: Vec<(usize, f64)> = numbers.into_iter().map(|number| (number, self.times[number])).collect();
        if self.fields { write_whole(&folder.join(NAMES[1]), |writer| collection(&times, writer)) } else { Ok(()) }
    }
}

/// Removes the states that a run that is not gone on with has left unfinished in its folder.
///
/// # Errors
/// Where they cannot be removed.
pub fn forget(folder: &Path) -> Result<(), Failure> {
    remove(&folder.join(HIDDEN))
}

fn remove(hidden: &Path) -> Result<(), Failure> {
    match std::fs::remove_dir_all(hidden) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Failure::file(hidden, "cannot be removed", error)),
        _ => Ok(()),
    }
}

/// Makes the frames of a folder a movie.
fn film(frames: &Path, path: &Path) -> Result<(), Failure> {
    let unread = |error| Failure::file(frames, "cannot be read", error);
    let entries = std::fs::read_dir(frames).and_then(Iterator::collect::<Result<Vec<_>, _>>).map_err(unread)?;
    let mut pictures: Vec<PathBuf> = entries.into_iter().map(|entry| entry.path()).collect();
    pictures.sort();
    write_whole(path, |writer| movie(&pictures, writer).map_err(io::Error::other))
}

/// The name of a state, or of a frame, in its folder.
fn file_name(folder: &str, number: usize) -> String {
    let ending = if folder == NAMES[0] { "vtu" } else { "png" };
    format!("{number:05}.{ending}")
}

/// The list of states, by their numbers and times (s): a format of five lines, which the library does not know.
fn collection(states: &[(usize, f64)], writer: &mut dyn Write) -> io::Result<()> {
    writeln!(
        writer,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">"
    )?;
    writeln!(writer, "  <Collection>")?;
    for (number, time) in states {
        writeln!(
            writer,
            "    <DataSet timestep=\"{time}\" part=\"0\" file=\"{}/{}\"/>",
            NAMES[0],
            file_name(NAMES[0], *number)
        )?;
    }
    writeln!(writer, "  </Collection>\n</VTKFile>")
}

/// What is read off each particle, by its name.
type Columns<'a> = Vec<(&'static str, Box<dyn Fn(usize) -> f64 + 'a>)>;

fn of_heat(particles: &Particles) -> Columns<'_> {
    let enthalpy = |i: usize| particles.enthalpy[i] + particles.materials.of(i).zero_enthalpy;
    vec![
        ("temperature_c", Box::new(|i| particles.temperature(i))),
        ("frozen_fraction", Box::new(|i| particles.front_fraction(i))),
        ("enthalpy_J_per_m3", Box::new(enthalpy)),
    ]
}

/// Of unsaturated water; dry ground has no head.
fn of_water<'a>(scene: &'a Scene, particles: &'a Particles) -> Columns<'a> {
    let head = |i: usize| Some(head(particles.temperature(i))).filter(|head| head.is_finite()).unwrap_or(f64::NAN);
    let content = |i: usize| {
        let soil = scene.materials[particles.materials.index(i)].soil.as_ref();
        soil.map_or(f64::NAN, |soil| soil.residual + (soil.saturated - soil.residual) * particles.reading(i))
    };
    let mut columns: Columns<'a> = vec![
        ("saturation", Box::new(|i| particles.reading(i))),
        ("head_m", Box::new(head)),
        ("water_content", Box::new(content)),
    ];
    if !particles.concentration.is_empty() {
        columns.push(("concentration", Box::new(|i| particles.concentration[i])));
    }
    columns
}

/// Writes all particles as points with their state. Enthalpies count from the unfrozen freezing point, as in the theory.
fn write_state(scene: &Scene, particles: &Particles, out: impl Write) -> io::Result<()> {
    let count = particles.len();
    let mut places = Vec::with_capacity(count);
    particles.visit(|_, place| places.push([place.x, place.y, 0.0]));
    let mut read = if scene.of_water { of_water(scene, particles) } else { of_heat(particles) };
    if !particles.factors.is_empty() {
        read.push(("conductivity_factor", Box::new(|i| particles.factors[i])));
    }
    let mut grid = Grid::begin(out, count)?;
    for (name, value) in &read {
        grid.column(name, (0..count).map(value))?;
    }
    grid.column("volume", (0..count).map(|i| particles.volumes.of(i)))?;
    grid.column("material", (0..count).map(|i| particles.materials.index(i) as i32))?;
    grid.end(&places)
}
