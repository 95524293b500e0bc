//! A study: a scene, and what each layout changes of it.

use std::error::Error;

use frazil_studies::failure::Failure;

use super::goals::{Critical, Design, Goal, Promise, Search};
use super::strata::Stratum;
use super::variants::{Ground, Layout, Role};

/// A study, with the rest of the program that its scenes come from.
pub struct Study<'a> {
    /// Short name: the file's stem or the bundled name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Where its parameters come from.
    pub source: String,
    /// Method, unless another is asked for.
    pub method: Option<String>,
    /// Frozen depth of the shaft (m), from which the load of the plant follows.
    pub depth: Option<f64>,
    /// Radius of the shaft (m), for sketches.
    pub shaft_radius: Option<f64>,
    /// What a wall must come to.
    pub design: Option<Design>,
    /// All layouts.
    pub layouts: Vec<Layout>,
    /// What is searched.
    pub search: Option<Search>,
    /// What is sought of each layout.
    pub critical: Option<Critical>,
    /// The error for which its spacing was chosen.
    pub error: Option<Promise>,
    /// What all layouts change.
    pub(super) ground: Ground<'a>,
}

impl Study<'_> {
    /// Those that are compared.
    pub fn compared(&self) -> impl Iterator<Item = &Layout> {
        self.layouts.iter().filter(|layout| layout.role == Role::Compared)
    }

    /// A layout with another value of a key.
    ///
    /// # Errors
    /// Where its scene is refused.
    pub fn changed(&self, of: &Layout, key: &str, value: &str) -> Result<Layout, Failure> {
        let (words, own) = (format!(", {key} = {value}"), vec![(key.to_owned(), value.to_owned())]);
        self.ground
            .again(of, &words, Role::Tried, own)
            .map_err(|failure| named(&format!("{}{words}", of.name), failure))
    }

    /// The layout with a value of the key that is searched, in each stratum.
    ///
    /// # Errors
    /// Where its scene is refused.
    pub fn tried(&self, search: &Search, value: f64) -> Result<Vec<Layout>, Failure> {
        let name = format!("{} = {value}", search.key);
        let text = if search.goal == Goal::Least { format!("{value}") } else { format!("{value:?}") };
        let layout = |at| {
            let own = vec![(search.key.clone(), text.clone())];
            self.ground.layout(&name, at, Role::Tried, own).map_err(|failure| named(&name, failure))
        };
        self.ground.places().map(layout).collect()
    }

    /// Depth (m) over which a layout takes heat.
    pub fn depth_of(&self, layout: &Layout) -> Option<f64> {
        layout.stratum.map_or(self.depth, |_| self.ground.stratum(layout.stratum).map(Stratum::thickness))
    }

    /// What the wall of a layout must come to.
    pub fn design_of(&self, layout: &Layout) -> Option<Design> {
        self.ground.stratum(layout.stratum).and_then(|stratum| stratum.design).or(self.design)
    }
}

/// What is wrong with a layout, with its name.
pub(super) fn named(layout: &str, cause: impl Into<Box<dyn Error + Send + Sync>>) -> Failure {
    Failure::of(format!("layout \"{layout}\""), cause)
}
