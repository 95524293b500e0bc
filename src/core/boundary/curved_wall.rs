//! Contacts of particles with a curved wall.
//!
//! No particle mirrors about a curve, and an image fitted to several particles acts on all of them: it leaks heat
//! through an insulated wall, and a wall of known temperature can pull particles out of the range of the data. So the
//! pairs that a curved wall cuts are dropped, and what they would carry is given back as a flux through the wall: a
//! pair of weight `w` between a particle at depth `d` and a place at depth `g` behind the wall counts as `w (d + g)`
//! of wall area, on which the flux `q` of the wall acts. A linear profile is met exactly.
//!
//! The flux follows from the linear profile through the wall and one particle: the particle itself, or, where that is
//! so near to the wall that it would set the step of the whole body, neighbours deeper inside. A neighbour serves at
//! most until its own pull on the particle is used up, of which fronts inside particles leave a part. So rates fall with
//! a particle's own potential and rise with all others and with the wall's: the maximum principle holds for every weight
//! and every kind of wall. Heat passes through the wall alone, and none through an insulated one.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::memory::HeapSize;
use crate::physics::latent_heat::Materials;
use crate::space::lattice::Lattice;
use crate::space::random_field::between;

/// What a curved wall may add to the row sum of a particle, over that of a whole neighbourhood. Beyond it deeper
/// neighbours serve. The step is then 8/9 of that deep inside. On a quenched disc errors were within a factor of two of
/// those at 1/3; at 0 the reach of peridynamics made them several times larger on coarse lattices.
const MOST_STIFFNESS: f64 = 0.125;

/// Part of its pull on a particle that a neighbour keeps at least where fronts inside particles are followed: a front at the far side of
/// a neighbouring cell is one and a half spacings away.
const PULL_BESIDE_FRONTS: f64 = 2.0 / 3.0;

/// What one particle has to do with a curved wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The particle.
    pub particle: u32,
    /// Sum of the weights of the pairs that the wall cuts (m^-2).
    pub cut: f64,
    /// What the particle's own potential adds to its row sum through the wall, at most (m^-2).
    pub stiffness: f64,
    /// Its views of the wall.
    views: (u32, u32),
    /// Potential (W/m) of the fronts between particles, where fronts inside particles are followed.
    front: Option<f64>,
}

impl Contact {
    /// What the particle sees of the potential (W/m) of another one. Where a front stands between them they exchange heat with the front
    /// and not with each other: then no more is seen than the front, or the other one would pull through the wall alone.
    #[inline]
    pub fn seen(&self, own: f64, other: f64) -> f64 {
        match self.front {
            Some(front) if own < front => other.min(front),
            Some(front) if own > front => other.max(front),
            _ => other,
        }
    }

    /// Whether another one is beyond a front, which does not follow it.
    #[inline]
    pub fn is_beyond(&self, own: f64, other: f64) -> bool {
        self.seen(own, other) != other
    }
}

/// The flux of a wall as the linear profile through one particle has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The particle.
    pub particle: u32,
    /// Area of wall by volume of a particle (m^-1) on which the flux acts.
    pub area: f64,
    /// Depth (m) of the particle inside the body.
    pub depth: f64,
}

/// All contacts of a body with its curved wall.
#[derive(Debug, Clone, Default)]
pub struct Contacts {
    /// By particle.
    pub contacts: Vec<Contact>,
    views: Vec<View>,
}

/// A curved wall of a body.
#[derive(Debug, Clone)]
pub struct Rim {
    /// Its patch.
    pub patch: usize,
    /// From when it is there (s).
    pub from: f64,
    /// Contacts of particles with it.
    pub contacts: Contacts,
}

impl Rim {
    /// Whether it is there at a time (s).
    #[inline]
    pub fn stands(&self, time: f64) -> bool {
        time >= self.from
    }
}

/// The pairs of one particle near a curved wall, while they are counted.
#[derive(Debug, Clone)]
pub struct Neighbourhood {
    depth: f64,
    cut: f64,
    area: f64,
    /// Weight and depth of the pairs inside the body, by particle.
    inside: BTreeMap<u32, (f64, f64)>,
}

impl Neighbourhood {
    /// No pair yet, of a particle at a depth (m) inside the body.
    pub fn new(depth: f64) -> Self {
        Neighbourhood { depth: depth.max(0.0), cut: 0.0, area: 0.0, inside: BTreeMap::new() }
    }

    /// Counts a pair of a weight (m^-2) that the wall cuts; its far end lies at a depth (m) behind the wall.
    pub fn cut(&mut self, weight: f64, behind: f64) {
        self.cut += weight;
        self.area += weight * (self.depth + behind.max(0.0));
    }

    /// Counts a pair of a weight (m^-2) with a particle at a depth (m) inside the body.
    pub fn pair(&mut self, particle: u32, weight: f64, depth: f64) {
        self.inside.entry(particle).or_insert((0.0, depth)).0 += weight;
    }
}

