//! Pipes of a scene, joined to particles.

use frazil_core::bonds::stencil::Stencil;
use frazil_core::boundary::green::Green;
use frazil_core::boundary::patch::{Boundary, Side};
use frazil_core::boundary::pipe::{Delta, Sink, green_reach, immerse, radius_of_one_particle};
use frazil_core::space::lattice::Lattice;
use frazil_record::plain;
use frazil_scene::{Front, Scene};

use crate::refused::Refused;

/// Times that a ring of pipes may be switched in one run.
const MOST_SWITCHES: f64 = 1e7;

/// Pipes joined to particles.
#[derive(Default)]
pub(super) struct Pipes {
    pub(super) sinks: Vec<Sink>,
    /// As what pipes of one particle act.
    pub(super) acting: Vec<String>,
}

/// Sinks of all pipes in the sector.
pub(super) fn pipes(
    scene: &Scene,
    lattice: &Lattice,
    boundary: &Boundary,
    (stencil, front): (&Stencil, Front),
) -> Result<Pipes, Refused> {
    if scene.rings.is_empty() {
        return Ok(Pipes::default());
    }
    let mirrors = (boundary.sides[0] == Side::Mirror, boundary.sides[2] == Side::Mirror);
    // Barriers and excavations keep clear of the delta: it should not grow where they are.
    let is_alone = !scene.has_barriers() && boundary.dug.is_none();
    let width = if is_alone && front == Front::SubCell { Delta::Flat } else { Delta::Narrow };
    let mut sinks = Vec::new();
    let mut acting = Vec::new();
    for (number, ring) in scene.rings.iter().enumerate() {
        let switches = ring.schedule.as_ref().map_or(0.0, |schedule| schedule.switches(scene.duration));
        if switches > MOST_SWITCHES {
            return Err(Refused::Switches { ring: number + 1, switches, most: MOST_SWITCHES });
        }
        let green = Green::new(stencil, lattice.spacing, green_reach(ring.pipe_radius, lattice.spacing));
        if ring.one_particle {
            acting.push(format!(
                "each pipe of ring {} is one particle with an effective radius of {} m",
                number + 1,
                plain(radius_of_one_particle(&green, lattice.spacing), 4)
            ));
        }
        for pipe in ring.pipes() {
            let sink = immerse(&pipe, number, lattice, mirrors, (&green, width))?;
            sinks.extend(sink);
        }
    }
    Ok(Pipes { sinks, acting })
}
