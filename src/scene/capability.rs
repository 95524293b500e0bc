//! What does not go together, and why: the one table that the reader refuses by, the guide prints and a test tries.
//!
//! Whatever is not in it goes together, under every method.

use frazil_core::balances::groundwater::numerics::{Advection, FlowNumerics};
use frazil_core::bonds::exchange::Exchange;
use frazil_core::boundary::wall_layers::WallModel;
use frazil_core::physics::latent_heat::{LatentHeatScheme, Mushy};
use frazil_core::physics::material::Material;

use crate::method::MethodKind;
use crate::settings::{Arrangement, Front, IntegratorChoice, Numerics, SearchChoice};

/// Something that a scene, the settings of a method or the method itself brings along.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    /// Unsaturated water instead of heat.
    UnsaturatedWater,
    /// Gravity that pulls unsaturated water.
    Gravity,
    /// What unsaturated water carries.
    Solute,
    /// Water that flows.
    Groundwater,
    /// A conductivity that is another along y than along x.
    Anisotropy,
    /// A conductivity that varies at random in place.
    RandomConductivity,
    /// Segments that nothing crosses.
    Cracks,
    /// A shaft that is dug.
    Excavation,
    /// Rings of freeze pipes.
    Pipes,
    /// Surfaces through which heat is counted.
    Surfaces,
    /// A body of cylindrical or spherical shells.
    Shells,
    /// The plan of a ring.
    Ring,
    /// Walls at which the body goes on at the opposite one.
    PeriodicWalls,
    /// Walls whose parts have conditions of their own.
    WallParts,
    /// Regions that release heat.
    HeatSources,
    /// A start that varies in place.
    InitialProfile,
    /// A material that freezes over an interval.
    FreezingCurve,
    /// No material that freezes at one temperature.
    NothingSharp,
    /// A method that makes its own steps.
    OwnSteps,
    /// A method whose weights are those of a lattice.
    LatticeWeights,
    /// Particles off the lattice.
    UnevenParticles,
    /// Pairs that exchange by a mean of conductivities.
    PairMeans,
    /// Temperature and released latent heat as unknowns.
    Flags,
    /// Temperature as the unknown.
    ApparentCapacity,
    /// Freezing particles that conduct as a whole phase, or as half of each.
    WholePhases,
    /// Steps of several stages.
    Stages,
    /// Explicit steps.
    ExplicitSteps,
    /// Super-time-stepping.
    Rkl2,
    /// Implicit steps.
    Implicit,
    /// Water that carries heat by what gradients mend.
    GradientAdvection,
    /// Fronts inside particles.
    SubCellFronts,
    /// Walls fitted by moving least squares.
    FittedWalls,
    /// Outermost particles that are the walls.
    InnerLayers,
    /// Ghosts of one value at walls of a flux or a film.
    NaiveOpenWalls,
    /// A sweep that the settings insist on.
    LatticeSearch,
    /// A neighbour search that the settings insist on.
    ListSearch,
}

/// Where a feature is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A key or section of the scene.
    Scene(&'static str),
    /// A key of a method's section.
    Setting(&'static str),
    /// The method itself.
    Method,
}

/// Two features that exclude each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exclusion {
    /// The one that is refused.
    pub asked: Feature,
    /// The one that it is refused beside.
    pub beside: Feature,
    /// Why.
    pub because: &'static str,
}

const fn row(asked: Feature, beside: Feature, because: &'static str) -> Exclusion {
    Exclusion { asked, beside, because }
}

