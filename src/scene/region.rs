//! Parts of the body with a material or a start of their own: boxes, circles, ellipses and polygons.

mod ellipse;

pub use ellipse::Ellipse;

use frazil_core::balances::heated::Power;
use glam::DVec2;

use crate::scene::Scene;

/// Rounding of positions, over the size of a shape or of a particle: what lies that near an edge lies on it.
const ON_EDGE: f64 = 1e-9;

/// A part of the domain with another material than the first one, another temperature at the start, or a source of heat.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Index into [`Scene::materials`], where the region has a material of its own.
    pub material: Option<usize>,
    /// Temperature at the start, where it has one of its own.
    pub temperature: Option<f64>,
    /// Heat that it releases, where it does.
    pub heat: Option<Power>,
    /// Where it is.
    pub shape: Shape,
}

/// The shape of a region.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A box along the axes; in y without end on a line.
    Box(Cell),
    /// A circle.
    Circle {
        /// Centre (m).
        centre: DVec2,
        /// Radius (m).
        radius: f64,
    },
    /// An ellipse.
    Ellipse(Ellipse),
    /// A polygon that does not cross itself, by its corners (m) in either sense.
    Polygon(Vec<DVec2>),
}

/// A box along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Lower left corner (m).
    pub low: DVec2,
    /// Upper right corner (m).
    pub high: DVec2,
}

impl Cell {
    /// The cell of a particle that stands at `centre` (m).
    pub fn around(centre: DVec2, spacing: f64) -> Self {
        let half = DVec2::splat(0.5 * spacing);
        Cell { low: centre - half, high: centre + half }
    }
}

impl Shape {
    /// Whether a point lies in the shape. Of two boxes that share an edge, a point on it belongs to the right or upper one.
    pub fn contains(&self, point: DVec2) -> bool {
        match self {
            Shape::Box(Cell { low, high }) => {
                // Edges are moved down and left by more than rounding, so that the same particles lie in wherever it falls.
                let inside = |value: f64, low: f64, high: f64| {
                    let slack = if (high - low).is_finite() { ON_EDGE * (high - low) } else { 0.0 };
                    value >= low - slack && value < high - slack
                };
                inside(point.x, low.x, high.x) && inside(point.y, low.y, high.y)
            }
            Shape::Circle { centre, radius } => (point - *centre).length() <= radius * (1.0 + ON_EDGE),
            Shape::Ellipse(ellipse) => ellipse.contains(point),
            Shape::Polygon(corners) => {
                let crosses = |(a, b): &(DVec2, DVec2)| {
                    (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
                };
                edges(corners).filter(crosses).count() % 2 == 1
            }
        }
    }

    /// The box around the shape.
    pub fn extent(&self) -> Cell {
        match self {
            Shape::Box(cell) => *cell,
            Shape::Circle { centre, radius } => {
                Cell { low: *centre - DVec2::splat(*radius), high: *centre + DVec2::splat(*radius) }
            }
            Shape::Ellipse(ellipse) => ellipse.extent(),
            Shape::Polygon(corners) => Cell {
                low: corners.iter().copied().fold(DVec2::INFINITY, DVec2::min),
                high: corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max),
            },
        }
    }

    /// Shows where a line crosses the edge, in parts of the way between two of its points. Edges of a box count with the
    /// lines that they lie on.
    pub fn crossings(&self, from: DVec2, to: DVec2, mut show: impl FnMut(f64)) {
        let way = to - from;
        match self {
            Shape::Box(Cell { low, high }) => {
                for (bound, start, run) in
                    [(low.x, from.x, way.x), (high.x, from.x, way.x), (low.y, from.y, way.y), (high.y, from.y, way.y)]
                {
                    if bound.is_finite() && run != 0.0 {
                        show((bound - start) / run);
                    }
                }
            }
            Shape::Circle { centre, radius } => crossings_of_circle(*radius, from - *centre, way, show),
            Shape::Ellipse(ellipse) => ellipse.crossings(from, to, show),
            Shape::Polygon(corners) => {
                for (a, b) in edges(corners) {
                    let edge = b - a;
                    let across = way.perp_dot(edge);
                    let along = (a - from).perp_dot(way) / across;
                    if across != 0.0 && (-ON_EDGE..=1.0 + ON_EDGE).contains(&along) {
                        show((a - from).perp_dot(edge) / across);
                    }
                }
            }
        }
    }

