//! The greatest value of a key at which each layout still closes, as of the velocity of groundwater: by bisection.
//!
//! It takes for granted that more of it keeps a wall open that less of it keeps open.

use frazil_plots::canvas::Formats;
use frazil_plots::layouts::{CriticalView, critical_map};
use frazil_plots::page::{Block, Figure, Table};
use frazil_scene::Scene;
use frazil_studies::campaign::Meter;
use frazil_studies::failure::Failure;
use serde::Serialize;

use super::ahead::{Ahead, Find};
use super::answers::Answers;
use super::execute::Work;
use super::goals::Critical;
use super::study::Study;
use super::variants::Layout;

/// A value that was tried of a layout: a row of `critical_tried.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// The layout.
    pub layout: String,
    /// The value.
    pub value: f64,
    /// Day on which the wall closed.
    pub closure_days: Option<f64>,
    /// The gap that closed the wall, or the widest open one.
    pub weakest_from: String,
    /// The other pipe of it.
    pub weakest_to: String,
    /// Where its middle lies, from the x axis (degrees).
    pub weakest_deg: Option<f64>,
    /// Day on which the wall closed at twice the spacing.
    pub closure_at_twice_the_spacing_days: Option<f64>,
}

/// What was found of a layout: a row of `critical.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// The layout.
    pub layout: String,
    /// Widest distance of neighbours in the first ring (m).
    pub pipe_spacing_m: f64,
    /// The greatest value that was tried at which the wall closes; none if it never does.
    pub closes_up_to: Option<f64>,
    /// The least value that was tried at which it does not; none if it always closes.
    pub open_from: Option<f64>,
    /// Darcy velocity (m a day) whose heat a pipe beside a gap that has just closed can take, by a balance of heat.
    pub heat_balance_m_per_day: Option<f64>,
}

/// What was tried and found of all layouts.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// By layout and value.
    pub tried: Vec<Tried>,
    /// By layout.
    pub found: Vec<Found>,
}

/// Refuses what cannot be run, before anything is.
pub(super) fn check(study: &Study<'_>, critical: &Critical, method: &str) -> Result<(), Failure> {
    for layout in study.compared() {
        for value in &critical.values {
            study.changed(layout, &critical.key, &value.to_string())?.check(study.shaft_radius, method)?;
        }
    }
    Ok(())
}

/// Seeks the value of each layout, runs side by side; none if it was interrupted.
pub(super) fn seek(study: &Study<'_>, critical: &Critical, work: &Work<'_>) -> Result<Option<Outcome>, Failure> {
    let (layouts, campaign): (Vec<_>, _) = (study.compared().collect(), work.campaign);
    let find = |layout: &Layout| work.made(layout);
    let attempts = Attempts::new(study, critical, &find, work.quiet);
    let each = critical.values.len();
    let first = campaign.side_by_side(&vec![0.0; layouts.len() * each], |k| {
        campaign.or_stop(attempts.one(layouts[k / each], critical.values[k % each]))?
    })?;
    let sought = campaign.side_by_side(&vec![0.0; layouts.len()], |k| {
        let tried: Option<Vec<Tried>> = first[k * each..(k + 1) * each].iter().cloned().collect();
        campaign.or_stop(attempts.halve(layouts[k], tried?))?
    });
    attempts.meter.finish();
    let mut outcome = Outcome::default();
    for one in sought? {
        let Some((tried, found)) = one else { return Ok(None) };
        outcome.tried.extend(tried);
        outcome.found.push(found);
    }
    Ok(Some(outcome))
}

/// What may still be tried beyond what is known.
pub(super) fn ahead(
    study: &Study<'_>,
    critical: &Critical,
    (method, threads): (&str, usize),
    known: &Find<'_>,
) -> Result<Ahead, Failure> {
    let layouts: Vec<_> = study.compared().collect();
    let attempts = Attempts::new(study, critical, known, true);
    let left = |layout: &Layout| {
        let tried: Vec<_> =
            critical.values.iter().map(|value| attempts.one(layout, *value)).collect::<Result<_, _>>()?;
        let open = tried.iter().filter(|one| one.is_none()).count();
        let is_found = match tried.into_iter().collect::<Option<Vec<_>>>() {
            Some(tried) => attempts.halve(layout, tried)?.is_some(),
            None => false,
        };
        // Of those between two values none is left where all close.
        Ok::<_, Failure>(if is_found { 0 } else { open + critical.halvings() })
    };
    let (middle, at_once) = (critical.values[critical.values.len() / 2].to_string(), threads.min(layouts.len()));
    layouts.iter().try_fold(Ahead::default(), |ahead, layout| {
        let (left, example) = (left(layout)?, study.changed(layout, &critical.key, &middle)?);
        Ok(ahead.and(Ahead::of((left, left), 0, &example, (method, at_once))))
    })
}

