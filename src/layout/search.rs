//! Search over one key: the least whole number that is in time, by halving, or the value of least energy that is, by Brent's
//! method.
//!
//! Halving takes for granted that more is earlier, as more pipes are. Each value that is tried is a layout in a folder of its own, so a
//! search that was stopped goes on where it stood: it asks for the same values again and finds them.

use std::cell::RefCell;

use argmin::core::{CostFunction, Executor};
use argmin::solver::brent::BrentOpt;
use frazil_plots::layouts::between;
use frazil_studies::failure::Failure;
use frazil_studies::parallel;
use serde::Serialize;

use super::ahead::{Ahead, Find};
use super::answers::{Answers, DAY};
use super::execute::Work;
use super::goals::{Goal, Search};
use super::study::Study;
use super::variants::Layout;

/// A value that was tried: a row of `search.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// The value.
    pub value: f64,
    /// Day on which the wall closed.
    pub closure_days: Option<f64>,
    /// Day on which it first opened again.
    pub reopened_days: Option<f64>,
    /// Day on which it was as designed.
    pub design_days: Option<f64>,
    /// Day on which it first was so no more.
    pub design_left_days: Option<f64>,
    /// Energy to the last day that is asked for (MJ by metre of depth).
    pub energy_mj_per_m: f64,
    /// Whether in time: closed by the day that is asked for, if one is, and to the end of the run, and designed likewise.
    pub in_time: bool,
    /// Whether it is the one that was searched.
    pub least: bool,
}

/// Refuses what cannot be run, before anything is.
pub(super) fn check(study: &Study<'_>, search: &Search, method: &str) -> Result<(), Failure> {
    for value in [search.from, search.to] {
        for layout in study.tried(search, value)? {
            layout.check(study.shaft_radius, method)?;
        }
    }
    Ok(())
}

/// How much more lateness weighs than energy: a day late by a thousandth outweighs all that is saved by it.
const PENALTY: f64 = 100.0;

/// Most steps of a search for the least energy.
const MOST: u64 = 60;

/// What a golden section leaves of a range, inverted.
const GOLDEN: f64 = 1.618;

/// What stops a search.
enum Stop {
    Interrupted,
    Failed(Failure),
}

/// Tries values.
struct Trials<'a> {
    study: &'a Study<'a>,
    search: &'a Search,
    find: &'a Find<'a>,
    threads: usize,
    tried: RefCell<Vec<Tried>>,
    stopped: RefCell<Option<Stop>>,
}

impl<'a> Trials<'a> {
    fn new(study: &'a Study<'a>, search: &'a Search, find: &'a Find<'a>, threads: usize) -> Self {
        Trials { study, search, find, threads, tried: RefCell::default(), stopped: RefCell::default() }
    }

    /// Tries values until the one searched is known, or says what stopped it.
    fn all(&self) -> Result<Option<Stop>, Failure> {
        match self.search.goal {
            Goal::Least => Ok(halve(self).err()),
            Goal::Energy => brent(self),
        }
    }

