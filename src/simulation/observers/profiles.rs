//! Profiles: means over layers across a plane front, and points along lines through the body.

use frazil_core::memory::total;
use frazil_core::particles::Particles;
use frazil_core::space::domain::{Domain, Surface};
use frazil_record::{MeanOver, ProfileRow};
use frazil_scene::{FreezingDirection, Scene};
use glam::DVec2;

use super::observer::{Instants, Made, Setup};
use super::rays::{Ray, rays};
use super::sampler::{Sample, Sampler};
use super::series::series;

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let (scene, particles, sampler) = (setup.scene, setup.particles, setup.sampler());
    let direction = scene.freezing_direction();
    let mut lines = Line::all(scene, particles, &sampler);
    for (rays, plane) in rays(scene, &sampler).iter().zip(["main", "interface"]) {
        lines.extend(rays.first().map(|ray| Line::along(plane, ray)));
    }
    if direction.is_none() && lines.is_empty() {
        return None;
    }
    let length = scene.watch.profile_length.or(direction.map(|direction| direction.length)).unwrap_or(0.0);
    let spacing = particles.lattice.spacing;
    let cells =
        direction.map_or(0.0, |direction| (direction.length / spacing).round().min((length / spacing + 0.5).floor()));
    let points = cells as usize + lines.iter().map(|line| line.along.len()).sum::<usize>();
    let held: usize = lines.iter().map(Line::heap_size).sum();
    series(
        Instants::Profiles,
        Vec::with_capacity(points * setup.profiles()),
        ("line".len(), held),
        move |view, rows| {
            let particles = view.particles;
            if let Some(direction) = &direction {
                rows.extend(layers(particles, direction, length, view.time, view.scene.domain.dimension()));
            }
            for line in &lines {
                line.read(view.scene, particles, view.time, rows);
            }
        },
        |rows, result| result.profiles = rows,
    )
}

/// A line of points at which a body is read.
#[derive(Debug, Clone)]
struct Line {
    /// Name in the series: `radius`, `main`, `interface`, or as `z=0.4`.
    plane: String,
    /// Places along the line (m).
    along: Vec<f64>,
    /// The same in coordinates of the scene (m).
    places: Vec<DVec2>,
    samples: Vec<Sample>,
}

impl Line {
    fn new(plane: String, points: Vec<(f64, DVec2)>, sampler: &Sampler<'_>) -> Self {
        let (along, places): (Vec<f64>, Vec<DVec2>) = points.into_iter().unzip();
        let samples = sampler.samples(&places);
        Line { plane, along, places, samples }
    }

    /// A ray from its origin.
    fn along(plane: &str, ray: &Ray) -> Self {
        let places = ray.radii.iter().map(|radius| ray.origin + *radius * ray.direction).collect();
        Line { plane: plane.to_owned(), along: ray.radii.clone(), places, samples: ray.samples.clone() }
    }

    /// The lines of a scene: of a radial body the whole radius, of others the cuts that it has.
    fn all(scene: &Scene, particles: &Particles, sampler: &Sampler<'_>) -> Vec<Line> {
        if let Domain::Radial { .. } = scene.domain {
            let lattice = &particles.lattice;
            let radii = (0..lattice.columns).map(|column| lattice.centre(column as i64, 0).x);
            return vec![Line::new("radius".into(), radii.map(|r| (r, DVec2::new(r, 0.0))).collect(), sampler)];
        }
        let cut = |cut: &Surface| Line::new(cut.name(&scene.domain), points(cut, scene, particles), sampler);
        scene.cuts().iter().map(cut).collect()
    }