    /// Whether the straight way between two points (m) leads through the shape, or ends in it.
    pub fn stands_between(&self, from: DVec2, to: DVec2) -> bool {
        let extent = self.extent();
        if from.min(to).cmpgt(extent.high).any() || from.max(to).cmplt(extent.low).any() {
            return false;
        }
        if self.contains(from) || self.contains(to) {
            return true;
        }
        let mut places = vec![0.0, 1.0];
        self.crossings(from, to, |place| places.extend((place > 0.0 && place < 1.0).then_some(place)));
        places.sort_unstable_by(f64::total_cmp);
        let inside = |place: f64| self.contains(from + place * (to - from));
        places.windows(2).any(|ends| ends[1] - ends[0] > ON_EDGE && inside(0.5 * (ends[0] + ends[1])))
    }

    /// Share of a cell that the shape covers, to rounding.
    pub fn share_of(&self, cell: &Cell) -> f64 {
        let extent = self.extent();
        let (low, high) = (cell.low.max(extent.low), cell.high.min(extent.high));
        if low.cmpge(high).any() {
            return 0.0;
        }
        // Lengths over the cell's own, so that areas neither vanish nor lose digits far from the origin.
        let size = cell.high - cell.low;
        let middle = 0.5 * (cell.low + cell.high);
        let share = match self {
            Shape::Box(_) => ((high - low) / size).element_product(),
            Shape::Circle { centre, radius } => {
                let (low, high) = (cell.low - *centre, cell.high - *centre);
                circle_in_box(*radius, low, high) / size.element_product()
            }
            Shape::Ellipse(ellipse) => ellipse.share_of(cell),
            Shape::Polygon(corners) => {
                let corners = corners.iter().map(|corner| (*corner - middle) / size).collect();
                area(&clipped(corners)).abs()
            }
        };
        // Rounding of an edge that lies between particles is no cut.
        if share < ON_EDGE {
            0.0
        } else if share > 1.0 - ON_EDGE {
            1.0
        } else {
            share
        }
    }
}

/// Shows where a line from a place on crosses a circle around the origin, in parts of its way.
fn crossings_of_circle(radius: f64, from: DVec2, way: DVec2, mut show: impl FnMut(f64)) {
    let square = way.length_squared();
    let (half, root) = (from.dot(way), from.perp_dot(way));
    let inside = radius * radius * square - root * root;
    if square > 0.0 && inside > 0.0 {
        show((-half - inside.sqrt()) / square);
        show((-half + inside.sqrt()) / square);
    }
}

