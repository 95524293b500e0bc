//! A layout and what is known of it.

use frazil_cases::layouts::LayoutTable;

use super::answers::Answers;
use super::execute::Pair;
use super::variants::Layout;

/// A layout and what is known of it.
pub struct Found<'a> {
    /// The layout.
    pub layout: &'a Layout,
    /// Its runs.
    pub pair: Pair,
    /// What they say.
    pub fine: Answers,
    /// The same at twice the spacing.
    pub coarse: Option<Answers>,
    /// What it is compared with.
    pub reference: Option<Compared>,
}

/// What a layout is compared with.
#[derive(Debug, Clone)]
pub enum Compared {
    /// A table.
    With(LayoutTable),
    /// None, since what was set with the command made another problem of it: the first difference.
    Set(String),
}
