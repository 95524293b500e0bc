//! Properties of fluids that move.

use super::*;

fn fluid<const D: usize>(lengths: [f64; D], step: f64, threads: usize) -> Fluid<D> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    // In space at a smaller cut-off: as many partners as in the plane.
    let reach = if D == 2 { 1.96 } else { 1.5 };
    let parameters = Parameters {
        step,
        conservative_cutoff: reach,
        dissipative_cutoff: reach,
        thermal_cutoff: reach,
        ..Parameters::water()
    };
    Fluid::new(parameters, lengths, 1.0, 3, (threads > 1).then(|| Arc::new(pool))).expect("a fluid")
}

/// Energy, momentum and temperatures over some time units, at a step.
fn equilibrium<const D: usize>(lengths: [f64; D], step: f64) {
    let mut fluid = fluid(lengths, step, 1);
    fluid.advance(500, &Undriven).expect("steps");
    let energy = |totals: &Totals<D>| totals.kinetic + totals.heat + totals.potential;
    let start = fluid.totals();
    let (mut kinetic, mut internal) = (0.0, 0.0);
    let samples = 60;
    for _ in 0..samples {
        fluid.advance(20, &Undriven).expect("steps");
        let totals = fluid.totals();
        kinetic += totals.kinetic_temperature / f64::from(samples);
        internal += totals.internal_temperature / f64::from(samples);
    }
    let end = fluid.totals();
    let count = fluid.particles().len() as f64;
    // Rounding of some 1e5 changes of heats of order 1 to 100 for each particle.
    let drift = (energy(&end) - energy(&start)) / (count * fluid.parameters().heat_capacity);
    assert!(drift.abs() < 1e-15, "{drift:e}");
    for momentum in end.momentum {
        assert!(momentum.abs() < 1e-10, "{momentum:e}");
    }
    // Four standard errors: independent samples of D N degrees of freedom would give root(2/(D N 60)); the step adds its
    // square, 0.1 % at 0.007.
    let error = 4.0 * (2.0 / (D as f64 * count * f64::from(samples))).sqrt() + 0.002 * (step / 0.007).powi(2);
    assert!((kinetic / internal - 1.0).abs() < error, "{kinetic} {internal} {error}");
}

#[test]
fn energy_and_momentum_are_kept_and_both_temperatures_agree() {
    equilibrium([16.0, 18.0], 0.007);
    equilibrium([7.0, 8.0, 7.5], 0.007);
}

#[test]
fn three_times_the_step_is_no_harm() {
    equilibrium([16.0, 18.0], 0.021);
    equilibrium([7.0, 8.0, 7.5], 0.021);
}

#[test]
fn threads_do_not_matter() {
    let state = |threads: usize| {
        let mut fluid = fluid([20.0, 33.0], 0.007, threads);
        fluid.change(|particle| particle.heat = 1e4 * (particle.position[0] / 20.0 - 0.5));
        fluid.advance(200, &Undriven).expect("steps");
        let particles = fluid.particles().iter();
        particles
            .map(|p| (p.name, p.position.map(f64::to_bits), p.velocity.map(f64::to_bits), p.heat.to_bits()))
            .collect()
    };
    let one: Vec<_> = state(1);
    for threads in 2..=4 {
        assert!(one == state(threads), "{threads} threads");
    }
}

/// A processor with narrower vectors makes the same, to the last bit.
#[test]
fn instruction_sets_do_not_matter() {
    use frazil_core::instruction_set::{self, InstructionSet};

    fn check<const D: usize>(lengths: [f64; D]) {
        let state = |widest| {
            instruction_set::limit(widest);
            let mut fluid = fluid(lengths, 0.007, 1);
            fluid.change(|particle| {
                particle.heat = 1e4 * (particle.position[0] / lengths[0] - 0.5);
                // Some stand still.
                particle.mobility = if particle.name % 7 == 0 { 0.0 } else { 1.0 };
                particle.velocity = particle.velocity.map(|along| along * particle.mobility);
            });
            fluid.advance(100, &Undriven).expect("steps");
            instruction_set::limit(InstructionSet::Avx512);
            let bits = |p: &Particle<D>| {
                (p.name, p.position.map(f64::to_bits), p.velocity.map(f64::to_bits), p.heat.to_bits())
            };
            fluid.particles().iter().map(bits).collect::<Vec<_>>()
        };
        let portable = state(InstructionSet::Portable);
        for widest in [InstructionSet::Avx2, InstructionSet::Avx512] {
            assert!(portable == state(widest), "{widest}");
        }
    }
    check([16.0, 15.0]);
    check([7.0, 6.5, 7.5]);
}

