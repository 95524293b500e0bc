//! The tables of a study, and its answer in words.

use std::path::Path;

use frazil_plots::style::percent;
use frazil_record::{Outcome, off_by};
use frazil_studies::failure::Failure;
use serde::Serialize;

use super::answers::Answers;
use super::found::{Attained, Found};
use super::rows::write_rows;
use super::shaft::{self, shafts};
use super::study::Study;
use super::variants::Role;
use super::{dug, reference};

/// One row of `layouts.csv`.
#[derive(Debug, Serialize)]
struct LayoutRow<'a> {
    layout: &'a str,
    of: &'a str,
    stratum: &'a str,
    from_m: Option<f64>,
    to_m: Option<f64>,
    method: &'a str,
    outcome: &'a str,
    pipes: usize,
    effective_pipe_radius_m: f64,
    first_gap_days: Option<f64>,
    closure_days: Option<f64>,
    closure_error_days: Option<f64>,
    reopened_days: Option<f64>,
    closed_at_end: bool,
    last_from: Option<&'a str>,
    last_to: Option<&'a str>,
    weakest_from: Option<&'a str>,
    weakest_to: Option<&'a str>,
    open_gaps: usize,
    all_gaps_days: Option<f64>,
    design_days: Option<f64>,
    design_left_days: Option<f64>,
    end_days: f64,
    thickness_weakest_m: f64,
    thickness_weakest_error_m: Option<f64>,
    temperature_weakest_c: Option<f64>,
    temperature_weakest_error_k: Option<f64>,
    thickness_interface_mean_m: Option<f64>,
    thickness_interface_mean_error_m: Option<f64>,
    thickness_main_mean_m: Option<f64>,
    inner_m: Option<f64>,
    outer_m: Option<f64>,
    mean_axis_c: Option<f64>,
    mean_temperature_c: Option<f64>,
    mean_temperature_error_k: Option<f64>,
    mean_temperature_ring_formula_c: Option<f64>,
    heat_per_pipe_w_per_m: f64,
    heat_per_pipe_ring_formula_w_per_m: Option<f64>,
    load_w_per_m: f64,
    load_peak_w_per_m: Option<f64>,
    plant_peak_kw: Option<f64>,
    plant_end_kw: Option<f64>,
    energy_mj_per_m: f64,
    energy_error_mj_per_m: Option<f64>,
    outer_wall_share: Option<f64>,
    outer_wall_cooled: Option<f64>,
    outer_wall_matters: Option<bool>,
    spacing_m: f64,
    particles: u64,
    part_of_plan: &'a str,
    closure_reached_rel: Option<f64>,
    thickness_reached_rel: Option<f64>,
}

#[derive(Debug, Serialize)]
struct DayRow<'a> {
    layout: &'a str,
    day: f64,
    closed: bool,
    thickness_weakest_m: f64,
    temperature_weakest_c: Option<f64>,
    thickness_interface_mean_m: Option<f64>,
    thickness_main_mean_m: Option<f64>,
    inner_m: Option<f64>,
    outer_m: Option<f64>,
    mean_main_c: Option<f64>,
    mean_interface_c: Option<f64>,
    mean_axis_c: Option<f64>,
    mean_c: Option<f64>,
    heat_per_pipe_w_per_m: f64,
    energy_mj_per_m: f64,
}

#[derive(Debug, Serialize)]
struct GapRow<'a> {
    layout: &'a str,
    from: &'a str,
    to: &'a str,
    x_m: f64,
    y_m: f64,
    distance_m: f64,
    closure_days: Option<f64>,
    closure_alike_days: Option<f64>,
}

#[derive(Debug, Serialize)]
pub(super) struct SensitivityRow<'a> {
    pub(super) layout: &'a str,
    pub(super) key: &'a str,
    pub(super) factor: f64,
    pub(super) closure_days: Option<f64>,
    pub(super) closure_change_days: Option<f64>,
    pub(super) thickness_change_m: Option<f64>,
    pub(super) mean_temperature_change_k: Option<f64>,
    pub(super) energy_change_mj_per_m: Option<f64>,
}

#[derive(Debug, Serialize)]
pub(super) struct DeviationRow<'a> {
    pub(super) layout: &'a str,
    pub(super) members: usize,
    pub(super) closed: usize,
    pub(super) reopened: usize,
    pub(super) closure_p05_days: Option<f64>,
    pub(super) closure_p50_days: Option<f64>,
    pub(super) closure_p95_days: Option<f64>,
}

/// A value, and the same at twice the spacing: what the spacing still changes.
pub(super) fn error(fine: Option<f64>, coarse: Option<f64>) -> Option<f64> {
    fine.zip(coarse).map(|(fine, coarse)| (fine - coarse).abs())
}

