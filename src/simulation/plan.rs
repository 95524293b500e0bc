//! From a scene to what its steps need, and what it is spared: the one place where run time becomes types.

use std::sync::Arc;

use glam::DVec2;
use rand::SeedableRng;
use rand_distr::{Distribution, Uniform};
use rayon::ThreadPool;

use crate::closing::dug_too_early;
use crate::cut_cells::blend;
use crate::interface;
use crate::layers;
use crate::march::Refused;
use crate::predict::{StepCount, planned_steps};
use crate::reference::Reference;
use crate::start;
use crate::terms::{self, Parts};
use crate::walls::boundary;
use frazil_core::balances::groundwater::network::WayOut;
use frazil_core::balances::groundwater::{FlowMethod, FlowParts};
use frazil_core::bonds::exchange::Exchange;
use frazil_core::bonds::pair_list::PairList;
use frazil_core::bonds::stencil::{SHELL_TOLERANCE, Stencil};
use frazil_core::bonds::weight::Normalisation;
use frazil_core::boundary::curved_wall::{Contacts, Neighbourhood, Rim, cells_behind};
use frazil_core::boundary::ghosts::Ghosts;
use frazil_core::boundary::green::Green;
use frazil_core::boundary::interface::Chains;
use frazil_core::boundary::patch::MOST_DOORS;
use frazil_core::boundary::patch::{Boundary, Dug, Side};
use frazil_core::boundary::pipe::{Extent, Sink, green_reach, immerse, radius_of_one_particle};
use frazil_core::boundary::shells::{naive_shells, shells};
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::boundary::wall_layers::{Body, inner, level};
use frazil_core::breakage::crack::{Barriers, Cuts};
use frazil_core::breakage::excavation;
use frazil_core::kernels::corner::strengthen;
use frazil_core::kernels::lattice::{LatticeOperator, LatticeParts};
use frazil_core::kernels::rows::{EnthalpyList, ListOperator, ListParts, Off, Tangent};
use frazil_core::kernels::sweep::WIDEST;
use frazil_core::memory::{self, Held, Memory};
use frazil_core::neighbours::all_pairs::AllPairs;
use frazil_core::neighbours::cells::Cells;
use frazil_core::neighbours::tree::Tree;
use frazil_core::neighbours::{NeighbourSearch, Period};
use frazil_core::particles::{Particles, Places};
use frazil_core::physics::potential::{Curve, Law, Thermal};
use frazil_core::physics::sub_cell::SubCellFront;
use frazil_core::physics::uptake::Mushy;
use frazil_core::physics::uptake::Uptake;
use frazil_core::physics::uptake::{Materials, scheme};
use frazil_core::solvers::assembly::Assembly;
use frazil_core::solvers::control::EnthalpyRange;
use frazil_core::solvers::euler::Euler;
use frazil_core::solvers::implicit::Implicit;
use frazil_core::solvers::method::Method;
use frazil_core::solvers::moving::{Crowd, Purpose};
use frazil_core::solvers::operator::Operator;
use frazil_core::solvers::rkl2::Rkl2;
use frazil_core::solvers::step::Bound;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::lattice::Lattice;
use frazil_core::space::segment::meet;
use frazil_core::space::symmetry::Symmetry;
use frazil_core::space::volumes::Volumes;
use frazil_scene::method::{Discretisation, Stepper};
use frazil_scene::settings::MethodSettings;
use frazil_scene::{Front, IntegratorChoice, Layout, Numerics, Scene, SearchChoice, StepChoice};

/// Stages of one step by error: longer steps are rarely as exact as they are stable, and gain less and less.
const MOST_STAGES: usize = 99;

/// Times that a ring of pipes may be switched in one run.
const MOST_SWITCHES: f64 = 1e7;

/// Steps of one run: more and time, which is as good as 16 digits, would stand still.
const MOST_STEPS: f64 = 1e15;

/// What a run of a scene under a method will do: the answer of `frazil check`.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSummary {
    /// Particles.
    pub particles: u64,
    /// Pairs that one evaluation visits (each pair once).
    pub pairs: u64,
    /// What the run holds on the heap to its end, apart from watches (bytes).
    pub memory: Memory,
    /// Step that will be made (s), before it is shortened to land on outputs.
    pub step_s: f64,
    /// Derived bound of the explicit step (s).
    pub step_bound_s: f64,
    /// What sets the bound.
    pub step_limit: String,
    /// Steps of the whole run.
    pub steps: StepCount,
    /// What the scene uses, in words.
    pub used: Vec<String>,
    /// What it is spared, in words.
    pub spared: Vec<String>,
    /// What would allow longer steps, in words.
    pub relaxed_by: Vec<String>,
    /// How the method differs from the scene, in words.
    pub differences: Vec<String>,
}

