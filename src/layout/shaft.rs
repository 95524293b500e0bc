//! The shaft as a whole: the same layout in all strata.

use std::path::Path;

use frazil_plots::layouts::{LayerView, ShaftView, between};
use frazil_studies::failure::Failure;
use serde::Serialize;

use super::answers::{Answers, DAY, greatest};
use super::found::Found;
use super::rows::write_rows;
use super::study::Study;
use super::tables::{error, open_width};
use super::variants::Role;

/// A layout in all strata, downwards.
pub(super) struct Shaft<'a> {
    /// Name of the layout.
    pub(super) name: &'a str,
    /// What it is in its strata, with the thickness of their layers (m).
    pub(super) parts: Vec<(&'a Found<'a>, f64)>,
}

/// One row of `shafts.csv`.
#[derive(Debug, Serialize)]
pub(super) struct ShaftRow<'a> {
    pub(super) layout: &'a str,
    of: &'a str,
    pub(super) depth_m: f64,
    pub(super) closure_days: Option<f64>,
    pub(super) closure_error_days: Option<f64>,
    pub(super) reopened_days: Option<f64>,
    pub(super) weakest_stratum: &'a str,
    weakest_from: Option<&'a str>,
    weakest_to: Option<&'a str>,
    pub(super) open_strata: usize,
    pub(super) design_days: Option<f64>,
    pub(super) design_left_days: Option<f64>,
    pub(super) thinnest_stratum: &'a str,
    pub(super) thickness_weakest_m: f64,
    pub(super) warmest_stratum: Option<&'a str>,
    pub(super) temperature_weakest_c: Option<f64>,
    pub(super) plant_peak_kw: Option<f64>,
    pub(super) plant_end_kw: f64,
    pub(super) energy_gj: f64,
}

/// All layouts over their strata, in the order in which they come.
pub(super) fn shafts<'a>(study: &Study<'_>, found: &'a [Found<'a>]) -> Vec<Shaft<'a>> {
    let mut all: Vec<Shaft<'a>> = Vec::new();
    for one in found {
        let Some(thickness) = one.layout.stratum.and(study.depth_of(one.layout)) else { continue };
        match all.iter_mut().find(|shaft| shaft.name == one.layout.shaft) {
            Some(shaft) => shaft.parts.push((one, thickness)),
            None => all.push(Shaft { name: &one.layout.shaft, parts: vec![(one, thickness)] }),
        }
    }
    all
}

impl<'a> Shaft<'a> {
    /// Day on which the wall stood closed in all strata.
    pub(super) fn closure(&self) -> Option<f64> {
        let days: Option<Vec<f64>> = self.parts.iter().map(|(one, _)| one.fine.closure).collect();
        days?.into_iter().reduce(f64::max)
    }

    /// Day on which it first opened again at one of them.
    pub(super) fn reopening(&self) -> Option<f64> {
        self.parts.iter().filter_map(|(one, _)| one.fine.reopening).reduce(f64::min)
    }

    /// Day on which one of them first was as designed no more: of a shaft that was so in all.
    fn design_left(&self) -> Option<f64> {
        self.parts.iter().filter_map(|(one, _)| one.fine.design_left).reduce(f64::min)
    }

    /// Its closure at twice the spacing.
    fn coarse_closure(&self) -> Option<f64> {
        let days: Option<Vec<f64>> = self.parts.iter().map(|(one, _)| one.coarse.as_ref()?.closure).collect();
        days?.into_iter().reduce(f64::max)
    }

    /// The stratum that closed last; while some are open, that of the widest open gap.
    pub(super) fn weakest(&self) -> Option<&'a Found<'a>> {
        let all = || self.parts.iter().map(|(one, _)| *one);
        let open = all().filter(|one| one.fine.closure.is_none());
        // Of equal ones the uppermost.
        let widest = open.reduce(|best, one| if open_width(&one.fine) > open_width(&best.fine) { one } else { best });
        let day = |one: &Found<'_>| one.fine.closure.unwrap_or(0.0);
        widest.or_else(|| all().reduce(|best, one| if day(one) > day(best) { one } else { best }))
    }

    /// Heat that all pipes take over time (s, kW), of the loads of each stratum (s, W/m) at the times of the uppermost.
    fn sum(&self, loads: impl Fn(&Answers) -> &[(f64, f64)]) -> Vec<(f64, f64)> {
        let times = self.parts.first().map_or(&[][..], |(one, _)| loads(&one.fine));
        let whole = |time: f64| {
            let parts = self.parts.iter().map(|(one, thick)| Some(1e-3 * thick * between(loads(&one.fine), time)?));
            parts.sum::<Option<f64>>()
        };
        times.iter().filter_map(|(time, _)| Some((*time, whole(*time)?))).collect()
    }

    /// The same at instants.
    pub(super) fn load(&self) -> Vec<(f64, f64)> {
        self.sum(|answers| &answers.load)
    }

