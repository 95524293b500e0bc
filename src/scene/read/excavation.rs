//! The shaft that is dug inside a ring of pipes.

use super::body;
use super::problem::Read;
use super::range::{Range, plain};
use super::section::Section;
use crate::pipe_name::PipeName;
use crate::pipe_ring::PipeRing;
use crate::scene::Excavation;
use frazil_core::boundary::condition::Condition;
use frazil_core::space::domain::Domain;

const RADIUS: (&str, &str) = ("radius", "m");

pub(super) fn excavation(
    root: &mut Section<'_>,
    domain: Option<&Domain>,
    rings: &[PipeRing],
) -> Read<Option<Excavation>> {
    let Some(mut section) = root.optional_section("excavation") else { return Ok(None) };
    let radius = section.positive(RADIUS);
    let start = section.duration("start", Range::NOT_NEGATIVE);
    let condition = body::condition(&mut section);
    if domain.is_some_and(|domain| !matches!(domain, Domain::Ring { .. })) {
        return Err(section.section_problem("an excavation needs the domain \"ring\""));
    }
    let refused = match condition {
        Ok(Condition::Exact) => Some("found \"exact\", the face of a shaft has no exact solution"),
        Ok(Condition::Periodic) => Some("found \"periodic\", the face of a shaft has no opposite wall"),
        _ => None,
    };
    if let Some(refused) = refused {
        return Err(section.problem("condition", refused));
    }
    let radius = radius?;
    if let Some(Domain::Ring { outer_radius, .. }) = domain
        && radius >= *outer_radius
    {
        return Err(section.problem(
            RADIUS,
            format!("found {}, must be less than the outer radius {}", plain(radius), plain(*outer_radius)),
        ));
    }
    for (number, ring) in rings.iter().enumerate() {
        if let Some(k) = ring.numbers().find(|k| ring.place(*k).length() - ring.pipe_radius <= radius) {
            let message = format!(
                "found {}, pipe {} stands {:.4} from the centre, in the shaft or at its face",
                plain(radius),
                PipeName { ring: number, pipe: k },
                ring.place(k).length()
            );
            return Err(section.problem(RADIUS, message));
        }
    }
    Ok(Some(Excavation { radius, start: start?.seconds, condition: condition? }))
}
