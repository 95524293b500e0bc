//! The parameters along which a map is drawn, as overrides of a scene.

use frazil_core::physics::material::Material;
use frazil_core::physics::retention::Retention;
use frazil_core::physics::retention::moisture::Soil;
use frazil_core::space::domain::Domain;
use frazil_record::Value;
use frazil_scene::method::MethodSettings;
use frazil_scene::method::{MethodKind, Stepper};
use frazil_scene::{Arrangement, Scene, Units};

use crate::parts::Override;

/// A parameter of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axis {
    /// The scene as it is: a map of one column.
    Own,
    /// Stefan number: sensible over latent heat.
    Stefan,
    /// Frozen over unfrozen conductivity.
    Conductivity,
    /// Frozen over unfrozen heat capacity.
    Capacity,
    /// Reach of the pair weight over the spacing.
    Reach,
    /// Largest shift of particles off the lattice over the spacing.
    Disorder,
    /// Relative fluctuation of a particle's temperature.
    Noise,
    /// Stages of RKL2.
    Stages,
    /// Particle spacing, of unsaturated water.
    Spacing,
    /// Effective saturation at its start.
    Saturation,
    /// Inverse of the suction of air entry.
    Alpha,
    /// Exponent of the retention curve.
    Exponent,
    /// Conductivity of the other soils over that of the first.
    Contrast,
}

/// One column of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Where it stands on the axis; absent for the scene as it is.
    pub value: Option<f64>,
    /// What makes it out of the scene.
    pub overrides: Vec<Override>,
}

/// Span of a physical parameter around the scene's own value: a quarter to four times.
const PHYSICS: f64 = 4.0;
/// Span of the parameters of retention curves: a tenth to ten times.
const SOILS: f64 = 10.0;
/// Greatest effective saturation at the start beside ground that is dry; the others are tenths of it.
const WETTEST: f64 = 0.1;
const DECADE: f64 = 10.0;
/// Decades by which other soils conduct less than the first at most.
const LEAST_CONTRAST: i32 = -6;
/// Span of the reach: half to twice.
const REACH: f64 = 2.0;
/// Span of the noise: a tenth to ten times.
const NOISE: f64 = 10.0;
/// Largest jitter that the reader takes.
const DISORDER: f64 = 0.5;
/// Particle spacings begin at the scene's own times two to this power, and are halved from there.
const COARSEST: i32 = 3;
/// Largest exponent of a retention curve that the reader takes.
const MOST_EXPONENT: f64 = 20.0;
/// Stages of RKL2 that are tried.
const STAGES: std::ops::RangeInclusive<usize> = 3..=40;

/// Steps of a bound in place of those by an error that nobody has asked for: they are what is mapped.
fn bounded(scene: &Scene, settings: &MethodSettings) -> Option<Override> {
    let numerics = &settings.numerics;
    let by_error = numerics.usual_integrator && numerics.integrator.tolerance().is_some() && !scene.of_water;
    let integrator = if scene.flow.is_some() { "heun" } else { "euler" };
    by_error.then(|| (format!("method.{}.integrator", settings.method), integrator.to_owned()))
}

impl Axis {
    /// All, by the words of `--axes`.
    pub const WORDS: [(&'static str, Axis); 13] = [
        ("stefan", Axis::Stefan),
        ("conductivity", Axis::Conductivity),
        ("capacity", Axis::Capacity),
        ("reach", Axis::Reach),
        ("disorder", Axis::Disorder),
        ("noise", Axis::Noise),
        ("rkl2", Axis::Stages),
        ("spacing", Axis::Spacing),
        ("saturation", Axis::Saturation),
        ("alpha", Axis::Alpha),
        ("n", Axis::Exponent),
        ("contrast", Axis::Contrast),
        ("own", Axis::Own),
    ];

    /// The word of files and of `--axes`.
    pub fn word(self) -> &'static str {
        Axis::WORDS.iter().find(|(_, axis)| *axis == self).map_or("", |(word, _)| word)
    }

    /// The axis of a word.
    pub fn of_word(word: &str) -> Option<Axis> {
        Axis::WORDS.iter().find(|(own, _)| *own == word).map(|(_, axis)| *axis)
    }

