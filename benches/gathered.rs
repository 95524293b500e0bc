//! What a command has left in a folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Adds all files in a folder and its folders, and folders in which there is nothing.
///
/// # Errors
/// A folder that cannot be read.
pub fn gather(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    let before = files.len();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() { gather(&path, files)? } else { files.push(path) }
    }
    if files.len() == before {
        files.push(folder.to_owned());
    }
    Ok(())
}
