//! What a study would run, on which part of the plan and why, and how long it would take; nothing is written.

use std::collections::BTreeMap;

use frazil_core::predict;

use super::study::Study;
use super::variants::{Role, working};
use crate::failure::{Failure, answer};
use crate::progress::clock;

/// Layouts whose first steps are tried.
const TRIED: usize = 20;

/// Prints the layouts of a study that are compared.
pub(super) fn print(study: &Study, method: &str, threads: usize) -> Result<(), Failure> {
    let compared: Vec<_> = study.layouts.iter().filter(|one| one.role == Role::Compared).collect();
    let mut text = format!("{}: {}\n", study.name, study.title);
    text.push_str(&format!("  {} layouts under {method}, each also at twice the spacing\n", study.layouts.len()));
    let mut others: BTreeMap<&str, usize> = BTreeMap::new();
    for layout in &study.layouts {
        let kind = match layout.role {
            Role::Changed { .. } => "with a key changed",
            Role::Deviating { .. } => "with deviating boreholes",
            Role::Compared | Role::Tried => continue,
        };
        *others.entry(kind).or_default() += 1;
    }
    for (kind, count) in others {
        text.push_str(&format!("  {count} of them {kind}\n"));
    }
    if study.search.is_some() || study.critical.is_some() {
        text.push_str("  and those that are tried on the way to what is sought\n");
    }
    answer(&text)?;
    for layout in compared.iter().take(TRIED) {
        let forecast = predict::forecast(&layout.scene, method, None, 1, 1)?;
        let time = forecast.seconds().map_or("unknown, as the number of steps is".to_owned(), clock);
        let radius = super::reference::effective_radius(&layout.scene, method);
        answer(&format!(
            "\n{}\n  runs on      {}\n  pipes        {}, acting as of radius {radius:.4} m\n  particles    {}\n  time         \
             {time} on 1 thread\n",
            layout.name,
            layout.sector,
            working(&layout.scene.rings),
            forecast.summary.particles,
        ))?;
    }
    if compared.len() > TRIED {
        answer(&format!("\nand {} more\n", compared.len() - TRIED))?;
    }
    if threads > 1 {
        answer(&format!("\n{threads} layouts run at once\n"))?;
    }
    Ok(())
}
