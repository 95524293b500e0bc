//! The operator on a list for small changes of potentials around a state.

use crate::bonds::exchange::Exchange;
use crate::boundary::curved_wall::{Contact, Rim};
use crate::boundary::interface::Way;
use crate::kernels::diagonal_pairs::Columns;
use crate::kernels::enthalpy_rows::Linearised;
use crate::kernels::gravity::Shares;
use crate::kernels::rows::ListRows;
use crate::kernels::term::PairTerm;
use crate::physics::latent_heat::SchemeState;

impl<T: PairTerm> ListRows<T> {
    /// How the flux through a wall into a particle follows the potential of the particle (1/m).
    fn through_wall_slope(&self, way: Option<Way<'_>>, particle: usize, patch: usize, depth: f64) -> f64 {
        let (materials, potential) = (&self.parts.materials, self.fields.potential[particle]);
        match way {
            None => {
                let material = materials.index(particle);
                self.faces[material][patch].flux_slope(potential, depth, &materials.thermals[material])
            }
            Some(way) => way.wall_slopes(&self.faces[way.near()][patch], depth, potential).1,
        }
    }

    /// How the flux that [`ListRows::across_materials`] gives, or gravity beside it, follows the potentials of both sides: it falls by the
    /// first share of the change of `i` and rises by the second share of the change of `j`.
    fn shares(&self, i: usize, j: usize, k: usize) -> (f64, f64) {
        if let Some(gravity) = &self.gravity {
            let Shares { own, other } = gravity.shares(i, j);
            return (1.0 + own, 1.0 + other);
        }
        let potential = &self.fields.potential;
        match self.way(k) {
            None => (1.0, 1.0),
            Some(way) if i < j => way.shares(potential[i], potential[j]),
            Some(way) => {
                let (near, far) = way.shares(potential[j], potential[i]);
                (far, near)
            }
        }
    }

    /// Linearises around a state: `slopes` takes dU/dH (m2/s) of every particle, `tangent` the exchange of small changes.
    pub fn linearise(
        &mut self,
        scheme: &dyn SchemeState,
        enthalpy: &[f64],
        time: f64,
        slopes: &mut [f64],
        tangent: &mut Linearised,
    ) {
        let total = self.parts.positions.len() + self.parts.ghosts.len();
        self.parts.cuts.bring_to(time, &mut self.parts.pairs.weights);
        let parts = &self.parts;
        for (faces, thermal) in self.faces.iter_mut().zip(parts.materials.thermals.iter()) {
            parts.boundary.update_faces(faces, time, &thermal.curve, thermal.zero_potential);
        }
        if parts.exchange != Exchange::Potential {
            return self.linearise_means(scheme, enthalpy, time, slopes, tangent);
        }
        self.fields.potential.resize(total, 0.0);
        scheme.read(&parts.materials, enthalpy, &mut self.fields);
        let potential = &mut self.fields.potential;
        parts.ghosts.fill_potentials(potential, &self.faces, &parts.materials, &parts.chains);
        parts.ghosts.slopes(potential, &self.faces, &parts.materials, &parts.chains, &mut tangent.ghosts);
        tangent.changes.resize(potential.len(), 0.0);
        for (i, (slope, enthalpy)) in slopes.iter_mut().zip(enthalpy).enumerate() {
            *slope = parts.materials.of(i).law.slope(*enthalpy);
        }
        tangent.time = time;
        tangent.views.resize_with(parts.rims.len(), Vec::new);
        for (number, Rim { patch, contacts, .. }) in self.standing(time) {
            let slope = |contact: &Contact, particle: usize, depth: f64| {
                let potential = |particle: usize| self.fields.potential[particle];
                let (own, other) = (potential(contact.particle as usize), potential(particle));
                let way = parts.chains.of_rim(number, particle, &parts.materials.thermals);
                let slope = || self.through_wall_slope(way, particle, *patch, depth);
                if contact.is_beyond(own, other) { 0.0 } else { slope() }
            };
            contacts.slopes(slope, &mut tangent.views[number]);
        }
        self.linearise_pipes(time, tangent);
        tangent.touches.clear();
        tangent.touches.extend(parts.touches.iter().enumerate().map(|(number, touch)| {
            let way = parts.chains.of_touch(number, &parts.materials.thermals);
            touch.area * self.through_wall_slope(way, touch.particle as usize, touch.patch as usize, touch.depth)
        }));
        if let Some(gravity) = &mut self.gravity {
            gravity.bring_to(parts, enthalpy, &self.fields.potential, &self.faces);
            gravity.linearise(parts, enthalpy, slopes);
        }
        if parts.materials.mixed() || self.gravity.is_some() {
            let pairs = &parts.pairs;
            tangent.shares.clear();
            for i in 0..enthalpy.len() {
                let row = pairs.starts[i]..pairs.starts[i + 1];
                tangent.shares.extend(row.map(|k| self.shares(i, pairs.partners[k] as usize, k)));
            }
        }
    }

