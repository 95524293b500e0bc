//! How pairs exchange heat.

/// How a pair exchanges heat.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exchange {
    /// The difference of the conduction potential.
    Potential,
    /// A mean of the two conductivities times the difference of temperature.
    Mean(Mean),
    /// The conductivity of the end from which it flows, times the difference of temperature.
    Upstream,
}

/// A mean of two conductivities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mean {
    /// 2ab/(a+b).
    Harmonic,
    /// (a+b)/2.
    Arithmetic,
    /// sqrt(ab).
    Geometric,
}

impl Mean {
    /// All of them with the words of files.
    pub const WORDS: [(&str, Mean); 3] =
        [("harmonic", Mean::Harmonic), ("arithmetic", Mean::Arithmetic), ("geometric", Mean::Geometric)];
}
