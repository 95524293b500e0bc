//! The rates of a solute, and the same for small changes.

use crate::balances::row::Row;
use crate::balances::solute::limit::Held;
use crate::balances::solute::pairs::Pairs;
use crate::balances::solute::walls::Walls;
use crate::balances::solute::{Solute, concentration};
use crate::boundary::patch::MOST_PATCHES;
use crate::kernels::enthalpy_rows::bandwidth;
use crate::kernels::list_parts::ListParts;
use crate::ledger::Sum;
use crate::solvers::balance::{Balance, BalanceFacts, Rates, Tangent, TangentShape, Update};
use crate::solvers::passenger::Passenger;
use crate::solvers::step::Clock;
use crate::team::Team;

/// Entries of a row that are summed side by side, so that none waits for the last.
const ABREAST: usize = 4;

impl Balance for Solute {
    fn facts(&self) -> &BalanceFacts {
        &self.facts
    }

    fn rate(&mut self, content: &[f64], clock: &Clock, rates: &mut Rates<'_>) {
        self.bring_to(content, clock);
        if self.pairs.limits {
            self.gather();
            self.limit(content, clock.step);
            self.take_back(rates.of_particles);
        } else {
            let Solute { list, pairs, walls, concentrations, .. } = &*self;
            list.in_tasks(rates.of_particles, |first, rates| {
                for (i, rate) in (first..).zip(rates) {
                    *rate = gain(list, pairs, concentrations, i);
                }
            });
            for mouth in &walls.mouths {
                let own = concentrations[mouth.particle as usize];
                rates.of_particles[mouth.particle as usize] += mouth.exchange * (walls.brought(mouth) - own);
            }
        }
        self.book(rates.patches);
        self.decay(content, rates);
    }

    fn advance(&mut self, update: Update<'_, '_>, clock: &Clock, patches: &mut [f64]) {
        let mut rate = std::mem::take(&mut self.rate);
        match update {
            Update::Euler(content) => {
                (self as &mut dyn Balance).rates(content, clock, &mut rate, patches);
                for (content, rate) in content.iter_mut().zip(&rate) {
                    *content += clock.step * rate;
                }
            }
            Update::Stage(stage, columns) => {
                (self as &mut dyn Balance).rates(columns.newest, clock, &mut rate, patches);
                stage.take(self.list.team.as_ref(), columns, &rate);
            }
        }
        self.rate = rate;
    }

    fn team(&self) -> Option<&Team> {
        self.list.team.as_ref()
    }

    fn tangent(&mut self) -> &mut dyn Tangent {
        self
    }

    fn passenger_mut(&mut self) -> Option<&mut dyn Passenger> {
        Some(self)
    }
}

/// Exchange that may be taken back stays: what is limited has no linearisation of its own.
impl Tangent for Solute {
    fn shape(&mut self) -> TangentShape {
        TangentShape { is_symmetric: false, is_constant: false, is_steep: false, bandwidth: bandwidth(&self.list) }
    }

    fn linearise(&mut self, content: &[f64], time: f64, slopes: &mut [f64]) {
        self.bring_to(content, &Clock { time, step: 0.0, index: 0, turned: false });
        for (slope, holds) in slopes.iter_mut().zip(&self.holds) {
            *slope = if *holds > 0.0 { 1.0 / holds } else { 0.0 };
        }
    }

    fn act(&mut self, concentrations: &[f64], rate: &mut [f64]) {
        self.changes[..concentrations.len()].copy_from_slice(concentrations);
        self.walls.fill_changes(&self.list.ghosts, &mut self.changes);
        let Solute { list, pairs, walls, changes, holds, .. } = &*self;
        list.in_tasks(rate, |first, rates| {
            for (i, rate) in (first..).zip(rates) {
                *rate = gain(list, pairs, changes, i) - self.material(i).decay * holds[i] * changes[i];
            }
        });
        for mouth in &walls.mouths {
            rate[mouth.particle as usize] -= mouth.exchange * changes[mouth.particle as usize];
        }
    }

    fn steepest(&mut self) -> Vec<f64> {
        let least = |i: usize| self.holding(i, 0.0).min(self.holding(i, 1.0));
        (0..self.holds.len()).map(|i| if least(i) > 0.0 { 1.0 / least(i) } else { 0.0 }).collect()
    }
}

impl Solute {
    /// Brings cuts, walls and concentrations to a state.
    fn bring_to(&mut self, content: &[f64], clock: &Clock) {
        let share = if clock.step > 0.0 { self.state_time(clock) } else { clock.time };
        let share = self.share(share);
        let Solute { list, images, walls, pairs, .. } = self;
        if list.cuts.bring_to(clock.time, &mut list.pairs.weights) {
            pairs.cut(list, images, walls);
        }
        walls.bring_to(clock.time);
        let mut holds = std::mem::take(&mut self.holds);
        self.list.in_tasks(&mut holds, |first, holds| {
            for (i, holds) in (first..).zip(holds) {
                *holds = self.holding(i, share);
            }
        });
        for (found, (content, holds)) in self.concentrations.iter_mut().zip(content.iter().zip(&holds)) {
            *found = concentration(*content, *holds);
        }
        self.holds = holds;
        self.walls.fill(&self.list.ghosts, &mut self.concentrations);
    }

    /// What an entry's exchange sees that may be taken back: a particle, or the one that a ghost mirrors.
    #[inline(always)]
    fn seen(&self, partner: usize) -> usize {
        match partner.checked_sub(self.holds.len()) {
            None => partner,
            Some(ghost) => self.images[ghost].original as usize,
        }
    }

