//! What pairs exchange for one flow of water.
//!
//! Particle i gains `F C_i + (w D + F/2 + e) (C_j - C_i)` from partner j, with the water F that it gains, so the mean of both
//! ends is carried, and an exchange e stands beside diffusion. No factor of `C_j - C_i` is negative where e is at least
//! `|F|/2 - w D`: then every particle keeps within the range of the data.
//!
//! A mirror image behind an open wall falls when its particle rises, so it takes from what the pair with the particle itself
//! conducts: as much as the image's own conductance, which is less, as images are farther away. What is left counts for e. Water
//! carries the wall's concentration in and the particle's out, with as much of the wall's as diffusion through the wall makes up
//! for; the mean of the particle and its image differs from that by an exchange of two particles that see each other's
//! images, which is taken back like e.

use glam::DVec2;

use crate::balances::solute::advection::Advection;
use crate::balances::solute::dispersion::{Spread, arm, between, spreads, velocities};
use crate::balances::solute::image::{Image, Kind};
use crate::balances::solute::walls::{Mouth, Walls};
use crate::kernels::list_parts::ListParts;
use crate::memory::{HeapSize, total};
use crate::physics::solute_material::SoluteMaterial;

/// Pairs for one flow of water.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    /// Which concentration water carries.
    advection: Advection,
    /// Water that a particle gains along each entry of the list (1/s by volume).
    pub flows: Vec<f64>,
    /// Factor (1/s) of the difference of concentrations, by entry.
    pub factors: Vec<f64>,
    /// Exchange (1/s) that may be taken back, by entry.
    pub back: Vec<f64>,
    /// Water that each particle gains from all entries (1/s by volume).
    pub gains: Vec<f64>,
    /// Whether some exchange of a particle may be taken back, and whether of any.
    pub takes_back: Vec<bool>,
    pub limits: bool,
    /// Entries of images behind open walls, with the entries from which they take.
    against: Vec<(usize, usize)>,
    disperses: bool,
    /// Molecular diffusion (m2/s), Darcy velocities (m/s) and spreading of particles.
    molecular: Vec<f64>,
    velocities: Vec<DVec2>,
    spreads: Vec<Spread>,
}

/// Greatest sums of one particle.
pub(super) struct Sums {
    /// Rate (1/s) with which it follows what is around it, and the particle.
    pub greatest: (f64, usize),
    /// Half of the water (1/s) that it exchanges, over what it holds.
    pub turning: f64,
}

impl Pairs {
    /// Pairs of a list without water.
    pub(super) fn new(
        list: &ListParts,
        materials: &[SoluteMaterial],
        advection: Advection,
        mouths: &[Mouth],
        images: &[Image],
    ) -> Self {
        let (count, entries) = (list.positions.len(), list.pairs.partners.len());
        Pairs {
            advection,
            flows: vec![0.0; entries],
            factors: vec![0.0; entries],
            back: vec![0.0; entries],
            gains: vec![0.0; count],
            takes_back: vec![false; count],
            limits: false,
            against: against(list, mouths, images),
            disperses: materials.iter().any(SoluteMaterial::disperses),
            molecular: vec![0.0; count],
            velocities: Vec::new(),
            spreads: Vec::new(),
        }
    }

    /// Follows the water that is in [`Pairs::flows`] and the weights of the list, at these water contents.
    pub(super) fn follow(
        &mut self,
        list: &ListParts,
        materials: &[SoluteMaterial],
        images: &[Image],
        walls: &mut Walls,
        content: impl Fn(usize) -> f64,
    ) {
        for (i, molecular) in self.molecular.iter_mut().enumerate() {
            *molecular = materials[list.materials.index(i)].molecular(content(i));
        }
        if self.disperses || self.advection == Advection::Paper {
            velocities(list, &self.flows, &mut self.velocities);
        }
        if self.disperses {
            spreads(list, materials, &self.molecular, &self.velocities, &mut self.spreads);
        }
        if self.advection == Advection::Paper {
            self.project(list, images);
        }
        self.cut(list, images, walls);
    }

