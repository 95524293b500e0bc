//! Small changes where pairs exchange by a mean of conductivities.
//!
//! What a pair conducts, `w mean(k_i, k_j) (T_j - T_i)`, is linearised with the conductivities of heat held: the changes that count
//! are those of `K T`, with the largest conductivity K of all. Newton's iteration then is Picard's where conductivities
//! follow temperatures, and its matrix stays an M-matrix. Those of water change a thousandfold over a pair, so what follows from
//! their changes is part of the tangent.

use crate::bonds::exchange::{Exchange, Mean};
use crate::boundary::curved_wall::{Contact, Rim};
use crate::boundary::patch::Face;
use crate::kernels::enthalpy_rows::Linearised;
use crate::kernels::rows::ListRows;
use crate::kernels::term::PairTerm;
use crate::physics::latent_heat::SchemeState;

impl<T: PairTerm> ListRows<T> {
    /// Linearises around a state at a time (s): `slopes` takes `K dT/dH` (m2/s) of every particle.
    pub(super) fn linearise_means(
        &mut self,
        scheme: &dyn SchemeState,
        enthalpy: &[f64],
        time: f64,
        slopes: &mut [f64],
        tangent: &mut Linearised,
    ) {
        let largest = self.largest_conductivity();
        let (parts, fields) = (&self.parts, &mut self.fields);
        scheme.read(&parts.materials, enthalpy, fields);
        parts.ghosts.fill_temperatures(
            &mut fields.temperature,
            &mut fields.conductivity,
            &self.faces,
            &parts.materials,
        );
        let seen = (&fields.temperature, &fields.conductivity);
        parts.ghosts.temperature_slopes(seen.0, seen.1, &self.faces, &parts.materials, &mut tangent.ghosts);
        tangent.changes.resize(fields.temperature.len(), 0.0);
        for (i, (slope, enthalpy)) in slopes.iter_mut().zip(enthalpy).enumerate() {
            let thermal = parts.materials.of(i);
            let own = thermal.curve.driven_conductivity(fields.temperature[i]);
            *slope = if own > 0.0 { largest * thermal.law.slope(*enthalpy) / own } else { 0.0 };
        }
        tangent.time = time;
        let conductivity = &self.fields.conductivity;
        let heads = &self.fields.temperature;
        let driven = self.driven_slopes(enthalpy.len());
        let share = |i: usize, j: usize| {
            let (a, b) = (conductivity[i], conductivity[j]);
            let difference = heads[j] - heads[i];
            // The mean, and how it follows either conductivity.
            let (mean, by_a, by_b) = match self.parts.exchange {
                Exchange::Mean(Mean::Harmonic) => {
                    let (sum, mean) = (a + b, 2.0 * a * b / (a + b));
                    (mean, 2.0 * (b / sum).powi(2), 2.0 * (a / sum).powi(2))
                }
                Exchange::Mean(Mean::Arithmetic) => (0.5 * (a + b), 0.5, 0.5),
                Exchange::Mean(Mean::Geometric) => {
                    let mean = (a * b).sqrt();
                    (mean, 0.5 * b / mean, 0.5 * a / mean)
                }
                Exchange::Upstream if difference > 0.0 => (b, 0.0, 1.0),
                Exchange::Upstream => (a, 1.0, 0.0),
                Exchange::Potential => (largest, 0.0, 0.0),
            };
            let follows = |slope: f64, by: f64| if slope > 0.0 { difference * by * slope } else { 0.0 };
            ((mean - follows(driven[i], by_a)) / largest, (mean + follows(driven[j], by_b)) / largest)
        };
        tangent.conductivity.clear();
        if self.diagonals.is_some() {
            // Means of conductivities grow in proportion with them.
            tangent.conductivity.extend(conductivity.iter().map(|own| own / largest));
        }
        let pairs = &self.parts.pairs;
        tangent.shares.clear();
        for i in 0..enthalpy.len() {
            let row = &pairs.partners[pairs.starts[i]..pairs.starts[i + 1]];
            tangent.shares.extend(row.iter().map(|j| share(i, *j as usize)));
        }
        let of_wall = |face: &Face, particle: usize, depth: f64| {
            let curve = &self.parts.materials.of(particle).curve;
            let flux = |temperature: f64| face.flux_by_temperature(temperature, conductivity[particle], depth, curve);
            let own = self.fields.temperature[particle];
            (flux(own + 1.0) - flux(own)) / largest
        };
        tangent.views.resize_with(self.parts.rims.len(), Vec::new);
        for (number, Rim { patch, contacts, .. }) in self.standing(time) {
            let slope = |_: &Contact, particle: usize, depth: f64| of_wall(&self.faces[0][*patch], particle, depth);
            contacts.slopes(slope, &mut tangent.views[number]);
        }
        self.linearise_pipes(time, tangent);
        tangent.touches.clear();
        tangent.touches.extend(self.parts.touches.iter().map(|touch| {
            let particle = touch.particle as usize;
            let face = &self.faces[self.parts.materials.index(particle)][touch.patch as usize];
            touch.area * of_wall(face, particle, touch.depth)
        }));
    }

    /// How the conductivities of particles and ghosts follow what drives them, where they do: those of water. Behind walls they
    /// follow their images, as far as they are those of their images.
    fn driven_slopes(&self, count: usize) -> Vec<f64> {
        let (materials, heads) = (&self.parts.materials, &self.fields.temperature);
        let mut slopes = vec![0.0; heads.len()];
        for (i, slope) in slopes.iter_mut().enumerate().take(count) {
            *slope = materials.of(i).curve.driven_slope(heads[i]);
        }
        self.parts.ghosts.fill(&mut slopes, |ghost, image| {
            let material = self.parts.ghosts.material(ghost, materials);
            let face = self.parts.ghosts.patch[ghost].map(|patch| self.faces[material][patch as usize]);
            if matches!(face, None | Some(Face::Even)) { image } else { 0.0 }
        });
        slopes
    }

    /// The largest conductivity (W/mK) of all materials.
    fn largest_conductivity(&self) -> f64 {
        let thermals = self.parts.materials.thermals.iter();
        thermals.map(|thermal| thermal.curve.most_conductive()).fold(0.0, f64::max)
    }

    /// The change of the potential (W/m) of a particle, which pipes see under every exchange, by the change that pairs see.
    pub(super) fn potential_of_change(&self, particle: usize, change: f64) -> f64 {
        match self.parts.exchange {
            Exchange::Potential => change,
            Exchange::Mean(_) | Exchange::Upstream => {
                change * self.fields.conductivity[particle] / self.largest_conductivity()
            }
        }
    }
}
