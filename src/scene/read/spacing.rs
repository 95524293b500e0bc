//! The spacing of particles, beside the body that they fill.

use frazil_core::kernels::sweep::WIDEST;
use frazil_core::space::domain::Domain;

use super::range::plain;
use super::section::Section;

/// The key of the spacing.
pub(super) const KEY: (&str, &str) = ("spacing", "m");

/// Particles that one run may have.
const MOST_PARTICLES: f64 = 1e8;
/// A length is a whole number of spacings if it is so to this relative tolerance.
const WHOLE: f64 = 1e-6;
/// Numbers of particles that are tried for one that fills a domain.
const SEARCHED: usize = 100_000;

/// Extents of a domain (m) that a lattice fills; of a ring its radius.
fn extents(domain: &Domain) -> Vec<f64> {
    match *domain {
        Domain::Line { length } => vec![length],
        Domain::Rectangle { width, height } => vec![width, height],
        Domain::Ring { outer_radius, .. } => vec![outer_radius],
        Domain::Radial { inner, outer, .. } => vec![outer - inner],
        Domain::Axial { inner, outer, height } => vec![outer - inner, height],
    }
}

fn shortest(domain: &Domain) -> f64 {
    extents(domain).into_iter().fold(f64::INFINITY, f64::min)
}

/// Refuses a spacing (m) with which pairs reach beyond the domain.
pub(super) fn reaches(section: &mut Section<'_>, spacing: f64, reach: f64, domain: &Domain) {
    let shortest = shortest(domain);
    if reach > shortest * (1.0 + WHOLE) {
        let message = format!(
            "found {}, for which the reach of pairs is {}, must be at most {}, the shortest extent of the domain",
            plain(spacing),
            plain(reach),
            plain(shortest)
        );
        section.problem(KEY, message);
    }
}

/// Whether pairs of some reach (m) have room in the domain and a compiled sweep.
pub(super) fn has_room(domain: &Domain, spacing: f64, reach: f64) -> bool {
    reach <= shortest(domain) && (reach / spacing).ceil() <= WIDEST as f64
}

/// Whether the spacing fits the domain; if not, a problem that names the nearest that does.
pub(super) fn divides(section: &mut Section<'_>, spacing: f64, domain: &Domain) -> bool {
    let (extents, round) = (extents(domain), matches!(domain, Domain::Ring { .. }));
    let particles = domain.size() / spacing.powi(domain.dimension() as i32);
    if particles.is_nan() || particles > MOST_PARTICLES {
        let message = format!(
            "found {}, which makes {particles:.1e} particles, must make at most {MOST_PARTICLES:.0e}",
            plain(spacing)
        );
        section.problem(KEY, message);
        return false;
    }
    let longest_allowed = shortest(domain);
    if round && spacing > longest_allowed {
        let message = format!("found {}, must be at most the outer radius {}", plain(spacing), plain(longest_allowed));
        section.problem(KEY, message);
        return false;
    }
    if round || extents.iter().all(|extent| is_whole(extent / spacing)) {
        return true;
    }
    let lengths: Vec<String> = extents.iter().map(|extent| plain(*extent)).collect();
    let nearest = match nearest_spacings(spacing, &extents).as_slice() {
        [] => "there is none near it".to_owned(),
        [only] => format!("the nearest is {}", plain(*only)),
        [below, above, ..] => format!("the nearest are {} and {}", plain(*below), plain(*above)),
    };
    let message =
        format!("found {}, must divide {} into whole parts: {nearest}", plain(spacing), lengths.join(" and "));
    section.problem(KEY, message);
    false
}

fn is_whole(parts: f64) -> bool {
    let count = parts.round();
    count >= 1.0 && (parts - count).abs() <= WHOLE * count
}

/// The greatest spacing (m) up to one that a lattice fills the domain with.
pub fn at_most(domain: &Domain, spacing: f64) -> Option<f64> {
    let extents = extents(domain);
    let first = extents[0];
    let count = (first / spacing * (1.0 - WHOLE)).ceil().max(1.0);
    let fits = |count: &f64| extents.iter().all(|extent| is_whole(extent * count / first));
    (0..SEARCHED).map(|more| count + more as f64).find(fits).map(|count| first / count)
}

/// The nearest spacing below and above, where there are any, that divides all extents.
fn nearest_spacings(spacing: f64, extents: &[f64]) -> Vec<f64> {
    let first = extents[0];
    let count = (first / spacing).floor();
    let fits = |count: &f64| *count >= 1.0 && extents.iter().all(|extent| is_whole(extent * count / first));
    let below = (1..=SEARCHED).map(|more| count + more as f64).find(fits);
    let above = (0..=SEARCHED).map(|fewer| count - fewer as f64).take_while(|count| *count >= 1.0).find(fits);
    below.into_iter().chain(above).map(|count| first / count).collect()
}