/// Edges of a polygon from corner to corner.
pub(super) fn edges(corners: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// Area inside corners that run counter-clockwise; negative clockwise.
pub(super) fn area(corners: &[DVec2]) -> f64 {
    0.5 * edges(corners).map(|(a, b)| a.perp_dot(b)).sum::<f64>()
}

/// The part of a polygon in the unit cell around the origin, by one half plane after the other (Sutherland and Hodgman
/// 1974). Parts of a polygon that falls apart stay joined along the cell's sides, which encloses no area.
fn clipped(mut corners: Vec<DVec2>) -> Vec<DVec2> {
    for normal in [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y] {
        let beyond = |point: DVec2| point.dot(normal) - 0.5;
        let mut kept = Vec::with_capacity(corners.len() + 4);
        for (a, b) in edges(&corners) {
            let (from, to) = (beyond(a), beyond(b));
            if from <= 0.0 {
                kept.push(a);
            }
            if (from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0) {
                kept.push(a + (b - a) * (from / (from - to)));
            }
        }
        corners = kept;
    }
    corners
}

/// Area of the part of a circle around the origin that lies in a box.
fn circle_in_box(radius: f64, low: DVec2, high: DVec2) -> f64 {
    let chord = |y: f64| (radius * radius - y * y).max(0.0).sqrt();
    let (from, to) = (low.x.max(-radius), high.x.min(radius));
    // Between these places both bounds of y are one function each: a side of the box or the circle.
    let mut places = vec![from, to];
    for y in [low.y, high.y] {
        places.extend([-chord(y), chord(y)].into_iter().filter(|x| *x > from && *x < to));
    }
    places.sort_unstable_by(f64::total_cmp);
    let under_circle = |x: f64| 0.5 * (x * chord(x) + radius * radius * (x / radius).clamp(-1.0, 1.0).asin());
    let mut sum = 0.0;
    for pair in places.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let arc = chord(0.5 * (a + b));
        let below = |side: f64| if arc < side { under_circle(b) - under_circle(a) } else { side * (b - a) };
        if arc > low.y && -arc < high.y {
            // From the lower bound, max(low, -circle), to the upper one, min(high, circle).
            sum += below(high.y) + below(-low.y);
        }
    }
    sum.max(0.0)
}

/// Parts in each direction of a cell that edges of several shapes cut, one of them curved or aslant.
const FINE: usize = 64;

/// A part of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Its share of the cell.
    pub share: f64,
    /// Index of its material.
    pub material: usize,
    /// Temperature at the start, where a region tells it.
    pub temperature: Option<f64>,
}

/// The pieces of a stretch that edges cut, each in even parts.
fn pieces(low: f64, high: f64, edges: &[f64], fine: usize) -> Vec<(f64, f64)> {
    let mut ends: Vec<f64> = (0..=fine).map(|k| low + (high - low) * k as f64 / fine as f64).collect();
    ends.extend(edges.iter().copied().filter(|edge| *edge > low && *edge < high));
    ends.sort_unstable_by(f64::total_cmp);
    ends.windows(2).map(|ends| (ends[0], ends[1])).filter(|(a, b)| b > a).collect()
}

impl Scene {
    /// Index of the material at a point (m): later regions win.
    pub fn material_at(&self, x: f64, y: f64) -> usize {
        let own = |region: &Region| region.material.filter(|_| region.shape.contains(DVec2::new(x, y)));
        self.regions.iter().rev().find_map(own).unwrap_or(0)
    }

    /// Whether regions have materials.
    pub fn has_regional_materials(&self) -> bool {
        self.regions.iter().any(|region| region.material.is_some())
    }

    /// Whether not all of the body starts at one temperature.
    pub fn has_uneven_start(&self) -> bool {
        self.initial_profile.is_some() || self.regions.iter().any(|region| region.temperature.is_some())
    }

    /// Whether regions release heat.
    pub fn has_heat_sources(&self) -> bool {
        self.regions.iter().any(|region| region.heat.is_some())
    }

    /// Part of the volume of a cell that lies in a shape: in bodies of shells, that of their volume.
    pub fn share_of(&self, shape: &Shape, cell: &Cell) -> f64 {
        let share = shape.share_of(cell);
        match (self.domain.symmetry(), shape) {
            (Some(symmetry), Shape::Box(extent)) if share > 0.0 && share < 1.0 => {
                let (low, high) = (cell.low.max(extent.low), cell.high.min(extent.high));
                let of_radius = (high.x - low.x) / (cell.high.x - cell.low.x);
                share / of_radius * symmetry.volume(low.x, high.x) / symmetry.volume(cell.low.x, cell.high.x)
            }
            _ => share,
        }
    }

