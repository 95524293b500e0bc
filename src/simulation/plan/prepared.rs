//! Particles before their bonds: where they stand, what they are made of, what they hold at the start, and what is around them.

use std::sync::Arc;

use frazil_core::bonds::stencil::Stencil;
use frazil_core::bonds::weight::Normalisation;
use frazil_core::boundary::patch::{Boundary, MOST_PATCHES};
use frazil_core::boundary::pipe::Sink;
use frazil_core::kernels::lattice_parts::LatticeParts;
use frazil_core::particles::{Particles, Places};
use frazil_core::physics::curve::Curve;
use frazil_core::physics::latent_heat::{LatentHeatScheme, Materials};
use frazil_core::physics::material::Material;
use frazil_core::physics::sub_cell::{Extent, SubCellFront};
use frazil_core::physics::thermal::Thermal;
use frazil_core::solvers::control::EnthalpyRange;
use frazil_core::space::domain::{Domain, Sector, Surface};
use frazil_core::space::lattice::Lattice;
use frazil_core::space::random_field::{RandomField, Variation};
use frazil_core::space::volumes::Volumes;
use frazil_core::team::Team;
use frazil_scene::Scene;
use frazil_scene::method::{MethodSettings, Stepper};
use frazil_scene::settings::{Arrangement, Front, IntegratorChoice, Numerics};
use glam::DVec2;
use rand::SeedableRng;
use rand_distr::{Distribution, Uniform};

use crate::cut_cells::blend;
use crate::open_volumes::open_volumes;
use crate::plan::bonds;
use crate::plan::irregular;
use crate::plan::pipes::{Pipes, pipes};
use crate::plan::random;
use crate::plan::refusals::blends;
use crate::reference::Reference;
use crate::refused::Refused;
use crate::terms::Parts;
use crate::walls::boundary;
use crate::{layers, start};

/// Particles before their bonds.
pub(super) struct Prepared {
    pub(super) lattice: Arc<Lattice>,
    /// Places off the lattice (m).
    pub(super) cloud: Option<Arc<[DVec2]>>,
    /// What heat or water meets.
    pub(super) boundary: Boundary,
    /// What a solute meets, if there is one: walls in parts even where only it tells them apart.
    pub(super) in_parts: Option<Boundary>,
    pub(super) volumes: Volumes,
    pub(super) materials: Materials,
    /// Enthalpies at the start (J/m3); empty where all are zero.
    pub(super) start: Arc<[f64]>,
    pub(super) stencil: Stencil,
    pub(super) sinks: Vec<Sink>,
    /// How much better the ground of each particle conducts than its material; empty where all conducts as its material.
    pub(super) factors: Arc<[f64]>,
    /// What particles hold of a solute at the start; empty where there is none.
    pub(super) solute: Vec<f64>,
    /// Whether shells take the papers' shape factors and mirrors, in their own setting.
    pub(super) printed: bool,
    /// Whether pairs reach farther than the body is wide.
    pub(super) narrow: bool,
    /// How the body differs from the scene, in words.
    pub(super) differences: Vec<String>,
}

