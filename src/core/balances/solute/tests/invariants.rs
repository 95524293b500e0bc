//! What must hold whatever the water does.

use super::*;
use crate::solvers::balance::{Balance, Update};
use crate::solvers::heun::Heun;
use crate::solvers::passenger::{Interval, Passenger};
use crate::space::symmetry::Symmetry;
use crate::team::Team;

/// A plate with an inflow on the left, a part of it of another concentration, an outflow on the right without one, and a pond
/// on the top.
fn plate(reach: usize) -> Body {
    let domain = Domain::Rectangle { width: 1.2, height: 0.9 };
    Body::new(domain, 0.1, reach, [true, true, false, true], &[(WallId::Left, 0.3, 0.6)])
}

const WALLS: [Option<f64>; 5] = [Some(1.0), None, None, Some(0.4), Some(0.0)];

/// Contents at both ends of an interval (s) in which particles gain water.
fn contents(gains: &[f64], step: f64) -> [Vec<f64>; 2] {
    let first: Vec<f64> = (0..gains.len()).map(|i| 0.3 + 0.1 * ((i % 7) as f64 / 7.0)).collect();
    let last = first.iter().zip(gains).map(|(first, gain)| first + step * gain).collect();
    [first, last]
}

/// A solute of a plate in uneven water, whose contents change by a third at most in an interval, and that (s).
fn uneven(body: &Body, material: SoluteMaterial, walls: &[Option<f64>], advection: Advection) -> (Solute, f64) {
    let (flows, gains) = body.uneven_flow(1e-3);
    let step = 0.1 / gains.iter().map(|gain| gain.abs()).fold(0.0, f64::max);
    let [first, last] = contents(&gains, step);
    let mut solute = body.solute(material, walls, advection, &first);
    solute.take(&Interval { start: 0.0, step, flows: &flows, contents: (&first, &last) });
    (solute, step)
}

#[test]
fn what_comes_in_and_decays_is_what_particles_hold() {
    for reach in [1, 3] {
        let body = plate(reach);
        for advection in ALL {
            let tortuosity = Tortuosity::MillingtonQuirk { saturated: 0.45 };
            let material = SoluteMaterial { tortuosity, sorption: 0.2, decay: 1e-3, ..plain(1e-4) };
            let (solute, end) = uneven(&body, material, &WALLS, advection);
            let start: Vec<f64> = (0..body.len()).map(|i| solute.content(i, (i % 5) as f64 / 5.0, 0.0)).collect();
            let mut particles = body.particles(start);
            let before = particles.integral(|i| particles.enthalpy[i]);
            let step = solute.facts().bound.step.min(end / 4.0);
            let mut solver = Heun::new(Box::new(solute), 1.0, body.len());
            run(&mut solver, &mut particles, (step, end), |_, _| {});
            let after = particles.integral(|i| particles.enthalpy[i]);
            let booked: f64 = solver.ledger().heat().iter().sum();
            let flowed: f64 = solver.ledger().heat().iter().map(|heat| heat.abs()).sum();
            assert!(((after - before) - booked).abs() < 1e-12 * (before + flowed), "{advection:?} {reach}");
            assert!(solver.ledger().heat().last().is_some_and(|decayed| *decayed < 0.0));
        }
    }
}

#[test]
fn an_even_concentration_stays_even() {
    for reach in [1, 3] {
        let body = plate(reach);
        for advection in [Advection::Limited, Advection::Fitted, Advection::Central, Advection::Upwind] {
            let material = SoluteMaterial { sorption: 0.1, ..plain(1e-5) };
            let (solute, end) = uneven(&body, material, &[Some(1.0), Some(1.0), None, Some(1.0), Some(1.0)], advection);
            let wanted: Vec<f64> = (0..body.len()).map(|i| solute.content(i, 1.0, end)).collect();
            let mut particles = body.particles((0..body.len()).map(|i| solute.content(i, 1.0, 0.0)).collect());
            let step = solute.facts().bound.step.min(end / 4.0);
            let mut solver = Heun::new(Box::new(solute), 1.0, body.len());
            run(&mut solver, &mut particles, (step, end), |_, _| {});
            for (found, wanted) in particles.enthalpy.iter().zip(&wanted) {
                assert!((found / wanted - 1.0).abs() < 1e-12, "{advection:?} {reach} {}", found / wanted - 1.0);
            }
        }
    }
}

