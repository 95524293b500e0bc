//! What exchange that may be taken back would do to a particle: as much of it is taken back as leaves the particle within what
//! lies around it (Zalesak 1979).

/// What the exchange would do to a particle, and what lies around it. Gains are by volume and second, of enthalpy (J/m3) or of
/// a solute's content; the range is of what is limited, enthalpy or concentration.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Row {
    /// Gain with all of the exchange.
    pub gain: f64,
    /// What taking the exchange back would add and take.
    pub up: f64,
    pub down: f64,
    /// Least and greatest around, of some partners where those of all are asked for only if need be.
    pub least: f64,
    pub most: f64,
}

impl Row {
    /// A row around a value.
    #[inline]
    pub fn around(own: f64) -> Self {
        Row { least: own, most: own, ..Row::default() }
    }

    /// Takes note of a value around.
    #[inline]
    pub fn see(&mut self, value: f64) {
        self.least = if value < self.least { value } else { self.least };
        self.most = if value > self.most { value } else { self.most };
    }

    /// Takes note of what taking exchange back would bring.
    #[inline]
    pub fn add(&mut self, back: f64) {
        // Without a branch, whose way nothing foretells.
        self.up += if back > 0.0 { back } else { 0.0 };
        self.down += if back < 0.0 { back } else { 0.0 };
    }

    /// Shares of what would be added and taken in a step (s) that fit into the room above and below.
    pub fn shares(&self, above: f64, below: f64, step: f64) -> (f64, f64) {
        let share = |room: f64, wanted: f64| if wanted > room { (room / wanted).max(0.0) } else { 1.0 };
        (share(above, step * self.up), share(below, -step * self.down))
    }
}