/// What is tried, by all threads.
struct Attempts<'a> {
    study: &'a Study<'a>,
    critical: &'a Critical,
    find: &'a Find<'a>,
    meter: Meter,
    expected: usize,
}

impl<'a> Attempts<'a> {
    fn new(study: &'a Study<'a>, critical: &'a Critical, find: &'a Find<'a>, quiet: bool) -> Self {
        let expected = study.compared().count() * (critical.values.len() + critical.halvings());
        Attempts { study, critical, find, meter: Meter::new(quiet, expected as f64), expected }
    }

    /// Tries a value; none if it was interrupted.
    fn one(&self, layout: &Layout, value: f64) -> Result<Option<Tried>, Failure> {
        let tried = self.run(layout, value)?;
        self.meter.made(1.0, |done| format!("{}: {done} of about {} runs", self.critical.key, self.expected));
        Ok(tried)
    }

    fn run(&self, layout: &Layout, value: f64) -> Result<Option<Tried>, Failure> {
        let changed = self.study.changed(layout, &self.critical.key, &value.to_string())?;
        let Some(pair) = (self.find)(&changed)? else { return Ok(None) };
        let answers = Answers::of(&changed.scene, &pair.fine, None);
        let weakest = answers.weakest;
        Ok(Some(Tried {
            layout: layout.name.clone(),
            value,
            closure_days: answers.closure,
            weakest_deg: weakest.as_ref().map(|link| link.y_m.atan2(link.x_m).to_degrees()),
            weakest_from: weakest.as_ref().map(|link| link.from.clone()).unwrap_or_default(),
            weakest_to: weakest.map(|link| link.to).unwrap_or_default(),
            closure_at_twice_the_spacing_days: pair
                .coarse
                .as_ref()
                .and_then(|coarse| Answers::of(&changed.scene, coarse, None).closure),
        }))
    }

    /// Halves between the greatest value below which all close and the next.
    fn halve(&self, layout: &Layout, mut tried: Vec<Tried>) -> Result<Option<(Vec<Tried>, Found)>, Failure> {
        let first_open = tried.iter().position(|one| one.closure_days.is_none());
        let mut open = first_open.map(|k| tried[k].value);
        let mut closes = match first_open {
            None => tried.last().map(|one| one.value),
            Some(k) => k.checked_sub(1).map(|k| tried[k].value),
        };
        while let Some((low, high)) = closes.zip(open).filter(|(low, high)| high - low > self.critical.within) {
            let middle = 0.5 * (low + high);
            let Some(one) = self.one(layout, middle)? else { return Ok(None) };
            match one.closure_days {
                Some(_) => closes = Some(middle),
                None => open = Some(middle),
            }
            tried.push(one);
        }
        tried.sort_by(|a, b| a.value.total_cmp(&b.value));
        let found = Found {
            layout: layout.name.clone(),
            pipe_spacing_m: widest(&layout.scene),
            closes_up_to: closes,
            open_from: open,
            heat_balance_m_per_day: (self.critical.key == VELOCITY).then(|| balance(&layout.scene)).flatten(),
        };
        Ok(Some((tried, found)))
    }
}

const VELOCITY: &str = "flow.velocity_m_per_day";

/// Widest distance (m) of neighbours in the first ring.
fn widest(scene: &Scene) -> f64 {
    let Some(ring) = scene.rings.first() else { return 0.0 };
    let numbers: Vec<usize> = ring.numbers().collect();
    let next = |k: usize| numbers[(k + 1) % numbers.len()];
    let chords = (0..numbers.len()).map(|k| ring.place(numbers[k]).distance(ring.place(next(k))));
    chords.fold(0.0, f64::max)
}

