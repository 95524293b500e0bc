//! Runs that are refused before their first step.

use frazil_core::balances::groundwater::error::GroundwaterError;
use frazil_core::balances::solute::SoluteError;
use frazil_core::boundary::patch::MOST_PATCHES;
use frazil_core::boundary::pipe::PipeError;
use frazil_core::boundary::shells::ShellError;
use frazil_core::boundary::wall_layers::NoFreeParticle;
use frazil_core::memory::{self, Allowed, Memory};
use frazil_core::solvers::step::Bound;
use frazil_core::space::wall::PatchId;
use frazil_record::plain;
use frazil_scene::method::Unrepresented;
use glam::DVec2;
use rand_distr::uniform;

use crate::closing::DugTooEarly;

/// Why a run was refused before its first step, by the setting and what is allowed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refused {
    /// A scene, by its name, says nothing of a method.
    #[error("scene `{scene}` has no section [method.{method}] that gives its spacing")]
    NoMethod {
        /// The scene.
        scene: String,
        /// The method.
        method: String,
    },
    /// What errors are taken against, or walls follow, cannot be had: the reason in words.
    #[error("{0}")]
    Reference(String),
    /// A method, by its name, has no bound to go beyond.
    #[error("[method.{0}]: adaptive steps have no step bound to exceed")]
    NoBound(&'static str),
    /// What a method that makes its own particles says that it cannot represent.
    #[error("{0}")]
    Method(String),
    /// A checkpoint, by its path, from which the run cannot go on: why.
    #[error("{0}: {1}")]
    Checkpoint(String, String),
    /// More than the memory that a run may take, before any of it is taken.
    #[error(
        "a spacing of {spacing} makes {particles:.1e} particles, which with {what} need at least {}, and a run may take \
         {allowed}: set a spacing of at least {}",
        memory::words(*.needed), plain(*.fits, 3)
    )]
    Memory {
        /// Spacing (m).
        spacing: f64,
        /// Particles.
        particles: f64,
        /// What is held beside them.
        what: &'static str,
        /// What is needed (bytes).
        needed: f64,
        /// What is allowed.
        allowed: Allowed,
        /// A spacing with which less is needed (m).
        fits: f64,
    },
    /// A run that would hold more at its end than it may take, counted part by part.
    #[error(
        "the run would hold {} in memory at its end, {} of it results, and may take {allowed}: {}",
        memory::words(held.total() as f64),
        memory::words(held.observers as f64),
        if held.observers > held.particles + held.method {
            "fewer outputs and profiles need less, and so does a larger spacing".into()
        } else {
            format!("a spacing of about {} fits", plain(*fits, 3))
        }
    )]
    Held {
        /// What it would hold.
        held: Memory,
        /// What is allowed.
        allowed: Allowed,
        /// A spacing with which it would be enough (m).
        fits: f64,
    },
    /// A stream of particles at rest.
    #[error("a stream needs moving particles: method.edpd.motion = true")]
    StillStream,
    /// A shaft is dug before a wall can stand.
    #[error(transparent)]
    DugTooEarly(#[from] DugTooEarly),
    /// A solute that the body has no place for.
    #[error(transparent)]
    Solute(#[from] SoluteError),
    /// Fronts inside particles where heat needs a list, and why it does.
    #[error("front = \"sub-cell\" needs a lattice without a neighbour list, but {0}")]
    FrontOnList(&'static str),
    /// A sweep over a lattice that is too narrow for it.
    #[error("search = \"lattice\" needs a body at least as wide as the reach of pairs: set \"auto\"")]
    NarrowLattice,
    /// A body that repeats after less than the reach of its pairs.
    #[error("walls with condition = \"periodic\" must be at least as far apart as pairs reach")]
    NarrowPeriod,
    /// Cracks in a body that is too narrow for them.
    #[error("cracks and impermeable parts need a body at least as wide as the reach of pairs")]
    NarrowCracks,
    /// A crack comes too near to the curved wall.
    #[error(
        "crack {number} comes within {distance:.6} m of the curved wall, must stay away from it by the reach of pairs, \
         {reach:.6} m"
    )]
    CrackAtWall {
        /// Its number.
        number: usize,
        /// How near it comes (m).
        distance: f64,
        /// How far pairs reach (m).
        reach: f64,
    },
    /// A crack cuts what stands for a pipe.
    #[error(
        "crack {number} cuts the particles under the regularised delta of the pipe at ({:.4}, {:.4}) m, must stay {half:.6} m away from it",
        .centre.x,
        .centre.y
    )]
    CrackInPipe {
        /// Its number.
        number: usize,
        /// Where the pipe stands (m).
        centre: DVec2,
        /// How far its particles reach in each direction (m).
        half: f64,
    },
    /// An impermeable part comes too near to the curved wall.
    #[error(
        "impermeable part {number} comes within {distance:.6} m of the curved wall, as the box around it has it, must stay \
         away from it by the reach of pairs, {reach:.6} m"
    )]
    ImpermeableAtWall {
        /// Its number.
        number: usize,
        /// How near the box around it comes (m).
        distance: f64,
        /// How far pairs reach (m).
        reach: f64,
    },
    /// No particle stands where phases are watched (m), at a spacing (m).
    #[error(
        "watch.phases_between: no particle stands between {from} and {to} at a spacing of {spacing}, must be a part of the body \
         in which one does"
    )]
    NoPhases {
        /// From there.
        from: f64,
        /// To there.
        to: f64,
        /// Spacing.
        spacing: f64,
    },
    /// Impermeable parts cover all particles of a spacing (m).
    #[error(
        "impermeable parts cover every particle at a spacing of {0}: leave a part of the body open, or set a smaller spacing"
    )]
    Closed(f64),
    /// An impermeable part covers what stands for a pipe.
    #[error(
        "impermeable part {number} covers particles under the regularised delta of the pipe at ({:.4}, {:.4}) m, must stay {half:.6} m away \
         from it",
        .centre.x,
        .centre.y
    )]
    ImpermeableInPipe {
        /// Its number.
        number: usize,
        /// Where the pipe stands (m).
        centre: DVec2,
        /// How far its particles reach in each direction (m).
        half: f64,
    },
    /// A shaft takes away what stands for a pipe.
    #[error(
        "the shaft of {radius} m takes away particles that stand for the pipe at ({:.4}, {:.4}) m, the nearest {nearest:.3} m \
         from the centre: a finer spacing is needed",
        .centre.x,
        .centre.y
    )]
    ShaftInPipe {
        /// Radius of the shaft (m).
        radius: f64,
        /// Where the pipe stands (m).
        centre: DVec2,
        /// How near its particles are to the centre (m).
        nearest: f64,
    },
    /// A spacing (m) that is too large for any particle.
    #[error("a spacing of {0} m leaves no particle in the domain")]
    NoParticle(f64),
    /// Too many walls and parts of walls.
    #[error("{0} walls and parts of walls, must be at most {MOST_PATCHES}")]
    TooManyPatches(usize),
    /// Particles without partners.
    #[error("no pair of particles has a weight: the reach is smaller than the spacing")]
    NoPair,
    /// A wall follows an exact solution that there is not.
    #[error("wall `{0}` asks for the exact solution, but this scene has none")]
    NoExact(PatchId),
    /// Mirrored layers reach to this radius (m).
    #[error(
        "the mirrored layers behind the wall \"inner\" reach across the axis, to r = {0:.6} m: in the paper setting pairs \
         must reach less than the inner radius"
    )]
    AcrossTheAxis(f64),
    /// A ring of pipes, by its number from 1, is switched too often.
    #[error(
        "the pipes of ring {ring} are switched {switches:.1e} times, must be at most {most:.0e}: steps land on every switch"
    )]
    Switches {
        /// The ring.
        ring: usize,
        /// How often.
        switches: f64,
        /// How often at most.
        most: f64,
    },
    /// A step that is not stable.
    #[error("step_s = {step} is above the stable bound of {:.6} s, which is set by {}", .bound.step, .bound.cause)]
    LongStep {
        /// The step (s).
        step: f64,
        /// Its bound.
        bound: Bound,
    },
    /// Steps that never end.
    #[error(
        "the run would take {steps:.1e} steps of {} s, must be at most {most:.0e}: the bound is set by {cause}",
        plain(*.step, 2)
    )]
    ManySteps {
        /// How many.
        steps: f64,
        /// Their length (s).
        step: f64,
        /// How many at most.
        most: f64,
        /// What sets their bound.
        cause: String,
    },
    /// Threads that the system does not give.
    #[error("cannot start {threads} threads: {cause}")]
    Threads {
        /// How many.
        threads: usize,
        /// What the system says.
        cause: String,
    },
    /// No numbers for places off the lattice.
    #[error(transparent)]
    Places(#[from] uniform::Error),
    /// Particles that are shells.
    #[error(transparent)]
    Shells(#[from] ShellError),
    /// Layers of particles as walls.
    #[error(transparent)]
    Layers(#[from] NoFreeParticle),
    /// A pipe that does not fit.
    #[error(transparent)]
    Pipe(#[from] PipeError),
    /// Water that does not flow.
    #[error(transparent)]
    Water(#[from] GroundwaterError),
}

impl From<Unrepresented> for Refused {
    fn from(wrong: Unrepresented) -> Self {
        Refused::Method(wrong.to_string())
    }
}