impl Prepared {
    /// The particles of a scene under a method.
    pub(super) fn new(
        scene: &Scene,
        settings: &MethodSettings,
        reference: Option<&Arc<dyn Reference>>,
        seed: u64,
        team: Option<&Team>,
    ) -> Result<Self, Refused> {
        let MethodSettings { numerics, discretisation, .. } = settings;
        let lattice = Arc::new(Lattice::new(&scene.domain, numerics.spacing));
        if lattice.is_empty() {
            return Err(Refused::NoParticle(numerics.spacing));
        }
        let printed = scene.domain.symmetry().is_some() && discretisation.normalisation == Normalisation::Nominal;
        let walls = |parts| boundary((scene, parts), numerics.walls, reference.cloned(), printed);
        let boundary = walls(scene.conducting_parts())?;
        let in_parts = scene.solute.is_some().then(|| walls(&scene.wall_parts)).transpose()?;
        let patches = in_parts.as_ref().unwrap_or(&boundary).patches.len();
        if patches > MOST_PATCHES {
            return Err(Refused::TooManyPatches(patches));
        }
        let cloud = place(scene, numerics, &lattice, seed)?;
        // Noise and the paths of water are of pairs whose ends are alike.
        let alike = matches!(discretisation.stepper, Stepper::Own(_)) || scene.flow.is_some();
        let volumes = match scene.impermeable.is_empty() || alike {
            true => Volumes::new(&scene.domain, &lattice, printed),
            false => open_volumes(scene, &lattice, cloud.as_deref()),
        };
        let count = cloud.as_ref().map_or(lattice.len(), |cloud| cloud.len());
        if (0..count).all(|i| volumes.of(i) <= 0.0) {
            return Err(Refused::Closed(numerics.spacing));
        }
        if let Some((from, to)) = scene.watch.phases {
            let along = |i: usize| cloud.as_ref().map_or_else(|| lattice.position(i), |cloud| cloud[i]).x;
            if !(0..count).any(|i| (from..=to).contains(&along(i)) && volumes.of(i) > 0.0) {
                return Err(Refused::NoPhases { from, to, spacing: numerics.spacing });
            }
        }
        let materials = materials(scene, numerics, &lattice, cloud.as_deref());
        let start = start::enthalpies(scene, &materials, &lattice, cloud.as_deref());
        // Particles that store what is in their cells fill regions exactly.
        let mut differences = match materials.mixed() && blends(scene, numerics) {
            true => Vec::new(),
            false => start::volume_errors(scene, &lattice, cloud.as_deref()),
        };
        let stencil = settings.stencil(lattice.spacing, lattice.dimension);
        if !stencil.sum().is_finite() || stencil.sum() <= 0.0 {
            return Err(Refused::NoPair);
        }
        if materials.mixed() {
            differences.extend(layers::unresolved(scene, numerics, &lattice, &stencil, &materials.thermals));
        }
        let Pipes { sinks, acting } = pipes(scene, &lattice, &boundary, (&stencil, numerics.front))?;
        differences.extend(acting);
        let start = start::without_displaced(start, &sinks, &materials, &volumes, count);
        differences.extend(random::unresolved(scene, lattice.spacing));
        let narrow = stencil.reach > lattice.columns || (lattice.dimension == 2 && stencil.reach > lattice.rows);
        let mut prepared = Prepared {
            lattice,
            cloud,
            boundary,
            in_parts,
            volumes,
            materials,
            start,
            stencil,
            sinks,
            factors: Arc::new([]),
            solute: Vec::new(),
            printed,
            narrow,
            differences,
        };
        prepared.factors = prepared.of_places(scene.random.conductivity.as_ref(), team);
        Ok(prepared)
    }

    /// What varies at random, at the places of all particles; nothing where nothing varies.
    pub(super) fn of_places(&self, variation: Option<&Variation>, team: Option<&Team>) -> Arc<[f64]> {
        variation.map_or_else(Arc::default, |varied| RandomField::new(varied).at_all(&self.positions(), team))
    }

    /// Number of particles.
    pub(super) fn count(&self) -> usize {
        self.cloud.as_ref().map_or(self.lattice.len(), |cloud| cloud.len())
    }

    /// Where particles stand (m).
    pub(super) fn positions(&self) -> Arc<[DVec2]> {
        match &self.cloud {
            Some(cloud) => cloud.clone(),
            None => self.lattice.positions().into(),
        }
    }

    /// Where a particle stands (m).
    pub(super) fn place(&self, particle: usize) -> DVec2 {
        self.cloud.as_ref().map_or_else(|| self.lattice.position(particle), |cloud| cloud[particle])
    }

