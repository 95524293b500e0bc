//! What is read off bodies of shells: profiles along r and along cuts, fronts as radii.

use glam::DVec2;

use super::{Sample, Sampler};
use crate::material::FreezingLaw;
use crate::particles::Particles;
use crate::record::ProfileRow;
use crate::scene::{Condition, Domain, Scene, Symmetry};

/// Where the front of a radial body starts, and how it is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RadialFront {
    symmetry: Symmetry,
    inner: f64,
    outer: f64,
    from_outer: bool,
}

impl RadialFront {
    /// The front of a scene, if its body is radial and freezes: it starts at the wall that drives harder.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let Domain::Radial { symmetry, inner, outer } = scene.domain else { return None };
        if scene.materials.iter().all(|material| material.law == FreezingLaw::None) {
            return None;
        }
        let drive = |name: &str| match scene.wall(name) {
            Some(Condition::Temperature(series)) => (series.at(scene.duration) - scene.initial_temperature).abs(),
            Some(Condition::Convection { ambient, .. }) => {
                (ambient.at(scene.duration) - scene.initial_temperature).abs()
            }
            Some(Condition::Flux(series)) => series.range().0.abs().max(series.range().1.abs()),
            _ => 0.0,
        };
        Some(RadialFront { symmetry, inner, outer, from_outer: drive("outer") > drive("inner") })
    }

    /// Radius (m) up to which, or from which on, a frozen volume fills the body.
    pub(super) fn radius(&self, frozen: f64) -> f64 {
        let whole = self.symmetry.volume(self.inner, self.outer);
        self.symmetry.radius(self.inner, if self.from_outer { whole - frozen } else { frozen })
    }
}

/// A line of samples.
#[derive(Debug, Clone)]
pub(super) struct Cut {
    /// Name in the series: `radius`, `z=0.4` or `r=0.1`.
    pub(super) plane: String,
    /// Places along the line (m).
    pub(super) along: Vec<f64>,
    pub(super) samples: Vec<Sample>,
}

impl Cut {
    /// The lines of a scene: of a radial body the whole radius, of others the cuts that it asks for.
    pub(super) fn all(scene: &Scene, particles: &Particles, sampler: &Sampler<'_>) -> Vec<Cut> {
        let lattice = &particles.lattice;
        let radii = || (0..lattice.columns).map(|column| lattice.centre(column as i64, 0).x);
        let heights = || (0..lattice.rows).map(|row| lattice.centre(0, row as i64).y);
        let cut = |plane: String, places: Vec<(f64, DVec2)>| Cut {
            plane,
            along: places.iter().map(|place| place.0).collect(),
            samples: places.iter().map(|place| sampler.sample(place.1)).collect(),
        };
        if let Domain::Radial { .. } = scene.domain {
            return vec![cut("radius".into(), radii().map(|r| (r, DVec2::new(r, 0.0))).collect())];
        }
        let at_height = |z: &f64| cut(format!("z={z}"), radii().map(|r| (r, DVec2::new(r, *z))).collect());
        let at_radius = |r: &f64| cut(format!("r={r}"), heights().map(|z| (z, DVec2::new(*r, z))).collect());
        scene.watch.cuts_z.iter().map(at_height).chain(scene.watch.cuts_r.iter().map(at_radius)).collect()
    }

    /// Temperatures and frozen fractions along the line.
    pub(super) fn rows(&self, particles: &Particles, time: f64) -> impl Iterator<Item = ProfileRow> {
        self.along.iter().zip(&self.samples).map(move |(along, sample)| ProfileRow {
            time_s: time,
            x_m: *along,
            temperature_c: sample.of(|i| particles.temperature(i)),
            temperature_ref_c: None,
            frozen_fraction: sample.of(|i| particles.frozen_fraction(i)),
            plane: self.plane.clone(),
        })
    }
}
