//! Boreholes that leave the vertical: where they stand at a depth, and whether two of them meet on the way.

use frazil_scene::{NoPipeName, PipeName, PipeRing};
use glam::DVec2;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use serde::Deserialize;
use toml::Value;

/// Times that a borehole is drawn anew because it would meet another, at most.
const MOST_DRAWS: usize = 1000;

/// A borehole that is known.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "Written")]
pub(super) struct Borehole {
    pipe: PipeName,
    inclination_deg: Option<f64>,
    azimuth_deg: Option<f64>,
    surveyed_m: Option<Vec<[f64; 3]>>,
    depth_m: Option<f64>,
}

/// A borehole as a study file has it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    pipe: Value,
    /// The ring of the pipe in older files.
    ring: Option<Value>,
    inclination_deg: Option<f64>,
    azimuth_deg: Option<f64>,
    surveyed_m: Option<Vec<[f64; 3]>>,
    depth_m: Option<f64>,
}

impl TryFrom<Written> for Borehole {
    type Error = String;

    fn try_from(written: Written) -> Result<Self, String> {
        let Written { pipe, ring, inclination_deg, azimuth_deg, surveyed_m, depth_m } = written;
        // Files that count rings and pipes from 0 are told the name.
        let number = |value: &Value| value.as_integer().and_then(|number| usize::try_from(number).ok());
        let old = number(&pipe).zip(ring.as_ref().map_or(Some(0), number));
        let old =
            old.map(|(pipe, ring)| format!(": what was pipe {pipe} of ring {ring} is \"{}\"", PipeName { ring, pipe }));
        let wrong = |message: String| format!("{message}{}", old.clone().unwrap_or_default());
        let name = pipe.as_str().and_then(|name| name.parse().ok());
        let pipe = name.ok_or_else(|| wrong(format!("pipe: found {pipe}, {NoPipeName}")))?;
        if let Some(ring) = ring {
            return Err(format!("ring: found {ring}, must be left out: the name of the pipe has it"));
        }
        Ok(Borehole { pipe, inclination_deg, azimuth_deg, surveyed_m, depth_m })
    }
}

/// Boreholes that deviate by chance.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Deviation {
    pub(super) depth_m: Option<f64>,
    pub(super) percent: f64,
    pub(super) members: usize,
    pub(super) seed: u64,
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

/// The depth at which boreholes without horizons are read, which all of them must name alike.
pub(super) fn depth(boreholes: &[Borehole]) -> Result<f64, String> {
    let mut common: Option<(PipeName, f64)> = None;
    for borehole in boreholes {
        let own = borehole.pipe;
        let depth =
            borehole.depth_m.ok_or_else(|| format!("pipe {own}: depth_m is missing, of the horizon that is run"))?;
        match common {
            Some((other, known)) if known != depth => {
                return Err(format!("found depth_m {known} of pipe {other} and {depth} of pipe {own}, must be one"));
            }
            _ => common = Some((own, depth)),
        }
    }
    Ok(common.map_or(0.0, |(_, depth)| depth))
}

/// Refuses depths of boreholes where horizons have theirs.
pub(super) fn without_depth(boreholes: &[Borehole]) -> Result<(), String> {
    match boreholes.iter().find_map(|borehole| Some((borehole.pipe, borehole.depth_m?))) {
        Some((pipe, depth)) => Err(format!(
            "pipe {pipe}: depth_m: found {depth}, must be left out: boreholes are read at the depth of each horizon"
        )),
        None => Ok(()),
    }
}

/// Where boreholes stand at a depth, from what is known of them down to `deepest`.
pub(super) fn moved(boreholes: &[Borehole], rings: &[PipeRing], depth: f64, deepest: f64) -> Result<Moved, String> {
    let mut ways: Vec<(PipeName, Way)> = Vec::new();
    for borehole in boreholes {
        let pipe = borehole.pipe;
        let Some(ring) = rings.get(pipe.ring) else {
            return Err(format!("found pipe {pipe}, must be of a ring from 1 to {}", rings.len()));
        };
        if pipe.pipe >= ring.count {
            let last = PipeName { pipe: ring.count - 1, ..pipe };
            return Err(format!("found pipe {pipe}, must be at most {last}"));
        }
        if ways.iter().any(|(other, _)| *other == pipe) {
            return Err(format!("found pipe {pipe} twice"));
        }
        ways.push((pipe, way(borehole, deepest).map_err(|message| format!("pipe {pipe}: {message}"))?));
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
                return Err(format!(
                    "pipes {first} and {second} meet at a depth of {at:.1} m: their axes are {distance:.4} m apart, must be \
                     more than {least}"
                ));
            }
        }
    }
    Ok(ways.iter().map(|(pipe, way)| (*pipe, way.at(depth))).collect())
}

