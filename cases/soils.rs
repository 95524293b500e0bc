//! Soils by name, as materials of a scene, and those that reference tables are about.

use frazil_core::physics::material::Material;
use frazil_scene::{Scene, Units};

use crate::table::compare;

/// A TOML table for each.
pub const TEXT: &str = include_str!("soils.toml");

/// A material by the numbers that a table depends on.
pub(crate) struct Soil {
    pub density: f64,
    pub frozen: (f64, f64),
    pub unfrozen: (f64, f64),
    pub freezing_point: f64,
    pub latent_heat: f64,
}

/// Sand of Chen and Bai 2016.
pub(crate) const SAND: Soil = Soil {
    density: 2090.0,
    frozen: (2.56, 1088.4),
    unfrozen: (1.86, 1465.1),
    freezing_point: 0.0,
    latent_heat: 52_875.8,
};

/// Clay of Chen and Bai 2016 with the latent heat as printed.
pub(crate) const CLAY: Soil = Soil {
    density: 2050.0,
    frozen: (2.05, 1172.1),
    unfrozen: (1.51, 1548.8),
    freezing_point: 0.0,
    latent_heat: 530_718.0,
};

/// The same clay with a tenth of the latent heat.
pub(crate) const CLAY_TENTH: Soil = Soil { latent_heat: 53_071.8, ..CLAY };

impl Soil {
    /// What about a scene's ground is not as in this soil.
    pub fn differences(&self, scene: &Scene) -> Vec<String> {
        let mut differences = Vec::new();
        if scene.units != Units::Si {
            differences.push("units are si there".into());
        }
        let own: Option<&Material> = match scene.is_uniform() {
            true => scene.materials.first(),
            false => None,
        };
        let mut number = |what: &str, read: fn(&Material) -> f64, expected: f64| {
            compare(&mut differences, what, own.map(read), expected);
        };
        number("the density", |own| own.density, self.density);
        number("the frozen conductivity", |own| own.frozen.conductivity, self.frozen.0);
        number("the frozen heat capacity", |own| own.frozen.heat_capacity, self.frozen.1);
        number("the unfrozen conductivity", |own| own.unfrozen.conductivity, self.unfrozen.0);
        number("the unfrozen heat capacity", |own| own.unfrozen.heat_capacity, self.unfrozen.1);
        number("the freezing point", |own| own.freezing_point, self.freezing_point);
        number("the latent heat", |own| own.latent_heat, self.latent_heat);
        if own.is_some_and(|own| !own.is_sharp()) {
            differences.push("the soil freezes at one temperature there".into());
        }
        differences
    }
}
