//! Gaps between pipes that symmetry makes equal: turns and mirrors about the centre that bring every pipe onto another one of its
//! ring. What differs between such gaps is how the lattice lies to them, so they are told as one.

use frazil_core::space::domain::Domain;
use frazil_scene::Scene;
use glam::DVec2;

use super::loops::SAME;

/// A pipe: its ring, and where it stands (m).
pub(super) type Place = (usize, DVec2);

/// By link, given by the numbers of its pipes, the first link that is like it.
pub(super) fn first_alike(scene: &Scene, places: &[Place], links: &[[usize; 2]]) -> Vec<usize> {
    let mut first: Vec<usize> = (0..links.len()).collect();
    let by_ends = Sorted::new(links.iter().map(|ends| key(*ends)).collect());
    for image in images(scene, places) {
        for (number, ends) in links.iter().enumerate() {
            let other = by_ends.find(key(ends.map(|end| image[end])));
            if let Some(other) = other {
                let (a, b) = (head(&mut first, number), head(&mut first, other));
                first[a.max(b)] = a.min(b);
            }
        }
    }
    (0..links.len()).map(|link| head(&mut first, link)).collect()
}

/// Numbers of the pipes of a link, in order.
fn key([a, b]: [usize; 2]) -> (usize, usize) {
    (a.min(b), a.max(b))
}

/// The first of the group of a link.
fn head(first: &mut [usize], mut link: usize) -> usize {
    while first[link] != link {
        first[link] = first[first[link]];
        link = first[link];
    }
    link
}

/// Links in order of their pipes.
struct Sorted(Vec<((usize, usize), usize)>);

impl Sorted {
    fn new(keys: Vec<(usize, usize)>) -> Self {
        let mut sorted: Vec<_> = keys.into_iter().enumerate().map(|(link, key)| (key, link)).collect();
        sorted.sort_unstable();
        Sorted(sorted)
    }

    fn find(&self, key: (usize, usize)) -> Option<usize> {
        let at = self.0.partition_point(|entry| entry.0 < key);
        self.0.get(at).filter(|entry| entry.0 == key).map(|entry| entry.1)
    }
}

/// Turns and mirrors that leave a plan as it is, each by the number of the pipe onto which it brings every pipe. None but the plan
/// itself where its ground, water or barriers are not the same all around.
fn images(scene: &Scene, places: &[Place]) -> Vec<Vec<usize>> {
    let round = matches!(scene.domain, Domain::Ring { .. })
        && scene.regions.is_empty()
        && scene.flow.is_none()
        && scene.random.is_even()
        && !scene.has_barriers()
        && scene.wall_parts.is_empty();
    // A pipe at the centre tells nothing of turns.
    let size = scene.domain.extent();
    let Some(&(ring, first)) = places.iter().find(|place| place.1.length() > SAME * size) else { return Vec::new() };
    if !round {
        return Vec::new();
    }
    let known = Places::of(places, SAME * size);
    let onto =
        places.iter().filter(|place| place.0 == ring && (place.1.length() - first.length()).abs() <= SAME * size);
    let mirrored = |place: DVec2| DVec2::new(place.x, -place.y);
    let moves = onto.flat_map(|place| {
        // From the first pipe onto this one by a turn, and by a mirror.
        let to = place.1.normalize();
        [(mirrored(first.normalize()).rotate(to), false), (first.normalize().rotate(to), true)]
    });
    // Ground that conducts by direction is the same after half a turn, and mirrored at an axis.
    let moves = moves.filter(|(turn, _)| scene.conducts_alike() || turn.y.abs() <= SAME);
    let image = |(turn, mirror): (DVec2, bool)| -> Option<Vec<usize>> {
        let moved = |place: DVec2| turn.rotate(if mirror { mirrored(place) } else { place });
        places.iter().map(|(ring, place)| known.find((*ring, moved(*place)))).collect()
    };
    moves.filter_map(image).collect()
}