    /// Name for figures.
    pub fn label(self) -> &'static str {
        match self {
            Axis::Own => "the scene as it is",
            Axis::Stefan => "Stefan number, sensible over latent heat",
            Axis::Conductivity => "conductivity, frozen over unfrozen",
            Axis::Capacity => "heat capacity, frozen over unfrozen",
            Axis::Reach => "reach of the weight over spacing",
            Axis::Disorder => "largest shift of particles over spacing",
            Axis::Noise => "fluctuation of a particle's absolute temperature",
            Axis::Stages => "stages of RKL2",
            Axis::Spacing => "particle spacing (m)",
            Axis::Saturation => "effective saturation at the start",
            Axis::Alpha => "alpha of the retention curve (1/m)",
            Axis::Exponent => "n of the retention curve",
            Axis::Contrast => "conductivity of other soils over that of the first",
        }
    }

    /// The columns of a map for one method on a scene; none where the axis means nothing there. `count` is odd: the
    /// middle column is the scene's own value, but for disorder and noise, which begin at zero.
    pub fn columns(self, scene: &Scene, kind: &MethodKind, settings: &MethodSettings, count: usize) -> Vec<Column> {
        // Particles that move make steps of their own, which no setting takes over their bound.
        if let Stepper::Moving(_) = settings.discretisation.stepper {
            return Vec::new();
        }
        // Porous ground has no keys of its own for its two states: they follow from its phases.
        let has_keys = |material: &&Material| material.freezes() && material.pores.is_none();
        let freezes: Vec<&Material> = scene.materials.iter().filter(has_keys).collect();
        let quiet = self.without_noise(settings);
        let scaled = |span: f64, column: &dyn Fn(f64) -> Option<Column>| -> Vec<Column> {
            factors(span, count).into_iter().filter_map(column).collect()
        };
        // A key of what freezes, by the axis' value of the first of it and what each has at a factor.
        let physical =
            |name: &str, unit: &str, value: &dyn Fn(&Material) -> Option<f64>, at: &dyn Fn(&Material, f64) -> f64| {
                let key = key(scene.units, name, unit);
                scaled(PHYSICS, &|factor| {
                    let value = Some(value(freezes.first()?)? * factor);
                    Some(Column { value, overrides: changed(&freezes, factor, &key, at) })
                })
            };
        let mut columns = match self {
            Axis::Own => vec![Column { value: None, overrides: Vec::new() }],
            Axis::Stefan => {
                physical("freezing.latent_heat", "J_per_kg", &|first| stefan_number(scene, first), &|own, factor| {
                    own.latent_heat / factor
                })
            }
            Axis::Conductivity => physical(
                "frozen.conductivity",
                "W_per_m_K",
                &|first| Some(first.frozen.conductivity / first.unfrozen.conductivity),
                &|own, factor| own.frozen.conductivity * factor,
            ),
            Axis::Capacity => physical(
                "frozen.heat_capacity",
                "J_per_kg_K",
                &|first| Some(first.frozen.heat_capacity / first.unfrozen.heat_capacity),
                &|own, factor| own.frozen.heat_capacity * factor,
            ),
            Axis::Reach => scaled(REACH, &|factor| {
                let (knob, own) = reach(settings)?;
                let value = if factor == 1.0 { own } else { rounded(own * factor) };
                let overrides = if factor == 1.0 { Vec::new() } else { vec![method_key(settings, knob, value)] };
                Some(Column { value: Some(value), overrides })
            }),
            // Shells and rows around pipes stand evenly.
            Axis::Disorder if kind.lattice_only || !scene.rings.is_empty() || scene.domain.symmetry().is_some() => {
                Vec::new()
            }
            Axis::Disorder => (0..count)
                .map(|k| rounded(DISORDER * k as f64 / (count - 1).max(1) as f64))
                .filter_map(|shift| disordered(settings, shift))
                .collect(),
            Axis::Noise => noise_levels(settings, count),
            Axis::Stages if kind.stochastic || scene.flow.is_some() || scene.of_water => Vec::new(),
            Axis::Spacing | Axis::Saturation | Axis::Alpha | Axis::Exponent | Axis::Contrast => {
                self.of_water(scene, settings, count)
            }
            Axis::Stages => STAGES
                .map(|stages| Column {
                    value: Some(stages as f64),
                    overrides: vec![
                        (format!("method.{}.integrator", settings.method), "rkl2".into()),
                        method_key(settings, "stages", stages as f64),
                    ],
                })
                .collect(),
        };
        let bounded = bounded(scene, settings).filter(|_| self != Axis::Stages);
        for column in &mut columns {
            column.overrides.extend(quiet.clone());
            column.overrides.extend(bounded.clone());
        }
        columns
    }

    /// Columns of a scene of unsaturated water; none of another.
    fn of_water(self, scene: &Scene, settings: &MethodSettings, count: usize) -> Vec<Column> {
        if !scene.of_water {
            return Vec::new();
        }
        let scaled = |span: f64, own: Option<f64>, at: &dyn Fn(f64) -> (f64, Vec<Override>)| -> Vec<Column> {
            let column = |factor: f64| {
                let (value, overrides) = at(factor);
                match factor {
                    1.0 => Column { value: own, overrides: Vec::new() },
                    _ => Column { value: Some(value), overrides },
                }
            };
            own.map_or_else(Vec::new, |_| factors(span, count).into_iter().map(column).collect())
        };
        // What the curves of soils have of a parameter, by their names.
        let curves = |of: fn(&Retention) -> Option<f64>| -> Vec<(&str, f64)> {
            let own = |material: &Material| of(&material.soil.as_ref()?.retention);
            scene.materials.iter().filter_map(|material| Some((material.name.as_str(), own(material)?))).collect()
        };
        let changed = |curves: &[(&str, f64)], key: &str, at: &dyn Fn(f64) -> f64| -> (f64, Vec<Override>) {
            let change = |(name, own): &(&str, f64)| (format!("materials.{name}.retention.{key}"), written(at(*own)));
            (curves.first().map_or(0.0, |(_, own)| at(*own)), curves.iter().map(change).collect())
        };
        let carried =
            scene.solute.as_ref().map_or_else(String::new, |solute| format!(", concentration = {}", solute.initial));
        match self {
            Axis::Spacing => {
                let own = settings.numerics.spacing;
                let key = key(scene.units, "spacing", "m");
                (0..count as i32)
                    .map(|halvings| own * 2f64.powi(COARSEST - halvings))
                    .filter(|spacing| divides(scene.domain, *spacing))
                    .map(|spacing| Column {
                        value: Some(spacing),
                        overrides: vec![method_key(settings, &key, spacing)],
                    })
                    .collect()
            }
            Axis::Saturation => (0..count)
                .map(|k| if k == 0 { 0.0 } else { rounded(WETTEST * DECADE.powi(k as i32 + 1 - count as i32)) })
                .map(|start| Column {
                    value: Some(start),
                    // In place of a head, if the scene starts from one.
                    overrides: vec![("initial".into(), format!("{{ saturation = {start}{carried} }}"))],
                })
                .collect(),
            Axis::Alpha => {
                let own = curves(|curve| match curve {
                    Retention::VanGenuchten(curve) => Some(curve.alpha),
                    Retention::Gardner(curve) => Some(curve.alpha),
                    Retention::BrooksCorey(_) | Retention::Table(_) => None,
                });
                let key = key(scene.units, "alpha", "per_m");
                scaled(SOILS, own.first().map(|own| own.1), &|factor| changed(&own, &key, &|own| own * factor))
            }
            Axis::Contrast => contrasts(scene, count),
            _ => {
                let own = curves(|curve| match curve {
                    Retention::VanGenuchten(curve) => Some(curve.exponent),
                    Retention::BrooksCorey(_) | Retention::Gardner(_) | Retention::Table(_) => None,
                });
                // The curve is that of n - 1: at 1 it would be flat.
                let at = |own: f64, factor: f64| (1.0 + (own - 1.0) * factor).min(MOST_EXPONENT);
                scaled(SOILS, own.first().map(|own| own.1), &|factor| changed(&own, "n", &|own| at(own, factor)))
            }
        }
    }

    /// Away from its own axis noise is switched off: it does not change the operator, whose stability the maps show.
    fn without_noise(self, settings: &MethodSettings) -> Option<Override> {
        let noisy = settings.discretisation.fluctuation > 0.0;
        (noisy && self != Axis::Noise && self != Axis::Own && has_knob(settings, "noise"))
            .then(|| (format!("method.{}.noise", settings.method), "false".into()))
    }
}