/// How far the day of closure may be off.
pub(super) fn closure_error(found: &Found<'_>) -> Option<f64> {
    error(found.fine.closure, found.coarse.as_ref().and_then(|coarse| coarse.closure))
}

/// What to add to the day of closure where a run at twice the spacing finds the wall open that closes here, or the other way round: its
/// error is then no number.
pub(super) fn in_doubt(found: &Found<'_>) -> String {
    let Some(coarse) = &found.coarse else { return String::new() };
    match (found.fine.closure, coarse.closure) {
        (Some(_), None) => ", open at twice the spacing".into(),
        (None, Some(day)) => format!(", at twice the spacing closed on day {day:.1}"),
        _ => String::new(),
    }
}

/// Width of the widest gap of a wall that is open (m); 0 once it is closed.
pub(super) fn open_width(answers: &Answers) -> f64 {
    let open = answers.weakest.as_ref().filter(|_| answers.closure.is_none());
    open.map_or(0.0, |link| link.distance_m)
}

/// Writes all tables.
pub(super) fn write(folder: &Path, study: &Study<'_>, method: &str, found: &[Found<'_>]) -> Result<(), Failure> {
    let rows: Vec<LayoutRow<'_>> = found.iter().filter_map(|one| row(study, method, one)).collect();
    write_rows(folder, "layouts.csv", &rows)?;
    let days: Vec<DayRow<'_>> = found
        .iter()
        .flat_map(|one| {
            one.fine.days.iter().map(|day| DayRow {
                layout: &one.layout.name,
                day: day.day,
                closed: day.closed,
                thickness_weakest_m: day.thickness_weakest_m,
                temperature_weakest_c: day.temperature_weakest_c,
                thickness_interface_mean_m: day.thickness_interface_mean_m,
                thickness_main_mean_m: day.thickness_main_mean_m,
                inner_m: day.weakest_m.map(|ends| ends.0),
                outer_m: day.weakest_m.map(|ends| ends.1),
                mean_main_c: day.mean_main_c,
                mean_interface_c: day.mean_interface_c,
                mean_axis_c: day.mean_axis_c,
                mean_c: day.mean_c,
                heat_per_pipe_w_per_m: day.heat_per_pipe_w_per_m,
                energy_mj_per_m: day.energy_mj_per_m,
            })
        })
        .collect();
    write_rows(folder, "days.csv", &days)?;
    let gaps: Vec<GapRow<'_>> = found
        .iter()
        .flat_map(|one| {
            one.pair.fine.links.iter().map(|link| GapRow {
                layout: &one.layout.name,
                from: &link.from,
                to: &link.to,
                x_m: link.x_m,
                y_m: link.y_m,
                distance_m: link.distance_m,
                closure_days: link.closure_s.map(|time| time / super::answers::DAY),
                closure_alike_days: link.closed_s().map(|time| time / super::answers::DAY),
            })
        })
        .collect();
    write_rows(folder, "gaps.csv", &gaps)?;
    let dug: Vec<_> = found.iter().filter_map(dug::row).collect();
    if !dug.is_empty() {
        write_rows(folder, "shaft.csv", &dug)?;
    }
    let beside: Vec<_> = found.iter().flat_map(reference::rows).collect();
    if !beside.is_empty() {
        write_rows(folder, "reference.csv", &beside)?;
    }
    let changes: Vec<SensitivityRow<'_>> = found.iter().filter_map(|one| change(found, one)).collect();
    if !changes.is_empty() {
        write_rows(folder, "sensitivity.csv", &changes)?;
    }
    shaft::write(folder, study, found)?;
    let spreads = spreads(study, found);
    if !spreads.is_empty() {
        write_rows(folder, "deviation.csv", &spreads)?;
    }
    Ok(())
}

