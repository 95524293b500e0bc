//! What instruments measured, beside the finest run of each method: how far each is off, and what the instruments leave open.

use frazil_plots::measured::{Named, drawing};
use frazil_plots::page::{Block, Figure, Table};
use frazil_plots::style::{number, percent};
use frazil_record::{MeasuredErrors, RunResult};

use crate::compare::analysis::{self, Study};
use crate::compare::measured::Measured;
use crate::{answers, figure_options};

/// The block of a scene that has measured points, and its figure with its name.
pub(super) fn block(study: &Study) -> Option<(Block, Option<(String, frazil_plots::canvas::Canvas)>)> {
    let finest: Vec<(&Measured, &RunResult)> = analysis::group(&study.runs.measured)
        .into_iter()
        .filter_map(|same| {
            same.into_iter().rev().find_map(|one| Some((one, one.result.as_ref().filter(|_| one.is_ok())?)))
        })
        .filter(|(_, result)| !result.record.measured.is_empty())
        .collect();
    let scene = &study.runs.scene;
    let rows: Vec<Vec<String>> = finest
        .iter()
        .flat_map(|(one, result)| result.record.measured.iter().map(move |(name, found)| (one, name, found)))
        .map(|(one, name, found)| row(study, one, name, found))
        .collect();
    if rows.is_empty() {
        return None;
    }
    let names: Vec<Named<'_>> = finest.iter().map(|(one, result)| (one.label(), *result)).collect();
    let drawn = drawing(&names, &figure_options::of(scene, &[]));
    let file = format!("{}/measured", study.name());
    let figures = drawn.iter().map(|canvas| {
        Figure::new(
            canvas,
            "Measured points with bars of one standard deviation, and the finest run of each method.",
            &*file,
        )
    });
    let table = Table {
        caption: "The finest run of each method against the measured points. A run that is right is off by about one standard \
                  deviation (rms), with two thirds of the points within one and 95 % within two."
            .into(),
        heads: ["method", "spacing", "measured", "off, rms", "standard deviation", "off, in standard deviations", "off, at most", "within one", "within two", "points"]
            .map(String::from)
            .to_vec(),
        rows,
        words: 3,
        csv: None,
    };
    let block = Block {
        heading: "Against what was measured".into(),
        text: floors(study),
        figures: figures.collect(),
        tables: vec![table],
        ..Block::default()
    };
    Some((block, drawn.map(|canvas| ("measured".into(), canvas))))
}

/// What the instruments leave open, by measure.
fn floors(study: &Study) -> Vec<String> {
    let floor = |comparison: &analysis::Comparison| {
        let (headline, error) = (comparison.headline, study.runs.reference_error(comparison.headline)?);
        Some(format!(
            "The standard deviation of the instruments is {} in the {}: errors that differ by less do not rank methods, and one \
             below it shows only that the method agrees with the measurement.",
            percent(error, 2),
            headline.label().trim_start_matches("rms ")
        ))
    };
    study.comparisons.iter().filter_map(floor).collect()
}

fn row(study: &Study, one: &Measured, quantity: &str, found: &MeasuredErrors) -> Vec<String> {
    let (title, with) = answers::quantity(&study.runs.scene, quantity);
    let reached = if found.missing > 0 { format!(", {} not reached", found.missing) } else { String::new() };
    vec![
        one.label(),
        one.spacing_words(),
        title.into(),
        with(found.rms),
        with(found.sd_rms),
        number(found.rms_over_sd, 3),
        with(found.max),
        percent(found.within_sd, 2),
        percent(found.within_2sd, 2),
        format!("{}{reached}", found.points),
    ]
}
