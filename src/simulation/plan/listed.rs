//! Methods on a list of neighbours.

use frazil_core::balances::groundwater::FlowParts;
use frazil_core::balances::groundwater::advected::AdvectedHeat;
use frazil_core::kernels::enthalpy_rows::ListBalance;
use frazil_core::kernels::list_parts::ListParts;
use frazil_core::kernels::term::Off;
use frazil_core::physics::latent_heat::{LatentHeatScheme, scheme};
use frazil_core::solvers::assembly::Assembly;
use frazil_core::solvers::balance::Balance;
use frazil_core::solvers::solver::Solver;
use frazil_core::team::Team;
use frazil_scene::Scene;
use frazil_scene::method::{MethodSettings, OwnStep};

use crate::plan::bonds::list;
use crate::plan::heating;
use crate::plan::prepared::Prepared;
use crate::plan::steps;
use crate::refused::Refused;

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
    /// The solver of these particles.
    pub(super) fn solver(&self, prepared: &mut Prepared, team: Option<Team>) -> Result<Box<dyn Solver>, Refused> {
        let (scene, numerics) = (self.scene, &self.settings.numerics);
        let (range, count) = (prepared.range(scene), prepared.count());
        let flow = scene.flow.as_ref().zip(numerics.flow).filter(|_| self.own_step.is_none());
        let on_lattice = self.conducts_on_lattice && flow.is_some();
        let lattice = on_lattice.then(|| prepared.lattice_parts(scene, self.settings, team.clone())).transpose()?;
        let (list, ways_out) = list(scene, self.settings, prepared, team.clone())?;
        if let Some(step) = self.own_step {
            return Ok(step(self.assembly(prepared, list)));
        }
        let is_heat_alone = flow.is_none() && numerics.latent_heat_scheme == LatentHeatScheme::Enthalpy;
        let balance: Box<dyn Balance> = match flow {
            Some((flow, own)) => {
                let parts = FlowParts {
                    list,
                    ways_out,
                    lattice: lattice.map(steps::on_lattice),
                    ground: &scene.materials,
                    domain: scene.domain,
                    flow,
                    numerics: own,
                    conduction: numerics.conduction,
                    passes: prepared.of_places(scene.random.permeability.as_ref(), team.as_ref()),
                };
                Box::new(AdvectedHeat::new(parts, &prepared.enthalpies())?)
            }
            None => {
                let (choice, materials) = (numerics.latent_heat_scheme, &prepared.materials);
                let scheme = scheme(choice, numerics.mushy, materials, &prepared.start, count);
                Box::new(ListBalance::new(list, Off, scheme))
            }
        };
        let balance = heating::heated(balance, scene, prepared);
        let sums = (count, is_heat_alone.then_some(scene.duration));
        Ok(steps::solver(numerics, balance, range, prepared.largest_slope(), sums))
    }

    fn assembly(&self, prepared: &Prepared, parts: ListParts) -> Assembly {
        Assembly {
            parts,
            sources: heating::sources(self.scene, prepared),
            start: prepared.start.clone(),
            latent_heat_scheme: self.settings.numerics.latent_heat_scheme,
            mushy: self.settings.numerics.mushy,
            absolute_zero: self.scene.units.absolute_zero(),
            seed: self.seed,
        }
    }
}
