//! Tables of water and solute in unsaturated soil, for the problems of Yan et al. 2020, from finite volumes.

pub mod amounts;
pub mod inclusions;
pub mod profiles;
pub mod slits;

/// A day (s).
const DAY: f64 = 86_400.0;

/// A centimetre (m).
const CENTIMETRE: f64 = 0.01;

/// A problem with a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Case {
    /// A line, wetted from its left end and closed at the other.
    OneSided,
    /// A line, wetted from both ends, with solute from the left one.
    TwoSided,
    /// A square, wetted from its left side, with solute from the middle of that side.
    ZoneSource,
    /// A square that is wetted, with solute, through the middle of its left side alone.
    ZoneClosed,
    /// A square with two cracks that let nothing pass.
    Cracks,
    /// A square with two such cracks that grow.
    GrowingCracks,
    /// A square with discs that let nothing in.
    ImpermeableInclusions,
    /// A square with discs that conduct less.
    PermeableInclusions,
}

impl Case {
    /// All of them.
    pub const ALL: [Case; 8] = [
        Case::OneSided,
        Case::TwoSided,
        Case::ZoneSource,
        Case::ZoneClosed,
        Case::Cracks,
        Case::GrowingCracks,
        Case::ImpermeableInclusions,
        Case::PermeableInclusions,
    ];

    /// Its name, as in those of the tables.
    pub fn name(self) -> &'static str {
        match self {
            Case::OneSided => "one-sided",
            Case::TwoSided => "two-sided",
            Case::ZoneSource => "zone-source",
            Case::ZoneClosed => "zone-closed",
            Case::Cracks => "cracks",
            Case::GrowingCracks => "growing-cracks",
            Case::ImpermeableInclusions => "impermeable-inclusions",
            Case::PermeableInclusions => "permeable-inclusions",
        }
    }

    /// Whether the body is a line.
    pub fn is_line(self) -> bool {
        matches!(self, Case::OneSided | Case::TwoSided)
    }
}
