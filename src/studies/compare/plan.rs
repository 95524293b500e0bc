//! Which runs a comparison of one scene consists of.

use frazil_scene::method::MethodKind;
use frazil_scene::{Scene, Units};

use super::request::CompareRequest;
use super::variant::Variant;
use crate::parts::Parts;

/// One method under one setting at one resolution.
#[derive(Debug, Clone)]
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
    pub scene: Result<Scene, String>,
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
    let key = if units == Units::Si { "spacing_m" } else { "spacing" };
    vec![
        (format!("method.{method}.{key}"), format!("{spacing}")),
        (format!("method.{method}.{}", setting.key().0), setting.key().1.clone()),
    ]
}

/// All configurations of a scene, from coarse to fine.
pub fn configurations(
    request: &CompareRequest,
    parts: &Parts<'_>,
    name: &str,
    base: &Scene,
) -> Result<Vec<Configuration>, String> {
    let methods = methods(request, parts, base)?;
    let first = base.methods.first().map(|own| own.numerics.spacing).ok_or("the scene has settings for no method")?;
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

/// Whether the methods that are asked for are known, and each setting is one that at least one of them takes on a scene; if
/// not, why.
pub fn check(request: &CompareRequest, parts: &Parts<'_>, name: &str, base: &Scene) -> Result<(), String> {
    let methods = methods(request, parts, base)?;
    if methods.is_empty() {
        return Err(format!("{name}: the scene has settings for no method"));
    }
    let own = |kind: &MethodKind| base.method(kind.name).or(base.methods.first()).map(|own| own.numerics.spacing);
    for setting in &request.settings {
        let mut refusals = Vec::new();
        for kind in &methods {
            let Some(spacing) = own(kind) else { continue };
            match request.scene(parts, name, &overrides(base.units, kind.name, spacing, setting)) {
                Ok(_) => refusals.clear(),
                Err(reason) => refusals.push(reason),
            }
            if refusals.is_empty() {
                break;
            }
        }
        if let Some(first) = refusals.first() {
            // The reader says `--set`, by whose way the key came there.
            let (key, value) = setting.key();
            let flag = if key == "setting" { "--settings" } else { "--also" };
            let asked = if key == "setting" { value.clone() } else { format!("{key}={value}") };
            return Err(format!("{flag} {asked}: no method of scene `{}` takes it: {first}", base.name));
        }
    }
    Ok(())
}

fn methods(request: &CompareRequest, parts: &Parts<'_>, base: &Scene) -> Result<Vec<&'static MethodKind>, String> {
    if let Some(unknown) = request.methods.iter().find(|name| !parts.methods.iter().any(|kind| kind.name == **name)) {
        let known: Vec<&str> = parts.methods.iter().map(|kind| kind.name).collect();
        return Err(format!("--methods {unknown}: there are {}", known.join(", ")));
    }
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
