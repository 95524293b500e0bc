//! Runs that are refused before their first step.

/// A run that was refused before its first step.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{reason}")]
pub struct Refused {
    /// Why, in words that name the setting and what is allowed.
    pub reason: String,
}

pub(crate) fn refuse(reason: impl ToString) -> Refused {
    Refused { reason: reason.to_string() }
}
