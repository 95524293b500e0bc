//! Cracks and closed parts that nothing crosses: which ways between two places they cut, and when.

use glam::DVec2;

use crate::boundary::ghosts::Ghosts;
use crate::boundary::patch::{Boundary, Side};
use crate::space::lattice::Lattice;
use crate::space::segment::{Segment, offset};

impl Crack {
    /// Length of the whole crack (m).
    pub fn length(&self) -> f64 {
        (self.to - self.from).length()
    }

    /// When the tip has come this far (m) from where the crack begins; never is infinite, and what is there at the start
    /// has come at zero.
    pub fn time_at(&self, distance: f64) -> f64 {
        match &self.growth {
            Growth::Whole { start } => *start,
            Growth::Steady { start, speed } => start + distance / speed,
            Growth::Table(rows) => {
                let Some(next) = rows.iter().position(|row| row.1 >= distance) else { return f64::INFINITY };
                let Some(before) = next.checked_sub(1) else { return 0.0 };
                let ((t0, l0), (t1, l1)) = (rows[before], rows[next]);
                t0 + (t1 - t0) * (distance - l0) / (l1 - l0)
            }
        }
    }
}

/// A segment that no heat crosses.
#[derive(Debug, Clone, PartialEq)]
pub struct Crack {
    /// Where it begins (m).
    pub from: DVec2,
    /// Where it ends at the latest (m).
    pub to: DVec2,
    /// How it comes to be.
    pub growth: Growth,
}

/// How a crack comes to be.
#[derive(Debug, Clone, PartialEq)]
pub enum Growth {
    /// All at once.
    Whole {
        /// When (s).
        start: f64,
    },
    /// From its beginning on, at one speed.
    Steady {
        /// When it begins (s).
        start: f64,
        /// Speed of its tip (m/s).
        speed: f64,
    },
    /// By rows of time (s) and length (m), linear between them and constant beyond; neither decreases.
    Table(Vec<(f64, f64)>),
}

/// Distance over the spacing up to which a place is on a crack.
const ON_IT: f64 = 1e-9;

/// A crack, or its image behind walls, as pairs meet it.
struct Barrier<'a> {
    segment: Segment,
    /// Images turn left into right.
    turned: bool,
    /// Distance (m) up to which a particle is on the crack, and a way through its end: rounding of positions decides
    /// neither.
    slack: f64,
    crack: &'a Crack,
}

impl Barrier<'_> {
    /// When the way from `p` to `q` is cut. The way crosses if its ends lie on different sides of the crack, of which the
    /// left one includes the crack's own line, and if the crack's ends, included, lie on different sides of the way. So a
    /// particle on a crack has one side, whatever rounding does, and ways that end on a crack or run along it are judged
    /// like any other.
    fn cuts(&self, p: DVec2, q: DVec2) -> Option<f64> {
        let (from, to) = self.segment;
        let slack = DVec2::splat(self.slack);
        if p.min(q).cmpgt(from.max(to) + slack).any() || p.max(q).cmplt(from.min(to) - slack).any() {
            return None;
        }
        let on_line = self.slack * (to - from).length();
        let left = |point: DVec2| offset(self.segment, point) > if self.turned { on_line } else { -on_line };
        if left(p) == left(q) {
            return None;
        }
        let (a, b) = (offset((p, q), from), offset((p, q), to));
        let at_end = self.slack * (q - p).length();
        if (a > at_end && b > at_end) || (a < -at_end && b < -at_end) {
            return None;
        }
        let share = if a == b { 0.0 } else { (a / (a - b)).clamp(0.0, 1.0) };
        Some(self.crack.time_at(share * self.crack.length()))
    }
}

/// Mirrors of x and of y that take a body to its image: twice the place of a wall.
type Mirrors = (Option<f64>, Option<f64>);

/// Cracks and closed parts with their images behind the straight walls of a body.
pub struct Barriers<'a> {
    all: Vec<Barrier<'a>>,
    /// Whether closed parts lie on the way between two places.
    blocked: &'a dyn Fn(DVec2, DVec2) -> bool,
    /// The body itself and its images.
    images: Vec<Mirrors>,
    /// What mirrors x and y: twice the place of each wall, left and right, bottom and top.
    mirrors: [[f64; 2]; 2],
}

