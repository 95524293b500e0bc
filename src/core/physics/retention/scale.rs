//! The scale on which pressure heads are counted inside: heads above saturation, and logarithms of suctions below.
//!
//! Suctions of dry ground have hundreds of digits, and dry ground exactly has none that is finite. On a scale that grows with
//! the logarithm, all of them are numbers of the size of others, in the same order, so all that is said of temperatures
//! holds of it: ground at rest has one everywhere, and interfaces share it.

/// Suction (m) up to which the scale is about even.
const EVEN: f64 = 1.0;

/// The place of ground that holds no water but the residual.
pub const DRY: f64 = -1000.0;

/// The largest suction (m) that has a place of its own above [`DRY`].
pub const DRIEST: f64 = 1e290;

/// The place of a pressure head (m): itself above zero, `-ln(1 + suction)` below.
pub fn place(head: f64) -> f64 {
    if head >= 0.0 {
        head
    } else if -head > DRIEST {
        DRY
    } else {
        -EVEN * libm::log1p(-head / EVEN)
    }
}

/// The suction (m) at a place below zero.
pub fn suction(place: f64) -> f64 {
    EVEN * libm::expm1(-place / EVEN)
}

/// The pressure head (m) at a place; infinite for dry ground.
pub fn head(place: f64) -> f64 {
    if place >= 0.0 {
        place
    } else if place <= DRY {
        f64::NEG_INFINITY
    } else {
        -suction(place)
    }
}

/// By how much the suction rises over the place (m) at a place below zero.
pub fn stretch(place: f64) -> f64 {
    libm::exp(-place / EVEN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_come_back_from_their_places() {
        for head_m in [3.0, 0.0, -1e-12, -0.1, -1.0, -5.9e3, -3.5e7, -1e160, f64::NEG_INFINITY] {
            let back = head(place(head_m));
            assert!(back == head_m || (back / head_m - 1.0).abs() < 1e-12, "{head_m}: {back}");
        }
    }

    #[test]
    fn places_have_the_order_of_heads() {
        let heads = [1.0, 0.0, -1e-9, -1.0, -1e3, -1e100, -DRIEST, f64::NEG_INFINITY];
        assert!(heads.windows(2).all(|pair| place(pair[0]) > place(pair[1])));
    }
}
