//! What there is to run.

use frazil_scene::heading;
use frazil_studies::failure::{Failure, Verdict, answer};

use crate::registry;

/// Prints the bundled scenes by group, the studies, the fluids, and the methods with their titles.
pub fn list() -> Result<Verdict, Failure> {
    let kinds = registry::methods();
    let groups = [("Scenes", frazil_cases::scenes::all()), ("Extreme scenes", frazil_cases::scenes::extreme())];
    let names =
        groups.iter().flat_map(|group| group.1).map(|scene| scene.name).chain(kinds.iter().map(|kind| kind.name));
    let width = names.map(str::len).max().unwrap_or(0);
    let mut text = String::new();
    for (title, scenes) in groups {
        text.push_str(&format!("{title}\n"));
        for bundled in scenes {
            let own = heading(bundled.text, bundled.name)?;
            text.push_str(&format!("  {:width$}  {} ({})\n", bundled.name, own.title, own.source));
        }
        text.push('\n');
    }
    text.push_str("Studies\n");
    for bundled in frazil_cases::studies::all() {
        let own = heading(bundled.text, bundled.name)?;
        text.push_str(&format!("  {:width$}  {}, for layout\n", bundled.name, own.title));
    }
    text.push_str("\nFluids\n");
    for fluid in frazil_cases::fluids::all() {
        text.push_str(&format!("  {:width$}  for calibrate and properties\n", fluid.name));
    }
    text.push_str("\nMethods\n");
    for kind in kinds {
        let noise = if kind.stochastic { ", stochastic" } else { "" };
        text.push_str(&format!("  {:width$}  {}{noise}\n", kind.name, kind.title));
    }
    answer(&text)?;
    Ok(Verdict::Done)
}
