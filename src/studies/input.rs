//! Files that are given to the program.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use frazil_scene::MOST_BYTES;

use crate::failure::Failure;

/// A file that is no scene and no study by its size alone.
#[derive(Debug, thiserror::Error)]
#[error("found more than {MOST_BYTES} bytes, must have at most as many")]
struct TooLarge;

/// The text of a file, of which no more is read than a scene may have.
///
/// # Errors
/// Where it cannot be read, or is longer.
pub fn text(path: &Path) -> Result<String, Failure> {
    let failed = |error| Failure::file(path, "cannot be read", error);
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(failed)?;
    file.take(MOST_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() > MOST_BYTES {
        return Err(failed(io::Error::other(TooLarge)));
    }
    String::from_utf8(bytes).map_err(|_| failed(io::Error::other("stream did not contain valid UTF-8")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_without_an_end_is_refused() {
        for file in ["/dev/zero", "/dev/urandom"].map(Path::new).into_iter().filter(|file| file.exists()) {
            let refused = text(file).expect_err("no scene").to_string();
            assert!(refused.ends_with("must have at most as many"), "{refused}");
        }
    }
}
