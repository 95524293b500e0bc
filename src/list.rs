//! What there is to run.

use frazil_scene::heading;
use frazil_studies::failure::{Failure, Verdict, answer, answer_json};
use serde::Serialize;

use crate::registry;

/// Something that there is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Listed {
    /// `scene`, `extreme` (a scene at the edge of what methods bear), `study`, `fluid` or `method`.
    pub kind: &'static str,
    /// Name.
    pub name: &'static str,
    /// Title; that of a fluid is empty.
    pub title: String,
    /// Where a scene or a study comes from; `stochastic` of a method with noise.
    pub source: String,
}

/// Everything that there is, in the order in which it is listed.
///
/// # Errors
/// Where a bundled file cannot be read.
pub fn listed() -> Result<Vec<Listed>, Failure> {
    let mut rows = Vec::new();
    let groups = [
        ("scene", frazil_cases::scenes::all()),
        ("extreme", frazil_cases::scenes::extreme()),
        ("study", frazil_cases::studies::all()),
    ];
    for (kind, group) in groups {
        for bundled in group {
            let own = heading(bundled.text, bundled.name)?;
            rows.push(Listed { kind, name: bundled.name, title: own.title, source: own.source });
        }
    }
    let fluid = |name| Listed { kind: "fluid", name, title: String::new(), source: String::new() };
    rows.extend(frazil_cases::fluids::all().iter().map(|bundled| fluid(bundled.name)));
    for kind in registry::methods() {
        let source = if kind.stochastic { "stochastic" } else { "" };
        rows.push(Listed { kind: "method", name: kind.name, title: kind.title.to_owned(), source: source.to_owned() });
    }
    Ok(rows)
}

/// Prints the bundled scenes by group, the studies, the fluids, and the methods with their titles; or all of it as JSON.
///
/// # Errors
/// Where a bundled file cannot be read.
pub fn list(json: bool) -> Result<Verdict, Failure> {
    let rows = listed()?;
    if json {
        answer_json(&rows)?;
        return Ok(Verdict::Done);
    }
    let width = rows.iter().map(|row| row.name.len()).max().unwrap_or(0);
    let groups = [
        ("scene", "Scenes"),
        ("extreme", "Extreme scenes"),
        ("study", "Studies"),
        ("fluid", "Fluids"),
        ("method", "Methods"),
    ];
    let line = |row: &Listed| {
        let words = match row.kind {
            "study" => format!("{}, for layout", row.title),
            "fluid" => "for calibrate and properties".to_owned(),
            "method" if row.source.is_empty() => row.title.clone(),
            "method" => format!("{}, {}", row.title, row.source),
            _ => format!("{} ({})", row.title, row.source),
        };
        format!("  {:width$}  {words}\n", row.name)
    };
    let group = |(kind, title): (&str, &str)| {
        let own = rows.iter().filter(|row| row.kind == kind).map(line);
        format!("{title}\n{}", own.collect::<String>())
    };
    answer(&groups.map(group).join("\n"))?;
    Ok(Verdict::Done)
}
