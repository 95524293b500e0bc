//! The program `frazil`: what a user runs, as functions.

pub mod check;
pub mod cli;
pub mod compare;
pub mod list;
pub mod output;
pub mod registry;
pub mod run;
