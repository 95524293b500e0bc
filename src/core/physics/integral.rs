//! Integrals without a closed form, in a table.

use std::sync::Arc;

use crate::memory::HeapSize;

/// The integral of a function of the temperature from the freezing point down, in a table of even steps on each of its pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct Integral(Arc<Pieces>);

#[derive(Debug, PartialEq)]
struct Pieces {
    /// Ends of the pieces (K, negative), falling.
    ends: Vec<f64>,
    /// Integral and function at the steps, those of one piece after those of another.
    nodes: Vec<(f64, f64)>,
    /// Steps of a piece.
    steps: usize,
}

/// The cubic between two nodes.
struct Cubic {
    /// Integral at the first, and by how much it rises to the second.
    from: f64,
    rise: f64,
    /// Length between them, and the part of it that the place has gone.
    step: f64,
    s: f64,
    /// The function at both, times the length.
    d0: f64,
    d1: f64,
}

impl Integral {
    /// The integral of `of` over pieces that end at `ends`, each in so many steps. Below the last end the function is taken to
    /// keep its value.
    pub fn new(of: impl Fn(f64) -> f64, ends: &[f64], steps: usize) -> Self {
        let mut integral = 0.0;
        let mut nodes = Vec::with_capacity(1 + steps * ends.len());
        nodes.push((integral, of(0.0)));
        let mut top = 0.0;
        for end in ends {
            let step = (end - top) / steps as f64;
            for k in 1..=steps {
                let below = top + k as f64 * step;
                integral += simpson(&of, below - step, below);
                nodes.push((integral, of(below)));
            }
            top = *end;
        }
        Integral(Arc::new(Pieces { ends: ends.to_vec(), nodes, steps }))
    }

    /// The integral down to `below` kelvin (negative) under the freezing point, by cubic interpolation.
    pub fn at(&self, below: f64) -> f64 {
        let Some(Cubic { from, s, d0, d1, rise, .. }) = self.cubic(below) else {
            let Pieces { ends, nodes, .. } = &*self.0;
            let (deepest, last) = nodes[nodes.len() - 1];
            return deepest + (below - ends.last().copied().unwrap_or(0.0)) * last;
        };
        from + s * (d0 + s * ((3.0 * rise - 2.0 * d0 - d1) + s * (d0 + d1 - 2.0 * rise)))
    }

    /// How the integral of [`Integral::at`] follows the place.
    pub fn slope(&self, below: f64) -> f64 {
        let Some(Cubic { step, s, d0, d1, rise, .. }) = self.cubic(below) else {
            return self.0.nodes[self.0.nodes.len() - 1].1;
        };
        (d0 + s * (2.0 * (3.0 * rise - 2.0 * d0 - d1) + s * 3.0 * (d0 + d1 - 2.0 * rise))) / step
    }

    /// The cubic at a place, if it is not below the last end.
    #[inline]
    fn cubic(&self, below: f64) -> Option<Cubic> {
        let Pieces { ends, nodes, steps } = &*self.0;
        let piece = ends.partition_point(|end| *end >= below);
        let top = piece.checked_sub(1).map_or(0.0, |above| ends[above]);
        let step = (ends.get(piece)? - top) / *steps as f64;
        let place = (below - top) / step;
        let k = (place as usize).min(steps - 1);
        let ((u0, f0), (u1, f1)) = (nodes[piece * steps + k], nodes[piece * steps + k + 1]);
        Some(Cubic { from: u0, step, s: place - k as f64, d0: f0 * step, d1: f1 * step, rise: u1 - u0 })
    }
}

/// The integral of a function between two places by Simpson's rule.
pub(super) fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    (to - from) / 6.0 * (f(from) + 4.0 * f(0.5 * (from + to)) + f(to))
}

impl HeapSize for Integral {
    fn heap_size(&self) -> usize {
        size_of::<Pieces>() + self.0.ends.heap_size() + self.0.nodes.heap_size()
    }
}
