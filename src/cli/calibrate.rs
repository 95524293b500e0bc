//! `frazil calibrate`.

use std::path::PathBuf;

use clap::Args;
use frazil_edpd::calibration::Constants;
use frazil_studies::failure::{Failure, Verdict};

use super::values::{positive, sized};
use crate::calibrate::{CalibrateRequest, Conduction, calibrate};

#[derive(Debug, Args)]
pub struct CalibrateArguments {
    /// A bundled fluid (water), or a TOML or CSV file.
    #[arg(default_value = "water")]
    fluid: String,
    /// Dimensions of space, 2 or 3.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    dimension: u8,
    /// Number density of particles, in DPD units like all options without a unit.
    #[arg(long, value_name = "N", default_value = "4", value_parser = sized)]
    number_density: f64,
    /// Friction coefficient of a pair, gamma.
    #[arg(long, value_name = "X", default_value = "8", value_parser = sized)]
    gamma: f64,
    /// Cut-off radius of all forces and of heat exchange.
    #[arg(long, value_name = "R", default_value = "1.96", value_parser = sized)]
    cutoff: f64,
    /// Cut-off radius of the conservative force only.
    #[arg(long, value_name = "R", value_parser = sized)]
    conservative_cutoff: Option<f64>,
    /// Cut-off radius of the dissipative and random forces only.
    #[arg(long, value_name = "R", value_parser = sized)]
    dissipative_cutoff: Option<f64>,
    /// Cut-off radius of heat exchange only.
    #[arg(long, value_name = "R", value_parser = sized)]
    thermal_cutoff: Option<f64>,
    /// Heat capacity of a particle in k_B.
    #[arg(long, value_name = "X", default_value = "1e5", value_parser = sized)]
    heat_capacity: f64,
    /// Reference temperature, 1 in DPD units, in K.
    #[arg(long, value_name = "K", default_value = "300", value_parser = sized)]
    reference_temperature_k: f64,
    /// Constant Prandtl number instead of those of the fluid.
    #[arg(long, value_name = "X", value_parser = sized, conflicts_with = "diffusivity")]
    prandtl: Option<f64>,
    /// Constant thermal diffusivity instead of Prandtl numbers.
    #[arg(long, value_name = "X", value_parser = sized)]
    diffusivity: Option<f64>,
    /// Skips rows below this temperature, in K.
    #[arg(long, value_name = "K", value_parser = positive)]
    from_k: Option<f64>,
    /// Skips rows above this temperature, in K.
    #[arg(long, value_name = "K", value_parser = positive)]
    to_k: Option<f64>,
    /// Folder for the results; by default out/calibrate.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl CalibrateArguments {
    /// Finds the constants.
    pub fn answer(self) -> Result<Verdict, Failure> {
        calibrate(&CalibrateRequest {
            fluid: self.fluid,
            constants: Constants {
                dimension: self.dimension.into(),
                density: self.number_density,
                friction: self.gamma,
                conservative_cutoff: self.conservative_cutoff.unwrap_or(self.cutoff),
                dissipative_cutoff: self.dissipative_cutoff.unwrap_or(self.cutoff),
                thermal_cutoff: self.thermal_cutoff.unwrap_or(self.cutoff),
                heat_capacity: self.heat_capacity,
            },
            reference_temperature: self.reference_temperature_k,
            conduction: match (self.prandtl, self.diffusivity) {
                (Some(prandtl), _) => Conduction::Prandtl(prandtl),
                (None, Some(diffusivity)) => Conduction::Diffusivity(diffusivity),
                (None, None) => Conduction::Fluid,
            },
            from: self.from_k,
            to: self.to_k,
            out: self.out,
        })
    }
}
