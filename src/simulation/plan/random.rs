//! What particles make of ground that varies at random in place.

use frazil_record::plain;
use frazil_scene::Scene;

/// Spacings in a correlation length below which neighbours have little to do with each other.
const FEW: f64 = 2.0;

/// Which correlation lengths are too short for a spacing (m), in words.
pub(super) fn unresolved(scene: &Scene, spacing: f64) -> impl Iterator<Item = String> + '_ {
    let short = scene.random.variations().filter_map(move |(name, variation)| {
        let across = if scene.domain.dimension() == 1 { variation.lengths.x } else { variation.lengths.min_element() };
        (across < FEW * spacing).then_some((name, across))
    });
    short.map(move |(name, length)| {
        let number = length / spacing;
        let length = plain(length, 4);
        format!("the correlation length of the {name}, {length} m, is {number:.1} spacings, which do not resolve it")
    })
}
