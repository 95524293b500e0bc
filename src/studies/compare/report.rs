//! The page of a comparison: the answer, one chart, and what lies behind them.

mod answer;
mod chart;
mod measured;
mod numbers;
mod words;

use std::cell::Cell;
use std::path::Path;
use std::time::{Duration, Instant};

use frazil_plots::canvas::Formats;
use frazil_plots::comparison::work_precision_panels;
use frazil_plots::page::{self, Block, Fact, Figure, Page, SceneSection};
use frazil_plots::run::drawings;
use frazil_scene::names;

use super::analysis::{self, Study};
use super::curve::Clock;
use super::execute::SceneRuns;
use super::figures::{Cost, order_figure, work_figure};
use super::request::CompareRequest;
use crate::failure::Failure;
use crate::figures::Figures;
use crate::machine::Machine;
use crate::output::{make_folder, write_run_and};
use crate::{figure_options, parallel};
use numbers::{
    ensembles, equal_error_table, equal_time_table, failures, gates, order_table, overall, run_table, settings,
};
use words::{fairness, parameters};

/// Time between two pages of a scene that is under way.
const BETWEEN: Duration = Duration::from_secs(2);

/// The figures and the page of a comparison, which grow as it goes on.
pub struct Report<'a> {
    request: &'a CompareRequest,
    machine: &'a Machine,
    folder: &'a Path,
    /// What is said of each finished scene.
    sections: Vec<SceneSection>,
    /// When the page was last written with a scene under way.
    shown: Cell<Option<Instant>>,
}

impl<'a> Report<'a> {
    /// One that says nothing yet.
    pub fn new(request: &'a CompareRequest, machine: &'a Machine, folder: &'a Path) -> Self {
        Report { request, machine, folder, sections: Vec::new(), shown: Cell::new(None) }
    }

    /// Writes the figures of finished scenes that it has none of, and the page of all.
    ///
    /// # Errors
    /// Where a figure cannot be drawn or a file not be written.
    pub fn finish(&mut self, studies: &[Study]) -> Result<(), Failure> {
        let mut figures = Figures::default();
        for study in &studies[self.sections.len()..] {
            self.sections.push(section(self.folder, study, &mut figures)?);
        }
        let all: Vec<&Study> = studies.iter().collect();
        let overview = self.overview(&all, &mut figures);
        figures.write(Formats::ALL, parallel::cores())?;
        self.page(&all, studies, None, overview)
    }

    /// Writes what is known of a scene whose runs go on, with the page of those before it, unless that was done just now. Nothing
    /// runs meanwhile whose time would be told.
    ///
    /// # Errors
    /// Where a file cannot be written.
    pub fn show(&self, finished: &[Study], runs: &SceneRuns) -> Result<(), Failure> {
        if self.shown.get().is_some_and(|shown| shown.elapsed() < BETWEEN) {
            return Ok(());
        }
        let study = Study::of(runs.so_far());
        if study.comparisons.is_empty() {
            return Ok(());
        }
        let mut figures = Figures::default();
        let section = under_way(self.folder, &study, &mut figures)?;
        let all: Vec<&Study> = finished.iter().chain([&study]).collect();
        let overview = self.overview(&all, &mut figures);
        figures.write(Formats::SVG, parallel::cores())?;
        self.page(&all, finished, Some(section), overview)?;
        self.shown.set(Some(Instant::now()));
        Ok(())
    }

    /// The figure of all scenes side by side, which stands where scripts do not run.
    fn overview(&self, studies: &[&Study], figures: &mut Figures) -> Option<Figure> {
        let of = |study: &&Study| Some(work_figure(study, study.comparisons.first()?, Cost::Time(study.clock)));
        let panels: Vec<_> = studies.iter().filter_map(of).collect();
        let clock = studies.first().map(|study| Cost::Time(study.clock)).filter(|_| !panels.is_empty())?;
        let canvas = work_precision_panels(&panels);
        let figure = Figure::new(&canvas, caption(studies[0], clock), "work_precision");
        figures.add(self.folder, "work_precision", canvas);
        Some(figure)
    }