    /// Whether the body is of one material, starts at one temperature and releases no heat.
    pub fn is_uniform(&self) -> bool {
        let has_own = self.has_uneven_start() || self.has_heat_sources();
        !has_own && self.regions.iter().all(|region| region.material.is_none_or(|index| index == 0))
    }

    /// What a cell is made of, by material and temperature at the start, where that is told. Exact unless the edge of a
    /// circle, ellipse or polygon and another edge cut the same cell. In bodies of shells, shares that boxes cut are those of volume.
    pub fn parts_of(&self, cell: &Cell) -> Vec<Part> {
        let shares: Vec<f64> = self.regions.iter().map(|region| region.shape.share_of(cell)).collect();
        let cutting: Vec<usize> = (0..shares.len()).filter(|k| shares[*k] > 0.0 && shares[*k] < 1.0).collect();
        let mut parts: Vec<Part> = Vec::new();
        let mut add = |share: f64, inside: &dyn Fn(usize) -> bool| {
            let here = || (0..shares.len()).rev().filter(|k| inside(*k)).map(|k| &self.regions[k]);
            let material = here().find_map(|region| region.material).unwrap_or(0);
            let temperature = here().find_map(|region| region.temperature);
            match parts.iter_mut().find(|part| (part.material, part.temperature) == (material, temperature)) {
                Some(part) => part.share += share,
                None => parts.push(Part { share, material, temperature }),
            }
        };
        let whole = |k: usize| shares[k] >= 1.0;
        let boxes = cutting.iter().all(|k| matches!(self.regions[*k].shape, Shape::Box(_)));
        match cutting[..] {
            [] => add(1.0, &whole),
            [one] if !boxes => {
                add(shares[one], &|k| k == one || whole(k));
                add(1.0 - shares[one], &whole);
            }
            _ => {
                let edges = cutting.iter().map(|k| self.regions[*k].shape.extent());
                let (across, up): (Vec<_>, Vec<_>) =
                    edges.map(|extent| ([extent.low.x, extent.high.x], [extent.low.y, extent.high.y])).unzip();
                let fine = if boxes { 1 } else { FINE };
                let across = pieces(cell.low.x, cell.high.x, across.as_flattened(), fine);
                let up = pieces(cell.low.y, cell.high.y, up.as_flattened(), fine);
                let symmetry = self.domain.symmetry();
                let width = |low: f64, high: f64| symmetry.map_or(high - low, |symmetry| symmetry.volume(low, high));
                let all = width(cell.low.x, cell.high.x) * (cell.high.y - cell.low.y);
                for (left, right) in &across {
                    for (low, high) in &up {
                        let middle = DVec2::new(0.5 * (left + right), 0.5 * (low + high));
                        let inside = |k: usize| whole(k) || (shares[k] > 0.0 && self.regions[k].shape.contains(middle));
                        add(width(*left, *right) * (high - low) / all, &inside);
                    }
                }
            }
        }
        parts
    }

