//! Methods on a list of neighbours.

use std::sync::Arc;

use frazil_core::balances::groundwater::{FlowMethod, FlowParts};
use frazil_core::kernels::enthalpy_rows::{EnthalpyList, Tangent};
use frazil_core::kernels::list_parts::ListParts;
use frazil_core::kernels::rows::ListOperator;
use frazil_core::kernels::term::Off;
use frazil_core::physics::latent_heat::{LatentHeatScheme, Mushy, scheme};
use frazil_core::solvers::assembly::Assembly;
use frazil_core::solvers::method::Method;
use frazil_scene::Scene;
use frazil_scene::method::{MethodSettings, OwnStep};
use frazil_scene::settings::StepChoice;
use rayon::ThreadPool;

use crate::plan::bonds::list;
use crate::plan::prepared::Prepared;
use crate::plan::steps;
use crate::refused::{Refused, refuse};

/// A method on a list, in the making.
pub(super) struct Listed<'a> {
    pub(super) scene: &'a Scene,
    pub(super) settings: &'a MethodSettings,
    /// A method's own step.
    pub(super) own_step: Option<&'a OwnStep>,
    /// Whether heat is conducted over the lattice, beside what flows along the pairs.
    pub(super) conducts_on_lattice: bool,
    pub(super) seed: u64,
}

impl Listed<'_> {
    /// The method of these particles.
    pub(super) fn method(
        &self,
        prepared: &mut Prepared,
        pool: Option<Arc<ThreadPool>>,
    ) -> Result<Box<dyn Method>, Refused> {
        let (scene, numerics) = (self.scene, &self.settings.numerics);
        let (range, count) = (prepared.range(scene), prepared.count());
        let on_lattice = self.conducts_on_lattice && self.own_step.is_none() && scene.flow.is_some();
        let lattice = on_lattice.then(|| prepared.lattice_parts(scene, self.settings, pool.clone())).transpose()?;
        let (parts, ways_out) = list(scene, self.settings, prepared, pool)?;
        let latent_heat_scheme = (numerics.latent_heat_scheme, numerics.mushy);
        match (self.own_step, scene.flow.as_ref().zip(numerics.flow)) {
            (None, Some((flow, own))) => {
                let fraction = match numerics.step {
                    StepChoice::Fraction(fraction) => fraction,
                    StepChoice::Fixed(_) => 1.0,
                };
                let parts = FlowParts {
                    list: parts,
                    ways_out: &ways_out,
                    lattice: lattice.map(steps::on_lattice),
                    ground: &scene.materials,
                    domain: scene.domain,
                    flow,
                    numerics: own,
                    conduction: numerics.conduction,
                    fraction,
                };
                Ok(Box::new(FlowMethod::new(parts, &prepared.enthalpies()).map_err(refuse)?))
            }
            (Some(step), _) => Ok(step(self.assembly(prepared, parts))),
            (None, None) if latent_heat_scheme == (LatentHeatScheme::Enthalpy, Mushy::Fraction) => {
                let operator = EnthalpyList {
                    operator: ListOperator::new(parts, Off),
                    scheme: scheme(
                        LatentHeatScheme::Enthalpy,
                        Mushy::Fraction,
                        &prepared.materials,
                        &prepared.start,
                        count,
                    ),
                    rate: vec![0.0; count],
                    tangent: Tangent::default(),
                };
                Ok(steps::integrator(numerics, Box::new(operator), range, prepared.largest_slope(), count))
            }
            (None, None) => Ok(self.assembly(prepared, parts).into_method(Off)),
        }
    }

    fn assembly(&self, prepared: &Prepared, parts: ListParts) -> Assembly {
        Assembly {
            parts,
            start: prepared.start.clone(),
            latent_heat_scheme: self.settings.numerics.latent_heat_scheme,
            mushy: self.settings.numerics.mushy,
            absolute_zero: self.scene.units.absolute_zero(),
            seed: self.seed,
        }
    }
}