/// Darcy velocity (m a day) at which the stream through a gap that has just closed brings as much heat as a pipe can take:
/// `2 pi k (Tf - Tp) / (C S (T0 - Tf) ln(S / 4 r))`, with the conductivity k of frozen ground, the heat capacity C of
/// water, the distance S and the radius r of pipes, and the temperatures of pipes, freezing and the ground. A balance of
/// magnitudes: the stream may go around a wall that is nearly closed, and its cooled part may reach the next pipes.
fn balance(scene: &Scene) -> Option<f64> {
    let [ring] = &scene.rings[..] else { return None };
    let material = scene.materials.first()?;
    let pores = material.pores?;
    let spacing = widest(scene);
    let cold = material.freezing_point - ring.condition.temperature()?.at(scene.duration);
    let warm = scene.initial_temperature - material.freezing_point;
    let slim = (spacing / (4.0 * ring.pipe_radius)).ln();
    if ring.one_particle || ring.condition.film().is_some() || cold <= 0.0 || warm <= 0.0 || slim <= 0.0 {
        return None;
    }
    let water = pores.water_density * pores.water_heat_capacity;
    let taken = std::f64::consts::TAU * material.frozen.conductivity * cold;
    Some(taken / (water * spacing * warm * slim) * super::answers::DAY)
}

/// What was found, for the page, and its figure as a file.
pub(super) fn block(critical: &Critical, outcome: &Outcome, work: &Work<'_>) -> Result<Block, Failure> {
    let views: Vec<CriticalView> = outcome
        .found
        .iter()
        .map(|found| CriticalView {
            name: found.layout.clone(),
            pipe_spacing_m: found.pipe_spacing_m,
            estimate: found.heat_balance_m_per_day,
            tried: outcome
                .tried
                .iter()
                .filter(|one| one.layout == found.layout)
                .map(|one| (one.value, one.closure_days))
                .collect(),
        })
        .collect();
    let canvas = critical_map(&views, &critical.key);
    canvas.write(&work.folder, "critical", Formats::ALL)?;
    let figure = Figure::new(
        &canvas,
        format!(
            "Above: the day on which the wall closes, by {}. Below: filled where it closes before the run ends, hollow where it \
             does not.",
            critical.key
        ),
        "critical",
    );
    let number = |value: Option<f64>, none: &str| value.map_or(none.to_owned(), |value| format!("{value:.4}"));
    let row = |one: &Found| {
        vec![
            one.layout.clone(),
            format!("{:.3}", one.pipe_spacing_m),
            number(one.closes_up_to, "never closes"),
            number(one.open_from, "always closes"),
            number(one.heat_balance_m_per_day, ""),
        ]
    };
    let heads = ["layout", "widest pipe spacing (m)", "closes up to", "open from", "heat balance (m/day)"];
    let summary = Table {
        caption: format!("{} at which the wall closes before the run ends, and at which it does not.", critical.key),
        heads: heads.map(String::from).into(),
        rows: outcome.found.iter().map(row).collect(),
        words: 1,
        csv: Some("critical.csv".into()),
    };
    let row = |one: &Tried| {
        let day = |day: Option<f64>| day.map_or("not closed".to_owned(), |day| format!("{day:.2}"));
        vec![
            one.layout.clone(),
            format!("{} to {}", one.weakest_from, one.weakest_to),
            one.weakest_deg.map_or(String::new(), |degrees| format!("{degrees:.0}")),
            format!("{}", one.value),
            day(one.closure_days),
            day(one.closure_at_twice_the_spacing_days),
        ]
    };
    let heads =
        ["layout", "weakest gap", "at (degrees)", &critical.key, "wall closes (day)", "at twice the spacing (day)"];
    let tried = Table {
        caption: "All that was tried. The weakest gap is the one that closed the wall, or the widest open one.".into(),
        heads: heads.map(String::from).into(),
        rows: outcome.tried.iter().map(row).collect(),
        words: 2,
        csv: Some("critical_tried.csv".into()),
    };
    let heading = "How much keeps the wall open".into();
    Ok(Block { heading, figures: vec![figure], tables: vec![summary, tried], ..Block::default() })
}
