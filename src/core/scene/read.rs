//! Reading scene files.

/// A problem in a scene file.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {}

/// All problems of a scene file.
#[derive(Debug, Clone, PartialEq)]
pub struct Problems(pub Vec<Problem>);

/// A table of a scene file that is being read.
pub struct Section<'a> {
    marker: std::marker::PhantomData<&'a ()>,
}