    /// Writes the page of the finished scenes, and of one that is under way.
    fn page(
        &self,
        all: &[&Study],
        finished: &[Study],
        current: Option<SceneSection>,
        overview: Option<Figure>,
    ) -> Result<(), Failure> {
        if all.is_empty() {
            return Ok(());
        }
        let answer = answer::table(all.iter().copied());
        let page = Page {
            title: "Which method reaches a given error soonest?".into(),
            answers: all.iter().filter_map(|study| answer::sentence(study)).collect(),
            lead: vec![
                "Each point below is one method at one particle spacing: how wrong it is, and how long it takes. Nearer to the \
                 lower left corner is better."
                    .into(),
            ],
            chart: chart::chart(all.iter().copied()),
            opening: vec![Block { figures: overview.into_iter().collect(), ..Block::default() }, answer],
            command: self.request.command_line.clone(),
            summary: if finished.len() > 1 { vec![overall(finished)] } else { Vec::new() },
            scenes: self.sections.iter().cloned().chain(current).collect(),
            fairness: if finished.is_empty() { Vec::new() } else { fairness(self.request, finished) },
            machine: self.machine.facts(Fact::new("Threads of a timed run", self.request.threads.to_string())),
            ..Page::default()
        };
        Ok(page::write(&page, &self.folder.join("report.html"))?)
    }
}

/// What is said of a finished scene.
fn section(folder: &Path, study: &Study, figures: &mut Figures) -> Result<SceneSection, Failure> {
    let own = folder.join(study.name());
    make_folder(&own)?;
    let mut blocks = compared(&own, study, ALL_COSTS, figures);
    if let Some((block, drawn)) = measured::block(study) {
        blocks.push(block);
        drawn.into_iter().for_each(|(file, canvas)| figures.add(&own, file, canvas));
    }
    blocks.push(run_table(study));
    let further = ensembles(study).into_iter().chain(finest_runs(&own, study)?).chain([gates(study)]);
    let further = further.chain(failures(study)).chain([settings(study)]);
    blocks.extend(further.map(|block| Block { folded: true, ..block }));
    Ok(SceneSection { blocks, parameters: parameters(study), ..headed(study) })
}

/// What is said of a scene whose runs go on.
fn under_way(folder: &Path, study: &Study, figures: &mut Figures) -> Result<SceneSection, Failure> {
    let own = folder.join(study.name());
    make_folder(&own)?;
    let text = "Under way: points, times and errors are those of the runs that have been made. Times of first runs are not warm.";
    let mut blocks = vec![Block { text: vec![text.into()], ..Block::default() }];
    // Which clock counts, and so what the figures by others are called, is known at the end.
    blocks.extend(compared(&own, study, 1, figures));
    blocks.push(run_table(study));
    Ok(SceneSection { blocks, svg_alone: true, ..headed(study) })
}

/// Name, title and source of a scene.
fn headed(study: &Study) -> SceneSection {
    let scene = &study.runs.scene;
    let (name, title, source) = (study.name().to_owned(), scene.title.clone(), scene.source.clone());
    SceneSection { name, title, source, ..SceneSection::default() }
}

/// The clock that counts, the other one, and particle updates.
const ALL_COSTS: usize = 3;

