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
    /// Walls whose parts have conditions of their own.
    WallParts,
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

const OWN_NOISE: &str = "its noise is exchanged at explicit steps of its own";
const NO_ENTHALPY: &str = "the scheme advances unknowns of its own by explicit steps";
const LIMITED: &str = "what gradients mend is limited by what one explicit step may do";
const AT_ONCE: &str = "pressure spreads through saturated ground at once";
const BY_PAIRS: &str = "the sweep over a lattice knows no such rows";
const WHOLE_LATTICE: &str = "the front in a cell is seen along the rows of a lattice";
const FIXED_LAYERS: &str = "layers of particles stand for the wall, whatever cuts them off";

/// All pairs that exclude each other.
pub const EXCLUSIONS: [Exclusion; 69] = {
    use Feature::{
        ApparentCapacity, Cracks, Excavation, ExplicitSteps, FittedWalls, Flags, FreezingCurve, GradientAdvection,
        Gravity, Groundwater, Implicit, InnerLayers, LatticeSearch, LatticeWeights, ListSearch, NaiveOpenWalls,
        NothingSharp, OwnSteps, PairMeans, Pipes, RandomConductivity, Ring, Rkl2, Shells, Solute, Stages,
        SubCellFronts, Surfaces, UnevenParticles, UnsaturatedWater, WallParts, WholePhases,
    };
    [
        row(Groundwater, UnsaturatedWater, "heat beside unsaturated water would have to freeze it in its pores"),
        row(Pipes, UnsaturatedWater, "a pipe freezes ground, and heat beside unsaturated water is not computed"),
        row(Excavation, UnsaturatedWater, "the face of a shaft exchanges heat"),
        row(OwnSteps, UnsaturatedWater, "its noise is that of heat"),
        row(Flags, UnsaturatedWater, "water has no latent heat"),
        row(ApparentCapacity, UnsaturatedWater, "water has no latent heat"),
        row(WholePhases, UnsaturatedWater, "water has no phases"),
        row(SubCellFronts, UnsaturatedWater, "a front of water is as wide as its pores make it"),
        row(ExplicitSteps, UnsaturatedWater, AT_ONCE),
        row(Rkl2, UnsaturatedWater, AT_ONCE),
        row(Gravity, Shells, "shells lie around an axis, and gravity pulls one way"),
        row(Gravity, Ring, "water through a curved wall is not told by pairs"),
        row(PairMeans, Gravity, "a mean of conductivities is taken along with heads alone"),
        row(InnerLayers, Gravity, "a wall of particles stands at no height of its own"),
        row(LatticeSearch, Gravity, BY_PAIRS),
        row(Solute, Shells, "walls touch shells, and water through touching walls is not told by pairs"),
        row(Solute, Ring, "water through a curved wall is not told by pairs"),
        row(Groundwater, Shells, "water flows through a line, a rectangle or a ring"),
        row(RandomConductivity, Shells, "a shell is even all around"),
        row(Groundwater, WallParts, "what water brings through a wall has one temperature"),
        row(OwnSteps, Groundwater, "its noise is balanced against conduction, and not against what water carries"),
        row(OwnSteps, Shells, "its particles are of one volume"),
        row(OwnSteps, Surfaces, "its random heat is not counted through surfaces"),
        row(Stages, OwnSteps, OWN_NOISE),
        row(Stages, ApparentCapacity, NO_ENTHALPY),
        row(Stages, WholePhases, "the phase that a particle last was is known at whole steps alone"),
        row(GradientAdvection, Implicit, LIMITED),
        row(Flags, FreezingCurve, "the accumulator of latent heat fills at one temperature"),
        row(ApparentCapacity, Groundwater, NO_ENTHALPY),
        row(WholePhases, Groundwater, "the phase that a particle last was is known at whole steps alone"),
        row(UnevenParticles, Shells, "shells stand evenly along the radius"),
        row(UnevenParticles, Pipes, "a pipe acts on particles that stand evenly around it"),
        row(UnevenParticles, LatticeWeights, "it has weights for the nearest neighbours on a lattice alone"),
        row(SubCellFronts, OwnSteps, OWN_NOISE),
        row(SubCellFronts, Shells, WHOLE_LATTICE),
        row(SubCellFronts, RandomConductivity, "the front in a cell lies in ground that conducts evenly"),
        row(SubCellFronts, WallParts, WHOLE_LATTICE),
        row(SubCellFronts, UnevenParticles, WHOLE_LATTICE),
        row(SubCellFronts, ListSearch, WHOLE_LATTICE),
        row(SubCellFronts, PairMeans, "a front has a potential, and no conductivity of its own"),
        row(SubCellFronts, ApparentCapacity, NO_ENTHALPY),
        row(SubCellFronts, WholePhases, "a front lies where the frozen fraction says"),
        row(SubCellFronts, NothingSharp, "there is no front where everything freezes over an interval"),
        row(SubCellFronts, FittedWalls, WHOLE_LATTICE),
        row(SubCellFronts, InnerLayers, WHOLE_LATTICE),
        row(SubCellFronts, NaiveOpenWalls, WHOLE_LATTICE),
        row(FittedWalls, Shells, "a body of shells knows its walls by the steady profile"),
        row(FittedWalls, Groundwater, "a fit leaks water"),
        row(FittedWalls, Cracks, "a fit reaches across them"),
        row(FittedWalls, Excavation, "a fit reaches across its face"),
        row(InnerLayers, Ring, "no layers lie along its curved wall"),
        row(InnerLayers, Cracks, FIXED_LAYERS),
        row(InnerLayers, Groundwater, "water enters through walls that lie between particles"),
        row(InnerLayers, OwnSteps, "its noise crosses mirrored walls alone"),
        row(NaiveOpenWalls, Ring, "no layers lie along its curved wall"),
        row(NaiveOpenWalls, Cracks, FIXED_LAYERS),
        row(NaiveOpenWalls, Groundwater, "water enters through walls that lie between particles"),
        row(NaiveOpenWalls, OwnSteps, "its noise crosses mirrored walls alone"),
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
        format!("{} does not go with {}: {}", self.asked.words(), self.beside.words(), self.because)
    }
}

