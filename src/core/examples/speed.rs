//! Particle updates a second of the lattice sweep.
#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::panic, unused_qualifications)]
use frazil_core::{
    boundary::Boundary, lattice::Lattice, lattice_operator::*, material::*, method::*, operator::Operator,
    potential::*, scene::*, stencil::Stencil,
};
use std::sync::Arc;
struct W(f64);
impl PairWeight for W {
    fn reach(&self) -> f64 {
        self.0
    }
    fn weight(&self, d: f64) -> f64 {
        1.0 / (d * d)
    }
}
fn main() {
    let one = std::env::args().count() > 1;
    for (n, threads, m) in if one {
        vec![(1000usize, 1usize, std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(3.0))]
    } else {
        vec![(1000usize, 1usize, 3.0), (1000, 2, 3.0), (1000, 1, 1.0), (1000, 1, 2.4), (1000, 1, 4.0), (3162, 1, 3.0)]
    } {
        let dx = 0.002;
        let domain = Domain::Rectangle { width: n as f64 * dx, height: n as f64 * dx };
        let lattice = Arc::new(Lattice::new(&domain, dx));
        let stencil = Stencil::from_weight(&W(m * dx), Normalisation::DiscreteMoment, dx, 2);
        let mat = Material {
            name: "w".into(),
            density: 1000.,
            frozen: Phase { conductivity: 2.14, heat_capacity: 2060. },
            unfrozen: Phase { conductivity: 0.6, heat_capacity: 4182. },
            freezing_point: 0.,
            latent_heat: 334000.,
            law: FreezingLaw::Isothermal,
            mixing: Mixing::Arithmetic,
        };
        let th = Thermal::new(Curve::new(&mat), 8.0);
        let scene = Scene {
            name: "".into(),
            title: "".into(),
            source: "".into(),
            units: Units::Si,
            time_unit: TimeUnit::Hour,
            domain,
            duration: 1.,
            materials: vec![mat],
            regions: vec![],
            initial_temperature: 8.,
            walls: vec![
                Wall { name: "left", condition: Condition::Temperature(Series::Constant(-20.)) },
                Wall { name: "right", condition: Condition::Symmetry },
                Wall { name: "bottom", condition: Condition::Symmetry },
                Wall { name: "top", condition: Condition::Symmetry },
            ],
            rings: vec![],
            watch: Watch { outputs: 1, profiles: vec![], probes: vec![], profile_length: None, front_from: 0. },
            reference: ReferenceChoice::Auto,
            methods: vec![],
            hash: "".into(),
        };
        let boundary = Boundary::new(&scene, WallModel::Mirror, None).unwrap();
        let pool =
            (threads > 1).then(|| Arc::new(rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()));
        let law = match &th.law {
            Law::Kinked(k) => *k,
            _ => panic!(),
        };
        let mut op = LatticeOperator::new(
            LatticeParts {
                lattice: lattice.clone(),
                stencil,
                thermal: th.clone(),
                boundary,
                sinks: vec![],
                rings: vec![],
                pool,
            },
            law,
        );
        let mut h: Vec<f64> = (0..lattice.len()).map(|i| -(((i * 7919) % 1000) as f64) * 5e5).collect();
        let dt = op.bound().step * 0.9;
        let mut doors = vec![0.0; op.doors().len()];
        let steps = if n > 2000 { 10 } else { 60 };
        let mut best: f64 = 0.0;
        for _ in 0..5 {
            let t = cpu_time::ThreadTime::now();
            for s in 0..steps {
                op.euler(&mut h, s as f64 * dt, dt, &mut doors);
            }
            best = best.max((steps * lattice.len()) as f64 / t.elapsed().as_secs_f64() / 1e6);
        }
        let s: f64 = h.iter().sum();
        println!("n {n} threads {threads} m {m}: {best:.0} M/s  bound {dt:.4} sum {s:e}");
    }
}
