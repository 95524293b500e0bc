//! The list of methods, one line each.

use frazil_scene::method::MethodKind;

/// All methods, in the order in which they are shown.
pub fn methods() -> &'static [&'static MethodKind] {
    static METHODS: [&MethodKind; 4] =
        [&frazil_local::METHOD, &frazil_pd::METHOD, &frazil_sph::METHOD, &frazil_edpd::METHOD];
    &METHODS
}