impl Contacts {
    /// Adds a particle whose pairs have been counted, if the wall cuts any; `sum` (m^-2) is the row sum of its whole
    /// neighbourhood. Fronts inside particles of these materials may be followed.
    pub fn add(&mut self, particle: u32, near: &Neighbourhood, sum: f64, (materials, followed): (&Materials, bool)) {
        if near.cut == 0.0 {
            return;
        }
        let front = followed.then(|| materials.of(particle as usize).front_potential()).flatten();
        let first = self.views.len() as u32;
        let most = near.cut + MOST_STIFFNESS * sum;
        let wanted = (near.area - near.depth * most).max(0.0);
        // Offers vanish with the difference in depth, so rounding does not decide between particles of one depth.
        let deeper = || near.inside.iter().filter(|other| *other.0 != particle && other.1.1 > near.depth);
        let offer = |(weight, depth): &(f64, f64)| weight * (depth - near.depth);
        let offered: f64 = deeper().map(|other| offer(other.1)).sum();
        let pull = if front.is_some() { PULL_BESIDE_FRONTS } else { 1.0 };
        let share = if wanted > 0.0 && offered > 0.0 { (wanted / offered).min(pull) } else { 0.0 };
        for (other, pair) in deeper().filter(|_| share > 0.0) {
            self.views.push(View { particle: *other, area: share * offer(pair), depth: pair.1 });
        }
        // What nobody serves stays with the particle, as if it lay deep enough.
        let area = near.area - share * offered;
        let depth = near.depth.max(area / most);
        let mut stiffness = 0.0;
        if area > 0.0 && depth > 0.0 {
            stiffness = area / depth;
            self.views.push(View { particle, area, depth });
        }
        let views = (first, self.views.len() as u32);
        self.contacts.push(Contact { particle, cut: near.cut, stiffness, views, front });
    }

    /// Takes ground that conducts by a factor of each particle: neighbours serve by what lies between them and the particle, which
    /// their own pull on it outweighs as in even ground.
    pub fn vary(&mut self, factors: &[f64]) {
        for contact in &mut self.contacts {
            let own = factors[contact.particle as usize];
            contact.stiffness *= own;
            for view in &mut self.views[contact.views.0 as usize..contact.views.1 as usize] {
                view.depth /= between(own, factors[view.particle as usize]);
            }
        }
    }

    /// Takes ground that conducts `along` x and y by these factors, at a wall around the origin; `place` tells where a particle stands
    /// (m). What its pairs would carry through the wall is greater by the factor along the radius, and a flux is not.
    pub fn conduct(&mut self, along: DVec2, place: impl Fn(usize) -> DVec2) {
        if along == DVec2::ONE {
            return;
        }
        for contact in &self.contacts {
            let radius = place(contact.particle as usize).normalize_or_zero();
            let factor = along.dot(radius * radius);
            for view in &mut self.views[contact.views.0 as usize..contact.views.1 as usize] {
                view.area /= factor;
                view.depth /= factor;
            }
        }
    }

    /// Particles whose profiles tell the flux through the wall.
    pub fn seen(&self) -> impl Iterator<Item = u32> {
        self.views.iter().map(|view| view.particle)
    }

    /// Heat rate (W/m3) that a particle gains through the wall; `flux` tells the flux (W/m2) by particle and depth (m).
    #[inline]
    pub fn gain(&self, contact: &Contact, flux: impl Fn(usize, f64) -> f64) -> f64 {
        let views = &self.views[contact.views.0 as usize..contact.views.1 as usize];
        views.iter().map(|view| view.area * flux(view.particle as usize, view.depth)).sum()
    }

    /// How what the wall gives follows the potentials: fills `slopes` (m^-2) view by view from the slope of the flux
    /// (1/m) by the contact, the particle through which it sees the wall, and the depth (m) of that.
    pub fn slopes(&self, slope: impl Fn(&Contact, usize, f64) -> f64, slopes: &mut Vec<f64>) {
        slopes.clear();
        for contact in &self.contacts {
            let views = &self.views[contact.views.0 as usize..contact.views.1 as usize];
            let one = |view: &View| view.area * slope(contact, view.particle as usize, view.depth);
            slopes.extend(views.iter().map(one));
        }
    }

    /// Change of a particle's gain (W/m3) with small changes of potentials, by the slopes of all views.
    #[inline]
    pub fn change(&self, contact: &Contact, slopes: &[f64], change: impl Fn(usize) -> f64) -> f64 {
        let views = contact.views.0 as usize..contact.views.1 as usize;
        self.views[views.clone()].iter().zip(&slopes[views]).map(|(view, s)| s * change(view.particle as usize)).sum()
    }

    /// Greatest distance in the numbering of particles between one and those through which it sees the wall.
    pub fn bandwidth(&self) -> usize {
        let width = |contact: &Contact| {
            let views = &self.views[contact.views.0 as usize..contact.views.1 as usize];
            views.iter().map(|view| view.particle.abs_diff(contact.particle) as usize).max().unwrap_or(0)
        };
        self.contacts.iter().map(width).max().unwrap_or(0)
    }
}

impl HeapSize for Contacts {
    fn heap_size(&self) -> usize {
        self.contacts.capacity() * size_of::<Contact>() + self.views.capacity() * size_of::<View>()
    }
}

/// Ways (m) from a place inside the body to the cell centres behind the wall within `limit` (m), and the depths (m) of
/// these behind it.
pub fn cells_behind(place: DVec2, lattice: &Lattice, radius: f64, limit: f64) -> impl Iterator<Item = (DVec2, f64)> {
    let near = lattice.to_cells(place).round();
    // The rounded place is at most half a cell off in each direction.
    let across = if radius - place.length() > limit { -1 } else { (limit / lattice.spacing + 0.5).ceil() as i64 };
    let centre = |dx: i64, dy: i64| lattice.centre(near.x as i64 + dx, near.y as i64 + dy);
    let cells = (-across..=across).flat_map(move |dy| (-across..=across).map(move |dx| centre(dx, dy)));
    cells
        .map(move |cell| (cell - place, cell.length() - radius))
        .filter(move |(way, behind)| *behind > 1e-9 * radius && way.length() <= limit)
        .collect::<Vec<_>>()
        .into_iter()
}
