//! The state of a fluid as bytes, from which it goes on to the same bits.

use super::Fluid;
use super::matter::Matter;
use super::particle::Particle;

/// First bytes of a state, and its form.
const MARK: &[u8; 8] = b"fluid\0\0\x01";

impl<const D: usize, M: Matter> Fluid<D, M> {
    /// Everything that steps change, to the last bit. Constants, matter, walls and drives are the program's to give again.
    pub fn save(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(64 + self.particles.len() * (16 + 8 * (4 * D + 2) + 4 * D));
        bytes.extend_from_slice(MARK);
        for count in [D as u64, self.particles.len() as u64, self.steps, self.sortings] {
            bytes.extend_from_slice(&count.to_le_bytes());
        }
        for number in [self.potential, self.gained, self.given_back, self.driven, self.moving] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        for (particle, origin) in self.particles.iter().zip(&self.origins) {
            let columns = [&particle.position, &particle.velocity, &particle.force, origin];
            for number in columns.into_iter().flatten().chain([&particle.heat, &particle.mobility]) {
                bytes.extend_from_slice(&number.to_le_bytes());
            }
            for turns in particle.turns {
                bytes.extend_from_slice(&turns.to_le_bytes());
            }
            bytes.extend_from_slice(&particle.name.to_le_bytes());
        }
        bytes
    }

    /// Takes over a state that a fluid of the same kind has saved.
    ///
    /// # Errors
    /// Bytes that are no such state.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), String> {
        let mut rest = bytes.strip_prefix(MARK).ok_or("no state of a fluid: it begins otherwise")?;
        let mut next = || {
            let (number, after) = rest.split_first_chunk::<8>().ok_or("the state of a fluid ends early")?;
            rest = after;
            Ok::<_, String>(*number)
        };
        let mut whole = || Ok::<_, String>(u64::from_le_bytes(next()?));
        let (dimension, count, steps, sortings) = (whole()?, whole()?, whole()?, whole()?);
        if (dimension, count) != (D as u64, self.particles.len() as u64) {
            return Err(format!(
                "a state of {count} particles in {dimension} directions, must be of {} in {D}",
                self.particles.len()
            ));
        }
        let mut number = || Ok::<_, String>(f64::from_le_bytes(next()?));
        let scalars = [number()?, number()?, number()?, number()?, number()?];
        let size = 8 * (4 * D + 2) + 4 * D + 4;
        if rest.len() != size * self.particles.len() {
            return Err("the state of a fluid has another length than its particles".into());
        }
        let mut places = Vec::with_capacity(self.particles.len());
        for (particle, record) in self.particles.iter_mut().zip(rest.chunks_exact(size)) {
            let (numbers, integers) = record.split_at(8 * (4 * D + 2));
            let mut numbers =
                numbers.chunks_exact(8).map(|chunk| f64::from_le_bytes(chunk.try_into().unwrap_or_default()));
            let mut integers = integers.chunks_exact(4).map(|chunk| <[u8; 4]>::try_from(chunk).unwrap_or_default());
            let mut column = || [(); D].map(|()| numbers.next().unwrap_or_default());
            let [position, velocity, force, origin] = [column(), column(), column(), column()];
            places.push(position);
            *particle = Particle {
                // Cells are those of where particles stood when they were sorted.
                position: origin,
                velocity,
                force,
                heat: numbers.next().unwrap_or_default(),
                mobility: numbers.next().unwrap_or_default(),
                turns: [(); D].map(|()| i32::from_le_bytes(integers.next().unwrap_or_default())),
                name: u32::from_le_bytes(integers.next().unwrap_or_default()),
            };
        }
        self.in_pool(Self::sort);
        for (particle, place) in self.particles.iter_mut().zip(places) {
            particle.position = place;
        }
        [self.potential, self.gained, self.given_back, self.driven, self.moving] = scalars;
        (self.steps, self.sortings) = (steps, sortings);
        Ok(())
    }
}
