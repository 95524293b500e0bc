//! Watches: what is read off the particles at outputs, and never inside a step.

mod corners;
mod field;
mod heap_size;
pub(crate) mod loops;
mod passage;
mod phases;
mod profiles;
pub(crate) mod rays;
mod sampler;
mod shells;
mod standing;
mod stream;
mod sunk;
mod wall;

use frazil_core::boundary::pipe::Extent;
use frazil_core::ledger::{Ledger, Sum};
use frazil_core::particles::Particles;
use frazil_core::space::domain::Domain;
use frazil_record::{
    BudgetRow, Field, FrontRow, FrozenRow, GapRow, LinkRow, PhaseRow, PlaneRow, ProbeRow, ProfileRow, SectionRow,
    Start, StreamRow, SurfaceRow, WallRecord, WallRow,
};
use frazil_scene::{FreezingDirection, PipeRing, Scene};
use glam::DVec2;

use crate::march::instants::outputs;
use crate::monotonicity::MonotonicityCheck;

use corners::Corners;
use field::field;
use profiles::{Line, layers};
use rays::{Gap, Planes, Ray, frozen_length, planes};
use sampler::{Sample, Sampler};
use shells::RadialFront;
use wall::{Joint, Wall};

/// The map of a state of a scene, as fields are kept.
pub fn map(scene: &Scene, particles: &Particles, time: f64) -> Field {
    field(particles, time, field_radius(scene))
}

/// Radius (m) around the origin within which maps are kept: beyond the pipes as far as a wall comes to; zero for all of the body.
fn field_radius(scene: &Scene) -> f64 {
    let apart = |ring: &PipeRing| 2.0 * ring.ring_radius * (std::f64::consts::PI / ring.count as f64).sin();
    let reach = |ring: &PipeRing| (1.6 * ring.ring_radius).max(ring.ring_radius + 1.5 * apart(ring));
    scene.rings.iter().map(reach).fold(0.0, f64::max)
}

/// All watches of a run and what they have seen.
pub struct Watches {
    dimension: usize,
    direction: Option<FreezingDirection>,
    radial: Option<RadialFront>,
    /// Lines along which profiles are kept, beside means over layers.
    lines: Vec<Line>,
    corners: Option<Corners>,
    /// Part of the body (m along x) whose phases are watched.
    phased: Option<(f64, f64)>,
    averages: Option<stream::Averages>,
    /// Whether the frozen volume is kept: there is neither a front nor a wall that tells how much is frozen.
    volumed: bool,
    /// Rows of surfaces at one output, and from the start on in all.
    surface_rows: usize,
    profile_length: f64,
    main: Vec<Ray>,
    interface: Vec<Ray>,
    gaps: Vec<Gap>,
    wall: Wall,
    next_look: f64,
    look_every: f64,
    sector_count: f64,
    pipe_count: usize,
    probes: Vec<(DVec2, Sample)>,
    keep_fields: bool,
    field_radius: f64,
    isothermal: bool,
    rows: heap_size::Rows,
    /// What can only go one way.
    pub monotonicity: MonotonicityCheck,
    /// Front over time.
    pub front: Vec<FrontRow>,
    /// What was frozen at the start.
    pub start: Start,
    /// Frozen volume over time.
    pub frozen: Vec<FrozenRow>,
    /// Phases over time.
    pub phases: Vec<PhaseRow>,
    /// Profiles.
    pub profiles: Vec<ProfileRow>,
    /// Probes.
    pub probe_rows: Vec<ProbeRow>,
    /// Heat balance.
    pub budget: Vec<BudgetRow>,
    /// Heat through surfaces.
    pub surfaces: Vec<SurfaceRow>,
    /// Frozen wall.
    pub walls: Vec<WallRow>,
    /// Temperature fields.
    pub fields: Vec<Field>,
}

impl Watches {
    /// Share of the duration between two looks at gaps.
    pub(crate) const LOOK_SHARE: f64 = 1.0 / 4000.0;

