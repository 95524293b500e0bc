//! What instruments have measured of a scene.

/// Measured points of a scene, and where they come from.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measured {
    /// Who measured, with what, and where it is printed.
    pub source: String,
    /// The points, in the order of time within each file.
    pub points: Vec<MeasuredPoint>,
}

/// A measured value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    /// Of what.
    pub quantity: Quantity,
    /// When (s); of an event, when it came about.
    pub time: f64,
    /// The value: m of a front, degrees on the scale of the scene or effective saturation of a probe, s of an event.
    pub value: f64,
    /// Standard deviation of the value, in its unit.
    pub sd: f64,
}

/// What was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Quantity {
    /// How far the front has come, as in `front.csv`.
    Front,
    /// What a probe reads at a place (m).
    Probe {
        /// x, or r of shells.
        x: f64,
        /// y, or z of shells; 0 on a line.
        y: f64,
    },
    /// When something came about.
    Event(Event),
}

/// Something that comes about once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// A gap between freeze pipes closes: the mean over all gaps.
    Closure,
    /// The first gap closes.
    FirstClosure,
    /// The last gap closes.
    LastClosure,
    /// The last ice thaws in flowing groundwater.
    Thaw,
    /// The front comes to stay within 2 % of where it is at the end of the run, which lasts a tenth longer at least.
    Steady,
}

impl Event {
    /// All of them.
    pub const ALL: [Event; 5] = [Event::Closure, Event::FirstClosure, Event::LastClosure, Event::Thaw, Event::Steady];

    /// Its name in files and records.
    pub fn name(self) -> &'static str {
        match self {
            Event::Closure => "closure_day",
            Event::FirstClosure => "closure_day_first",
            Event::LastClosure => "closure_day_last",
            Event::Thaw => "thawed",
            Event::Steady => "front_steady",
        }
    }
}

impl Measured {
    /// Instants (s) at which a run is looked at for its sake, in order.
    pub fn instants(&self) -> Vec<f64> {
        let looked_at = |point: &&MeasuredPoint| !matches!(point.quantity, Quantity::Event(_)) && point.time > 0.0;
        let mut instants: Vec<f64> = self.points.iter().filter(looked_at).map(|point| point.time).collect();
        instants.sort_by(f64::total_cmp);
        instants.dedup();
        instants
    }

    /// Places (m) of its probes, each once.
    pub fn places(&self) -> Vec<(f64, f64)> {
        let mut places = Vec::new();
        for point in &self.points {
            if let Quantity::Probe { x, y } = point.quantity
                && !places.contains(&(x, y))
            {
                places.push((x, y));
            }
        }
        places
    }
}
