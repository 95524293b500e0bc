//! What fronts add to the rates of particles.

use crate::memory::HeapSize;

/// Particles, and what is added to their rates (W/m3); one particle may come several times.
#[derive(Debug, Clone)]
pub(super) struct Changes {
    /// Longer than it needs to be: what is beyond `count` is left from before.
    list: Vec<(u32, f64)>,
    count: usize,
}

impl Changes {
    /// None, with room for some.
    pub(super) fn with_room(room: usize) -> Self {
        Changes { list: Vec::with_capacity(room), count: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds those of particles that are not zero, no more than `most`.
    #[inline(always)]
    pub(super) fn extend(&mut self, most: usize, changes: impl Iterator<Item = (u32, f64)>) {
        let start = self.count;
        if self.list.len() < start + most {
            self.list.resize((start + most).max(self.list.capacity()), (0, 0.0));
        }
        // Whether a particle is changed cannot be guessed: all are written, and those that are not are written over.
        let (slots, mut count) = (&mut self.list[start..], 0);
        for (particle, change) in changes {
            if let Some(slot) = slots.get_mut(count) {
                *slot = (particle, change);
            }
            count += usize::from(change != 0.0);
        }
        self.count = start + count.min(most);
    }

    /// All of them.
    #[inline(always)]
    pub(super) fn all(&self) -> &[(u32, f64)] {
        &self.list[..self.count]
    }
}

impl HeapSize for Changes {
    fn heap_size(&self) -> usize {
        self.list.heap_size()
    }
}
