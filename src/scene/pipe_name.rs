//! Names of pipes.

use std::fmt;
use std::str::FromStr;

/// A pipe by its ring and its number on it. Both count from 0 here and from 1 in its name, which files and results share: pipe
/// 9 of ring 0 is `1.10`.
///
/// ```
/// use frazil_scene::PipeName;
/// assert_eq!("1.10".parse(), Ok(PipeName { ring: 0, pipe: 9 }));
/// assert_eq!(PipeName { ring: 0, pipe: 9 }.to_string(), "1.10");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct PipeName {
    /// Its ring, from 0.
    pub ring: usize,
    /// Its number on the ring, from 0.
    pub pipe: usize,
}

impl fmt::Display for PipeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.ring + 1, self.pipe + 1)
    }
}

/// A text that is no name of a pipe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("must be the name of a pipe as in results, its ring and its number on the ring, both from 1, such as \"1.10\"")]
pub struct NoPipeName;

impl FromStr for PipeName {
    type Err = NoPipeName;

    fn from_str(text: &str) -> Result<Self, NoPipeName> {
        // A pipe has one name: 1.1 and 1.01 are not both it.
        let number = |digits: &str| -> Option<usize> {
            let plain = digits.bytes().all(|byte| byte.is_ascii_digit()) && !digits.starts_with('0');
            digits.parse::<usize>().ok().filter(|_| plain)?.checked_sub(1)
        };
        let (ring, pipe) = text.split_once('.').ok_or(NoPipeName)?;
        Ok(PipeName { ring: number(ring).ok_or(NoPipeName)?, pipe: number(pipe).ok_or(NoPipeName)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pipe_has_one_name_and_none_counts_from_zero() {
        for pipe in (0..3).flat_map(|ring| (0..30).map(move |pipe| PipeName { ring, pipe })) {
            assert_eq!(pipe.to_string().parse(), Ok(pipe));
        }
        for text in
            ["0.1", "1.0", "1.01", "1", "3", "", ".", "1.", ".1", "+1.2", "1.1.1", "1. 2", "99999999999999999999.1"]
        {
            assert_eq!(text.parse::<PipeName>(), Err(NoPipeName), "{text}");
        }
    }
}
