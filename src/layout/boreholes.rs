//! Boreholes that leave the vertical: where they stand at a depth, and whether two of them meet on the way.

use frazil_scene::{PipeName, PipeRing, Range, Read, Section};
use glam::DVec2;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use super::goals;

/// Times that a borehole is drawn anew because it would meet another, at most.
const MOST_DRAWS: usize = 1000;

/// A borehole that is known.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Borehole {
    pipe: PipeName,
    course: Course,
    /// Depth (m) at which it is read, where there are no strata that say it.
    pub(super) depth: Option<f64>,
}

/// How a borehole runs.
#[derive(Debug, Clone, PartialEq)]
enum Course {
    /// Straight, with a slope (m/m).
    Straight(DVec2),
    /// As surveyed.
    Surveyed(Way),
}

/// Why boreholes cannot stand where they are told to.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Misplaced {
    /// There is no such ring.
    #[error("found pipe {pipe}, must be of a ring from 1 to {rings}")]
    NoRing {
        /// The pipe.
        pipe: PipeName,
        /// Rings that there are.
        rings: usize,
    },
    /// There is no such pipe on the ring.
    #[error("found pipe {pipe}, must be at most {last}")]
    NoPipe {
        /// The pipe.
        pipe: PipeName,
        /// The last of the ring.
        last: PipeName,
    },
    /// Two boreholes meet on their way down.
    #[error(
        "boreholes of pipes {first} and {second} intersect at a depth of {depth:.1} m: their axes are {distance:.4} m apart, must be more than \
         {least}"
    )]
    Meet {
        /// One of them.
        first: PipeName,
        /// The other.
        second: PipeName,
        /// Where (m).
        depth: f64,
        /// How near they come (m).
        distance: f64,
        /// How near they may come (m).
        least: f64,
    },
    /// Boreholes that deviate by chance meet however they are drawn.
    #[error(
        "percent: found {percent}, boreholes deviate so far that pipe {pipe} intersects others in {MOST_DRAWS} draws"
    )]
    Crowded {
        /// How far boreholes deviate (% of their depth).
        percent: f64,
        /// The one that finds no place.
        pipe: PipeName,
    },
}

/// What is wrong with a survey; depths in m.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
enum BadSurvey {
    #[error("found no rows, must have at least one")]
    Empty,
    #[error("found a depth of {depth}, must be at least 0")]
    Above { depth: f64 },
    #[error("found a depth of {to} after {from}, must increase")]
    Back { from: f64, to: f64 },
    #[error("found {end} as the last depth, must reach {reach}")]
    Short { end: f64, reach: f64 },
}

/// Reads the boreholes of a layout; strata, where there are any, say at which depths they are read, and how deep they go.
pub(super) fn read(layout: &mut Section<'_>, layered: bool, deepest: Option<f64>) -> Vec<Borehole> {
    let mut found: Vec<Borehole> = Vec::new();
    for mut section in layout.sections("boreholes") {
        let Ok(own) = borehole(&mut section, layered, deepest) else { continue };
        if found.iter().any(|other| other.pipe == own.pipe) {
            section.problem("pipe", format!("found pipe {} twice", own.pipe));
        }
        if let (Some(first), Some(depth)) = (found.first(), own.depth)
            && let Some(known) = first.depth.filter(|known| *known != depth)
        {
            let message = format!("found {depth}, must be {known} as of pipe {}: the plan is at one depth", first.pipe);
            section.problem(("depth", "m"), message);
        }
        found.push(own);
    }
    found
}

fn borehole(section: &mut Section<'_>, layered: bool, deepest: Option<f64>) -> Read<Borehole> {
    const SURVEYED: (&str, &str) = ("surveyed", "m");
    section.refuse("ring", "the name of the pipe has it");
    let pipe = section.pipe_name("pipe");
    let depth = goals::depth(section, layered, Range::NOT_NEGATIVE);
    let told = section.only_one(&[("inclination", "deg").into(), SURVEYED.into()]);
    let told = told.inspect_err(|_| section.abandon())?;
    let course = if told == 0 {
        let inclination = section.number(("inclination", "deg"), Range::from_to_below(0.0, 90.0));
        let azimuth = section.number(("azimuth", "deg"), Range::ANY);
        Course::Straight(inclination?.to_radians().tan() * DVec2::from_angle(azimuth?.to_radians()))
    } else {
        section.refuse(("azimuth", "deg"), "the survey has it");
        let rows = section.points(SURVEYED, Some(3))?;
        let reach = deepest.or(depth.unwrap_or(None)).unwrap_or(0.0);
        let way = Way::surveyed(&rows, reach).map_err(|wrong| section.problem(SURVEYED, wrong.to_string()))?;
        Course::Surveyed(way)
    };
    Ok(Borehole { pipe: pipe?, course, depth: depth? })
}