/// A run that is ready for its first step.
pub struct Plan {
    /// Particles at their start.
    pub particles: Particles,
    /// The method.
    pub method: Box<dyn Method>,
    /// The longest step that will be made (s).
    pub step: f64,
    /// The bound that the step was chosen from.
    pub bound: Bound,
    /// The same in words.
    pub summary: PlanSummary,
    /// Where pipes are at work, in the sector.
    pub pipe_extents: Vec<Extent>,
}

/// Limits of explicit steps of a method on a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    /// By row sums of the actual pairs (Gershgorin): up to here the maximum principle holds.
    pub gershgorin: Bound,
    /// Two over the largest rate of decay (s), by power iteration: up to here steps are linearly stable.
    pub sharp_step: f64,
}

/// Both limits of explicit steps.
pub fn bounds(
    scene: &Scene,
    settings: &MethodSettings,
    reference: Option<&Arc<dyn Reference>>,
    seed: u64,
) -> Result<Bounds, Refused> {
    let mut explicit = settings.clone();
    explicit.numerics.integrator = IntegratorChoice::Euler;
    explicit.numerics.step = StepChoice::Fraction(1.0);
    let mut plan = build(scene, &explicit, reference, 1, seed)?;
    Ok(Bounds { sharp_step: plan.method.sharp_step(), gershgorin: plan.bound })
}

/// The settings of a method on a scene, or why there are none.
pub fn settings_of<'a>(scene: &'a Scene, method: &str) -> Result<&'a MethodSettings, Refused> {
    scene.method(method).ok_or_else(|| {
        refuse(format!("scene `{}` has no section [method.{method}] that gives its spacing", scene.name))
    })
}

fn refuse(reason: String) -> Refused {
    Refused { reason }
}

/// Builds everything that a run needs.
pub fn build(
    scene: &Scene,
    settings: &MethodSettings,
    reference: Option<&Arc<dyn Reference>>,
    threads: usize,
    seed: u64,
) -> Result<Plan, Refused> {
    build_for(Purpose::Run, scene, settings, reference, threads, seed)
}

