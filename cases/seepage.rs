//! The thawing inclusion of Nikolaev et al. 2021, section 5.3, from tables of a finite-volume solution for each of two
//! laws of conductivity.

use frazil_core::physics::material::Mixing;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_record::ReferenceInfo;
use frazil_scene::Scene;
use frazil_simulation::reference::Reference;

use crate::BadTable;
use crate::table::{NumberTable, interpolate};

/// Name of the table, as a scene file asks for it.
pub const NAME: &str = "thawing-inclusion";

/// Relative agreement of a scene's numbers with those of the table.
const SAME: f64 = 1e-3;

/// Estimated error of the times at which ice is gone, the largest of the tables.
const ERROR: f64 = 4e-3;

/// Error of temperatures on the cut (K), rms.
const TEMPERATURE_ERROR: f64 = 0.035;

/// Range of the temperatures (K): from the inclusion's to the water's.
const RANGE: f64 = 20.0;

/// The tables of one law.
pub struct Inclusion {
    law: &'static str,
    temperature: NumberTable,
    pressure: NumberTable,
    history: NumberTable,
}

impl Inclusion {
    /// The tables of a law.
    ///
    /// # Errors
    ///
    /// If they cannot be read.
    pub fn of_law(mixing: Mixing) -> Result<Self, BadTable> {
        let (law, temperature, pressure, history) = match mixing {
            Mixing::Geometric => (
                "geometric",
                include_str!("tables/thawing-inclusion-temperature.csv"),
                include_str!("tables/thawing-inclusion-pressure.csv"),
                include_str!("tables/thawing-inclusion-history.csv"),
            ),
            Mixing::Arithmetic => (
                "volume-weighted",
                include_str!("tables/thawing-inclusion-volume-temperature.csv"),
                include_str!("tables/thawing-inclusion-volume-pressure.csv"),
                include_str!("tables/thawing-inclusion-volume-history.csv"),
            ),
        };
        Ok(Inclusion {
            law,
            temperature: NumberTable::read(temperature)?,
            pressure: NumberTable::read(pressure)?,
            history: NumberTable::read(history)?,
        })
    }

    fn of_history(&self, name: &str, t: f64) -> Option<f64> {
        interpolate(self.history.column("time_s").ok()?, self.history.column(name).ok()?, t)
    }
}

/// A number of the cut at one of its instants.
fn at(table: &NumberTable, x: f64, t: f64) -> Option<f64> {
    let is_instant = |name: &&String| {
        let time = name.strip_prefix("at_").and_then(|name| name.strip_suffix("_s")).and_then(|time| time.parse().ok());
        time.is_some_and(|time: f64| (time - t).abs() < 1e-6)
    };
    let name = table.names().iter().find(is_instant)?;
    interpolate(table.column("x_m").ok()?, table.column(name).ok()?, x)
}

impl Reference for Inclusion {
    fn describe(&self) -> ReferenceInfo {
        let source = format!("finite volumes on 600 x 400 cells, {} mean of conductivities", self.law);
        let temperature = ("temperature".to_owned(), TEMPERATURE_ERROR / RANGE);
        ReferenceInfo { errors: [temperature].into(), ..ReferenceInfo::new("table", source, ERROR) }
    }

    fn cut(&self, x: f64, t: f64) -> Option<(f64, Option<f64>)> {
        Some((at(&self.temperature, x, t)?, at(&self.pressure, x, t)))
    }

    fn ice(&self, t: f64) -> Option<f64> {
        self.of_history("ice_fraction", t)
    }

    fn event(&self, name: &str) -> Option<f64> {
        if name != "thawed" {
            return None;
        }
        let (times, coldest) = (self.history.column("time_s").ok()?, self.history.column("least_temperature_c").ok()?);
        let last = coldest.iter().rposition(|temperature| *temperature < 0.0)?;
        let (cold, warm) = (-coldest[last], *coldest.get(last + 1)?);
        Some(times[last] + (times[last + 1] - times[last]) * cold / (cold + warm))
    }
}

/// What about a scene is not that of the tables.
pub fn differences(scene: &Scene) -> Vec<String> {
    let mut found = Vec::new();
    let mut compare = |what: &str, own: Option<f64>, expected: f64| {
        if own.is_none_or(|own| (own - expected).abs() > SAME * expected.abs().max(1e-9)) {
            let own = own.map_or("none".into(), |own| own.to_string());
            found.push(format!("{what} is {own}, the table's {expected}"));
        }
    };
    let extent = match scene.domain {
        Domain::Rectangle { width, height } => (Some(width), Some(height)),
        _ => (None, None),
    };
    compare("the width", extent.0, 0.75);
    compare("the height", extent.1, 0.5);
    compare("the initial temperature", Some(scene.initial_temperature), 15.0);
    let inclusion = match scene.regions.as_slice() {
        [one] => one.temperature,
        _ => None,
    };
    compare("the temperature of the one region", inclusion, -5.0);
    compare("the range of temperatures", Some(scene.temperature_range().1 - scene.temperature_range().0), RANGE);
    let flow = scene.flow.as_ref();
    let drop = flow.map(|flow| {
        let at = |name: WallId| {
            flow.walls.iter().find(|wall| wall.wall == name).map_or(f64::NAN, |wall| wall.pressure.at(0.0))
        };
        at(WallId::Left) - at(WallId::Right)
    });
    compare("the drop of pressure", drop, 370.0);
    if let Some(material) = scene.materials.first() {
        let pores = material.pores;
        compare("the porosity", pores.map(|pores| pores.porosity), 0.3);
        compare("the permeability", pores.and_then(|pores| pores.permeability), 1.3e-10);
        compare("the heat capacity of thawed ground", Some(material.unfrozen_capacity()), 2_803_525.0);
        compare("that of frozen ground", Some(material.frozen_capacity()), 2_117_485.0);
        compare("the latent heat", Some(material.volumetric_latent_heat()), 92_184_000.0);
    }
    found
}
