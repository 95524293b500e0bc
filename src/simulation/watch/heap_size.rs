//! What watches hold on the heap: the samples that they read, and the series that they fill.

use frazil_core::memory::HeapSize;
use frazil_core::particles::Particles;
use frazil_record::{BudgetRow, Field, FrontRow, FrozenRow, PlaneRow, ProbeRow, ProfileRow, SurfaceRow, WallRow};
use glam::DVec2;

use super::field::grid;
use super::profiles::Line;
use super::rays::{Gap, Ray};
use super::{Sample, Watches};

impl HeapSize for Sample {
    fn heap_size(&self) -> usize {
        self.0.heap_size()
    }
}

impl HeapSize for Ray {
    fn heap_size(&self) -> usize {
        self.radii.heap_size() + self.samples.heap_size()
    }
}

impl HeapSize for Gap {
    fn heap_size(&self) -> usize {
        self.joint.heap_size()
    }
}

/// Rows and fields that a run leaves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Rows {
    /// Instants of output.
    outputs: usize,
    /// Instants at which profiles are kept.
    profiles: usize,
    /// Rows of all planes at one of them.
    points: usize,
}

impl Watches {
    /// Makes room for all rows of a run with this many outputs, of which `profiles` keep profiles, so that none has to
    /// move when it is half full.
    pub(super) fn make_room(&mut self, particles: &Particles, outputs: usize, profiles: usize) {
        let spacing = particles.lattice.spacing;
        let layers = self.direction.map_or(0, |direction| {
            let count = (direction.length / spacing).round();
            count.min((self.profile_length / spacing + 0.5).floor()) as usize
        });
        let points = layers + self.lines.iter().map(|line| line.along.len()).sum::<usize>();
        self.surface_rows *= outputs;
        self.rows = Rows { outputs, profiles, points };
        let only = |wanted: bool, count: usize| if wanted { count } else { 0 };
        self.front.reserve_exact(only(self.direction.is_some() || self.radial.is_some(), outputs));
        self.frozen.reserve_exact(only(self.volumed, outputs));
        self.walls.reserve_exact(only(!self.main.is_empty(), outputs));
        self.wall.planes.reserve_exact(only(!self.wall.joints.is_empty(), 4 * outputs));
        self.budget.reserve_exact(outputs);
        self.surfaces.reserve_exact(self.surface_rows);
        self.probe_rows.reserve_exact(self.probes.len() * outputs);
        self.profiles.reserve_exact(points * profiles);
        self.fields.reserve_exact(only(self.keep_fields, profiles));
    }

    /// Forgets all rows and keeps their room.
    pub(crate) fn forget(&mut self) {
        self.front.clear();
        self.surfaces.clear();
        self.frozen.clear();
        self.profiles.clear();
        self.probe_rows.clear();
        self.budget.clear();
        self.walls.clear();
        self.wall.planes.clear();
        self.fields.clear();
    }

    /// Bytes that the watches will hold at the end of a run whose heat goes through `patches` patches.
    pub fn held_at_the_end(&self, particles: &Particles, patches: usize) -> usize {
        let lines = self.lines.iter().map(Line::heap_size).sum::<usize>();
        let samples =
            self.main.heap_size() + self.interface.heap_size() + self.gaps.heap_size() + self.wall.heap_size() + lines;
        let probes = self.probes.capacity() * size_of::<(DVec2, Sample)>()
            + self.probes.iter().map(|probe| probe.1.heap_size()).sum::<usize>();
        let Rows { outputs, profiles, points } = self.rows;
        let rows = self.front.capacity() * size_of::<FrontRow>()
            + self.surface_rows * (size_of::<SurfaceRow>() + "r=0.001".len())
            + self.frozen.capacity() * size_of::<FrozenRow>()
            + self.walls.capacity() * size_of::<WallRow>()
            + self.wall.planes.capacity() * (size_of::<PlaneRow>() + "interface".len())
            + self.probe_rows.capacity() * size_of::<ProbeRow>()
            + outputs * (size_of::<BudgetRow>() + patches * size_of::<f64>())
            + profiles * points * (size_of::<ProfileRow>() + "line".len());
        let cells = if self.keep_fields {
            let grid = grid(&particles.lattice, self.field_radius);
            grid.nx * grid.ny
        } else {
            0
        };
        let fields = self.fields.capacity() * size_of::<Field>() + 2 * profiles * cells * size_of::<f64>();
        // The sums from which a field is taken.
        let sums = cells * size_of::<(f64, f64, usize)>();
        samples + probes + rows + fields + sums
    }
}
