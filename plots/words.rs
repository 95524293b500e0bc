//! What figures of a run say alike: titles, units, the entry of the reference.

use frazil_record::{Field, ProfileRow, RunResult, TimeUnit};

use crate::axes::Entry;
use crate::canvas::Stroke;
use crate::ground_plan::GroundPlan;
use crate::moisture_map::Outlines;
use crate::style::{INK, REFERENCE, method_title, number};

/// What figures of a run need beyond the run itself.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureOptions {
    /// What figures are called; the title of the run if absent.
    pub name: Option<String>,
    /// Unit of times on axes.
    pub time_unit: TimeUnit,
    /// Temperature of the isotherm that is drawn heavy: where the ground freezes; absent where nothing does.
    pub freezing_point: Option<f64>,
    /// Names of both directions.
    pub axes: (&'static str, &'static str),
    /// Least and greatest pressure of walls (Pa); equal where no water flows.
    pub pressures: (f64, f64),
    /// Height of the cut through flowing water (m).
    pub cut: f64,
    /// What is drawn over maps.
    pub plan: GroundPlan,
    /// What stands in the ground of unsaturated water; absent where the run is of heat.
    pub unsaturated: Option<Outlines>,
    /// Logarithms of what varies at random in the ground, over what its materials have, each with its name.
    pub ground: Vec<(&'static str, Field)>,
}

/// How a run speaks of its units.
pub(crate) struct Words {
    pub(crate) heading: String,
    pub(crate) method: String,
    pub(crate) time_symbol: &'static str,
    seconds: f64,
    pub(crate) time_label: String,
    pub(crate) temperature_label: String,
    pub(crate) degree: &'static str,
    /// Names of both directions.
    pub(crate) axes: (&'static str, &'static str),
    pub(crate) length_unit: Option<(f64, &'static str)>,
    pub(crate) freezing_point: Option<f64>,
    /// What the figure of the front is about, and what it and its error are called.
    pub(crate) front: (&'static str, &'static str, &'static str),
}

impl Words {
    pub(crate) fn of(result: &RunResult, options: &FigureOptions) -> Words {
        let record = &result.record;
        let reach = result.front.iter().map(|row| row.front_m).fold(0.0, f64::max);
        let heading = options.name.as_ref().unwrap_or(&record.title);
        Words::new((heading, &record.method, &record.units), reach, options)
    }

    /// `reach` is how far fronts go (m).
    pub(crate) fn new((heading, method, units): (&str, &str, &str), reach: f64, options: &FigureOptions) -> Words {
        let si = units == "si";
        let unit = options.time_unit;
        Words {
            heading: format!("{heading} — {}", method_title(method)),
            method: method.to_owned(),
            time_symbol: if si { unit.symbol() } else { "" },
            seconds: if si { unit.seconds() } else { 1.0 },
            time_label: if si { format!("time ({})", unit.symbol()) } else { "time (dimensionless)".into() },
            temperature_label: if si { "temperature (°C)".into() } else { "temperature (dimensionless)".into() },
            degree: if si { " °C" } else { "" },
            axes: options.axes,
            length_unit: si.then_some(if reach > 0.0 && reach < 0.2 { (1e3, "mm") } else { (1.0, "m") }),
            freezing_point: options.freezing_point,
            front: match (&options.unsaturated, options.axes.0) {
                (Some(_), _) => ("Wetted length over time", "wetted length", "error of the wetted length (%)"),
                (None, "r") => ("Front over time", "radius of the front", "error of the front (%)"),
                (None, _) => ("Front over time", "front", "error of the front (%)"),
            },
        }
    }

    /// What a figure of this shows, for those who cannot see it.
    pub(crate) fn name(&self, what: &str) -> String {
        format!("{what}: {}", self.heading)
    }

    pub(crate) fn time(&self, seconds: f64) -> f64 {
        seconds / self.seconds
    }

    pub(crate) fn instant(&self, seconds: f64) -> String {
        format!("{} {}", number(self.time(seconds), 4), self.time_symbol).trim_end().into()
    }

    pub(crate) fn length(&self, metres: f64) -> f64 {
        metres * self.length_unit.map_or(1.0, |(scale, _)| scale)
    }

    /// What lengths along profiles are multiplied by on an axis, and the symbol of their unit.
    pub(crate) fn along(&self, profiles: &[ProfileRow]) -> (f64, &'static str) {
        let reach = profiles.iter().map(|row| row.along_m.abs()).fold(0.0, f64::max);
        if self.length_unit.is_none() {
            (1.0, "dimensionless")
        } else if reach < 0.2 {
            (1e3, "mm")
        } else {
            (1.0, "m")
        }
    }

    pub(crate) fn length_label(&self, what: &str) -> String {
        match self.length_unit {
            Some((_, symbol)) => format!("{what} ({symbol})"),
            None => format!("{what} (dimensionless)"),
        }
    }
}

/// Line and legend entry of the reference.
pub(crate) fn reference_entry() -> Entry {
    Entry::line("reference", reference_stroke())
}

pub(crate) fn reference_stroke() -> Stroke {
    Stroke { colour: REFERENCE, width: 4.5, dash: &[] }
}

/// References that lie over their curves.
pub(crate) const DOTS: Stroke = Stroke { colour: INK, width: 1.6, dash: &[2.5, 4.5] };