/// Columns in which all soils but the first conduct less than it; none where there is one soil.
fn contrasts(scene: &Scene, count: usize) -> Vec<Column> {
    let soils: Vec<_> = scene.materials.iter().filter_map(|own| Some((own, own.soil.as_ref()?))).collect();
    let Some(((_, first), others)) = soils.split_first().filter(|(_, others)| !others.is_empty()) else {
        return Vec::new();
    };
    let key = key(scene.units, "conductivity", "m_per_s");
    let column = |k: i32| {
        let contrast = DECADE.powi(LEAST_CONTRAST * k / (count as i32 - 1).max(1));
        let value = written(first.conductivity * contrast);
        let one = |(own, _): &(&Material, &Soil)| (format!("materials.{}.{key}", own.name), value.clone());
        Column { value: Some(contrast), overrides: others.iter().map(one).collect() }
    };
    (0..count as i32).map(column).collect()
}

/// Whether a spacing (m) divides a body into whole parts.
fn divides(domain: Domain, spacing: f64) -> bool {
    let whole = |length: f64| ((length / spacing).round() * spacing / length - 1.0).abs() < 1e-9;
    match domain {
        Domain::Line { length } => whole(length),
        Domain::Rectangle { width, height } => whole(width) && whole(height),
        Domain::Radial { inner, outer, .. } => whole(outer - inner),
        Domain::Axial { inner, outer, height } => whole(outer - inner) && whole(height),
        Domain::Ring { .. } => true,
    }
}

