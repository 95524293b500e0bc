//! The operator on a lattice for small changes of potentials around a state.

use crate::boundary::curved_wall::Contact;
use crate::boundary::patch::Face;
use crate::boundary::pipe::Sink;
use crate::kernels::around::Around;
use crate::kernels::exterior::WallSlopes;
use crate::kernels::lattice::LatticeBalance;
use crate::kernels::sweep::Shape;
use crate::physics::laws::Laws;
use crate::physics::potential::Identity;

impl<L: Laws> LatticeBalance<L> {
    /// Linearises at a state and time (s); `slopes` takes dU/dH (m2/s) of every particle.
    pub(super) fn linearise_at(&mut self, enthalpy: &[f64], time: f64, slopes: &mut [f64]) {
        self.around.update_faces(&self.boundary, time, false);
        for (particle, (slope, enthalpy)) in slopes.iter_mut().zip(enthalpy).enumerate() {
            *slope = self.around.laws.slope_of(particle, *enthalpy);
        }
        if let Some(irregular) = &mut self.irregular {
            irregular.linearise(enthalpy, time);
        }
        if let Some(front) = &mut self.front {
            let Around { laws, lattice, materials, .. } = &self.around;
            front.linearise(lattice, enthalpy, laws, |particle| materials.of(particle).largest_slope, slopes);
        }
        self.linear_time = time;
        let wall_slopes = self.wall_slopes(enthalpy);
        let mut tangent = self.tangent.take().unwrap_or_else(|| Box::new(self.still()));
        for (linear, face) in tangent.around.faces.iter_mut().zip(&self.around.faces) {
            *linear = face.homogeneous();
        }
        tangent.around.slopes = Some(wall_slopes);
        tangent.around.ends = tangent.around.find_ends();
        for (linear, sink) in tangent.sinks.iter_mut().zip(&self.sinks) {
            let sampled = sink.sampled(|index| self.around.laws.potential_of(index, enthalpy[index]));
            linear.resistance = sink.resistance_to_changes(sampled, time, self.around.thermal_at_sink(sink));
        }
        self.tangent = Some(tangent);
    }

    /// The operator on small changes of potentials: walls and pipes hold still, and no heat is booked.
    fn still(&self) -> LatticeBalance<Identity> {
        let around = &self.around;
        let mut boundary = self.boundary.clone();
        boundary.hold_still();
        LatticeBalance {
            volume: self.volume,
            around: Around {
                lattice: around.lattice.clone(),
                shape: around.shape,
                stencil: around.stencil.clone(),
                laws: Identity,
                materials: around.materials.clone(),
                material_at: around.material_at.clone(),
                sides: around.sides,
                open: [false; 4],
                walls_meet: around.walls_meet,
                faces: around.faces.iter().map(Face::homogeneous).collect(),
                slopes: Some(WallSlopes::default()),
                exterior: around.exterior.clone(),
                patch_weights: around.patch_weights.clone(),
                patch_own: around.patch_own.clone(),
                ends: None,
            },
            boundary,
            weights: self.weights.clone(),
            sinks: self.sinks.iter().map(Sink::still).collect(),
            sink_potentials: vec![0.0; self.sinks.len()],
            sink_heat: vec![0.0; self.sinks.len()],
            corners: self.corners.clone(),
            corner_rates: vec![0.0; self.corners.len()],
            front: None,
            irregular: None,
            observed: None,
            bands: self.bands.clone(),
            row_patches: self.row_patches.clone(),
            is_bare: false,
            team: self.team.clone(),
            facts: self.facts.clone(),
            tangent: None,
            linear_time: 0.0,
        }
    }

    /// How small changes around a state meet the walls.
    fn wall_slopes(&self, enthalpy: &[f64]) -> WallSlopes {
        let around = &self.around;
        let Shape { reach, width, .. } = around.shape;
        let (columns, rows) = (around.lattice.columns, around.lattice.rows);
        let mut slopes = WallSlopes::default();
        let mut row_buffer = vec![0.0; width];
        for side in 0..4 {
            let face = around.face(side);
            if !face.bends() {
                continue;
            }
            let thermal = around.thermal_at(side);
            let slope = |face: &Face, image: f64, depth: f64| {
                face.ghost_slope(image, depth, &thermal.curve, thermal.zero_potential)
            };
            let depth = |layer: usize| around.depth(side, layer);
            let table = &mut slopes.by_side[side];
            if side < 2 {
                let beyond = around.shape.reach_rows as i64;
                for row in -beyond..rows as i64 + beyond {
                    around.fill_any(row, enthalpy, &mut row_buffer);
                    table.extend((0..reach).map(|layer| {
                        let image = if side == 0 { reach + layer } else { reach + columns - 1 - layer };
                        slope(face, row_buffer[image], depth(layer))
                    }));
                }
            } else {
                table.resize((columns + 2 * reach) * reach, 0.0);
                for layer in 0..around.shape.reach_rows {
                    let image = if side == 2 { layer as i64 } else { rows as i64 - 1 - layer as i64 };
                    around.fill_any(image, enthalpy, &mut row_buffer);
                    for (place, potential) in row_buffer[..columns + 2 * reach].iter().enumerate() {
                        table[place * reach + layer] = slope(face, *potential, depth(layer));
                    }
                }
            }
        }
        if let (Some(exterior), Some((patch, _))) = (&around.exterior, self.boundary.curved) {
            let (face, thermal) = (&around.faces[patch], around.thermal_of(patch));
            let potential = |particle: usize| around.laws.potential_of(particle, enthalpy[particle]);
            let slope = |contact: &Contact, particle: usize, depth: f64| {
                let (own, other) = (potential(contact.particle as usize), potential(particle));
                if contact.is_beyond(own, other) { 0.0 } else { face.flux_slope(other, depth, thermal) }
            };
            exterior.contacts.slopes(slope, &mut slopes.curved);
        }
        slopes
    }
}