const OWN_NOISE: &str = "its noise needs its own explicit steps";
const NO_ENTHALPY: &str = "the scheme advances its own unknowns with explicit steps";
const LIMITED: &str = "the limiter of the gradient correction is defined for one explicit step";
const AT_ONCE: &str = "saturated ground has no explicit step bound";
const BY_PAIRS: &str = "the lattice sweep does not support it";
const FREEZING_UNSATURATED: &str = "ice, water and air in the same pores need a law for their pressures";
const CURVED_WALL: &str = "the water flux through a curved wall is not a sum over pairs";
const WHOLE_LATTICE: &str = "sub-cell fronts are located along the rows of a lattice";
const IMAGES: &str = "behind walls there are mirror images of them";
const NOT_FITTED: &str = "behind periodic walls there are the particles at the opposite wall";
const ISOTROPIC_WALL: &str = "the exchange at this kind of wall is fitted for an isotropic conductivity";
const FIXED_LAYERS: &str = "the layers of the wall cannot be cut";

/// All pairs that exclude each other.
pub const EXCLUSIONS: [Exclusion; 89] = {
    use Feature::{
        Anisotropy, ApparentCapacity, Cracks, Excavation, ExplicitSteps, FittedWalls, Flags, FreezingCurve,
        GradientAdvection, Gravity, Groundwater, HeatSources, Implicit, InitialProfile, InnerLayers, LatticeSearch,
        LatticeWeights, ListSearch, NaiveOpenWalls, NothingSharp, OwnSteps, PairMeans, PeriodicWalls, Pipes,
        RandomConductivity, Ring, Rkl2, Shells, Solute, Stages, SubCellFronts, Surfaces, UnevenParticles,
        UnsaturatedWater, WallParts, WholePhases,
    };
    [
        row(Groundwater, UnsaturatedWater, FREEZING_UNSATURATED),
        row(Pipes, UnsaturatedWater, FREEZING_UNSATURATED),
        row(Excavation, UnsaturatedWater, "the shaft condition is one of heat, which is not solved for"),
        row(HeatSources, UnsaturatedWater, "heat is not solved for"),
        row(OwnSteps, UnsaturatedWater, "its noise is thermal noise"),
        row(Flags, UnsaturatedWater, "unsaturated water has no latent heat"),
        row(ApparentCapacity, UnsaturatedWater, "unsaturated water has no latent heat"),
        row(WholePhases, UnsaturatedWater, "unsaturated water does not freeze"),
        row(SubCellFronts, UnsaturatedWater, "a wetting front is not sharp"),
        row(ExplicitSteps, UnsaturatedWater, AT_ONCE),
        row(Rkl2, UnsaturatedWater, AT_ONCE),
        row(Gravity, Shells, "gravity does not have the symmetry of shells"),
        row(Gravity, Ring, CURVED_WALL),
        row(
            PairMeans,
            Gravity,
            "a mean of conductivities multiplies a difference of pressure heads, which has no part for the elevation",
        ),
        row(InnerLayers, Gravity, "the layers of the wall have no elevation"),
        row(LatticeSearch, Gravity, BY_PAIRS),
        row(Solute, Shells, "the water flux through the walls of shells is not a sum over pairs"),
        row(Solute, Ring, CURVED_WALL),
        row(InitialProfile, Ring, "a plan across the pipes lies at one depth"),
        row(Groundwater, Shells, "groundwater flows through a line, a rectangle or a ring"),
        row(Anisotropy, UnsaturatedWater, "hydraulic conductivities are isotropic"),
        row(Anisotropy, Groundwater, "permeabilities are isotropic, and water flows along the pairs that conduct heat"),
        row(Anisotropy, Shells, "the weights of shells follow from an isotropic profile"),
        row(Anisotropy, WallParts, ISOTROPIC_WALL),
        row(UnevenParticles, Anisotropy, "second moments in both directions need a lattice"),
        row(FittedWalls, Anisotropy, ISOTROPIC_WALL),
        row(InnerLayers, Anisotropy, ISOTROPIC_WALL),
        row(NaiveOpenWalls, Anisotropy, ISOTROPIC_WALL),
        row(PeriodicWalls, Groundwater, "groundwater is driven and counted by the conditions at its walls"),
        row(PeriodicWalls, Shells, "shells do not repeat along the radius"),
        row(PeriodicWalls, Pipes, "gaps between pipes are those of one period"),
        row(PeriodicWalls, Cracks, IMAGES),
        row(PeriodicWalls, WallParts, IMAGES),
        row(FittedWalls, PeriodicWalls, NOT_FITTED),
        row(InnerLayers, PeriodicWalls, NOT_FITTED),
        row(NaiveOpenWalls, PeriodicWalls, NOT_FITTED),
        row(RandomConductivity, Shells, "a random field does not have the symmetry of shells"),
        row(Groundwater, WallParts, "inflow through a wall has one temperature"),
        row(OwnSteps, Groundwater, "its noise balances conduction only, not advection"),
        row(OwnSteps, Shells, "its particles have equal volumes"),
        row(OwnSteps, Surfaces, "random heat fluxes through surfaces are not counted"),
        row(Stages, OwnSteps, OWN_NOISE),
        row(Stages, ApparentCapacity, NO_ENTHALPY),
        row(Flags, HeatSources, NO_ENTHALPY),
        row(ApparentCapacity, HeatSources, NO_ENTHALPY),
        row(Stages, WholePhases, "the last complete phase is known only after complete steps"),
        row(GradientAdvection, Implicit, LIMITED),
        row(Flags, FreezingCurve, "the latent-heat accumulator needs a single freezing temperature"),
        row(ApparentCapacity, Groundwater, NO_ENTHALPY),
        row(WholePhases, Groundwater, "the last complete phase is known only after complete steps"),
        row(UnevenParticles, Shells, "shells are evenly spaced along the radius"),
        row(UnevenParticles, Pipes, "the regularised delta of a pipe needs a lattice"),
        row(UnevenParticles, LatticeWeights, "its weights are defined for nearest neighbours on a lattice only"),
        row(SubCellFronts, OwnSteps, OWN_NOISE),
        row(SubCellFronts, Shells, WHOLE_LATTICE),
        row(SubCellFronts, RandomConductivity, "sub-cell fronts need a uniform conductivity"),
        row(SubCellFronts, WallParts, WHOLE_LATTICE),
        row(SubCellFronts, UnevenParticles, WHOLE_LATTICE),
        row(SubCellFronts, ListSearch, WHOLE_LATTICE),
        row(SubCellFronts, PairMeans, "sub-cell fronts exchange heat by the conduction potential"),
        row(SubCellFronts, ApparentCapacity, NO_ENTHALPY),
        row(SubCellFronts, WholePhases, "sub-cell fronts need the frozen fraction"),
        row(SubCellFronts, NothingSharp, "materials with a freezing interval have no sharp front"),
        row(SubCellFronts, FittedWalls, WHOLE_LATTICE),
        row(SubCellFronts, InnerLayers, WHOLE_LATTICE),
        row(SubCellFronts, NaiveOpenWalls, WHOLE_LATTICE),
        row(FittedWalls, Shells, "walls of shells use the steady profile"),
        row(FittedWalls, Groundwater, "the fit does not conserve water"),
        row(FittedWalls, Cracks, "the fit extends across cracks"),
        row(FittedWalls, Excavation, "the fit extends across the face of the shaft"),
        row(InnerLayers, Ring, "layers cannot follow the curved wall"),
        row(InnerLayers, Cracks, FIXED_LAYERS),
        row(InnerLayers, Groundwater, "water needs walls half-way between particles"),
        row(InnerLayers, OwnSteps, "its noise balances the exchange with a mirrored wall only"),
        row(NaiveOpenWalls, Ring, "layers cannot follow the curved wall"),
        row(NaiveOpenWalls, Cracks, FIXED_LAYERS),
        row(NaiveOpenWalls, Groundwater, "water needs walls half-way between particles"),
        row(NaiveOpenWalls, OwnSteps, "its noise balances the exchange with a mirrored wall only"),
        row(LatticeSearch, OwnSteps, BY_PAIRS),
        row(LatticeSearch, Shells, BY_PAIRS),
        row(LatticeSearch, WallParts, BY_PAIRS),
        row(LatticeSearch, UnevenParticles, BY_PAIRS),
        row(LatticeSearch, PairMeans, BY_PAIRS),
        row(LatticeSearch, RandomConductivity, BY_PAIRS),
        row(LatticeSearch, ApparentCapacity, BY_PAIRS),
        row(LatticeSearch, WholePhases, BY_PAIRS),
        row(LatticeSearch, FittedWalls, BY_PAIRS),
        row(LatticeSearch, InnerLayers, BY_PAIRS),
        row(LatticeSearch, NaiveOpenWalls, BY_PAIRS),
    ]
};

