//! What a plan refuses, and why a scene needs a list of neighbours.

use frazil_core::bonds::exchange::Exchange;
use frazil_core::bonds::stencil::Stencil;
use frazil_core::boundary::patch::{Boundary, Dug};
use frazil_core::boundary::pipe::{Extent, Sink};
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::kernels::sweep::WIDEST;
use frazil_core::memory::{self, Memory};
use frazil_core::physics::latent_heat::{LatentHeatScheme, Mushy};
use frazil_core::space::lattice::Lattice;
use frazil_core::space::segment::meet;
use frazil_scene::Scene;
use frazil_scene::method::{Discretisation, MethodSettings, Stepper};
use frazil_scene::region::Cell;
use frazil_scene::settings::{Arrangement, Front, Numerics, SearchChoice};
use glam::DVec2;

use crate::closing::in_time;
use crate::plan::prepared::Prepared;
use crate::refused::Refused;

/// Whether particles store the heat of all materials in their cells. The papers' exchange and columns know one material a
/// particle, and so does water in its pores.
pub(super) fn blends(scene: &Scene, numerics: &Numerics) -> bool {
    let columns = numerics.latent_heat_scheme == LatentHeatScheme::Enthalpy && numerics.mushy == Mushy::Fraction;
    numerics.exchange == Exchange::Potential && columns && scene.flow.is_none()
}

/// What is held for each (bytes): a particle at rest, one that moves with what it meets while the liquid is made, a pair on a list
/// while that is made, and a pair along which water flows; measured with some ten thousand particles and more, and rounded down.
const BYTES: [f64; 4] = [16.0, 700.0, 26.0, 150.0];

/// What can be counted of a run without a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Counted {
    /// Particles.
    pub particles: f64,
    /// Pairs.
    pub pairs: f64,
    /// What is held for them at least (bytes).
    pub bytes: f64,
    /// Whatever holds the most of it, in words.
    what: &'static str,
}

/// Counts what a scene says of particles and pairs.
pub(crate) fn count(scene: &Scene, settings: &MethodSettings, stencil: &Stencil) -> Counted {
    let numerics = &settings.numerics;
    let discretisation = settings.discretisation.as_ref();
    let particles = scene.domain.size() / numerics.spacing.powi(scene.domain.dimension() as i32);
    let pairs = 0.5 * particles * stencil.neighbours() as f64;
    let [still, moving, listed, watered] = BYTES;
    let (bytes, what) = match (&discretisation.stepper, scene.flow.is_some()) {
        (Stepper::Moving(_), _) => (moving * particles, "their neighbours in motion"),
        (_, true) => ((still * particles) + watered * pairs, "the pairs along which water flows"),
        _ if why_list(scene, numerics, discretisation, stencil, false, false).is_some() => {
            (still * particles + listed * pairs, "their list of neighbours")
        }
        _ => (still * particles, "a lattice"),
    };
    Counted { particles, pairs, bytes, what }
}

/// Refuses what is far beyond the memory that a run may take, before any of it is taken.
pub(crate) fn affordable(scene: &Scene, settings: &MethodSettings, stencil: &Stencil) -> Result<(), Refused> {
    let Counted { particles, bytes: needed, what, .. } = count(scene, settings, stencil);
    let spacing = settings.numerics.spacing;
    match memory::allowed() {
        Some(allowed) if needed > allowed.each() => {
            let fits = fitting(spacing, scene, needed / allowed.each());
            Err(Refused::Memory { spacing, particles, what, needed, allowed, fits })
        }
        _ => Ok(()),
    }
}

/// Refuses a run that would hold more than it may, now that all it will hold is counted.
pub(crate) fn holdable(scene: &Scene, method: &str, held: Memory) -> Result<(), Refused> {
    let Some(allowed) = memory::allowed() else { return Ok(()) };
    let over = held.total() as f64 / allowed.each();
    if over <= 1.0 {
        return Ok(());
    }
    let spacing = scene.method(method).map_or(f64::NAN, |settings| settings.numerics.spacing);
    Err(Refused::Held { held, allowed, fits: fitting(spacing, scene, over) })
}

/// A spacing (m) at which this many times less is held, rounded up to three digits.
fn fitting(spacing: f64, scene: &Scene, over: f64) -> f64 {
    let least = spacing * over.powf(1.0 / scene.domain.dimension() as f64);
    let unit = 10f64.powf(least.log10().floor() - 2.0);
    (least / unit).ceil() * unit
}

