//! Search over one key: the least whole number that is in time, or the value of least energy that is, by Brent's method.
//!
//! The least number takes for granted that more is earlier, as more pipes are. Runs at twice the spacing, which each layout needs anyway
//! and which take an eighth of the time, say where the least is about; it and the one below it are then run as layouts are, and others
//! from there on where the coarse runs were wrong. What is tried is kept, so a search that was stopped goes on where it stood: it
//! asks for the same values again and finds them.

use std::cell::RefCell;

use argmin::core::{CostFunction, Executor};
use argmin::solver::brent::BrentOpt;
use frazil_plots::layouts::between;
use frazil_studies::failure::Failure;
use frazil_studies::parallel;
use serde::Serialize;

use super::ahead::{Ahead, Find, Known};
use super::answers::{Answers, DAY, Kept};
use super::execute::{Coarse, Work};
use super::goals::{Goal, Search};
use super::study::Study;
use super::variants::Layout;

/// A value that was tried: a row of `search.csv`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tried {
    /// The value.
    pub value: f64,
    /// Spacing of its runs (m): that of the method, or twice that.
    pub spacing_m: f64,
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
    known: Known<'a>,
    method: &'a str,
    threads: usize,
    tried: RefCell<Vec<Tried>>,
    stopped: RefCell<Option<Stop>>,
}