/// The pairs among these features that exclude each other.
pub fn exclusions(features: &[Feature]) -> impl Iterator<Item = &'static Exclusion> + '_ {
    EXCLUSIONS.iter().filter(|row| features.contains(&row.asked) && features.contains(&row.beside))
}

/// All features, in words as messages have them, and where each is asked for.
const FEATURES: [(Feature, &str, Place); 32] = [
    (Feature::UnsaturatedWater, "balance = \"water\"", Place::Scene("balance")),
    (Feature::Gravity, "\"gravity\"", Place::Scene("gravity")),
    (Feature::Solute, "a solute", Place::Scene("materials")),
    (Feature::Groundwater, "\"flow\"", Place::Scene("flow")),
    (Feature::RandomConductivity, "\"random.conductivity\"", Place::Scene("random")),
    (Feature::Cracks, "\"cracks\"", Place::Scene("cracks")),
    (Feature::Excavation, "\"excavation\"", Place::Scene("excavation")),
    (Feature::Pipes, "\"pipes\"", Place::Scene("pipes")),
    (Feature::Surfaces, "\"watch.surfaces\"", Place::Scene("watch")),
    (Feature::Shells, "a body of shells", Place::Scene("domain")),
    (Feature::Ring, "the domain \"ring\"", Place::Scene("domain")),
    (Feature::WallParts, "a wall in parts", Place::Scene("walls")),
    (Feature::FreezingCurve, "a material that freezes over an interval", Place::Scene("materials")),
    (Feature::NothingSharp, "materials of which none freezes at one temperature", Place::Scene("materials")),
    (Feature::OwnSteps, "a method that makes its own steps", Place::Method),
    (Feature::LatticeWeights, "a method of the lattice", Place::Method),
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
