//! Columns against closed forms.

use super::*;
use crate::physics::curve::Curve;
use crate::physics::freezing_curve::FreezingLaw;
use crate::physics::material::{Material, Phase};
use crate::physics::mixing::Mixing;
use crate::physics::thermal::Thermal;
use crate::solvers::balance::Balance;
use crate::solvers::control::EnthalpyRange;
use crate::solvers::heun::Heun;
use crate::solvers::implicit::Implicit;
use crate::solvers::rkl2::Rkl2;

/// Runs a column that starts empty behind a wall of concentration one, and gives concentrations at some times (s).
fn column(body: &Body, velocity: f64, material: SoluteMaterial, advection: Advection, times: &[f64]) -> Vec<Vec<f64>> {
    let flows = body.even_flow(DVec2::new(velocity, 0.0));
    let full = vec![1.0; body.len()];
    let mut solute = body.solute(material, &[Some(1.0), None, None, None], advection, &full);
    steady(&mut solute, &flows, &full);
    let step = solute.facts().bound.step;
    let mut particles = body.particles(vec![0.0; body.len()]);
    let mut solver = Heun::new(Box::new(solute), 1.0, body.len());
    let (mut found, mut now, mut index) = (Vec::new(), 0.0, 0);
    for time in times {
        let steps = ((time - now) / step).ceil();
        for _ in 0..steps as u64 {
            let clock = Clock { time: now, step: (time - now).min(step), index, turned: index == 0 };
            now += (&mut solver as &mut dyn Solver).advance(&mut particles, &clock).expect("a step");
            index += 1;
        }
        let holds = 1.0 + material.sorption;
        found.push(particles.enthalpy.iter().map(|content| content / holds).collect());
    }
    found
}

/// Root of the mean square, and the greatest, of what separates a column from a closed form.
fn errors(body: &Body, found: &[f64], exact: impl Fn(f64) -> f64) -> (f64, f64) {
    let differences = body.list.positions.iter().zip(found).map(|(place, found)| (found - exact(place.x)).abs());
    let (sum, most) = differences.fold((0.0, 0.0f64), |(sum, most), d| (sum + d * d, most.max(d)));
    ((sum / found.len() as f64).sqrt(), most)
}

#[test]
fn a_retarded_and_decaying_solute_follows_the_closed_form() {
    for reach in [1, 3] {
        for advection in [Advection::Limited, Advection::Fitted, Advection::Central] {
            let body = Body::line(2.0, 200, reach);
            let material = SoluteMaterial { sorption: 0.5, decay: 0.2, ..plain(0.02) };
            let found = column(&body, 0.5, material, advection, &[1.5]);
            let (rms, most) = errors(&body, &found[0], |x| half_space(x, 1.5, 0.5, 0.02, 1.5, 0.2));
            assert!(most < 0.01, "{advection:?} {reach}: {rms} {most}");
        }
    }
}

#[test]
fn a_column_at_a_cell_peclet_number_of_one() {
    for reach in [1, 3] {
        for advection in ALL {
            let body = Body::line(10.0, 1000, reach);
            let found = column(&body, 1.0, plain(0.01), advection, &[3.0]);
            let (rms, most) = errors(&body, &found[0], |x| half_space(x, 3.0, 1.0, 0.01, 1.0, 0.0));
            assert!(rms < 0.01 || advection != Advection::Limited, "{reach}: {rms} {most}");
        }
    }
}

#[test]
fn a_column_in_which_diffusion_rules() {
    for reach in [1, 3] {
        for advection in ALL {
            let body = Body::line(20.0, 400, reach);
            let found = column(&body, 1.0, plain(1.0), advection, &[1.0, 2.0, 3.0]);
            for (found, time) in found.iter().zip([1.0, 2.0, 3.0]) {
                let within = found.len() / 2;
                let exact = |x: f64| half_space(x, time, 1.0, 1.0, 1.0, 0.0);
                let (rms, most) = errors(&body, &found[..within], exact);
                assert!(rms < 0.005 || advection == Advection::Upwind, "{advection:?} {reach}: {rms} {most}");
            }
        }
    }
}

