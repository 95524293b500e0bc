//! What a plan refuses, and why a scene needs a list of neighbours.

use frazil_core::bonds::exchange::Exchange;
use frazil_core::bonds::stencil::Stencil;
use frazil_core::boundary::patch::{Boundary, Dug};
use frazil_core::boundary::pipe::{Extent, Sink};
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::kernels::sweep::WIDEST;
use frazil_core::memory;
use frazil_core::physics::latent_heat::{LatentHeatScheme, Mushy};
use frazil_core::space::lattice::Lattice;
use frazil_core::space::segment::meet;
use frazil_scene::Scene;
use frazil_scene::method::{Discretisation, MethodSettings, Stepper};
use frazil_scene::settings::{Arrangement, Front, Numerics, SearchChoice};
use glam::DVec2;

use crate::closing::dug_too_early;
use crate::plan::prepared::Prepared;
use crate::refused::{Refused, refuse};

/// Whether particles store the heat of all materials in their cells. The papers' exchange and columns know one material a
/// particle, and so does water in its pores.
pub(super) fn blends(scene: &Scene, numerics: &Numerics) -> bool {
    let columns = numerics.latent_heat_scheme == LatentHeatScheme::Enthalpy && numerics.mushy == Mushy::Fraction;
    numerics.exchange == Exchange::Potential && columns && scene.flow.is_none()
}

/// What is held for each (bytes): a particle at rest, one that moves with what it meets, a pair on a list, and a pair along which
/// water flows; measured by `frazil check` with some ten thousand particles and more, and rounded down.
const BYTES: [f64; 4] = [16.0, 400.0, 28.0, 160.0];

/// Refuses what is far beyond the memory that is left, before any of it is taken.
pub(super) fn affordable(scene: &Scene, settings: &MethodSettings, stencil: &Stencil) -> Result<(), Refused> {
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
pub(super) fn why_list(
    scene: &Scene,
    numerics: &Numerics,
    discretisation: &Discretisation,
    stencil: &Stencil,
    narrow: bool,
    flows: bool,
) -> Option<&'static str> {
    let reasons = [
        (numerics.arrangement != Arrangement::Lattice, "particles stand unevenly"),
        (numerics.exchange != Exchange::Potential, "pairs exchange by a mean of conductivities"),
        (
            numerics.latent_heat_scheme != LatentHeatScheme::Enthalpy || numerics.mushy != Mushy::Fraction,
            "the latent-heat scheme keeps its own columns",
        ),
        (scene.domain.symmetry().is_some(), "particles are shells"),
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

/// Refuses what needs particles that move, and a shaft that is dug before a wall can stand.
pub(super) fn unsupported(scene: &Scene) -> Result<(), Refused> {
    if scene.stream.is_some() {
        return Err(refuse("a driven liquid needs particles that move: method.edpd.motion = true"));
    }
    if !scene.wall_parts.is_empty() && scene.domain.symmetry().is_none() {
        return Err(refuse(
            "parts of the walls of a rectangle need particles that move (method.edpd.motion = true) or an axis",
        ));
    }
    if let Some(reason) = dug_too_early(scene) {
        return Err(refuse(reason));
    }
    Ok(())
}

/// Refuses fronts inside particles where heat needs a list, for this reason.
pub(super) fn front_off_the_lattice(numerics: &Numerics, why_list: Option<&str>) -> Result<(), Refused> {
    match why_list {
        Some(reason) if numerics.front == Front::SubCell => {
            Err(refuse(format!("front = \"sub-cell\" needs a lattice without a neighbour list, but {reason}")))
        }
        _ => Ok(()),
    }
}

/// Refuses a search, cracks and shafts that a body has no place for.
pub(super) fn out_of_place(scene: &Scene, numerics: &Numerics, prepared: &Prepared) -> Result<(), Refused> {
    let Prepared { boundary, sinks, lattice, narrow, .. } = prepared;
    if *narrow && numerics.search == SearchChoice::Lattice {
        return Err(refuse("search = \"lattice\" needs a body at least as wide as pairs reach: set \"auto\""));
    }
    let reach = prepared.stencil.reach as f64 * lattice.spacing;
    let cracks = cracks_out_of_place(scene, boundary, sinks, reach, *narrow);
    let shaft = || boundary.dug.as_ref().and_then(|dug| shaft_out_of_place(dug, lattice, sinks));
    cracks.or_else(shaft).map_or(Ok(()), |reason| Err(refuse(reason)))
}

/// Why cracks cannot be where they are: pairs alone know which way heat goes, and not the fits and sums that some walls and
/// pipes are made of.
fn cracks_out_of_place(scene: &Scene, boundary: &Boundary, sinks: &[Sink], reach: f64, narrow: bool) -> Option<String> {
    if scene.cracks.is_empty() {
        return None;
    }
    if narrow {
        return Some("cracks need a body at least as wide as pairs reach".into());
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

/// Why a shaft cannot be where it is.
fn shaft_out_of_place(dug: &Dug, lattice: &Lattice, sinks: &[Sink]) -> Option<String> {
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