/// Builds everything that is needed for a purpose.
pub(crate) fn build_for(
    purpose: Purpose,
    scene: &Scene,
    settings: &MethodSettings,
    reference: Option<&Arc<dyn Reference>>,
    threads: usize,
    seed: u64,
) -> Result<Plan, Refused> {
    let numerics = &settings.numerics;
    let discretisation = settings.discretisation.as_ref();
    let stencil = discretisation.stencil(numerics.spacing, scene.domain.dimension());
    affordable(scene, settings, &stencil)?;
    let own_step = match &discretisation.stepper {
        Stepper::Moving(make) => {
            let crowd = make(scene, settings, pool(threads)?, seed, purpose).map_err(refuse)?;
            return moving(scene, settings, crowd);
        }
        Stepper::Own(step) => Some(step),
        Stepper::Shared => None,
    };
    if scene.stream.is_some() {
        return Err(refuse("a driven liquid needs particles that move: method.edpd.motion = true".into()));
    }
    if !scene.wall_parts.is_empty() && scene.domain.symmetry().is_none() {
        return Err(refuse(
            "parts of the walls of a rectangle need particles that move (method.edpd.motion = true) or an axis".into(),
        ));
    }
    if let Some(reason) = dug_too_early(scene) {
        return Err(refuse(reason));
    }
    let lattice = Arc::new(Lattice::new(&scene.domain, numerics.spacing));
    if lattice.is_empty() {
        return Err(refuse(format!("a spacing of {} m leaves no particle in the domain", numerics.spacing)));
    }
    // The papers' shape factors and mirrors, in their own setting.
    let printed = scene.domain.symmetry().is_some() && discretisation.normalisation == Normalisation::Nominal;
    let boundary = boundary(scene, numerics.walls, reference.cloned(), printed).map_err(refuse)?;
    if boundary.doors.len() > MOST_DOORS {
        return Err(refuse(format!("{} walls and parts of walls, must be at most {MOST_DOORS}", boundary.doors.len())));
    }
    let volumes = Volumes::new(&scene.domain, &lattice, printed);
    let thermals: Arc<[Thermal]> = scene
        .materials
        .iter()
        .map(|material| {
            let curve = Curve::new(material);
            let curve = match numerics.uptake {
                Uptake::ApparentCapacity { interval } => curve.spread(interval),
                Uptake::Enthalpy | Uptake::Flags => curve,
            };
            Thermal::new(curve, scene.initial_temperature)
        })
        .collect();
    let pool = pool(threads)?;
    let cloud = place(scene, numerics, &lattice, seed)?;
    let of_particle: Vec<u8> = if !scene.has_regional_materials() {
        Vec::new()
    } else {
        let material = |place: DVec2| scene.material_at(place.x, place.y) as u8;
        match &cloud {
            Some(positions) => positions.iter().copied().map(material).collect(),
            None => lattice.positions().into_iter().map(material).collect(),
        }
    };
    let mut materials = Materials::new(thermals, of_particle);
    if materials.mixed() && blends(scene, numerics) {
        match &cloud {
            Some(positions) => blend(scene, &mut materials, positions, lattice.spacing),
            None => blend(scene, &mut materials, &lattice.positions(), lattice.spacing),
        }
    }
    let start = start::enthalpies(scene, &materials, &lattice, cloud.as_deref());
    // Particles that store what is in their cells fill regions exactly.
    let mut differences = match materials.mixed() && blends(scene, numerics) {
        true => Vec::new(),
        false => start::volume_errors(scene, &lattice, cloud.as_deref()),
    };
    let stencil = discretisation.stencil(lattice.spacing, lattice.dimension);
    if !stencil.sum().is_finite() || stencil.sum() <= 0.0 {
        return Err(refuse("no pair of particles has a weight: the reach is shorter than the spacing".into()));
    }
    if materials.mixed() {
        differences.extend(layers::unresolved(scene, numerics, &lattice, &stencil, &materials.thermals));
    }
    let Pipes { sinks, rings, acting } = pipes(scene, numerics, &lattice, &boundary, &stencil)?;
    differences.extend(acting);
    let count = cloud.as_ref().map_or(lattice.len(), |cloud| cloud.len());
    let start = start::without_displaced(start, &sinks, &materials, &volumes, count);
    let sampled = sinks.iter().flat_map(|sink| sink.sample.iter().map(|entry| entry.0));
    let mut exempt: Vec<u32> = sampled.collect();
    exempt.sort_unstable();
    exempt.dedup();
    let range = || EnthalpyRange::new(&materials, scene.temperature_range(), exempt, scene.has_flux());
    let largest_slope = materials.laws().map(|thermal| thermal.largest_slope).fold(0.0, f64::max);
    let pipe_extents = sinks.iter().map(|sink| sink.extent).collect();
    let shelled = scene.domain.symmetry().is_some();
    let narrow = stencil.reach > lattice.columns || (lattice.dimension == 2 && stencil.reach > lattice.rows);
    if narrow && numerics.search == SearchChoice::Lattice {
        return Err(refuse("search = \"lattice\" needs a body at least as wide as pairs reach: set \"auto\"".into()));
    }
    if let Some(reason) =
        cracks_out_of_place(scene, numerics, &boundary, &sinks, stencil.reach as f64 * lattice.spacing, narrow)
    {
        return Err(refuse(reason));
    }
    if let Some(reason) = boundary.dug.as_ref().and_then(|dug| shaft_out_of_place(dug, numerics, &lattice, &sinks)) {
        return Err(refuse(reason));
    }
    let why_list = |flows| why_list(scene, numerics, discretisation, &stencil, narrow, flows);
    // Water needs the pairs; heat may be conducted without them.
    let conducts_on_lattice = why_list(false).is_none();
    let why_list = why_list(scene.flow.is_some());
    if let (Some(reason), Front::SubCell) = (why_list, numerics.front) {
        return Err(refuse(format!("front = \"sub-cell\" needs a lattice without a neighbour list, but {reason}")));
    }
    let mut used = vec![format!(
        "{} particles, {} m apart, {}",
        lattice.len(),
        lattice.spacing,
        match numerics.layout {
            Layout::Lattice => "on a lattice".to_string(),
            Layout::Jittered { fraction } => format!("on a lattice jittered by {fraction} of the spacing"),
            Layout::Random => "at random".to_string(),
        }
    )];
    let terms = Parts {
        scene,
        numerics,
        discretisation,
        materials: &materials,
        boundary: &boundary,
        pipes: sinks.len(),
        list: why_list.is_some(),
    };
    let (terms, spared, relaxed_by) = (terms.used(), terms.spared(), terms.relaxed_by());
    let method: Box<dyn Method> = match why_list {
        None => {
            used.push(format!("one fused sweep a step, {} neighbours a particle", stencil.neighbours()));
            let thermal = &materials.thermals[0];
            let front = match numerics.front {
                Front::Cell => None,
                Front::SubCell => Some(SubCellFront::new(thermal, scene.temperature_range(), &lattice, &stencil)),
            };
            let parts = LatticeParts {
                lattice: lattice.clone(),
                front,
                stencil,
                thermal: materials.thermals[0].clone(),
                boundary,
                sinks,
                rings,
                pool,
                bound: settings.bound.clone(),
            };
            integrator(numerics, on_lattice(parts), range, largest_slope, count)
        }
        Some(reason) => {
            used.push(format!("a neighbour list, because {reason}"));
            let positions: Arc<[DVec2]> = match &cloud {
                Some(cloud) => cloud.clone(),
                None => lattice.positions().into(),
            };
            let fitted = numerics.walls == WallModel::MovingLeastSquares;
            let reach = discretisation.weight.reach();
            let mut ghosts = Ghosts::new(&positions, &lattice, &boundary, reach, fitted);
            let naive = numerics.walls == WallModel::Naive;
            let (mut pairs, contacts, mut touches, ways_out) = if shelled && !printed {
                let shells = if naive {
                    naive_shells(&scene.domain, &lattice, &stencil, &boundary)
                } else {
                    shells(&scene.domain, &lattice, &stencil, &boundary)
                };
                let shells = shells.map_err(refuse)?;
                ghosts = shells.ghosts;
                (shells.pairs, Contacts::default(), shells.touches, Vec::new())
            } else {
                let (mut pairs, contacts, ways_out) =
                    pairs(&positions, &ghosts, &lattice, &boundary, &materials, settings);
                match scene.domain.symmetry() {
                    Some(symmetry) => print_shapes(&mut pairs, symmetry, &positions, &ghosts)?,
                    None => {
                        let first = &materials.thermals[0];
                        let faces = boundary.first_faces(&first.curve, first.initial_potential);
                        strengthen(&mut pairs, &ghosts, positions.len(), &faces);
                    }
                }
                (pairs, contacts, Vec::new(), ways_out)
            };
            let body = Body {
                positions: &positions,
                lattice: &lattice,
                boundary: &boundary,
                volumes: &volumes,
                materials: &materials,
                symmetry: scene.domain.symmetry(),
            };
            if naive && (scene.brings_heat() || (shelled && !printed)) {
                level(&mut ghosts, &pairs, &body, !printed && shelled);
            }
            if numerics.walls == WallModel::InnerLayers {
                touches = inner(&mut pairs, &mut ghosts, &body, stencil.reach).map_err(refuse)?;
            }
            let outer = boundary.curved.map(|(door, _)| Rim { door, from: 0.0, contacts });
            let mut rims: Vec<Rim> = outer.into_iter().collect();
            let cuts = if let Some(dug) = &boundary.dug {
                let (cuts, face) = excavation::face(&pairs, &positions, &ghosts, &materials, dug);
                rims.push(face);
                cuts
            } else if scene.cracks.is_empty() {
                Cuts::default()
            } else {
                let barriers = Barriers::new(&scene.cracks, &lattice, &boundary);
                Cuts::new(&mut pairs, &positions, &ghosts, &barriers)
            };
            let chains = if numerics.exchange == Exchange::Potential {
                let seen = interface::Seen {
                    positions: &positions,
                    materials: &materials,
                    pairs: &pairs,
                    boundary: &boundary,
                    rims: &rims,
                    touches: &touches,
                    lattice: &lattice,
                };
                interface::chains(scene, numerics, &seen, &mut ghosts)
            } else {
                Chains::default()
            };
            let parts = ListParts {
                chains,
                positions,
                volumes: volumes.clone(),
                spacing: lattice.spacing,
                materials: materials.clone(),
                pairs,
                cuts,
                ghosts,
                boundary,
                rims,
                touches,
                surfaces: scene.watch.surfaces.clone(),
                sinks,
                rings,
                exchange: numerics.exchange,
                pool,
                bound: settings.bound.clone(),
            };
            let assembly = |parts: ListParts| Assembly {
                parts,
                start: start.clone(),
                uptake: numerics.uptake,
                mushy: numerics.mushy,
                absolute_zero: scene.units.absolute_zero(),
                seed,
            };
            let flows = scene.flow.as_ref().zip(numerics.flow);
            match (own_step, flows) {
                (None, Some((flow, own))) => {
                    let enthalpy = if start.is_empty() { vec![0.0; count] } else { start.to_vec() };
                    let lattice = conducts_on_lattice.then(|| {
                        used.push("heat is conducted by a sweep over the lattice".into());
                        on_lattice(LatticeParts {
                            lattice: lattice.clone(),
                            front: None,
                            stencil,
                            thermal: materials.thermals[0].clone(),
                            boundary: parts.boundary.clone(),
                            sinks: parts.sinks.clone(),
                            rings: parts.rings.clone(),
                            pool: parts.pool.clone(),
                            bound: settings.bound.clone(),
                        })
                    });
                    let method = FlowMethod::new(
                        FlowParts {
                            list: parts,
                            ways_out: &ways_out,
                            lattice,
                            ground: &scene.materials,
                            domain: scene.domain,
                            flow,
                            numerics: own,
                            conduction: numerics.conduction,
                            fraction: match numerics.step {
                                StepChoice::Fraction(fraction) => fraction,
                                StepChoice::Fixed(_) => 1.0,
                            },
                        },
                        &enthalpy,
                    );
                    Box::new(method.map_err(refuse)?)
                }
                (Some(step), _) => step(assembly(parts)),
                (None, None) if numerics.uptake == Uptake::Enthalpy && numerics.mushy == Mushy::Fraction => {
                    let operator = EnthalpyList {
                        operator: ListOperator::new(parts, Off),
                        scheme: scheme(Uptake::Enthalpy, Mushy::Fraction, &materials, &start, count),
                        rate: vec![0.0; count],
                        tangent: Tangent::default(),
                    };
                    integrator(numerics, Box::new(operator), range, largest_slope, count)
                }
                (None, None) => assembly(parts).into_method(Off),
            }
        }
    };
    let bound = method.bound();
    let step = choose_step(numerics, &bound, scene)?;
    let particles = Particles {
        enthalpy: if start.is_empty() { vec![0.0; count] } else { start.to_vec() },
        start,
        places: cloud.map_or(Places::Lattice, Places::Cloud),
        velocity: Vec::new(),
        volumes,
        sub_cell: numerics.front == Front::SubCell,
        shaft: None,
        lattice,
        materials,
    };
    let summary = PlanSummary {
        particles: count as u64,
        pairs: method.pairs(),
        memory: Memory { particles: particles.held(), method: method.held(), watches: 0 },
        step_s: step,
        step_bound_s: bound.step,
        step_limit: bound.cause.clone(),
        steps: match numerics.integrator.tolerance() {
            None => StepCount::Planned(planned_steps(scene, step, method.gentle_step())),
            Some(_) => StepCount::ByErrorControl { estimate: None, trial: 0 },
        },
        used: [used, terms].concat(),
        spared,
        relaxed_by,
        differences: [
            discretisation.differences.clone(),
            terms::noise(scene, &particles.materials, discretisation.fluctuation),
            differences,
        ]
        .concat(),
    };
    Ok(Plan { particles, method, step, bound, summary, pipe_extents })
}

