//! Properties that vary at random in place.

use super::range::Range;
use super::section::Section;
use crate::random::RandomGround;
use frazil_core::space::domain::Domain;
use frazil_core::space::random_field::{Covariance, Variation};

/// Greatest standard deviation of a logarithm: of a hundred places the best then conducts a million times better than the worst, as
/// much as both phases of a material may differ.
const MOST_DEVIATION: f64 = 3.0;

/// Which properties of the ground vary at random.
pub(super) fn random(root: &mut Section<'_>, domain: Option<&Domain>) -> RandomGround {
    let flows = root.has("flow");
    let Some(mut section) = root.optional_section("random") else { return RandomGround::default() };
    section.at_least_one(&["conductivity".into(), "permeability".into()]);
    let conductivity = section.optional_section("conductivity").and_then(|mut table| variation(&mut table, domain));
    if !flows {
        section.refuse("permeability", "the scene has no section \"flow\"");
    }
    let permeability = section.optional_section("permeability").and_then(|mut table| variation(&mut table, domain));
    RandomGround { conductivity, permeability }
}

fn variation(section: &mut Section<'_>, domain: Option<&Domain>) -> Option<Variation> {
    let log_deviation = section.number("log_deviation", Range::above_to(0.0, MOST_DEVIATION));
    let lengths = section.along_axes(("correlation_length", "m"), domain.map_or(2, Domain::dimension));
    let covariance = section.choice_or("covariance", &Covariance::WORDS, Covariance::Exponential);
    let seed = section.integer_or("seed", 1, 0..=u32::MAX as usize) as u64;
    Some(Variation { log_deviation: log_deviation.ok()?, lengths: lengths.ok()?, covariance, seed })
}
