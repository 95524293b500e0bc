//! The sections of the methods: how the scene is resolved, never what it is.

use std::sync::Arc;

use super::ground::has_slow_fronts;
use super::range::{Range, all_of};
use super::section::Section;
use super::spacing;
use super::water;
use crate::TimeUnit;
use crate::capability::{self, Exclusion, Feature, Place};
use crate::method::{MethodKind, MethodSettings, SceneFacts};
use crate::settings::{Arrangement, Front, IntegratorChoice, Numerics, SearchChoice, Setting, StepChoice, UPSTREAM};
use frazil_core::balances::groundwater::numerics::{Advection, Conduction, FlowNumerics};
use frazil_core::bonds::exchange::{Exchange, Mean};
use frazil_core::bonds::stencil::longest_reach;
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::physics::latent_heat::{LatentHeatScheme, Mushy};
use frazil_core::physics::material::Material;
use frazil_core::physics::retention::scale::DRY;
use frazil_core::space::domain::Domain;
use glam::DVec2;

/// Error of one step where a scene does not say, by integrator: heat in the wrong place over the heat held (see
/// docs/theory/time.md for what it costs and gives).
const RKL2_TOLERANCE: f64 = 1e-2;
/// The same around pipes: the days on which single gaps of a ring close, at any place on the lattice, then lie as close to each other as
/// with Euler's steps.
const RKL2_TOLERANCE_AROUND_PIPES: f64 = 3e-3;
/// The same on a line, where steps end as fronts pass particles: the error is then that of the spacing, and a step costs little.
const RKL2_TOLERANCE_ON_A_LINE: f64 = 1e-5;
/// The same beside water, which carries what an error moves away from where it is made good again.
const RKL2_TOLERANCE_BESIDE_WATER: f64 = 1e-3;
const IMPLICIT_TOLERANCE: f64 = 1e-3;

/// Change of permeabilities from which the pressure is solved for again, where a scene does not say: a fifth of the
/// particles across the body.
const PRESSURE_CHANGE: f64 = 0.2;

const INTERVAL: (&str, &str) = ("interval", "K");

/// What the checks of numerics need to know of the scene.
pub(super) struct Setup<'a> {
    pub(super) domain: Option<&'a Domain>,
    /// Conductivity along x and along y, over that of the materials.
    pub(super) along: DVec2,
    pub(super) materials: &'a [Material],
    /// Whether heat comes in by a flux or a film.
    pub(super) brings_heat: bool,
    /// Whether any flux is given.
    pub(super) has_flux: bool,
    /// What it has that not all settings go with.
    pub(super) features: &'a [Feature],
}

impl Setup<'_> {
    /// Whether the body has one dimension.
    fn is_line(&self) -> bool {
        self.domain.is_some_and(|domain| domain.dimension() == 1)
    }
}

