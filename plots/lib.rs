//! Figures and pages from records: never a particle.
//!
//! A [`canvas::Canvas`] holds a drawing, of which an SVG is written and, where one is asked for, a PNG that shows the same.

use std::path::PathBuf;

pub mod axes;
pub mod calibration;
pub mod canvas;
pub mod chart;
pub mod comparison;
pub mod convergence;
pub mod ensemble;
mod flow_map;
mod grid;
pub mod ground_plan;
pub mod layouts;
pub mod map;
pub mod measured;
pub mod moisture_map;
mod moisture_profiles;
pub mod movie;
pub mod page;
mod pdf;
mod png;
pub mod properties;
pub mod rings;
pub mod run;
mod sheet;
pub mod signed;
pub mod stability;
mod stream;
pub mod style;
mod svg;
pub mod sweep;
mod table;
pub mod words;

pub use run::{frame, run_figures};
pub use words::FigureOptions;

/// A figure or page that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    /// The built-in font was refused.
    #[error("the built-in font could not be used")]
    Font,
    /// A picture could not be encoded.
    #[error("cannot encode a picture: {0}")]
    Encode(Box<dyn std::error::Error + Send + Sync>),
    /// A file could not be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The page could not be filled in.
    #[error("cannot fill in the page: {0}")]
    Page(#[from] minijinja::Error),
    /// What its chart shows could not be written down.
    #[error("cannot fill in the page: {0}")]
    Chart(#[from] serde_json::Error),
}