    /// Temperatures at which a cell starts, with the share of it that each has. Where regions overlap, the later one takes
    /// its share of what was there before: exact unless edges of both cut the same cell.
    pub fn starts_in(&self, cell: &Cell) -> Vec<(f64, f64)> {
        let mut found = self.initial_in(cell);
        for region in &self.regions {
            let Some(temperature) = region.temperature else { continue };
            let share = self.share_of(&region.shape, cell);
            if share > 0.0 {
                found.iter_mut().for_each(|part| part.1 *= 1.0 - share);
                found.push((temperature, share));
                found.retain(|part| part.1 > 0.0);
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn square(x: f64, y: f64, size: f64) -> Vec<DVec2> {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(u, v)| DVec2::new(x + u * size, y + v * size)).to_vec()
    }

    /// Sum of a shape's shares of the cells of a lattice that covers [-4, 4]^2, times their size.
    fn covered(shape: &Shape, spacing: f64) -> f64 {
        let cells = (8.0 / spacing).round() as i32;
        let centre = |k: i32| -4.0 + (k as f64 + 0.5) * spacing;
        let share = |x: i32, y: i32| shape.share_of(&Cell::around(DVec2::new(centre(x), centre(y)), spacing));
        (0..cells).flat_map(|x| (0..cells).map(move |y| (x, y))).map(|(x, y)| share(x, y)).sum::<f64>()
            * spacing
            * spacing
    }

    proptest! {
        /// Cells share out the whole of a shape, wherever their edges fall: to the rounding that counts as none
        /// ([`ON_EDGE`] of each of some thousand cells).
        #[test]
        fn cells_share_out_a_shape(x in -1.5..1.5f64, y in -1.5..1.5f64, r in 0.05..2.0f64, n in 3usize..9,
                                   spacing in prop::sample::select(vec![0.1, 0.25, 0.8, 2.0])) {
            let centre = DVec2::new(x, y);
            let circle = Shape::Circle { centre, radius: r };
            prop_assert!((covered(&circle, spacing) - PI * r * r).abs() < 1e-5);
            // A star of n points, whose area is that of its triangles.
            let corner = |k: usize| {
                let radius = if k.is_multiple_of(2) { r } else { 0.4 * r };
                centre + radius * DVec2::from_angle(PI * k as f64 / n as f64)
            };
            let star = Shape::Polygon((0..2 * n).map(corner).collect());
            let exact = n as f64 * 0.4 * r * r * (PI / n as f64).sin();
            prop_assert!((covered(&star, spacing) - exact).abs() < 1e-5, "{} {exact}", covered(&star, spacing));
            let half_axes = DVec2::new(r, 0.3 * r);
            let ellipse = Shape::Ellipse(Ellipse { centre, half_axes, angle: x });
            prop_assert!((covered(&ellipse, spacing) - 0.3 * PI * r * r).abs() < 1e-5);
            let cell = Cell { low: centre - DVec2::splat(r), high: centre + DVec2::new(r, 0.3 * r) };
            prop_assert!((covered(&Shape::Box(cell), spacing) - 2.6 * r * r).abs() < 1e-5);
        }

        /// An ellipse of equal half axes is a circle, whichever way it is turned: in what it covers, holds and is crossed at.
        #[test]
        fn an_ellipse_of_equal_half_axes_is_a_circle(x in -2.0..2.0f64, y in -2.0..2.0f64, radius in 0.01..3.0f64,
                                                     angle in -7.0..7.0f64, size in 0.01..2.0f64) {
            let centre = DVec2::new(x, y);
            let circle = Shape::Circle { centre, radius };
            let ellipse = Shape::Ellipse(Ellipse { centre, half_axes: DVec2::splat(radius), angle });
            let place = DVec2::new(0.3, -0.2);
            let cell = Cell::around(place, size);
            prop_assert!((ellipse.share_of(&cell) - circle.share_of(&cell)).abs() < 1e-9);
            prop_assert_eq!(ellipse.contains(place), circle.contains(place));
            let crossed = |shape: &Shape| {
                let mut places = Vec::new();
                shape.crossings(place, centre + DVec2::X, |at| places.push(at));
                places
            };
            let (found, wanted) = (crossed(&ellipse), crossed(&circle));
            prop_assert_eq!(found.len(), wanted.len());
            prop_assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-6 * (1.0 + b.abs())));
        }

        /// What lies in an ellipse, and how large it is, does not depend on how it is written, and its box touches it.
        #[test]
        fn an_ellipse_is_the_same_turned_by_a_quarter(a in 0.05..2.0f64, b in 0.05..2.0f64, angle in -3.0..3.0f64,
                                                      x in -2.0..2.0f64, size in 0.01..2.0f64) {
            let centre = DVec2::new(0.1, 0.2);
            let ellipse = Ellipse { centre, half_axes: DVec2::new(a, b), angle };
            let other = Ellipse { half_axes: DVec2::new(b, a), angle: angle + 0.5 * PI, ..ellipse };
            let (own, other) = (Shape::Ellipse(ellipse), Shape::Ellipse(other));
            let cell = Cell::around(DVec2::new(x, 0.3), size);
            prop_assert!((own.share_of(&cell) - other.share_of(&cell)).abs() < 1e-9);
            let Cell { low, high } = own.extent();
            let within = own.share_of(&own.extent()) * (high - low).element_product();
            prop_assert!((within - PI * a * b).abs() < 1e-9);
            let top = Cell { low: DVec2::new(low.x, high.y - 1e-3 * b.min(a)), high };
            prop_assert!(own.share_of(&top) > 0.0);
            let edge = ellipse.as_large(200);
            prop_assert!((area(&edge) - PI * a * b).abs() < 1e-9);
        }

        /// A box is the same as the polygon of its corners.
        #[test]
        fn a_box_is_a_polygon(x in -2.0..2.0f64, y in -2.0..2.0f64, size in 0.01..3.0f64, cell in 0.1..2.0f64) {
            let corner = DVec2::new(x, y);
            let shape = Shape::Box(Cell { low: corner, high: corner + DVec2::splat(size) });
            let cell = Cell::around(DVec2::new(0.3, -0.2), cell);
            let polygon = Shape::Polygon(square(x, y, size));
            prop_assert!((shape.share_of(&cell) - polygon.share_of(&cell)).abs() < 1e-9);
        }
    }

