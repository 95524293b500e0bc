//! What a scene uses under a method, and what it is spared, in words.

use frazil_core::bonds::exchange::Exchange;
use frazil_core::boundary::patch::Boundary;
use frazil_core::kernels::irregular::IrregularRows;
use frazil_core::physics::latent_heat::{LatentHeatScheme, Materials, Mushy};
use frazil_core::physics::material::Material;
use frazil_core::physics::potential::Law;
use frazil_core::physics::thermal::Thermal;
use frazil_record::plain;
use frazil_scene::method::{Discretisation, Stepper};
use frazil_scene::{Front, Numerics, Scene, StepChoice, Units};

/// What the words are about.
pub struct Parts<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its settings.
    pub numerics: &'a Numerics,
    /// The method's geometry.
    pub discretisation: &'a Discretisation,
    /// Materials of particles.
    pub materials: &'a Materials,
    /// Walls.
    pub boundary: &'a Boundary,
    /// Pipes in the simulated sector.
    pub pipes: usize,
    /// Whether pairs are on a list.
    pub list: bool,
}

/// What of a lattice is on a list, in words.
pub fn irregular(rows: &IrregularRows) -> String {
    let count = rows.particles().len();
    format!("a list of the pairs of {count} particles beside interfaces, cracks or a shaft")
}

