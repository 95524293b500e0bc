//! Shells between naive walls: the same exchange on a body that is longer by the layers behind its open walls.

use crate::bonds::pair_list::PairList;
use crate::bonds::stencil::Stencil;
use crate::boundary::ghosts::Ghosts;
use crate::boundary::patch::Boundary;
use crate::boundary::shells::{Bonds, Exchange, ShellError};
use crate::space::domain::Domain;
use crate::space::lattice::Lattice;
use crate::space::volumes::Volumes;
use crate::space::wall::WallId;

/// Pairs of the shells of a domain with each other and with the layers behind walls that let heat through, or why there
/// are none. The layers take their values from [`crate::boundary::wall_layers::level`].
///
/// # Errors
/// A body without symmetry, weights that cannot be made positive, and layers that reach across the axis.
pub fn naive_shells(
    domain: &Domain,
    lattice: &Lattice,
    stencil: &Stencil,
    boundary: &Boundary,
) -> Result<Bonds, ShellError> {
    let Some(symmetry) = domain.symmetry() else { return Err(ShellError::NoSymmetry) };
    let (columns, rows, spacing) = (lattice.columns, lattice.rows, lattice.spacing);
    // A wall is open where any of its parts is; closed parts then have layers that take nothing.
    let is_open = |wall: WallId| {
        let mut patches = boundary.patches.iter().filter(|patch| patch.id.wall() == Some(wall));
        patches.any(|patch| patch.lets_heat_through())
    };
    let [left, right, below, above] = [WallId::Inner, WallId::Outer, WallId::Bottom, WallId::Top]
        .map(|wall| if is_open(wall) { stencil.reach } else { 0 });
    let (inner, outer) = domain.radii();
    let innermost = inner - left as f64 * spacing;
    if innermost < -1e-9 * spacing {
        return Err(ShellError::AcrossTheAxis(innermost));
    }
    let (innermost, outermost) = (innermost.max(0.0), outer + right as f64 * spacing);
    let longer = match *domain {
        Domain::Axial { height, .. } => {
            Domain::Axial { inner: innermost, outer: outermost, height: height + (below + above) as f64 * spacing }
        }
        _ => Domain::Radial { symmetry, inner: innermost, outer: outermost },
    };
    let longer = Lattice::new(&longer, spacing);
    let exchange = Exchange::positive(symmetry, &longer, stencil)?;
    let volumes = Volumes::new(domain, lattice, false);
    let mut ghosts = Ghosts::none();
    let mut index = Vec::with_capacity(longer.len());
    for row in 0..longer.rows {
        for column in 0..longer.columns {
            let (own, level) = (column.wrapping_sub(left), row.wrapping_sub(below));
            if own < columns && level < rows {
                index.push((level * columns + own) as u32);
                continue;
            }
            // The nearest particle; at corners inner and outer walls go first, as mirrors do.
            let (near, at) = (column.clamp(left, left + columns - 1), row.clamp(below, below + rows - 1));
            let (near, at) = (near - left, at - below);
            let (wall, along) = if column < left {
                (WallId::Inner, (at as f64 + 0.5) * spacing)
            } else if own >= columns {
                (WallId::Outer, (at as f64 + 0.5) * spacing)
            } else {
                (if row < below { WallId::Bottom } else { WallId::Top }, inner + (near as f64 + 0.5) * spacing)
            };
            let Some(whole) = boundary.whole(wall) else {
                return Err(ShellError::NoWall(wall));
            };
            let patch = boundary.patch_at(whole, along) as u8;
            index.push((lattice.len() + ghosts.len()) as u32);
            let mut place = longer.centre(column as i64, row as i64);
            place.y -= below as f64 * spacing;
            ghosts.hold(lattice.len(), (at * columns + near) as u32, place, patch);
        }
    }
    let mut pairs = PairList { starts: vec![0], ..PairList::default() };
    for row in below..below + rows {
        for column in left..left + columns {
            let volume = volumes.of((row - below) * columns + column - left);
            exchange.with_partners((column, row), |(other, above), strength| {
                pairs.partners.push(index[above * longer.columns + other]);
                pairs.weights.push(strength / volume);
            });
            pairs.starts.push(pairs.partners.len());
        }
    }
    Ok(Bonds { pairs, touches: Vec::new(), ghosts })
}
