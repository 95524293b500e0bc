//! The walls of a body: which one is meant, and what it is called in files and results.

use std::fmt;

use glam::DVec2;

/// A wall of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum WallId {
    /// Across x, where a box begins.
    Left,
    /// Across x, where it ends.
    Right,
    /// Across y or z, below.
    Bottom,
    /// Across y or z, above.
    Top,
    /// Around the axis or the centre of a body of shells.
    Inner,
    /// Around the body.
    Outer,
}

impl WallId {
    /// The word for it in files and results.
    pub fn name(self) -> &'static str {
        match self {
            WallId::Left => "left",
            WallId::Right => "right",
            WallId::Bottom => "bottom",
            WallId::Top => "top",
            WallId::Inner => "inner",
            WallId::Outer => "outer",
        }
    }

    /// The walls at both ends of a box along y, or along x, the lesser coordinate first.
    pub fn ends(along_y: bool) -> [WallId; 2] {
        if along_y { [WallId::Bottom, WallId::Top] } else { [WallId::Left, WallId::Right] }
    }

    /// Place among the four sides of a lattice: left or inner, right or outer, bottom, top.
    pub fn side(self) -> usize {
        match self {
            WallId::Left | WallId::Inner => 0,
            WallId::Right | WallId::Outer => 1,
            WallId::Bottom => 2,
            WallId::Top => 3,
        }
    }

    /// Whether it lies across y or z instead of x or r.
    pub fn is_across_y(self) -> bool {
        self.side() >= 2
    }

    /// Whether it lies towards greater coordinates.
    pub fn is_at_end(self) -> bool {
        self.side() % 2 == 1
    }

    /// The direction out of a box through it.
    pub fn outwards(self) -> DVec2 {
        let along = if self.is_across_y() { DVec2::Y } else { DVec2::X };
        if self.is_at_end() { along } else { -along }
    }

    /// The wall of a box that faces it; none of a round one.
    pub fn opposite(self) -> Option<WallId> {
        match self {
            WallId::Left => Some(WallId::Right),
            WallId::Right => Some(WallId::Left),
            WallId::Bottom => Some(WallId::Top),
            WallId::Top => Some(WallId::Bottom),
            WallId::Inner | WallId::Outer => None,
        }
    }
}

impl fmt::Display for WallId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A place where heat may cross the surface of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PatchId {
    /// A wall, where no part of it has a condition of its own.
    Whole(WallId),
    /// A part of a wall, by its number among all parts from 0.
    Part(WallId, usize),
    /// The face of a shaft that is dug.
    Face,
}

impl PatchId {
    /// The wall that it lies in.
    pub fn wall(self) -> Option<WallId> {
        match self {
            PatchId::Whole(wall) | PatchId::Part(wall, _) => Some(wall),
            PatchId::Face => None,
        }
    }
}

impl fmt::Display for PatchId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PatchId::Whole(wall) => wall.fmt(f),
            PatchId::Part(wall, number) => write!(f, "{wall}_part_{}", number + 1),
            PatchId::Face => f.write_str("shaft"),
        }
    }
}
