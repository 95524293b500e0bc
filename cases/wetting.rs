//! Scenes of unsaturated water beside what is known of them: tables, absorption into a half space, infiltration under gravity, a
//! solute in steady flow.

use frazil_core::boundary::condition::Condition;
use frazil_core::breakage::crack::{Crack, Growth};
use frazil_core::physics::retention::Retention;
use frazil_core::physics::retention::moisture::Soil;
use frazil_core::physics::retention::scale::{DRY, head};
use frazil_core::physics::retention::shape::RetentionCurve;
use frazil_core::physics::solute_material::Tortuosity;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::{PatchId, WallId};
use frazil_record::ReferenceInfo;
use frazil_scene::{Scene, Shape};
use frazil_simulation::reference::{Cut, Reference};

use crate::exact::Unsolved;
use crate::exact::unsaturated::ogata_banks::SoluteFront;
use crate::exact::unsaturated::philip::Absorption;
use crate::exact::unsaturated::soil as exact;
use crate::exact::unsaturated::srivastava_yeh::{GardnerColumn, GardnerSoil};
use crate::table::{compare, interpolate_square, wall_temperature};
use crate::unsaturated::amounts::amounts;
use crate::unsaturated::inclusions::inclusions;
use crate::unsaturated::profiles::{Cut as Line, Profiles};
use crate::unsaturated::slits::{Slit, slits};
use crate::unsaturated::{self, Case};
use crate::{BadTable, Unfit};

/// What names of tables begin with.
const PREFIX: &str = "unsaturated-";

/// The bodies of the tables reach this far (m).
const SIDE: f64 = 0.1;

/// Water that the soil of the tables takes up from dry to saturated.
const DRAINABLE: f64 = 0.177;

/// Names of all tables, as a scene file asks for them.
pub fn names() -> [&'static str; 8] {
    [
        "unsaturated-one-sided",
        "unsaturated-two-sided",
        "unsaturated-zone-source",
        "unsaturated-zone-closed",
        "unsaturated-cracks",
        "unsaturated-growing-cracks",
        "unsaturated-impermeable-inclusions",
        "unsaturated-permeable-inclusions",
    ]
}

/// The table of the given name, if it is one of these.
pub fn by_name(name: &str, scene: &Scene) -> Option<Result<Box<dyn Reference>, Unfit>> {
    let case = name.strip_prefix(PREFIX).and_then(|name| Case::ALL.into_iter().find(|case| case.name() == name))?;
    let found = Unfit::unless_same(name, differences(case, scene))
        .and_then(|()| Ok(Box::new(WettingTable::of(case)?) as Box<dyn Reference>));
    Some(found)
}

/// The table of a problem.
struct WettingTable {
    case: Case,
    profiles: Profiles,
    /// Times (s) and how much of a line the water would have filled (m), from the start on; empty where water does not go one
    /// way.
    filled: (Vec<f64>, Vec<f64>),
}

impl WettingTable {
    fn of(case: Case) -> Result<Self, BadTable> {
        let mut filled = (vec![0.0], vec![0.0]);
        let across = if case.is_line() { 1.0 } else { SIDE };
        if matches!(case, Case::OneSided | Case::ZoneSource) {
            for amount in amounts(case)? {
                filled.0.push(amount.time);
                filled.1.push(amount.water / (across * DRAINABLE));
            }
        }
        Ok(WettingTable { case, profiles: Profiles::of_case(case)?, filled })
    }

    fn line(&self, cut: Cut) -> Line {
        match cut {
            Cut::Across(y) => Line::AlongX { y: y + corner(self.case) },
            Cut::Up(x) => Line::AlongY { x: x + corner(self.case) },
        }
    }

    /// A line on which the table knows what does not vary across it.
    fn along(&self) -> Line {
        Line::AlongX { y: if self.case.is_line() { 0.0 } else { 0.5 * SIDE } }
    }
}

impl Reference for WettingTable {
    fn describe(&self) -> ReferenceInfo {
        let source =
            format!("table {PREFIX}{}: finite volumes with exact integral-mean conductivities", self.case.name());
        // Mean differences of grids of 100 and 200 cells a side; the line has 1600.
        let error = match self.case {
            case if case.is_line() => 1.3e-5,
            // The ends of the wet part are of first order.
            Case::ZoneClosed => 2e-3,
            _ => 1e-3,
        };
        ReferenceInfo::new("table", source, error)
    }

