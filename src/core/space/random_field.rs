//! Properties that vary at random in place: log-normal factors, as functions of place.
//!
//! A factor is `exp(s z(x))` with the Gaussian field `z(x) = sqrt(2/N) sum_n cos(k_n . x + phi_n)`, whose wave vectors are drawn
//! from the spectral density of its covariance and whose phases are even (Shinozuka and Jan 1972). It has mean 0 and
//! variance 1 over all seeds, and the covariance of the infinite sum whatever N is. Nothing of it is stored by place, so that it is
//! the same under every spacing, method and layout.

use std::f64::consts::{SQRT_2, TAU};
use std::sync::Arc;

use glam::DVec2;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use crate::team::{Team, share};

/// Places that are looked at together.
const TASK: usize = 256;

/// Waves of a field: its values are normal to a kurtosis of `3 - 3 / (2 N)`.
const WAVES: usize = 512;

/// Least denominator of a Cauchy number: waves shorter than a billionth of the correlation length are seen by nobody.
const LEAST: f64 = 1e-9;

/// How correlation falls with the distance r, counted in correlation lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Covariance {
    /// `exp(-r)`: rough at all scales.
    Exponential,
    /// `exp(-r^2)`: smooth.
    Gaussian,
}

impl Covariance {
    /// All of them, in words.
    pub const WORDS: [(&str, Covariance); 2] =
        [("exponential", Covariance::Exponential), ("gaussian", Covariance::Gaussian)];
}

/// A property that varies at random: its logarithm is normal around that of the materials.
#[derive(Debug, Clone, PartialEq)]
pub struct Variation {
    /// Standard deviation of the logarithm.
    pub log_deviation: f64,
    /// Correlation lengths (m) along x and y.
    pub lengths: DVec2,
    /// How it is correlated.
    pub covariance: Covariance,
    /// Which one of all such fields it is.
    pub seed: u64,
}

/// A factor of place.
#[derive(Debug, Clone)]
pub struct RandomField {
    amplitude: f64,
    /// Wave vectors (1/m) and phases.
    waves: Vec<(DVec2, f64)>,
}

impl RandomField {
    /// The field of a variation.
    pub fn new(variation: &Variation) -> Self {
        let mut random = StdRng::seed_from_u64(variation.seed);
        let wave = |_| {
            let mut normal = || random.sample::<f64, _>(StandardNormal);
            let (direction, denominator) = (DVec2::new(normal(), normal()), normal());
            // The spectrum of exp(-r) is a Cauchy density in any dimension, that of exp(-r^2) a normal one of variance 2.
            let vector = match variation.covariance {
                Covariance::Exponential => direction / denominator.abs().max(LEAST),
                Covariance::Gaussian => SQRT_2 * direction,
            };
            (vector / variation.lengths, TAU * random.random::<f64>())
        };
        let waves = (0..WAVES).map(wave).collect();
        RandomField { amplitude: variation.log_deviation * (2.0 / WAVES as f64).sqrt(), waves }
    }

    /// The factor at a place (m).
    pub fn at(&self, place: DVec2) -> f64 {
        let sum: f64 = self.waves.iter().map(|(vector, phase)| (vector.dot(place) + phase).cos()).sum();
        (self.amplitude * sum).exp()
    }

    /// The factors at places (m), found by all threads of a team.
    pub fn at_all(&self, places: &[DVec2], team: Option<&Team>) -> Arc<[f64]> {
        let mut factors = vec![0.0; places.len()];
        let tasks = places.chunks(TASK).zip(factors.chunks_mut(TASK));
        let fill = |(places, factors): (&[DVec2], &mut [f64])| {
            factors.iter_mut().zip(places).for_each(|(factor, place)| *factor = self.at(*place));
        };
        share(team, tasks, fill);
        factors.into()
    }
}

/// What conducts between two places in series, by the factors of both.
#[inline]
pub fn between(a: f64, b: f64) -> f64 {
    2.0 * a * b / (a + b)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEEDS: u64 = 4000;

    /// The logarithms over the deviation, at two places of each of many fields.
    fn sample(covariance: Covariance, way: DVec2) -> Vec<(f64, f64)> {
        let of = |seed: u64| {
            let variation = Variation { log_deviation: 0.7, lengths: DVec2::new(0.2, 0.05), covariance, seed };
            let field = RandomField::new(&variation);
            let at = |place: DVec2| field.at(place).ln() / variation.log_deviation;
            let place = DVec2::new(0.3, 1.7);
            (at(place), at(place + way))
        };
        (0..SEEDS).map(of).collect()
    }

    /// Means of `SEEDS` independent numbers scatter by their standard deviation over the root of that: 1 for the values, the root of
    /// 2 for their squares, the root of `1 + c^2` for products of two with the correlation c. Five times that is found by
    /// chance once in a million.
    #[test]
    fn the_field_has_its_mean_its_variance_and_its_correlation() {
        let scatter = 5.0 / (SEEDS as f64).sqrt();
        for covariance in [Covariance::Exponential, Covariance::Gaussian] {
            for (way, lengths) in [
                (DVec2::new(0.1, 0.0), 0.5),
                (DVec2::new(0.0, 0.05), 1.0),
                (DVec2::new(-0.12, 0.04), 1.0),
                (DVec2::new(0.4, 0.0), 2.0),
            ] {
                let values = sample(covariance, way);
                let mean = |of: &dyn Fn(&(f64, f64)) -> f64| values.iter().map(of).sum::<f64>() / SEEDS as f64;
                let wanted = match covariance {
                    Covariance::Exponential => f64::exp(-lengths),
                    Covariance::Gaussian => f64::exp(-lengths * lengths),
                };
                assert!(mean(&|pair| pair.0).abs() < scatter);
                assert!((mean(&|pair| pair.1 * pair.1) - 1.0).abs() < 2f64.sqrt() * scatter);
                let found = mean(&|pair| pair.0 * pair.1);
                let allowed = (1.0 + wanted * wanted).sqrt() * scatter;
                assert!((found - wanted).abs() < allowed, "{covariance:?} at {lengths}: {found}, not {wanted}");
            }
        }
    }

    /// Two fields of one seed are one, and their amplitude is the deviation alone.
    #[test]
    fn a_seed_is_a_field() {
        let field = |log_deviation: f64, seed: u64| {
            let covariance = Covariance::Exponential;
            RandomField::new(&Variation { log_deviation, lengths: DVec2::ONE, covariance, seed })
                .at(DVec2::new(0.2, 0.9))
        };
        assert_eq!(field(0.5, 3), field(0.5, 3));
        assert!((field(1.0, 3).ln() - 2.0 * field(0.5, 3).ln()).abs() < 1e-12);
        assert_ne!(field(0.5, 3), field(0.5, 4));
    }
}