impl Exclusion {
    /// What is wrong, in words.
    pub fn message(&self) -> String {
        format!("{} cannot be combined with {}: {}", self.asked.words(), self.beside.words(), self.because)
    }
}

/// The pairs among these features that exclude each other.
pub fn exclusions(features: &[Feature]) -> impl Iterator<Item = &'static Exclusion> + '_ {
    EXCLUSIONS.iter().filter(|row| features.contains(&row.asked) && features.contains(&row.beside))
}

/// All features, in words as messages have them, and where each is asked for.
const FEATURES: [(Feature, &str, Place); 36] = [
    (Feature::UnsaturatedWater, "balance = \"water\"", Place::Scene("balance")),
    (Feature::Gravity, "\"gravity\"", Place::Scene("gravity")),
    (Feature::Solute, "a solute", Place::Scene("materials")),
    (Feature::Groundwater, "\"flow\"", Place::Scene("flow")),
    (Feature::Anisotropy, "\"anisotropy\"", Place::Scene("anisotropy")),
    (Feature::RandomConductivity, "\"random.conductivity\"", Place::Scene("random")),
    (Feature::Cracks, "\"cracks\"", Place::Scene("cracks")),
    (Feature::Excavation, "\"excavation\"", Place::Scene("excavation")),
    (Feature::Pipes, "\"pipes\"", Place::Scene("pipes")),
    (Feature::Surfaces, "\"watch.surfaces\"", Place::Scene("watch")),
    (Feature::Shells, "a body of shells", Place::Scene("domain")),
    (Feature::Ring, "the domain \"ring\"", Place::Scene("domain")),
    (Feature::PeriodicWalls, "condition = \"periodic\"", Place::Scene("walls")),
    (Feature::WallParts, "a wall in parts", Place::Scene("walls")),
    (Feature::HeatSources, "\"heat\" of a region", Place::Scene("regions")),
    (Feature::InitialProfile, "a start that varies in place", Place::Scene("initial")),
    (Feature::FreezingCurve, "a material that freezes over an interval", Place::Scene("materials")),
    (Feature::NothingSharp, "materials without a sharp freezing point", Place::Scene("materials")),
    (Feature::OwnSteps, "a method with its own time steps", Place::Method),
    (Feature::LatticeWeights, "a lattice-only method", Place::Method),
    (Feature::UnevenParticles, "a layout other than \"lattice\"", Place::Setting("layout")),
    (Feature::PairMeans, "a mean of conductivities", Place::Setting("mean")),
    (Feature::Flags, "scheme = \"flags\"", Place::Setting("scheme")),
    (Feature::ApparentCapacity, "scheme = \"apparent-capacity\"", Place::Setting("scheme")),
    (Feature::WholePhases, "mushy other than true", Place::Setting("mushy")),
    (Feature::Stages, "integrator other than \"euler\"", Place::Setting("integrator")),
    (Feature::ExplicitSteps, "integrator = \"euler\" or \"heun\"", Place::Setting("integrator")),
    (Feature::Rkl2, "integrator = \"rkl2\"", Place::Setting("integrator")),
    (Feature::Implicit, "integrator = \"implicit\"", Place::Setting("integrator")),
    (Feature::GradientAdvection, "advection = \"limited\" or \"central\"", Place::Setting("advection")),
    (Feature::SubCellFronts, "front = \"sub-cell\"", Place::Setting("front")),
    (Feature::FittedWalls, "wall_model = \"moving-least-squares\"", Place::Setting("wall_model")),
    (Feature::InnerLayers, "wall_model = \"inner-layers\"", Place::Setting("wall_model")),
    (Feature::NaiveOpenWalls, "wall_model = \"naive\" at a wall of a flux or a film", Place::Setting("wall_model")),
    (Feature::LatticeSearch, "search = \"lattice\"", Place::Setting("search")),
    (Feature::ListSearch, "search other than \"auto\" and \"lattice\"", Place::Setting("search")),
];

