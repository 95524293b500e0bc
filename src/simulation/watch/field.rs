//! Maps: temperatures and frozen fractions on a regular grid.

use frazil_core::particles::Particles;
use frazil_core::space::lattice::Lattice;
use frazil_record::Field;
use glam::DVec2;

/// Largest number of cells of a kept field along one direction.
const FIELD_CELLS: usize = 400;

/// Cells of a kept field.
pub(super) struct Grid {
    /// Lower left corner (m).
    least: DVec2,
    /// Cell size (m).
    spacing: f64,
    /// Columns.
    pub(super) nx: usize,
    /// Rows.
    pub(super) ny: usize,
}

/// The grid of fields over a lattice, of at most [`FIELD_CELLS`] cells a side, within `radius` (m) if that is not zero.
pub(super) fn grid(lattice: &Lattice, radius: f64) -> Grid {
    let within = |extent: f64| if radius > 0.0 { extent.min(radius) } else { extent };
    let least = DVec2::new(-within(-lattice.corner.x), -within(-lattice.corner.y));
    let most = lattice.corner + lattice.spacing * DVec2::new(lattice.columns as f64, lattice.rows as f64);
    let size = DVec2::new(within(most.x), within(most.y)) - least;
    let coarsening = (size.max_element() / lattice.spacing / FIELD_CELLS as f64).ceil().max(1.0);
    let spacing = coarsening * lattice.spacing;
    let (nx, ny) = ((size.x / spacing).round().max(1.0) as usize, (size.y / spacing).round().max(1.0) as usize);
    Grid { least, spacing, nx, ny }
}

/// Temperatures on a grid of at most [`FIELD_CELLS`] cells a side; particles off the lattice fill their nearest cell.
pub(super) fn field(particles: &Particles, time_s: f64, radius: f64) -> Field {
    let Grid { least, spacing, nx, ny } = grid(&particles.lattice, radius);
    let mut sums = vec![(0.0, 0usize, 0.0, 0usize); nx * ny];
    particles.visit(|i, place| {
        let cell = ((place - least) / spacing).floor();
        if cell.x >= 0.0 && cell.y >= 0.0 && (cell.x as usize) < nx && (cell.y as usize) < ny {
            let sum = &mut sums[cell.y as usize * nx + cell.x as usize];
            // What was dug out has no temperature, and is not frozen.
            if !particles.is_gone(i) {
                (sum.0, sum.1) = (sum.0 + particles.reading(i), sum.1 + 1);
            }
            (sum.2, sum.3) = (sum.2 + particles.frozen_fraction(i), sum.3 + 1);
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
        temperature_ref_c: Vec::new(),
    }
}
