use super::*;
use crate::bonds::stencil::Stencil;
use crate::bonds::weight::{Disc, Normalisation};
use crate::space::domain::Domain;

/// A pipe at a place on a lattice of 1 m, of 20 m by 20 m, whose pairs reach this far.
fn sink(reach: f64, (x, y): (f64, f64), width: Delta) -> Sink {
    let lattice = Lattice::new(&Domain::Rectangle { width: 20.0, height: 20.0 }, 1.0);
    let stencil = Stencil::new(&Disc(reach, 2.0), Normalisation::DiscreteMoment, 1.0, 2);
    let green = Green::new(&stencil, 1.0, green_reach(0.54, 1.0));
    let condition = PipeCondition::Temperature(Series::Constant(-20.0));
    let pipe = Pipe { x, y, radius: 0.54, one_particle: false, condition, schedule: None };
    immerse(&pipe, 0, &lattice, (false, false), (&green, width)).expect("room").expect("in the sector")
}

#[test]
fn a_flat_delta_makes_up_for_the_stencil_wherever_the_pipe_stands() {
    for reach in [1.0, 2.0, 3.0] {
        for (x, y) in [(10.0, 10.0), (10.5, 10.5), (10.3, 9.8)] {
            let [narrow, flat] = [Delta::Narrow, Delta::Flat].map(|width| sink(reach, (x, y), width));
            assert!(flat.extent.smoothing >= 0.0, "{reach} at ({x}, {y}): {}", flat.extent.smoothing);
            assert!(flat.extent.half_width >= narrow.extent.half_width);
            // Nothing is wider than it must be, and both stand for the same pipe.
            assert_eq!(narrow.extent.smoothing >= 0.0, narrow.sample == flat.sample, "{reach} at ({x}, {y})");
            assert!(narrow.resistance < flat.resistance + 1e-12 && (narrow.radius - flat.radius).abs() < 1e-15);
        }
    }
    // Long pairs need it.
    assert!(sink(3.0, (10.0, 10.0), Delta::Narrow).extent.smoothing < 0.0);
}

#[test]
fn a_delta_that_has_no_room_to_be_flat_is_narrow() {
    let near = (1.6, 10.0);
    assert_eq!(sink(3.0, near, Delta::Flat).sample, sink(3.0, near, Delta::Narrow).sample);
    assert_ne!(sink(3.0, (10.0, 10.0), Delta::Flat).sample, sink(3.0, (10.0, 10.0), Delta::Narrow).sample);
}
