//! What changes of one key and deviating boreholes do.

use frazil_plots::page::{Block, Table};

use crate::found::Found;
use crate::rows::{cell, signed};
use crate::study::Study;
use crate::tables;

/// What changes of one key and deviating boreholes do.
pub(super) fn what_if(study: &Study<'_>, found: &[Found<'_>]) -> Vec<Block> {
    let mut blocks = Vec::new();
    let changes: Vec<_> = found.iter().filter_map(|one| tables::change(found, one)).collect();
    if !changes.is_empty() {
        let row = |row: &tables::SensitivityRow<'_>| {
            vec![
                row.layout.to_owned(),
                row.key.to_owned(),
                format!("{:.2}", row.factor),
                cell(row.closure_days, 2, "not closed"),
                signed(row.closure_change_days, 2),
                signed(row.thickness_change_m, 2),
                signed(row.mean_temperature_change_k, 2),
                signed(row.energy_change_mj_per_m, 0),
            ]
        };
        let heads =
            ["layout", "key", "factor", "wall closes (day)", "closure (d)", "thickness (m)", "mean temperature (K)"];
        let heads = heads.into_iter().chain(["energy (MJ/m)"]).map(String::from).collect();
        let caption = "Changes against the layout itself; thickness and temperature where the wall is weakest, and energy, at the end.".into();
        let csv = Some("sensitivity.csv".into());
        let table = Table { caption, heads, rows: changes.iter().map(row).collect(), words: 2, csv };
        blocks.push(Block { heading: "Sensitivity".into(), tables: vec![table], ..Block::default() });
    }
    let spreads = tables::spreads(study, found);
    if !spreads.is_empty() {
        let row = |row: &tables::DeviationRow<'_>| {
            vec![
                row.layout.to_owned(),
                row.members.to_string(),
                if row.reopened > 0 {
                    format!("{}, {} OPEN AGAIN", row.closed, row.reopened)
                } else {
                    row.closed.to_string()
                },
                cell(row.closure_p05_days, 2, "not closed"),
                cell(row.closure_p50_days, 2, "not closed"),
                cell(row.closure_p95_days, 2, "not closed"),
            ]
        };
        let heads = ["layout", "members", "closed", "5 % close by (day)", "half close by (day)", "95 % close by (day)"];
        let heads = heads.map(String::from).into();
        let caption = "Boreholes that end anywhere in a circle around their places.".into();
        let csv = Some("deviation.csv".into());
        let table = Table { caption, heads, rows: spreads.iter().map(row).collect(), words: 1, csv };
        blocks.push(Block { heading: "Deviating boreholes".into(), tables: vec![table], ..Block::default() });
    }
    blocks
}
