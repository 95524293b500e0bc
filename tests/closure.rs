//! When the gaps of an even ring close, wherever it stands on the lattice.

use std::f64::consts::TAU;
use std::ops::Range;

use frazil_layouts::answers::DAY;
use frazil_record::RunResult;
use frazil_simulation::march::{self, Options};

use crate::sketch::bundled;

const METHODS: [&str; 3] = ["local", "sph", "pd"];

/// The ring of `frozen-wall-sand` until its gaps have closed. The ground beyond 8 m does not feel it before.
const UNTIL_CLOSED: [(&str, &str); 4] = [
    ("domain.ring.outer_radius_m", "8"),
    ("time.duration_days", "17"),
    ("time.profiles_days", "[17]"),
    ("reference.kind", "\"none\""),
];

/// How rings are run: the spacing (m), the integrator, and other keys of the method.
#[derive(Debug, Clone, Copy)]
struct Numerics<'a> {
    spacing: f64,
    integrator: &'a str,
    weights: &'a [(&'a str, &'a str)],
}

/// With the weights that the method has by default.
fn by_default(spacing: f64, integrator: &str) -> Numerics<'_> {
    Numerics { spacing, integrator, weights: &[] }
}

/// The ring of `frozen-wall-sand`, turned (radians) and moved (m), until its gaps have closed.
fn run(method: &str, numerics: Numerics<'_>, turn: f64, moved: (f64, f64)) -> RunResult {
    let place = |k: usize| {
        let angle = turn + TAU * k as f64 / 26.0;
        format!("[{}, {}]", 5.0 * angle.cos() + moved.0, 5.0 * angle.sin() + moved.1)
    };
    let places: Vec<String> = (0..26).map(place).collect();
    let pipes = format!("[{{ places_m = [{}], pipe_radius_m = 0.054, temperature_c = -20 }}]", places.join(", "));
    let ring = [("pipes", pipes.as_str()), ("domain.ring.sector", "\"whole\"")];
    let spacing = numerics.spacing.to_string();
    let own = [&[("spacing_m", spacing.as_str()), ("integrator", numerics.integrator)], numerics.weights].concat();
    let own: Vec<_> = own.into_iter().map(|(key, value)| (format!("method.{method}.{key}"), value)).collect();
    let own: Vec<_> = own.iter().map(|(key, value)| (key.as_str(), *value)).collect();
    let scene = bundled("frozen-wall-sand", &[&UNTIL_CLOSED[..], &ring, &own].concat());
    let result = march::run(&scene, method, None, &Options::default()).expect("a run");
    assert_eq!(result.links.len(), 26);
    result
}

/// The table's day, by finite volumes on a mesh that fits the pipes, and how well it knows it.
const DAY_OF_TABLE: f64 = 15.398;
const ERROR_OF_TABLE: f64 = 0.002;

/// Days on which all gaps of some of 26 rings close, and the least time (s) of their runs.
fn days(method: &str, numerics: Numerics<'_>, rings: Range<usize>) -> (Vec<f64>, f64) {
    let (mut days, mut least) = (Vec::new(), f64::INFINITY);
    for ring in rings {
        // Turned by up to a gap, and moved by up to a spacing, evenly and not alike.
        let part = |step: f64| (0.5 + step * ring as f64).fract() - 0.5;
        let moved = (numerics.spacing * part(0.754_878), numerics.spacing * part(0.569_84));
        let result = run(method, numerics, TAU / 26.0 * part(0.618_034), moved);
        days.extend(result.links.iter().map(|link| link.closure_s.expect("closed") / DAY));
        least = least.min(result.record.solve_wall_s);
    }
    (days, least)
}

/// Days of gaps over the table's: the least and the greatest, their mean, and their root mean square about it.
#[derive(Debug, Clone, Copy)]
struct Spread {
    least: f64,
    greatest: f64,
    mean: f64,
    scatter: f64,
}

impl Spread {
    fn of(days: &[f64]) -> Self {
        let off: Vec<f64> = days.iter().map(|day| day / DAY_OF_TABLE - 1.0).collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        let square = off.iter().map(|off| (off - mean).powi(2)).sum::<f64>() / off.len() as f64;
        Spread {
            least: off.iter().copied().fold(f64::INFINITY, f64::min),
            greatest: off.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            mean,
            scatter: square.sqrt(),
        }
    }