    fn temperature(&self, x: f64, t: f64) -> Option<f64> {
        let has_front = self.filled.0.len() > 1 || self.case.is_line();
        self.profiles.saturation(self.along(), x, t).filter(|_| has_front)
    }

    fn cut_temperature(&self, cut: Cut, x: f64, t: f64) -> Option<f64> {
        self.profiles.saturation(self.line(cut), x + corner(self.case), t)
    }

    fn concentration(&self, x: f64, t: f64) -> Option<f64> {
        self.profiles.concentration(self.along(), x, t).filter(|_| self.case.is_line())
    }

    fn cut_concentration(&self, cut: Cut, x: f64, t: f64) -> Option<f64> {
        self.profiles.concentration(self.line(cut), x + corner(self.case), t)
    }

    fn front(&self, t: f64) -> Option<f64> {
        let (times, filled) = &self.filled;
        if times.len() > 1 { interpolate_square(times, filled, t) } else { None }
    }
}

/// Where the lower left corner of the body is in a table (m).
fn corner(case: Case) -> f64 {
    if matches!(case, Case::Cracks | Case::GrowingCracks) { -0.5 * SIDE } else { 0.0 }
}

/// What about a scene is not as in a table.
fn differences(case: Case, scene: &Scene) -> Vec<String> {
    let mut found = Vec::new();
    let mut differs = |is_so: bool, what: &str| found.extend(is_so.then(|| what.to_owned()));
    differs(!scene.of_water, "it is of unsaturated water there");
    let is_line = matches!(scene.domain, Domain::Line { length } if (length - SIDE).abs() < 1e-9);
    let square = |side: f64| (side - SIDE).abs() < 1e-9;
    let is_square = matches!(scene.domain, Domain::Rectangle { width, height } if square(width) && square(height));
    differs(
        if case.is_line() { !is_line } else { !is_square },
        "the body is 0.1 m long and, but on a line, as high there",
    );
    differs(scene.initial_temperature != DRY, "the ground is dry at the start there");
    differs(scene.regions.iter().any(|region| region.temperature.is_some()), "all of the body starts alike there");
    differs(!has_wet_wall(case, scene), "the left wall is saturated there, or a part of it is that has the solute");
    let far = wall_temperature(scene, WallId::Right) == Some(0.0);
    differs(
        far != (case == Case::TwoSided),
        "of the other walls, the right one alone is saturated where both ends are wet",
    );
    let others = [WallId::Right, WallId::Bottom, WallId::Top];
    differs(scene.wall_parts.iter().any(|part| part.wall != WallId::Left), "the other walls are in one part there");
    let closed = |wall: &WallId| scene.is_closed(*wall) || *wall == WallId::Right && case == Case::TwoSided;
    differs(!others.iter().all(closed), "the other walls are closed there");
    differs(!has_cracks(case, scene), "its cracks are others there");
    differs(!has_inclusions(case, scene), "its inclusions are others there");
    soil_differences(&mut found, scene);
    solute_differences(&mut found, case, scene);
    found
}

fn soil_differences(found: &mut Vec<String>, scene: &Scene) {
    let soil = scene.materials.first().and_then(|material| material.soil.as_ref());
    let genuchten = soil.and_then(|soil| match &soil.retention {
        Retention::VanGenuchten(curve) => Some(*curve),
        _ => None,
    });
    compare(found, "alpha (1/m)", genuchten.map(|curve| curve.alpha), 1.0);
    compare(found, "n", genuchten.map(|curve| curve.exponent), 1.53);
    compare(found, "the connectivity", genuchten.map(|curve| curve.connectivity), 0.5);
    compare(found, "the residual water content", soil.map(|soil| soil.residual), 0.186);
    compare(found, "the saturated water content", soil.map(|soil| soil.saturated), 0.363);
    compare(found, "the conductivity (m/s)", soil.map(|soil| soil.conductivity), 1e-9);
}

