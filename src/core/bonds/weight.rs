//! What a method is: a weight for each bond.

/// Geometry of a pair: seam 2. A weight knows the distance of two particles and nothing of heat.
///
/// A scaled weight `w(r)` (m^-(d+2)) enters the heat balance of particle i as
/// `V_i dH_i/dt = sum_j V_i V_j w(r_ij) (U_j - U_i)`, so in the continuum `integral of w r^2 dV = 2 d`.
/// It must not be negative, and should not grow with distance: a mirror wall then keeps the maximum principle, for a
/// particle is nearer to its neighbour than to the neighbour's image. Corners of two walls see to themselves
/// (`kernels::corner`).
pub trait PairWeight: Send + Sync {
    /// Distance (m) beyond which the weight is zero.
    fn reach(&self) -> f64;
    /// The weight at a distance (m) greater than zero.
    fn weight(&self, distance: f64) -> f64;
}

/// How weights are scaled to the wanted conductivity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normalisation {
    /// By the second moment of the actual neighbourhood: exact for quadratic fields on a lattice.
    DiscreteMoment,
    /// Not at all: the continuum constant, as the papers print it.
    Nominal,
}

/// Weights of tests, which fall with the distance by a power, up to a reach.
#[cfg(test)]
pub(crate) struct Disc(pub(crate) f64, pub(crate) f64);

#[cfg(test)]
impl PairWeight for Disc {
    fn reach(&self) -> f64 {
        self.0
    }

    fn weight(&self, distance: f64) -> f64 {
        distance.powf(-self.1)
    }
}
