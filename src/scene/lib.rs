//! A scene: the physics of a run and nothing else, checked and in SI (or in the file's own dimensionless units).
//!
//! Temperatures are stored on the file's scale: degrees Celsius in SI scenes, the DPD or dimensionless
//! temperature elsewhere. [`Units::absolute_zero`] maps them to an absolute scale where a law needs one.

pub mod capability;
pub mod files;
mod measured;
pub mod method;
pub mod names;
mod pipe_name;
mod pipe_ring;
mod profile;
mod random;
pub mod read;
pub mod region;
mod scene;
pub mod settings;
mod solute;
pub mod stream;
mod units;

pub use files::{Files, Source};
pub use frazil_record::TimeUnit;
pub use measured::{Event, Measured, MeasuredPoint, Quantity};
pub use pipe_name::{NoPipeName, PipeName};
pub use pipe_ring::PipeRing;
pub use profile::{Profile, ProfileValues};
pub use random::RandomGround;
pub use read::{
    Change, Duration, Heading, Key, MOST_BYTES, Noted, Problem, Problems, Range, Read, Section, Spot, heading,
    read_section, schema, soils, spacing_at_most,
};
pub use region::{Region, Shape};
pub use scene::{Excavation, FreezingDirection, ReferenceChoice, Scene, Wall, WallPart, Watch};
pub use settings::{Arrangement, Front, IntegratorChoice, Numerics, SearchChoice, Setting, StepChoice};
pub use solute::{Solute, SoluteNumerics, SoluteWall};
pub use stream::Stream;
pub use units::Units;