fn solute_differences(found: &mut Vec<String>, case: Case, scene: &Scene) {
    let soil = scene.materials.first().and_then(|material| material.soil.as_ref());
    let Some((solute, material)) = scene.solute.as_ref().zip(soil.and_then(|soil| soil.solute)) else { return };
    compare(found, "the diffusion (m2/s)", Some(material.diffusion), 9e-11);
    let plain = material.tortuosity == Tortuosity::None
        && material.longitudinal_dispersivity == 0.0
        && material.sorption == 0.0
        && material.decay == 0.0;
    let walls: Vec<_> = solute.walls.iter().map(|wall| (wall.patch, wall.concentration.constant())).collect();
    let (left, zone) = ((PatchId::Whole(WallId::Left), Some(1.0)), (PatchId::Part(WallId::Left, 0), Some(1.0)));
    let is_so = match case {
        Case::ZoneSource => walls == [(left.0, Some(0.0)), zone],
        Case::ZoneClosed => walls == [zone],
        Case::TwoSided => walls == [left, (PatchId::Whole(WallId::Right), Some(0.0))],
        _ => walls == [left],
    };
    if !plain || !is_so || solute.initial != 0.0 || solute.regions.iter().any(Option::is_some) {
        found.push("the solute enters at 1 from the left (between 0.03 and 0.07 m alone, where it has a zone) and only diffuses there".into());
    }
}

/// Whether the left wall of a scene, and its part where the solute enters, are those of a table.
fn has_wet_wall(case: Case, scene: &Scene) -> bool {
    let wet = |condition: Option<&Condition>| match condition {
        Some(Condition::Temperature(series)) => series.constant() == Some(0.0),
        _ => false,
    };
    let whole = scene.wall(WallId::Left);
    match (case, &scene.wall_parts[..]) {
        (Case::ZoneSource | Case::ZoneClosed, [part]) => {
            let rest = if case == Case::ZoneSource { wet(whole) } else { whole == Some(&Condition::Symmetry) };
            rest && wet(Some(&part.condition)) && near((part.from, part.to), (0.03, 0.07))
        }
        (Case::ZoneSource, parts) => wet(whole) && parts.is_empty() && scene.solute.is_none(),
        (_, parts) => wet(whole) && parts.is_empty(),
    }
}

/// Whether two places (m) are the same.
fn near(own: (f64, f64), other: (f64, f64)) -> bool {
    (own.0 - other.0).hypot(own.1 - other.1) < 1e-9
}

/// Whether the cracks of a scene are those of a table.
fn has_cracks(case: Case, scene: &Scene) -> bool {
    let wanted = slits(case);
    let grows = |growth: &Growth, slit: &Slit| match (growth, slit.speed) {
        (Growth::Whole { start }, None) => *start == 0.0,
        (Growth::Steady { start, speed }, Some(wanted)) => *start == 0.0 && (speed / wanted - 1.0).abs() < 1e-3,
        _ => false,
    };
    let same = |(crack, slit): (&Crack, &Slit)| {
        let place = |y: f64| (slit.x - corner(case), y - corner(case));
        near(crack.from.into(), place(slit.from)) && near(crack.to.into(), place(slit.to)) && grows(&crack.growth, slit)
    };
    scene.cracks.len() == wanted.len() && scene.cracks.iter().zip(wanted).all(same)
}

/// Whether the inclusions of a scene are those of a table.
fn has_inclusions(case: Case, scene: &Scene) -> bool {
    if !matches!(case, Case::ImpermeableInclusions | Case::PermeableInclusions) {
        return scene.regions.is_empty() && scene.impermeable.is_empty();
    }
    let Ok(wanted) = inclusions() else { return false };
    if case == Case::ImpermeableInclusions {
        let same = |(shape, wanted): (&Shape, &unsaturated::inclusions::Inclusion)| {
            let Shape::Circle { centre, radius } = shape else { return false };
            near((*centre).into(), (wanted.x, wanted.y)) && (radius - wanted.radius).abs() < 1e-9
        };
        let shapes = &scene.impermeable;
        return scene.regions.is_empty() && shapes.len() == wanted.len() && shapes.iter().zip(&wanted).all(same);
    }
    let soil = |material: usize| scene.materials[material].soil.as_ref().map_or(0.0, |soil| soil.conductivity);
    let same = |(region, wanted): (&frazil_scene::Region, &unsaturated::inclusions::Inclusion)| {
        let Shape::Circle { centre, radius } = &region.shape else { return false };
        let there = near((*centre).into(), (wanted.x, wanted.y)) && (radius - wanted.radius).abs() < 1e-9;
        let factor = region.material.map_or(1.0, |material| soil(material) / soil(0));
        there && (factor - wanted.factor).abs() < 1e-6
    };
    let parts = &scene.regions;
    scene.impermeable.is_empty() && parts.len() == wanted.len() && parts.iter().zip(&wanted).all(same)
}

