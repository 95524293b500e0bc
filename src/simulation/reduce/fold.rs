//! One way of leaving a part of a body away: when it may be, and what the scene becomes.

use std::f64::consts::PI;

use frazil_core::boundary::condition::Condition;
use frazil_core::boundary::pipe::Pipe;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::lattice::Lattice;
use frazil_core::space::wall::WallId;
use frazil_scene::region::Cell;
use frazil_scene::{PipeRing, Profile, ProfileValues, Region, Scene, Shape, Wall};
use glam::DVec2;

/// Distance (m per m of the body's extent) up to which pipes and angles are in the same place.
const SAME_PLACE: f64 = 1e-9;

/// What is left away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fold {
    /// Nothing varies across a plane: a line along x, or along y, stands for it.
    Line {
        /// Whether the line runs along y.
        along_y: bool,
        /// Extent of the plane across the line (m).
        across: f64,
    },
    /// The body is symmetric about its middle: the half from the origin on stands for it.
    Half {
        /// Whether the middle is that of y.
        along_y: bool,
        /// Extent of the whole body in that direction (m).
        length: f64,
    },
    /// Pipes and ground are symmetric about the axes: a sector stands for a larger one.
    Sector {
        /// The larger one.
        from: Sector,
        /// The smaller one.
        to: Sector,
        /// Angle of the first ring's pipe that counts as its first in the sector (radians), so that profiles run
        /// along images of the same rays.
        first_angle: f64,
    },
}

impl Fold {
    /// Folds that walls and pipes allow, the ones that save most first. Materials are not looked at.
    pub(super) fn candidates(scene: &Scene) -> Vec<Fold> {
        // By direction: along y, or along x.
        let [same_in_x, same_in_y] = [false, true].map(|along_y| {
            let [first, last] = WallId::ends(along_y);
            // What repeats has no middle.
            scene.wall(first) == scene.wall(last) && scene.wall(first) != Some(&Condition::Periodic)
        });
        let closed = |along_y: bool| WallId::ends(along_y).into_iter().all(|wall| scene.is_closed(wall));
        let mut found = Vec::new();
        // Where barriers are, or walls in parts, or sources of heat, ways differ that look alike.
        if scene.has_barriers() || !scene.wall_parts.is_empty() || scene.has_heat_sources() {
            return found;
        }
        // Regions that are watched lie anywhere.
        if !scene.watch.regions.is_empty() {
            return found;
        }
        // A row of pipes is of any places.
        if !matches!(scene.domain, Domain::Ring { .. }) && !scene.rings.is_empty() {
            return found;
        }
        match scene.domain {
            // Shells are what symmetry leaves.
            Domain::Radial { .. } | Domain::Axial { .. } => {}
            Domain::Line { length } => {
                if same_in_x {
                    found.push(Fold::Half { along_y: false, length });
                }
            }
            Domain::Rectangle { width, height } => {
                // A line has no points beside it along which a profile could be kept.
                let along_line = scene.watch.cuts.is_empty();
                // On a line, y of a formula has no name.
                let has_formula = |profile: &Profile| matches!(profile.values, ProfileValues::Formula { .. });
                let keeps_y = scene.initial_profile.as_ref().is_some_and(has_formula);
                if along_line && closed(true) {
                    found.push(Fold::Line { along_y: false, across: height });
                }
                if along_line && closed(false) && !keeps_y {
                    found.push(Fold::Line { along_y: true, across: width });
                }
                if same_in_x {
                    found.push(Fold::Half { along_y: false, length: width });
                }
                if same_in_y {
                    found.push(Fold::Half { along_y: true, length: height });
                }
            }
            Domain::Ring { sector, .. } => {
                // Cuts cross the plan.
                let even = scene.watch.cuts.is_empty() && scene.rings.iter().all(PipeRing::is_even);
                let in_x = even && scene.rings.iter().all(|ring| is_mirrored(ring, true));
                let in_y = even && scene.rings.iter().all(|ring| is_mirrored(ring, false));
                let smaller = match sector {
                    Sector::Whole if in_x && in_y => vec![Sector::Quarter, Sector::Half],
                    Sector::Whole if in_y => vec![Sector::Half],
                    Sector::Half if in_x => vec![Sector::Quarter],
                    _ => Vec::new(),
                };
                found.extend(smaller.into_iter().filter_map(|to| {
                    let first_angle = match scene.rings.first() {
                        Some(ring) => first_angle(ring, sector, to)?,
                        None => 0.0,
                    };
                    Some(Fold::Sector { from: sector, to, first_angle })
                }));
            }
        }
        found
    }

