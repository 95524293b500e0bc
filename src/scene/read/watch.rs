//! Time, and what is observed.

use super::problem::Read;
use super::range::{Range, plain, temperatures};
use super::regions::{self, extent};
use super::section::{Duration, Section};
use super::shells;
use crate::region::Cell;
use crate::scene::Watch;
use frazil_core::space::domain::{Domain, Surface};
use glam::DVec2;

/// End of the run and the instants of the observations.
pub(super) struct Time {
    pub(super) duration: Duration,
    outputs: usize,
    profiles: Vec<f64>,
    /// What of the file is left out, in words.
    pub(super) remarks: Vec<String>,
}

/// Instants of profiles, and places, cuts and temperatures that are watched, of each.
pub(super) const MOST_PLACES: usize = 1000;

pub(super) fn few(count: usize) -> String {
    format!("found {count}, must be at most {MOST_PLACES}")
}

pub(super) fn time(root: &mut Section<'_>) -> Read<Time> {
    let mut section = root.section("time")?;
    let duration = section.duration("duration", Range::POSITIVE);
    let outputs = section.integer_or("outputs", 60, 1..=100_000);
    let profiles = section.optional_times("profiles");
    if let Some(count) = profiles.as_ref().map(Vec::len).filter(|count| *count > MOST_PLACES) {
        section.time_problem("profiles", few(count));
    }
    let duration = duration?;
    let (mut instants, mut remarks) = (vec![duration.seconds], Vec::new());
    if let Some(profiles) = profiles {
        if profiles.iter().any(|profile| profile.seconds == 0.0) {
            section.time_problem("profiles", "found 0, must be greater than 0");
        }
        let (kept, late): (Vec<&Duration>, Vec<&Duration>) =
            profiles.iter().partition(|profile| profile.seconds <= duration.seconds);
        if let Some(first) = late.first() {
            let all: Vec<String> = late.iter().map(|late| plain(late.seconds / late.unit.seconds())).collect();
            let end = plain(duration.seconds / first.unit.seconds());
            let key = section.time_key("profiles");
            remarks.push(format!("time.{key}: {} skipped, after the end of the run at {end}", all.join(", ")));
        }
        // A run whose profiles all lie after its end keeps its end, as one that names none.
        if !kept.is_empty() {
            instants = kept.iter().map(|profile| profile.seconds).collect();
        }
    }
    Ok(Time { duration, outputs, profiles: instants, remarks })
}

pub(super) fn watch(root: &mut Section<'_>, domain: Option<&Domain>, time: Read<&mut Time>) -> Read<Watch> {
    const PROBES: (&str, &str) = ("probes", "m");
    const PROFILE_LENGTH: (&str, &str) = ("profile_length", "m");
    let (mut probes, mut profile_length, mut front_from) = (Vec::new(), None, None);
    let mut front_key = String::new();
    let mut cuts = Vec::new();
    let (mut surfaces, mut regions, mut isotherms) = (Vec::new(), Vec::new(), Vec::new());
    let mut frozen_wall = domain.is_some_and(|domain| matches!(domain, Domain::Ring { .. }));
    let (mut phases, mut corner_front) = (None, false);
    if let Some(mut section) = root.optional_section("watch") {
        let dimension = domain.map(Domain::dimension);
        let points = section.optional_points(PROBES, dimension).unwrap_or_default();
        if points.len() > MOST_PLACES {
            section.problem(PROBES, few(points.len()));
        }
        for point in points {
            let coordinate = |axis: usize| point.get(axis).copied().unwrap_or(0.0);
            let (x, y) = (coordinate(0), coordinate(1));
            if domain.is_some_and(|domain| !inside(domain, x, y)) {
                let coordinates: Vec<String> = point.iter().map(|coordinate| plain(*coordinate)).collect();
                section.problem(PROBES, format!("found [{}], must lie inside the domain", coordinates.join(", ")));
            }
            probes.push((x, y));
        }
        cuts = self::cuts(&mut section, domain);
        surfaces = shells::surfaces(&mut section, domain);
        regions = regions::watched(&mut section, domain);
        let allowed = temperatures(section.units().absolute_zero());
        isotherms = section.optional_numbers(("isotherms", "c"), allowed).unwrap_or_default();
        if isotherms.len() > MOST_PLACES {
            section.problem(("isotherms", "c"), few(isotherms.len()));
        }
        phases = self::phases(&mut section, domain);
        corner_front = section.flag_or("corner_front", false);
        if corner_front && domain.is_some_and(|domain| !matches!(domain, Domain::Rectangle { .. })) {
            section.problem("corner_front", "only the domain \"rectangle\" has corners");
        }
        frozen_wall = section.flag_or("frozen_wall", frozen_wall);
        if frozen_wall && domain.is_some_and(|domain| !matches!(domain, Domain::Ring { .. })) {
            section.problem("frozen_wall", "only the domain \"ring\" has a frozen wall");
        }
        profile_length = section.optional_number(PROFILE_LENGTH, Range::POSITIVE);
        if let (Some(length), Some(domain)) = (profile_length, domain) {
            let longest = domain.extent();
            if length > longest {
                let message =
                    format!("found {}, must be at most {}, the domain's extent", plain(length), plain(longest));
                section.problem(PROFILE_LENGTH, message);
            }
        }
        front_from = section.optional_duration("front_from", Range::NOT_NEGATIVE);
        front_key = section.time_key("front_from");
    }
    let time = time?;
    if let Some(from) = front_from.take_if(|from| from.seconds > time.duration.seconds) {
        let (found, end) = (from.seconds / from.unit.seconds(), time.duration.seconds / from.unit.seconds());
        let (found, end) = (plain(found), plain(end));
        time.remarks.push(format!("watch.{front_key}: {found} ignored, after the end of the run at {end}"));
    }
    let front_from = front_from.map(|from| from.seconds);
    let (outputs, profiles) = (time.outputs, time.profiles.clone());
    Ok(Watch {
        outputs,
        profiles,
        probes,
        surfaces,
        regions,
        cuts,
        isotherms,
        phases,
        corner_front,
        frozen_wall,
        profile_length,
        front_from,
        measured: Vec::new(),
    })
}

