//! Dispersion and cracks in the plane.

use super::*;
use crate::breakage::crack::{Barriers, Crack, Growth};
use crate::solvers::balance::Balance;
use crate::solvers::heun::Heun;

/// Growth of the variance along and across a flow at an angle, over what the tensor says.
fn growth(angle: f64, along: f64, across: f64, molecular: f64) -> (f64, f64) {
    let body = Body::new(Domain::Rectangle { width: 4.0, height: 4.0 }, 0.05, 3, [true, true, true, true], &[]);
    let material =
        SoluteMaterial { longitudinal_dispersivity: along, transverse_dispersivity: across, ..plain(molecular) };
    let velocity = DVec2::from_angle(angle);
    let full = vec![1.0; body.len()];
    let mut solute = body.solute(material, &[None; 4], Advection::Central, &full);
    steady(&mut solute, &body.even_flow(velocity), &full);
    let centre = DVec2::splat(2.0) - 0.15 * velocity;
    let start = |place: &DVec2| (-(*place - centre).length_squared() / (2.0 * 0.04)).exp();
    let mut particles = body.particles(body.list.positions.iter().map(start).collect());
    let moments = |particles: &Particles| {
        let mut sums = [0.0; 5];
        for (place, content) in body.list.positions.iter().zip(&particles.enthalpy) {
            let (x, y) = ((*place - centre).dot(velocity), (*place - centre).perp_dot(velocity));
            let terms = [1.0, x, y, x * x, y * y];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += content * term);
        }
        let [all, x, y, xx, yy] = sums;
        DVec2::new(xx / all - (x / all).powi(2), yy / all - (y / all).powi(2))
    };
    let before = moments(&particles);
    let (step, end) = (solute.facts().bound.step, 0.3);
    let mut solver = Heun::new(Box::new(solute), 1.0, body.len());
    run(&mut solver, &mut particles, (step, end), |_, _| {});
    let grown = moments(&particles) - before;
    (grown.x / (2.0 * (molecular + along) * end), grown.y / (2.0 * (molecular + across) * end))
}

#[test]
fn flowing_water_spreads_along_and_across() {
    for angle in [0.0, 0.3, std::f64::consts::FRAC_PI_4] {
        for (along, across, molecular) in [(0.0, 0.0, 0.05), (0.1, 0.05, 0.0), (0.1, 0.05, 0.02), (0.1, 0.01, 0.0)] {
            let (x, y) = growth(angle, along, across, molecular);
            assert!((x - 1.0).abs() < 0.02 && (y - 1.0).abs() < 0.02, "{angle} {along} {across}: {x} {y}");
        }
        // Pairs of a lattice do not lie close enough together for any ratio of both.
        let (x, _) = growth(angle, 0.1, 0.001, 0.0);
        assert!((x - 1.0).abs() < 0.02, "{angle}: {x}");
    }
}

#[test]
fn a_crack_passes_nothing() {
    let mut body = Body::new(Domain::Rectangle { width: 1.0, height: 0.5 }, 0.05, 3, [true, true, false, false], &[]);
    let growth = Growth::Whole { start: 0.0 };
    let crack = Crack { from: DVec2::new(0.5, -1.0), to: DVec2::new(0.5, 1.0), growth };
    let Body { list, lattice } = &mut body;
    let cracks = [crack];
    let barriers = Barriers::new(&cracks, &|_, _| false, lattice, &list.boundary);
    list.cuts = Cuts::new(&mut list.pairs, &list.volumes, &list.positions, &list.ghosts, &barriers);
    let full = vec![1.0; body.len()];
    for advection in ALL {
        let mut solute = body.solute(plain(0.01), &[Some(1.0), Some(0.0), None, None], advection, &full);
        steady(&mut solute, &vec![0.0; body.list.pairs.partners.len()], &full);
        let mut particles = body.particles(vec![0.0; body.len()]);
        let step = solute.facts().bound.step;
        let mut solver = Heun::new(Box::new(solute), 1.0, body.len());
        run(&mut solver, &mut particles, (step, 20.0), |_, _| {});
        for (place, content) in body.list.positions.iter().zip(&particles.enthalpy) {
            assert!(if place.x > 0.5 { *content == 0.0 } else { *content > 0.1 }, "{place} {content}");
        }
    }
}

/// A crack that opens cuts diffusion, and puts it back when a step is made again. Water of the interval has gone before: what it carries
/// stays with it, so that an even concentration stays even.
#[test]
fn a_crack_that_opens_cuts_diffusion_and_leaves_what_water_has_carried() {
    let mut body = Body::line(1.0, 20, 3);
    let growth = Growth::Whole { start: 1.0 };
    let cracks = [Crack { from: DVec2::new(0.5, -1.0), to: DVec2::new(0.5, 1.0), growth }];
    let Body { list, lattice } = &mut body;
    let barriers = Barriers::new(&cracks, &|_, _| false, lattice, &list.boundary);
    list.cuts = Cuts::new(&mut list.pairs, &list.volumes, &list.positions, &list.ghosts, &barriers);
    let full = vec![1.0; body.len()];
    let mut solute = body.solute(plain(0.01), &[Some(1.0), None, None, None], Advection::Limited, &full);
    let mut rates = |flows: &[f64], state: &[f64], time: f64| {
        steady(&mut solute, flows, &full);
        let (mut rate, mut patches) = (vec![0.0; state.len()], vec![0.0; 4]);
        let clock = Clock { time, step: 1e-3, index: 0, turned: false };
        (&mut solute as &mut dyn Balance).rates(state, &clock, &mut rate, &mut patches);
        rate[10..].iter().map(|rate| rate.abs()).fold(0.0, f64::max)
    };
    let state: Vec<f64> = body.list.positions.iter().map(|place| f64::from(place.x < 0.5)).collect();
    let still = vec![0.0; body.list.pairs.partners.len()];
    let found = [0.5, 1.5, 0.5].map(|time| rates(&still, &state, time));
    assert!(found[0] > 1.0 && found[1] == 0.0 && found[2] == found[0], "{found:?}");
    let flow = body.even_flow(DVec2::X);
    let found = [0.5, 1.5, 0.5].map(|time| rates(&flow, &full, time));
    assert!(found.iter().all(|rate| *rate < 1e-12), "{found:?}");
}