    /// Fills the resistances with which small changes meet pipes at a time (s).
    pub(super) fn linearise_pipes(&self, time: f64, tangent: &mut Linearised) {
        let parts = &self.parts;
        tangent.pipes.clear();
        tangent.pipes.extend(parts.sinks.iter().map(|sink| {
            let material = parts.materials.of(sink.sample.first().map_or(0, |entry| entry.0 as usize));
            sink.resistance_to_changes(sink.sampled(|index| self.fields.potential[index]), time, material)
        }));
    }

    /// Rates (W/m3) that small changes of the potentials (W/m) of particles cause.
    pub fn act(&self, tangent: &mut Linearised, potentials: &[f64], rate: &mut [f64]) {
        let parts = &self.parts;
        let Linearised { changes, ghosts, shares, conductivity, views, touches, pipes, time } = tangent;
        changes[..potentials.len()].copy_from_slice(potentials);
        parts.ghosts.fill_changes(changes, ghosts);
        let changes = &*changes;
        let pairs = &parts.pairs;
        let row = |i: usize| {
            let range = pairs.starts[i]..pairs.starts[i + 1];
            let own = changes[i];
            let partners = pairs.partners[range.clone()].iter().zip(&pairs.weights[range.clone()]);
            if shares.is_empty() {
                partners.map(|(j, weight)| weight * (changes[*j as usize] - own)).sum::<f64>()
            } else {
                let flux = |((j, weight), (own_share, other_share)): ((&u32, &f64), &(f64, f64))| {
                    weight * (other_share * changes[*j as usize] - own_share * own)
                };
                partners.zip(&shares[range]).map(flux).sum()
            }
        };
        let columns = Columns { values: changes, conductivity };
        match &self.diagonals {
            None => parts.in_tasks(rate, |first, rates| {
                rates.iter_mut().enumerate().for_each(|(offset, rate)| *rate = row(first + offset));
            }),
            Some(diagonals) => parts.in_tasks_of(diagonals.share(parts.threads()), rate, |first, rates| {
                diagonals.gather(&columns, first, rates);
                diagonals.listed(first, rates.len()).for_each(|own| rates[own - first] += row(own));
            }),
        }
        for (rim, views) in parts.rims.iter().zip(views.iter()).filter(|(rim, _)| rim.stands(*time)) {
            for contact in &rim.contacts.contacts {
                rate[contact.particle as usize] += rim.contacts.change(contact, views, |particle| changes[particle]);
            }
        }
        for (touch, slope) in parts.touches.iter().zip(touches.iter()) {
            rate[touch.particle as usize] += slope * changes[touch.particle as usize];
        }
        for (sink, resistance) in parts.sinks.iter().zip(pipes).filter(|(sink, _)| sink.works(*time)) {
            let heat = sink.sampled(|index| self.potential_of_change(index, changes[index])) / *resistance * sink.share;
            for (index, weight) in &sink.sample {
                rate[*index as usize] -= heat * weight / parts.volumes.of(*index as usize);
            }
        }
    }
}
