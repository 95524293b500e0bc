//! Formulas of place and time.
//!
//! They are read and evaluated here and not by a package: their functions must give the same bits on every machine, and mistakes are
//! told with their column.

mod over_time;
mod parse;
mod sampled;

use std::fmt;
use std::sync::Arc;

pub use over_time::{MOST_TURNS, OverTime};
pub use parse::Mistake;
pub use sampled::{Extremes, Sample};

/// A place (m) and a time (s): x, y, t; in bodies of shells r, z, t.
pub type Coordinates = [f64; 3];

/// Index of x, and in bodies of shells of r, in [`Coordinates`].
pub const X: usize = 0;
/// Index of y, and in bodies of shells of z.
pub const Y: usize = 1;
/// Index of the time.
pub const TIME: usize = 2;

/// A formula of some of the [`Coordinates`].
#[derive(Clone)]
pub struct Formula {
    text: Arc<str>,
    root: Arc<Node>,
}

/// A part of a formula with a value.
enum Node {
    Number(f64),
    Coordinate(usize),
    One(fn(f64) -> f64, Box<Node>),
    Two(fn(f64, f64) -> f64, Box<[Node; 2]>),
}

impl Node {
    fn at(&self, coordinates: &Coordinates) -> f64 {
        match self {
            Node::Number(number) => *number,
            Node::Coordinate(index) => coordinates[*index],
            Node::One(function, argument) => function(argument.at(coordinates)),
            Node::Two(function, arguments) => function(arguments[0].at(coordinates), arguments[1].at(coordinates)),
        }
    }

    fn uses(&self, index: usize) -> bool {
        match self {
            Node::Number(_) => false,
            Node::Coordinate(own) => *own == index,
            Node::One(_, argument) => argument.uses(index),
            Node::Two(_, arguments) => arguments.iter().any(|argument| argument.uses(index)),
        }
    }
}

impl Formula {
    /// Reads a formula, in which each of `names` is the coordinate of an index.
    ///
    /// ```
    /// use frazil_core::formula::{Formula, X};
    /// let formula = Formula::read("10 + 5*cos(pi*x)", &[("x", X)]).map(|formula| formula.at(&[1.0, 0.0, 0.0]));
    /// assert_eq!(formula, Ok(5.0));
    /// ```
    ///
    /// # Errors
    /// Where the text is none.
    pub fn read(text: &str, names: &[(&'static str, usize)]) -> Result<Formula, Mistake> {
        let root = parse::parse(text, names)?;
        Ok(Formula { text: text.into(), root: Arc::new(root) })
    }

    /// Its value.
    pub fn at(&self, coordinates: &Coordinates) -> f64 {
        self.root.at(coordinates)
    }

    /// Whether the coordinate of an index occurs in it.
    pub fn uses(&self, index: usize) -> bool {
        self.root.uses(index)
    }

    /// How it was written.
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// Formulas are the same that are written the same.
impl PartialEq for Formula {
    fn eq(&self, other: &Formula) -> bool {
        self.text == other.text
    }
}

impl fmt::Debug for Formula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.text)
    }
}