fn row<'a>(study: &'a Study<'_>, method: &'a str, one: &'a Found<'_>) -> Option<LayoutRow<'a>> {
    let (fine, coarse) = (&one.fine, one.coarse.as_ref());
    let end = fine.days.last()?;
    let far = coarse.and_then(|coarse| coarse.days.last());
    let load = end.heat_per_pipe_w_per_m * fine.pipes as f64;
    let stratum = study.ground.stratum(one.layout.stratum);
    let attained = study.error.as_ref().map(|promise| one.attained(promise));
    Some(LayoutRow {
        layout: &one.layout.name,
        of: match &one.layout.role {
            Role::Compared | Role::Tried => "",
            Role::Changed { of, .. } | Role::Deviating { of } => of,
        },
        stratum: stratum.map_or("", |stratum| &stratum.name),
        from_m: stratum.map(|stratum| stratum.from),
        to_m: stratum.map(|stratum| stratum.to),
        method,
        outcome: fine.outcome.name(),
        pipes: fine.pipes,
        effective_pipe_radius_m: reference::effective_radius(&one.layout.scene, method),
        first_gap_days: fine.first_gap,
        closure_days: fine.closure,
        closure_error_days: closure_error(one),
        reopened_days: fine.reopening,
        closed_at_end: fine.closed,
        last_from: fine.last.as_ref().map(|last| last[0].as_str()),
        last_to: fine.last.as_ref().map(|last| last[1].as_str()),
        weakest_from: fine.weakest.as_ref().map(|link| link.from.as_str()),
        weakest_to: fine.weakest.as_ref().map(|link| link.to.as_str()),
        open_gaps: fine.open,
        all_gaps_days: fine.all_gaps,
        design_days: fine.design,
        design_left_days: fine.design_left,
        end_days: end.day,
        thickness_weakest_m: end.thickness_weakest_m,
        thickness_weakest_error_m: error(Some(end.thickness_weakest_m), far.map(|far| far.thickness_weakest_m)),
        temperature_weakest_c: end.temperature_weakest_c,
        temperature_weakest_error_k: error(end.temperature_weakest_c, far.and_then(|far| far.temperature_weakest_c)),
        thickness_interface_mean_m: end.thickness_interface_mean_m,
        thickness_interface_mean_error_m: error(
            end.thickness_interface_mean_m,
            far.and_then(|far| far.thickness_interface_mean_m),
        ),
        thickness_main_mean_m: end.thickness_main_mean_m,
        mean_axis_c: end.mean_axis_c,
        inner_m: end.weakest_m.map(|ends| ends.0),
        outer_m: end.weakest_m.map(|ends| ends.1),
        mean_temperature_c: end.mean_c,
        mean_temperature_error_k: error(end.mean_c, far.and_then(|far| far.mean_c)),
        mean_temperature_ring_formula_c: fine.formula.map(|formula| formula.0),
        heat_per_pipe_w_per_m: end.heat_per_pipe_w_per_m,
        heat_per_pipe_ring_formula_w_per_m: fine.formula.map(|formula| formula.1),
        load_w_per_m: load,
        load_peak_w_per_m: fine.peak(),
        plant_peak_kw: study.depth_of(one.layout).and_then(|depth| Some(1e-3 * depth * fine.peak()?)),
        plant_end_kw: study.depth_of(one.layout).map(|depth| 1e-3 * depth * load),
        energy_mj_per_m: end.energy_mj_per_m,
        energy_error_mj_per_m: error(Some(end.energy_mj_per_m), far.map(|far| far.energy_mj_per_m)),
        outer_wall_share: fine.far.map(|far| far.share),
        outer_wall_cooled: fine.far.map(|far| far.cooled),
        outer_wall_matters: fine.far.map(|far| far.matters()),
        spacing_m: one.layout.scene.method(method).map_or(0.0, |settings| settings.numerics.spacing),
        particles: one.pair.fine.record.particles,
        part_of_plan: &one.layout.sector,
        closure_reached_rel: attained.and_then(|attained| attained.closure),
        thickness_reached_rel: attained.and_then(|attained| attained.thickness),
    })
}

pub(super) fn change<'a>(found: &'a [Found<'_>], one: &'a Found<'_>) -> Option<SensitivityRow<'a>> {
    let Role::Changed { of, key, factor } = &one.layout.role else { return None };
    let base = &found.iter().find(|other| other.layout.name == *of)?.fine;
    let last = |answers: &Answers| answers.days.last().copied();
    let difference = |own: Option<f64>, base: Option<f64>| own.zip(base).map(|(own, base)| own - base);
    let (own, other) = (last(&one.fine), last(base));
    Some(SensitivityRow {
        layout: of,
        key,
        factor: *factor,
        closure_days: one.fine.closure,
        closure_change_days: difference(one.fine.closure, base.closure),
        thickness_change_m: difference(
            own.map(|day| day.thickness_weakest_m),
            other.map(|day| day.thickness_weakest_m),
        ),
        mean_temperature_change_k: difference(
            own.and_then(|day| day.temperature_weakest_c),
            other.and_then(|day| day.temperature_weakest_c),
        ),
        energy_change_mj_per_m: difference(own.map(|day| day.energy_mj_per_m), other.map(|day| day.energy_mj_per_m)),
    })
}

/// What deviating boreholes do to each layout, and to the shafts of a study with strata.
pub(super) fn spreads<'a>(study: &Study<'_>, found: &'a [Found<'a>]) -> Vec<DeviationRow<'a>> {
    let deviates = |other: &Found<'_>, name: &str| matches!(&other.layout.role, Role::Deviating { of } if of == name);
    let layouts = found.iter().filter_map(|one| {
        let own = found.iter().filter(|other| deviates(other, &one.layout.name));
        let days: Vec<_> = own.map(|other| (other.fine.closure, other.fine.reopening)).collect();
        spread(&one.layout.name, &days)
    });
    let all = shafts(study, found);
    let whole = all.iter().filter_map(|shaft| {
        let (base, _) = shaft.parts.first()?;
        let own = all.iter().filter(|other| other.parts.iter().any(|(one, _)| deviates(one, &base.layout.name)));
        spread(shaft.name, &own.map(|shaft| (shaft.closure(), shaft.reopening())).collect::<Vec<_>>())
    });
    layouts.chain(whole).collect()
}

