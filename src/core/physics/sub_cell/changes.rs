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

    /// Room for so many more.
    #[inline(always)]
    pub(super) fn room(&mut self, most: usize) -> Room<'_> {
        let end = self.count + most;
        if self.list.len() < end {
            self.list.resize(end.max(self.list.capacity()), (0, 0.0));
        }
        Room { slots: &mut self.list[self.count..end], taken: 0 }
    }

    /// Takes so many more from the room that there was.
    #[inline(always)]
    pub(super) fn take(&mut self, taken: usize) {
        self.count += taken;
    }

    /// All of them.
    #[inline(always)]
    pub(super) fn all(&self) -> &[(u32, f64)] {
        &self.list[..self.count]
    }
}

/// Room for changes, and how much of it is taken.
pub(super) struct Room<'a> {
    slots: &'a mut [(u32, f64)],
    pub(super) taken: usize,
}

impl Room<'_> {
    /// Adds what is added to a particle, if that is not zero.
    #[inline(always)]
    pub(super) fn add(&mut self, particle: u32, change: f64) {
        // Whether a particle is changed cannot be guessed: all are written, and those that are not are written over.
        if let Some(slot) = self.slots.get_mut(self.taken) {
            *slot = (particle, change);
            self.taken += usize::from(change != 0.0);
        }
    }
}

impl HeapSize for Changes {
    fn heap_size(&self) -> usize {
        self.list.heap_size()
    }
}