    /// The watches that a scene asks for.
    pub fn new(scene: &Scene, particles: &Particles, pipes: &[Extent], keep_fields: bool) -> Self {
        let sampler = Sampler::new(scene, particles);
        let spacing = particles.lattice.spacing;
        let (sector, outer) = match scene.domain {
            Domain::Ring { outer_radius, sector } => (Some(sector), outer_radius),
            _ => (None, 0.0),
        };
        let Planes { main, interface, gaps } = planes(scene, &sampler);
        let probes =
            scene.watch.probes.iter().map(|(x, y)| (DVec2::new(*x, *y), sampler.sample(DVec2::new(*x, *y)))).collect();
        let direction = scene.freezing_direction();
        let mut lines = Line::all(scene, particles, &sampler);
        for (rays, plane) in [(&main, "main"), (&interface, "interface")] {
            lines.extend(rays.first().map(|ray| Line::along(plane, ray)));
        }
        let mut watches = Watches {
            profile_length: scene.watch.profile_length.or(direction.map(|d| d.length)).unwrap_or(outer),
            dimension: scene.domain.dimension(),
            direction,
            radial: RadialFront::of(scene),
            lines,
            corners: Corners::of(scene, spacing),
            phased: scene.watch.phases,
            averages: stream::Averages::of(scene, particles),
            volumed: scene.domain.symmetry().is_some() || direction.is_none() && scene.rings.is_empty(),
            surface_rows: scene.watch.surfaces.len(),
            main,
            interface,
            gaps,
            wall: Wall::of(scene, &sampler, pipes),
            next_look: 0.0,
            look_every: scene.duration * Self::LOOK_SHARE,
            sector_count: sector.map_or(1.0, |sector| sector.images() as f64),
            pipe_count: scene.rings.iter().map(|ring| ring.numbers().count()).sum(),
            probes,
            keep_fields: keep_fields && scene.domain.dimension() == 2,
            field_radius: field_radius(scene),
            isothermal: scene.materials[0].is_sharp(),
            monotonicity: MonotonicityCheck::new(scene, particles.volumes.largest()),
            front: Vec::new(),
            start: Start::default(),
            frozen: Vec::new(),
            phases: Vec::new(),
            profiles: Vec::new(),
            probe_rows: Vec::new(),
            budget: Vec::new(),
            surfaces: Vec::new(),
            walls: Vec::new(),
            fields: Vec::new(),
            rows: heap_size::Rows::default(),
        };
        watches.make_room(particles, outputs(scene).len(), scene.watch.profiles.len());
        watches
    }

    /// Whether something needs a look between outputs at this time.
    #[inline]
    pub fn due(&self, time: f64) -> bool {
        time >= self.next_look
            && (!self.gaps.is_empty() || self.averages.as_ref().is_some_and(|averages| averages.wants(time)))
    }

    /// Whether a gap that was open at the last look is closed now.
    pub fn closes(&self, particles: &Particles) -> bool {
        let mut joints = self.gaps.iter().map(|gap| &gap.joint).chain(&self.wall.joints);
        joints.any(|joint| joint.closed.is_none() && self.openness(joint, particles) <= 0.0)
    }

    /// How far a joint is from being closed: positive while open.
    fn openness(&self, joint: &Joint, particles: &Particles) -> f64 {
        let openness = |sample: &Sample| {
            if self.isothermal {
                // Enthalpy above the frozen state, in units of the latent heat.
                sample.of(|i| {
                    let thermal = particles.materials.of(i);
                    (particles.enthalpy[i] + thermal.initial_enthalpy) / thermal.curve.latent_heat() + 1.0
                })
            } else {
                0.5 - sample.of(|i| particles.frozen_fraction(i))
            }
        };
        joint.openness(openness)
    }