/// Days of closure of deviating members, and of opening again: members whose wall stays open close after all others.
fn spread<'a>(layout: &'a str, members: &[(Option<f64>, Option<f64>)]) -> Option<DeviationRow<'a>> {
    if members.is_empty() {
        return None;
    }
    let mut closed: Vec<f64> = members.iter().filter_map(|(closure, _)| *closure).collect();
    closed.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        let place = share * (members.len() - 1) as f64;
        let (low, part) = (place.floor() as usize, place.fract());
        let (below, above) = (closed.get(low)?, closed.get(if part > 0.0 { low + 1 } else { low })?);
        Some(below + part * (above - below))
    };
    Some(DeviationRow {
        layout,
        members: members.len(),
        closed: closed.len(),
        reopened: members.iter().filter(|(_, reopening)| reopening.is_some()).count(),
        closure_p05_days: quantile(0.05),
        closure_p50_days: quantile(0.5),
        closure_p95_days: quantile(0.95),
    })
}

/// What a layout has reached of the requested error, in words.
fn attained(Attained { closure, thickness }: Attained) -> String {
    let all = [("day", closure), ("thickness at the end", thickness)];
    let told = all.into_iter().filter_map(|(name, own)| Some(format!("{name} to {}", percent(own?, 2))));
    let told: Vec<String> = told.collect();
    if told.is_empty() { String::new() } else { format!(", {}", told.join(" and ")) }
}

/// The answer in a few lines.
pub(super) fn summary(study: &Study<'_>, method: &str, found: &[Found<'_>], folder: &Path) -> String {
    let mut text = format!("{} with {method}: {} layouts\n", study.name, found.len());
    for one in found.iter().filter(|one| one.layout.role == Role::Compared) {
        let fine = &one.fine;
        let closure = match fine.closure {
            Some(day) => {
                let off = closure_error(one).map_or(String::new(), |error| format!(" +- {}", off_by(error, 2)));
                format!("closes on day {day:.2}{off}")
            }
            None => "does not close".into(),
        };
        let closure = closure + &in_doubt(one);
        let closure = match fine.reopening {
            Some(day) => format!("{closure}, OPENS AGAIN on day {day:.2}"),
            None => closure,
        };
        let designed = match (study.design_of(one.layout), fine.design, fine.design_left) {
            (None, ..) => String::new(),
            (_, None, _) => ", never as designed".into(),
            (_, Some(day), None) => format!(", as designed on day {day:.2}"),
            (_, Some(day), Some(left)) => format!(", as designed on day {day:.2} and NO MORE from day {left:.2}"),
        };
        let weakest = fine.weakest.as_ref().map_or(String::new(), |link| {
            format!(", weakest between {} and {} ({:.2} m apart)", link.from, link.to, link.distance_m)
        });
        let load = fine.peak().map_or(String::new(), |peak| format!(", load at most {peak:.0} W/m, mean of a day"));
        let outcome =
            if fine.outcome == Outcome::Ok { String::new() } else { format!(", outcome {}", fine.outcome.name()) };
        let attained = study.error.as_ref().map_or(String::new(), |promise| attained(one.attained(promise)));
        let near = if fine.far.is_some_and(|far| far.matters()) { ", outer wall too near" } else { "" };
        text.push_str(&format!("  {}: {closure}{designed}{weakest}{load}{attained}{near}{outcome}\n", one.layout.name));
    }
    for row in shafts(study, found).iter().filter(|one| one.compared()).filter_map(|shaft| shaft.row(study, found)) {
        text.push_str(&format!("  {}\n", shaft::words(&row)));
    }
    text.push_str(&format!("  results: {}\n", folder.display()));
    text
}