#[test]
fn smooth_profiles_are_met_to_second_order() {
    for (reach, advection) in
        [1, 3].iter().flat_map(|reach| [Advection::Limited, Advection::Central, Advection::Fitted].map(|a| (*reach, a)))
    {
        let error = |cells: usize| {
            let body = Body::line(4.0, cells, reach);
            let (velocity, diffusion, end) = (1.0, 0.03, 1.0);
            let exact = |x: f64, t: f64| {
                let width = 0.04 + 2.0 * diffusion * t;
                (0.04 / width).sqrt() * (-(x - 1.3 - velocity * t).powi(2) / (2.0 * width)).exp()
            };
            let full = vec![1.0; body.len()];
            let mut solute = body.solute(plain(diffusion), &[Some(0.0), None, None, None], advection, &full);
            steady(&mut solute, &body.even_flow(DVec2::X), &full);
            let mut particles = body.particles(body.list.positions.iter().map(|place| exact(place.x, 0.0)).collect());
            let step = solute.facts().bound.step;
            let mut solver = Heun::new(Box::new(solute), 1.0, body.len());
            run(&mut solver, &mut particles, (step, end), |_, _| {});
            errors(&body, &particles.enthalpy, |x| exact(x, end)).0
        };
        let found = [100, 200, 400, 800].map(error);
        let orders: Vec<f64> = found.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
        assert!(orders[2] >= 1.8, "{advection:?} {reach}: {found:?} {orders:?}");
    }
}

/// What holds one for a temperature of one: steps by error measure contents as they measure enthalpies.
fn unit() -> Thermal {
    let phase = Phase { conductivity: 1.0, heat_capacity: 1.0 };
    let material = Material {
        name: "solute".into(),
        density: 1.0,
        frozen: phase,
        unfrozen: phase,
        freezing_point: 0.0,
        latent_heat: 0.0,
        law: FreezingLaw::None,
        mixing: Mixing::Arithmetic,
        pores: None,
        soil: None,
    };
    Thermal::new(Curve::new(&material), 0.0)
}

/// Long steps make the same of a column as short ones.
#[test]
fn long_steps_agree_with_short_ones() {
    for advection in [Advection::Limited, Advection::Fitted, Advection::Central, Advection::Upwind] {
        let body = Body::line(4.0, 100, 3);
        let short = column(&body, 0.5, plain(0.1), advection, &[2.0]).remove(0);
        let full = vec![1.0; body.len()];
        let solute = || {
            let walls = [Some(1.0), None, None, None];
            let mut solute = body.solute(plain(0.1), &walls, advection, &full);
            steady(&mut solute, &body.even_flow(DVec2::new(0.5, 0.0)), &full);
            Box::new(solute)
        };
        let range =
            || EnthalpyRange::new(&Materials::new(Arc::new([unit()]), Vec::new()), (0.0, 1.0), Vec::new(), (false, 0));
        let mut long: [Box<dyn Solver>; 2] = [
            Box::new(Rkl2::controlled(solute(), 20, 1e-5, range(), body.len())),
            Box::new(Implicit::new(solute(), 1e-5, range(), 1.0, body.len())),
        ];
        for solver in &mut long {
            let mut particles = body.particles(vec![0.0; body.len()]);
            let (mut now, mut index) = (0.0, 0);
            while now < 2.0 {
                let step = solver.wanted_step().min(2.0 - now);
                let clock = Clock { time: now, step, index, turned: index == 0 };
                now += solver.advance(&mut particles, &clock).expect("a step");
                index += 1;
            }
            let most = particles.enthalpy.iter().zip(&short).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(most < 1e-3, "{advection:?} {most}");
        }
    }
}
