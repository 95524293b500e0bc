//! Cell centres of a square lattice inside a domain, stored row by row without gaps.

use glam::DVec2;

use crate::memory::HeapSize;
use crate::space::domain::{Domain, Sector};

/// The lattice of a domain. Particle `i` of row `y` stands at column `first(y) + i - start(y)`.
#[derive(Debug, Clone)]
pub struct Lattice {
    /// Spacing (m).
    pub spacing: f64,
    /// Number of space dimensions.
    pub dimension: usize,
    /// Lower left corner of cell (0, 0) (m).
    pub corner: DVec2,
    /// Columns.
    pub columns: usize,
    /// Rows; one on a line.
    pub rows: usize,
    /// First and one past the last column that belongs to the domain, by row.
    spans: Vec<(u32, u32)>,
    /// Index of the first particle of each row, and the number of all.
    starts: Vec<usize>,
}

impl HeapSize for Lattice {
    fn heap_size(&self) -> usize {
        self.spans.heap_size() + self.starts.heap_size()
    }
}

/// Relative distance by which a cell centre may lie outside a curved wall and still belong to the domain.
const INSIDE_TOLERANCE: f64 = 1e-9;

impl Lattice {
    /// The lattice of a domain at a spacing (m) that divides its straight sides.
    pub fn new(domain: &Domain, spacing: f64) -> Self {
        let cells = |length: f64| (length / spacing).round().max(1.0) as usize;
        match *domain {
            Domain::Line { length } => {
                Self::from_spans(length / cells(length) as f64, 1, DVec2::ZERO, vec![(0, cells(length) as u32)])
            }
            Domain::Rectangle { width, height } => {
                let spans = vec![(0, cells(width) as u32); cells(height)];
                Self::from_spans(width / cells(width) as f64, 2, DVec2::ZERO, spans)
            }
            Domain::Radial { inner, outer, .. } => {
                let (length, corner) = (outer - inner, DVec2::new(inner, 0.0));
                Self::from_spans(length / cells(length) as f64, 1, corner, vec![(0, cells(length) as u32)])
            }
            Domain::Axial { inner, outer, height } => {
                let width = outer - inner;
                let spans = vec![(0, cells(width) as u32); cells(height)];
                Self::from_spans(width / cells(width) as f64, 2, DVec2::new(inner, 0.0), spans)
            }
            Domain::Ring { outer_radius, sector } => {
                let across = (outer_radius / spacing - 1e-9).ceil() as usize;
                let (below, left) = match sector {
                    Sector::Quarter => (0, 0),
                    Sector::Half => (0, across),
                    Sector::Whole => (across, across),
                };
                let spans = (0..across + below)
                    .map(|row| {
                        let y = (row as f64 - below as f64 + 0.5) * spacing;
                        let half = (outer_radius * outer_radius * (1.0 + INSIDE_TOLERANCE) - y * y).max(0.0).sqrt();
                        let right = (half / spacing + 0.5).floor() as usize;
                        ((left - right.min(left)) as u32, (left + right) as u32)
                    })
                    .collect();
                Self::from_spans(spacing, 2, DVec2::new(-(left as f64), -(below as f64)) * spacing, spans)
            }
        }
    }

    fn from_spans(spacing: f64, dimension: usize, corner: DVec2, spans: Vec<(u32, u32)>) -> Self {
        let columns = spans.iter().map(|span| span.1).max().unwrap_or(0) as usize;
        let mut starts = Vec::with_capacity(spans.len() + 1);
        let mut total = 0;
        starts.push(0);
        for (first, end) in &spans {
            total += (end - first) as usize;
            starts.push(total);
        }
        Lattice { spacing, dimension, corner, columns, rows: spans.len(), spans, starts }
    }

    /// Number of particles.
    #[inline]
    pub fn len(&self) -> usize {
        self.starts[self.rows]
    }

    /// Whether there is no particle at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Volume of a particle (m^d).
    pub fn volume(&self) -> f64 {
        self.spacing.powi(self.dimension as i32)
    }

    /// First and one past the last column of a row.
    #[inline]
    pub fn span(&self, row: usize) -> (usize, usize) {
        let (first, end) = self.spans[row];
        (first as usize, end as usize)
    }