    /// Runs a value, or finds it.
    fn one(&self, value: f64) -> Result<Tried, Stop> {
        let Trials { study, search, find, threads, .. } = self;
        let layouts = study.tried(search, value).map_err(Stop::Failed)?;
        let run = |k: usize| Some(find(&layouts[k]));
        let mut parts = Vec::new();
        for (pair, layout) in parallel::runs(layouts.len(), *threads, run).into_iter().flatten().zip(&layouts) {
            let pair = pair.map_err(Stop::Failed)?.ok_or(Stop::Interrupted)?;
            let thickness = study.depth_of(layout).filter(|_| layout.stratum.is_some()).unwrap_or(1.0);
            parts.push((Answers::of(&layout.scene, &pair.fine, study.design_of(layout)), thickness));
        }
        // A shaft is closed once it is closed in all strata, and open once it is in one.
        let last = |day: fn(&Answers) -> Option<f64>| {
            let days: Option<Vec<f64>> = parts.iter().map(|(answers, _)| day(answers)).collect();
            days.and_then(|days| days.into_iter().reduce(f64::max))
        };
        let first =
            |day: fn(&Answers) -> Option<f64>| parts.iter().filter_map(|(answers, _)| day(answers)).reduce(f64::min);
        let (closure_days, design_days) = (last(|answers| answers.closure), last(|answers| answers.design));
        let (reopened_days, design_left_days) =
            (first(|answers| answers.reopening), first(|answers| answers.design_left));
        let energy = |answers: &Answers| between(&answers.energy, DAY * search.last_day()).unwrap_or(f64::NAN);
        let depth: f64 = parts.iter().map(|(_, thick)| thick).sum();
        let energy_mj_per_m = parts.iter().map(|(answers, thick)| thick * energy(answers)).sum::<f64>() / depth;
        let by = |asked: Option<f64>, day: Option<f64>| asked.is_none_or(|asked| day.is_some_and(|day| day <= asked));
        let stays = closure_days.is_some() && reopened_days.is_none();
        let designed =
            by(search.design_days, design_days) && (search.design_days.is_none() || design_left_days.is_none());
        let in_time = stays && by(search.closure_days, closure_days) && designed;
        let tried = Tried {
            value,
            closure_days,
            reopened_days,
            design_days,
            design_left_days,
            energy_mj_per_m,
            in_time,
            least: false,
        };
        self.tried.borrow_mut().push(tried.clone());
        Ok(tried)
    }

    /// Energy over that of the first value tried, and how late it is: a smooth fall towards what is in time. What never comes is
    /// later than all that comes, the less so the more energy was taken.
    fn merit(&self, one: &Tried) -> f64 {
        let first = self.tried.borrow().first().map_or(1.0, |first| first.energy_mj_per_m);
        let energy = one.energy_mj_per_m / first;
        let end = self.study.layouts.first().map_or(f64::INFINITY, |layout| layout.scene.duration / DAY);
        let late = |asked: Option<f64>, day: Option<f64>| match (asked, day) {
            (None, _) => 0.0,
            (Some(asked), Some(day)) => (day / asked - 1.0).max(0.0),
            (Some(asked), None) => end / asked + 1.0 / (1.0 + energy),
        };
        let days = late(self.search.closure_days, one.closure_days) + late(self.search.design_days, one.design_days);
        // What is in time but does not last is as bad as what never comes.
        let late = if days == 0.0 && !one.in_time { end / self.search.last_day() + 1.0 / (1.0 + energy) } else { days };
        energy + PENALTY * late
    }
}

impl CostFunction for &Trials<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, value: &f64) -> Result<f64, argmin::core::Error> {
        match self.one(*value) {
            Ok(one) => Ok(self.merit(&one)),
            Err(stop) => {
                *self.stopped.borrow_mut() = Some(stop);
                Err(argmin::core::Error::msg("stopped"))
            }
        }
    }
}

/// Values that a search tries, as a rule and at most.
fn values(search: &Search) -> (usize, usize) {
    let range = search.to - search.from;
    match search.goal {
        // Both ends, and the halvings between them.
        Goal::Least => {
            let all = 2 + range.log2().ceil() as usize;
            (all, all)
        }
        // The first, and one for each step. Golden sections narrow the range to what is asked for; parabolas are quicker.
        Goal::Energy => {
            let most = MOST as usize + 1;
            let sections = (range / search.within()).ln() / GOLDEN.ln();
            ((2.0 + sections.ceil()).min(most as f64) as usize, most)
        }
    }
}

/// What a search may still try beyond what is known.
pub(super) fn ahead(
    study: &Study<'_>,
    search: &Search,
    (method, threads): (&str, usize),
    known: &Find<'_>,
) -> Result<Ahead, Failure> {
    // The search itself, up to the first value that is not known.
    let trials = Trials::new(study, search, known, threads);
    if trials.all()?.is_none() {
        return Ok(Ahead::default());
    }
    let (likely, most) = values(search);
    let tried = trials.tried.into_inner().len();
    let middle = 0.5 * (search.from + search.to);
    let layouts = study.tried(search, if search.goal == Goal::Least { middle.floor() } else { middle })?;
    let counts = (likely.saturating_sub(tried).max(1), most.saturating_sub(tried).max(1));
    let at_once = threads.min(layouts.len());
    let each = |layout: &Layout| Ahead::of(counts, layout, method, at_once);
    Ok(layouts.iter().map(each).fold(Ahead::default(), Ahead::and))
}