/// Runs a solute from nothing over so many of its longest steps, and gives the least and greatest concentration of all of
/// them, where particles hold `holds` of water at a time (s).
fn range(body: &Body, solute: Solute, (steps, end): (f64, f64), holds: impl Fn(usize, f64) -> f64) -> (f64, f64) {
    let mut found = (f64::INFINITY, f64::NEG_INFINITY);
    let bound = solute.facts().bound.step;
    let mut solver = Heun::new(Box::new(solute), 1.0, body.len());
    let mut particles = body.particles(vec![0.0; body.len()]);
    run(&mut solver, &mut particles, (bound, end.min(steps * bound)), |time, particles| {
        for (i, content) in particles.enthalpy.iter().enumerate() {
            let concentration = content / holds(i, time);
            found = (found.0.min(concentration), found.1.max(concentration));
        }
    });
    found
}

#[test]
fn a_jump_at_the_wall_stays_within_its_range() {
    for reach in [1, 3] {
        for peclet in [1.0, 10.0, 1e3] {
            for advection in BOUNDED {
                let line = Body::line(1.0, 50, reach);
                for velocity in [1.0, -1.0] {
                    let flows = line.even_flow(DVec2::new(velocity, 0.0));
                    let full = vec![1.0; line.len()];
                    let mut solute =
                        line.solute(plain(0.02 / peclet), &[Some(1.0), None, None, None], advection, &full);
                    steady(&mut solute, &flows, &full);
                    let (least, most) = range(&line, solute, (300.0, f64::INFINITY), |_, _| 1.0);
                    assert!(least > -1e-12 && most < 1.0 + 1e-12, "{advection:?} {reach} {peclet}: {least} {most}");
                }
            }
        }
    }
}

#[test]
fn a_jump_along_the_wall_stays_within_its_range() {
    for reach in [1, 3] {
        let body = plate(reach);
        let full = vec![1.0; body.len()];
        let uneven = body.uneven_flow(1.0);
        let straight = [DVec2::X, DVec2::NEG_X, DVec2::new(1.0, -0.6)].map(|velocity| body.even_flow(velocity));
        for (peclet, advection) in
            [1.0, 10.0, 1e3].iter().flat_map(|peclet| BOUNDED.map(|advection| (peclet, advection)))
        {
            for flows in straight.iter().chain([&uneven.0]) {
                let mut solute = body.solute(plain(0.1 / peclet), &WALLS, advection, &full);
                // Water that gathers somewhere is not of interest here: contents follow the balance for a while.
                let pairs = &body.list.pairs;
                let gain = |i: usize| flows[pairs.starts[i]..pairs.starts[i + 1]].iter().sum::<f64>();
                let gains: Vec<f64> = (0..body.len()).map(gain).collect();
                let step = 0.3 / gains.iter().map(|gain| gain.abs()).fold(1e-3, f64::max);
                let last: Vec<f64> = gains.iter().map(|gain| 1.0 + step * gain).collect();
                solute.take(&Interval { start: 0.0, step, flows, contents: (&full, &last) });
                let (least, most) = range(&body, solute, (200.0, step), |i, time| 1.0 + time * gains[i]);
                assert!(least > -1e-12 && most < 1.0 + 1e-12, "{advection:?} {reach} {peclet}: {least} {most}");
            }
        }
    }
}

/// Weights and water by volume of unequal particles.
#[test]
fn unequal_particles_exchange_what_they_hold() {
    let mut body = Body::line(1.0, 30, 3);
    let domain = Domain::Radial { symmetry: Symmetry::Spherical, inner: 0.2, outer: 1.2 };
    let mut flows = body.even_flow(DVec2::X);
    let volumes = Volumes::new(&domain, &body.lattice, false);
    let row_of: Vec<usize> = body.arms().iter().map(|(i, _)| *i).collect();
    for (k, i) in row_of.iter().enumerate() {
        body.list.pairs.weights[k] /= volumes.of(*i);
        flows[k] /= volumes.of(*i);
    }
    body.list.volumes = volumes;
    for (peclet, advection) in [0.1, 10.0].iter().flat_map(|peclet| ALL.map(|advection| (peclet, advection))) {
        let full = vec![1.0; body.len()];
        let mut solute = body.solute(plain(0.03 / peclet), &[Some(1.0), None, None, None], advection, &full);
        steady(&mut solute, &flows, &full);
        let step = solute.facts().bound.step;
        let mut particles = body.particles(vec![0.0; body.len()]);
        let mut solver = Heun::new(Box::new(solute), 1.0, body.len());
        run(&mut solver, &mut particles, (step, 1e3 * step), |_, _| {});
        let (held, booked) =
            (particles.integral(|i| particles.enthalpy[i]), solver.ledger().heat().iter().sum::<f64>());
        assert!(held > 0.0 && (held - booked).abs() < 1e-12 * held, "{advection:?} {peclet}: {held} {booked}");
    }
}

