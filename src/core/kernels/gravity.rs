//! What gravity moves along the pairs of a list, beside what their potentials exchange.
//!
//! The flux of unsaturated water is `-(grad Phi + K grad z)`, so a pair of weight w brings `w [(Phi_j - Phi_i) + (z_j - z_i) K_ij]`
//! to its particle i, with the mean conductivity K of both ends: by the second moment of the weights, which is twice the unit,
//! this is the divergence exactly where K is linear in place. A pair whose upper end hands down more than its potentials even
//! out takes as much of K from that end as keeps the factor of the difference of both ends from being negative, which is what
//! the range of the data needs, and no more.

use std::sync::Arc;

use glam::DVec2;

use crate::boundary::condition::Condition;
use crate::boundary::patch::{Face, Patch};
use crate::kernels::list_parts::ListParts;
use crate::memory::{HeapSize, total};
use crate::physics::retention::conducting::Conducting;

/// Particles and ghosts as gravity sees them.
pub(super) struct Gravity {
    law: Arc<Conducting>,
    /// Heights (m). Behind a wall that lets no water out of itself a ghost stands as high as its image, as it mirrors all that
    /// drives water there; behind others it stands at its own place.
    heights: Vec<f64>,
    /// Conductivities (m/s), and potentials (m2/s) at the same states: behind a wall of given head, those of the wall.
    conductivity: Vec<f64>,
    potential: Vec<f64>,
    /// How the conductivities follow the potentials (1/m), and whether the states follow them at all.
    slope: Vec<f64>,
    follows: Vec<f64>,
}

/// How the flux of a pair follows the potentials of its two ends, beside what they exchange.
pub(super) struct Shares {
    /// It falls by this share of the change of the particle.
    pub(super) own: f64,
    /// It rises by this share of the change of its partner.
    pub(super) other: f64,
}

/// A pair by its upper and its lower end.
struct Fall {
    upper: usize,
    lower: usize,
    /// The height (m) between them.
    height: f64,
    /// Whether water falls to the first of the two that were asked for.
    to_first: bool,
}

impl Gravity {
    /// Gravity in ground of one soil, where the parts have a direction upwards.
    pub(super) fn of(parts: &ListParts) -> Option<Self> {
        let up = parts.up?;
        let law = parts.materials.thermals[0].conducting()?.clone();
        let places = parts.positions.iter().chain(&parts.ghosts.position);
        let own: Vec<f64> = places.map(|place: &DVec2| up.dot(*place)).collect();
        let count = parts.positions.len();
        let mut above_image = vec![0.0; parts.ghosts.len()];
        parts.ghosts.fill(&mut own.clone(), |ghost, image| {
            above_image[ghost] = own[count + ghost] - image;
            own[count + ghost]
        });
        let patch = |ghost: usize| parts.ghosts.patch[ghost].map(|patch| &parts.boundary.patches[patch as usize]);
        let stands = |patch: &Patch| patch.is_held() || patch.condition == Condition::FreeDrainage;
        let mut heights = own.clone();
        parts.ghosts.fill(&mut heights, |ghost, image| {
            if patch(ghost).is_some_and(stands) { image + above_image[ghost] } else { image }
        });
        let column = || vec![0.0; own.len()];
        let mut follows = vec![1.0; own.len()];
        parts
            .ghosts
            .fill(&mut follows, |ghost, image| if patch(ghost).is_some_and(Patch::is_held) { 0.0 } else { image });
        Some(Gravity { law, heights, conductivity: column(), potential: column(), slope: column(), follows })
    }

    /// Follows a state, of which the potentials are known.
    pub(super) fn bring_to(&mut self, parts: &ListParts, enthalpy: &[f64], potential: &[f64], faces: &[Vec<Face>]) {
        let thermal = &parts.materials.thermals[0];
        for (conductivity, content) in self.conductivity.iter_mut().zip(enthalpy) {
            *conductivity = self.law.at(*content);
        }
        let count = enthalpy.len();
        self.potential[..count].copy_from_slice(&potential[..count]);
        let held: Vec<Option<(f64, f64)>> = faces[0]
            .iter()
            .map(|face| match face {
                Face::Odd { wall, temperature } | Face::Held { wall, temperature } => {
                    let moisture = thermal.curve.moisture();
                    Some((moisture.map_or(0.0, |moisture| moisture.hydraulic_conductivity(*temperature)), *wall))
                }
                Face::Even | Face::Flux(_) | Face::Film { .. } | Face::Runoff(_) => None,
            })
            .collect();
        let at_wall = |ghost: usize| parts.ghosts.patch[ghost].and_then(|patch| held[patch as usize]);
        parts.ghosts.fill(&mut self.conductivity, |ghost, image| at_wall(ghost).map_or(image, |wall| wall.0));
        parts.ghosts.fill(&mut self.potential, |ghost, image| at_wall(ghost).map_or(image, |wall| wall.1));
    }

    /// Follows how the conductivities of a state change: `slopes` has how its potentials do (m2/s).
    pub(super) fn linearise(&mut self, parts: &ListParts, enthalpy: &[f64], slopes: &[f64]) {
        for (own, (content, slope)) in self.slope.iter_mut().zip(enthalpy.iter().zip(slopes)) {
            *own = if *slope > 0.0 { self.law.slope(*content) / slope } else { 0.0 };
        }
        let (follows, count) = (&self.follows, enthalpy.len());
        parts.ghosts.fill(&mut self.slope, |ghost, image| follows[count + ghost] * image);
    }

    /// What gravity brings to `i` along its pair with `j`, over their weight. Exchanging both only turns the sign.
    #[inline]
    pub(super) fn brings(&self, i: usize, j: usize) -> f64 {
        let Fall { upper, lower, height, to_first } = self.fall(i, j);
        let (rest, evens) = self.central(upper, lower, height);
        let down = height * self.conductivity[upper] - rest.max(-evens).min(evens);
        if to_first { down } else { -down }
    }

    /// How [`Gravity::brings`] follows the potentials of both.
    pub(super) fn shares(&self, i: usize, j: usize) -> Shares {
        let Fall { upper, lower, height, to_first } = self.fall(i, j);
        let (rest, evens) = self.central(upper, lower, height);
        let (by_upper, by_lower) = if rest.abs() <= evens {
            (0.5 * height * self.slope[upper], 0.5 * height * self.slope[lower])
        } else {
            let turns = rest.signum() * (self.potential[upper] - self.potential[lower]).signum();
            (height * self.slope[upper] - turns * self.follows[upper], turns * self.follows[lower])
        };
        if to_first { Shares { own: -by_lower, other: by_upper } } else { Shares { own: by_upper, other: -by_lower } }
    }

    #[inline]
    fn fall(&self, i: usize, j: usize) -> Fall {
        let rise = self.heights[j] - self.heights[i];
        let (upper, lower) = if rise > 0.0 { (j, i) } else { (i, j) };
        Fall { upper, lower, height: rise.abs(), to_first: rise > 0.0 }
    }

    /// By how much the mean of both ends hands down less than the upper end alone, and what their potentials even out: so much of
    /// it may be.
    #[inline]
    fn central(&self, upper: usize, lower: usize, height: f64) -> (f64, f64) {
        let rest = 0.5 * height * (self.conductivity[upper] - self.conductivity[lower]);
        (rest, (self.potential[upper] - self.potential[lower]).abs())
    }
}

impl HeapSize for Gravity {
    fn heap_size(&self) -> usize {
        self.law.heap_size() + total(&[&self.heights, &self.conductivity, &self.potential, &self.slope, &self.follows])
    }
}
