//! Scenes by name, exact solutions and reference tables.

pub mod scenes;