    /// The smaller scene.
    pub(super) fn shrink(&self, scene: &Scene) -> Scene {
        let mut smaller = scene.clone();
        match (*self, scene.domain) {
            (Fold::Line { along_y, .. }, Domain::Rectangle { width, height }) => {
                smaller.domain = Domain::Line { length: if along_y { height } else { width } };
                smaller.along = DVec2::new(scene.along[usize::from(along_y)], 1.0);
                let ends = WallId::ends(false).into_iter().zip(WallId::ends(along_y));
                let wall = |(wall, own)| Some(Wall { wall, condition: scene.wall(own)?.clone() });
                smaller.walls = ends.filter_map(wall).collect();
                smaller.regions = scene.regions.iter().filter_map(|region| on_line(region, along_y)).collect();
                // One across the line leaves no particle as it was, and the body as it is.
                if let Some(Profile { values: ProfileValues::Axis { along_y: own, .. }, .. }) =
                    &mut smaller.initial_profile
                {
                    *own = *own && !along_y;
                }
                for (x, y) in &mut smaller.watch.probes {
                    (*x, *y) = (if along_y { *y } else { *x }, 0.0);
                }
            }
            (Fold::Half { along_y, length }, domain) => {
                let half = 0.5 * length;
                smaller.domain = match domain {
                    Domain::Rectangle { width, .. } if along_y => Domain::Rectangle { width, height: half },
                    Domain::Rectangle { height, .. } => Domain::Rectangle { width: half, height },
                    _ => Domain::Line { length: half },
                };
                let [_, far] = WallId::ends(along_y);
                for wall in smaller.walls.iter_mut().filter(|wall| wall.wall == far) {
                    wall.condition = Condition::Symmetry;
                }
                for (x, y) in &mut smaller.watch.probes {
                    let coordinate = if along_y { y } else { x };
                    *coordinate = coordinate.min(length - *coordinate);
                }
                smaller.watch.cuts = scene.cuts();
                for cut in smaller.watch.cuts.iter_mut().filter(|cut| cut.across_y == along_y) {
                    cut.at = cut.at.min(length - cut.at);
                }
                if smaller.freezing_direction().is_some_and(|direction| direction.along_y == along_y) {
                    smaller.watch.profile_length = smaller.watch.profile_length.filter(|end| *end < half);
                }
            }
            (Fold::Sector { to, first_angle, .. }, Domain::Ring { outer_radius, .. }) => {
                smaller.domain = Domain::Ring { outer_radius, sector: to };
                if let Some(ring) = smaller.rings.first_mut() {
                    ring.first_angle = first_angle;
                }
                for (x, y) in &mut smaller.watch.probes {
                    *y = y.abs();
                    *x = if to == Sector::Quarter { x.abs() } else { *x };
                }
            }
            (Fold::Line { .. } | Fold::Sector { .. }, _) => {}
        }
        smaller
    }

    /// Whether every particle holds the material of its image and starts as warm.
    pub(super) fn keeps_ground(&self, larger: &Scene, smaller: &Scene, spacing: f64) -> bool {
        let (materials, starts) = (larger.has_regional_materials(), larger.has_uneven_start());
        if !materials && !starts {
            return true;
        }
        let (lattice, folded) = (Lattice::new(&larger.domain, spacing), Lattice::new(&smaller.domain, spacing));
        let material = |scene: &Scene, place: DVec2| scene.material_at(place.x, place.y);
        let parts = |scene: &Scene, place: DVec2| scene.starts_in(&Cell::around(place, spacing));
        (0..lattice.len()).map(|index| lattice.cell(index)).all(|cell| {
            let image = self.image(&lattice, &folded, cell);
            let (own, image) = (lattice.centre(cell.0, cell.1), folded.centre(image.0, image.1));
            (!materials || material(larger, own) == material(smaller, image))
                && (!starts || same_parts(&parts(larger, own), &parts(smaller, image)))
        })
    }

    /// Cell of the smaller body that stands for one of the larger.
    fn image(&self, lattice: &Lattice, folded: &Lattice, (column, row): (i64, i64)) -> (i64, i64) {
        // Cells beyond the smaller body are mirrored at its last one, or at its first.
        let last = |cell: i64, count: usize| cell.min(2 * count as i64 - 1 - cell);
        let first = |cell: i64, whole: usize, part: usize| {
            let cell = cell - (whole - part) as i64;
            cell.max(-1 - cell)
        };
        match self {
            Fold::Line { along_y: true, .. } => (row, 0),
            Fold::Line { .. } => (column, 0),
            Fold::Half { along_y: true, .. } => (column, last(row, folded.rows)),
            Fold::Half { .. } => (last(column, folded.columns), row),
            Fold::Sector { .. } => {
                (first(column, lattice.columns, folded.columns), first(row, lattice.rows, folded.rows))
            }
        }
    }