    /// What each particle gains with all of the exchange, and what lies around it.
    fn gather(&mut self) {
        let mut rows = std::mem::take(&mut self.rows);
        let Solute { list, pairs, walls, concentrations, .. } = &*self;
        list.in_tasks(&mut rows, |first, rows| {
            for (i, row) in (first..).zip(rows) {
                let own = concentrations[i];
                *row = Row::around(own);
                row.gain = gain(list, pairs, concentrations, i);
                if pairs.takes_back[i] {
                    let entries = list.pairs.starts[i]..list.pairs.starts[i + 1];
                    let factors = pairs.factors[entries.clone()].iter().zip(&pairs.back[entries.clone()]);
                    for (partner, (factor, back)) in list.pairs.partners[entries].iter().zip(factors) {
                        let other = concentrations[self.seen(*partner as usize)];
                        row.see(if *factor == 0.0 { own } else { other });
                        row.add(back * (own - other));
                    }
                }
            }
        });
        for mouth in &walls.mouths {
            let row = &mut rows[mouth.particle as usize];
            let wall = walls.brought(mouth);
            row.gain += mouth.exchange * (wall - concentrations[mouth.particle as usize]);
            if mouth.flow > 0.0 || walls.held[mouth.patch as usize] {
                row.see(wall);
            }
        }
        self.rows = rows;
    }

    /// How much of the exchange may be taken back at each particle in a step (s); marks those where it is not all.
    fn limit(&mut self, content: &[f64], step: f64) {
        self.limited.fill(false);
        let (starts, partners) = (&self.list.pairs.starts, &self.list.pairs.partners);
        let mut limited = std::mem::take(&mut self.limited);
        let mut limits = std::mem::take(&mut self.limits);
        for i in (0..content.len()).filter(|i| self.pairs.takes_back[*i]) {
            let holds = [self.holds[i], self.holds[i] + step * self.pairs.gains[i]];
            let held = Held { content: content[i], holds, decays: step * self.material(i).decay };
            limits[i] = held.shares(&self.rows[i], step);
            if limits[i].0 < 1.0 || limits[i].1 < 1.0 {
                limited[i] = true;
                for j in &partners[starts[i]..starts[i + 1]] {
                    limited[self.seen(*j as usize)] = true;
                }
            }
        }
        (self.limited, self.limits) = (limited, limits);
    }

    /// What of an entry's exchange is taken back (1/s).
    #[inline(always)]
    fn back(&self, i: usize, k: usize) -> f64 {
        let other = self.seen(self.list.pairs.partners[k] as usize);
        let back = self.pairs.back[k] * (self.concentrations[i] - self.concentrations[other]);
        let (here, there) = (self.limits[i], self.limits[other]);
        back * if back > 0.0 { here.0.min(there.1) } else { here.1.min(there.0) }
    }

    /// Rates with what is taken back.
    fn take_back(&self, rates: &mut [f64]) {
        self.list.in_tasks(rates, |first, rates| {
            for (i, rate) in (first..).zip(rates) {
                let row = self.rows[i];
                let back = if self.limited[i] && self.pairs.takes_back[i] {
                    (self.list.pairs.starts[i]..self.list.pairs.starts[i + 1]).map(|k| self.back(i, k)).sum()
                } else {
                    row.up + row.down
                };
                *rate = row.gain + back;
            }
        });
    }

    /// Books what passes walls.
    fn book(&self, patches: &mut [f64]) {
        let mut sums = [Sum::default(); MOST_PATCHES];
        for mouth in &self.walls.mouths {
            let i = mouth.particle as usize;
            let mut passing = self.walls.passing(mouth, &self.concentrations, self.pairs.factors[mouth.pair]);
            if self.pairs.limits {
                passing.far += self.back(i, mouth.pair);
            }
            let volume = self.list.volumes.share(i);
            Walls::book(mouth, &passing, volume, |patch, amount| sums[patch].add(amount));
        }
        for (patch, sum) in patches.iter_mut().zip(&sums) {
            *patch = sum.value() * self.list.volumes.unit();
        }
    }

    /// Takes away what decays.
    fn decay(&self, content: &[f64], rates: &mut Rates<'_>) {
        if !self.decays {
            return;
        }
        let mut sum = Sum::default();
        for (i, (rate, content)) in rates.of_particles.iter_mut().zip(content).enumerate() {
            let decayed = self.material(i).decay * content;
            *rate -= decayed;
            sum.add(decayed * self.list.volumes.share(i));
        }
        if let Some(own) = rates.patches.last_mut() {
            *own = -sum.value() * self.list.volumes.unit();
        }
    }
}

/// What a particle gains from all entries of its row (1/s), with all of the exchange.
#[inline(always)]
fn gain(list: &ListParts, pairs: &Pairs, concentrations: &[f64], i: usize) -> f64 {
    let row = list.pairs.starts[i]..list.pairs.starts[i + 1];
    let (partners, factors) = (&list.pairs.partners[row.clone()], &pairs.factors[row]);
    let own = concentrations[i];
    let term = |(partner, factor): (&u32, &f64)| factor * (concentrations[*partner as usize] - own);
    let (mut partners, mut factors) = (partners.chunks_exact(ABREAST), factors.chunks_exact(ABREAST));
    let mut sums = [0.0; ABREAST];
    for group in partners.by_ref().zip(factors.by_ref()) {
        for (sum, entry) in sums.iter_mut().zip(group.0.iter().zip(group.1)) {
            *sum += term(entry);
        }
    }
    let rest: f64 = partners.remainder().iter().zip(factors.remainder()).map(term).sum();
    pairs.gains[i] * own + ((sums[0] + sums[1]) + (sums[2] + sums[3])) + rest
}