/// The plan of a scene whose particles move.
fn moving(scene: &Scene, settings: &MethodSettings, crowd: Crowd) -> Result<Plan, Refused> {
    let numerics = &settings.numerics;
    let Crowd { thermal, enthalpy, volume, differences, mut method } = crowd;
    let bound = method.bound();
    let step = choose_step(numerics, &bound, scene)?;
    let count = enthalpy.len();
    let mut particles = Particles {
        start: if scene.has_regional_starts() { enthalpy.as_slice().into() } else { Arc::new([]) },
        enthalpy,
        places: Places::Cloud(vec![DVec2::ZERO; count].into()),
        velocity: vec![DVec2::ZERO; count],
        lattice: Arc::new(Lattice::new(&scene.domain, numerics.spacing)),
        volumes: Volumes::even(volume),
        sub_cell: false,
        shaft: None,
        materials: Materials::new([thermal].into(), Vec::new()),
    };
    method.publish(&mut particles);
    let summary = PlanSummary {
        particles: count as u64,
        pairs: method.pairs(),
        memory: Memory { particles: particles.held(), method: method.held(), watches: 0 },
        step_s: step,
        step_bound_s: bound.step,
        step_limit: bound.cause.clone(),
        steps: StepCount::Planned(planned_steps(scene, step, None)),
        used: vec![
            format!("{count} particles that move, {} m apart in the mean", numerics.spacing),
            "columns of enthalpy, place and velocity; cells and a list of pairs with a skin".into(),
        ],
        spared: Vec::new(),
        relaxed_by: Vec::new(),
        differences: [settings.discretisation.differences.clone(), differences].concat(),
    };
    Ok(Plan { particles, method, step, bound, summary, pipe_extents: Vec::new() })
}

