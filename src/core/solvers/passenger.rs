//! What rides on a balance without acting back: it is advanced after each of its steps, by what the step exchanged.

/// What a balance has exchanged along its pairs over a step.
#[derive(Debug, Clone, Copy)]
pub struct Interval<'a> {
    /// When the step began (s).
    pub start: f64,
    /// Its length (s).
    pub step: f64,
    /// What the particle of each entry of the list of pairs has gained along it, by the particle's volume and by time (1/s).
    pub flows: &'a [f64],
    /// Contents of all particles at its start and at its end.
    pub contents: (&'a [f64], &'a [f64]),
}

/// A balance that rides on another.
pub trait Passenger {
    /// Takes what the other has done over its next step.
    fn take(&mut self, interval: &Interval<'_>);
    /// Potentials at its contents, at the end of the interval.
    fn potentials(&self, contents: &[f64], potentials: &mut [f64]);
}