impl Feature {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Feature> {
        FEATURES.iter().map(|row| row.0)
    }

    /// In words, as messages have it.
    pub fn words(self) -> &'static str {
        FEATURES[self as usize].1
    }

    /// Where it is asked for.
    pub fn place(self) -> Place {
        FEATURES[self as usize].2
    }
}

/// What materials bring along.
pub(crate) fn of_materials(materials: &[Material]) -> impl Iterator<Item = Feature> {
    let sharp = materials.iter().any(Material::is_sharp);
    let features = [
        (materials.iter().any(Material::has_curve), Feature::FreezingCurve),
        (!materials.is_empty() && !sharp, Feature::NothingSharp),
    ];
    features.into_iter().filter(|feature| feature.0).map(|feature| feature.1)
}

/// What a method and its settings bring along, at walls that bring heat or not.
pub(crate) fn of_settings(numerics: &Numerics, kind: &MethodKind, brings_heat: bool) -> impl Iterator<Item = Feature> {
    let rkl2 = matches!(numerics.integrator, IntegratorChoice::Rkl2 { .. } | IntegratorChoice::ControlledRkl2 { .. });
    let apparent = matches!(numerics.latent_heat_scheme, LatentHeatScheme::ApparentCapacity { .. });
    let naive = numerics.walls == WallModel::Naive && brings_heat;
    let stages = match numerics.integrator {
        IntegratorChoice::Euler => false,
        // What water carries asks for them.
        IntegratorChoice::Heun => numerics.flow.is_none(),
        _ => true,
    };
    let mended = |flow: &FlowNumerics| matches!(flow.advection, Advection::Limited | Advection::Central);
    let features = [
        (kind.stochastic, Feature::OwnSteps),
        (kind.lattice_only, Feature::LatticeWeights),
        (numerics.arrangement != Arrangement::Lattice, Feature::UnevenParticles),
        (numerics.exchange != Exchange::Potential, Feature::PairMeans),
        (numerics.latent_heat_scheme == LatentHeatScheme::Flags, Feature::Flags),
        (apparent, Feature::ApparentCapacity),
        (numerics.mushy != Mushy::Fraction, Feature::WholePhases),
        (stages, Feature::Stages),
        (numerics.integrator.is_monotone(), Feature::ExplicitSteps),
        (rkl2, Feature::Rkl2),
        (matches!(numerics.integrator, IntegratorChoice::Implicit { .. }), Feature::Implicit),
        (numerics.flow.as_ref().is_some_and(mended), Feature::GradientAdvection),
        (numerics.front == Front::SubCell, Feature::SubCellFronts),
        (numerics.walls == WallModel::MovingLeastSquares, Feature::FittedWalls),
        (numerics.walls == WallModel::InnerLayers, Feature::InnerLayers),
        (naive, Feature::NaiveOpenWalls),
        (numerics.search == SearchChoice::Lattice, Feature::LatticeSearch),
        (!matches!(numerics.search, SearchChoice::Auto | SearchChoice::Lattice), Feature::ListSearch),
    ];
    features.into_iter().filter(|feature| feature.0).map(|feature| feature.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_feature_has_the_row_of_its_own_number() {
        assert!(Feature::all().enumerate().all(|(number, feature)| feature as usize == number));
    }
}