/// Why a scene needs a neighbour list; none if the lattice stencil does.
pub(super) fn why_list(
    scene: &Scene,
    numerics: &Numerics,
    discretisation: &Discretisation,
    stencil: &Stencil,
    narrow: bool,
    flows: bool,
) -> Option<&'static str> {
    let reasons = [
        (numerics.arrangement != Arrangement::Lattice, "particles are irregular"),
        (numerics.exchange != Exchange::Potential, "pairs exchange by a mean of conductivities"),
        (
            numerics.latent_heat_scheme != LatentHeatScheme::Enthalpy || numerics.mushy != Mushy::Fraction,
            "the latent-heat scheme keeps its own columns",
        ),
        (scene.domain.symmetry().is_some(), "particles are shells"),
        (scene.random.conductivity.is_some(), "the conductivity varies from place to place"),
        (!scene.conducting_parts().is_empty(), "walls are in parts"),
        (flows, "water flows along the pairs"),
        (scene.gravity.is_some(), "gravity pulls water along the pairs"),
        (numerics.walls == WallModel::MovingLeastSquares, "walls are fitted by moving least squares"),
        (numerics.walls == WallModel::InnerLayers, "the outermost particles are the walls"),
        (
            numerics.walls == WallModel::Naive && scene.brings_heat(),
            "naive layers at a flux or film depend on particles",
        ),
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

/// Refuses what needs particles that move, and a shaft that is dug before a wall can stand.
pub(super) fn unsupported(scene: &Scene) -> Result<(), Refused> {
    if scene.stream.is_some() {
        return Err(Refused::StillStream);
    }
    Ok(in_time(scene)?)
}

/// Refuses fronts inside particles where heat needs a list, for this reason.
pub(super) fn front_off_the_lattice(numerics: &Numerics, why_list: Option<&'static str>) -> Result<(), Refused> {
    match why_list {
        Some(reason) if numerics.front == Front::SubCell => Err(Refused::FrontOnList(reason)),
        _ => Ok(()),
    }
}

/// Refuses a search, cracks and shafts that a body has no place for.
pub(super) fn out_of_place(scene: &Scene, numerics: &Numerics, prepared: &Prepared) -> Result<(), Refused> {
    let Prepared { boundary, sinks, lattice, narrow, .. } = prepared;
    if *narrow && numerics.search == SearchChoice::Lattice {
        return Err(Refused::NarrowLattice);
    }
    if *narrow && boundary.repeats_anywhere() {
        return Err(Refused::NarrowPeriod);
    }
    let reach = prepared.stencil.reach as f64 * lattice.spacing;
    cracks_in_place(scene, boundary, sinks, reach, *narrow)?;
    boundary.dug.as_ref().map_or(Ok(()), |dug| shaft_in_place(dug, lattice, sinks))
}

/// Refuses cracks that cannot be where they are: pairs alone know which way heat goes, and not the fits and sums that some walls and
/// pipes are made of.
fn cracks_in_place(
    scene: &Scene,
    boundary: &Boundary,
    sinks: &[Sink],
    reach: f64,
    narrow: bool,
) -> Result<(), Refused> {
    if narrow && scene.has_barriers() {
        return Err(Refused::NarrowCracks);
    }
    impermeable_in_place(scene, boundary, sinks, reach)?;
    for (number, crack) in scene.cracks.iter().enumerate() {
        let farthest = crack.from.length().max(crack.to.length());
        if let Some((_, radius)) = boundary.curved.filter(|(_, radius)| farthest > radius - reach) {
            return Err(Refused::CrackAtWall { number, distance: radius - farthest, reach });
        }
        for sink in sinks {
            let Extent { centre, half_width: half, .. } = sink.extent;
            let corners =
                [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| centre + half * DVec2::new(x, y));
            let edge = |k: usize| (corners[k], corners[(k + 1) % 4]);
            let inside = (crack.from - centre).abs().max_element() <= half;
            if inside || (0..4).any(|k| meet((crack.from, crack.to), edge(k))) {
                return Err(Refused::CrackInPipe { number, centre, half });
            }
        }
    }
    Ok(())
}

/// Refuses impermeable parts at a curved wall and in pipes, as cracks are.
fn impermeable_in_place(scene: &Scene, boundary: &Boundary, sinks: &[Sink], reach: f64) -> Result<(), Refused> {
    for (number, shape) in scene.impermeable.iter().enumerate() {
        let Cell { low, high } = shape.extent();
        let farthest = low.abs().max(high.abs()).length();
        if let Some((_, radius)) = boundary.curved.filter(|(_, radius)| farthest > radius - reach) {
            return Err(Refused::ImpermeableAtWall { number, distance: radius - farthest, reach });
        }
        for Extent { centre, half_width: half, .. } in sinks.iter().map(|sink| sink.extent) {
            if shape.share_of(&Cell::around(centre, 2.0 * half)) > 0.0 {
                return Err(Refused::ImpermeableInPipe { number, centre, half });
            }
        }
    }
    Ok(())
}

/// Refuses a shaft that cannot be where it is.
fn shaft_in_place(dug: &Dug, lattice: &Lattice, sinks: &[Sink]) -> Result<(), Refused> {
    let nearest = |sink: &Sink| {
        let places = sink.sample.iter().map(|(index, _)| lattice.position(*index as usize).length());
        places.fold(f64::INFINITY, f64::min)
    };
    match sinks.iter().find(|sink| nearest(sink) < dug.radius) {
        Some(sink) => {
            Err(Refused::ShaftInPipe { radius: dug.radius, centre: sink.extent.centre, nearest: nearest(sink) })
        }
        None => Ok(()),
    }
}