/// How far pipes stand from their places.
pub(super) type Moved = Vec<(PipeName, DVec2)>;

/// The way of a borehole: how far it stands from its place (m) at depths (m), linear between them.
#[derive(Debug, Clone, PartialEq)]
struct Way(Vec<(f64, DVec2)>);

impl Way {
    /// A borehole that stays in its place.
    fn vertical(depth: f64) -> Way {
        Way::straight(DVec2::ZERO, depth)
    }

    /// A straight borehole by its slope (m/m).
    fn straight(slope: DVec2, depth: f64) -> Way {
        Way(vec![(0.0, DVec2::ZERO), (depth, slope * depth)])
    }

    /// A borehole by what was measured in it down to a depth: rows of depth and of how far it stands from its place.
    fn surveyed(rows: &[Vec<f64>], depth: f64) -> Result<Way, BadSurvey> {
        let mut points: Vec<(f64, DVec2)> = rows.iter().map(|row| (row[0], DVec2::new(row[1], row[2]))).collect();
        let (Some(first), Some(last)) = (points.first(), points.last()) else {
            return Err(BadSurvey::Empty);
        };
        if first.0 < 0.0 {
            return Err(BadSurvey::Above { depth: first.0 });
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
            return Err(BadSurvey::Back { from: pair[0].0, to: pair[1].0 });
        }
        if depth > last.0 {
            return Err(BadSurvey::Short { end: last.0, reach: depth });
        }
        // It was set up in its place.
        if first.0 > 0.0 {
            points.insert(0, (0.0, DVec2::ZERO));
        }
        Ok(Way(points))
    }

    fn at(&self, depth: f64) -> DVec2 {
        let Some(after) = self.0.iter().position(|(known, _)| *known >= depth) else {
            return self.0.last().map_or(DVec2::ZERO, |(_, way)| *way);
        };
        let (d1, w1) = self.0[after];
        let Some((d0, w0)) = after.checked_sub(1).map(|before| self.0[before]) else { return w1 };
        w0 + (w1 - w0) * ((depth - d0) / (d1 - d0))
    }

    /// The depth down to a given one at which two boreholes come closest, and their distance there (m). Between points of
    /// both, one moves on a straight line as seen from the other.
    fn closest(&self, own: DVec2, other: &Way, place: DVec2, depth: f64) -> (f64, f64) {
        let mut depths: Vec<f64> = self.0.iter().chain(&other.0).map(|(known, _)| *known).collect();
        depths.retain(|known| *known < depth);
        depths.extend([0.0, depth]);
        depths.sort_by(f64::total_cmp);
        let apart = |depth: f64| place + other.at(depth) - own - self.at(depth);
        let mut least = (0.0, apart(0.0).length());
        for piece in depths.windows(2) {
            let (from, to) = (apart(piece[0]), apart(piece[1]));
            let along = to - from;
            let part =
                if along == DVec2::ZERO { 0.0 } else { (-from.dot(along) / along.length_squared()).clamp(0.0, 1.0) };
            let distance = (from + along * part).length();
            if distance < least.1 {
                least = (piece[0] + part * (piece[1] - piece[0]), distance);
            }
        }
        least
    }
}

/// Where boreholes stand at a depth, from what is known of them down to `deepest`.
///
/// # Errors
/// Where the rings have no such pipe, or two boreholes meet.
pub(super) fn moved(boreholes: &[Borehole], rings: &[PipeRing], depth: f64, deepest: f64) -> Result<Moved, Misplaced> {
    let mut ways: Vec<(PipeName, Way)> = Vec::with_capacity(boreholes.len());
    for Borehole { pipe, course, .. } in boreholes {
        let pipe = *pipe;
        let Some(ring) = rings.get(pipe.ring) else { return Err(Misplaced::NoRing { pipe, rings: rings.len() }) };
        if pipe.pipe >= ring.count {
            return Err(Misplaced::NoPipe { pipe, last: PipeName { pipe: ring.count - 1, ..pipe } });
        }
        let way = match course {
            Course::Straight(slope) => Way::straight(*slope, deepest),
            Course::Surveyed(way) => way.clone(),
        };
        ways.push((pipe, way));
    }
    let vertical = Way::vertical(deepest);
    let leaning = |pipe: PipeName| ways.iter().find(|(other, _)| *other == pipe).map(|(_, way)| way);
    let pipes = || (0..).zip(rings).flat_map(|(at, ring)| ring.numbers().map(move |pipe| PipeName { ring: at, pipe }));
    for (own, way) in &ways {
        let ring = &rings[own.ring];
        // Of two that lean, the later looks at the earlier.
        for other in pipes().filter(|other| other != own && (other < own || leaning(*other).is_none())) {
            let beside = &rings[other.ring];
            let other_way = leaning(other).unwrap_or(&vertical);
            let (at, distance) = way.closest(ring.place(own.pipe), other_way, beside.place(other.pipe), deepest);
            // To the nanometre, so that no rounding of the sum is told.
            let least = ((ring.pipe_radius + beside.pipe_radius) * 1e9).round() / 1e9;
            if distance <= least {
                let (first, second) = (other.min(*own), other.max(*own));
                return Err(Misplaced::Meet { first, second, depth: at, distance, least });
            }
        }
    }
    Ok(ways.iter().map(|(pipe, way)| (*pipe, way.at(depth))).collect())
}

