//! Errors of the runs of a ladder, by what they differ from each other.

use std::f64::consts::SQRT_2;

use frazil_core::physics::material::Material;
use frazil_record::RunResult;
use frazil_scene::{Front, Scene};
use frazil_simulation::measure;
use frazil_simulation::measure::front::Judged;

use super::{Ladder, NOISE, Rung};
use crate::cheapest::estimate::Estimate;
use crate::compare::reference::{LocalReference, judge_alike};
use crate::ensemble::runs::Headline;

/// Ratio of spacings from which on two runs tell of an order.
pub(super) const APART: f64 = 1.5;

/// Part of a particle to which a front stands between two.
const WHOLE: f64 = 1e-6;

/// What a run differs from a finer one, over what the finer one says; none where one of both does not say.
pub type Differ<'a> = dyn Fn(&RunResult, &RunResult) -> Option<f64> + Sync + 'a;

/// What the error is of.
#[derive(Clone, Copy)]
pub enum Quantity<'a> {
    /// What runs are judged by elsewhere, too.
    Headline(Headline),
    /// An answer in one number, where fronts meet.
    Answer(&'a Differ<'a>),
}

/// What is promised of all runs.
pub(super) struct Promised {
    /// Errors, from coarse to fine.
    pub(super) errors: Vec<f64>,
    /// Observed order.
    pub(super) order: f64,
}

