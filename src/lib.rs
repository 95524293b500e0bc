//! The program `frazil`: what a user runs, as functions.

pub mod atlas;
pub mod calibrate;
pub mod check;
#[cfg(feature = "command-line")]
pub mod cli;
pub mod gallery;
pub mod interrupt;
pub mod list;
pub mod load;
pub mod parts;
pub mod process_runs;
pub mod properties;
pub mod provenance;
pub mod registry;
pub mod rerun;
pub mod run;
pub mod seeds;
pub mod status;
pub mod templates;

/// The example of the document is compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/add-a-method.md")]
pub struct AddAMethod;
