//! A row for each layout.

use frazil_plots::page::Table;

use crate::found::Found;
use crate::goals::Design;
use crate::rows::{cell, designed_on, stood, with_error};
use crate::study::Study;
use crate::{reference, tables};

/// When a wall closed, how sure that is, and that it opened again.
fn closed(one: &Found<'_>) -> String {
    let day = with_error(one.fine.closure, tables::closure_error(one), 2, "not closed");
    stood(day + &tables::in_doubt(one), one.fine.reopening)
}

/// A row for each layout: what is asked first.
pub(super) fn overview(study: &Study<'_>, method: &str, compared: &[&Found<'_>]) -> Table {
    let mut heads: Vec<String> = [
        "layout",
        "weakest gap",
        "pipes",
        "wall closes (day)",
        "first gap (day)",
        "thickness at the end (m)",
        "mean temperature there (°C)",
        "thickness, mean over the ring (m)",
        "all frozen ground, mean (°C)",
        "load, greatest (W/m)",
        "load at the end (W/m)",
        "energy (MJ/m)",
    ]
    .map(String::from)
    .into();
    let designs: Vec<Option<Design>> = compared.iter().map(|one| study.design_of(one.layout)).collect();
    let designed = designs.iter().flatten().next();
    if let Some(design) = designed {
        let alike = designs.iter().all(|own| own.as_ref() == Some(design));
        let words = format!("{} m at {} °C (day)", design.thickness_m, design.mean_temperature_c);
        heads.push(if alike { words } else { "as designed (day)".into() });
    }
    let single = |one: &&Found<'_>| one.layout.scene.rings.iter().any(|ring| ring.one_particle);
    let acting = compared.iter().any(single);
    if acting {
        heads.push("pipes act as (mm)".into());
    }
    if compared.iter().any(|one| study.depth_of(one.layout).is_some()) {
        heads.push("plant, greatest (kW)".into());
    }
    let row = |one: &&Found<'_>| {
        let (fine, coarse) = (&one.fine, one.coarse.as_ref());
        let (end, far) = (fine.days.last(), coarse.and_then(|coarse| coarse.days.last()));
        let thickness = end.map(|day| day.thickness_weakest_m);
        let mean = end.and_then(|day| day.temperature_weakest_c);
        let weakest = fine
            .weakest
            .as_ref()
            .map_or("none".into(), |link| format!("{} to {}, {:.2} m", link.from, link.to, link.distance_m));
        let mut cells = vec![
            one.layout.name.clone(),
            weakest,
            fine.pipes.to_string(),
            closed(one),
            cell(fine.first_gap, 2, "none"),
            with_error(thickness, tables::error(thickness, far.map(|day| day.thickness_weakest_m)), 2, ""),
            with_error(mean, tables::error(mean, far.and_then(|day| day.temperature_weakest_c)), 2, "open"),
            cell(end.and_then(|day| day.thickness_interface_mean_m), 2, ""),
            cell(end.and_then(|day| day.mean_c), 2, "none"),
            cell(fine.peak(), 0, "none"),
            cell(end.map(|day| day.heat_per_pipe_w_per_m * fine.pipes as f64), 0, ""),
            cell(end.map(|day| day.energy_mj_per_m), 0, ""),
        ];
        if designed.is_some() {
            cells.push(designed_on(fine.design, fine.design_left));
        }
        if acting {
            cells.push(format!("{:.3}", 1e3 * reference::effective_radius(&one.layout.scene, method)));
        }
        if let Some(depth) = study.depth_of(one.layout) {
            cells.push(cell(fine.peak().map(|peak| 1e-3 * depth * peak), 0, "none"));
        }
        cells
    };
    Table {
        caption:
            "± is the change from twice the spacing, not a bound. Thickness is the frozen length on the least frozen way through the wall, at the \
             weakest gap, 0 while it is open, and the mean temperature is that on this way; means over planes midway between pipes and of \
             all frozen ground stand beside them. Loads and energy by metre of depth; the greatest load is the greatest mean of a day, after the first."
                .into(),
        heads,
        rows: compared.iter().map(row).collect(),
        words: 2,
        csv: Some("layouts.csv".into()),
    }
}
