//! What fronts need to know of a body.

/// What fronts need to know of a body beside its particles.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// Least and greatest temperature of the scene.
    pub temperatures: (f64, f64),
    /// Left, right, bottom, top: whether what lies beyond is the mirror image of the body.
    pub mirrors: [bool; 4],
    /// Along x and y: whether the body repeats.
    pub repeats: [bool; 2],
    /// Whether fronts run along y, or along x, where nothing varies across.
    pub along_y: Option<bool>,
    /// Whether fronts may also lie on faces of particles, and at any angle. Not where equations are solved: which of two
    /// cells a front enters is not continuous, and they may have no solution. Nor beside water that carries heat: what keeps
    /// its temperatures in range counts on the exchange of all pairs.
    pub free: bool,
}
