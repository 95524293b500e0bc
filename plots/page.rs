//! The page of a report: one file that opens offline, the answer first, then figures with their numbers.
//!
//! Scripts are part of the page and allowed by their hashes alone, so a text of a user that looked like one would not run. The page
//! says the same without them: drawings stand where the chart would.

use std::path::Path;

use base64::Engine;
use sha2::{Digest, Sha256};

use minijinja::Environment;
use serde::Serialize;

use crate::PlotError;
use crate::canvas::{self, Canvas};
use crate::chart::Chart;
use crate::layouts::Days;

/// A whole page.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Page {
    /// Title.
    pub title: String,
    /// What the page shows, in a sentence or two.
    pub lead: Vec<String>,
    /// What came out, a sentence each.
    pub answers: Vec<String>,
    /// The interactive chart, in the place of the first figures of the opening.
    pub chart: Option<Chart>,
    /// The plans of layouts day by day, before the opening.
    pub plan: Option<Days>,
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
    /// Whether its figures are there as SVG alone.
    pub svg_alone: bool,
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
    /// Pages and drawings beside this one, after the text: what they are called, and their files.
    pub links: Vec<Fact>,
    /// A list after the tables.
    pub list: Vec<String>,
    /// Whether only its heading is seen until it is asked for.
    pub folded: bool,
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

/// The chart library, as it was published.
const LIBRARY: &str = include_str!("vendor/uplot/uPlot.iife.min.js");
/// Its look.
const LIBRARY_STYLE: &str = include_str!("vendor/uplot/uPlot.min.css");
/// The chart of a comparison.
const CHART: &str = include_str!("page/chart.js");
/// The plans of layouts day by day.
const PLAN: &str = include_str!("page/plan.js");
/// Sorting, light and dark.
const PAGE: &str = include_str!("page/page.js");

/// What the page runs, and what allows that and nothing else.
#[derive(Serialize)]
struct Scripts {
    /// Scripts in their order.
    texts: Vec<&'static str>,
    /// Their hashes as a policy names them.
    policy: String,
    /// Look of the chart.
    style: &'static str,
    /// What the chart shows, as JSON that ends no element.
    data: Option<String>,
    /// What the plans show.
    plan: Option<String>,
}

impl Scripts {
    fn of(page: &Page) -> Result<Self, PlotError> {
        let chart = page.chart.is_some().then_some([LIBRARY, CHART]).into_iter().flatten();
        let texts: Vec<&str> = chart.chain(page.plan.is_some().then_some(PLAN)).chain([PAGE]).collect();
        let hash = |text: &&str| base64::engine::general_purpose::STANDARD.encode(Sha256::digest(text.as_bytes()));
        let policy: Vec<String> = texts.iter().map(|text| format!("'sha256-{}'", hash(text))).collect();
        let data = page.chart.as_ref().map(Chart::json).transpose()?;
        let plan = page.plan.as_ref().map(Days::json).transpose()?;
        let style = if data.is_some() { LIBRARY_STYLE } else { "" };
        Ok(Scripts { texts, policy: policy.join(" "), style, data, plan })
    }
}

/// Fills in the page.
fn render(page: &Page) -> Result<String, PlotError> {
    #[derive(Serialize)]
    struct Filled<'a> {
        #[serde(flatten)]
        page: &'a Page,
        scripts: Scripts,
    }
    let mut environment = Environment::new();
    // The ending of the name switches escaping on.
    environment.add_template("report.html", include_str!("report.html"))?;
    let filled = Filled { page, scripts: Scripts::of(page)? };
    Ok(environment.get_template("report.html")?.render(minijinja::value::Serde(filled))?)
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
    use crate::chart::ChartScene;

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
        let named = ChartScene { title: "</script><script>alert(1)</script>".into(), ..ChartScene::default() };
        let page = Page {
            title: "T".into(),
            command: "frazil compare \"x\"".into(),
            chart: Some(Chart { scenes: vec![named] }),
            scenes: vec![scene],
            summary,
            ..Page::default()
        };
        let html = render(&page).unwrap_or_else(|error| error.to_string());
        for name in names {
            assert!(html.contains(&format!("<p class=\"caption\">{name}")), "{name}: {html}");
        }
        // The library, the chart and the page itself; what a scene is called ends none of them.
        assert_eq!(html.matches("<script>").count(), 3);
        assert_eq!(html.matches("</script>").count(), 4);
        assert!(!html.contains("alert(1)</script>") && html.contains("a &lt;script&gt; &amp; more"));
        assert!(html.contains("&lt;b&gt;pd&lt;") && html.contains("5 &lt; 6 &amp; 7"));
        assert!(html.contains("<svg") && html.contains("href=\"comparison.csv\""));
        // The names of a vocabulary and of a library, neither of which is asked for.
        let known = ["http://www.w3.org/2000/svg", "https://github.com/leeoniya/uPlot"];
        let count: usize = known.iter().map(|address| html.matches(address).count()).sum();
        assert_eq!(html.matches("://").count(), count);
    }

    /// The library is what its authors published: `npm pack uplot@1.6.32` gives the same file.
    #[test]
    fn the_chart_library_is_as_it_was_published() {
        let hash =
            |text: &str| Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        assert_eq!(hash(LIBRARY), "19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f");
        assert_eq!(hash(LIBRARY_STYLE), "df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04");
    }
}
