//! What an ensemble says about a scene under a method: `ensemble.json`.

use std::collections::BTreeMap;

use frazil_core::statistics;
use frazil_record::{Errors, Outcome, Record, ReferenceInfo, Value};
use serde::{Deserialize, Serialize};

use super::runs::{EnsembleRuns, Headline};

/// Measures with a sign, apart from the errors of events, which all have one.
const SIGNED: [&str; 3] = ["front_last_rel", "front_constant_rel", "temperature_mean_rel"];

/// Errors of events, by the start of their names.
const EVENTS: &str = "events.";

/// One member.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Member {
    /// Its seed.
    pub seed: u64,
    /// How its run ended.
    pub outcome: Outcome,
    /// Why, if not `ok`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub cause: Option<String>,
    /// Its heat balance.
    pub energy_balance_rel: f64,
    /// Hash of its final enthalpies.
    pub state_hash: String,
    /// CPU time of preparation and steps (s).
    pub cpu_s: f64,
    /// Wall time of the same (s).
    pub wall_s: f64,
}

impl Member {
    /// From the record of its run.
    pub fn of(record: &Record) -> Member {
        Member {
            seed: record.seed,
            outcome: record.outcome,
            cause: record.cause.clone(),
            energy_balance_rel: record.energy_balance_rel,
            state_hash: record.state_hash.clone(),
            cpu_s: record.setup_cpu_s + record.solve_cpu_s,
            wall_s: record.setup_wall_s + record.solve_wall_s,
        }
    }
}

/// One measure of error over the members.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// Members that have it.
    pub members: usize,
    /// Mean over them. Errors of events are taken as logarithms of times over those of the reference, whose scatter is
    /// skewed.
    pub mean: f64,
    /// Its 95 % interval by Student's t; absent for a single member.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub interval: Option<[f64; 2]>,
    /// Standard deviation between members.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub sd: Option<f64>,
    /// Root of the mean square over members.
    pub rms: f64,
    /// The same measure of the mean of the members' series.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub of_mean: Option<f64>,
    /// Of measures with a sign: what no number of members removes, squared, without the bias of the squared mean; negative
    /// where it is not resolved.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub bias_squared: Option<f64>,
}

/// Systematic error and scatter of a series, point by point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Split {
    /// Rms error of one member.
    pub member_rms: f64,
    /// Rms error of the mean of these members.
    pub mean_rms: f64,
    /// Variance between members, mean over the points.
    pub variance: f64,
    /// Squared error of the mean of endlessly many, without bias; negative where it is not resolved.
    pub bias_squared: f64,
    /// Its root, where it is resolved.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub bias: Option<f64>,
}

/// The record of an ensemble.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EnsembleRecord {
    /// Version of the program.
    pub frazil_version: String,
    /// Name of the scene.
    pub scene: String,
    /// Title of the scene.
    pub title: String,
    /// Hash of the scene file as it was run.
    pub scene_hash: String,
    /// Name of the method.
    pub method: String,
    /// All settings after defaults, by key.
    pub settings: BTreeMap<String, Value>,
    /// Units of the numbers.
    pub units: String,
    /// Seeds of the members.
    pub seeds: Vec<u64>,
    /// Members whose series are in the means: those that came to the end of the scene.
    pub averaged: usize,
    /// Members that were there already.
    pub taken_over: usize,
    /// The members.
    pub members: Vec<Member>,
    /// Errors by measure, as in the record of a run; those of events by `events.` and their name.
    pub errors: BTreeMap<String, Measure>,
    /// Bias and variance apart, relative as the errors: of `front` and what is read along profiles. Absent for a single member.
    pub curves: BTreeMap<String, Split>,
    /// The reference.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub reference: Option<ReferenceInfo>,
    /// The worst heat balance of all members.
    pub energy_balance_rel: f64,
    /// CPU time of all members (s).
    pub cpu_s: f64,
    /// Wall times of all members, summed (s).
    pub members_wall_s: f64,
    /// Wall time of the members that were run now (s).
    pub wall_s: f64,
    /// Members that were run at once.
    pub threads: usize,
    /// How the method differs from the scene, in words.
    pub differences: Vec<String>,
    /// What of the scene was not taken as it stands, in words.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub remarks: Vec<String>,
}

/// Numbers by name; those of events after the name of their group.
pub type ByName = BTreeMap<String, f64>;

/// Errors by name.
pub fn by_name(errors: &Errors) -> ByName {
    flat(errors, "")
}

/// All errors of a run by name: those of its series, those of its water, and what a driven liquid came to.
pub fn errors_of(record: &Record) -> ByName {
    let mut all = by_name(&record.errors);
    all.extend(record.water.iter().flat_map(|water| flat(&water.errors, "water.")));
    all.extend(record.stream.iter().flat_map(|stream| flat(stream, "stream.")));
    all
}