impl Parts<'_> {
    fn is_explicit(&self) -> bool {
        self.numerics.integrator.is_monotone()
    }

    fn has_shared_steps(&self) -> bool {
        matches!(self.discretisation.stepper, Stepper::Shared)
    }

    fn open_walls(&self) -> Vec<String> {
        self.boundary
            .patches
            .iter()
            .filter(|patch| patch.lets_heat_through())
            .map(|patch| patch.id.to_string())
            .collect()
    }

    /// Numbers that every particle carries.
    fn columns(&self) -> String {
        let mut names = vec![if self.scene.of_water { "water content" } else { "enthalpy" }];
        if self.list {
            names.push("position");
            let means = self.numerics.exchange != Exchange::Potential;
            if !means || self.pipes > 0 {
                names.push("potential");
            }
            if means {
                names.extend(["temperature", "conductivity"]);
            }
            if !self.has_shared_steps() {
                names.push("those of the method's own step");
            }
            names.push("rate");
            match self.numerics.latent_heat_scheme {
                LatentHeatScheme::Flags => names.push("temperature and released heat of the scheme"),
                LatentHeatScheme::ApparentCapacity { .. } => names.push("temperature of the scheme"),
                LatentHeatScheme::Enthalpy if self.numerics.mushy == Mushy::LastPhase => names.push("last phase"),
                LatentHeatScheme::Enthalpy => {}
            }
        }
        if self.materials.mixed() {
            names.push("material");
        }
        if !self.is_explicit() {
            names.push("those of the integrator");
        }
        format!("columns: {}", names.join(", "))
    }

    /// What the scene uses beside particles and pairs.
    pub fn used(&self) -> Vec<String> {
        let mut used = vec![self.columns()];
        if self.scene.freezes() {
            let scheme = match self.numerics.latent_heat_scheme {
                LatentHeatScheme::Enthalpy => "enthalpy",
                LatentHeatScheme::Flags => "flags",
                LatentHeatScheme::ApparentCapacity { .. } => "apparent capacity",
            };
            used.push(format!("latent heat, by {scheme}"));
            if self.numerics.front == Front::SubCell {
                used.push("sub-cell fronts".into());
            }
        }
        if self.materials.mixed() {
            used.push(format!("{} materials, with interfaces", self.scene.materials.len()));
        }
        if !self.scene.conducts_alike() {
            used.push(format!(
                "a conductivity along y of {} times that along x",
                self.scene.along.y / self.scene.along.x
            ));
        }
        used.extend(self.scene.random.variations().map(|(name, varied)| {
            format!("a random {name}, standard deviation of its logarithm {}", varied.log_deviation)
        }));
        if !self.scene.cracks.is_empty() {
            used.push(format!("{} cracks, which cut pairs", self.scene.cracks.len()));
        }
        if !self.scene.impermeable.is_empty() {
            used.push(format!("{} impermeable parts, which cut pairs and cells", self.scene.impermeable.len()));
        }
        if self.scene.excavation.is_some() {
            used.push("an excavation, whose face cuts pairs".to_string());
        }
        let walls = self.open_walls();
        if !walls.is_empty() {
            let moved = if self.scene.of_water { "water" } else { "heat" };
            used.push(format!("{moved} through {}, booked each step", walls.join(", ")));
        }
        if self.pipes > 0 {
            used.push(format!("{} pipes in the simulated part", self.pipes));
        }
        used
    }

    /// What it does not need and does not pay for.
    pub fn spared(&self) -> Vec<String> {
        let thermals = &self.materials.thermals;
        let straight = thermals.iter().all(|thermal| matches!(thermal.law, Law::Straight(_)));
        let said = [
            (!self.list, "no list of all pairs: a fixed lattice stencil"),
            (!self.list, "no positions or volumes"),
            (!self.materials.mixed(), "no material column"),
            (!self.list && self.is_explicit(), "no second pass: potentials, sums and update are one"),
            (self.has_shared_steps(), "no random numbers"),
            (true, "no motion: no velocities, forces and sorting into cells"),
            (self.pipes == 0, "no pipes"),
            (!self.scene.has_barriers(), "no cracks"),
            (self.open_walls().is_empty() && !self.scene.of_water, "no heat through walls"),
            (self.open_walls().is_empty() && self.scene.of_water, "no water through walls"),
            (self.scene.domain.dimension() == 1, "one dimension: no rows"),
            (!self.scene.freezes() && !self.scene.of_water, "no phase change"),
            (straight, "no law: potential proportional to enthalpy"),
        ];
        said.into_iter().filter(|said| said.0).map(|said| said.1.to_string()).collect()
    }

    /// What would allow longer steps.
    pub fn relaxed_by(&self) -> Vec<String> {
        let mut found = vec!["a larger spacing: the bound is proportional to its square".to_string()];
        if let StepChoice::Fraction(fraction) = self.numerics.step
            && fraction < 1.0
            && self.numerics.integrator.tolerance().is_none()
        {
            found.push(format!("step_fraction, now {fraction} of the bound"));
        }
        let plain =
            self.numerics.latent_heat_scheme == LatentHeatScheme::Enthalpy && self.numerics.mushy == Mushy::Fraction;
        if self.is_explicit() && self.has_shared_steps() && plain && self.scene.flow.is_none() {
            found.push("integrator = \"rkl2\": s stages make a step of (s^2 + s - 2)/4 bounds".to_string());
        }
        found
    }
}

/// Fluctuation of the temperature of a particle in the phase that stores least heat, over that while it is unfrozen.
pub fn fluctuation(law: &Thermal) -> f64 {
    (law.curve.unfrozen_capacity() / law.curve.least_capacity()).sqrt()
}

/// The thermal noise of each material at the warmest datum, in words; `relative` is that of absolute temperature.
pub fn noise(scene: &Scene, materials: &Materials, relative: f64) -> Vec<String> {
    if relative == 0.0 {
        return Vec::new();
    }
    let (low, high) = scene.temperature_range();
    let degree = if scene.units == Units::Si { " K" } else { "" };
    let own = relative * (high - scene.units.absolute_zero());
    let of = |(material, law): (&Material, &Thermal)| {
        let deviation = own * fluctuation(law);
        let part = match high > low {
            true => format!(", {} % of the range of the data", plain(100.0 * deviation / (high - low), 3)),
            false => String::new(),
        };
        format!("thermal noise of {}: up to {}{degree} in one particle{part}", material.name, plain(deviation, 3))
    };
    scene.materials.iter().zip(materials.thermals.iter()).map(of).collect()
}