    /// Prints it in percent, of runs that take a time (s) each.
    fn print(&self, method: &str, Numerics { spacing, integrator, weights }: Numerics<'_>, time: f64) {
        let [least, greatest, mean, scatter] =
            [self.least, self.greatest, self.mean, self.scatter].map(|part| 100.0 * part);
        eprintln!(
            "{method}, {spacing} m, {integrator}, {weights:?}: gaps {least:+.2} to {greatest:+.2} % off, mean {mean:+.2}, scatter {scatter:.2} %; {time:.3} s"
        );
    }
}

/// Each gap closes within 1 % of the table's day, as far as that is known.
fn each_gap_is_right(method: &str, numerics: Numerics<'_>, rings: Range<usize>) {
    let (days, time) = days(method, numerics, rings);
    let spread = Spread::of(&days);
    spread.print(method, numerics, time);
    let within = 0.01 + ERROR_OF_TABLE;
    assert!(spread.least.abs().max(spread.greatest.abs()) <= within, "{method}, {numerics:?}: {spread:?}");
}

#[test]
fn each_gap_of_a_ring_closes_on_the_day_of_the_table_wherever_it_stands() {
    // One that is turned and moved; the others are in the tests below.
    METHODS.iter().for_each(|method| each_gap_is_right(method, by_default(0.04, "euler"), 1..2));
}

fn each_gap_of_26_rings_is_right(method: &str) {
    each_gap_is_right(method, by_default(0.04, "euler"), 0..26);
    each_gap_is_right(method, by_default(0.04, "rkl2"), 0..26);
}

#[test]
#[ignore = "minutes"]
fn each_gap_of_26_rings_closes_on_the_day_of_the_table_under_local() {
    each_gap_of_26_rings_is_right("local");
}

#[test]
#[ignore = "minutes"]
fn each_gap_of_26_rings_closes_on_the_day_of_the_table_under_sph() {
    each_gap_of_26_rings_is_right("sph");
}

#[test]
#[ignore = "minutes"]
fn each_gap_of_26_rings_closes_on_the_day_of_the_table_under_pd() {
    each_gap_of_26_rings_is_right("pd");
}