/// Whether particles store the heat of all materials in their cells. The papers' exchange and columns know one material a
/// particle, and so does water in its pores.
fn blends(scene: &Scene, numerics: &Numerics) -> bool {
    let columns = numerics.uptake == Uptake::Enthalpy && numerics.mushy == Mushy::Fraction;
    numerics.exchange == Exchange::Potential && columns && scene.flow.is_none()
}

/// What is held for each (bytes): a particle at rest, one that moves with what it meets, a pair on a list, and a pair along which
/// water flows; measured by `frazil check` with some ten thousand particles and more, and rounded down.
const BYTES: [f64; 4] = [16.0, 400.0, 28.0, 160.0];

/// Refuses what is far beyond the memory that is left, before any of it is taken.
fn affordable(scene: &Scene, settings: &MethodSettings, stencil: &Stencil) -> Result<(), Refused> {
    let numerics = &settings.numerics;
    let discretisation = settings.discretisation.as_ref();
    let spacing = numerics.spacing;
    let particles = scene.domain.size() / spacing.powi(scene.domain.dimension() as i32);
    let pairs = 0.5 * particles * stencil.neighbours() as f64;
    let [still, moving, listed, watered] = BYTES;
    let (bytes, what) = match (&discretisation.stepper, scene.flow.is_some()) {
        (Stepper::Moving(_), _) => (moving * particles, "particles that move"),
        (_, true) => ((still * particles) + watered * pairs, "the pairs along which water flows"),
        _ if why_list(scene, numerics, discretisation, stencil, false, false).is_some() => {
            (still * particles + listed * pairs, "their list of neighbours")
        }
        _ => (still * particles, "a lattice"),
    };
    match memory::left() {
        Some(left) if bytes > left => Err(refuse(format!(
            "a spacing of {spacing} makes {particles:.1e} particles, which with {what} need at least {}, and {} are left: \
             set a larger spacing",
            memory::words(bytes),
            memory::words(left)
        ))),
        _ => Ok(()),
    }
}