pub(super) fn methods(root: &mut Section<'_>, setup: &Setup<'_>, kinds: &[&'static MethodKind]) -> Vec<MethodSettings> {
    let Ok(mut section) = root.section("method") else { return Vec::new() };
    let names = all_of(kinds.iter().map(|kind| kind.name));
    let mut found = Vec::new();
    let tables = section.named_sections();
    if tables.is_empty() {
        section.section_problem(format!("missing, must have at least one method: the methods are {names}"));
    }
    for (name, mut table) in tables {
        match kinds.iter().position(|kind| kind.name == name) {
            Some(index) => found.push((index, method(&mut table, setup, kinds[index]))),
            None => {
                table.section_problem(format!("unknown method, the methods are {names}"));
                table.abandon();
            }
        }
    }
    found.sort_by_key(|(index, _)| *index);
    found.into_iter().map(|(_, settings)| settings).collect()
}

fn method(section: &mut Section<'_>, setup: &Setup<'_>, kind: &'static MethodKind) -> MethodSettings {
    let setting = section.choice_or("setting", &Setting::WORDS, Setting::Best);
    let mut numerics = (kind.defaults)(setting);
    let found = section.positive(spacing::KEY);
    // Where the spacing is wrong, the method still reads its own keys.
    numerics.spacing = found.unwrap_or(1.0);
    numerics.arrangement = layout(section, numerics.arrangement);
    let water = setup.features.contains(&Feature::UnsaturatedWater);
    if water && setting == Setting::Paper {
        numerics = water::printed(numerics);
    }
    numerics.exchange = exchange(section, numerics.exchange, water);
    numerics.latent_heat_scheme = latent_heat_scheme(section, numerics.latent_heat_scheme, setup.materials);
    let flags = [Mushy::Fraction, Mushy::LastPhase];
    if let Some(mushy) = section.optional_flag_or_word("mushy", flags, ("mean", Mushy::Mean)) {
        if numerics.exchange == Exchange::Potential {
            section.problem("mushy", "has no effect, only means of conductivities use it");
        }
        numerics.mushy = mushy;
    }
    let front = section.optional_choice("front", &Front::WORDS);
    numerics.front = front.unwrap_or(numerics.front);
    numerics.walls = wall_model(section, &numerics, water);
    numerics.search = section.choice_or("search", &SearchChoice::WORDS, numerics.search);
    let preset = preset_integrator(section, setting, &numerics, setup, kind);
    numerics.usual_integrator = !section.has("integrator");
    numerics.integrator = integrator(section, preset, setup);
    let carries = setup.features.contains(&Feature::Solute);
    numerics.solute = carries.then(|| water::numerics(section, setting));
    numerics.flow =
        flow(section, (setup.features.contains(&Feature::Groundwater), carries), setting, numerics.integrator);
    numerics.conduction = conduction(section, &numerics, setup);
    numerics.step = step(section, numerics.step, numerics.integrator.tolerance().is_some());
    combinations(section, &numerics, setup, kind);

    let fits = match (found, setup.domain) {
        (Ok(found), Some(domain)) => spacing::divides(section, found, domain),
        _ => false,
    };
    let facts = SceneFacts {
        dimension: setup.domain.map_or(2, Domain::dimension),
        one_material: setup.materials.len() <= 1 && !water,
    };
    let discretisation = (kind.read)(section, setting, &numerics, &facts);
    let reach = longest_reach(discretisation.weight.as_ref(), setup.along);
    if let (true, Some(domain)) = (fits, setup.domain) {
        // Between straight walls pairs may reach images of images. Noise would have to tell all these apart; and a
        // curved wall has none.
        if kind.stochastic || matches!(domain, Domain::Ring { .. }) {
            spacing::reaches(section, numerics.spacing, reach, domain);
        }
    }
    let fronts = section.temperatures().is_some_and(|range| has_slow_fronts(setup.materials, range, setup.has_flux));
    if front.is_none() && setting == Setting::Best && fronts {
        numerics.front = best_front(&numerics, setup, kind, reach);
    }
    let (discretisation, along) = (Arc::new(discretisation), setup.along);
    MethodSettings { method: kind.name, setting, numerics, discretisation, along, bound: None }
}

/// Fronts inside particles wherever they go with everything else: they are of one order more.
fn best_front(numerics: &Numerics, setup: &Setup<'_>, kind: &MethodKind, reach: f64) -> Front {
    let inside = Numerics { front: Front::SubCell, ..numerics.clone() };
    let features: Vec<Feature> =
        setup.features.iter().copied().chain(capability::of_settings(&inside, kind, setup.brings_heat)).collect();
    let concerns = |row: &Exclusion| [row.asked, row.beside].contains(&Feature::SubCellFronts);
    let fits = numerics.latent_heat_scheme == LatentHeatScheme::Enthalpy
        && setup.domain.is_some_and(|domain| spacing::has_room(domain, numerics.spacing, reach))
        && !capability::exclusions(&features).any(concerns);
    if fits { Front::SubCell } else { numerics.front }
}

fn layout(section: &mut Section<'_>, preset: Arrangement) -> Arrangement {
    let given = if let Arrangement::Jittered { fraction } = preset { Some(fraction) } else { None };
    let jittered = Arrangement::Jittered { fraction: given.unwrap_or(0.0) };
    let words = [("lattice", Arrangement::Lattice), ("jittered", jittered), ("random", Arrangement::Random)];
    let found = section.choice_or("layout", &words, preset);
    if !matches!(found, Arrangement::Jittered { .. }) {
        section.refuse("jitter_fraction", "only the layout \"jittered\" uses it");
        return found;
    }
    let range = Range::above_to(0.0, 0.5);
    let fraction = match given {
        Some(fraction) => Ok(section.number_or("jitter_fraction", fraction, range)),
        None => section.number("jitter_fraction", range),
    };
    fraction.map_or(Arrangement::Lattice, |fraction| Arrangement::Jittered { fraction })
}

fn exchange(section: &mut Section<'_>, preset: Exchange, water: bool) -> Exchange {
    let potential = section.optional_choice("exchange", &[("potential", Exchange::Potential)]);
    let mut words = Mean::WORDS.map(|(word, mean)| (word, Exchange::Mean(mean))).to_vec();
    words.extend(water.then_some((UPSTREAM, Exchange::Upstream)));
    let mean = section.optional_choice("mean", &words);
    if section.has("exchange") && section.has("mean") {
        section.problem("mean", "found beside \"exchange\", must be only one of them");
    }
    let found = potential.or(mean).unwrap_or(preset);
    if water && found != Exchange::Potential && section.temperatures().is_some_and(|(driest, _)| driest <= DRY) {
        section.problem(
            "mean",
            "dry ground has no head whose differences a mean could be multiplied by: it needs a \
            saturation above 0, or exchange = \"potential\"",
        );
    }
    found
}

/// Beside a mean of hydraulic conductivities walls are layers: a head that is mirrored at a wall is as far above that of the wall
/// as the ground before it is below, and ground so wet would conduct a thousand times too well.
fn wall_model(section: &mut Section<'_>, numerics: &Numerics, water: bool) -> WallModel {
    let layers = water && numerics.exchange != Exchange::Potential;
    let usual = if layers { WallModel::Naive } else { numerics.walls };
    let found = section.choice_or("wall_model", &WallModel::WORDS, usual);
    if layers && found != WallModel::Naive {
        let word = WallModel::WORDS.iter().find(|(_, model)| *model == found).map_or("", |(word, _)| word);
        let message = format!("found \"{word}\", must be \"naive\" beside a mean of hydraulic conductivities");
        section.problem("wall_model", message);
    }
    found
}

fn latent_heat_scheme(section: &mut Section<'_>, preset: LatentHeatScheme, materials: &[Material]) -> LatentHeatScheme {
    use LatentHeatScheme::{ApparentCapacity, Enthalpy, Flags};
    let given = if let ApparentCapacity { interval } = preset { Some(interval) } else { None };
    let apparent = ApparentCapacity { interval: given.unwrap_or(0.0) };
    let words = [("enthalpy", Enthalpy), ("flags", Flags), ("apparent-capacity", apparent)];
    let found = section.choice_or("scheme", &words, preset);
    if !matches!(found, ApparentCapacity { .. }) {
        section.refuse(INTERVAL, "only the scheme \"apparent-capacity\" uses it");
        return found;
    }
    if !materials.iter().any(Material::is_sharp) {
        if !materials.is_empty() {
            section.refuse(INTERVAL, "no material freezes at one temperature");
        }
        return found;
    }
    let interval = match given {
        Some(interval) => section.number_or(INTERVAL, interval, Range::POSITIVE),
        None => section.positive(INTERVAL).unwrap_or(1.0),
    };
    ApparentCapacity { interval }
}

/// The integrator where a method names none: the one that costs least for the same answer.
fn preset_integrator(
    section: &Section<'_>,
    setting: Setting,
    numerics: &Numerics,
    setup: &Setup<'_>,
    kind: &MethodKind,
) -> IntegratorChoice {
    let has = |feature| setup.features.contains(&feature);
    if numerics.integrator != IntegratorChoice::Euler {
        return numerics.integrator;
    }
    if has(Feature::UnsaturatedWater) {
        // Pressure spreads through saturated ground at once.
        return IntegratorChoice::Implicit { tolerance: IMPLICIT_TOLERANCE };
    }
    // Around pipes and beside water, and on lines that freeze, temperatures change slowly for most of the time.
    let freezes = setup.materials.iter().any(Material::freezes);
    let slow = has(Feature::Pipes) || has(Feature::Ring) || has(Feature::Groundwater) || setup.is_line() && freezes;
    let own_steps =
        TimeUnit::ALL.iter().any(|unit| section.has(("step", unit.ending()))) || section.has("step_fraction");
    let tolerance = rkl2_tolerance(setup);
    let in_stages = Numerics { integrator: IntegratorChoice::ControlledRkl2 { tolerance }, ..numerics.clone() };
    let features = capability::of_settings(&in_stages, kind, setup.brings_heat);
    let features: Vec<Feature> = setup.features.iter().copied().chain(features).collect();
    let concerns = |row: &Exclusion| {
        let pair = [row.asked, row.beside];
        pair.contains(&Feature::Stages) || pair.contains(&Feature::Rkl2)
    };
    if setting == Setting::Best && slow && !own_steps && !capability::exclusions(&features).any(concerns) {
        in_stages.integrator
    } else if has(Feature::Groundwater) {
        // What water carries asks for steps of second order.
        IntegratorChoice::Heun
    } else {
        IntegratorChoice::Euler
    }
}

/// Error of one step of RKL2 where a scene does not say.
fn rkl2_tolerance(setup: &Setup<'_>) -> f64 {
    let has = |feature| setup.features.contains(&feature);
    if has(Feature::Groundwater) {
        RKL2_TOLERANCE_BESIDE_WATER
    } else if has(Feature::Pipes) || has(Feature::Ring) {
        RKL2_TOLERANCE_AROUND_PIPES
    } else if setup.is_line() {
        RKL2_TOLERANCE_ON_A_LINE
    } else {
        RKL2_TOLERANCE
    }
}

fn integrator(section: &mut Section<'_>, preset: IntegratorChoice, setup: &Setup<'_>) -> IntegratorChoice {
    use IntegratorChoice::{ControlledRkl2, Euler, Heun, Implicit, Rkl2};
    let controlled = ControlledRkl2 { tolerance: rkl2_tolerance(setup) };
    let implicit = Implicit { tolerance: IMPLICIT_TOLERANCE };
    let words = [("euler", Euler), ("heun", Heun), ("rkl2", controlled), ("implicit", implicit)];
    let found = section.choice_or("integrator", &words, preset);
    let in_stages = matches!(found, Rkl2 { .. } | ControlledRkl2 { .. });
    if !in_stages {
        section.refuse("stages", "only the integrator \"rkl2\" has stages");
    }
    if found.is_monotone() {
        section.refuse("tolerance", "Euler and Heun steps have no error estimate");
        return found;
    }
    if in_stages && section.has("stages") {
        section.refuse("tolerance", "\"stages\" fixes the step");
        return Rkl2 { stages: section.integer("stages", 3..=99).unwrap_or(3) };
    }
    if let (Rkl2 { stages }, false) = (preset, section.has("tolerance")) {
        return Rkl2 { stages };
    }
    let usual = found.tolerance().unwrap_or(rkl2_tolerance(setup));
    let tolerance = section.number_or("tolerance", usual, Range::between(1e-9, 1.0));
    if in_stages { ControlledRkl2 { tolerance } } else { Implicit { tolerance } }
}

fn flow(
    section: &mut Section<'_>,
    (flows, carries): (bool, bool),
    setting: Setting,
    integrator: IntegratorChoice,
) -> Option<FlowNumerics> {
    if !flows {
        for key in ["advection", "conduction", "permeability_mean", "pressure_change"] {
            if key != "advection" || !carries {
                section.refuse(key, "the scene has no section \"flow\"");
            }
        }
        for key in ["coupling", "solute_step_fraction"] {
            if !carries {
                section.refuse(key, "the scene has no solute");
            }
        }
        for unit in TimeUnit::ALL {
            section.refuse(("pressure_interval", unit.ending()), "the scene has no section \"flow\"");
        }
        return None;
    }
    let usual = match (setting, integrator) {
        (Setting::Paper, _) => Advection::Paper,
        (Setting::Best, IntegratorChoice::Implicit { .. }) => Advection::Blended,
        (Setting::Best, _) => Advection::Limited,
    };
    let advection = section.choice_or("advection", &Advection::WORDS, usual);
    let usual = if setting == Setting::Paper { Mean::Harmonic } else { Mean::Arithmetic };
    let mean = section.choice_or("permeability_mean", &Mean::WORDS, usual);
    let pressure_change = section.number_or("pressure_change", PRESSURE_CHANGE, Range::above_to(0.0, 1.0));
    let interval = section.optional_duration("pressure_interval", Range::POSITIVE);
    let pressure_interval = interval.map_or(f64::INFINITY, |interval| interval.seconds);
    Some(FlowNumerics { advection, mean, pressure_change, pressure_interval })
}

fn conduction(section: &mut Section<'_>, numerics: &Numerics, setup: &Setup<'_>) -> Conduction {
    let Some(flow) = numerics.flow else { return Conduction::Plain };
    // The correction is limited together with the heat that water carries; it knows neither pipes nor curved walls, and the fourth
    // derivative that it takes out is that of even ground.
    let reason = if flow.advection != Advection::Limited {
        Some("advection = \"limited\"")
    } else if numerics.arrangement != Arrangement::Lattice {
        Some("layout = \"lattice\"")
    } else if setup.features.contains(&Feature::RandomConductivity) {
        Some("ground without \"random.conductivity\"")
    } else if setup.features.contains(&Feature::Pipes) {
        Some("a body without pipes")
    } else {
        matches!(setup.domain, Some(Domain::Ring { .. })).then_some("a line or a rectangle")
    };
    let preset = if reason.is_some() { Conduction::Plain } else { numerics.conduction };
    let found = section.choice_or("conduction", &Conduction::WORDS, preset);
    if let (Conduction::Corrected, Some(reason)) = (found, reason) {
        section.problem("conduction", format!("found \"corrected\", which needs {reason}"));
    }
    found
}

fn step(section: &mut Section<'_>, preset: StepChoice, by_error: bool) -> StepChoice {
    let fixed = section.optional_duration("step", Range::POSITIVE);
    if by_error {
        section.refuse("step_fraction", "steps follow the tolerance");
    }
    let fraction = section.optional_number("step_fraction", Range::above_to(0.0, 1.0));
    if let (Some(_), Some(_)) = (fixed, fraction) {
        let message = format!("found beside \"{}\", must be only one of them", section.time_key("step"));
        section.problem("step_fraction", message);
    }
    let fixed = fixed.map(|step| StepChoice::Fixed(step.seconds));
    fixed.or(fraction.map(StepChoice::Fraction)).unwrap_or(preset)
}

/// Settings that exclude each other, or what the scene has.
fn combinations(section: &mut Section<'_>, numerics: &Numerics, setup: &Setup<'_>, kind: &MethodKind) {
    let mut features = setup.features.to_vec();
    features.extend(capability::of_settings(numerics, kind, setup.brings_heat));
    for row in capability::exclusions(&features) {
        match row.asked.place() {
            // Said once, of the scene.
            Place::Scene(_) => {}
            Place::Setting(key) => {
                section.problem(key, row.message());
            }
            Place::Method => {
                section.section_problem(row.message());
            }
        }
    }
}