    /// Name of the stratum of a part.
    fn stratum(study: &'a Study<'_>, one: &Found<'_>) -> &'a str {
        study.ground.stratum(one.layout.stratum).map_or("", |stratum| stratum.name.as_str())
    }

    /// Its row, beside all layouts.
    pub(super) fn row(&self, study: &'a Study<'_>, found: &'a [Found<'a>]) -> Option<ShaftRow<'a>> {
        let weakest = self.weakest()?;
        let ends: Vec<_> = self
            .parts
            .iter()
            .map(|(one, thick)| Some((*one, *thick, *one.fine.days.last()?)))
            .collect::<Option<_>>()?;
        let thin = ends.iter().min_by(|a, b| a.2.thickness_weakest_m.total_cmp(&b.2.thickness_weakest_m))?;
        // Where the wall is open it has no temperature.
        let closed = ends.iter().filter_map(|(one, _, end)| Some((*one, end.temperature_weakest_c?)));
        let warm = closed.max_by(|a, b| a.1.total_cmp(&b.1));
        let design: Option<Vec<f64>> = self.parts.iter().map(|(one, _)| one.fine.design).collect();
        let load = self.load();
        let of = match &weakest.layout.role {
            Role::Compared | Role::Tried => "",
            Role::Changed { of, .. } | Role::Deviating { of } => {
                found.iter().find(|other| other.layout.name == *of).map_or("", |other| &other.layout.shaft)
            }
        };
        Some(ShaftRow {
            layout: self.name,
            of,
            depth_m: self.parts.iter().map(|(_, thick)| thick).sum(),
            closure_days: self.closure(),
            closure_error_days: error(self.closure(), self.coarse_closure()),
            reopened_days: self.reopening(),
            weakest_stratum: Shaft::stratum(study, weakest),
            weakest_from: weakest.fine.weakest.as_ref().map(|link| link.from.as_str()),
            weakest_to: weakest.fine.weakest.as_ref().map(|link| link.to.as_str()),
            open_strata: self.parts.iter().filter(|(one, _)| one.fine.closure.is_none()).count(),
            design_left_days: self.design_left().filter(|_| design.is_some()),
            design_days: design.and_then(|days| days.into_iter().reduce(f64::max)),
            thinnest_stratum: Shaft::stratum(study, thin.0),
            thickness_weakest_m: thin.2.thickness_weakest_m,
            warmest_stratum: warm.map(|warm| Shaft::stratum(study, warm.0)),
            temperature_weakest_c: warm.map(|warm| warm.1),
            plant_peak_kw: greatest(&self.sum(|answers| &answers.daily)),
            plant_end_kw: load.last().map_or(0.0, |(_, load)| *load),
            energy_gj: ends.iter().map(|(_, thick, end)| 1e-3 * thick * end.energy_mj_per_m).sum(),
        })
    }

    /// What a figure over depth shows of it.
    pub(super) fn view(&self, study: &Study<'_>) -> ShaftView {
        let layer = |(one, _): &(&Found<'_>, f64)| {
            let stratum = study.ground.stratum(one.layout.stratum)?;
            Some(LayerView {
                name: stratum.name.clone(),
                from_m: stratum.from,
                to_m: stratum.to,
                closure_s: one.fine.closure.map(|day| day * DAY),
                thickness_m: one.fine.days.last().map_or(0.0, |end| end.thickness_weakest_m),
                load_w_per_m: one.fine.peak().unwrap_or(0.0),
            })
        };
        ShaftView { name: self.name.to_owned(), layers: self.parts.iter().filter_map(layer).collect() }
    }

    /// Whether it is one of those compared.
    pub(super) fn compared(&self) -> bool {
        self.parts.iter().all(|(one, _)| one.layout.role == Role::Compared)
    }
}

/// Writes the table of all shafts, where there are strata.
pub(super) fn write(folder: &Path, study: &Study<'_>, found: &[Found<'_>]) -> Result<(), Failure> {
    let rows: Vec<ShaftRow<'_>> = shafts(study, found).iter().filter_map(|shaft| shaft.row(study, found)).collect();
    if rows.is_empty() { Ok(()) } else { write_rows(folder, "shafts.csv", &rows) }
}

/// A shaft in words.
pub(super) fn words(row: &ShaftRow<'_>) -> String {
    let (name, depth, stratum) = (row.layout, row.depth_m, row.weakest_stratum);
    let closure = match row.closure_days {
        Some(day) => match row.reopened_days {
            Some(opens) => format!("closed on day {day:.2}, last in {stratum}, OPENS AGAIN on day {opens:.2}"),
            None => format!("closed on day {day:.2}, last in {stratum}"),
        },
        None => format!("open in {} of its strata, widest in {stratum}", row.open_strata),
    };
    let plant = row.plant_peak_kw.map_or(String::new(), |peak| format!(", plant at most {peak:.0} kW, mean of a day"));
    format!("{name}, all {depth} m: {closure}{plant}")
}
