//! Walls that exchange heat with their surroundings by their own temperature, a file for each kind. A new one is its file here
//! and its two lines below.

pub mod convection;
pub mod law;
pub mod radiation;

use std::ops::Bound;

use crate::physics::root::solve_increasing;
use law::FilmLaw;

/// Makes the list of exchanges from their types: what a step asks of one is known where it is compiled.
macro_rules! films {
    ($($file:ident::$kind:ident),* $(,)?) => {
        /// A kind of exchange.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[expect(missing_docs, reason = "each exchange says itself what it is")]
        pub enum FilmKind {
            $($kind),*
        }

        /// All kinds.
        pub const FILMS: &[FilmKind] = &[$(FilmKind::$kind),*];

        impl FilmKind {
            /// Key of its strength in scenes, and the unit of that.
            pub fn key(self) -> (&'static str, &'static str) {
                match self { $(FilmKind::$kind => $file::$kind::KEY),* }
            }

            /// Least and greatest strength.
            pub fn range(self) -> (Bound<f64>, Bound<f64>) {
                match self { $(FilmKind::$kind => $file::$kind::RANGE),* }
            }

            /// Whether scenes in other units than SI can not have it.
            pub fn needs_si(self) -> bool {
                match self { $(FilmKind::$kind => $file::$kind::NEEDS_SI),* }
            }

            /// What it is called, and the unit of its strength for people.
            pub fn words(self) -> (&'static str, &'static str) {
                match self { $(FilmKind::$kind => ($file::$kind::NAME, $file::$kind::UNIT)),* }
            }

            fn is_linear(self) -> bool {
                match self { $(FilmKind::$kind => $file::$kind::IS_LINEAR),* }
            }
        }

        impl Film {
            /// Flux into a wall of this temperature over what the surroundings are warmer (W/m2K).
            #[inline]
            pub fn coefficient(&self, wall: f64) -> f64 {
                match self.kind { $(FilmKind::$kind => $file::$kind::coefficient(self.strength, self.ambient, wall)),* }
            }

            /// By how much the flux falls with the temperature of the wall (W/m2K).
            #[inline]
            pub fn steepness(&self, wall: f64) -> f64 {
                match self.kind { $(FilmKind::$kind => $file::$kind::steepness(self.strength, self.ambient, wall)),* }
            }
        }
    };
}

films![convection::Convection, radiation::Radiation];

/// An exchange at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Film {
    /// Its kind.
    pub kind: FilmKind,
    /// Its strength, as its kind counts it.
    pub strength: f64,
    /// Temperature of the surroundings.
    pub ambient: f64,
}

impl Film {
    /// A film of a coefficient (W/m2K).
    pub fn convection(coefficient: f64, ambient: f64) -> Self {
        Film { kind: FilmKind::Convection, strength: coefficient, ambient }
    }

    /// Whether no heat passes.
    pub fn is_closed(&self) -> bool {
        self.strength == 0.0
    }

    /// Whether the coefficient is one number, whatever the temperature of the wall.
    pub fn is_linear(&self) -> bool {
        self.kind.is_linear()
    }

    /// The coefficient (W/m2K) at the temperature that a wall takes before a particle of temperature `inside`, with a layer
    /// of this conductivity (W/mK) and depth (m) between them.
    pub fn coefficient_before(&self, inside: f64, conductivity: f64, depth: f64) -> f64 {
        if self.is_linear() {
            return self.strength;
        }
        let missing = |wall: f64| {
            let flux = self.coefficient(wall) * (self.ambient - wall);
            (conductivity * (wall - inside) - flux * depth, conductivity + self.steepness(wall) * depth)
        };
        self.coefficient(solve_increasing(missing, inside.min(self.ambient), inside.max(self.ambient)))
    }
}
