//! A driven liquid.

use super::problem::Read;
use super::range::{Range, plain, temperatures};
use super::section::{Duration, Section};
use crate::scene::Wall;
use crate::stream::Stream;
use frazil_core::boundary::condition::Condition;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;

/// Reads the section `stream`, if there is one.
pub(super) fn stream(
    root: &mut Section<'_>,
    domain: Option<&Domain>,
    walls: &[Wall],
    duration: Option<&Duration>,
) -> Read<Option<Stream>> {
    const PUMP: (&str, &str) = ("pump", "m");
    const RESET: (&str, &str) = ("reset", "m");
    const RESET_TEMPERATURE: (&str, &str) = ("reset_temperature", "c");
    const SECTIONS: (&str, &str) = ("sections", "m");
    let Some(mut section) = root.optional_section("stream") else { return Ok(None) };
    let length = match domain {
        Some(Domain::Rectangle { width, .. }) => *width,
        Some(_) => {
            section.abandon();
            return Err(section.section_problem("a stream needs the domain \"rectangle\""));
        }
        None => f64::INFINITY,
    };
    for name in WallId::ends(false) {
        let closed = |wall: &Wall| matches!(wall.condition, Condition::Symmetry | Condition::Periodic);
        if walls.iter().any(|wall| wall.wall == name && !closed(wall)) {
            section.section_problem(format!(
                "the wall \"{name}\" must have condition = \"symmetry\": the stream is periodic along x"
            ));
        }
    }
    let acceleration = section.number(("acceleration", "m_per_s2"), Range::ANY);
    let start_speed = section.number_or(("start_speed", "m_per_s"), 0.0, Range::ANY);
    let stretch = |section: &mut Section<'_>, key: (&'static str, &'static str)| {
        let ends = section.optional_numbers(key, Range::ANY)?;
        match ends[..] {
            [from, to] if from < to && from >= 0.0 && to <= length => Some((from, to)),
            _ => {
                let message = format!("must be two positions from 0 to {}, in increasing order", plain(length));
                section.problem(key, message);
                None
            }
        }
    };
    let pump = stretch(&mut section, PUMP);
    let place = stretch(&mut section, RESET);
    let allowed = temperatures(section.units().absolute_zero());
    let reset = match place {
        Some(place) => Some((place, section.number(RESET_TEMPERATURE, allowed))),
        None => {
            section.refuse(RESET_TEMPERATURE, "nothing is reset without \"reset\"");
            None
        }
    };
    let reset = reset.map(|(place, temperature)| temperature.map(|temperature| (place, temperature)));
    let sections = section.optional_numbers(SECTIONS, Range::ANY).unwrap_or_default();
    if let Some(outside) = sections.iter().find(|at| !(0.0..=length).contains(*at)) {
        section.problem(SECTIONS, format!("found {}, must lie between 0 and {}", plain(*outside), plain(length)));
    }
    let from = section.optional_duration("average_from", Range::NOT_NEGATIVE);
    if let (Some(from), Some(duration)) = (&from, duration)
        && from.seconds >= duration.seconds
    {
        section.time_problem("average_from", "must be less than the duration");
    }
    let to = section.optional_duration("average_to", Range::POSITIVE);
    let average = (from.map_or(0.0, |from| from.seconds), to.map_or(f64::INFINITY, |to| to.seconds));
    if average.1 <= average.0 {
        section.time_problem("average_to", "must be greater than the start of the averages");
    }
    let (acceleration, reset) = (acceleration?, reset.transpose()?);
    Ok(Some(Stream { acceleration, start_speed, pump, reset, sections, average }))
}
