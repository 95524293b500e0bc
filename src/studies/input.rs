//! Files that a user names: text of a size that somebody may have written.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use frazil_record::shown;
use frazil_scene::MOST_BYTES;

use crate::failure::Failure;

/// What is no text.
#[derive(Debug, thiserror::Error)]
enum NoText {
    #[error("found more than {MOST_BYTES} bytes, must have at most as many")]
    Large,
    #[error("found the byte {0:#04x}, must be text in UTF-8")]
    Byte(u8),
}

/// The text of a file.
///
/// # Errors
/// Where it cannot be read, is larger than anything meant, or is no text, with its line.
pub fn text(path: &Path) -> Result<String, Failure> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(MOST_BYTES as u64 + 1).read_to_end(&mut bytes))
        .map_err(|error| Failure::file(path, "cannot be read", error))?;
    let file = path.display().to_string();
    if bytes.len() > MOST_BYTES {
        return Err(Failure::of(shown(&file), NoText::Large));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
        Failure::of(format!("{}:{line}", shown(&file)), NoText::Byte(error.as_bytes()[at]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_text_is_refused_with_its_place() {
        let folder = tempfile::tempdir().expect("a folder");
        let said = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).expect("written");
            let place = path.display().to_string();
            text(&path).map_err(|failure| failure.to_string().replace(&place, "file"))
        };
        assert_eq!(said("a", "title = \"лёд\"".as_bytes()), Ok("title = \"лёд\"".to_owned()));
        assert_eq!(
            said("b", b"a = 1\nb = \"\xff\"").expect_err("refused"),
            "file:2: found the byte 0xff, must be text in UTF-8"
        );
        assert_eq!(
            said("c", &vec![b'#'; MOST_BYTES + 1]).expect_err("refused"),
            "file: found more than 4000000 bytes, must have at most as many"
        );
        assert!(text(folder.path()).is_err());
    }
}