/// Why a scene needs a neighbour list; none if the lattice stencil does.
fn why_list(
    scene: &Scene,
    numerics: &Numerics,
    discretisation: &Discretisation,
    stencil: &Stencil,
    narrow: bool,
    flows: bool,
) -> Option<&'static str> {
    let reasons = [
        (numerics.layout != Layout::Lattice, "particles stand unevenly"),
        (numerics.exchange != Exchange::Potential, "pairs exchange by a mean of conductivities"),
        (
            numerics.uptake != Uptake::Enthalpy || numerics.mushy != Mushy::Fraction,
            "the latent-heat scheme keeps its own columns",
        ),
        (scene.has_regional_materials(), "there are several materials"),
        (!scene.cracks.is_empty(), "cracks cut pairs"),
        (scene.excavation.is_some(), "a shaft cuts pairs"),
        (scene.domain.symmetry().is_some(), "particles are shells"),
        (!scene.watch.surfaces.is_empty(), "heat through surfaces is watched"),
        (flows, "water flows along the pairs"),
        (numerics.walls == WallModel::MovingLeastSquares, "walls are fitted by moving least squares"),
        (numerics.walls == WallModel::InnerLayers, "the outermost particles are the walls"),
        (numerics.walls == WallModel::Naive && scene.brings_heat(), "naive layers at a flux or film follow particles"),
        (matches!(discretisation.stepper, Stepper::Own(_)), "the method makes its own step"),
        (narrow, "pairs reach farther than the body is wide"),
        (stencil.reach > WIDEST, "the reach is wider than any compiled stencil"),
        (
            !matches!(numerics.search, SearchChoice::Auto | SearchChoice::Lattice),
            "the settings ask for a neighbour search",
        ),
    ];
    reasons.into_iter().find(|reason| reason.0).map(|reason| reason.1)
}

/// Why cracks cannot be where they are: pairs alone know which way heat goes, and not the fits and sums that some walls and
/// pipes are made of.
fn cracks_out_of_place(
    scene: &Scene,
    numerics: &Numerics,
    boundary: &Boundary,
    sinks: &[Sink],
    reach: f64,
    narrow: bool,
) -> Option<String> {
    if scene.cracks.is_empty() {
        return None;
    }
    if narrow {
        return Some("cracks need a body at least as wide as pairs reach".into());
    }
    if numerics.walls == WallModel::MovingLeastSquares {
        return Some("fits of wall_model = \"moving-least-squares\" know no cracks: set \"mirror\"".into());
    }
    for (number, crack) in scene.cracks.iter().enumerate() {
        let farthest = crack.from.length().max(crack.to.length());
        if let Some((_, radius)) = boundary.curved.filter(|(_, radius)| farthest > radius - reach) {
            return Some(format!(
                "crack {number} comes within {:.6} m of the curved wall, must stay away from it by the reach of pairs, \
                 {reach:.6} m",
                radius - farthest
            ));
        }
        for sink in sinks {
            let Extent { centre, half_width: half, .. } = sink.extent;
            let corners =
                [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| centre + half * DVec2::new(x, y));
            let edge = |k: usize| (corners[k], corners[(k + 1) % 4]);
            let inside = (crack.from - centre).abs().max_element() <= half;
            if inside || (0..4).any(|k| meet((crack.from, crack.to), edge(k))) {
                return Some(format!(
                    "crack {number} cuts the particles that stand for the pipe at ({:.4}, {:.4}) m, must stay {half:.6} m \
                     away from it",
                    centre.x, centre.y
                ));
            }
        }
    }
    None
}

/// The operator on a lattice, with the law of its material.
fn on_lattice(parts: LatticeParts) -> Box<dyn Operator> {
    match parts.thermal.law.clone() {
        Law::Straight(law) => Box::new(LatticeOperator::new(parts, law)),
        Law::Kinked(law) => Box::new(LatticeOperator::new(parts, law)),
        Law::Curved(law) => Box::new(LatticeOperator::new(parts, law)),
        // A lattice without a list has one material.
        Law::Blended(_) => unreachable!("cells of one material"),
    }
}

fn integrator(
    numerics: &Numerics,
    operator: Box<dyn Operator>,
    range: impl FnOnce() -> EnthalpyRange,
    largest_slope: f64,
    count: usize,
) -> Box<dyn Method> {
    match numerics.integrator {
        IntegratorChoice::Euler => Box::new(Euler::new(operator)),
        IntegratorChoice::Rkl2 { stages } => Box::new(Rkl2::fixed(operator, stages, count)),
        IntegratorChoice::ControlledRkl2 { tolerance } => {
            Box::new(Rkl2::controlled(operator, MOST_STAGES, tolerance, range(), count))
        }
        IntegratorChoice::Implicit { tolerance } => {
            Box::new(Implicit::new(operator, tolerance, range(), largest_slope, count))
        }
    }
}

