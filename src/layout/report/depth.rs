//! The shaft over its depth.

use frazil_plots::canvas::Formats;
use frazil_plots::page::{Block, Figure, Table};
use frazil_studies::failure::Failure;

use crate::execute::Work;
use crate::found::Found;
use crate::rows::{cell, designed_on, stood, with_error};
use crate::shaft::{ShaftRow, shafts};
use crate::study::Study;

/// Layouts over their strata, and what the shaft as a whole comes to.
pub(super) fn over_depth(study: &Study<'_>, work: &Work<'_>, found: &[Found<'_>]) -> Result<Option<Block>, Failure> {
    let all = shafts(study, found);
    let compared: Vec<_> = all.iter().filter(|shaft| shaft.compared()).collect();
    if compared.is_empty() {
        return Ok(None);
    }
    let views: Vec<_> = compared.iter().map(|shaft| shaft.view(study)).collect();
    let drawing = frazil_plots::layouts::over_depth(&views);
    drawing.write(&work.folder, "depth", Formats::ALL)?;
    let caption = "Each stratum of the layouts; boreholes are read at the depth that stands in the table of strata.";
    let figures = vec![Figure::new(&drawing, caption, "depth")];
    let heads =
        ["layout", "last to close", "wall closes (day)", "thinnest (m)", "warmest mean (°C)", "plant, greatest (kW)"];
    let heads = heads.into_iter().chain(["plant at the end (kW)", "energy (GJ)"]).map(String::from);
    let designed = study.layouts.iter().any(|layout| study.design_of(layout).is_some());
    let heads = heads.chain(designed.then(|| "as designed (day)".into())).collect();
    let row = |row: &ShaftRow<'_>| {
        let mut cells = vec![
            row.layout.to_owned(),
            row.weakest_stratum.to_owned(),
            stood(
                with_error(row.closure_days, row.closure_error_days, 2, &format!("{} strata open", row.open_strata)),
                row.reopened_days,
            ),
            format!("{:.2} in {}", row.thickness_weakest_m, row.thinnest_stratum),
            match row.warmest_stratum {
                Some(stratum) => format!("{} in {stratum}", cell(row.temperature_weakest_c, 2, "none")),
                None => "none".into(),
            },
            cell(row.plant_peak_kw, 0, "none"),
            format!("{:.0}", row.plant_end_kw),
            format!("{:.0}", row.energy_gj),
        ];
        cells.extend(designed.then(|| designed_on(row.design_days, row.design_left_days)));
        cells
    };
    let rows: Vec<ShaftRow<'_>> = compared.iter().filter_map(|shaft| shaft.row(study, found)).collect();
    let shafts = Table {
        caption: "The shaft as a whole: closed once it is in all strata; thickness and mean temperature where the wall is weakest; loads \
                  are sums over the layers, the greatest as the mean of a day after the first. ± is the change from twice the spacing."
            .into(),
        heads,
        rows: rows.iter().map(row).collect(),
        words: 2,
        csv: Some("shafts.csv".into()),
    };
    let strata = Table {
        caption: "Strata.".into(),
        heads: ["stratum", "from (m)", "to (m)", "boreholes read at (m)"].map(String::from).into(),
        rows: study
            .ground
            .strata
            .iter()
            .map(|stratum| {
                let depths = [stratum.from, stratum.to, stratum.depth].map(|depth| depth.to_string());
                [vec![stratum.name.clone()], depths.into()].concat()
            })
            .collect(),
        words: 1,
        csv: None,
    };
    let heading = "The shaft over its depth".into();
    Ok(Some(Block { heading, figures, tables: vec![shafts, strata], ..Block::default() }))
}