/// Cells and slabs leave out no pair and take none twice: the potential is that of all pairs.
#[test]
fn every_pair_is_met_once() {
    fn check<const D: usize>(lengths: [f64; D]) {
        let mut fluid = fluid(lengths, 0.007, 1);
        fluid.advance(37, &Undriven).expect("steps");
        let (mut potential, mut force) = (0.0, [0.0; D]);
        let reach = fluid.parameters().conservative_cutoff;
        let strength = fluid.parameters().repulsion;
        let probe = fluid.particles()[0].name;
        for (k, a) in fluid.particles().iter().enumerate() {
            for b in &fluid.particles()[k + 1..] {
                let mut way = [0.0; D];
                for axis in 0..D {
                    let plain = a.position[axis] - b.position[axis];
                    way[axis] = plain - lengths[axis] * (plain / lengths[axis]).round();
                }
                let distance = way.iter().map(|w| w * w).sum::<f64>().sqrt();
                let near = (1.0 - distance / reach).max(0.0);
                potential += 0.5 * strength * reach * near * near;
                if a.name == probe {
                    (0..D).for_each(|axis| force[axis] += strength * near * way[axis] / distance);
                }
            }
        }
        let found = fluid.totals().potential;
        assert!((found / potential - 1.0).abs() < 1e-12, "{found} {potential}");
        for axis in 0..D {
            assert!((fluid.particles()[0].force[axis] - force[axis]).abs() < 1e-9);
        }
    }
    check([9.0, 8.0]);
    check([9.0, 14.5]);
    check([6.0, 6.5, 9.0]);
}

/// Heat spreads as fast as the continuum limit says, in a sine along the box.
#[test]
fn heat_spreads_at_the_diffusivity_of_the_weight() {
    let mut fluid = fluid([24.0, 12.0], 0.007, 1);
    fluid.advance(300, &Undriven).expect("steps");
    let wave = 2.0 * std::f64::consts::PI / 24.0;
    let amplitude = |fluid: &Fluid<2>| {
        let particles = fluid.particles().iter();
        let sums = particles.map(|p| [p.heat * (wave * p.position[0]).sin(), (wave * p.position[0]).sin().powi(2)]);
        let [heat, weight] = sums.fold([0.0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
        heat / weight
    };
    // Far above the noise of heat, root(C_v) = 316 for a particle.
    fluid.change(|particle| particle.heat = 1e4 * (wave * particle.position[0]).sin());
    let start = amplitude(&fluid);
    fluid.advance(600, &Undriven).expect("steps");
    let rate = (start / amplitude(&fluid)).ln() / (600.0 * 0.007);
    let expected = fluid.parameters().constants(2).thermal_diffusivity(fluid.parameters().heat_friction) * wave * wave;
    // The relaxed fluid conducts 0.994 of the mean field; particles carry heat as they diffuse, below 1 %; the amplitude is
    // known to 316 root(2/1152)/1e4, 0.13 %, of a decay by 27 %.
    assert!((rate / expected - 1.0).abs() < 0.02, "{rate} {expected}");
}

#[test]
fn constants_that_mean_nothing_are_refused() {
    let refused = |parameters: Parameters, lengths| {
        Fluid::<2>::new(parameters, lengths, 1.0, 1, None)
            .map(|_| String::new())
            .unwrap_or_else(|wrong| wrong.to_string())
    };
    let water = Parameters::water;
    let found = refused(Parameters { exponent: Exponent::Constant(-0.1), ..water() }, [20.0, 20.0]);
    assert_eq!(found, "exponent: found -0.1, must be at least 0: friction would grow towards the cut-off");
    let found = refused(Parameters { step: 0.0, ..water() }, [20.0, 20.0]);
    assert_eq!(found, "step: found 0, must be above 0");
    let found = refused(water(), [5.0, 20.0]);
    assert!(found.starts_with("a periodic box of length 5 is too small: it must be at least 6.762 long"), "{found}");
}

/// One particle that leaves the numbers ends the run, whichever it is.
#[test]
fn a_place_that_is_no_number_is_told() {
    for name in [0, 17] {
        let mut fluid = fluid([12.0, 12.0], 0.01, 1);
        fluid.change(|particle| {
            if particle.name == name {
                particle.velocity = [f64::NAN; 2];
            }
        });
        let told = fluid.advance(1, &Undriven);
        assert!(matches!(told, Err(FluidError::TooLong { .. })), "{told:?}");
    }
}
