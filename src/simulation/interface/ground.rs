//! Where materials lie: on the line between two places, and behind walls.

use frazil_core::boundary::interface::Piece;
use frazil_core::boundary::patch::{Boundary, Side};
use frazil_core::space::lattice::Lattice;
use frazil_core::space::symmetry::Symmetry;
use frazil_scene::Scene;
use frazil_scene::region::Cell;
use glam::DVec2;

/// Part of a line below which a piece between others is rounding.
const NO_PIECE: f64 = 1e-9;

/// Part of a spacing by which places on a wall are moved into the body, so that they lie in its regions.
const INTO_BODY: f64 = 1e-6;

/// What goes on behind a side of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Beyond {
    /// Its mirror image.
    Mirrored,
    /// The material at the wall.
    Continued,
    /// The body again, from the opposite wall on.
    Repeated,
    /// Nothing that pairs see.
    Nothing,
}

/// The materials of a scene, with what pairs see of them behind straight walls.
pub struct Ground<'a> {
    scene: &'a Scene,
    low: DVec2,
    high: DVec2,
    spacing: f64,
    /// Left, right, bottom, top.
    beyond: [Beyond; 4],
    symmetry: Option<Symmetry>,
}

impl<'a> Ground<'a> {
    pub fn new(scene: &'a Scene, lattice: &Lattice, boundary: &Boundary) -> Self {
        let low = lattice.corner;
        let high = lattice.far();
        let beyond = boundary.sides.map(|side| match side {
            Side::Curved => Beyond::Nothing,
            Side::Mirror => Beyond::Mirrored,
            Side::Periodic => Beyond::Repeated,
            // What lies behind is told by the wall as a whole: closed parts are mirrors, and what they reflect must be.
            Side::Wall(patch) if boundary.is_open(patch) => Beyond::Continued,
            Side::Wall(_) => Beyond::Mirrored,
        });
        Ground { scene, low, high, spacing: lattice.spacing, beyond, symmetry: scene.domain.symmetry() }
    }

    /// Whether a square around a place holds one material, by its half width (m).
    pub fn is_uniform(&self, place: DVec2, half: f64) -> bool {
        let cell = Cell { low: place - DVec2::splat(half), high: place + DVec2::splat(half) };
        let holds_one = |cell: &Cell| {
            let regions = self.scene.regions.iter().filter(|region| region.material.is_some());
            regions.map(|region| region.shape.share_of(cell)).all(|share| share == 0.0 || share == 1.0)
        };
        if !self.beyond.contains(&Beyond::Repeated) {
            return holds_one(&cell);
        }
        let parts = self.repeated_parts(&cell);
        let material = |part: &Cell| self.material(0.5 * (part.low + part.high));
        parts.iter().all(|part| holds_one(part) && material(part) == material(&parts[0]))
    }

    /// The parts of the body in a cell that may reach over walls at which it goes on at the opposite ones.
    fn repeated_parts(&self, cell: &Cell) -> Vec<Cell> {
        let mut parts = vec![*cell];
        for axis in (0..2).filter(|axis| self.beyond[2 * axis] == Beyond::Repeated) {
            let (low, high) = (self.low[axis], self.high[axis]);
            if cell.low[axis] >= low && cell.high[axis] <= high {
                continue;
            }
            let shifted = |part: Cell, by: f64| {
                let mut part = part;
                part.low[axis] = (part.low[axis] + by).max(low);
                part.high[axis] = (part.high[axis] + by).min(high);
                (part.low[axis] < part.high[axis]).then_some(part)
            };
            let period = high - low;
            parts =
                parts.iter().flat_map(|part| [0.0, period, -period].map(|by| shifted(*part, by))).flatten().collect();
        }
        parts
    }

    /// A place in the body for one that may lie behind walls.
    fn inside(&self, place: DVec2) -> DVec2 {
        let margin = INTO_BODY * self.spacing;
        let fold = |value: f64, low: f64, high: f64, sides: [Beyond; 2]| {
            let mut value = value;
            // Images of images, for bodies that are narrower than pairs reach.
            for _ in 0..64 {
                let (beyond, mirrored, wall, repeated) = if value < low {
                    (sides[0], 2.0 * low - value, low + margin, value + (high - low))
                } else if value > high {
                    (sides[1], 2.0 * high - value, high - margin, value - (high - low))
                } else {
                    break;
                };
                match beyond {
                    Beyond::Mirrored => value = mirrored,
                    Beyond::Repeated => value = repeated,
                    Beyond::Continued => return wall,
                    Beyond::Nothing => break,
                }
            }
            value
        };
        let x = fold(place.x, self.low.x, self.high.x, [self.beyond[0], self.beyond[1]]);
        let y = match self.scene.domain.dimension() {
            1 => place.y,
            _ => fold(place.y, self.low.y, self.high.y, [self.beyond[2], self.beyond[3]]),
        };
        DVec2::new(x, y)
    }

