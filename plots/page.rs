//! The page of a comparison: one file that opens offline, figures first, numbers under each.

use std::path::Path;

use minijinja::Environment;
use serde::Serialize;

use crate::PlotError;
use crate::canvas::{self, Canvas};

/// A whole page.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Page {
    /// Title.
    pub title: String,
    /// What the page shows, in a sentence or two.
    pub lead: Vec<String>,
    /// The command that makes it again.
    pub command: String,
    /// What comes first of all, before the scenes.
    pub opening: Vec<Block>,
    /// What goes before the scenes: the summary over all of them.
    pub summary: Vec<Block>,
    /// The scenes.
    pub scenes: Vec<SceneSection>,
    /// What holds for all scenes: how times were taken, how settings were chosen.
    pub fairness: Vec<Fact>,
    /// The machine.
    pub machine: Vec<Fact>,
}

/// A named statement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fact {
    /// Name.
    pub name: String,
    /// Statement.
    pub value: String,
}

impl Fact {
    /// A named statement.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Fact {
        Fact { name: name.into(), value: value.into() }
    }
}

/// What a page says about one scene.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct SceneSection {
    /// Name, used as the anchor too.
    pub name: String,
    /// Title.
    pub title: String,
    /// Where its parameters come from.
    pub source: String,
    /// Parameters.
    pub parameters: Vec<Fact>,
    /// Figures and tables.
    pub blocks: Vec<Block>,
    /// Whether it is not finished: its figures are not there as PNG yet.
    pub under_way: bool,
}

/// Figures and the tables under them.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Block {
    /// Heading.
    pub heading: String,
    /// Paragraphs before the figures.
    pub text: Vec<String>,
    /// Figures.
    pub figures: Vec<Figure>,
    /// Tables.
    pub tables: Vec<Table>,
    /// A list after the tables.
    pub list: Vec<String>,
}

/// A figure on a page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// The drawing.
    pub svg: String,
    /// Caption.
    pub caption: String,
    /// Path of the same drawing as a file, relative to the page and without its ending.
    pub file: String,
}

impl Figure {
    /// A drawing with its caption.
    pub fn new(canvas: &Canvas, caption: impl Into<String>, file: impl Into<String>) -> Figure {
        Figure { svg: canvas.svg(), caption: caption.into(), file: file.into() }
    }
}

/// A table on a page.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Table {
    /// Caption.
    pub caption: String,
    /// Column heads, units included.
    pub heads: Vec<String>,
    /// Rows of cells.
    pub rows: Vec<Vec<String>>,
    /// How many columns from the left are words.
    pub words: usize,
    /// File with the same numbers unrounded, relative to the page.
    pub csv: Option<String>,
}

/// Fills in the page.
fn render(page: &Page) -> Result<String, PlotError> {
    let mut environment = Environment::new();
    // The ending of the name switches escaping on.
    environment.add_template("report.html", include_str!("report.html"))?;
    Ok(environment.get_template("report.html")?.render(minijinja::value::Serde(page))?)
}

/// Writes the page.
///
/// # Errors
///
/// If it cannot be filled in or written.
pub fn write(page: &Page, path: &Path) -> Result<(), PlotError> {
    canvas::write(path, render(page)?.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_is_there_and_texts_are_escaped() {
        let table = |caption: &str| Table {
            caption: caption.into(),
            heads: vec!["method".into(), "time (s)".into()],
            rows: vec![vec!["<b>pd</b>".into(), "1.2".into()]],
            words: 1,
            csv: Some("comparison.csv".into()),
        };
        let names = ["Equal error", "Equal time", "Convergence", "Energy"];
        let blocks = names.map(|name| Block { heading: name.into(), tables: vec![table(name)], ..Block::default() });
        let scene = SceneSection {
            name: "s".into(),
            title: "a <script> & more".into(),
            blocks: blocks.into(),
            ..SceneSection::default()
        };
        let mut canvas = Canvas::new(100.0, 100.0, "a < b");
        canvas.text((1.0, 1.0), "5 < 6 & 7", 16.0, canvas::Align::Start);
        let figure = Figure::new(&canvas, "caption", "work_precision");
        let summary = vec![Block { figures: vec![figure], ..Block::default() }];
        let page = Page {
            title: "T".into(),
            command: "frazil compare \"x\"".into(),
            scenes: vec![scene],
            summary,
            ..Page::default()
        };
        let html = render(&page).unwrap_or_else(|error| error.to_string());
        for name in names {
            assert!(html.contains(&format!("<caption>{name}")), "{name}: {html}");
        }
        assert!(!html.contains("<script>") && html.contains("a &lt;script&gt; &amp; more"));
        assert!(html.contains("&lt;b&gt;pd&lt;") && html.contains("5 &lt; 6 &amp; 7"));
        assert!(html.contains("<svg") && html.contains("href=\"comparison.csv\""));
        assert!(
            !html.contains("http://")
                || html.matches("://").count() == html.matches("http://www.w3.org/2000/svg").count()
        );
    }
}