/// Weights that reach to the eight nearest particles and scatter least by the direction of a gap.
const SHORT: [(&str, Numerics<'_>); 3] = [
    ("local", Numerics { spacing: 0.09, integrator: "rkl2", weights: &[] }),
    ("sph", Numerics { spacing: 0.075, integrator: "rkl2", weights: &[("smoothing_ratio", "1")] }),
    (
        "pd",
        Numerics {
            spacing: 0.075,
            integrator: "rkl2",
            weights: &[("horizon_ratio", "2"), ("influence", "\"triangular\"")],
        },
    ),
];

#[test]
fn each_gap_of_26_rings_is_right_on_a_coarse_lattice() {
    for (method, numerics) in SHORT {
        each_gap_is_right(method, numerics, 0..26);
    }
    // With the weights that methods have by default.
    for (method, spacing) in [("local", 0.08), ("sph", 0.08), ("pd", 0.05)] {
        each_gap_is_right(method, by_default(spacing, "rkl2"), 0..26);
    }
}

/// Adaptive steps, of which each reaches over many of Euler's, are short enough where fronts are about to meet: gaps close in the mean on
/// Euler's day, to a quarter of what is known of it.
#[test]
fn adaptive_steps_come_near_to_a_closure() {
    let mean_day = |integrator: &str| {
        let own = [("method.local.spacing_m", "0.03"), ("method.local.integrator", integrator)];
        let scene = bundled("frozen-wall-sand", &[&UNTIL_CLOSED[..], &own].concat());
        let links = march::run(&scene, "local", None, &Options::default()).expect("a run").links;
        let days: Vec<f64> = links.iter().map(|link| link.closure_s.expect("closed") / DAY).collect();
        days.iter().sum::<f64>() / days.len() as f64
    };
    let [euler, rkl2] = ["euler", "rkl2"].map(mean_day);
    eprintln!("mean day of closure: {euler:.4} with Euler's steps, {rkl2:.4} with adaptive ones");
    assert!((rkl2 / euler - 1.0).abs() < 0.25 * ERROR_OF_TABLE, "{euler} {rkl2}");
}

/// Gaps of a ring close the more alike the less weights reach beyond the eight nearest particles: with `sph` least alike at the widest
/// reach, with `pd` most alike where weights fall to nothing at two spacings, and least where they are constant up to there.
#[test]
#[ignore = "minutes"]
fn weights_scatter_gaps_by_their_reach() {
    let scatter = |method: &str, weights: &[(&str, &str)]| {
        let numerics = Numerics { spacing: 0.1, integrator: "rkl2", weights };
        let (days, time) = days(method, numerics, 0..26);
        let spread = Spread::of(&days);
        spread.print(method, numerics, time);
        spread.scatter
    };
    scatter("local", &[]);
    let [widest, usual, short] = ["1.5", "1.2", "1"].map(|ratio| scatter("sph", &[("smoothing_ratio", ratio)]));
    assert!(short < widest && usual < widest);
    let of_pd = |influence, ratio| scatter("pd", &[("horizon_ratio", ratio), ("influence", influence)]);
    let [long, short] = ["3", "2"].map(|ratio| of_pd("\"triangular\"", ratio));
    let [constant, worst] = ["3", "2"].map(|ratio| of_pd("\"constant\"", ratio));
    let parabolic = ["3", "2"].map(|ratio| of_pd("\"parabolic\"", ratio));
    assert!(short < long && parabolic[1] < parabolic[0] && long < constant && constant < worst);
}

/// Gaps that symmetry makes equal are told as one: the closure is their mean, of which a coarse lattice tells less than 2 % wrong.
#[test]
fn an_even_ring_closes_with_the_mean_of_its_gaps() {
    for method in METHODS {
        let links = run(method, by_default(0.1, "euler"), 0.1, (0.0, 0.0)).links;
        let own: Vec<f64> = links.iter().map(|link| link.closure_s.expect("closed")).collect();
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        assert!((mean / (DAY_OF_TABLE * DAY) - 1.0).abs() < 0.02, "{method}: {}", mean / DAY);
        for link in &links {
            assert_eq!(link.alike, 1);
            let told = link.closure_alike_s.expect("all have closed");
            assert!((told / mean - 1.0).abs() < 1e-12, "{method}: {told} {mean}");
        }
        // Moved, it is no ring about the centre any more.
        let moved = run(method, by_default(0.2, "euler"), 0.1, (0.03, 0.01)).links;
        assert!(moved.iter().enumerate().all(|(k, link)| link.alike == k + 1));
    }
}

/// Time (s) at which so much (m) of a slab of water of 0.12 m is frozen, from both sides, in so many particles.
fn slab_frozen(method: &str, frozen: f64, particles: usize) -> f64 {
    let spacing = format!("{}", 0.12 / particles as f64);
    let own = ["spacing_m", "integrator"].map(|key| format!("method.{method}.{key}"));
    let changes = [
        ("domain.line.length_m", "0.12"),
        ("walls.right.temperature_c", "-20"),
        ("watch.profile_length_m", "0.12"),
        ("time.duration_h", "4.4"),
        ("time.outputs", "1000"),
        ("time.profiles_h", "[4.4]"),
        ("reference.kind", "\"none\""),
        (own[0].as_str(), spacing.as_str()),
        (own[1].as_str(), "\"euler\""),
    ];
    let scene = bundled("stefan-water", &changes);
    let rows = march::run(&scene, method, None, &Options::default()).expect("a run").front;
    let pair = rows.windows(2).find(|pair| pair[0].front_m < frozen && pair[1].front_m >= frozen).expect("frozen");
    let part = (frozen - pair[0].front_m) / (pair[1].front_m - pair[0].front_m);
    pair[0].time_s + part * (pair[1].time_s - pair[0].time_s)
}

/// Two fronts come near each other as late on a coarse line as on a fine one, where they meet on a face between particles (even numbers)
/// or in one (odd): by heat alone they would be 0.6 % early, and under `pd` 0.4 and 0.9 % later than while they are apart if pairs
/// longer than what is left between them knew but one.
#[test]
fn fronts_of_a_slab_come_near_in_time() {
    let fronts = [0.09, 0.11, 0.115, 0.118];
    let fine = fronts.map(|frozen| slab_frozen("local", frozen, 160));
    for (method, several) in [("local", [10, 11]), ("sph", [10, 11]), ("pd", [20, 21])] {
        for particles in several {
            let off = |which: usize| slab_frozen(method, fronts[which], particles) / fine[which] - 1.0;
            let apart = off(0);
            for (which, frozen) in fronts.iter().enumerate() {
                let off = off(which);
                eprintln!("{method}, {particles} particles, {frozen} m frozen: {:.3} % off", 100.0 * off);
                assert!((off - apart).abs() < 2.5e-3, "{method}, {particles} particles, {frozen} m: {off}, {apart}");
                assert!(method == "pd" || off.abs() < 2.5e-3, "{method}, {particles} particles, {frozen} m: {off}");
            }
        }
    }
}