impl<'a> Barriers<'a> {
    /// The cracks of a scene on a lattice, and closed parts, of which `blocked` tells whether they lie on the way between two places.
    pub fn new(
        cracks: &'a [Crack],
        blocked: &'a dyn Fn(DVec2, DVec2) -> bool,
        lattice: &Lattice,
        boundary: &Boundary,
    ) -> Self {
        let low = 2.0 * lattice.corner;
        let high = low + 2.0 * lattice.spacing * DVec2::new(lattice.columns as f64, lattice.rows as f64);
        let mirrors = [[low.x, high.x], [low.y, high.y]];
        let of = |axis: usize| {
            let walls = (0..2).filter(move |end| boundary.sides[2 * axis + end] != Side::Curved);
            [None].into_iter().chain(walls.map(move |end| Some(mirrors[axis][end])))
        };
        let images: Vec<Mirrors> = of(0).flat_map(|x| of(1).map(move |y| (x, y))).collect();
        let slack = ON_IT * lattice.spacing;
        let seen = |crack: &'a Crack, (x, y): Mirrors| Barrier {
            segment: (mirrored(crack.from, (x, y)), mirrored(crack.to, (x, y))),
            turned: x.is_some() != y.is_some(),
            slack,
            crack,
        };
        let all = cracks.iter().flat_map(|crack| images.iter().map(move |image| seen(crack, *image))).collect();
        Barriers { all, blocked, images, mirrors }
    }

    /// The same without images, for places inside the body.
    pub fn inside(cracks: &'a [Crack], blocked: &'a dyn Fn(DVec2, DVec2) -> bool, spacing: f64) -> Self {
        let barrier = |crack: &'a Crack| Barrier {
            segment: (crack.from, crack.to),
            turned: false,
            slack: ON_IT * spacing,
            crack,
        };
        let mirrors = [[0.0; 2]; 2];
        Barriers { all: cracks.iter().map(barrier).collect(), blocked, images: vec![(None, None)], mirrors }
    }

    /// When the way between two places is cut: never is infinite, and closed parts are there from the start.
    pub fn between(&self, p: DVec2, q: DVec2) -> f64 {
        if self.images.iter().any(|image| (self.blocked)(mirrored(p, *image), mirrored(q, *image))) {
            return 0.0;
        }
        self.all.iter().filter_map(|barrier| barrier.cuts(p, q)).fold(f64::INFINITY, f64::min)
    }

    /// When the way from a particle of those at `positions` to a partner, which may be a ghost, is cut.
    ///
    /// Both directions of a pair are judged by the same segment, so that they are cut together to the last bit. A pair with
    /// the image of a particle behind a wall that lets heat through is cut with the pair itself at the latest: such images
    /// can act against their particle, which the pair itself outweighs.
    pub(super) fn of_pair(&self, positions: &[DVec2], ghosts: &Ghosts, i: usize, partner: usize) -> f64 {
        let Some(ghost) = partner.checked_sub(positions.len()) else {
            return self.between(positions[i.min(partner)], positions[i.max(partner)]);
        };
        let model = ghosts.model[ghost] as usize;
        let mirrors = self.mirrors_of(positions[model], ghosts.position[ghost]);
        let (first, second) = (positions[i.min(model)], positions[i.max(model)]);
        let own = self.between(first, mirrored(second, mirrors));
        if ghosts.pays[ghost].is_some() { own.min(self.between(first, second)) } else { own }
    }

    /// The mirrors that take a particle to a ghost of it.
    fn mirrors_of(&self, particle: DVec2, ghost: DVec2) -> Mirrors {
        let of = |axis: usize, own: f64, image: f64| {
            let nearest = |wall: &&f64| (*wall - (own + image)).abs();
            let walls = self.mirrors[axis].iter();
            (own != image).then(|| walls.min_by(|a, b| nearest(a).total_cmp(&nearest(b))).copied()).flatten()
        };
        (of(0, particle.x, ghost.x), of(1, particle.y, ghost.y))
    }
}

fn mirrored(point: DVec2, (x, y): Mirrors) -> DVec2 {
    DVec2::new(x.map_or(point.x, |x| x - point.x), y.map_or(point.y, |y| y - point.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crack(from: (f64, f64), to: (f64, f64), growth: Growth) -> Crack {
        Crack { from: from.into(), to: to.into(), growth }
    }

    fn cut(crack: &Crack, turned: bool, p: (f64, f64), q: (f64, f64)) -> Option<f64> {
        let barrier = Barrier { segment: (crack.from, crack.to), turned, slack: 1e-12, crack };
        let both = [barrier.cuts(p.into(), q.into()), barrier.cuts(q.into(), p.into())];
        assert_eq!(both[0].is_some(), both[1].is_some());
        both[0]
    }

    #[test]
    fn ways_are_cut_by_the_side_on_which_their_ends_lie() {
        let level = crack((0.0, 0.0), (2.0, 0.0), Growth::Whole { start: 3.0 });
        let cases = [
            ((1.0, -1.0), (1.0, 1.0), true),
            // Past either tip, and through one.
            ((-1.0, -1.0), (-0.5, 1.0), false),
            ((2.5, -1.0), (3.0, 1.0), false),
            ((2.0, -1.0), (2.0, 1.0), true),
            ((0.0, 1.0), (0.0, -1.0), true),
            // Ends on the crack count to its left, above.
            ((1.0, 0.0), (1.0, 1.0), false),
            ((1.0, 0.0), (1.0, -1.0), true),
            // Along the crack.
            ((0.5, 0.0), (1.5, 0.0), false),
            ((-1.0, 0.0), (3.0, 0.0), false),
        ];
        for (p, q, expected) in cases {
            assert_eq!(cut(&level, false, p, q), expected.then_some(3.0), "{p:?} {q:?}");
        }
        assert_eq!(cut(&level, true, (1.0, 0.0), (1.0, 1.0)), Some(3.0));
        assert_eq!(cut(&level, true, (1.0, 0.0), (1.0, -1.0)), None);
    }

    #[test]
    fn a_tip_cuts_what_it_passes() {
        let growing = crack((0.0, 0.0), (2.0, 0.0), Growth::Steady { start: 10.0, speed: 0.5 });
        assert_eq!(cut(&growing, false, (0.5, -1.0), (0.5, 1.0)), Some(11.0));
        assert_eq!(cut(&growing, false, (1.0, -1.0), (2.0, 1.0)), Some(13.0));
        let table = crack((0.0, 0.0), (2.0, 0.0), Growth::Table(vec![(5.0, 0.5), (7.0, 0.5), (9.0, 1.5)]));
        for (x, time) in [(0.25, 0.0), (0.5, 0.0), (1.0, 8.0), (1.5, 9.0), (1.75, f64::INFINITY)] {
            assert_eq!(cut(&table, false, (x, -1.0), (x, 1.0)), Some(time), "{x}");
        }
    }
}