/// The closed form of a scene of unsaturated water.
///
/// # Errors
///
/// If it has none.
pub fn exact_solution(scene: &Scene) -> Result<Box<dyn Reference>, Unsolved> {
    let Domain::Line { length } = scene.domain else { return Err(Unsolved::NotALine) };
    let [material] = scene.materials.as_slice() else { return Err(Unsolved::SeveralMaterials) };
    let soil = material.soil.as_ref().ok_or(Unsolved::NoMaterial)?;
    if !scene.regions.is_empty() || !scene.cracks.is_empty() {
        return Err(Unsolved::Body("a line whose parts differ"));
    }
    if let Some(towards) = scene.gravity {
        return Ok(Box::new(Infiltration::new(scene, soil, length, towards)?));
    }
    match (scene.wall(WallId::Left), wall_temperature(scene, WallId::Right)) {
        (Some(Condition::Flux(flux)), Some(far)) if far >= 0.0 && scene.initial_temperature >= 0.0 => {
            let flux = flux.constant().filter(|flux| *flux > 0.0).ok_or(Unsolved::NothingDrives)?;
            Ok(Box::new(Tracer::new(scene, soil, flux, length)?))
        }
        _ => Ok(Box::new(Wetting::new(scene, soil, length)?)),
    }
}

/// Water that a half space soaks up from a wall.
struct Wetting {
    absorption: Absorption,
    initial: f64,
    length: f64,
    /// Water between the residual and the saturated content.
    drainable: f64,
}

/// Greatest saturation above that of the start that the far wall of a finite body may see.
const FAR_WALL: f64 = 1e-6;

impl Wetting {
    fn new(scene: &Scene, soil: &Soil, length: f64) -> Result<Self, Unsolved> {
        if !scene.is_closed(WallId::Right) {
            return Err(Unsolved::Body("a line of which both ends are open"));
        }
        let wall = wall_temperature(scene, WallId::Left).ok_or(Unsolved::WallChanges(WallId::Left))?;
        let retention = match &soil.retention {
            Retention::VanGenuchten(curve) => exact::Retention::VanGenuchten { alpha: curve.alpha, n: curve.exponent },
            _ => return Err(Unsolved::Body("a soil that is not van Genuchten's")),
        };
        let made = exact::Soil::new(retention, soil.residual, soil.saturated, soil.conductivity);
        let initial = soil.saturation(scene.initial_temperature);
        let absorption = made.and_then(|made| match wall >= 0.0 {
            true => Absorption::under_head(made, initial, head(wall)),
            false => Absorption::new(made, initial, soil.saturation(wall)),
        });
        let absorption = absorption.map_err(|_| Unsolved::NothingDrives)?;
        let change = absorption.saturation(length, scene.duration) - initial;
        if change > FAR_WALL {
            return Err(Unsolved::FarWallFelt { length, change, limit: FAR_WALL });
        }
        Ok(Wetting { absorption, initial, length, drainable: soil.saturated - soil.residual })
    }
}

impl Reference for Wetting {
    fn describe(&self) -> ReferenceInfo {
        ReferenceInfo::new("similarity", "absorption into a half space (Philip 1957)", 1e-9)
    }

    fn temperature(&self, x: f64, t: f64) -> Option<f64> {
        Some(self.absorption.saturation(x, t))
    }

    fn front(&self, t: f64) -> Option<f64> {
        Some(self.initial * self.length + self.absorption.infiltrated(t) / self.drainable)
    }
}

