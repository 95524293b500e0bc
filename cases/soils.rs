//! Soils that reference tables are about.

use frazil_scene::{Scene, Units};

use crate::table::{compare, compare_material, note};

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
        note(&mut differences, &[(scene.units != Units::Si, "units are si there")]);
        let own = scene.materials.first().filter(|_| scene.is_uniform());
        compare_material(&mut differences, own, self.density, [self.frozen, self.unfrozen]);
        compare(&mut differences, "the freezing point", own.map(|own| own.freezing_point), self.freezing_point);
        compare(&mut differences, "the latent heat", own.map(|own| own.latent_heat), self.latent_heat);
        let is_smeared = own.is_some_and(|own| !own.is_sharp());
        note(&mut differences, &[(is_smeared, "the soil freezes at one temperature there")]);
        differences
    }
}
