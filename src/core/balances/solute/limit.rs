//! How much of the exchange beside water is taken back: as much as leaves every particle within the concentrations around it
//! (Zalesak 1979).

/// What the exchange would do to a particle, and what it may.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Row {
    /// Gain with all of the exchange (1/s).
    pub gain: f64,
    /// What taking the exchange back would add and take (1/s).
    pub up: f64,
    pub down: f64,
    /// Least and greatest concentration around.
    pub least: f64,
    pub most: f64,
}

/// A particle at the start of a step.
pub(super) struct Held {
    /// What it holds, with all that it holds it in: for a concentration of one, at the start of the step and at its end.
    pub content: f64,
    pub holds: [f64; 2],
    /// Share that decays in the step.
    pub decays: f64,
}

impl Row {
    /// A row around a concentration.
    pub(super) fn around(own: f64) -> Self {
        Row { least: own, most: own, ..Row::default() }
    }

    /// Takes note of a concentration around.
    #[inline]
    pub(super) fn see(&mut self, value: f64) {
        self.least = if value < self.least { value } else { self.least };
        self.most = if value > self.most { value } else { self.most };
    }

    /// Takes note of what taking exchange back would bring.
    #[inline]
    pub(super) fn add(&mut self, back: f64) {
        if back > 0.0 {
            self.up += back;
        } else {
            self.down += back;
        }
    }

    /// Shares of what would be added and taken in a step (s) that leave the particle within its range. Decay is no part of that:
    /// the range decays as the particle does.
    pub(super) fn shares(&self, held: &Held, step: f64) -> (f64, f64) {
        let [before, after] = held.holds;
        let own = held.content / before;
        let low = held.content + step * self.gain;
        let kept = if after > 0.0 { held.decays * before / after } else { 0.0 };
        let least = after * (self.least + kept * (own - self.least));
        let most = after * (self.most - kept * (self.most - own));
        let share = |room: f64, wanted: f64| if wanted > room { (room / wanted).max(0.0) } else { 1.0 };
        (share(most - low, step * self.up), share(low - least, -step * self.down))
    }
}