/// The longest step that a run will make (s); steps by error may be shorter.
fn choose_step(numerics: &Numerics, bound: &Bound, scene: &Scene) -> Result<f64, Refused> {
    let by_error = numerics.integrator.tolerance().is_some();
    let step = match numerics.step {
        StepChoice::Fraction(_) if by_error => scene.duration,
        StepChoice::Fraction(fraction) => fraction * bound.step,
        StepChoice::Fixed(step) => {
            // A step equal to the bound to rounding is the bound.
            if !by_error && step > bound.step * (1.0 + 1e-12) {
                return Err(refuse(format!(
                    "step_s = {step} is above the stable bound of {:.6} s, which is set by {}",
                    bound.step, bound.cause
                )));
            }
            step
        }
    };
    let steps = scene.duration / step;
    if steps.is_nan() || steps > MOST_STEPS {
        return Err(refuse(format!(
            "the run would take {steps:.1e} steps of {step:.1e} s, must be at most {MOST_STEPS:.0e}: the bound is set by {}",
            bound.cause
        )));
    }
    Ok(step.min(scene.duration))
}

fn pool(threads: usize) -> Result<Option<Arc<ThreadPool>>, Refused> {
    if threads <= 1 {
        return Ok(None);
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map(|pool| Some(Arc::new(pool)))
        .map_err(|error| refuse(format!("cannot start {threads} threads: {error}")))
}

/// Positions of particles off the lattice.
fn place(scene: &Scene, numerics: &Numerics, lattice: &Lattice, seed: u64) -> Result<Option<Arc<[DVec2]>>, Refused> {
    let uniform = Uniform::new(-0.5, 0.5).map_err(|error| refuse(error.to_string()))?;
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
    Ok(match numerics.layout {
        Layout::Lattice => None,
        Layout::Jittered { fraction } => Some(
            lattice
                .positions()
                .into_iter()
                .map(|place| {
                    let moved = place + 2.0 * fraction * lattice.spacing * shift();
                    if inside(moved) { moved } else { place }
                })
                .collect(),
        ),
        Layout::Random => {
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

/// Pairs with their weights: every partner within reach of every particle, ghosts included; and what became of those
/// that a curved wall cuts, for heat and, where it flows, for water.
fn pairs(
    positions: &[DVec2],
    ghosts: &Ghosts,
    lattice: &Lattice,
    boundary: &Boundary,
    materials: &Materials,
    MethodSettings { numerics, discretisation, .. }: &MethodSettings,
) -> (PairList, Contacts, Vec<WayOut>) {
    let (weight, flows) = (discretisation.weight.as_ref(), numerics.flow.is_some());
    // On a lattice a radius that falls on a shell must not depend on rounding.
    let limit = weight.reach() * (1.0 + SHELL_TOLERANCE);
    let mut points = positions.to_vec();
    points.extend_from_slice(&ghosts.position);
    let count = positions.len();
    let list = match numerics.search {
        SearchChoice::Auto | SearchChoice::Lattice | SearchChoice::Tree => {
            Tree.neighbours(&points, count, limit, Period::NONE)
        }
        SearchChoice::Cells => Cells.neighbours(&points, count, limit, Period::NONE),
        SearchChoice::AllPairs => AllPairs.neighbours(&points, count, limit, Period::NONE),
    };
    // Coincident points exchange nothing: their distance gives no direction.
    let distance = |i: usize, j: u32| (points[j as usize] - points[i]).length();
    let volume = lattice.volume();
    let behind = |i: usize| {
        let curved = boundary.curved.into_iter();
        let cells = curved.flat_map(move |(_, radius)| cells_behind(positions[i], lattice, radius, limit));
        cells.map(|(way, depth)| (way, depth, volume * weight.weight(way.length())))
    };
    let mut weights: Vec<f64> = Vec::with_capacity(list.partners.len());
    let mut scale = vec![1.0; points.len()];
    for i in 0..count {
        let mut moment: f64 = behind(i).map(|(way, _, pair)| pair * way.length_squared()).sum();
        for j in list.of(i) {
            let distance = distance(i, *j);
            let share = (*j as usize).checked_sub(count).map_or(1.0, |ghost| ghosts.share(ghost));
            let pair = if distance > 0.0 { volume * share * weight.weight(distance) } else { 0.0 };
            moment += pair * distance * distance;
            weights.push(pair);
        }
        if discretisation.normalisation == Normalisation::DiscreteMoment {
            scale[i] = if moment > 0.0 { (2 * lattice.dimension) as f64 / moment } else { 0.0 };
        }
    }
    for (ghost, model) in ghosts.model.iter().enumerate() {
        scale[count + ghost] = scale[*model as usize];
    }
    let mut place = 0;
    for i in 0..count {
        for j in list.of(i) {
            weights[place] *= 0.5 * (scale[i] + scale[*j as usize]);
            place += 1;
        }
    }
    let (mut contacts, mut ways_out) = (Contacts::default(), Vec::new());
    if let Some((door, radius)) = boundary.curved {
        for i in 0..count {
            let mut near = Neighbourhood::new(radius - positions[i].length());
            let mut sum = 0.0;
            for (way, depth, pair) in behind(i) {
                near.cut(scale[i] * pair, if boundary.doors[door].layers { 0.0 } else { depth });
                sum += scale[i] * pair;
                if flows {
                    ways_out.push(WayOut { particle: i as u32, weight: scale[i] * pair, way });
                }
            }
            if sum == 0.0 {
                continue;
            }
            for k in list.starts[i]..list.starts[i + 1] {
                // Beside a curved wall there are mirror planes alone, whose ghosts are their particles.
                let partner = list.partners[k] as usize;
                let particle = partner.checked_sub(count).map_or(partner as u32, |ghost| ghosts.model[ghost]);
                sum += weights[k];
                // A neighbour of another material pulls by the potential of the interface, not by its own.
                if materials.index(particle as usize) == materials.index(i) {
                    near.pair(particle, weights[k], radius - positions[particle as usize].length());
                }
            }
            contacts.add(i as u32, &near, sum);
        }
    }
    (PairList { starts: list.starts, partners: list.partners, weights }, contacts, ways_out)
}

/// Multiplies pairs by the shape factors that the papers print.
fn print_shapes(pairs: &mut PairList, symmetry: Symmetry, positions: &[DVec2], ghosts: &Ghosts) -> Result<(), Refused> {
    let radius =
        |j: usize| j.checked_sub(positions.len()).map_or_else(|| positions[j].x, |ghost| ghosts.position[ghost].x);
    for i in 0..positions.len() {
        for k in pairs.starts[i]..pairs.starts[i + 1] {
            let other = radius(pairs.partners[k] as usize);
            if other <= 0.0 {
                return Err(refuse(format!(
                    "the mirrored layers behind the wall \"inner\" reach across the axis, to r = {other:.6} m: in the \
                     paper setting pairs must reach less than the inner radius"
                )));
            }
            pairs.weights[k] *= symmetry.printed_factor(positions[i].x, other);
        }
    }
    Ok(())
}

/// Pipes joined to particles.
#[derive(Default)]
struct Pipes {
    sinks: Vec<Sink>,
    /// Names of the rings in the heat balance.
    rings: Vec<String>,
    /// As what pipes of one particle act.
    acting: Vec<String>,
}

/// Sinks of all pipes in the sector, and the names of their rings.
fn pipes(
    scene: &Scene,
    numerics: &Numerics,
    lattice: &Lattice,
    boundary: &Boundary,
    stencil: &Stencil,
) -> Result<Pipes, Refused> {
    if scene.rings.is_empty() {
        return Ok(Pipes::default());
    }
    if numerics.layout != Layout::Lattice {
        return Err(refuse("freeze pipes need particles on a lattice: set layout = \"lattice\"".into()));
    }
    let mirrors = (boundary.sides[0] == Side::Mirror, boundary.sides[2] == Side::Mirror);
    let mut sinks = Vec::new();
    let mut rings = Vec::new();
    let mut acting = Vec::new();
    for (number, ring) in scene.rings.iter().enumerate() {
        if let Some(schedule) = &ring.schedule
            && schedule.switches(scene.duration) > MOST_SWITCHES
        {
            return Err(refuse(format!(
                "the pipes of ring {} are switched {:.1e} times, must be at most {MOST_SWITCHES:.0e}: steps land on \
                 every switch",
                number + 1,
                schedule.switches(scene.duration)
            )));
        }
        let green = Green::new(stencil, lattice.spacing, green_reach(ring.pipe_radius, lattice.spacing));
        if ring.one_particle {
            acting.push(format!(
                "each pipe of ring {} is one particle, which acts as one of radius {:.3e} m",
                number + 1,
                radius_of_one_particle(&green, lattice.spacing)
            ));
        }
        for pipe in ring.pipes() {
            let sink = immerse(&pipe, number, lattice, mirrors, &green).map_err(refuse)?;
            sinks.extend(sink);
        }
        rings.push(if scene.rings.len() == 1 { "pipes".to_string() } else { format!("pipes_{}", number + 1) });
    }
    Ok(Pipes { sinks, rings, acting })
}

/// Why a shaft cannot be where it is.
fn shaft_out_of_place(dug: &Dug, numerics: &Numerics, lattice: &Lattice, sinks: &[Sink]) -> Option<String> {
    if numerics.walls == WallModel::MovingLeastSquares {
        return Some("fits of wall_model = \"moving-least-squares\" know no shaft: set \"mirror\"".into());
    }
    let nearest = |sink: &Sink| {
        let places = sink.sample.iter().map(|(index, _)| lattice.position(*index as usize).length());
        places.fold(f64::INFINITY, f64::min)
    };
    let sink = sinks.iter().find(|sink| nearest(sink) < dug.radius)?;
    Some(format!(
        "the shaft of {} m takes away particles that stand for the pipe at ({:.4}, {:.4}) m, the nearest {:.3} m from the \
         centre: a finer spacing is needed",
        dug.radius,
        sink.extent.centre.x,
        sink.extent.centre.y,
        nearest(sink)
    ))
}