/// What one material keeps back, pairs with it do not pass, and images in closed walls conduct like what they mirror.
#[test]
fn a_material_without_diffusion_passes_nothing() {
    let mut body = plate(3);
    let is_tight = |place: &DVec2| place.x > 0.5 && place.x < 0.7;
    body.list.materials.of_particle = body.list.positions.iter().map(|place| u8::from(is_tight(place))).collect();
    let full = vec![1.0; body.len()];
    let walls = WALLS.map(|wall| wall.map(held)).to_vec();
    let materials = vec![plain(0.01), plain(0.0)];
    let list = body.list.clone();
    let solute = Solute::new(SoluteParts { list, materials, walls, advection: Advection::Limited }, &full);
    let solute = solute.expect("parts that fit");
    let step = solute.facts().bound.step;
    let mut particles = body.particles(vec![0.0; body.len()]);
    let mut solver = Heun::new(Box::new(solute), 1.0, body.len());
    run(&mut solver, &mut particles, (step, 20.0), |_, _| {});
    for (place, content) in body.list.positions.iter().zip(&particles.enthalpy) {
        assert!(!is_tight(place) || *content == 0.0, "{place} {content}");
    }
    let booked: f64 = solver.ledger().heat().iter().sum();
    let held = particles.integral(|i| particles.enthalpy[i]);
    assert!(held > 0.0 && (held - booked).abs() < 1e-12 * held, "{held} {booked}");
}

/// Walls as layers that hold one value keep the range too, and threads change nothing.
#[test]
fn layers_keep_the_range_on_any_number_of_threads() {
    let domain = Domain::Rectangle { width: 9.0, height: 5.0 };
    let mut body = Body::new(domain, 0.1, 3, [true, true, false, false], &[(WallId::Left, 2.0, 3.0)]);
    body.list.boundary.patches.iter_mut().for_each(|patch| patch.layers = true);
    let full = vec![1.0; body.len()];
    let flows = body.even_flow(DVec2::new(1.0, 0.2));
    let run = |threads: usize| {
        let mut list = body.list.clone();
        list.team = Team::new(threads).expect("threads");
        let walls = [Some(0.0), None, None, None, Some(1.0)].map(|wall| wall.map(held)).to_vec();
        let parts = SoluteParts { list, materials: vec![plain(0.01)], walls, advection: Advection::Limited };
        let mut solute = Solute::new(parts, &full).expect("parts that fit");
        steady(&mut solute, &flows, &full);
        let mut contents = vec![0.0; body.len()];
        let (mut least, mut most) = (0.0f64, 0.0f64);
        let step = solute.facts().bound.step;
        for index in 0..20 {
            let clock = Clock { time: index as f64 * step, step, index, turned: false };
            solute.advance(Update::Euler(&mut contents), &clock, &mut [0.0; 5]);
            least = contents.iter().copied().fold(least, f64::min);
            most = contents.iter().copied().fold(most, f64::max);
        }
        assert!(least > -1e-12 && most > 0.1 && most < 1.0 + 1e-12, "{least} {most}");
        contents
    };
    assert!(run(1) == run(3));
}

#[test]
fn parts_that_do_not_fit_are_named() {
    let body = plate(1);
    let parts = |walls: usize, materials: Vec<SoluteMaterial>| SoluteParts {
        list: body.list.clone(),
        materials,
        walls: vec![Some(held(1.0)); walls],
        advection: Advection::Limited,
    };
    let full = vec![1.0; body.len()];
    let problem = |parts: SoluteParts| Solute::new(parts, &full).err().map(|error| error.to_string());
    let expected = "concentrations of 2 walls are given, and the body has 5";
    assert_eq!(problem(parts(2, vec![plain(1.0)])).as_deref(), Some(expected));
    assert_eq!(
        problem(parts(5, Vec::new())).as_deref(),
        Some("a particle has material 0, and 0 materials are described")
    );
    let expected = "wall bottom has a concentration, and nothing crosses it";
    assert_eq!(problem(parts(5, vec![plain(1.0)])).as_deref(), Some(expected));
}