/// Water that soaks down through a soil of exponentials.
struct Infiltration {
    column: GardnerColumn,
    /// The height of the wall at x = 0 (m), and how heights follow x.
    from: f64,
    upwards: f64,
}

impl Infiltration {
    fn new(scene: &Scene, soil: &Soil, length: f64, towards: WallId) -> Result<Self, Unsolved> {
        let Retention::Gardner(curve) = &soil.retention else {
            return Err(Unsolved::Body("a soil that is not Gardner's, where water falls"));
        };
        let above = towards.opposite().ok_or(Unsolved::NotALine)?;
        let Some(Condition::Flux(flux)) = scene.wall(above) else { return Err(Unsolved::WallChanges(above)) };
        let after = flux.constant().ok_or(Unsolved::WallChanges(above))?;
        let bottom = wall_temperature(scene, towards).ok_or(Unsolved::WallChanges(towards))?;
        if bottom != scene.initial_temperature || bottom > 0.0 {
            return Err(Unsolved::Body("a column that starts with another head than it has below"));
        }
        let own = GardnerSoil {
            alpha: curve.alpha,
            residual: soil.residual,
            saturated: soil.saturated,
            conductivity: soil.conductivity,
        };
        // An even head lets water through by its weight alone.
        let before = soil.conductivity * curve.relative_conductivity(-head(bottom));
        let column = GardnerColumn::new(own, length, head(bottom), [before, after]);
        let (from, upwards) = if towards.is_at_end() { (length, -1.0) } else { (0.0, 1.0) };
        Ok(Infiltration { column: column.map_err(|_| Unsolved::NothingDrives)?, from, upwards })
    }
}

impl Reference for Infiltration {
    fn describe(&self) -> ReferenceInfo {
        ReferenceInfo::new("exact", "infiltration into a soil of exponentials (Srivastava and Yeh 1991)", 1e-12)
    }

    fn temperature(&self, x: f64, t: f64) -> Option<f64> {
        Some(self.column.saturation(self.from + self.upwards * x, t))
    }
}

/// A solute in saturated ground through which water flows steadily.
struct Tracer {
    front: SoluteFront,
}

impl Tracer {
    fn new(scene: &Scene, soil: &Soil, flux: f64, length: f64) -> Result<Self, Unsolved> {
        let Some((solute, material)) = scene.solute.as_ref().zip(soil.solute) else {
            return Err(Unsolved::NothingDrives);
        };
        let one = matches!(&solute.walls[..], [wall] if wall.patch == PatchId::Whole(WallId::Left) && wall.concentration.constant() == Some(1.0));
        if !one || solute.initial != 0.0 {
            return Err(Unsolved::WallChanges(WallId::Left));
        }
        let content = soil.saturated;
        let molecular = match material.tortuosity {
            Tortuosity::None => material.diffusion,
            Tortuosity::MillingtonQuirk { saturated } => {
                material.diffusion * content.powf(10.0 / 3.0) / saturated.powi(2)
            }
        };
        let spreads = (molecular + material.longitudinal_dispersivity * flux) / content;
        let retards = 1.0 + material.sorption / content;
        let front = SoluteFront::new(flux / content, spreads)
            .and_then(|front| front.with_reactions(retards, material.decay))
            .map_err(|_| Unsolved::NothingDrives)?;
        let change = front.concentration(length, scene.duration);
        // A column that ends lets the solute out: what comes near its end feels that.
        if change > TRACER_FAR_WALL {
            return Err(Unsolved::ColumnEnds(change));
        }
        Ok(Tracer { front })
    }
}

/// The same of a solute.
const TRACER_FAR_WALL: f64 = 5e-3;

impl Reference for Tracer {
    fn describe(&self) -> ReferenceInfo {
        ReferenceInfo::new("exact", "a solute in steady flow into a half space (Ogata and Banks 1961)", 1e-13)
    }

    fn temperature(&self, _x: f64, _t: f64) -> Option<f64> {
        Some(1.0)
    }

    fn concentration(&self, x: f64, t: f64) -> Option<f64> {
        Some(self.front.concentration(x, t))
    }
}