/// Slopes (m/m) of all boreholes of all rings, each to end anywhere in a circle, as likely in all of it. One that would meet
/// another down to a depth is drawn anew.
///
/// # Errors
/// Where one finds no place.
pub(super) fn draw(rings: &[PipeRing], percent: f64, random: &mut StdRng, depth: f64) -> Result<Moved, Misplaced> {
    let mut slopes = Moved::new();
    let pipes =
        rings.iter().enumerate().flat_map(|(at, ring)| (0..ring.count).map(move |k| PipeName { ring: at, pipe: k }));
    for own in pipes {
        let ring = &rings[own.ring];
        let mut one = || {
            let way = 0.01 * percent * random.random::<f64>().sqrt();
            way * DVec2::from_angle(std::f64::consts::TAU * random.random::<f64>())
        };
        let stands = |one: PipeName| !rings[one.ring].missing.contains(&one.pipe);
        let free = |slope: &DVec2| {
            let way = Way::straight(*slope, depth);
            slopes.iter().filter(|(other, _)| stands(*other) && stands(own)).all(|(other, slope)| {
                let beside = &rings[other.ring];
                let other_way = Way::straight(*slope, depth);
                let (_, distance) = way.closest(ring.place(own.pipe), &other_way, beside.place(other.pipe), depth);
                distance > ring.pipe_radius + beside.pipe_radius
            })
        };
        let found = (0..MOST_DRAWS).map(|_| one()).find(free);
        slopes.push((own, found.ok_or(Misplaced::Crowded { percent, pipe: own })?));
    }
    Ok(slopes)
}

/// The random numbers of all members.
pub(super) fn chance(seed: u64) -> StdRng {
    StdRng::seed_from_u64(seed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn survey(rows: &[[f64; 3]], depth: f64) -> Result<Way, BadSurvey> {
        Way::surveyed(&rows.iter().map(|row| row.to_vec()).collect::<Vec<_>>(), depth)
    }

    #[test]
    fn ways_are_read_between_what_was_surveyed() {
        let way = survey(&[[0.0, 0.0, 0.0], [100.0, 0.1, 0.05], [200.0, 0.2, 0.3]], 150.0).expect("a way");
        assert!(way.at(150.0).distance(DVec2::new(0.15, 0.175)) < 1e-15);
        assert_eq!(way.at(100.0), DVec2::new(0.1, 0.05));
        // From its place at the collar, where the survey begins deeper.
        let way = survey(&[[100.0, 0.1, 0.0]], 50.0).expect("a way");
        assert!(way.at(50.0).distance(DVec2::new(0.05, 0.0)) < 1e-15);
    }

    /// Both ways are lines between their points, so a fine search finds nothing closer.
    #[test]
    fn the_closest_depth_is_that_of_a_search() {
        let one = survey(&[[0.0, 0.0, 0.0], [60.0, 0.7, 0.2], [130.0, -0.1, 0.4], [200.0, 0.2, 0.3]], 200.0);
        let other = survey(&[[20.0, -0.1, 0.0], [90.0, -0.9, 0.1], [210.0, 0.3, -0.4]], 200.0);
        let (one, other) = (one.expect("a way"), other.expect("a way"));
        let (own, place) = (DVec2::new(5.0, 0.0), DVec2::new(6.1, 0.3));
        let apart = |depth: f64| (place + other.at(depth) - own - one.at(depth)).length();
        let searched = (0..=20_000).map(|k| apart(0.01 * f64::from(k))).fold(f64::INFINITY, f64::min);
        let (at, distance) = one.closest(own, &other, place, 200.0);
        assert!((distance - searched).abs() < 1e-4 && distance <= searched + 1e-12, "{distance} {searched}");
        assert!((apart(at) - distance).abs() < 1e-12);
    }
}
