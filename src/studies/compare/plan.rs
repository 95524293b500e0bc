//! Which runs a comparison of one scene consists of.

use frazil_scene::method::MethodKind;
use frazil_scene::{Scene, Units};

use super::request::CompareRequest;
use super::variant::Variant;
use crate::failure::Failure;
use crate::method;
use crate::parts::{Override, Parts};

/// One method under one setting at one resolution.
#[derive(Debug)]
pub struct Configuration {
    /// Method.
    pub method: &'static str,
    /// Whether it needs an ensemble.
    pub stochastic: bool,
    /// Setting.
    pub setting: Variant,
    /// Number of the resolution, from coarse to fine.
    pub level: usize,
    /// Particle spacing (m).
    pub spacing: f64,
    /// Units of the scene.
    pub units: Units,
    /// The scene with these settings, or why it cannot be had.
    pub scene: Result<Scene, Failure>,
}

/// What a comparison cannot be asked of a scene.
#[derive(Debug, thiserror::Error)]
enum NoComparison {
    #[error("the scene has settings for no method")]
    NoMethod,
    #[error("{flag} {asked}: no method of scene `{scene}` takes it: {cause}")]
    Setting { flag: &'static str, asked: String, scene: String, cause: Failure },
}

/// Spacings from coarse to fine around a scene's own, which is the second finest.
pub fn spacings(own: f64, levels: usize) -> Vec<f64> {
    if levels <= 1 {
        return vec![own];
    }
    (0..levels).map(|level| own * 2f64.powi(levels as i32 - 2 - level as i32)).collect()
}

/// Pairs of key and value that give a method a spacing and a setting.
pub fn overrides(units: Units, method: &str, spacing: f64, setting: &Variant) -> Vec<(String, String)> {
    vec![
        spacing_override(units, method, spacing),
        (format!("method.{method}.{}", setting.key().0), setting.key().1.clone()),
    ]
}

/// The key and value that give a method a spacing (m).
pub fn spacing_override(units: Units, method: &str, spacing: f64) -> Override {
    let key = if units == Units::Si { "spacing_m" } else { "spacing" };
    (format!("method.{method}.{key}"), format!("{spacing}"))
}

/// All configurations of a scene, from coarse to fine.
///
/// # Errors
/// Where a method is none, or the scene has settings for none.
pub fn configurations(
    request: &CompareRequest,
    parts: &Parts<'_>,
    name: &str,
    base: &Scene,
) -> Result<Vec<Configuration>, Failure> {
    let methods = methods(request, parts, base)?;
    let first = base.methods.first().ok_or(NoComparison::NoMethod).map_err(Failure::request)?.numerics.spacing;
    let mut all = Vec::new();
    for level in 0..request.levels.max(1) {
        for kind in &methods {
            let own = base.method(kind.name).map_or(first, |own| own.numerics.spacing);
            let spacing = spacings(own, request.levels)[level];
            for setting in &request.settings {
                let overrides = overrides(base.units, kind.name, spacing, setting);
                all.push(Configuration {
                    method: kind.name,
                    stochastic: kind.stochastic,
                    setting: setting.clone(),
                    level,
                    spacing,
                    units: base.units,
                    scene: request.scene(parts, name, &overrides),
                });
            }
        }
    }
    Ok(all)
}

/// Holds what is asked for against a scene.
///
/// # Errors
/// Where a method is none, or a setting one that no method takes.
pub fn check(request: &CompareRequest, parts: &Parts<'_>, name: &str, base: &Scene) -> Result<(), Failure> {
    let methods = methods(request, parts, base)?;
    if methods.is_empty() {
        return Err(Failure::of(name, NoComparison::NoMethod));
    }
    let own = |kind: &MethodKind| base.method(kind.name).or(base.methods.first()).map(|own| own.numerics.spacing);
    for setting in &request.settings {
        let spacings = methods.iter().filter_map(|kind| Some((kind.name, own(kind)?)));
        let taken = spacings.map(|(method, spacing)| {
            request.scene(parts, name, &overrides(base.units, method, spacing, setting)).map(drop)
        });
        // The first refusal, unless a method takes it.
        let refused = taken.reduce(|first, next| if next.is_ok() { next } else { first });
        if let Some(Err(cause)) = refused {
            // The reader says `--set`, by whose way the key came there.
            let (key, value) = setting.key();
            let (flag, asked) = match key.as_str() {
                "setting" => ("--settings", value.clone()),
                _ => ("--also", format!("{key}={value}")),
            };
            return Err(Failure::request(NoComparison::Setting { flag, asked, scene: base.name.clone(), cause }));
        }
    }
    Ok(())
}

fn methods(request: &CompareRequest, parts: &Parts<'_>, base: &Scene) -> Result<Vec<&'static MethodKind>, Failure> {
    method::check(&request.methods, parts.methods)?;
    let asked = |kind: &MethodKind| match request.methods.as_slice() {
        [] => base.method(kind.name).is_some(),
        names => names.iter().any(|name| name == kind.name),
    };
    Ok(parts.methods.iter().copied().filter(|kind| asked(kind)).collect())
}

#[cfg(test)]
mod tests {
    use frazil_scene::Setting;

    use super::*;

    #[test]
    fn the_scenes_own_spacing_is_the_second_finest() {
        assert_eq!(spacings(0.002, 4), [0.008, 0.004, 0.002, 0.001]);
        assert_eq!(spacings(0.002, 1), [0.002]);
        let pairs = overrides(Units::Si, "pd", 0.001, &Variant::standard(Setting::Best));
        assert_eq!(pairs[0], ("method.pd.spacing_m".into(), "0.001".into()));
        assert_eq!(
            overrides(Units::Dpd, "edpd", 2.0, &Variant::changed("mean", "harmonic"))[0].0,
            "method.edpd.spacing"
        );
    }
}