/// The numbers in something, by names that start alike.
fn flat(group: &impl Serialize, start: &str) -> ByName {
    let mut all = ByName::new();
    if let Ok(serde_json::Value::Object(entries)) = serde_json::to_value(group) {
        for (name, value) in entries {
            match value {
                serde_json::Value::Object(_) => all.extend(flat(&value, &format!("{start}{name}."))),
                _ => all.extend(value.as_f64().map(|number| (format!("{start}{name}"), number))),
            }
        }
    }
    all
}

/// Errors over members, and those of their mean.
pub fn measures(members: &[ByName], mean: &Errors) -> BTreeMap<String, Measure> {
    let mut values: BTreeMap<&String, Vec<f64>> = BTreeMap::new();
    for (name, error) in members.iter().flatten() {
        values.entry(name).or_default().push(*error);
    }
    let of_mean = by_name(mean);
    values
        .into_iter()
        .filter_map(|(name, errors)| Some((name.clone(), measure(name, &errors, of_mean.get(name))?)))
        .collect()
}

fn measure(name: &str, errors: &[f64], of_mean: Option<&f64>) -> Option<Measure> {
    let (mean, variance) = statistics::moments(errors)?;
    let event = name.starts_with(EVENTS);
    let signed = event || SIGNED.contains(&name);
    let count = errors.len();
    let ratios: Vec<f64> = errors.iter().map(|error| 1.0 + error).collect();
    let (found, from) = match statistics::geometric_mean(&ratios).filter(|_| event) {
        Some(found) => (found, 1.0),
        None => (statistics::mean(errors)?, 0.0),
    };
    Some(Measure {
        members: count,
        mean: found.mean - from,
        interval: found.interval.map(|ends| [ends.low - from, ends.high - from]),
        sd: (count > 1).then(|| variance.sqrt()),
        rms: (errors.iter().map(|error| error * error).sum::<f64>() / count as f64).sqrt(),
        of_mean: of_mean.copied(),
        bias_squared: (signed && count > 1).then(|| mean * mean - variance / count as f64),
    })
}

/// Bias and variance of the series that have a reference.
pub fn splits(runs: &EnsembleRuns) -> BTreeMap<String, Split> {
    let split = |headline: Headline| {
        let found = runs.split(headline)?;
        let split = Split {
            member_rms: found.run_rms,
            mean_rms: found.mean_rms,
            variance: found.variance,
            bias_squared: found.bias_squared,
            bias: found.bias(),
        };
        Some((headline.name().to_owned(), split))
    };
    let series = Headline::ALL.into_iter().filter(|own| *own == Headline::Front || own.is_of_profiles());
    series.filter_map(split).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(front: f64, last: f64, closure: f64) -> Errors {
        Errors {
            front_rms_rel: Some(front),
            front_last_rel: Some(last),
            events: [("closure_day".to_owned(), closure)].into(),
            ..Errors::default()
        }
    }

    #[test]
    fn measures_are_found_by_the_names_that_records_give_them() {
        let found = by_name(&errors(0.01, 0.03, -0.2));
        let names: Vec<&str> = found.keys().map(String::as_str).collect();
        assert_eq!(names, ["events.closure_day", "front_last_rel", "front_rms_rel"]);
        assert_eq!(found["events.closure_day"], -0.2);
    }

    #[test]
    fn bias_is_told_from_variance() {
        let members = [errors(0.01, 0.03, 0.0), errors(0.03, -0.01, 0.21)].map(|errors| by_name(&errors));
        let found = measures(&members, &errors(0.015, 0.01, 0.1));
        let front = &found["front_rms_rel"];
        assert!((front.mean - 0.02).abs() < 1e-15 && (front.rms - 5e-4_f64.sqrt()).abs() < 1e-15);
        assert_eq!((front.of_mean, front.bias_squared, front.members), (Some(0.015), None, 2));
        // Half of 0.04 apart: a variance of 8e-4, and t of one degree of freedom.
        assert!(front.sd.is_some_and(|sd| (sd - 2e-4_f64.sqrt()).abs() < 1e-15));
        let [low, high] = front.interval.expect("two members");
        assert!((0.5 * (high - low) - 12.706 * 0.01).abs() < 1e-5, "{low} {high}");
        // The squared mean is 1e-4, its own variance 8e-4 / 2.
        let last = found["front_last_rel"].bias_squared.expect("a sign");
        assert!((last - (1e-4 - 4e-4)).abs() < 1e-15, "{last}");
        // Times by their logarithms: the geometric mean of 1 and 1.21.
        assert!((found["events.closure_day"].mean - 0.1).abs() < 1e-15);
        let single = &measures(&members[..1], &Errors::default())["front_last_rel"];
        assert_eq!((single.interval, single.sd, single.of_mean, single.bias_squared), (None, None, None, None));
    }
}
