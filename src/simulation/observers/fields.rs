//! Maps: temperatures and frozen fractions on a regular grid.

use frazil_core::particles::Particles;
use frazil_core::space::lattice::Lattice;
use frazil_record::Field;
use frazil_scene::{PipeRing, Scene};
use glam::DVec2;

use super::observer::{Instants, Made, Setup, View};
use super::series::series;

/// Largest number of cells of a kept field along one direction.
const FIELD_CELLS: usize = 400;

/// The map of a state of a scene, as fields are kept.
pub fn map(scene: &Scene, particles: &Particles, time: f64) -> Field {
    field(particles, time, field_radius(scene))
}

/// Radius (m) around the origin within which maps are kept: beyond the pipes as far as a wall comes to; zero for all of the body.
fn field_radius(scene: &Scene) -> f64 {
    let apart = |ring: &PipeRing| 2.0 * ring.ring_radius * (std::f64::consts::PI / ring.count as f64).sin();
    let reach = |ring: &PipeRing| (1.6 * ring.ring_radius).max(ring.ring_radius + 1.5 * apart(ring));
    scene.rings.iter().map(reach).fold(0.0, f64::max)
}

pub(super) fn of(setup: &Setup<'_>) -> Made {
    if !setup.maps || setup.scene.domain.dimension() != 2 {
        return None;
    }
    let radius = field_radius(setup.scene);
    let Grid { nx, ny, .. } = grid(&setup.particles.lattice, radius);
    // Two columns by field, and the sums from which one is taken.
    let held = (2 * nx * ny * size_of::<f64>(), nx * ny * size_of::<(f64, f64, usize)>());
    let read = move |view: &View<'_>, fields: &mut Vec<Field>| fields.push(field(view.particles, view.time, radius));
    let fields = Vec::with_capacity(setup.profiles());
    series(Instants::Profiles, fields, held, read, |fields, result| result.fields = fields)
}

/// Cells of a kept field.
struct Grid {
    /// Lower left corner (m).
    least: DVec2,
    /// Cell size (m).
    spacing: f64,
    /// Columns.
    nx: usize,
    /// Rows.
    ny: usize,
}

/// The grid of fields over a lattice, of at most [`FIELD_CELLS`] cells a side, within `radius` (m) if that is not zero.
fn grid(lattice: &Lattice, radius: f64) -> Grid {
    let within = |extent: f64| if radius > 0.0 { extent.min(radius) } else { extent };
    let least = DVec2::new(-within(-lattice.corner.x), -within(-lattice.corner.y));
    let most = lattice.far();
    let size = DVec2::new(within(most.x), within(most.y)) - least;
    let coarsening = (size.max_element() / lattice.spacing / FIELD_CELLS as f64).ceil().max(1.0);
    let spacing = coarsening * lattice.spacing;
    let (nx, ny) = ((size.x / spacing).round().max(1.0) as usize, (size.y / spacing).round().max(1.0) as usize);
    Grid { least, spacing, nx, ny }
}

/// Temperatures on a grid of at most [`FIELD_CELLS`] cells a side; particles off the lattice fill their nearest cell.
fn field(particles: &Particles, time_s: f64, radius: f64) -> Field {
    let Grid { least, spacing, nx, ny } = grid(&particles.lattice, radius);
    let mut sums = vec![(0.0, 0usize, 0.0, 0usize); nx * ny];
    particles.visit(|i, place| {
        let cell = ((place - least) / spacing).floor();
        if cell.x >= 0.0 && cell.y >= 0.0 && (cell.x as usize) < nx && (cell.y as usize) < ny {
            let sum = &mut sums[cell.y as usize * nx + cell.x as usize];
            let fraction = particles.front_fraction(i);
            // What was dug out has no temperature, and is not frozen.
            if !particles.is_gone(i) {
                (sum.0, sum.1) = (sum.0 + particles.reading_by(i, || fraction), sum.1 + 1);
            }
            (sum.2, sum.3) = (sum.2 + fraction, sum.3 + 1);
        }
    });
    let mean = |sum: f64, count: usize| if count > 0 { sum / count as f64 } else { f64::NAN };
    Field {
        time_s,
        nx,
        ny,
        x0_m: least.x + 0.5 * spacing,
        y0_m: least.y + 0.5 * spacing,
        spacing_m: spacing,
        temperature_c: sums.iter().map(|sum| mean(sum.0, sum.1)).collect(),
        frozen_fraction: sums.iter().map(|sum| mean(sum.2, sum.3)).collect(),
        concentration: concentrations(particles, &sums, (least, spacing, nx)),
        temperature_ref_c: Vec::new(),
    }
}

/// Concentrations on the same grid; empty where there is no solute.
fn concentrations(
    particles: &Particles,
    sums: &[(f64, usize, f64, usize)],
    (least, spacing, nx): (DVec2, f64, usize),
) -> Vec<f64> {
    if particles.concentration.is_empty() {
        return Vec::new();
    }
    let mut found = vec![0.0; sums.len()];
    particles.visit(|i, place| {
        let cell = ((place - least) / spacing).floor();
        let inside = cell.min_element() >= 0.0 && (cell.x as usize) < nx;
        if let Some(sum) = found.get_mut(cell.y as usize * nx + cell.x as usize).filter(|_| inside) {
            *sum += particles.concentration[i];
        }
    });
    found.iter().zip(sums).map(|(sum, (.., count))| if *count > 0 { sum / *count as f64 } else { f64::NAN }).collect()
}