    /// Enthalpies of all particles at the start (J/m3).
    pub(super) fn enthalpies(&self) -> Vec<f64> {
        if self.start.is_empty() { vec![0.0; self.count()] } else { self.start.to_vec() }
    }

    /// Particles and how they stand, in words.
    pub(super) fn words(&self, numerics: &Numerics) -> String {
        let stand = match numerics.arrangement {
            Arrangement::Lattice => "on a lattice".to_string(),
            Arrangement::Jittered { fraction } => format!("on a lattice jittered by {fraction} of the spacing"),
            Arrangement::Random => "at random".to_string(),
        };
        format!("{} particles, {} m apart, {stand}", self.lattice.len(), self.lattice.spacing)
    }

    /// The steepest answer of a potential to enthalpy (m2/s).
    pub(super) fn largest_slope(&self) -> f64 {
        self.materials.laws().map(|thermal| thermal.largest_slope).fold(0.0, f64::max)
    }

    /// What the sweep over the lattice is made from.
    pub(super) fn lattice_parts(
        &self,
        scene: &Scene,
        settings: &MethodSettings,
        team: Option<Team>,
    ) -> Result<LatticeParts, Refused> {
        let selection = irregular::select(scene, self);
        let front = (settings.numerics.front == Front::SubCell).then(|| {
            let cut = |particle: usize| selection.as_ref().is_some_and(|rows| rows.cut[particle]);
            let extent = Extent {
                temperatures: scene.temperature_range(),
                mirrors: self.boundary.sides.map(|side| self.boundary.mirrors(side)),
                repeats: self.boundary.repeats(),
                along_y: scene.freezing_direction().map(|direction| direction.along_y),
                free: scene.flow.is_none()
                    && !matches!(settings.numerics.integrator, IntegratorChoice::Implicit { .. }),
            };
            SubCellFront::new(&self.materials, extent, &self.lattice, &self.stencil, cut)
        });
        let boundary = selection.as_ref().map_or_else(|| self.boundary.clone(), |rows| rows.swept.clone());
        let rows =
            |selection, surfaces: &[Surface]| bonds::rows(scene, settings, self, selection, surfaces, team.clone());
        let observed = (!scene.watch.surfaces.is_empty()).then(|| irregular::at_surfaces(scene, self));
        Ok(LatticeParts {
            irregular: selection.map(|selection| rows(selection, &[])).transpose()?,
            observed: observed.map(|selection| rows(selection, &scene.watch.surfaces)).transpose()?,
            lattice: self.lattice.clone(),
            front,
            stencil: self.stencil.clone(),
            materials: self.materials.clone(),
            boundary,
            sinks: self.sinks.clone(),
            rings: scene.rings.len(),
            team,
            bound: settings.bound.clone(),
        })
    }

    /// What a run uses, what it is spared, and what would allow longer steps, in words.
    pub(super) fn terms(
        &self,
        scene: &Scene,
        settings: &MethodSettings,
        list: bool,
    ) -> (Vec<String>, Vec<String>, Vec<String>) {
        let terms = Parts {
            scene,
            numerics: &settings.numerics,
            discretisation: &settings.discretisation,
            materials: &self.materials,
            boundary: &self.boundary,
            pipes: self.sinks.len(),
            list,
        };
        (terms.used(), terms.spared(), terms.relaxed_by())
    }

    /// The particles, and how they differ from the scene.
    pub(super) fn into_particles(self, numerics: &Numerics) -> (Particles, Vec<String>) {
        let particles = Particles {
            enthalpy: self.enthalpies(),
            concentration: vec![0.0; self.solute.len()],
            factors: self.factors,
            solute: self.solute,
            start: self.start,
            places: self.cloud.map_or(Places::Lattice, Places::Cloud),
            velocity: Vec::new(),
            volumes: self.volumes,
            sub_cell: numerics.front == Front::SubCell,
            shaft: None,
            lattice: self.lattice,
            materials: self.materials,
        };
        (particles, self.differences)
    }

