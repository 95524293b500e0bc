//! A whole comparison with made-up runs: no engine, known slopes.
//!
//! With `FRAZIL_COMPARISON=folder` its files stay there to be looked at.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use frazil_record::{Errors, FrontRow, Outcome, ProfileRow, Record, RunResult};
use frazil_scene::{Scene, Setting};
use frazil_simulation::march::{Options, Refused};
use frazil_simulation::measure;
use frazil_simulation::reference::Reference;

use super::variant::Variant;
use super::*;
use crate::bundled;

/// A run whose front is wrong by a known law: first order for PD, second for the others, with noise for eDPD.
fn made_up(
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    options: &Options<'_>,
) -> Result<RunResult, Refused> {
    let Some(settings) = scene.method(method) else {
        return Err(Refused::Reference("no settings".into()));
    };
    let spacing = settings.numerics.spacing;
    let level = spacing / 0.002;
    if method == "sph" && level > 3.0 {
        return Err(Refused::Reference("the spacing is <too> large".into()));
    }
    let noise = if method == "edpd" { 0.02 * ((options.seed * 7919) % 13) as f64 / 13.0 - 0.01 } else { 0.0 };
    let wrong = match method {
        "pd" => 0.0067 * level,
        "sph" => 0.002 * level * level,
        "edpd" => 0.03 * level,
        _ => 0.0007 * level * level,
    } * if settings.setting == Setting::Paper { 3.0 } else { 1.0 };
    let cost = level.powi(-3)
        * match method {
            "pd" => 0.02,
            "edpd" => 0.05,
            _ => 0.004,
        };
    let mut record = blank(scene, method);
    record.solve_wall_s = cost;
    record.solve_cpu_s = cost;
    record.particle_updates = (1e6 * cost) as u64;
    record.errors = Errors::default();
    let mut result = RunResult { ..RunResult::bare(record) };
    if method == "pd" && level < 0.6 && settings.setting == Setting::Paper {
        result.record.outcome = Outcome::Diverged;
        result.record.cause = Some("particle 3 left the range of the data".into());
    }
    if let Some(reference) = reference {
        for k in 1..=60 {
            let time_s = scene.duration * f64::from(k) / 60.0;
            let truth = reference.front(time_s).unwrap_or(0.0);
            result.front.push(FrontRow { time_s, front_m: truth * (1.0 + wrong + noise), front_ref_m: None });
        }
        for k in 0..40 {
            let (x_m, time_s) = (0.002 * (f64::from(k) + 0.5), scene.duration);
            let truth = reference.temperature(x_m, time_s).unwrap_or(0.0);
            result.profiles.push(ProfileRow {
                time_s,
                x_m: Some(x_m),
                temperature_c: truth + 3.0 * (wrong + noise),
                temperature_ref_c: None,
                frozen_fraction: 0.0,
                concentration: None,
                concentration_ref: None,
                plane: "line".into(),
                y_m: None,
                along_m: x_m,
                mean_over: None,
            });
        }
        measure::attach(scene, spacing, &mut result, reference.as_ref());
    }
    Ok(result)
}

fn blank(scene: &Scene, method: &str) -> Record {
    Record {
        frazil_version: "0.1.0".into(),
        scene: scene.name.clone(),
        title: scene.title.clone(),
        scene_hash: scene.hash.clone(),
        method: method.into(),
        units: scene.units.name().into(),
        particles: 100,
        pairs: 300,
        steps: 1000,
        pair_evaluations: 300_000,
        step_s: 1.0,
        step_bound_s: 1.1,
        threads: 1,
        seed: 1,
        outcome: Outcome::Ok,
        energy_balance_rel: 1e-14,
        bounds_violation_rel: Some(0.0),
        setback_rel: Some(0.0),
        state_hash: "0123456789abcdef".into(),
        ..Record::default()
    }
}

fn best() -> Variant {
    Variant::standard(Setting::Best)
}

/// A comparison of all methods.
fn request() -> CompareRequest {
    CompareRequest {
        scenes: vec!["stefan-water".into()],
        methods: ["local", "pd", "sph", "edpd"].map(Into::into).into(),
        levels: 4,
        out: None,
        repeats: Some(7),
        seeds: Some(10),
        threads: 1,
        vary: None,
        budget_s: None,
        settings: vec![best()],
        overrides: Vec::new(),
        reduce: false,
        checkpoints: None,
        quiet: true,
        command_line: "frazil compare stefan-water --settings best,paper".into(),
    }
}

/// The program as it is, but for its runs.
fn parts() -> Parts<'static> {
    static INTERRUPT: AtomicBool = AtomicBool::new(false);
    Parts {
        scene_at: &bundled::scene,
        reference_for: &|scene| frazil_cases::truth(scene).map_err(Into::into),
        run: &made_up,
        methods: bundled::methods(),
        interrupt: &INTERRUPT,
    }
}

