//! The answer of a study in sentences: when each wall closes, when it is as designed, and what a search has found.

use crate::found::Found;
use crate::rows::{cell, with_error};
use crate::search;
use crate::study::Study;
use crate::tables;

use super::{SHOWN, Told};

/// The sentences that the page begins with.
pub(super) fn answers(study: &Study<'_>, told: &Told<'_>, compared: &[&Found<'_>]) -> Vec<String> {
    let closes = |one: &Found<'_>| one.fine.closure;
    let closure = |one: &Found<'_>| {
        let day = with_error(one.fine.closure, tables::closure_error(one), 2, "");
        let again = one.fine.reopening.map_or(String::new(), |day| format!(" and OPENS AGAIN on day {day:.1}"));
        let gap =
            one.fine.weakest.as_ref().map_or(String::new(), |link| format!(" ({} to {} widest)", link.from, link.to));
        match one.fine.closure {
            Some(_) => format!("closes on day {day}{}{again}", tables::in_doubt(one)),
            None => format!("does not close{gap}{}", tables::in_doubt(one)),
        }
    };
    let mut sentences = vec![in_order(compared, closes, closure)];
    if compared.iter().any(|one| study.design_of(one.layout).is_some()) {
        let designed = |one: &Found<'_>| {
            let left = one.fine.design_left.map_or(String::new(), |day| format!(" and NO MORE from day {day:.1}"));
            match one.fine.design {
                Some(_) => format!("has it on day {}{left}", cell(one.fine.design, 1, "")),
                None => "never has it".into(),
            }
        };
        let words = in_order(compared, |one| one.fine.design, designed);
        sentences.push(format!("The wall that was asked for: {words}"));
    }
    sentences.extend(study.search.as_ref().map(|search| format!("{}.", search::words(search, told.tried))));
    sentences
}

/// What holds for each layout, the soonest first; of many, the first ones and the last.
fn in_order(
    compared: &[&Found<'_>],
    day: impl Fn(&Found<'_>) -> Option<f64>,
    words: impl Fn(&Found<'_>) -> String,
) -> String {
    let mut all: Vec<&Found<'_>> = compared.to_vec();
    all.sort_by(|a, b| day(a).unwrap_or(f64::INFINITY).total_cmp(&day(b).unwrap_or(f64::INFINITY)));
    let said = |one: &&Found<'_>| format!("“{}” {}", one.layout.name, words(one));
    let mut parts: Vec<String> = all.iter().map(said).collect();
    if parts.len() > SHOWN {
        let between = format!("{} more in between", parts.len() - SHOWN);
        parts.splice(SHOWN / 2..parts.len() - SHOWN / 2, [between]);
    }
    format!("{}.", parts.join("; "))
}
