//! Many runs as one work: comparisons, maps of stability, ensembles; and what runs and studies write and say.
//!
//! Studies see records, scenes and runs. Which methods, scenes and references there are they are told by [`parts::Parts`].

pub mod answers;
pub mod campaign;
pub mod cheapest;
pub mod compare;
pub mod ensemble;
pub mod expect;
pub mod failure;
pub mod fields;
pub mod figure_options;
pub mod figures;
pub mod input;
pub mod machine;
pub mod method;
pub mod output;
pub mod parallel;
pub mod parts;
pub mod progress;
pub mod stability;
pub mod sweep;
pub mod words;

/// The methods and bundled scenes, as the application has them.
#[cfg(test)]
mod bundled {
    use frazil_scene::Scene;
    use frazil_scene::method::MethodKind;

    use crate::failure::Failure;

    pub fn methods() -> &'static [&'static MethodKind] {
        static METHODS: [&MethodKind; 4] =
            [&frazil_local::METHOD, &frazil_pd::METHOD, &frazil_sph::METHOD, &frazil_edpd::METHOD];
        &METHODS
    }

    pub fn scene(name: &str, overrides: &[(String, String)]) -> Result<Scene, Failure> {
        let bundled = frazil_cases::scenes::find(name).expect("bundled");
        Ok(Scene::read(bundled, name, name, overrides, methods())?)
    }
}