/// Pipes in order of x.
struct Places<'a> {
    all: &'a [Place],
    by_x: Vec<usize>,
    /// Distance (m) up to which places are the same.
    same: f64,
}

impl<'a> Places<'a> {
    fn of(all: &'a [Place], same: f64) -> Self {
        let mut by_x: Vec<usize> = (0..all.len()).collect();
        by_x.sort_by(|a, b| all[*a].1.x.total_cmp(&all[*b].1.x));
        Places { all, by_x, same }
    }

    /// The pipe of a ring that stands at a place.
    fn find(&self, (ring, place): Place) -> Option<usize> {
        let x = |k: &usize| self.all[*k].1.x;
        let from = self.by_x.partition_point(|k| x(k) < place.x - self.same);
        let near = self.by_x[from..].iter().take_while(|k| x(k) <= place.x + self.same);
        near.copied().find(|k| self.all[*k].0 == ring && self.all[*k].1.distance(place) <= self.same)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use frazil_core::space::domain::Sector;
    use frazil_scene::Shape;
    use proptest::prelude::*;

    use super::super::loops::neighbours;
    use super::*;

    fn ring(number: usize, count: usize, radius: f64, first: f64) -> Vec<Place> {
        let place = |k: usize| (number, radius * DVec2::from_angle(first + TAU * k as f64 / count as f64));
        (0..count).map(place).collect()
    }

    /// How many links there are of each kind, in order.
    fn kinds(places: &[Place], change: impl Fn(&mut Scene)) -> Vec<usize> {
        let mut scene = Scene::bare(Domain::Ring { outer_radius: 9.0, sector: Sector::Whole }, 1.0, Vec::new());
        change(&mut scene);
        let at: Vec<DVec2> = places.iter().map(|place| place.1).collect();
        let links = neighbours(&at);
        let first = first_alike(&scene, places, &links);
        let mut counts: Vec<usize> =
            (0..links.len()).map(|link| first.iter().filter(|other| **other == link).count()).collect();
        counts.retain(|count| *count > 0);
        counts.sort_unstable();
        counts
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        /// Of an even ring all gaps are alike, however it is turned; of two staggered ones those within each and those between.
        #[test]
        fn even_rings_have_as_many_kinds_as_rings(count in 3usize..60, first in -7.0..7.0f64) {
            let one = ring(0, count, 5.0, first);
            prop_assert_eq!(kinds(&one, |_| {}), vec![count]);
            let both = [one, ring(1, count, 4.4, first + 0.5 * TAU / count as f64)].concat();
            let found = kinds(&both, |_| {});
            prop_assert_eq!(found.last().copied(), Some(2 * count));
            prop_assert!(found.len() <= 3, "{:?}", found);
        }

        /// One pipe that stands elsewhere leaves a mirror at most.
        #[test]
        fn a_pipe_out_of_place_leaves_gaps_of_their_own(number in 0usize..12, x in 0.01..0.1f64) {
            let mut places = ring(0, 12, 5.0, 0.3);
            let outwards = places[number].1.normalize();
            places[number].1 += x * outwards;
            prop_assert_eq!(kinds(&places, |_| {}), vec![2; 6]);
            places[number].1 += x * outwards.perp();
            prop_assert_eq!(kinds(&places, |_| {}), vec![1; 12]);
        }
    }

    #[test]
    fn ground_that_is_not_the_same_all_around_makes_all_gaps_differ() {
        let places = ring(0, 8, 5.0, 0.0);
        let stone = Shape::Circle { centre: DVec2::new(2.0, 0.0), radius: 0.5 };
        assert_eq!(kinds(&places, |scene| scene.impermeable = vec![stone.clone()]), vec![1; 8]);
        // A pipe at the centre turns with the rest.
        assert_eq!(kinds(&[places, vec![(1, DVec2::ZERO)]].concat(), |_| {}), vec![8, 8]);
    }
}
