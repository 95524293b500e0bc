//! What a study would run, on which part of the plan and why, and how long it would take; nothing is written.

use std::collections::BTreeMap;

use frazil_simulation::predict;
use frazil_studies::failure::{Failure, answer};
use frazil_studies::progress::clock;

use super::ahead::{self, Ahead};
use super::study::Study;
use super::variants::{Layout, Role, working};

/// Layouts whose first steps are tried.
const TRIED: usize = 20;

/// Work of a layout at twice the spacing over that at its own: a quarter of the particles, a quarter of the steps.
const COARSE: f64 = 1.0 / 16.0;

/// Prints the layouts of a study that are compared, under one method or several.
pub(super) fn print(study: &Study<'_>, methods: &[&'static str], threads: usize) -> Result<(), Failure> {
    let compared: Vec<_> = study.compared().collect();
    let ahead = ahead::all(study, methods[0], threads)?;
    answer(&heading(study, methods, &ahead))?;
    // Seconds by particle and second of the scene, of each method, from the layouts that were tried.
    let mut rates: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for layout in compared.iter().take(TRIED) {
        let radius = super::reference::effective_radius(&layout.scene, methods[0]);
        answer(&format!(
            "\n{}\n  runs on      {}\n  pipes        {}, effective radius {radius:.4} m\n",
            layout.name,
            layout.sector,
            working(&layout.scene.rings),
        ))?;
        for method in methods {
            let forecast = match predict::forecast(&layout.scene, method, None, 1, 1) {
                Ok(forecast) => forecast,
                // Under all methods one that cannot run a layout is named with its reason, and the others run it.
                Err(refused) if *method != methods[0] => {
                    answer(&format!("  {method:<12} not possible: {refused}\n"))?;
                    continue;
                }
                Err(refused) => return Err(refused.into()),
            };
            if let Some(seconds) = forecast.seconds() {
                rates.entry(method).or_default().push(seconds / size(layout, method));
            }
            let time = forecast.seconds().map_or("unknown, like the number of steps".to_owned(), |seconds| {
                format!("{} on 1 thread", clock(seconds))
            });
            let under = if methods.len() > 1 { format!(" with {method}") } else { String::new() };
            let particles = forecast.summary.particles;
            answer(&format!("  particles    {particles}{under}\n  time         {time}{under}\n"))?;
        }
    }
    if compared.len() > TRIED {
        answer(&format!("\nand {} more\n", compared.len() - TRIED))?;
    }
    answer(&format!("\n{}\n", total(study, methods, &rates, &ahead, threads)))
}

/// What is run, counted.
pub(super) fn heading(study: &Study<'_>, methods: &[&'static str], ahead: &Ahead) -> String {
    let mut text = format!("{}: {}\n", study.name, study.title);
    let under = methods.join(", ");
    text.push_str(&format!("  {} with {under}, each also at twice the spacing\n", layouts(study.layouts.len())));
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
    if ahead.most > 0 {
        text.push_str(&format!("  and {}\n", ahead.words()));
    }
    text
}

fn layouts(count: usize) -> String {
    if count == 1 { "1 layout".into() } else { format!("{count} layouts") }
}

/// Particles times seconds of the scene.
fn size(layout: &Layout, method: &str) -> f64 {
    let spacing = layout.scene.method(method).map_or(1.0, |settings| settings.numerics.spacing);
    layout.scene.domain.size() / (spacing * spacing) * layout.scene.duration
}

/// The time of all runs together: those that were not tried go by particles and duration.
fn total(
    study: &Study<'_>,
    methods: &[&'static str],
    rates: &BTreeMap<&str, Vec<f64>>,
    ahead: &Ahead,
    threads: usize,
) -> String {
    let (mut seconds, mut unknown) = (0.0, Vec::new());
    for (k, method) in methods.iter().enumerate() {
        // Beside the first method only what is compared is run.
        let own = study.layouts.iter().filter(|one| k == 0 || one.role == Role::Compared);
        match rates.get(method) {
            Some(rates) => {
                let rate = rates.iter().sum::<f64>() / rates.len() as f64;
                seconds += (1.0 + COARSE) * rate * own.map(|one| size(one, method)).sum::<f64>();
            }
            None => unknown.push(*method),
        }
    }
    let at_once = threads.min(study.layouts.len()).max(1);
    let mut text = format!("total         about {} of 1 thread", clock(seconds + ahead.likely_s));
    if at_once > 1 {
        text += &format!(", {} with {at_once} concurrent layouts", clock(seconds / at_once as f64 + ahead.wall_s));
    }
    if ahead.most > 0 {
        text += &format!(", {} of it for search candidates", clock(ahead.likely_s));
        if ahead.most > ahead.likely {
            text += &format!(", at most {}", clock(ahead.most_s));
        }
    }
    if !unknown.is_empty() {
        text += &format!(", excluding {}, whose steps are not known in advance", unknown.join(", "));
    }
    text
}
