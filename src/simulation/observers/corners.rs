//! Fronts that run from the corners of a rectangle.

use std::f64::consts::SQRT_2;

use frazil_core::boundary::condition::Condition;
use frazil_core::particles::Particles;
use frazil_core::space::domain::Domain;
use frazil_core::space::wall::WallId;
use frazil_scene::Scene;
use glam::DVec2;

/// Half the width of the strip around a diagonal whose frozen fractions tell its front, over the spacing.
const HALF_WIDTH: f64 = 2.0;

/// Corners of a rectangle between two cold walls.
#[derive(Debug, Clone)]
pub(super) struct Corners {
    /// Corner, and the signs of the way into the body.
    corners: Vec<(DVec2, DVec2)>,
    half_width: f64,
    /// Half the length of the shorter side (m): beyond it a strip would meet another corner's.
    reach: f64,
}

impl Corners {
    /// The corners of a scene that asks for their fronts.
    pub(super) fn of(scene: &Scene, spacing: f64) -> Option<Self> {
        let Domain::Rectangle { width, height } = scene.domain else { return None };
        if !scene.watch.corner_front {
            return None;
        }
        let freezing = scene.materials[0].freezing_point;
        let cold = |wall: WallId, corner: f64| {
            let length = if wall.is_across_y() { width } else { height };
            let along = corner.min(length - 0.5 * spacing);
            matches!(scene.wall_at(wall, along), Some(Condition::Temperature(series)) if series.at(scene.duration) < freezing)
        };
        let mut corners = Vec::new();
        for (side, x, right) in [(WallId::Left, 0.0, 1.0), (WallId::Right, width, -1.0)] {
            for (end, y, up) in [(WallId::Bottom, 0.0, 1.0), (WallId::Top, height, -1.0)] {
                if cold(side, y) && cold(end, x) {
                    corners.push((DVec2::new(x, y), DVec2::new(right, up)));
                }
            }
        }
        (!corners.is_empty()).then(|| Corners {
            corners,
            half_width: HALF_WIDTH * spacing,
            reach: 0.5 * width.min(height),
        })
    }

    /// How far the front has come along the diagonals (m), in the mean over corners: the integral of the frozen fraction
    /// along them.
    ///
    /// Fractions in a strip around a diagonal are weighed by `9/4 - 15/4 (u/b)^2` at a distance `u` from it, of half the
    /// strip's width `b`, which has no second moment: a front that is curved across the strip counts where it meets the
    /// diagonal.
    pub(super) fn front(&self, particles: &Particles) -> f64 {
        let half = self.half_width;
        let length = SQRT_2 * self.reach;
        let mut sums = vec![(0.0, 0.0); (length / half).ceil() as usize];
        particles.visit(|i, place| {
            for (corner, signs) in &self.corners {
                let way = (place - *corner) * *signs;
                let (across, along) = ((way.x - way.y) / SQRT_2 / half, (way.x + way.y) / SQRT_2);
                if across.abs() < 1.0
                    && let Some(sum) = sums.get_mut((along / half) as usize)
                {
                    let weight = 2.25 - 3.75 * across * across;
                    *sum = (sum.0 + weight * particles.front_fraction(i), sum.1 + weight);
                }
            }
        });
        // Too few may stand in the sharp end of a strip to weigh them against each other.
        sums.iter().map(|sum| half * if sum.1 > 0.0 { (sum.0 / sum.1).clamp(0.0, 1.0) } else { 1.0 }).sum()
    }
}
