//! Which concentration the water of a pair carries.

/// Flow over conductance, halved, below which a series takes the place of the hyperbolic tangent.
const SLOW: f64 = 1e-3;

/// Which concentration the water of a pair carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Advection {
    /// The mean of both ends, with as much exchange beside it as the range of the data needs and diffusion does not give, taken
    /// back wherever concentrations stay within those around (Zalesak 1979). Where water outruns diffusion and pairs reach to nearest
    /// neighbours only, each step of Euler in a step should be half of the bound: longer ones leave little room to take back.
    Limited,
    /// That of the steady profile between both ends (Scharfetter and Gummel 1969): keeps the range of the data, as exact as
    /// diffusion where that dominates, and smears fronts where it does not.
    Fitted,
    /// The mean of both ends, which overshoots where water outruns diffusion.
    Central,
    /// That of the end that the water comes from: keeps the range of the data and smears fronts.
    Upwind,
    /// The mean, with the water of a pair from the Darcy velocities of both ends. An even concentration stays even only as far
    /// as those velocities close the balance of water.
    Paper,
}

impl Advection {
    /// All of them with the words of the file.
    pub const WORDS: [(&str, Advection); 5] = [
        ("limited", Advection::Limited),
        ("fitted", Advection::Fitted),
        ("central", Advection::Central),
        ("upwind", Advection::Upwind),
        ("paper", Advection::Paper),
    ];

    /// Whether water carries the mean of both ends, and nothing beside it.
    pub(super) fn is_plain(self) -> bool {
        matches!(self, Advection::Central | Advection::Paper)
    }

    /// Exchange (1/s) of both ends of a pair beside the mean that its water (1/s) carries, by what it conducts (1/s).
    pub(super) fn exchange(self, flow: f64, conductance: f64) -> f64 {
        let half = 0.5 * flow.abs();
        match self {
            Advection::Central | Advection::Paper => 0.0,
            Advection::Upwind => half,
            Advection::Limited => (half - conductance).max(0.0),
            Advection::Fitted if conductance <= 0.0 => half - conductance,
            Advection::Fitted => {
                let ratio = half / conductance;
                if ratio < SLOW { half * ratio / 3.0 } else { half / ratio.tanh() - conductance }
            }
        }
    }
}