    /// Index of the material at a place, which may lie behind walls.
    pub fn material(&self, place: DVec2) -> u8 {
        let inside = self.inside(place);
        self.scene.material_at(inside.x, inside.y) as u8
    }

    /// The pieces between two places with their materials; none if all is of one.
    pub fn pieces(&self, (from, own): (DVec2, u8), (to, other): (DVec2, u8)) -> Option<Vec<Piece>> {
        let mut cuts = self.cuts(from, to);
        cuts.retain(|cut| *cut > 0.0 && *cut < 1.0);
        cuts.extend([0.0, 1.0]);
        cuts.sort_unstable_by(f64::total_cmp);
        let mut pieces: Vec<Piece> = Vec::with_capacity(cuts.len() + 1);
        pieces.push(Piece { material: own, share: 0.0 });
        let mut add = |material: u8, share: f64| match pieces.last_mut() {
            Some(last) if last.material == material => last.share += share,
            _ => pieces.push(Piece { material, share }),
        };
        let (mut last, mut whole) = (0.0, 0.0);
        for cut in &cuts[1..] {
            if cut - last > NO_PIECE || *cut == 1.0 {
                let share = self.length((from, to), last, *cut);
                add(self.material(from + 0.5 * (last + cut) * (to - from)), share);
                whole += share;
                last = *cut;
            }
        }
        add(other, 0.0);
        if pieces.len() == 1 {
            return None;
        }
        pieces.iter_mut().for_each(|piece| piece.share /= whole);
        Some(pieces)
    }

    /// Where a line crosses the edges of regions, its images' too, in parts of it.
    fn cuts(&self, from: DVec2, to: DVec2) -> Vec<f64> {
        let mut cuts = Vec::new();
        let way = to - from;
        // Between two of these places the image of the line is a line.
        let mut bends = vec![0.0, 1.0];
        for axis in 0..self.scene.domain.dimension().min(2) {
            let (low, high, start, run) = (self.low[axis], self.high[axis], from[axis], way[axis]);
            let size = high - low;
            if run == 0.0 {
                continue;
            }
            let (least, most) = (start.min(start + run), start.max(start + run));
            if least >= low && most <= high {
                continue;
            }
            let (first, last) = (((least - low) / size).floor() as i64, ((most - low) / size).ceil() as i64);
            bends
                .extend((first..=last).map(|k| (low + k as f64 * size - start) / run).filter(|t| *t > 0.0 && *t < 1.0));
        }
        bends.sort_unstable_by(f64::total_cmp);
        for ends in bends.windows(2) {
            let (a, b) = (ends[0], ends[1]);
            if b - a < NO_PIECE {
                continue;
            }
            cuts.extend(if a > 0.0 { Some(a) } else { None });
            // Two places well inside the stretch tell the line that its image lies on.
            let at = |t: f64| self.inside(from + t * way);
            let (near, far) = (0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b);
            let (p, q) = (at(near), at(far));
            for region in self.scene.regions.iter().filter(|region| region.material.is_some()) {
                region.shape.crossings(p, q, |t| {
                    let cut = near + t * (far - near);
                    if cut > a && cut < b {
                        cuts.push(cut);
                    }
                });
            }
        }
        cuts
    }

    /// Length of a part of a line; in bodies of shells, the part of the difference that a steady profile has over it.
    fn length(&self, (from, to): (DVec2, DVec2), start: f64, end: f64) -> f64 {
        let Some(symmetry) = self.symmetry else { return end - start };
        let run = to.x - from.x;
        let (inner, outer) = (from.x + start * run, from.x + end * run);
        // Lines along the axis, and radii of layers that papers set behind it.
        if run.abs() <= 1e-12 * from.x.abs().max(to.x.abs()) || inner <= 0.0 || outer <= 0.0 {
            return end - start;
        }
        match symmetry {
            Symmetry::Axial => (outer / inner).ln() / run,
            Symmetry::Spherical => (1.0 / inner - 1.0 / outer) / run,
        }
    }
}
