//! Figures as files, drawn side by side: a picture takes some hundredths of a second.

use std::path::{Path, PathBuf};

use frazil_plots::PlotError;
use frazil_plots::canvas::{Canvas, Formats};

use crate::parallel;

/// Drawings that are to become files.
#[derive(Debug, Default)]
pub struct Figures {
    /// Folder, name without ending, and drawing.
    all: Vec<(PathBuf, String, Canvas)>,
}

impl Figures {
    /// Adds one that is to lie in a folder, by its name without ending.
    pub fn add(&mut self, folder: &Path, name: impl Into<String>, canvas: Canvas) {
        self.all.push((folder.to_owned(), name.into(), canvas));
    }

    /// Writes all, so many at once. The files do not depend on how many.
    ///
    /// # Errors
    /// The first that cannot be drawn or written, in the order in which they were added.
    pub fn write(&self, formats: Formats, threads: usize) -> Result<(), PlotError> {
        let write = |k: usize| {
            let (folder, name, canvas) = &self.all[k];
            Some(canvas.write(folder, name, formats))
        };
        parallel::in_order(self.all.len(), threads, write)
            .into_iter()
            .flatten()
            .try_for_each(|written| written.map(drop))
    }
}