impl Ladder<'_> {
    /// Takes the first headline that both of the first runs have, where nothing else was asked for.
    pub(super) fn find_headline(&mut self) {
        let (true, [coarse, fine]) = (self.quantities.is_empty(), &self.rungs[..]) else { return };
        let apart = |headline: Headline| {
            self.differ(Quantity::Headline(headline), coarse.spacing, &coarse.result, &fine.result)
        };
        let known = |headline: &Headline| apart(*headline).is_some();
        self.quantities = Headline::ALL.into_iter().find(known).map(Quantity::Headline).into_iter().collect();
    }

    /// What a run differs from a finer one in the quantity in which it differs most.
    pub(super) fn difference(&self, coarse: &RunResult, fine: &RunResult) -> Option<f64> {
        let coarsest = self.rungs.first()?.spacing;
        let all = self.quantities.iter().map(|quantity| self.differ(*quantity, coarsest, coarse, fine));
        all.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::max)
    }

    /// The same of one quantity, where runs of a spacing (m) are judged: the coarser, the later and the farther from walls.
    fn differ(&self, quantity: Quantity<'_>, spacing: f64, coarse: &RunResult, fine: &RunResult) -> Option<f64> {
        let headline = match quantity {
            Quantity::Headline(headline) => headline,
            Quantity::Answer(differ) => return differ(coarse, fine),
        };
        let truth = LocalReference::new(&self.base, fine.clone());
        let mut judged = self.base.clone();
        judge_alike(&mut judged, spacing, &truth);
        headline.of(&measure::errors(&judged, spacing, coarse, &truth)).map(f64::abs)
    }

    /// What a sharp front may be off while it stands between a particle that is frozen and one that is not, as in a steady state: wherever
    /// it is, it is told to be midway, and finer runs may tell the same for long.
    fn standing(&self, quantity: Quantity<'_>, rung: &Rung) -> f64 {
        if !matches!(quantity, Quantity::Headline(Headline::Front)) || !is_sharp(&self.base) {
            return 0.0;
        }
        let own = LocalReference::new(&self.base, rung.result.clone());
        let window = measure::front::window(&self.base, rung.spacing, &rung.result.front, &own);
        let stands = |row: &&Judged| {
            let particles = row.own / rung.spacing;
            (particles - particles.round()).abs() < WHOLE
        };
        let squares = window.iter().filter(stands).map(|row| (0.5 * rung.spacing / row.far).powi(2)).sum::<f64>();
        (squares / window.len().max(1) as f64).sqrt()
    }

    /// The noise of one run at the finest spacing.
    pub(super) fn noise(&self) -> Option<f64> {
        let finest = self.rungs.last()?;
        Some(self.difference(finest.second.as_ref()?, &finest.result)? / SQRT_2)
    }

    /// Errors that are promised of all runs, of the quantity that is worst.
    pub(super) fn promised(&self) -> Option<Promised> {
        let all = self.quantities.iter().map(|quantity| self.promised_of(*quantity));
        let all = all.collect::<Option<Vec<Promised>>>()?;
        all.into_iter().reduce(|one, other| {
            let errors = one.errors.iter().zip(&other.errors).map(|(one, other)| one.max(*other)).collect();
            let worst = if one.errors.last() < other.errors.last() { other.order } else { one.order };
            Promised { errors, order: worst }
        })
    }

    /// The same of one quantity: by those runs that are apart, and of the others by what they differ from the finest. Runs that are so
    /// coarse that they do not say it are promised nothing.
    fn promised_of(&self, quantity: Quantity<'_>) -> Option<Promised> {
        let coarsest = self.rungs.first()?.spacing;
        let judged = |spacing: f64, coarse: usize, fine: usize| {
            self.differ(quantity, spacing, &self.rungs[coarse].result, &self.rungs[fine].result)
        };
        let between = |coarse: usize, fine: usize| judged(coarsest, coarse, fine);
        let finest = self.rungs.len().checked_sub(1)?;
        // All are held against each other where the coarsest is judged; a finer one is judged by more.
        let by_more = |k: usize| {
            let own = k.min(finest.saturating_sub(1));
            let wider = judged(self.rungs[own].spacing, own, finest).zip(between(own, finest));
            let ratio = wider.map(|(wider, usual)| wider / usual).filter(|ratio| ratio.is_finite());
            ratio.map_or(1.0, |ratio| ratio.max(1.0))
        };
        let (mut apart, mut differences) = (vec![finest], Vec::new());
        for k in (0..finest).rev() {
            let finer = *apart.last()?;
            if self.rungs[k].spacing < APART * self.rungs[finer].spacing {
                continue;
            }
            let Some(difference) = between(k, finer) else { break };
            apart.push(k);
            differences.push(difference);
        }
        apart.reverse();
        differences.reverse();
        let spacings: Vec<f64> = apart.iter().map(|k| self.rungs[*k].spacing).collect();
        let estimate = Estimate::of(&spacings, &differences, formal_order(&self.base, self.kind.name, quantity))?;
        let (noise, steps) = (NOISE * self.noise().unwrap_or(0.0), self.steps_alone());
        let errors = (0..=finest).map(|k| {
            let space = match apart.iter().position(|own| *own == k) {
                Some(place) => Some(estimate.promised[place]),
                None => {
                    between(k, finest).zip(estimate.promised.last()).map(|(apart, own)| estimate.safety * apart + own)
                }
            };
            let space = space.map(|space| (by_more(k) * space).max(self.standing(quantity, &self.rungs[k])));
            space.map_or(f64::INFINITY, |space| (space + steps).hypot(noise))
        });
        let mut errors: Vec<f64> = errors.collect();
        // Where a coarser run seems better than a finer one, it is so by chance.
        for k in (0..finest).rev() {
            errors[k] = errors[k].max(errors[k + 1]);
        }
        Some(Promised { errors, order: estimate.order })
    }
}

/// Whether ground freezes at one temperature.
fn is_sharp(scene: &Scene) -> bool {
    !scene.of_water && scene.materials.iter().any(Material::is_sharp)
}

/// The order that the error of the spacing has: a sharp front that is felt at the centres of particles is of the first.
fn formal_order(scene: &Scene, method: &str, quantity: Quantity<'_>) -> f64 {
    let front = scene.method(method).map(|own| own.numerics.front);
    // A closure is that of fronts that meet, at any angle to the lattice.
    let meets = matches!(quantity, Quantity::Headline(Headline::Closure) | Quantity::Answer(_));
    if is_sharp(scene) && (meets || front != Some(Front::SubCell)) { 1.0 } else { 2.0 }
}
