//! What lies behind the walls of a lattice.

use crate::bonds::stencil::Stencil;
use crate::boundary::curved_wall::{Contact, Contacts, Neighbourhood};
use crate::boundary::patch::{Boundary, Face, Side};
use crate::kernels::sweep::Shape;
use crate::ledger::Sum;
use crate::memory::HeapSize;
use crate::physics::latent_heat::Materials;
use crate::physics::laws::Laws;
use crate::physics::thermal::Thermal;
use crate::space::lattice::Lattice;
use crate::team::{Team, share};

/// Contacts that a thread handles at once.
const CONTACTS: usize = 256;

/// What lies behind a curved wall.
#[derive(Debug, Clone, Default)]
pub(super) struct Exterior {
    /// Cells behind the wall that pairs reach, by padded row: column + reach. They hold zero.
    pub(super) rows: Vec<Vec<u32>>,
    /// Particles whose pairs the wall cuts.
    pub(super) contacts: Contacts,
    /// What each of them gains at the current instant, and what the sweep takes from it for the cut pairs (W/m3).
    pub(super) gains: Vec<(f64, f64)>,
}

impl HeapSize for Exterior {
    fn heap_size(&self) -> usize {
        self.rows.heap_size() + self.contacts.heap_size() + self.gains.heap_size()
    }
}

impl Exterior {
    /// What lies behind the curved wall of a body, if it has one, where fronts inside particles may be followed.
    pub(super) fn new(
        (lattice, shape): (&Lattice, Shape),
        stencil: &Stencil,
        boundary: &Boundary,
        ground: (&Materials, bool),
    ) -> Option<Self> {
        let (patch, radius) = boundary.curved?;
        let mirror = |side: usize| boundary.sides[side] == Side::Mirror;
        let fold = |column: i64, row: i64| {
            (
                if mirror(0) && column < 0 { -1 - column } else { column },
                if mirror(2) && row < 0 { -1 - row } else { row },
            )
        };
        let (reach, reach_rows) = (shape.reach as i64, shape.reach_rows as i64);
        let mut rows = vec![std::collections::BTreeSet::new(); lattice.rows + 2 * shape.reach_rows];
        let mut contacts = Contacts::default();
        let sum = stencil.sum();
        let layers = boundary.patches[patch].layers;
        for row in 0..lattice.rows {
            let (first, end) = lattice.span(row);
            for column in first as i64..end as i64 {
                let row = row as i64;
                let depth = radius - lattice.centre(column, row).length();
                // Deep inside every offset stays inside.
                if depth > (reach as f64 + 1.5) * lattice.spacing * 1.5 {
                    continue;
                }
                let mut near = Neighbourhood::new(depth);
                for (dx, dy, weight) in stencil.offsets() {
                    let (dx, dy) = (dx as i64, dy as i64);
                    for (sx, sy) in [(1, 1), (-1, 1), (1, -1), (-1, -1)] {
                        if (dx == 0 && sx < 0) || (dy == 0 && sy < 0) {
                            continue;
                        }
                        let cell = fold(column + sx * dx, row + sy * dy);
                        let depth = radius - lattice.centre(cell.0, cell.1).length();
                        match lattice.index(cell.0, cell.1) {
                            Some(index) => near.pair(index as u32, weight, depth),
                            None => {
                                near.cut(weight, if layers { 0.0 } else { -depth });
                                rows[(cell.1 + reach_rows) as usize].insert((cell.0 + reach) as u32);
                            }
                        }
                    }
                }
                if let Some(index) = lattice.index(column, row) {
                    contacts.add(index as u32, &near, sum, ground);
                }
            }
        }
        contacts.conduct(stencil.along(), |particle| lattice.position(particle));
        let rows = rows.into_iter().map(|row| row.into_iter().collect()).collect();
        Some(Exterior { rows, gains: vec![(0.0, 0.0); contacts.contacts.len()], contacts })
    }

    pub(super) fn update<L: Laws>(
        &mut self,
        team: Option<&Team>,
        (laws, enthalpy): (&L, &[f64]),
        face: &Face,
        thermal: &Thermal,
        slopes: Option<&WallSlopes>,
    ) {
        let Exterior { contacts, gains, .. } = self;
        let potential = |particle: usize| laws.potential_of(particle, enthalpy[particle]);
        let one = |contact: &Contact| {
            let own = potential(contact.particle as usize);
            let given = match slopes {
                Some(slopes) => contacts.change(contact, &slopes.curved, potential),
                None => {
                    let seen = |particle: usize| contact.seen(own, potential(particle));
                    let flux = |particle: usize, depth: f64| face.flux(seen(particle), depth, thermal);
                    contacts.gain(contact, flux)
                }
            };
            (given, contact.cut * own)
        };
        let team = team.filter(|_| gains.len() > CONTACTS);
        share(team, gains.chunks_mut(CONTACTS).zip(contacts.contacts.chunks(CONTACTS)), |(gains, contacts)| {
            for (gain, contact) in gains.iter_mut().zip(contacts) {
                *gain = one(contact);
            }
        });
    }

    /// Adds what the wall gives to `rates`, scaled, and gives back what the sweep took for the cut pairs.
    pub(super) fn add(&self, rates: &mut [f64], scale: f64) {
        for (contact, (gain, taken)) in self.contacts.contacts.iter().zip(&self.gains) {
            rates[contact.particle as usize] += scale * (gain + taken);
        }
    }

    /// Heat rate in through the wall, by volume of a particle.
    pub(super) fn heat(&self) -> f64 {
        self.gains.iter().map(|gain| gain.0).collect::<Sum>().value()
    }
}

/// How small changes meet the walls: the ghosts of straight walls with a film follow their images by padded place along the
/// wall and layer (those of other straight walls all follow alike), the gains at a curved wall follow what is seen of it.
#[derive(Debug, Clone, Default)]
pub(super) struct WallSlopes {
    pub(super) by_side: [Vec<f64>; 4],
    pub(super) curved: Vec<f64>,
}
