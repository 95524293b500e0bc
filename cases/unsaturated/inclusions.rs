//! Discs of other soil in a square.

use super::CENTIMETRE;
use crate::BadTable;
use crate::table::NumberTable;

/// A disc in the square of 0.1 m, from whose lower left corner its centre is counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inclusion {
    /// Centre (m).
    pub x: f64,
    /// Centre (m).
    pub y: f64,
    /// Radius (m).
    pub radius: f64,
    /// By what conductivity and diffusion are smaller where the discs are permeable.
    pub factor: f64,
}

/// The shipped discs.
///
/// # Errors
///
/// If their table cannot be read.
pub fn inclusions() -> Result<Vec<Inclusion>, BadTable> {
    let table = NumberTable::read(include_str!("../tables/unsaturated-inclusions.csv"))?;
    let [x, y] = [table.column("x_cm")?, table.column("y_cm")?];
    let [radius, factor] = [table.column("radius_cm")?, table.column("factor")?];
    let disc = |row: usize| Inclusion {
        x: x[row] * CENTIMETRE,
        y: y[row] * CENTIMETRE,
        radius: radius[row] * CENTIMETRE,
        factor: factor[row],
    };
    Ok((0..x.len()).map(disc).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discs_lie_apart_inside_the_square() {
        let discs = inclusions().expect("discs");
        assert_eq!(discs.len(), 12);
        for (index, disc) in discs.iter().enumerate() {
            assert!((0.0..1.0).contains(&disc.factor) && (0.0045..=0.01).contains(&disc.radius));
            for place in [disc.x, disc.y] {
                assert!(place > disc.radius && place < 0.1 - disc.radius);
            }
            for other in &discs[..index] {
                let gap = (disc.x - other.x).hypot(disc.y - other.y) - disc.radius - other.radius;
                assert!(gap > 0.003 - 1e-9, "{gap}");
            }
        }
    }
}
