//! The page of a study: layouts beside each other, figures first.

use frazil_plots::page::{self, Block, Fact, Page, Table};

use super::execute::Work;
use super::study::{Role, Study};
use super::{Found, LayoutRequest, tables};
use crate::failure::Failure;
use crate::machine::Machine;

/// Writes figures and page.
pub(super) fn write(
    request: &LayoutRequest,
    study: &Study,
    work: &Work<'_>,
    found: &[Found<'_>],
) -> Result<(), Failure> {
    let compared: Vec<&Found<'_>> = found.iter().filter(|one| one.layout.role == Role::Compared).collect();
    let mut page = Page {
        title: study.title.clone(),
        lead: vec![format!(
            "{} of freeze pipes under the method {}, from the scene {}. A gap is closed once ground between two pipes is frozen \
             with its latent heat released; the wall once a closed loop of such gaps runs around the centre.",
            if compared.len() == 1 { "One layout".to_owned() } else { format!("{} layouts", compared.len()) },
            work.method,
            study.scene
        )],
        command: request.command_line.clone(),
        machine: Machine::now().facts(Fact::new("Layouts at once", work.threads.to_string())),
        ..Page::default()
    };
    page.summary.push(Block {
        heading: "Layouts beside each other".into(),
        tables: vec![overview(study, &compared)],
        ..Block::default()
    });
    page.fairness = assumptions(study, &compared);
    Ok(page::write(&page, &work.folder.join("report.html"))?)
}

/// A number, or what stands in its place.
fn cell(value: Option<f64>, digits: usize, none: &str) -> String {
    value.map_or_else(|| none.to_owned(), |value| format!("{value:.digits$}"))
}

/// A number and how far off it may be.
fn with_error(value: Option<f64>, error: Option<f64>, digits: usize, none: &str) -> String {
    let error = value.and(error).map_or(String::new(), |error| format!(" ± {error:.digits$}"));
    format!("{}{error}", cell(value, digits, none))
}

/// A row for each layout: what is asked first.
fn overview(study: &Study, compared: &[&Found<'_>]) -> Table {
    let mut heads: Vec<String> = [
        "layout",
        "weakest gap",
        "pipes",
        "wall closes (day)",
        "first gap (day)",
        "thickness at the end (m)",
        "mean temperature (°C)",
        "load, greatest (W/m)",
        "load at the end (W/m)",
        "energy (MJ/m)",
    ]
    .map(String::from)
    .into();
    if let Some(design) = study.design {
        heads.push(format!("{} m at {} °C (day)", design.thickness_m, design.mean_temperature_c));
    }
    if study.depth.is_some() {
        heads.push("plant, greatest (kW)".into());
    }
    let row = |one: &&Found<'_>| {
        let (fine, coarse) = (&one.fine, one.coarse.as_ref());
        let (end, far) = (fine.days.last(), coarse.and_then(|coarse| coarse.days.last()));
        let off = |own: Option<f64>, other: Option<f64>| own.zip(other).map(|(own, other)| (own - other).abs());
        let thickness = end.map(|day| day.thickness_interface_m);
        let mean = end.and_then(|day| day.mean_c);
        let weakest = fine
            .weakest
            .as_ref()
            .map_or("none".into(), |link| format!("{} to {}, {:.2} m", link.from, link.to, link.distance_m));
        let mut cells = vec![
            one.layout.name.clone(),
            weakest,
            fine.pipes.to_string(),
            with_error(fine.closure, tables::closure_error(one), 2, "not closed"),
            cell(fine.first_gap, 2, "none"),
            with_error(thickness, off(thickness, far.map(|day| day.thickness_interface_m)), 2, ""),
            with_error(mean, off(mean, far.and_then(|day| day.mean_c)), 2, ""),
            format!("{:.0}", fine.peak),
            cell(end.map(|day| day.heat_per_pipe_w_per_m * fine.pipes as f64), 0, ""),
            cell(end.map(|day| day.energy_mj_per_m), 0, ""),
        ];
        if study.design.is_some() {
            cells.push(cell(fine.design, 1, "not reached"));
        }
        if let Some(depth) = study.depth {
            cells.push(format!("{:.0}", 1e-3 * depth * fine.peak));
        }
        cells
    };
    Table {
        caption:
            "± is the change from twice the spacing, not a bound. Thickness on the plane between two pipes; loads and \
                  energy by metre of depth, greatest after the first day."
                .into(),
        heads,
        rows: compared.iter().map(row).collect(),
        words: 2,
        csv: Some("layouts.csv".into()),
    }
}

/// What holds for all layouts, and which part of the plan each was run on.
fn assumptions(study: &Study, compared: &[&Found<'_>]) -> Vec<Fact> {
    let mut facts = vec![
        Fact::new("Source", study.source.clone()),
        Fact::new("Pipes", "circles of their true radius, held at the temperature of their outer wall"),
    ];
    for one in compared {
        facts.push(Fact::new(one.layout.name.clone(), format!("run on {}", one.layout.sector)));
        if let Some((mean, heat)) = one.fine.formula {
            let end = one.fine.days.last();
            facts.push(Fact::new(
                format!("{}, checked", one.layout.name),
                format!(
                    "mean temperature {} °C and {} W/m a pipe at the end; the steady ring in closed form with the same fronts \
                     has {mean:.2} °C and {heat:.1} W/m",
                    cell(end.and_then(|day| day.mean_c), 2, "none"),
                    cell(end.map(|day| day.heat_per_pipe_w_per_m), 1, "none"),
                ),
            ));
        }
        if let Some(reason) = &one.pair.refused {
            facts.push(Fact::new(format!("{}, error", one.layout.name), format!("not known: {reason}")));
        }
    }
    facts
}
