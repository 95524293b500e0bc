//! The least value of a key at which the wall closes in time, by halving the range in which it must lie.
//!
//! It takes for granted that more closes earlier, as more pipes do; the value below the one found is always tried.

use serde::Serialize;

use super::answers::Answers;
use super::execute::Work;
use super::study::{Search, Study};
use crate::failure::Failure;

/// A value that was tried: a row of `search.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// The value.
    pub value: i64,
    /// Day on which the wall closed.
    pub closure_days: Option<f64>,
    /// Whether in time.
    pub in_time: bool,
    /// Whether it is the least that is.
    pub least: bool,
}

/// Tries values until the least is known, in the order of the values; none if it was interrupted.
pub(super) fn search(study: &Study, search: &Search, work: &Work<'_>) -> Result<Option<Vec<Tried>>, Failure> {
    let mut tried: Vec<Tried> = Vec::new();
    let mut try_one = |value: i64| -> Result<Option<bool>, Failure> {
        let mut closures = Vec::new();
        for layout in study.tried(search, value)? {
            let Some(pair) = work.made(&layout)? else { return Ok(None) };
            closures.push(Answers::of(&layout.scene, &pair.fine, study.design_of(&layout)).closure);
        }
        // A shaft is closed once it is closed at all horizons.
        let closure_days =
            closures.into_iter().collect::<Option<Vec<f64>>>().and_then(|days| days.into_iter().reduce(f64::max));
        let in_time = closure_days.is_some_and(|day| day <= search.closure_days);
        tried.push(Tried { value, closure_days, in_time, least: false });
        Ok(Some(in_time))
    };
    let Some(most) = try_one(search.to)? else { return Ok(None) };
    let mut least = most.then_some(search.to);
    if most {
        let Some(first) = try_one(search.from)? else { return Ok(None) };
        let (mut late, mut in_time) = (search.from, if first { search.from } else { search.to });
        while in_time - late > 1 {
            let middle = late + (in_time - late) / 2;
            match try_one(middle)? {
                Some(true) => in_time = middle,
                Some(false) => late = middle,
                None => return Ok(None),
            }
        }
        least = Some(in_time);
    }
    tried.sort_by_key(|one| one.value);
    tried.iter_mut().for_each(|one| one.least = Some(one.value) == least);
    Ok(Some(tried))
}

/// What was found, in words.
pub(super) fn words(search: &Search, tried: &[Tried]) -> String {
    let (key, day) = (&search.key, search.closure_days);
    match tried.iter().find(|one| one.least) {
        Some(one) => {
            let closure = one.closure_days.map_or(String::new(), |closure| format!(", on day {closure:.2}"));
            format!(
                "{key} = {} is the least from {} to {} that closes by day {day}{closure}",
                one.value, search.from, search.to
            )
        }
        None => format!("{key} from {} to {}: none closes by day {day}", search.from, search.to),
    }
}