/// Errors against the first costs of all, and their convergence.
fn compared(own: &Path, study: &Study, costs: usize, figures: &mut Figures) -> Vec<Block> {
    let name = study.name();
    let mut blocks = Vec::new();
    for (k, comparison) in study.comparisons.iter().enumerate() {
        let word = comparison.headline.name();
        let (other, other_word) = if study.clock == Clock::Wall { (Clock::Cpu, "cpu") } else { (Clock::Wall, "wall") };
        let all: [_; ALL_COSTS] = [
            (Cost::Time(study.clock), format!("work_precision_{word}")),
            (Cost::Time(other), format!("work_precision_{word}_{other_word}")),
            (Cost::Updates, format!("work_precision_{word}_updates")),
        ];
        let mut block =
            Block { heading: format!("Error against cost: {}", comparison.headline.label()), ..Block::default() };
        for (place, (cost, file)) in all.iter().take(costs).cloned().enumerate() {
            let canvas = work_precision_panels(&[work_figure(study, comparison, cost)]);
            // The chart at the head of the page shows the first measure, and all costs: their drawings lie beside the page.
            if k > 0 && place == 0 {
                block.figures.push(Figure::new(&canvas, caption(study, cost), format!("{name}/{file}")));
            }
            figures.add(own, file, canvas);
        }
        block.tables.push(equal_error_table(comparison));
        block.tables.push(equal_time_table(comparison));
        if costs == ALL_COSTS {
            let link = |(cost, file): &(Cost, String)| {
                Fact::new(format!("Error against {}", cost.name()), format!("{name}/{file}.svg"))
            };
            block.links.extend(all.iter().map(link));
        }
        blocks.push(block);
        let file = format!("convergence_{word}");
        let canvas = order_figure(study, comparison);
        let caption = "Error against particle spacing. Hollow points lie below ten times the error of the \
                       reference: how far below their true error lies is not known.";
        blocks.push(Block {
            heading: format!("Convergence: {}", comparison.headline.label()),
            figures: vec![Figure::new(&canvas, caption, format!("{name}/{file}"))],
            tables: vec![order_table(study.runs.scene.units, comparison)],
            folded: true,
            ..Block::default()
        });
        figures.add(own, file, canvas);
    }
    blocks
}

fn caption(study: &Study, cost: Cost) -> String {
    let bars = "Bars upward: 95 % interval of the median, or the range where fewer than six runs were timed; bars \
                sideways: 95 % interval over seeds. Ringed points are lower than other runs lead to expect, perhaps by chance, and do \
                not count.";
    match cost {
        Cost::Updates => "The same errors against particle updates, which no machine and no load changes.".into(),
        Cost::Time(clock) if clock == study.clock => format!("{bars} Setup is part of the time."),
        Cost::Time(Clock::Cpu) => "The same errors against the CPU time of the process.".into(),
        Cost::Time(Clock::Wall) => "The same errors against wall time, on a machine that was not quiet.".into(),
    }
}

fn finest_runs(folder: &Path, study: &Study) -> Result<Vec<Block>, Failure> {
    let scene = &study.runs.scene;
    let mut blocks = Vec::new();
    for same in analysis::group(&study.runs.measured) {
        let Some((one, result)) =
            same.iter().rev().find_map(|one| Some((one, one.result.as_ref().filter(|_| one.is_ok())?)))
        else {
            continue;
        };
        let key = names::of(&format!("{}_{}", one.method, one.setting.name.replace('=', "-")));
        let own = folder.join(&key);
        make_folder(&own)?;
        let all = drawings(result, &figure_options::of_run(scene, &result.fields));
        let last_map = all.iter().rposition(|(file, _)| file.starts_with("map_"));
        let mut block = Block { heading: format!("{} at {}", one.label(), one.spacing_words()), ..Block::default() };
        let mut figures = Figures::default();
        for (k, (file, canvas)) in all.into_iter().enumerate() {
            if !file.starts_with("map_") || last_map == Some(k) {
                let path = format!("{}/{key}/{file}", study.name());
                block.figures.push(Figure::new(&canvas, canvas.title.clone(), path));
            }
            figures.add(&own, file, canvas);
        }
        write_run_and(&own, result, || Ok(figures.write(Formats::ALL, parallel::cores())?))?;
        if !block.figures.is_empty() {
            blocks.push(block);
        }
    }
    Ok(blocks)
}