/// Factors from one over the span to the span, evenly in their logarithm; a single one is one.
fn factors(span: f64, count: usize) -> Vec<f64> {
    let half = (count / 2) as i32;
    let factor = |k: i32| if k == 0 { 1.0 } else { span.powf(f64::from(k) / f64::from(half)) };
    (-half..=half).map(factor).collect()
}

/// A number of two significant digits near another, as people write them.
fn rounded(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// Numbers of overrides are written with four digits, so that a command can be read.
fn written(value: f64) -> String {
    let short: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    format!("{short}")
}

fn key(units: Units, name: &str, unit: &str) -> String {
    if units == Units::Si { format!("{name}_{unit}") } else { name.into() }
}

fn method_key(settings: &MethodSettings, name: &str, value: f64) -> Override {
    (format!("method.{}.{name}", settings.method), format!("{value}"))
}

/// One override for each material; none for the scene's own value, whose cells are then those of the other axes.
fn changed(materials: &[&Material], factor: f64, key: &str, at: impl Fn(&Material, f64) -> f64) -> Vec<Override> {
    if factor == 1.0 {
        return Vec::new();
    }
    let one = |material: &&Material| (format!("materials.{}.{key}", material.name), written(at(material, factor)));
    materials.iter().map(one).collect()
}

/// Heat that the frozen phase gives up between the freezing point and the coldest datum, over the latent heat; where
/// nothing freezes, that of the unfrozen phase up to the warmest.
pub fn stefan_number(scene: &Scene, material: &Material) -> Option<f64> {
    let (low, high) = scene.temperature_range();
    let sensible = if low < material.freezing_point {
        material.frozen.heat_capacity * (material.freezing_point - low)
    } else {
        material.unfrozen.heat_capacity * (high - material.freezing_point)
    };
    (material.latent_heat > 0.0).then(|| sensible / material.latent_heat)
}

fn has_knob(settings: &MethodSettings, name: &str) -> bool {
    settings.discretisation.knobs.iter().any(|(knob, _)| *knob == name)
}

/// A method's reach over its spacing: by convention the one setting of its own whose key ends in `_ratio`.
fn reach(settings: &MethodSettings) -> Option<(&'static str, f64)> {
    settings.discretisation.knobs.iter().find_map(|(knob, value)| match value {
        Value::Number(value) if knob.ends_with("_ratio") => Some((*knob, *value)),
        _ => None,
    })
}

fn disordered(settings: &MethodSettings, shift: f64) -> Option<Column> {
    let own = match settings.numerics.arrangement {
        Arrangement::Lattice => 0.0,
        Arrangement::Jittered { fraction } => fraction,
        // Random places have no shift to scale.
        Arrangement::Random => return None,
    };
    let set = |name: &str, value: String| (format!("method.{}.{name}", settings.method), value);
    let overrides = match shift {
        shift if shift == own => Vec::new(),
        0.0 => vec![set("layout", "lattice".into())],
        shift => vec![set("layout", "jittered".into()), set("jitter_fraction", format!("{shift}"))],
    };
    Some(Column { value: Some(shift), overrides })
}

/// No noise, then levels around the scene's own.
fn noise_levels(settings: &MethodSettings, count: usize) -> Vec<Column> {
    const CAPACITY: &str = "heat_capacity_dpd";
    let own = settings.discretisation.fluctuation;
    if own == 0.0 || !has_knob(settings, CAPACITY) || !has_knob(settings, "noise") {
        return Vec::new();
    }
    let none =
        Column { value: Some(0.0), overrides: vec![(format!("method.{}.noise", settings.method), "false".into())] };
    let level = |factor: f64| {
        let level = own * factor;
        let capacity = method_key(settings, CAPACITY, 0.0).0;
        let overrides = if factor == 1.0 { Vec::new() } else { vec![(capacity, written(1.0 / (level * level)))] };
        Column { value: Some(level), overrides }
    };
    std::iter::once(none).chain(factors(NOISE, count).into_iter().map(level)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bundled;

    fn columns(scene: &str, method: &str, axis: Axis) -> Vec<Column> {
        let scene = bundled::scene(scene, &[]).unwrap_or_else(|failure| unreachable!("{failure}"));
        let kind = bundled::methods().iter().find(|kind| kind.name == method).expect("known");
        // Scenes leave out methods that cannot represent them.
        scene.method(method).map_or_else(Vec::new, |settings| axis.columns(&scene, kind, settings, 5))
    }

    #[test]
    fn every_column_is_a_scene_that_has_the_value() {
        for bundled in frazil_cases::scenes::all() {
            for kind in bundled::methods() {
                for (_, axis) in Axis::WORDS {
                    for column in columns(bundled.name, kind.name, axis) {
                        let scene = bundled::scene(bundled.name, &column.overrides);
                        let scene = scene.unwrap_or_else(|failure| unreachable!("{failure}"));
                        let settings = scene.method(kind.name).expect("settings");
                        let material = &scene.materials[0];
                        let (frozen, unfrozen) = (material.frozen, material.unfrozen);
                        let found = match axis {
                            Axis::Own => None,
                            Axis::Stefan => stefan_number(&scene, material),
                            Axis::Conductivity => Some(frozen.conductivity / unfrozen.conductivity),
                            Axis::Capacity => Some(frozen.heat_capacity / unfrozen.heat_capacity),
                            Axis::Reach => reach(settings).map(|reach| reach.1),
                            Axis::Disorder => match settings.numerics.arrangement {
                                Arrangement::Jittered { fraction } => Some(fraction),
                                _ => Some(0.0),
                            },
                            Axis::Noise => Some(settings.discretisation.fluctuation),
                            Axis::Stages => column.value,
                            Axis::Contrast => {
                                let of = |own: &Material| own.soil.as_ref().map(|soil| soil.conductivity);
                                let all: Vec<f64> = scene.materials.iter().filter_map(of).collect();
                                all.windows(2).for_each(|pair| assert!(pair[1] == all[1] && pair[1] <= pair[0]));
                                Some(all[1] / all[0])
                            }
                            Axis::Spacing | Axis::Saturation | Axis::Alpha | Axis::Exponent => {
                                assert!(scene.of_water);
                                column.value
                            }
                        };
                        let near = match (found, column.value) {
                            // Four digits are written.
                            (Some(found), Some(value)) => (found - value).abs() <= 1e-3 * value,
                            (found, value) => found == value,
                        };
                        assert!(near, "{} {} {axis:?}: {found:?} {column:?}", bundled.name, kind.name);
                    }
                }
            }
        }
    }

    #[test]
    fn the_scenes_own_value_stands_in_the_middle_and_changes_nothing_but_steps_by_error() {
        let bounded = [("method.pd.integrator".to_owned(), "euler".to_owned())];
        for axis in [Axis::Stefan, Axis::Conductivity, Axis::Capacity, Axis::Reach] {
            let all = columns("stefan-water", "pd", axis);
            assert_eq!((all.len(), &all[2].overrides[..]), (5, &bounded[..]), "{axis:?}");
            assert!(all.windows(2).all(|pair| pair[0].value < pair[1].value), "{axis:?}");
        }
        assert_eq!(columns("stefan-water", "edpd", Axis::Stefan)[2].overrides[0].1, "false");
        assert_eq!(columns("stefan-water", "edpd", Axis::Noise)[3].overrides, []);
    }

    #[test]
    fn labels_fit_below_a_panel() {
        for (_, axis) in Axis::WORDS {
            let width = frazil_plots::canvas::text_width(axis.label(), frazil_plots::style::LABEL, false);
            assert!(width < 460.0, "{axis:?}: {width} px");
        }
    }

    #[test]
    fn an_axis_that_means_nothing_has_no_column() {
        assert_eq!(columns("stefan-water", "local", Axis::Reach), []);
        assert_eq!(columns("stefan-water", "local", Axis::Disorder), []);
        assert_eq!(columns("frozen-wall-sand", "pd", Axis::Disorder), [], "pipes need a lattice");
        assert_eq!(columns("stefan-water", "pd", Axis::Noise), []);
        assert_eq!(columns("stefan-water", "edpd", Axis::Stages), []);
        assert_eq!(columns("stefan-water", "sph", Axis::Stages).len(), 38);
    }
}
