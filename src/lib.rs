//! The program `frazil`: what a user runs, as functions.

pub mod answers;
pub mod calibrate;
pub mod campaign;
pub mod check;
pub mod cli;
pub mod compare;
pub mod ensemble;
pub mod expect;
pub mod failure;
pub mod fields;
pub mod interrupt;
pub mod layout;
pub mod list;
pub mod load;
pub mod machine;
pub mod output;
pub mod parallel;
pub mod progress;
pub mod properties;
pub mod registry;
pub mod run;
pub mod stability;
pub mod words;

/// The example of the document is compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/add-a-method.md")]
pub struct AddAMethod;