/// Tries values until the one searched is known, in the order of the values; none if it was interrupted.
pub(super) fn search(study: &Study<'_>, search: &Search, work: &Work<'_>) -> Result<Option<Vec<Tried>>, Failure> {
    let find = |layout: &Layout| work.made(layout);
    let trials = Trials::new(study, search, &find, work.threads);
    match trials.all()? {
        Some(Stop::Interrupted) => return Ok(None),
        Some(Stop::Failed(failure)) => return Err(failure),
        None => {}
    }
    let mut tried = trials.tried.into_inner();
    let cost = |one: &Tried| if search.goal == Goal::Least { one.value } else { one.energy_mj_per_m };
    let best = tried.iter().filter(|one| one.in_time).map(cost).reduce(f64::min);
    tried.iter_mut().for_each(|one| one.least = one.in_time && Some(cost(one)) == best);
    tried.sort_by(|a, b| a.value.total_cmp(&b.value));
    Ok(Some(tried))
}

/// Halves the range in which the least value in time must lie; the one below it is always tried.
fn halve(trials: &Trials<'_>) -> Result<(), Stop> {
    let (from, to) = (trials.search.from, trials.search.to);
    if !trials.one(to)?.in_time {
        return Ok(());
    }
    let (mut late, mut in_time) = (from, if trials.one(from)?.in_time { from } else { to });
    while in_time - late > 1.0 {
        let middle = late + ((in_time - late) / 2.0).floor();
        if trials.one(middle)?.in_time { in_time = middle } else { late = middle }
    }
    Ok(())
}

/// The least energy, where the lateness of what is not in time counts as energy.
fn brent(trials: &Trials<'_>) -> Result<Option<Stop>, Failure> {
    let Search { from, to, .. } = trials.search;
    // Brent's method comes within three of its tolerances.
    let solver = BrentOpt::new(*from, *to).set_tolerance(f64::EPSILON.sqrt(), trials.search.within() / 3.0);
    let run = Executor::new(trials, solver).configure(|state| state.max_iters(MOST)).timer(false).run();
    match (trials.stopped.take(), run) {
        (Some(stop), _) => Ok(Some(stop)),
        (None, Ok(_)) => Ok(None),
        (None, Err(error)) => Err(Failure::of("search", error)),
    }
}

/// What was found, in words.
pub(super) fn words(search: &Search, tried: &[Tried]) -> String {
    let Search { key, from, to, .. } = search;
    let asked = [
        search.closure_days.map(|day| format!("closes by day {day}")),
        search.design_days.map(|day| format!("is as designed by day {day}")),
    ];
    let asked = asked.into_iter().flatten().collect::<Vec<_>>().join(" and ");
    let Some(one) = tried.iter().find(|one| one.least) else {
        return format!("{key} from {from} to {to}: none {asked}");
    };
    let day = |words: &str, day: Option<f64>| day.map_or(String::new(), |day| format!(", {words} on day {day:.2}"));
    let days = day("closed", one.closure_days.filter(|_| search.closure_days.is_some()))
        + &day("as designed", one.design_days.filter(|_| search.design_days.is_some()));
    match search.goal {
        Goal::Least => format!("{key} = {} is the least from {from} to {to} that {asked}{days}", one.value),
        Goal::Energy => format!(
            "{key} = {:.4} takes the least energy from {from} to {to} of all that {asked}{days}: {:.0} MJ/m to day {}, {} values \
             tried",
            one.value,
            one.energy_mj_per_m,
            search.last_day(),
            tried.len()
        ),
    }
}