    /// Why a discretisation whose pairs reach `reach` cells does not follow, if it does not.
    pub(super) fn obstacle(&self, scene: &Scene, spacing: f64, reach: usize) -> Option<String> {
        let lattice = Lattice::new(&scene.domain, spacing);
        let (along_y, halved) = match *self {
            Fold::Half { along_y, .. } => (along_y, true),
            Fold::Line { along_y, .. } => (along_y, false),
            Fold::Sector { .. } => return None,
        };
        let (cells, direction) = if along_y { (lattice.rows, "y") } else { (lattice.columns, "x") };
        if halved && !cells.is_multiple_of(2) {
            return Some(format!("the middle of {direction} cuts through particles, as their number is odd"));
        }
        // A particle that sees both walls of a body feels them together.
        (cells < 2 * reach).then(|| format!("along {direction} the body is narrower than twice the reach of its pairs"))
    }

    /// Why the smaller scene gives the same answer.
    pub(super) fn why(&self) -> String {
        match self {
            Fold::Line { along_y, .. } => {
                let across = if *along_y { "x" } else { "y" };
                format!("nothing varies along {across}")
            }
            Fold::Half { along_y, .. } => {
                format!("the body is symmetric about the middle of {}", if *along_y { "y" } else { "x" })
            }
            Fold::Sector { from, to, .. } => {
                let axes = match (from, to) {
                    (Sector::Whole, Sector::Quarter) => "both axes",
                    (Sector::Whole, _) => "the x axis",
                    _ => "the y axis",
                };
                format!("pipes and ground are symmetric about {axes}")
            }
        }
    }
}

/// Whether two cells start at the same temperatures in the same shares, to rounding of the shapes.
fn same_parts(a: &[(f64, f64)], b: &[(f64, f64)]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() <= SAME_PLACE)
}

/// A region of a plane on a line along x, or along y, if the line at the edge of the body meets it.
fn on_line(region: &Region, along_y: bool) -> Option<Region> {
    // Nothing varies across, so a region that matters is a box that reaches from edge to edge.
    let Shape::Box(Cell { low, high }) = region.shape else { return None };
    let (least, greatest, across) = if along_y { (low.y, high.y, low.x) } else { (low.x, high.x, low.y) };
    let low = DVec2::new(least, f64::NEG_INFINITY);
    let high = DVec2::new(greatest, f64::INFINITY);
    (across <= 0.0).then_some(Region { shape: Shape::Box(Cell { low, high }), ..region.clone() })
}

/// Whether each pipe of a ring has an image of its own kind behind the y axis (`in_x`) or the x axis.
fn is_mirrored(ring: &PipeRing, in_x: bool) -> bool {
    let pipes = ring.pipes();
    let image = |pipe: &Pipe| match in_x {
        true => Pipe { x: -pipe.x, ..pipe.clone() },
        false => Pipe { y: -pipe.y, ..pipe.clone() },
    };
    pipes.iter().map(image).all(|image| pipes.iter().any(|pipe| is_same(pipe, &image)))
}

/// Whether two rings are the same pipes, counted from another one.
fn same_pipes(a: &PipeRing, b: &PipeRing) -> bool {
    let (a, b) = (a.pipes(), b.pipes());
    a.len() == b.len() && a.iter().all(|pipe| b.iter().any(|other| is_same(pipe, other)))
}

fn is_same(a: &Pipe, b: &Pipe) -> bool {
    let near = SAME_PLACE * a.x.hypot(a.y).max(a.radius);
    (a.x - b.x).hypot(a.y - b.y) <= near && Pipe { x: b.x, y: b.y, ..a.clone() } == *b
}

/// Angle into a sector, by mirrors at the axes (radians).
pub(super) fn folded(angle: f64, to: Sector) -> f64 {
    let (sin, cos) = angle.sin_cos();
    match to {
        Sector::Whole => sin.atan2(cos),
        Sector::Half => sin.abs().atan2(cos),
        Sector::Quarter => sin.abs().atan2(cos.abs()),
    }
}

/// Whether two angles are the same direction.
pub(super) fn same_direction(a: f64, b: f64) -> bool {
    let difference = (a - b).rem_euclid(2.0 * PI);
    difference.min(2.0 * PI - difference) <= SAME_PLACE
}

/// The pipe from which a ring must count in the smaller sector, so that its first ray through a pipe and its first one
/// between two are images of those in the larger; none if there is no such pipe.
fn first_angle(ring: &PipeRing, from: Sector, to: Sector) -> Option<f64> {
    let first = |ring: &PipeRing, sector: Sector| {
        let main = (0..ring.count).map(|k| ring.angle(k)).find(|angle| sector.holds(*angle));
        let between = (0..ring.count).map(|k| ring.gap_angle(k)).find(|angle| sector.holds(*angle));
        (main, between)
    };
    let wanted = first(ring, from);
    let image = |own: Option<f64>, of: Option<f64>| match (own, of) {
        (Some(own), Some(of)) => same_direction(own, folded(of, to)),
        (own, of) => own.is_none() && of.is_none(),
    };
    (0..ring.count).map(|k| ring.angle(k)).find(|angle| {
        let turned = PipeRing { first_angle: *angle, ..ring.clone() };
        let found = first(&turned, to);
        image(found.0, wanted.0) && image(found.1, wanted.1) && same_pipes(&turned, ring)
    })
}