    /// Looks at the gaps between pipes, which close once ground there is frozen with its latent heat released.
    pub fn look(&mut self, particles: &Particles, time: f64) {
        self.next_look = time + self.look_every;
        if let Some(averages) = &mut self.averages {
            averages.look(particles, time);
        }
        for number in 0..self.gaps.len() {
            if self.gaps[number].joint.closed.is_none() {
                let now = self.openness(&self.gaps[number].joint, particles);
                self.gaps[number].joint.look(time, now);
            }
        }
        for number in 0..self.wall.joints.len() {
            if self.wall.joints[number].closed.is_none() {
                let now = self.openness(&self.wall.joints[number], particles);
                self.wall.joints[number].look(time, now);
            }
        }
    }

    /// Takes the heat (W) through the surfaces of a scene, in their order.
    pub fn surfaces(&mut self, scene: &Scene, heat: &[f64], time: f64) {
        for (surface, heat_w) in scene.watch.surfaces.iter().zip(heat) {
            let flux_w_per_m2 = heat_w / surface.area(&scene.domain);
            let (time_s, surface) = (time, surface.name(&scene.domain));
            self.surfaces.push(SurfaceRow { time_s, surface, heat_w: *heat_w, flux_w_per_m2 });
        }
    }

    /// Takes what is frozen at the start.
    pub fn begin(&mut self, particles: &Particles) {
        let frozen = particles.integral(|i| particles.frozen_fraction(i));
        let front_m = self.front_of(particles, frozen, 0.0);
        self.start = Start { front_m, frozen_volume: frozen * self.sector_count };
    }

    /// The front (m) of a body of which so much is frozen, where there is one.
    fn front_of(&self, particles: &Particles, frozen: f64, time: f64) -> Option<f64> {
        if let Some(direction) = self.direction {
            // Where particles move, they may stand closer in one phase than in the other.
            return Some(match particles.move_about() {
                true => {
                    layers(particles, &direction, direction.length, time, self.dimension)
                        .map(|row| row.frozen_fraction)
                        .sum::<f64>()
                        * particles.lattice.spacing
                }
                false => frozen / direction.across,
            });
        }
        let radius = self.radial.map(|radial| radial.radius(frozen));
        radius.or_else(|| Some(self.corners.as_ref()?.front(particles)))
    }

    /// Takes everything that is due at an output, on which a step has landed or over which it has passed.
    pub fn output(&mut self, scene: &Scene, particles: &Particles, ledger: &Ledger, time: f64, landed: bool) {
        let frozen = particles.integral(|i| particles.frozen_fraction(i));
        if landed {
            // The curve between two states may swing where steps do not.
            self.monotonicity.look(frozen, ledger.rate(), ledger.rings());
        }
        if let Some(front_m) = self.front_of(particles, frozen, time) {
            self.front.push(FrontRow { time_s: time, front_m, front_ref_m: None });
        }
        if let Some(part) = self.phased {
            self.phases.push(phases::shares(particles, part, time));
        }
        if self.volumed {
            self.frozen.push(FrozenRow {
                time_s: time,
                frozen_volume: frozen * self.sector_count,
                frozen_volume_ref: None,
            });
        }
        let stand = self.wall.stand(particles, time);
        if !self.main.is_empty() {
            let length = |rays: &[Ray]| {
                let weights: usize = rays.iter().map(|ray| ray.multiplicity).sum();
                rays.iter().map(|ray| ray.multiplicity as f64 * frozen_length(ray, particles)).sum::<f64>()
                    / weights.max(1) as f64
            };
            let pipes = self.pipe_count as f64 / self.sector_count;
            let heat = -ledger.rings().sum::<f64>();
            self.walls.push(WallRow {
                time_s: time,
                thickness_main_mean_m: length(&self.main),
                thickness_main_mean_ref_m: None,
                thickness_interface_mean_m: length(&self.interface),
                thickness_interface_mean_ref_m: None,
                frozen_area_m2: frozen * self.sector_count,
                frozen_area_ref_m2: None,
                heat_per_pipe_w_per_m: heat / pipes,
                closed: stand.map(|(closed, _)| closed),
                thickness_weakest_m: stand.map(|(_, thickness)| thickness),
            });
        }
        self.wall.output([&self.main, &self.interface], scene, particles, ledger, time);
        // Samples are of particles that stay where they are.
        let sampler = Sampler::free(particles);
        for (place, sample) in self.probes.iter().filter(|(place, _)| !particles.is_dug(place.length())) {
            let moved = if particles.move_about() { Some(sampler.sample(*place)) } else { None };
            let temperature_c = moved.as_ref().unwrap_or(sample).of(|i| particles.reading(i));
            self.probe_rows.push(ProbeRow { time_s: time, x_m: place.x, y_m: place.y, temperature_c });
        }
        self.budget.push(balance(particles, ledger, time));
        let kept = |wanted: &&f64| (**wanted - time).abs() <= 1e-9 * scene.duration;
        if scene.watch.profiles.iter().find(kept).is_some() {
            self.profile(particles, time);
            if self.keep_fields {
                self.fields.push(field(particles, time, self.field_radius));
            }
        }
    }

