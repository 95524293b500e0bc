//! What a run leaves behind: one record and the tables beside it. Figures and studies read these, never particles.

mod measured;
mod provenance;
mod record;
mod result;
mod shown;
mod stream;
mod table;
mod tables;
mod time_unit;
mod wall;
mod water;
mod work;
mod write;

pub use measured::{MeasuredErrors, MeasuredRow};
pub use provenance::Provenance;
pub use record::{Errors, EstimatedError, Outcome, Record, ReferenceInfo, Value};
pub use result::RunResult;
pub use shown::{brief, fixed, is_hidden, off_by, plain, quoted, shown, shown_lines};
pub use stream::{SectionRow, StreamRecord, StreamRow};
pub use table::{Column, Head, Role, Table, Unit};
pub use tables::{
    BesideRow, BudgetRow, Field, FrontRow, FrozenRow, MeanOver, PhaseRow, ProbeRow, ProfileRow, Start, SurfaceRow,
};
pub use time_unit::TimeUnit;
pub use wall::{FrontLineRow, GapRow, LinkRow, PlaneRow, WallRecord, WallRow};
pub use water::{CutRow, FlowPoint, WaterRecord, WaterRow, WaterSeries};
pub use work::Work;
pub use write::{UNFINISHED, write_whole};
