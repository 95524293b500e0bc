//! Viscosity and thermal diffusivity from a periodic box whose halves are driven against each other (Ng et al. 2017, section
//! 3.2).
//!
//! Particles of the upper half are pushed along x, or heated, and those of the lower half pushed back, or cooled. Far from
//! particles' reach the steady profile in each half is a parabola, of tip `drive (L/4)^2 / (2 diffusivity)`, with which eqs
//! 18 and 21 agree. The tip is fitted by least squares to all bins of both halves at once, and not read off extremes, which
//! noise makes larger. What both halves share, as a drift of the whole, does not enter.
//!
//! Pairs reach across the bend between both halves: profiles stand `c drive / diffusivity` higher than their parabolas,
//! `c = [r^4 w] / (16 [r^2 w])`, and the fit finds `2.5 c (4/L)^2` too little diffusivity: for `w = (1 - r/rc)^2` and rc =
//! 1.96 that is 0.4 % at L = 30, 0.9 % at 20.

use super::{GoOn, Span, advance};
use crate::fluid::{Drive, Fluid, FluidError, Particle};

/// Bins across the box (as in the paper).
pub const BINS: usize = 40;

/// Steps between two samples of a profile.
const EVERY: u64 = 10;

/// What sets the halves against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Push {
    /// A force on each particle along x. The work it does is taken from the heat of the same particle, so that the flow heats
    /// nothing on the whole.
    Force(f64),
    /// Heat for each particle by time.
    Heat(f64),
}

/// A profile and what follows from it.
#[derive(Debug, Clone, PartialEq)]
pub struct HalvesDrive {
    /// Height in the box, and mean velocity along x or temperature above the one at the start.
    pub profile: Vec<(f64, f64)>,
    /// Height of the parabola that fits.
    pub tip: f64,
    /// Kinematic viscosity or thermal diffusivity.
    pub diffusivity: f64,
}

/// Drives the upper half one way, the lower half the other.
pub(super) struct Halves {
    pub(super) push: Push,
    pub(super) height: f64,
}

impl Halves {
    fn sign(&self, place: f64) -> f64 {
        if place.rem_euclid(self.height) < 0.5 * self.height { -1.0 } else { 1.0 }
    }
}

impl Drive<2> for Halves {
    #[inline(always)]
    fn act(&self, particle: &mut Particle<2>, time: f64) {
        let sign = self.sign(particle.position[1]);
        match self.push {
            Push::Force(force) => {
                let change = sign * force * time * particle.mobility;
                particle.heat -= sign * force * time * (particle.velocity[0] + 0.5 * change);
                particle.velocity[0] += change;
            }
            Push::Heat(heat) => particle.heat += sign * heat * time,
        }
    }
}

/// The steady profile over its tip: a parabola of height 1 in the upper half, of -1 in the lower one; `place` over the height of the box.
pub fn profile(place: f64) -> f64 {
    let within = 2.0 * (2.0 * place).fract() - 1.0;
    (1.0 - within * within) * if place < 0.5 { -1.0 } else { 1.0 }
}

/// Tip of the steady profile at a viscosity or thermal diffusivity.
pub fn tip(push: Push, height: f64, heat_capacity: f64, diffusivity: f64) -> f64 {
    let source = match push {
        Push::Force(force) => force,
        Push::Heat(heat) => heat / heat_capacity,
    };
    source * (0.25 * height).powi(2) / (2.0 * diffusivity)
}

/// Time in which the slowest wave of the box decays by a factor of e.
pub fn decay(height: f64, diffusivity: f64) -> f64 {
    (height / (2.0 * std::f64::consts::PI)).powi(2) / diffusivity
}

/// Measures a fluid; `None` if it was told to stop. It starts from the profile that the expected viscosity or thermal
/// diffusivity gives, so that only what is wrong with that has to decay.
///
/// # Errors
/// Those of the fluid's steps.
pub fn measure(
    fluid: &mut Fluid<2>,
    push: Push,
    expected: f64,
    span: Span,
    watch: GoOn<'_>,
) -> Result<Option<HalvesDrive>, FluidError> {
    let height = fluid.lengths()[1];
    let capacity = fluid.parameters().heat_capacity;
    let start = tip(push, height, capacity, expected);
    fluid.change(|particle| {
        let above = start * profile(particle.position[1].rem_euclid(height) / height);
        match push {
            Push::Force(_) => particle.velocity[0] += above,
            Push::Heat(_) => particle.heat += capacity * above,
        }
    });
    let drive = Halves { push, height };
    if !advance(fluid, span.settle, &drive, watch)? {
        return Ok(None);
    }
    let mut sums = [[0.0; 2]; BINS];
    for _ in 0..span.watch.div_ceil(EVERY) {
        if !advance(fluid, EVERY, &drive, watch)? {
            return Ok(None);
        }
        for particle in fluid.particles() {
            let place = particle.position[1].rem_euclid(height) / height;
            let sum = &mut sums[((place * BINS as f64) as usize).min(BINS - 1)];
            sum[0] += match push {
                Push::Force(_) => particle.velocity[0],
                Push::Heat(_) => particle.heat / capacity,
            };
            sum[1] += 1.0;
        }
    }
    let middle = |bin: usize| (bin as f64 + 0.5) / BINS as f64;
    let points: Vec<(f64, f64)> =
        sums.iter().enumerate().map(|(bin, sum)| (height * middle(bin), sum[0] / sum[1].max(1.0))).collect();
    let (mut both, mut square) = (0.0, 0.0);
    for (bin, point) in points.iter().enumerate() {
        let shape = binned(middle(bin));
        both += shape * point.1;
        square += shape * shape;
    }
    let found = both / square;
    // The tip is in inverse proportion to what is looked for.
    Ok(Some(HalvesDrive { profile: points, tip: found, diffusivity: expected * start / found }))
}

/// Mean of the parabola over the bin around a place.
pub(super) fn binned(place: f64) -> f64 {
    // Bins are of half-width 2/BINS in the units in which a half is 2 wide; the mean of a square is a third of its end.
    let half = 2.0 / BINS as f64;
    profile(place) - half * half / 3.0 * if place < 0.5 { -1.0 } else { 1.0 }
}