/// The way of one borehole down to a depth.
fn way(borehole: &Borehole, depth: f64) -> Result<Way, String> {
    if !(depth >= 0.0 && depth.is_finite()) {
        return Err(format!("found depth_m {depth}, must be 0 or more"));
    }
    match (borehole.inclination_deg, borehole.azimuth_deg, &borehole.surveyed_m) {
        (Some(inclination), Some(azimuth), None) => {
            if !((0.0..90.0).contains(&inclination) && azimuth.is_finite()) {
                return Err(format!("found inclination_deg {inclination}, must be 0 or more and below 90"));
            }
            Ok(Way::straight(inclination.to_radians().tan() * DVec2::from_angle(azimuth.to_radians()), depth))
        }
        (None, None, Some(rows)) => surveyed(rows, depth),
        _ => Err("must have inclination_deg and azimuth_deg, or surveyed_m".into()),
    }
}

/// A borehole by what was measured in it: rows of depth and of how far it stands from its place.
fn surveyed(rows: &[[f64; 3]], depth: f64) -> Result<Way, String> {
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Err("surveyed_m: found no rows".into()) };
    if !rows.iter().flatten().all(|number| number.is_finite()) || first[0] < 0.0 {
        return Err("surveyed_m: found a depth below 0, or what is no number".into());
    }
    if let Some(pair) = rows.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        return Err(format!("surveyed_m: found a depth of {} after {}, must increase", pair[1][0], pair[0][0]));
    }
    if depth > last[0] {
        return Err(format!("surveyed_m: ends at a depth of {}, must reach {depth}", last[0]));
    }
    let mut points: Vec<(f64, DVec2)> = rows.iter().map(|[depth, x, y]| (*depth, DVec2::new(*x, *y))).collect();
    // It was set up in its place.
    if first[0] > 0.0 {
        points.insert(0, (0.0, DVec2::ZERO));
    }
    Ok(Way(points))
}

/// Slopes (m/m) of all boreholes of all rings, each to end anywhere in a circle, as likely in all of it. One that would meet
/// another down to a depth is drawn anew.
pub(super) fn draw(rings: &[PipeRing], percent: f64, random: &mut StdRng, depth: f64) -> Result<Moved, String> {
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
        let found = (0..MOST_DRAWS).map(|_| one()).find(free).ok_or_else(|| {
            format!(
                "percent: found {percent}, so far do boreholes deviate that pipe {own} meets others in {MOST_DRAWS} draws"
            )
        })?;
        slopes.push((own, found));
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

    #[test]
    fn ways_are_read_between_what_was_surveyed() {
        let way = surveyed(&[[0.0, 0.0, 0.0], [100.0, 0.1, 0.05], [200.0, 0.2, 0.3]], 150.0).expect("a way");
        assert!(way.at(150.0).distance(DVec2::new(0.15, 0.175)) < 1e-15);
        assert_eq!(way.at(100.0), DVec2::new(0.1, 0.05));
        // From its place at the collar, where the survey begins deeper.
        let way = surveyed(&[[100.0, 0.1, 0.0]], 50.0).expect("a way");
        assert!(way.at(50.0).distance(DVec2::new(0.05, 0.0)) < 1e-15);
    }

    /// Both ways are lines between their points, so a fine search finds nothing closer.
    #[test]
    fn the_closest_depth_is_that_of_a_search() {
        let one = surveyed(&[[0.0, 0.0, 0.0], [60.0, 0.7, 0.2], [130.0, -0.1, 0.4], [200.0, 0.2, 0.3]], 200.0);
        let other = surveyed(&[[20.0, -0.1, 0.0], [90.0, -0.9, 0.1], [210.0, 0.3, -0.4]], 200.0);
        let (one, other) = (one.expect("a way"), other.expect("a way"));
        let (own, place) = (DVec2::new(5.0, 0.0), DVec2::new(6.1, 0.3));
        let apart = |depth: f64| (place + other.at(depth) - own - one.at(depth)).length();
        let searched = (0..=20_000).map(|k| apart(0.01 * f64::from(k))).fold(f64::INFINITY, f64::min);
        let (at, distance) = one.closest(own, &other, place, 200.0);
        assert!((distance - searched).abs() < 1e-4 && distance <= searched + 1e-12, "{distance} {searched}");
        assert!((apart(at) - distance).abs() < 1e-12);
    }
}
