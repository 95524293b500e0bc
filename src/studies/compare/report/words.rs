//! What the page says in words: the scene, and how times were taken.

use frazil_plots::page::Fact;
use frazil_plots::style::{duration, percent};

use crate::compare::analysis::Study;
use crate::compare::curve::{Clock, Kind, REFERENCE_MARGIN};
use crate::compare::request::CompareRequest;
use crate::compare::turns::FIRST_RUNS;
use crate::words;

pub(super) fn parameters(study: &Study) -> Vec<Fact> {
    let mut facts = words::parameters(&study.runs.scene);
    facts.push(Fact::new("Reference", study.runs.reference_words.clone()));
    for remark in &study.runs.scene.remarks {
        facts.push(Fact::new("Differences from the file", remark.clone()));
    }
    facts.push(Fact::new("Wall time spent", duration(study.runs.spent)));
    facts
}

pub(super) fn fairness(request: &CompareRequest, studies: &[Study]) -> Vec<Fact> {
    let repeats = match request.repeats {
        Some(count) => format!("{count} of each configuration"),
        None => "7 of runs below 10 s, 5 below 60 s, 3 above; fewer of the longest if the time for the scene was too \
             short; up to 15 if times scattered by more than 5 %"
            .into(),
    };
    let rounds: Vec<String> = studies.iter().map(|study| format!("{}: {}", study.name(), study.runs.rounds)).collect();
    let disturbed: Vec<String> = studies
        .iter()
        .map(|study| {
            let clock = if study.clock == Clock::Wall { "wall time counts" } else { "CPU time counts for all methods" };
            format!("{}: {} of the points, {clock}", study.name(), percent(study.disturbed, 2))
        })
        .collect();
    let taken_over: Vec<String> = (studies.iter().filter(|study| study.runs.count.known > 0))
        .map(|study| format!("{}: {}", study.name(), study.runs.count.words()))
        .collect();
    let stochastic = studies.iter().flat_map(|study| &study.comparisons).flat_map(|comparison| &comparison.curves);
    let any_ensemble = stochastic.into_iter().any(|curve| matches!(curve.kind, Kind::MeanOf(_)));
    let ensembles = if any_ensemble {
        "seeds run concurrently on all cores for their errors; times come from runs that have the machine to \
         themselves; the \
         mean of K runs costs K times the CPU time of one"
    } else {
        "none in this comparison"
    };
    vec![
        Fact::new("Timed", "particles, neighbours, weights (setup) and all steps (solve)"),
        Fact::new("Not timed", "reading the scene, the reference, errors, files and figures"),
        Fact::new("Runs", format!("one first run of each configuration, not timed unless marked cold; then {repeats}")),
        Fact::new(
            "Order",
            format!("shuffled rounds over all methods, settings and spacings; rounds: {}", rounds.join(", ")),
        ),
        Fact::new(
            "Quiet machine",
            format!("wall time above 1.05 × CPU time of one thread at {}", disturbed.join("; ")),
        ),
        Fact::new(
            "Taken over",
            match taken_over.is_empty() {
                true => "nothing: all runs were made by this call of the program".to_owned(),
                false => format!("{}, on this machine and by this build", taken_over.join("; ")),
            },
        ),
        Fact::new(
            "Time allowed",
            format!(
                "{} for each scene, of which {} for first runs, cheap ones first over all methods; runs that do not \
                 fit are listed as left out",
                duration(request.budget()),
                percent(FIRST_RUNS, 2)
            ),
        ),
        Fact::new(
            "Tuning",
            "none here: \"best\" and \"paper\" are fixed in the program, keys of the scene override both alike",
        ),
        Fact::new("Ensembles", ensembles),
        Fact::new(
            "Excluded from speed-ups",
            format!(
                "points below {REFERENCE_MARGIN} × the error of the reference (they are bounds: \"at most\"), points that are perhaps low by chance (the next finer run is worse, or the ratio to another norm is lower by more than a factor 3), failed runs"
            ),
        ),
        Fact::new(
            "Program",
            "one binary, double precision throughout, the same pool of threads and the same search of neighbours for all",
        ),
    ]
}
