//! Ground that conducts heat better along one axis than along the other.

use super::range::Range;
use super::section::Section;
use frazil_core::space::domain::Domain;
use glam::DVec2;

/// How much better, or worse, ground may conduct along y than along x.
const MOST: f64 = 100.0;

/// Conductivity along x and along y, over that of the materials.
pub(super) fn anisotropy(root: &mut Section<'_>, domain: Option<&Domain>) -> DVec2 {
    let Some(mut section) = root.optional_section("anisotropy") else { return DVec2::ONE };
    if matches!(domain, Some(Domain::Line { .. })) {
        section.section_problem("a line has one direction: it needs the domain \"rectangle\" or \"ring\"");
    }
    let ratio = section.number("conductivity_y_over_x", Range::between(1.0 / MOST, MOST));
    DVec2::new(1.0, ratio.unwrap_or(1.0))
}