    /// Follows the weights of the list alone: along what cracks cut nothing diffuses.
    pub(super) fn cut(&mut self, list: &ListParts, images: &[Image], walls: &mut Walls) {
        self.conduct(list, images);
        self.mix(list, walls);
    }

    /// Takes the water of pairs from the velocities of both ends.
    fn project(&mut self, list: &ListParts, images: &[Image]) {
        let (count, pairs) = (list.positions.len(), &list.pairs);
        for i in 0..count {
            for k in pairs.starts[i]..pairs.starts[i + 1] {
                let j = pairs.partners[k] as usize;
                let other = match j.checked_sub(count) {
                    None => self.velocities[j],
                    Some(ghost) if images[ghost].kind == Kind::Inner => {
                        images[ghost].mirror(self.velocities[images[ghost].original as usize])
                    }
                    Some(_) => continue,
                };
                self.flows[k] = -0.5 * pairs.weights[k] * arm(list, i, j).dot(self.velocities[i] + other);
            }
        }
    }

    /// Conductances (1/s) of all entries, in the place of their factors.
    fn conduct(&mut self, list: &ListParts, images: &[Image]) {
        let (count, pairs) = (list.positions.len(), &list.pairs);
        let Pairs { factors, molecular, spreads, disperses, .. } = self;
        list.in_rows(factors, |i, row| {
            for (k, factor) in (pairs.starts[i]..).zip(row) {
                let j = pairs.partners[k] as usize;
                let (here, there) = if *disperses {
                    between(spreads, list, i, j, images)
                } else {
                    let other = j.checked_sub(count).map_or(j, |ghost| images[ghost].original as usize);
                    (molecular[i], molecular[other])
                };
                let mean = if here == there { here } else { 2.0 * here * there / (here + there) };
                *factor = pairs.weights[k] * mean;
            }
        });
    }

    /// Factors of all entries from their conductances and the water.
    fn mix(&mut self, list: &ListParts, walls: &mut Walls) {
        let Pairs { advection, flows, factors, back, gains, takes_back, against, .. } = self;
        let (advection, starts) = (*advection, &list.pairs.starts);
        // Of a pair that is cut within the interval, too: contents know of the water that went before.
        let flow = |k: usize| flows[k];
        back.copy_from_slice(factors);
        for (image, pair) in against.iter() {
            back[*pair] -= factors[*image];
        }
        list.in_rows(back, |i, row| {
            for (k, back) in (starts[i]..).zip(row) {
                *back = advection.exchange(flow(k), *back);
            }
        });
        for mouth in &mut walls.mouths {
            let (k, kind) = (mouth.pair, mouth.image.kind);
            (mouth.flow, mouth.conductance) = (flow(k), factors[k]);
            mouth.exchange = entering(advection, kind, mouth.flow, mouth.conductance);
        }
        list.in_rows(factors, |i, row| {
            for (k, factor) in (starts[i]..).zip(row) {
                *factor += back[k] + 0.5 * flow(k);
            }
        });
        // Behind open walls water carries no mean, unless it carries nothing else.
        for Mouth { pair, image, flow, conductance, .. } in &walls.mouths {
            let is_mean = image.kind == Kind::Layer || (image.kind == Kind::Odd && advection.is_plain());
            if !is_mean {
                factors[*pair] = *conductance;
            }
            back[*pair] = if image.kind == Kind::Odd { 0.5 * flow } else { 0.0 };
        }
        list.in_tasks(gains, |first, gains| {
            for (i, gain) in (first..).zip(gains) {
                *gain = (starts[i]..starts[i + 1]).map(flow).sum();
            }
        });
        if advection == Advection::Limited {
            list.in_tasks(takes_back, |first, takes_back| {
                for (i, takes_back) in (first..).zip(takes_back) {
                    *takes_back = back[starts[i]..starts[i + 1]].iter().any(|back| *back != 0.0);
                }
            });
            self.limits = takes_back.contains(&true);
        }
    }

