//! What a study asks of its layouts: a design, what is searched or sought, and how layouts are varied.

use std::collections::BTreeMap;

use frazil_scene::{Range, Read, Section, Spot};

/// A relative error of days of closure and of thicknesses at the end for which a spacing was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Promise {
    /// The error.
    pub error: f64,
    /// The least order at which errors of a layout fall with the spacing.
    pub order: f64,
    /// What coarse and fine runs of each layout promise of it, by its name.
    pub promised: BTreeMap<String, f64>,
}

/// What a wall must come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Design {
    /// Thickness where the wall is weakest: frozen length on the least frozen way through it (m).
    pub thickness_m: f64,
    /// Mean temperature on that way.
    pub mean_temperature_c: f64,
}

impl Design {
    /// The section `design`, if there is one.
    pub(super) fn read(parent: &mut Section<'_>) -> Option<Design> {
        let mut section = parent.optional_section("design")?;
        let thickness = section.number(("thickness", "m"), Range::NOT_NEGATIVE);
        let mean = section.number(("mean_temperature", "c"), Range::above(section.units().absolute_zero()));
        Some(Design { thickness_m: thickness.ok()?, mean_temperature_c: mean.ok()? })
    }
}

/// What is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goal {
    /// The least whole number.
    Least,
    /// The value that takes the least energy.
    Energy,
}

/// The value of a key that is best of all at which the wall is in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// The key, as `pipes.1.count`.
    pub key: String,
    /// The least value.
    pub from: f64,
    /// The greatest value.
    pub to: f64,
    /// What is best.
    pub goal: Goal,
    /// Day by which the wall must have closed.
    pub closure_days: Option<f64>,
    /// Day by which it must be as designed.
    pub design_days: Option<f64>,
    /// How near to the best value the search has to come.
    pub within: Option<f64>,
}

/// Widest range of whole numbers that is searched.
const WIDEST: f64 = 10_000.0;

impl Search {
    /// Reads the section `search` of a study with a design or without.
    pub(super) fn read(section: &mut Section<'_>, designed: bool) -> Read<Search> {
        const CLOSURE: (&str, &str) = ("closure", "days");
        const DESIGN: (&str, &str) = ("design", "days");
        let key = section.text("key");
        let goal = section.choice_or("goal", &[("least", Goal::Least), ("energy", Goal::Energy)], Goal::Least);
        let from = section.number("from", Range::ANY);
        let to = section.number("to", from.map_or(Range::ANY, Range::above));
        let ends = from.and_then(|from| Ok((from, to?)));
        section.at_least_one(&[CLOSURE.into(), DESIGN.into()]);
        let closure_days = section.optional_number(CLOSURE, Range::POSITIVE);
        let design_days = section.optional_number(DESIGN, Range::POSITIVE);
        if design_days.is_some() && !designed {
            section.problem(DESIGN, "needs a \"design\"");
        }
        let within = match goal {
            Goal::Least => {
                section.refuse("within", "the smallest whole number is exact");
                None
            }
            Goal::Energy => {
                let range = ends.map_or(Range::POSITIVE, |(from, to)| Range::inside(0.0, to - from));
                section.optional_number("within", range)
            }
        };
        let (from, to) = ends?;
        if goal == Goal::Least {
            for (key, value) in [("from", from), ("to", to)] {
                if value.fract() != 0.0 {
                    section.problem(
                        key,
                        format!("found {value}, must be whole, because the smallest whole number is searched"),
                    );
                }
            }
            if to - from > WIDEST {
                section.problem("to", format!("found {to}, must be at most {WIDEST} above \"from\""));
            }
        }
        Ok(Search { key: key?, from, to, goal, closure_days, design_days, within })
    }

    /// The last of the days that are asked for.
    pub fn last_day(&self) -> f64 {
        self.closure_days.into_iter().chain(self.design_days).fold(0.0, f64::max)
    }

    /// How near to the best value the search has to come: a hundredth of the range, if nothing is said.
    pub fn within(&self) -> f64 {
        self.within.unwrap_or(0.01 * (self.to - self.from))
    }
}

/// The greatest value of a key at which each layout still closes.
#[derive(Debug, Clone, PartialEq)]
pub struct Critical {
    /// The key, as `flow.velocity_m_per_day`.
    pub key: String,
    /// Values that are tried in any case, increasing.
    pub values: Vec<f64>,
    /// How closely the value is sought between them.
    pub within: f64,
}

/// Most values, and most halvings between two of them.
const MOST: usize = 30;

impl Critical {
    /// Reads the section `critical`.
    pub(super) fn read(section: &mut Section<'_>) -> Read<Critical> {
        let key = section.text("key");
        let values = section.numbers("values", Range::ANY);
        let within = section.positive("within");
        let values = values?;
        if !(2..=MOST).contains(&values.len()) {
            return Err(section.problem("values", format!("found {} numbers, must be 2 to {MOST}", values.len())));
        }
        if let Some(pair) = values.windows(2).find(|pair| pair[0] >= pair[1]) {
            return Err(section.problem("values", format!("found {} after {}, must increase", pair[1], pair[0])));
        }
        let critical = Critical { key: key?, values, within: within? };
        if critical.halvings() > MOST {
            let message =
                format!("found {}, must be reachable by {MOST} bisections between two values", critical.within);
            section.problem("within", message);
        }
        Ok(critical)
    }

    /// Halvings of the widest gap between two values, at most.
    pub(super) fn halvings(&self) -> usize {
        let widest = self.values.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        // The cast of a value beyond the range gives the greatest there is.
        (widest / self.within).log2().max(0.0).ceil() as usize
    }
}

/// Keys that are changed up and down.
#[derive(Debug, Clone)]
pub(super) struct Sensitivity {
    pub(super) percent: f64,
    /// The keys and where they stand.
    pub(super) keys: Vec<(String, Spot)>,
}

impl Sensitivity {
    /// Reads the section `sensitivity`.
    pub(super) fn read(section: &mut Section<'_>) -> Read<Sensitivity> {
        let percent = section.number("percent", Range::inside(0.0, 100.0));
        Ok(Sensitivity { keys: section.texts("keys"), percent: percent? })
    }
}

/// Boreholes that deviate by chance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Deviation {
    /// Depth (m) at which boreholes are read, where there are no strata that say it.
    pub(super) depth: Option<f64>,
    pub(super) percent: f64,
    pub(super) members: usize,
    pub(super) seed: u64,
}

impl Deviation {
    /// Reads the section `deviation` of a study with strata or without.
    pub(super) fn read(section: &mut Section<'_>, layered: bool) -> Read<Deviation> {
        let depth = depth(section, layered, Range::POSITIVE);
        let percent = section.number("percent", Range::inside(0.0, 100.0));
        let members = section.integer("members", 2..=1000);
        let seed = section.integer("seed", 0..=i64::MAX as usize);
        Ok(Deviation { depth: depth?, percent: percent?, members: members?, seed: seed? as u64 })
    }
}

/// The depth (m) at which boreholes are read, which strata have each for itself.
pub(super) fn depth(section: &mut Section<'_>, layered: bool, range: Range) -> Read<Option<f64>> {
    const DEPTH: (&str, &str) = ("depth", "m");
    if layered {
        section.refuse(DEPTH, "boreholes are evaluated at the depth of each stratum");
        return Ok(None);
    }
    section.number(DEPTH, range).map(Some)
}
