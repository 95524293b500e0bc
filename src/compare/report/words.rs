//! What the page says in words: the scene, and how times were taken.

use frazil_core::scene::{Condition, Domain, Scene, Sector, Series, Units};
use frazil_plots::page::Fact;
use frazil_plots::style::{duration, number, percent};

use crate::compare::CompareRequest;
use crate::compare::analysis::Study;
use crate::compare::curve::{Clock, Kind, REFERENCE_MARGIN};

pub(super) fn parameters(study: &Study) -> Vec<Fact> {
    let scene: &Scene = &study.runs.scene;
    let si = scene.units == Units::Si;
    let with = |value: f64, unit: &str| if si { format!("{} {unit}", number(value, 4)) } else { number(value, 4) };
    let series = |series: &Series, unit: &str| match series {
        Series::Constant(value) => with(*value, unit),
        Series::Table(rows) => format!("a table of {} instants", rows.len()),
        Series::Repeated { rows, .. } => format!("a repeated table of {} instants", rows.len()),
    };
    let domain = match scene.domain {
        Domain::Line { length } => format!("line of {}", with(length, "m")),
        Domain::Rectangle { width, height } => format!("{} by {}", with(width, "m"), with(height, "m")),
        Domain::Ring { outer_radius, sector } => {
            let part = match sector {
                Sector::Quarter => "quarter",
                Sector::Half => "half",
                Sector::Whole => "whole",
            };
            format!("{part} of a disc of radius {}", with(outer_radius, "m"))
        }
    };
    let mut facts = vec![
        Fact::new("Body", domain),
        Fact::new(
            "Duration",
            if si {
                format!("{} {}", number(scene.duration / scene.time_unit.seconds(), 4), scene.time_unit.symbol())
            } else {
                number(scene.duration, 4)
            },
        ),
        Fact::new("Temperature at the start", with(scene.initial_temperature, "°C")),
    ];
    for wall in &scene.walls {
        let condition = match &wall.condition {
            Condition::Symmetry => "mirror plane, no heat crosses".into(),
            Condition::Temperature(value) => series(value, "°C"),
            Condition::Flux(value) => format!("heat flux into the body: {}", series(value, "W/m²")),
            Condition::Convection { coefficient, ambient } => {
                format!("film coefficient {} to {}", series(coefficient, "W/m²K"), series(ambient, "°C"))
            }
            Condition::Exact => "temperature of the exact solution".into(),
        };
        facts.push(Fact::new(format!("Wall {}", wall.name), condition));
    }
    for ring in &scene.rings {
        facts.push(Fact::new(
            "Pipes",
            format!(
                "{} on a circle of radius {}, each of radius {}, at {}",
                ring.count,
                with(ring.ring_radius, "m"),
                with(ring.pipe_radius, "m"),
                series(&ring.temperature, "°C")
            ),
        ));
    }
    for material in &scene.materials {
        facts.push(Fact::new(
            format!("Material {}", material.name),
            format!(
                "frozen {}, {}; unfrozen {}, {}; density {}; freezes at {}; latent heat {}",
                with(material.frozen.conductivity, "W/(m K)"),
                with(material.frozen.heat_capacity, "J/(kg K)"),
                with(material.unfrozen.conductivity, "W/(m K)"),
                with(material.unfrozen.heat_capacity, "J/(kg K)"),
                with(material.density, "kg/m³"),
                with(material.freezing_point, "°C"),
                with(material.latent_heat, "J/kg"),
            ),
        ));
    }
    facts.push(Fact::new("Reference", study.runs.reference_words.clone()));
    facts.push(Fact::new("Wall time spent", duration(study.runs.spent)));
    facts
}

pub(super) fn fairness(request: &CompareRequest, studies: &[Study]) -> Vec<Fact> {
    let repeats = match request.repeats {
        Some(count) => format!("{count} of each configuration"),
        None => {
            "7 of runs below 10 s, 5 below 60 s, 3 above; fewer of the longest where the time for the scene did not \
                 suffice; up to 15 where times scattered by more than 5 %"
                .into()
        }
    };
    let rounds: Vec<String> = studies.iter().map(|study| format!("{}: {}", study.name(), study.runs.rounds)).collect();
    let disturbed: Vec<String> = studies
        .iter()
        .map(|study| {
            let clock = if study.clock == Clock::Wall { "wall time counts" } else { "CPU time counts for all methods" };
            format!("{}: {} of the points, {clock}", study.name(), percent(study.disturbed, 2))
        })
        .collect();
    let stochastic = studies.iter().flat_map(|study| &study.comparisons).flat_map(|comparison| &comparison.curves);
    let any_ensemble = stochastic.into_iter().any(|curve| matches!(curve.kind, Kind::MeanOf(_)));
    let ensembles = if any_ensemble {
        "seeds run side by side on all cores for their errors; times come from runs that are alone on the machine; the \
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
            "Time allowed",
            format!("{} for each scene; what would not fit is listed as left out", duration(request.budget())),
        ),
        Fact::new(
            "Tuning",
            "none here: \"best\" and \"paper\" are fixed in the program, keys of the scene override both alike",
        ),
        Fact::new("Ensembles", ensembles),
        Fact::new(
            "Excluded from speed-ups",
            format!(
                "points below {REFERENCE_MARGIN} × the error of the reference, points that may be low by luck (the next finer run is worse, or the ratio of two norms is off by more than a factor 3), failed runs"
            ),
        ),
        Fact::new(
            "Program",
            "one binary, double precision throughout, the same pool of threads and the same search of neighbours for all",
        ),
    ]
}