/// The same under which each run of eDPD says that it took ten thousand times as long.
fn slow_edpd(
    scene: &Scene,
    method: &str,
    reference: Option<&Arc<dyn Reference>>,
    options: &Options<'_>,
) -> Result<RunResult, Refused> {
    let mut result = made_up(scene, method, reference, options)?;
    if method == "edpd" {
        result.record.solve_wall_s *= 1e4;
        result.record.solve_cpu_s *= 1e4;
    }
    Ok(result)
}

/// What one method's long runs take is not taken from another's short ones; what was left out is not what failed, in every
/// file and on the page.
#[test]
fn what_is_left_out_for_lack_of_time_is_not_failed() -> Result<(), Failure> {
    let Ok(temporary) = tempfile::tempdir() else {
        return Err(Failure::of("temporary folder", "none"));
    };
    let out = temporary.path().join("out");
    let request = CompareRequest { out: Some(out.clone()), settings: vec![best()], ..request() };
    let parts = Parts { run: &slow_edpd, ..parts() };
    assert_eq!(compare(&request, &parts)?, Verdict::Done);
    let read = |name: &str| fs::read_to_string(out.join(name)).unwrap_or_default();
    let column = |text: &str, name: &str| -> Vec<(String, String)> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let heads = reader.headers().cloned().unwrap_or_default();
        let at = |name: &str| heads.iter().position(|head| head == name).unwrap_or(usize::MAX);
        let (method, own) = (at("method"), at(name));
        let cell = |row: &csv::StringRecord, k: usize| row.get(k).unwrap_or_default().to_owned();
        reader.records().flatten().map(|row| (cell(&row, method), cell(&row, own))).collect()
    };
    for (method, status) in column(&read("comparison.csv"), "status") {
        let wanted: &[&str] = match method.as_str() {
            "edpd" => &["done", "left out"],
            // Two of its spacings are refused.
            "sph" => &["done", "refused"],
            _ => &["done"],
        };
        assert!(wanted.contains(&status.as_str()), "{method}: {status}");
    }
    let edpd: Vec<String> =
        column(&read("comparison.csv"), "status").into_iter().filter(|row| row.0 == "edpd").map(|row| row.1).collect();
    assert_eq!(edpd, ["done", "left out", "left out", "left out"]);
    let cells = column(&read("equal_error.csv"), "status");
    assert!(cells.iter().any(|cell| cell == &("edpd".to_owned(), "left out".to_owned())), "{cells:?}");
    assert!(!cells.iter().any(|cell| cell == &("edpd".to_owned(), "not reached".to_owned())), "{cells:?}");
    // The data of the chart stand before the lists, and hold reasons too.
    let whole = read("report.html");
    let page = whole.split_once("<section>").map_or("", |parts| parts.1);
    let (lacking, failed) = (page.find("Left out for lack of time"), page.find("Failed or refused"));
    let reason = page.find("expected, ");
    assert!(
        lacking < reason && reason < failed && lacking.is_some() && failed.is_some(),
        "{lacking:?} {reason:?} {failed:?}"
    );
    assert!(!page[failed.unwrap_or(0)..].contains("eDPD best at"), "eDPD has not failed");
    Ok(())
}

#[test]
fn a_comparison_leaves_all_its_files() -> Result<(), Failure> {
    let Ok(temporary) = tempfile::tempdir() else {
        return Err(Failure::of("temporary folder", "none"));
    };
    let out = std::env::var_os("FRAZIL_COMPARISON").map_or(temporary.path().join("out"), Into::into);
    let request = CompareRequest {
        out: Some(out.clone()),
        settings: [Setting::Best, Setting::Paper].map(Variant::standard).to_vec(),
        ..request()
    };
    let parts = parts();
    assert_eq!(compare(&request, &parts)?, Verdict::Done);
    let read = |name: &str| fs::read_to_string(out.join(name)).unwrap_or_default();
    let comparison = read("comparison.csv");
    assert_eq!(comparison.lines().count(), 1 + 4 * 2 * 4, "{comparison}");
    assert!(comparison.contains("diverged") && comparison.contains("not_run"));
    assert!(read("equal_error.csv").contains("faster") || read("equal_error.csv").contains("slower"));
    assert!(read("equal_error.csv").contains("not reached"));
    assert!(read("equal_time.csv").lines().count() > 1 && read("convergence.csv").lines().count() > 1);
    for file in ["work_precision.svg", "work_precision.png", "stefan-water/convergence_front.svg"] {
        assert!(out.join(file).exists(), "{file}");
    }
    assert!(out.join("stefan-water/pd_best/front.csv").exists());
    let page = read("report.html");
    for part in [
        "Time to reach an error",
        "Error reached in a time",
        "observed order",
        "Medians of the repeated",
        "Heat balance",
        "Left out for lack of time",
        "Failed or refused",
        "Settings of each method",
        "How it was measured",
        "Machine",
        "Ensembles",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(page.contains("&lt;too&gt; large") && !page.contains("<too>"));
    assert!(page.contains("particle 3 left the range"));
    Ok(())
}
