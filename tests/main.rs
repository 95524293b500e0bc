//! One binary for all tests of the program.

mod bad_scenes;
mod broken_scenes;
mod bundled_scenes;
mod calibration;
mod command_line;
mod cracks;
mod documents;
mod ensembles;
mod extreme;
mod fields;
mod forecasts;
mod invariants;
mod moving;
mod order;
mod printed;
mod properties;
mod reductions;
mod references;
mod regions;
mod reproducibility;
mod seepage;
mod shells;
mod sketch;
mod stability;
mod steps_by_error;
mod wall_models;
