//! The one way in which results become files: whole, or not at all.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use tempfile::Builder;

/// What the names of files and folders begin with that are still being made: whoever finds one of a run that is over may remove it.
pub const UNFINISHED: &str = ".frazil-";

/// Writes a file beside its place and moves it there when it is whole, so that no reader sees half of it.
///
/// # Errors
///
/// If the file cannot be written; what stood in its place stays.
pub fn write_whole(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let unfinished = Builder::new().prefix(UNFINISHED).tempfile_in(folder)?;
    let mut writer = BufWriter::new(unfinished);
    fill(&mut writer)?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    // Temporary files are for their owner only; results are for everybody.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644))?;
    }
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_file_that_fails_half_way_leaves_the_old_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("record.json");
        write_whole(&path, |writer| writer.write_all(b"old")).expect("written");
        let failed = write_whole(&path, |writer| {
            writer.write_all(b"half")?;
            Err(io::Error::other("stopped"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read_to_string(&path).expect("the file"), "old");
        assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1);
    }
}