    fn profile(&mut self, particles: &Particles, time: f64) {
        if let Some(direction) = self.direction {
            self.profiles.extend(layers(particles, &direction, self.profile_length, time, self.dimension));
        }
        for line in &self.lines {
            line.read(self.dimension, particles, time, &mut self.profiles);
        }
    }

    /// Averages over a driven liquid, and across its sections.
    pub fn stream(&self, particles: &Particles) -> (Vec<StreamRow>, Vec<SectionRow>) {
        let averages = self.averages.as_ref();
        averages.map(|averages| (averages.stream(particles), averages.sections())).unwrap_or_default()
    }

    /// When neighbouring pipes of all rings joined, and sections of the wall over time.
    pub fn wall(&mut self) -> (Vec<LinkRow>, Vec<PlaneRow>) {
        (self.wall.rows(), std::mem::take(&mut self.wall.planes))
    }

    /// What has become of the frozen wall, where it is watched.
    pub fn wall_record(&self) -> Option<WallRecord> {
        self.wall.record()
    }

    /// When each gap closed.
    pub fn gap_rows(&self) -> Vec<GapRow> {
        self.gaps
            .iter()
            .map(|gap| GapRow {
                gap: gap.number,
                from: gap.ends[0].clone(),
                to: gap.ends[1].clone(),
                angle_deg: gap.angle.to_degrees(),
                multiplicity: gap.multiplicity,
                closure_s: gap.joint.closed,
                closure_ref_s: None,
            })
            .collect()
    }
}

/// The heat balance at a time.
fn balance(particles: &Particles, ledger: &Ledger, time: f64) -> BudgetRow {
    let (stored_j, moved_j) = taken_up(particles);
    let in_j = ledger.heat();
    let total: Sum = in_j.iter().copied().collect();
    let exchanged = in_j.iter().map(|heat| heat.abs()).sum::<f64>().max(stored_j.abs());
    // Where particles start from different temperatures, they exchange heat even if nothing comes in.
    let exchanged = exchanged.max(0.5 * moved_j);
    let balance_rel = if exchanged > 0.0 { (stored_j - total.value()) / exchanged } else { 0.0 };
    BudgetRow { time_s: time, stored_j, in_j, balance_rel }
}

/// What all particles have taken up since the start (J), and, where they started from different temperatures, how much each
/// by its magnitude, summed.
fn taken_up(particles: &Particles) -> (f64, f64) {
    match &particles.start[..] {
        [] => (particles.integral(|i| particles.enthalpy[i]), 0.0),
        start => {
            let change = |i: usize| particles.enthalpy[i] - start[i];
            (particles.integral(change), particles.integral(|i| change(i).abs()))
        }
    }
}