    /// Greatest sums of all particles, by the least that each holds for a concentration, and its rate of decay (1/s).
    pub(super) fn sums(&self, list: &ListParts, walls: &Walls, holds: impl Fn(usize) -> (f64, f64) + Sync) -> Sums {
        let starts = &list.pairs.starts;
        let mut found = vec![(0.0, 0.0); self.gains.len()];
        for mouth in &walls.mouths {
            let mirrored = Walls::mirrored(mouth, self.factors[mouth.pair].abs());
            found[mouth.particle as usize].0 += mouth.exchange + mirrored;
        }
        list.in_tasks(&mut found, |first, found| {
            for (i, (rate, turning)) in (first..).zip(found) {
                let (row, (least, decay)) = (starts[i]..starts[i + 1], holds(i));
                let sum = *rate + self.factors[row.clone()].iter().map(|factor| factor.abs()).sum::<f64>();
                // A step that dries a particle leaves it with less at its end.
                *rate = (sum + (-self.gains[i]).max(0.0)) / least + decay;
                *turning = 0.5 * self.flows[row].iter().map(|flow| flow.abs()).sum::<f64>() / least;
            }
        });
        let mut sums = Sums { greatest: (0.0, 0), turning: 0.0 };
        for (i, (rate, turning)) in found.into_iter().enumerate() {
            sums.greatest = if rate > sums.greatest.0 { (rate, i) } else { sums.greatest };
            sums.turning = sums.turning.max(turning);
        }
        sums
    }
}

/// Exchange (1/s) with a wall that comes with its water, by the conductance of its entry.
fn entering(advection: Advection, kind: Kind, flow: f64, conductance: f64) -> f64 {
    match kind {
        Kind::Inner | Kind::Layer => 0.0,
        Kind::Odd if advection.is_plain() => 0.0,
        // Diffusion alone follows the wall twice as fast as its image.
        Kind::Odd if flow < 0.0 && advection != Advection::Upwind => -flow.abs().min(2.0 * conductance),
        Kind::Odd | Kind::Open | Kind::Fitted => flow.max(0.0),
    }
}

/// For each entry of an image behind an open wall, the entry of the same row whose conductance it lessens. Images are farther
/// away than what they mirror, so sorted by weights each finds one that conducts more.
fn against(list: &ListParts, mouths: &[Mouth], images: &[Image]) -> Vec<(usize, usize)> {
    let (count, pairs) = (list.positions.len(), &list.pairs);
    let original = |k: usize| {
        let j = pairs.partners[k] as usize;
        j.checked_sub(count).map_or(Some((j as u32, Kind::Inner)), |ghost| {
            let Image { original, kind, .. } = images[ghost];
            (kind == Kind::Inner).then_some((original, kind))
        })
    };
    let heaviest = |entries: &mut Vec<usize>| entries.sort_by(|a, b| pairs.weights[*b].total_cmp(&pairs.weights[*a]));
    let mut found = Vec::new();
    for row in mouths.chunk_by(|a, b| a.particle == b.particle) {
        let i = row[0].particle as usize;
        let mut odd: Vec<&Mouth> =
            row.iter().filter(|mouth| mouth.image.kind == Kind::Odd && mouth.image.original as usize != i).collect();
        odd.sort_by_key(|mouth| mouth.image.original);
        for same in odd.chunk_by(|a, b| a.image.original == b.image.original) {
            let mut taking: Vec<usize> = same.iter().map(|mouth| mouth.pair).collect();
            let own = pairs.starts[i]..pairs.starts[i + 1];
            let mut giving: Vec<usize> =
                own.filter(|k| original(*k) == Some((same[0].image.original, Kind::Inner))).collect();
            heaviest(&mut taking);
            heaviest(&mut giving);
            let last = giving.len().saturating_sub(1);
            let giver = |n: usize| giving.get(n.min(last)).copied();
            found.extend(taking.iter().enumerate().filter_map(|(n, image)| Some((*image, giver(n)?))));
        }
    }
    found
}

impl HeapSize for Pairs {
    fn heap_size(&self) -> usize {
        let columns = [&self.flows, &self.factors, &self.back, &self.gains, &self.molecular];
        let spreads = self.spreads.capacity() * size_of::<Spread>();
        let columns: usize = columns.into_iter().map(HeapSize::heap_size).sum();
        columns + spreads + total(&[&self.takes_back, &self.against, &self.velocities])
    }
}
