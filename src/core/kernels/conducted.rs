//! What a pair conducts by what its ends hold.

/// How the conductivities of both ends of a pair count.
pub trait Conducted: Copy + Send + Sync {
    /// Whether they count at all.
    const BY_CONDUCTIVITY: bool;
    /// The conductivity (W/mK) of the pair; the same from either end.
    fn mean(a: f64, b: f64) -> f64;
}

/// Potentials hold all there is to know.
#[derive(Debug, Clone, Copy)]
pub struct Even;

/// 2ab/(a+b).
#[derive(Debug, Clone, Copy)]
pub struct Harmonic;

/// (a+b)/2.
#[derive(Debug, Clone, Copy)]
pub struct Arithmetic;

/// sqrt(ab).
#[derive(Debug, Clone, Copy)]
pub struct Geometric;

impl Conducted for Even {
    const BY_CONDUCTIVITY: bool = false;

    #[inline(always)]
    fn mean(_: f64, _: f64) -> f64 {
        1.0
    }
}

impl Conducted for Harmonic {
    const BY_CONDUCTIVITY: bool = true;

    #[inline(always)]
    fn mean(a: f64, b: f64) -> f64 {
        2.0 * a * b / (a + b)
    }
}

impl Conducted for Arithmetic {
    const BY_CONDUCTIVITY: bool = true;

    #[inline(always)]
    fn mean(a: f64, b: f64) -> f64 {
        0.5 * (a + b)
    }
}

impl Conducted for Geometric {
    const BY_CONDUCTIVITY: bool = true;

    #[inline(always)]
    fn mean(a: f64, b: f64) -> f64 {
        (a * b).sqrt()
    }
}
