//! Everything that one run leaves.

use serde::{Deserialize, Serialize};

use crate::{
    BesideRow, BudgetRow, Field, FrontLineRow, FrontRow, FrozenRow, GapRow, LinkRow, MeasuredRow, PhaseRow, PlaneRow,
    ProbeRow, ProfileRow, Record, SectionRow, Start, StreamRow, SurfaceRow, Table, WallRow, WaterSeries,
};

/// Everything one run leaves.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RunResult {
    /// The record.
    pub record: Record,
    /// Front over time; empty where no front is defined.
    pub front: Vec<FrontRow>,
    /// What was frozen at the start.
    pub start: Start,
    /// The front of a solution that is shown beside the reference; mostly empty.
    pub beside: Vec<BesideRow>,
    /// Frozen volume of a body of shells over time; empty elsewhere.
    pub frozen: Vec<FrozenRow>,
    /// Phases over time, where the scene asks for them.
    pub phases: Vec<PhaseRow>,
    /// Velocities across a driven liquid.
    pub stream: Vec<StreamRow>,
    /// Temperatures across it.
    pub sections: Vec<SectionRow>,
    /// Profiles.
    pub profiles: Vec<ProfileRow>,
    /// Probes.
    pub probes: Vec<ProbeRow>,
    /// What was measured, beside what the run found then and there; mostly empty.
    #[serde(default)]
    pub measured: Vec<MeasuredRow>,
    /// Heat through surfaces; empty where the scene names none.
    pub surfaces: Vec<SurfaceRow>,
    /// Names of walls and pipe rings in the heat balance.
    pub budget_names: Vec<String>,
    /// Heat balance.
    pub budget: Vec<BudgetRow>,
    /// Frozen wall of a ring; empty elsewhere.
    pub walls: Vec<WallRow>,
    /// Gaps of a ring; empty elsewhere.
    pub gaps: Vec<GapRow>,
    /// Neighbouring pipes of all rings, where the scene asks for them; of the whole plan, also where a part of it is run.
    pub links: Vec<LinkRow>,
    /// Sections of the frozen wall, where the scene asks for them.
    pub planes: Vec<PlaneRow>,
    /// The front of a frozen wall as lines, where the scene asks for its wall and maps are kept.
    #[serde(default)]
    pub front_lines: Vec<FrontLineRow>,
    /// Temperature fields at the profile instants; empty on a line.
    pub fields: Vec<Field>,
    /// Water over time, where it flows.
    pub water: Option<WaterSeries>,
    /// Tables that say themselves what is in them.
    #[serde(default)]
    pub tables: Vec<Table>,
}

impl RunResult {
    /// A record without any series.
    pub fn bare(record: Record) -> Self {
        RunResult { record, ..RunResult::default() }
    }
}
