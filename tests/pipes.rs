//! Pipes of true radius against bodies of shells around a wall in their place.

use frazil::registry::methods;
use frazil_core::space::domain::{Domain, Sector};
use frazil_core::space::symmetry::Symmetry;

use crate::sketch::{SHARP, Sketch, even, sand, through};

const DAY: f64 = 86400.0;

/// Particles fill the place of the pipe too, but what it takes from the start on is the heat of the ground outside it.
#[test]
fn a_pipe_takes_the_heat_of_the_ground_around_it_alone() {
    let sand = || vec![("sand", sand(SHARP))];
    let (radius, outer) = (0.054, 1.054);
    let shells = Domain::Radial { symmetry: Symmetry::Axial, inner: radius, outer };
    let mut truth = Sketch::new(shells, 0.005).wall("inner", "temperature_c = -20").wall("outer", "temperature_c = 10");
    (truth.initial_c, truth.materials, truth.duration_s, truth.outputs) = (10.0, sand(), 4.0 * DAY, 8);
    let local = methods().iter().copied().find(|kind| kind.name == "local").expect("local");
    let truth = through(&truth.run(local), "inner");
    for kind in even() {
        // After half a day the front is 0.13 m away: it must lie beyond the reach of pairs.
        let mut pipe = Sketch::new(Domain::Ring { outer_radius: outer, sector: Sector::Quarter }, 0.04)
            .wall("outer", "temperature_c = 10");
        (pipe.initial_c, pipe.materials, pipe.duration_s, pipe.outputs) = (10.0, sand(), 4.0 * DAY, 8);
        pipe.pipes = vec![format!("count = 1\nring_radius_m = 0\npipe_radius_m = {radius}\ntemperature_c = -20")];
        let result = pipe.run(kind);
        assert!(result.record.energy_balance_rel.abs() < 1e-9, "{}", kind.name);
        let found = through(&result, "pipes");
        for (row, (found, truth)) in result.budget.iter().zip(found.iter().zip(&truth)) {
            let error = 4.0 * found / truth - 1.0;
            // Ground in its own place would be 9 % more after half a day and 2 % after four.
            assert!(error.abs() < 0.02, "{}: {error} after {} d", kind.name, row.time_s / DAY);
        }
    }
}