/// Lines along which profiles are kept: at places along the second direction of a body, then along its first.
fn cuts(section: &mut Section<'_>, domain: Option<&Domain>) -> Vec<Surface> {
    const KEYS: [(&str, bool); 4] = [("cuts_z", true), ("cuts_r", false), ("cuts_y", true), ("cuts_x", false)];
    let mut found = Vec::new();
    for (name, across_y) in KEYS {
        let key = (name, "m");
        let round = matches!(name, "cuts_z" | "cuts_r");
        let Some(domain) = domain else { continue };
        let own = match domain {
            Domain::Axial { .. } => round,
            Domain::Rectangle { .. } | Domain::Ring { .. } => !round,
            Domain::Line { .. } | Domain::Radial { .. } => false,
        };
        if !own {
            let domains = if round {
                "only the domain \"axial\" has"
            } else {
                "only the domains \"rectangle\" and \"ring\" have"
            };
            section.refuse(key, &format!("{domains} cuts of this name"));
            continue;
        }
        // Where cuts may lie.
        let Cell { low, high } = extent(domain);
        let between = if across_y { (low.y, high.y) } else { (low.x, high.x) };
        let places = section.optional_numbers(key, Range::ANY).unwrap_or_default();
        if places.len() > MOST_PLACES {
            section.problem(key, few(places.len()));
        }
        if let Some(outside) = places.iter().find(|at| !(between.0..=between.1).contains(*at)) {
            let (found, least, most) = (plain(*outside), plain(between.0), plain(between.1));
            section.problem(key, format!("found {found}, must lie between {least} and {most}"));
        }
        found.extend(places.into_iter().map(|at| Surface { across_y, at }));
    }
    found
}

/// The part of the body whose phases are kept: all of it, or what lies between two places along x.
fn phases(section: &mut Section<'_>, domain: Option<&Domain>) -> Option<(f64, f64)> {
    const BETWEEN: (&str, &str) = ("phases_between", "m");
    let wanted = section.flag_or("phases", false);
    let Some(between) = section.optional_numbers(BETWEEN, Range::ANY) else {
        return wanted.then_some((f64::NEG_INFINITY, f64::INFINITY));
    };
    if !wanted {
        section.problem(BETWEEN, "has no effect without phases = true");
    }
    let extent = match domain {
        Some(Domain::Rectangle { width, .. }) => *width,
        other => other.map_or(f64::INFINITY, Domain::extent),
    };
    match between[..] {
        [from, to] if from < to && from >= -extent && to <= extent => Some((from, to)),
        _ => {
            section.problem(BETWEEN, "must be two positions along x in the body, in increasing order");
            None
        }
    }
}

pub(super) fn inside(domain: &Domain, x: f64, y: f64) -> bool {
    let (Cell { low, high }, place) = (extent(domain), DVec2::new(x, y));
    let beyond = matches!(domain, Domain::Ring { outer_radius, .. } if x.hypot(y) > *outer_radius);
    !beyond && place.cmpge(low).all() && place.cmple(high).all()
}