    /// Adds temperatures and frozen fractions along the line; of ground that is there.
    fn read(&self, scene: &Scene, particles: &Particles, time: f64, rows: &mut Vec<ProfileRow>) {
        let anew = Sampler::anew(scene, particles, time).map(|sampler| sampler.samples(&self.places));
        let samples = anew.as_ref().unwrap_or(&self.samples);
        let points = self.along.iter().zip(&self.places).zip(samples);
        let carries = !particles.concentration.is_empty();
        // Points on the face of a shaft are there, however their distance is rounded.
        let there = points.filter(|((_, place), _)| !particles.is_dug(place.length() * (1.0 + 1e-12)));
        rows.extend(there.map(|((along, place), sample)| ProfileRow {
            time_s: time,
            x_m: Some(place.x),
            temperature_c: sample.of(|i| particles.reading(i)),
            temperature_ref_c: None,
            frozen_fraction: sample.of(|i| particles.front_fraction(i)),
            concentration: carries.then(|| sample.of(|i| particles.concentration[i])),
            concentration_ref: None,
            plane: self.plane.clone(),
            y_m: (scene.domain.dimension() > 1).then_some(place.y),
            along_m: *along,
            mean_over: None,
        }));
    }

    /// Bytes on the heap.
    fn heap_size(&self) -> usize {
        total(&[&self.plane, &self.along, &self.places, &self.samples])
    }
}

/// Points of a cut: those of the columns or rows of the lattice that it crosses, inside the body.
fn points(cut: &Surface, scene: &Scene, particles: &Particles) -> Vec<(f64, DVec2)> {
    let lattice = &particles.lattice;
    let place = |cell: usize| {
        if cut.across_y {
            let x = lattice.centre(cell as i64, 0).x;
            (x, DVec2::new(x, cut.at))
        } else {
            let y = lattice.centre(0, cell as i64).y;
            (y, DVec2::new(cut.at, y))
        }
    };
    let count = if cut.across_y { lattice.columns } else { lattice.rows };
    let inside = |point: &(f64, DVec2)| match scene.domain {
        // Beside the curved wall there are no particles on both sides of a point.
        Domain::Ring { outer_radius, .. } => point.1.length() <= outer_radius - lattice.spacing,
        _ => true,
    };
    (0..count).map(place).filter(inside).collect()
}

/// Means over layers one spacing thick across the freezing direction, as far as `length` (m) from where it starts.
pub(super) fn layers(
    particles: &Particles,
    direction: &FreezingDirection,
    length: f64,
    time: f64,
    dimension: usize,
) -> impl Iterator<Item = ProfileRow> {
    let (spacing, corner) = (particles.lattice.spacing, particles.lattice.corner);
    let first = if direction.along_y { corner.y } else { corner.x };
    let count = (direction.length / spacing).round() as usize;
    let carries = !particles.concentration.is_empty();
    let mut sums = vec![(0.0, 0.0, 0.0, 0usize, 0.0); count];
    particles.visit(|i, place| {
        let along = if direction.along_y { place.y } else { place.x };
        let layer = (((along - first) / spacing) as usize).min(count - 1);
        let sum = &mut sums[layer];
        let concentration = particles.concentration.get(i).copied().unwrap_or(0.0);
        let fraction = particles.front_fraction(i);
        let temperature = particles.reading_by(i, || fraction);
        *sum = (sum.0 + along, sum.1 + temperature, sum.2 + fraction, sum.3 + 1, sum.4 + concentration);
    });
    let plane = (dimension > 1).then_some(if direction.along_y { MeanOver::X } else { MeanOver::Y });
    let direction = *direction;
    let row = move |(along, temperature, fraction, number, concentration): (f64, f64, f64, usize, f64)| {
        let number = number as f64;
        let along_m = along / number;
        ProfileRow {
            time_s: time,
            x_m: (!direction.along_y).then_some(along_m),
            temperature_c: temperature / number,
            temperature_ref_c: None,
            frozen_fraction: fraction / number,
            concentration: carries.then_some(concentration / number),
            concentration_ref: None,
            plane: "line".into(),
            y_m: direction.along_y.then_some(along_m),
            along_m,
            mean_over: plane,
        }
    };
    let known = sums.into_iter().filter(|sum| sum.3 > 0).map(row);
    known.filter(move |row| direction.distance(row.along_m - first) <= length)
}