    /// The enthalpies that steps by error keep; particles that stand for pipes are exempt.
    pub(super) fn range(&self, scene: &Scene) -> EnthalpyRange {
        let sampled = self.sinks.iter().flat_map(|sink| sink.sample.iter().map(|entry| entry.0));
        let mut exempt: Vec<u32> = sampled.collect();
        exempt.sort_unstable();
        exempt.dedup();
        EnthalpyRange::new(&self.materials, scene.temperature_range(), exempt, (scene.has_flux(), self.count()))
    }
}

/// Laws of all particles.
fn materials(scene: &Scene, numerics: &Numerics, lattice: &Lattice, cloud: Option<&[DVec2]>) -> Materials {
    let thermal = |material: &Material| {
        let curve = Curve::new(material);
        let curve = match numerics.latent_heat_scheme {
            LatentHeatScheme::ApparentCapacity { interval } => curve.spread(interval),
            LatentHeatScheme::Enthalpy | LatentHeatScheme::Flags => curve,
        };
        Thermal::new(curve, scene.initial_temperature)
    };
    let mut thermals: Vec<Thermal> = Vec::new();
    for material in &scene.materials {
        let shared = thermals.iter().find_map(|known| known.shared(material, scene.initial_temperature));
        thermals.push(shared.unwrap_or_else(|| thermal(material)));
    }
    let thermals: Arc<[Thermal]> = thermals.into();
    if !scene.has_regional_materials() {
        return Materials::new(thermals, Vec::new());
    }
    let stood: Vec<DVec2>;
    let places = match cloud {
        Some(positions) => positions,
        None => {
            stood = lattice.positions();
            &stood
        }
    };
    let of_particle = places.iter().map(|place| scene.material_at(place.x, place.y) as u8).collect();
    let mut materials = Materials::new(thermals, of_particle);
    if materials.mixed() && blends(scene, numerics) {
        blend(scene, &mut materials, places, lattice.spacing);
    }
    materials
}

/// Positions of particles off the lattice.
fn place(scene: &Scene, numerics: &Numerics, lattice: &Lattice, seed: u64) -> Result<Option<Arc<[DVec2]>>, Refused> {
    let uniform = Uniform::new(-0.5, 0.5)?;
    let plane = if lattice.dimension == 1 { DVec2::X } else { DVec2::ONE };
    let mut random = rand::rngs::StdRng::seed_from_u64(seed);
    let mut shift = || DVec2::new(uniform.sample(&mut random), uniform.sample(&mut random)) * plane;
    let inside = |place: DVec2| match scene.domain {
        Domain::Line { length } => place.x > 0.0 && place.x < length,
        Domain::Rectangle { width, height } => place.x > 0.0 && place.x < width && place.y > 0.0 && place.y < height,
        Domain::Ring { outer_radius, sector } => {
            place.length() < outer_radius
                && (sector != Sector::Quarter || place.x > 0.0)
                && (sector == Sector::Whole || place.y > 0.0)
        }
        // Shells stand on their lattice.
        Domain::Radial { .. } | Domain::Axial { .. } => true,
    };
    Ok(match numerics.arrangement {
        Arrangement::Lattice => None,
        Arrangement::Jittered { fraction } => Some(
            lattice
                .positions()
                .into_iter()
                .map(|place| {
                    let moved = place + 2.0 * fraction * lattice.spacing * shift();
                    if inside(moved) { moved } else { place }
                })
                .collect(),
        ),
        Arrangement::Random => {
            let extent = DVec2::new(lattice.columns as f64, lattice.rows as f64) * lattice.spacing * plane;
            let centre = lattice.corner * plane + 0.5 * extent;
            let mut places: Vec<DVec2> = Vec::with_capacity(lattice.len());
            while places.len() < lattice.len() {
                let place = centre + extent * shift();
                if inside(place) {
                    places.push(place);
                }
            }
            Some(places.into())
        }
    })
}
