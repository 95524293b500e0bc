//! How a scene asks for particles that move. All numbers are in DPD units: masses of 1, the mean distance of particles to
//! the power of the dimension one over their number density, temperatures over 300 K.

use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::physics::latent_heat::LatentHeatScheme;
use frazil_record::Value;
use frazil_scene::{Arrangement, Numerics, Range, Section, Units};

use crate::fluid::Exponent;

/// Exponents of the dissipative weight of water over temperature, at the default friction, number density and cut-off
/// (Ng et al. 2017, table 1, from 0 degC on; `frazil calibrate` solves for them).
const WATER: [(f64, f64); 9] = [
    (273.15 / 300.0, 0.6067),
    (278.15 / 300.0, 0.7337),
    (283.15 / 300.0, 0.8619),
    (288.15 / 300.0, 0.9834),
    (298.15 / 300.0, 1.2153),
    (313.15 / 300.0, 1.5395),
    (333.15 / 300.0, 1.9335),
    (353.15 / 300.0, 2.2906),
    (373.15 / 300.0, 2.6146),
];

const FRICTION: f64 = 8.0;
const DENSITY: f64 = 4.0;
const CUTOFF_RATIO: f64 = 3.92;

/// What a scene says of motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Particles by area, rho.
    pub number_density: f64,
    /// Friction, gamma.
    pub friction: f64,
    /// Exponent of the dissipative weight over temperature.
    pub exponent: Exponent,
    /// Largest conservative force, a, over the mean temperature of the scene.
    pub repulsion: f64,
    /// Thermal diffusivity of the liquid, which sets the unit of time; as the scene has it, where absent.
    pub diffusivity: Option<f64>,
    /// Width of the strip of plane that stands for a line.
    pub strip_width: f64,
}

impl Motion {
    /// The settings by their keys.
    pub fn knobs(&self) -> Vec<(&'static str, Value)> {
        let mut knobs = vec![
            ("motion", Value::Flag(true)),
            ("number_density", Value::Number(self.number_density)),
            ("friction", Value::Number(self.friction)),
            ("repulsion", Value::Number(self.repulsion)),
            ("strip_width", Value::Number(self.strip_width)),
        ];
        match &self.exponent {
            Exponent::Constant(value) => knobs.push(("exponent", Value::Number(*value))),
            Exponent::Table(rows) => {
                let words: Vec<String> = rows.iter().map(|row| format!("[{}, {}]", row.0, row.1)).collect();
                knobs.push(("exponent_table", Value::Text(words.join(", "))));
            }
        }
        knobs.extend(self.diffusivity.map(|value| ("thermal_diffusivity", Value::Number(value))));
        knobs
    }
}

/// Reads the keys of motion; none if particles rest.
pub fn read(section: &mut Section<'_>, numerics: &Numerics, cutoff_ratio: f64) -> Option<Motion> {
    let motion = section.flag_or("motion", false);
    let given: Vec<&str> = KEYS.into_iter().filter(|key| section.has(*key)).collect();
    let number_density = section.number_or("number_density", DENSITY, Range::between(1.0, 50.0));
    let friction = section.number_or("friction", FRICTION, Range::between(0.0, 1e3));
    let repulsion = section.number_or("repulsion", 75.0 / number_density, Range::between(0.0, 1e4));
    let diffusivity = section.optional_number("thermal_diffusivity", Range::between(1e-3, 1e3));
    let strip_width = section.number_or("strip_width", 12.0, Range::between(1.0, 1e4));
    let constant = section.optional_number("exponent", Range::between(0.0, 50.0));
    let table = section.optional_points("exponent_table", Some(2));
    if !motion {
        for key in given {
            section.problem(key, "has no effect, particles are at rest without motion = true");
        }
        return None;
    }
    if constant.is_some() && table.is_some() {
        section.problem("exponent_table", "found beside \"exponent\", must be only one of them");
    }
    let own = friction != FRICTION || number_density != DENSITY || (cutoff_ratio - CUTOFF_RATIO).abs() > 1e-9;
    if own && constant.is_none() && table.is_none() {
        let message = format!(
            "needs \"exponent\" or \"exponent_table\" beside it: that of water is known only for friction \
             {FRICTION}, number_density {DENSITY} and cutoff_ratio {CUTOFF_RATIO}, frazil calibrate solves for others"
        );
        section.problem("motion", message);
    }
    let exponent = match (constant, table) {
        (Some(value), _) => Exponent::Constant(value),
        (None, Some(rows)) => {
            let rows: Vec<(f64, f64)> = rows.iter().map(|row| (row[0], row[1])).collect();
            let grows = rows.windows(2).all(|pair| pair[1].0 > pair[0].0);
            if rows.is_empty() || !grows || rows.iter().any(|row| row.1 < 0.0) {
                let message =
                    "must be rows [temperature, exponent] with increasing temperatures and no exponent below 0";
                section.problem("exponent_table", message);
            }
            Exponent::Table(rows)
        }
        (None, None) => Exponent::Table(WATER.to_vec()),
    };
    if section.units() == Units::Dpd && diffusivity.is_some() {
        section.problem("thermal_diffusivity", "has no effect, a scene in DPD units has one of its own");
    }
    exclude(section, numerics);
    Some(Motion { number_density, friction, exponent, repulsion, diffusivity, strip_width })
}

const KEYS: [&str; 7] =
    ["number_density", "friction", "repulsion", "thermal_diffusivity", "strip_width", "exponent", "exponent_table"];

/// Settings of particles at rest that motion excludes.
fn exclude(section: &mut Section<'_>, numerics: &Numerics) {
    let excluded = [
        ("layout", numerics.arrangement != Arrangement::Lattice, "moving particles have no layout"),
        ("scheme", numerics.latent_heat_scheme != LatentHeatScheme::Enthalpy, "moving particles use the enthalpy"),
        (
            "wall_model",
            !matches!(numerics.walls, WallModel::Mirror | WallModel::MovingLeastSquares),
            "walls of moving particles are fitted by moving least squares",
        ),
    ];
    for (key, wrong, reason) in excluded {
        if wrong {
            section.problem(key, format!("excluded by motion = true: {reason}"));
        }
    }
}