    /// Index of the first particle of a row; for `rows`, the number of particles.
    #[inline]
    pub fn start(&self, row: usize) -> usize {
        self.starts[row]
    }

    /// Index of the particle in a cell, if the cell belongs to the domain.
    #[inline]
    pub fn index(&self, column: i64, row: i64) -> Option<usize> {
        let row = usize::try_from(row).ok().filter(|row| *row < self.rows)?;
        let (first, end) = self.span(row);
        let column = usize::try_from(column).ok().filter(|column| (first..end).contains(column))?;
        Some(self.starts[row] + column - first)
    }

    /// Column and row of a particle.
    #[inline]
    pub fn cell(&self, index: usize) -> (i64, i64) {
        let row = self.starts.partition_point(|start| *start <= index) - 1;
        ((index - self.starts[row]) as i64 + i64::from(self.spans[row].0), row as i64)
    }

    /// Centre of a cell (m); on a line, y is zero.
    pub fn centre(&self, column: i64, row: i64) -> DVec2 {
        let y = if self.dimension == 1 { 0.0 } else { self.corner.y + (row as f64 + 0.5) * self.spacing };
        DVec2::new(self.corner.x + (column as f64 + 0.5) * self.spacing, y)
    }

    /// Position of a particle (m).
    pub fn position(&self, index: usize) -> DVec2 {
        let (column, row) = self.cell(index);
        self.centre(column, row)
    }

    /// Positions of all particles (m), in order.
    pub fn positions(&self) -> Vec<DVec2> {
        (0..self.rows)
            .flat_map(|row| {
                let (first, end) = self.span(row);
                (first..end).map(move |column| self.centre(column as i64, row as i64))
            })
            .collect()
    }

    /// The corner across from that at which it begins (m).
    pub fn far(&self) -> DVec2 {
        self.corner + self.spacing * DVec2::new(self.columns as f64, self.rows as f64)
    }

    /// The place on a side next to a point: 0 and 1 across x, 2 and 3 across y.
    pub fn foot(&self, side: usize, point: DVec2) -> DVec2 {
        match side {
            0 => DVec2::new(self.corner.x, point.y),
            1 => DVec2::new(self.far().x, point.y),
            2 => DVec2::new(point.x, self.corner.y),
            _ => DVec2::new(point.x, self.far().y),
        }
    }

    /// A point in units of cells, measured from the centre of cell (0, 0).
    pub fn to_cells(&self, point: DVec2) -> DVec2 {
        let cells = (point - self.corner) / self.spacing - DVec2::splat(0.5);
        if self.dimension == 1 { DVec2::new(cells.x, 0.0) } else { cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_and_cell_are_inverse_and_positions_lie_inside() {
        for (domain, spacing) in [
            (Domain::Line { length: 0.4 }, 0.002),
            (Domain::Rectangle { width: 1.2, height: 0.3 }, 0.1),
            (Domain::Ring { outer_radius: 15.0, sector: Sector::Quarter }, 0.4),
            (Domain::Ring { outer_radius: 15.0, sector: Sector::Half }, 0.7),
            (Domain::Ring { outer_radius: 15.0, sector: Sector::Whole }, 0.37),
        ] {
            let lattice = Lattice::new(&domain, spacing);
            for (index, position) in lattice.positions().into_iter().enumerate() {
                let (column, row) = lattice.cell(index);
                assert_eq!(lattice.index(column, row), Some(index));
                assert_eq!(lattice.position(index), position);
                if let Domain::Ring { outer_radius, .. } = domain {
                    assert!(position.length() <= outer_radius * (1.0 + 1e-8));
                }
            }
        }
    }

    #[test]
    fn a_quarter_is_a_quarter_of_the_whole() {
        let count = |sector, spacing| Lattice::new(&Domain::Ring { outer_radius: 3.0, sector }, spacing).len();
        for spacing in [0.1, 0.17, 0.3] {
            assert_eq!(4 * count(Sector::Quarter, spacing), count(Sector::Whole, spacing));
            assert_eq!(2 * count(Sector::Quarter, spacing), count(Sector::Half, spacing));
        }
    }
}