    #[test]
    fn a_share_of_a_cell_far_from_the_origin_keeps_its_digits() {
        let corner = DVec2::splat(1e6);
        let cell = Cell { low: corner, high: corner + DVec2::splat(0.5) };
        let triangle = Shape::Polygon(vec![corner, corner + DVec2::X, corner + DVec2::Y]);
        // Positions of a million metres are known to 1e-10 m.
        assert!((triangle.share_of(&cell) - 1.0).abs() < 1e-8);
        let cell = Cell { low: corner, high: corner + DVec2::ONE };
        assert!((triangle.share_of(&cell) - 0.5).abs() < 1e-8);
    }

    #[test]
    fn a_centre_on_an_edge_belongs_to_one_of_two_boxes() {
        let cell = |low: f64, high: f64| Shape::Box(Cell { low: DVec2::splat(low), high: DVec2::splat(high) });
        // 0.1 + 0.2 rounds up, and belongs to the right box like 0.3.
        for point in [0.3, 0.1 + 0.2] {
            let point = DVec2::splat(point);
            assert!(!cell(0.0, 0.3).contains(point) && cell(0.3, 0.6).contains(point));
        }
        let unbounded = Cell { low: DVec2::new(0.0, f64::NEG_INFINITY), high: DVec2::new(1.0, f64::INFINITY) };
        assert!(Shape::Box(unbounded).contains(DVec2::new(0.5, 0.0)));
        assert_eq!(Shape::Box(unbounded).share_of(&Cell::around(DVec2::ZERO, 1.0)), 0.5);
    }

    #[test]
    fn points_of_a_hollow_polygon_are_told_apart() {
        // A U, open to the top.
        let corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (2.0, 3.0), (2.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)];
        let shape = Shape::Polygon(corners.map(DVec2::from).to_vec());
        for (point, inside) in [((0.5, 2.0), true), ((1.5, 2.0), false), ((2.5, 2.0), true), ((1.5, 0.5), true)] {
            assert_eq!(shape.contains(DVec2::from(point)), inside, "{point:?}");
        }
        // Its arms in one cell fall apart: 2 of 3 units of the upper part.
        let upper = Cell { low: DVec2::new(0.0, 2.0), high: DVec2::new(3.0, 3.0) };
        assert!((shape.share_of(&upper) - 2.0 / 3.0).abs() < 1e-12);
    }
}