impl<'a> Trials<'a> {
    fn new(study: &'a Study<'a>, search: &'a Search, known: Known<'a>, (method, threads): (&'a str, usize)) -> Self {
        Trials { study, search, known, method, threads, tried: RefCell::default(), stopped: RefCell::default() }
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
        let layouts = self.study.tried(self.search, value).map_err(Stop::Failed)?;
        let pairs = self.each(&layouts, self.known.layout)?;
        Ok(self.judge(value, 1.0, &layouts, pairs.into_iter().map(|pair| pair.fine)))
    }

    /// The same at twice the spacing; none where that is too coarse in some stratum.
    fn coarse(&self, value: f64) -> Result<Option<Tried>, Stop> {
        let layouts = self.study.tried(self.search, value).map_err(Stop::Failed)?;
        let runs = self.each(&layouts, self.known.coarse)?;
        let kept: Option<Vec<Kept>> = runs.into_iter().map(|Coarse { kept, .. }| kept).collect();
        Ok(kept.map(|kept| self.judge(value, 2.0, &layouts, kept.into_iter())))
    }

    /// What is found of each layout.
    fn each<T: Send>(&self, layouts: &[Layout], find: &Find<'_, T>) -> Result<Vec<T>, Stop> {
        let found = parallel::runs(layouts.len(), self.threads, |k| Some(find(&layouts[k])));
        found.into_iter().flatten().map(|one| one.map_err(Stop::Failed)?.ok_or(Stop::Interrupted)).collect()
    }

    /// What the runs of a value in all strata say together, at so many times the spacing of the method.
    fn judge(&self, value: f64, coarser: f64, layouts: &[Layout], runs: impl Iterator<Item = Kept>) -> Tried {
        let Trials { study, search, .. } = self;
        let part = |(kept, layout): (Kept, &Layout)| {
            let thickness = study.depth_of(layout).filter(|_| layout.stratum.is_some()).unwrap_or(1.0);
            (Answers::of(&layout.scene, &kept, study.design_of(layout)), thickness)
        };
        let parts: Vec<(Answers, f64)> = runs.zip(layouts).map(part).collect();
        // A shaft is closed once it is closed in all strata, and open once it is in one.
        let last = |day: fn(&Answers) -> Option<f64>| {
            let days: Option<Vec<f64>> = parts.iter().map(|(answers, _)| day(answers)).collect();
            days.and_then(|days| days.into_iter().reduce(f64::max))
        };
        let first =
            |day: fn(&Answers) -> Option<f64>| parts.iter().filter_map(|(answers, _)| day(answers)).reduce(f64::min);
        let (closure_days, design_days) = (last(|answers| answers.closure), last(|answers| answers.design));
        let (reopened_days, design_left_days) = (
            first(|answers| answers.reopening),
            first(|answers| answers.design_left).filter(|_| design_days.is_some()),
        );
        let energy = |answers: &Answers| between(&answers.energy, DAY * search.last_day()).unwrap_or(f64::NAN);
        let depth: f64 = parts.iter().map(|(_, thick)| thick).sum();
        let energy_mj_per_m = parts.iter().map(|(answers, thick)| thick * energy(answers)).sum::<f64>() / depth;
        let by = |asked: Option<f64>, day: Option<f64>| asked.is_none_or(|asked| day.is_some_and(|day| day <= asked));
        let stays = closure_days.is_some() && reopened_days.is_none();
        let designed =
            by(search.design_days, design_days) && (search.design_days.is_none() || design_left_days.is_none());
        let in_time = stays && by(search.closure_days, closure_days) && designed;
        let spacing = layouts.first().and_then(|layout| layout.scene.method(self.method));
        let tried = Tried {
            value,
            spacing_m: coarser * spacing.map_or(f64::NAN, |settings| settings.numerics.spacing),
            closure_days,
            reopened_days,
            design_days,
            design_left_days,
            energy_mj_per_m,
            in_time,
            least: false,
        };
        self.tried.borrow_mut().push(tried.clone());
        tried
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

/// Values that a search tries, as a rule and at most; and how many more at twice the spacing.
fn values(search: &Search) -> ((usize, usize), usize) {
    let range = search.to - search.from;
    match search.goal {
        // The least and the one below it; or ever longer strides from there, and their halvings. Coarse runs are hardly more than
        // halvings would be.
        Goal::Least => {
            let halvings = range.log2().ceil() as usize;
            ((2, 2 + 2 * halvings), 2 + halvings)
        }
        // The first, and one for each step. Golden sections narrow the range to what is asked for; parabolas are quicker.
        Goal::Energy => {
            let most = MOST as usize + 1;
            let sections = (range / search.within()).ln() / GOLDEN.ln();
            (((2.0 + sections.ceil()).min(most as f64) as usize, most), 0)
        }
    }
}

/// What a search may still try beyond what is known.
pub(super) fn ahead(
    study: &Study<'_>,
    search: &Search,
    (method, threads): (&str, usize),
    known: Known<'_>,
) -> Result<Ahead, Failure> {
    // The search itself, up to the first value that is not known.
    let trials = Trials::new(study, search, known, (method, threads));
    if trials.all()?.is_none() {
        return Ok(Ahead::default());
    }
    let ((likely, most), coarse) = values(search);
    let tried = trials.tried.into_inner();
    let middle = 0.5 * (search.from + search.to);
    let layouts = study.tried(search, if search.goal == Goal::Least { middle.floor() } else { middle })?;
    let spacing = layouts.first().and_then(|layout| layout.scene.method(method));
    let spacing = spacing.map_or(f64::INFINITY, |settings| settings.numerics.spacing);
    let whole = tried.iter().filter(|one| one.spacing_m < 1.5 * spacing).count();
    let coarse = coarse.saturating_sub(tried.len() - whole);
    let counts = (likely.saturating_sub(whole).max(1), most.saturating_sub(whole).max(1));
    let at_once = threads.min(layouts.len());
    let each = |layout: &Layout| Ahead::of(counts, coarse, layout, (method, at_once));
    Ok(layouts.iter().map(each).fold(Ahead::default(), Ahead::and))
}

/// Tries values until the one searched is known, in the order of the values; none if it was interrupted.
pub(super) fn search(study: &Study<'_>, search: &Search, work: &Work<'_>) -> Result<Option<Vec<Tried>>, Failure> {
    let known = Known { layout: &|layout| work.made(layout), coarse: &|layout| work.made_coarse(layout) };
    let trials = Trials::new(study, search, known, (work.method, work.threads));
    match trials.all()? {
        Some(Stop::Interrupted) => return Ok(None),
        Some(Stop::Failed(failure)) => return Err(failure),
        None => {}
    }
    let mut tried = trials.tried.into_inner();
    let cost = |one: &Tried| if search.goal == Goal::Least { one.value } else { one.energy_mj_per_m };
    let finest = tried.iter().map(|one| one.spacing_m).fold(f64::INFINITY, f64::min);
    let counts = |one: &Tried| one.in_time && one.spacing_m == finest;
    let best = tried.iter().filter(|one| counts(one)).map(cost).reduce(f64::min);
    tried.iter_mut().for_each(|one| one.least = counts(one) && Some(cost(one)) == best);
    tried.sort_by(|a, b| a.value.total_cmp(&b.value).then(b.spacing_m.total_cmp(&a.spacing_m)));
    Ok(Some(tried))
}

/// Finds the least value in time from the one that coarse runs tell, by strides that double until one is in time and one is not, and
/// by halving between them; the one below it is always tried.
fn halve(trials: &Trials<'_>) -> Result<(), Stop> {
    let (from, to) = (trials.search.from, trials.search.to);
    let (mut late, mut in_time) = (from - 1.0, None);
    let (mut next, mut stride) = (least_coarse(trials)?.unwrap_or(to), 1.0);
    loop {
        if trials.one(next)?.in_time {
            in_time = Some(next)
        } else {
            late = next
        }
        next = match in_time {
            Some(least) if least - late <= 1.0 => return Ok(()),
            Some(least) if late >= from => late + ((least - late) / 2.0).floor(),
            Some(least) => (least - stride).max(from),
            None if late >= to => return Ok(()),
            None => (late + stride).min(to),
        };
        stride *= 2.0;
    }
}

/// The least value that is in time at twice the spacing; none if there is none, or that is too coarse. Between a value that is late and
/// one that is in time the next is where the lateness of both, by powers of the value, tells; where that did not halve what is left, or
/// days are missing, the middle is.
fn least_coarse(trials: &Trials<'_>) -> Result<Option<f64>, Stop> {
    let (from, to) = (trials.search.from, trials.search.to);
    let Some(mut least) = trials.coarse(to)?.filter(|one| one.in_time) else { return Ok(None) };
    let mut late = match trials.coarse(from)? {
        Some(one) if one.in_time => return Ok(Some(from)),
        Some(one) => one,
        None => return Ok(None),
    };
    let mut is_told = true;
    while least.value - late.value > 1.0 {
        let left = least.value - late.value;
        let told = crossing(trials.search, [&late, &least]).filter(|_| is_told);
        let middle = late.value + (left / 2.0).floor();
        let next = told.map_or(middle, |told| told.ceil().clamp(late.value + 1.0, least.value - 1.0));
        let Some(one) = trials.coarse(next)? else { return Ok(None) };
        if one.in_time {
            least = one
        } else {
            late = one
        }
        // From a value that is too late by little, the next one is looked at, not the middle.
        is_told = least.value - late.value <= left / 2.0 + 1.0;
    }
    Ok(Some(least.value))
}

/// Where two values, one late and one in time, tell that what is asked for is met just in time: days go with a power of the value.
fn crossing(search: &Search, [late, in_time]: [&Tried; 2]) -> Option<f64> {
    let behind = |asked: Option<f64>, day: fn(&Tried) -> Option<f64>| {
        let Some(asked) = asked else { return Some(f64::NEG_INFINITY) };
        let [before, after] = [day(late)?, day(in_time)?].map(|day| (day / asked).ln());
        let share = before / (before - after);
        let is_met = before <= 0.0;
        let crossing = late.value * (in_time.value / late.value).powf(share);
        Some(if is_met { f64::NEG_INFINITY } else { crossing }).filter(|value| !value.is_nan())
    };
    let closure = behind(search.closure_days, |one| one.closure_days)?;
    let design = behind(search.design_days, |one| one.design_days)?;
    Some(closure.max(design)).filter(|value| value.is_finite())
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
        Goal::Least => format!("{key} = {} is the smallest value from {from} to {to} that {asked}{days}", one.value),
        Goal::Energy => format!(
            "{key} = {:.4} needs the least energy from {from} to {to} of all values that {asked}{days}: {:.0} MJ/m to day {}, {} values \
             tried",
            one.value,
            one.energy_mj_per_m,
            search.last_day(),
            tried.len()
        ),
    }
}
