//! The way back: what a smaller body leaves, in terms of the larger one.

use std::f64::consts::PI;

use frazil_core::space::domain::Sector;
use frazil_core::space::wall::WallId;
use frazil_record::{Field, GapRow, MeanOver, ProfileRow, RunResult};
use frazil_scene::Scene;

use super::fold::{Fold, folded, same_direction};
use crate::observers::rays::pairs;

impl Fold {
    /// Turns what the smaller body left into what `larger`, the scene before this fold, would have left. Counts and
    /// times stay those of the run that was made.
    pub(super) fn restore(&self, larger: &Scene, result: &mut RunResult) {
        self.heat(larger, result);
        let count = larger.watch.probes.len();
        for (k, row) in result.probes.iter_mut().enumerate() {
            (row.x_m, row.y_m) = larger.watch.probes[k % count];
        }
        match *self {
            Fold::Line { along_y, .. } => {
                for row in &mut result.profiles {
                    (row.x_m, row.y_m) = if along_y { (None, Some(row.along_m)) } else { (Some(row.along_m), None) };
                    row.mean_over = Some(if along_y { MeanOver::X } else { MeanOver::Y });
                }
            }
            Fold::Half { along_y, length } => {
                result.frozen.iter_mut().for_each(|row| row.frozen_volume *= 2.0);
                result.tables.iter_mut().for_each(|table| table.scale_sums(2.0));
                if larger.freezing_direction().is_some_and(|direction| direction.along_y == along_y) {
                    result.front.iter_mut().for_each(|row| row.front_m *= 2.0);
                    result.start.front_m = result.start.front_m.map(|front| 2.0 * front);
                }
                result.profiles = profiles(larger, along_y, length, &result.profiles);
                for field in &mut result.fields {
                    let middle = 0.5 * length;
                    *field = unfold(field, along_y, middle);
                }
            }
            Fold::Sector { from, to, first_angle } => {
                result.gaps = gaps(larger, from, to, &result.gaps);
                rename(larger, first_angle, result);
                for field in &mut result.fields {
                    if from != Sector::Half {
                        *field = unfold(field, true, 0.0);
                    }
                    if to == Sector::Quarter {
                        *field = unfold(field, false, 0.0);
                    }
                }
            }
        }
    }

    /// Heat by walls and rings of the larger body.
    fn heat(&self, larger: &Scene, result: &mut RunResult) {
        let names = std::mem::take(&mut result.budget_names);
        let first_ring = names.len() - larger.rings.len();
        let scale = match self {
            Fold::Line { across, .. } => *across,
            Fold::Half { .. } => 2.0,
            Fold::Sector { from, to, .. } => images(*from, *to),
        };
        // Whose heat stands for a wall's, and how many times; a wall that the smaller body lacks lets none through.
        let source = |wall: WallId| -> (Option<WallId>, f64) {
            match *self {
                Fold::Line { along_y, across } => {
                    let known = wall.is_across_y() == along_y;
                    (known.then(|| WallId::ends(false)[usize::from(wall.is_at_end())]), across)
                }
                Fold::Half { along_y, .. } if wall.is_across_y() == along_y => (Some(WallId::ends(along_y)[0]), 1.0),
                Fold::Half { .. } | Fold::Sector { .. } => (Some(wall), scale),
            }
        };
        let walls = larger.walls.iter().map(|wall| {
            let (own, times) = source(wall.wall);
            (own.and_then(|own| names.iter().position(|name| name == own.name())), times)
        });
        let rings = (first_ring..names.len()).map(|ring| (Some(ring), scale));
        let sources: Vec<(Option<usize>, f64)> = walls.chain(rings).collect();
        result.start.frozen_volume *= if let Fold::Sector { .. } = self { 1.0 } else { scale };
        for row in &mut result.budget {
            row.stored_j *= scale;
            row.in_j = sources.iter().map(|(own, times)| own.map_or(0.0, |own| times * row.in_j[own])).collect();
        }
        let walls = larger.walls.iter().map(|wall| wall.wall.to_string());
        result.budget_names = walls.chain(names[first_ring..].iter().cloned()).collect();
    }
}

/// How many of a sector make up a larger one.
fn images(from: Sector, to: Sector) -> f64 {
    to.images() as f64 / from.images() as f64
}

/// Profiles of half a body of `length` (m) in one direction, in terms of the whole.
fn profiles(larger: &Scene, along_y: bool, length: f64, half: &[ProfileRow]) -> Vec<ProfileRow> {
    let cuts = larger.cuts();
    let mut found = Vec::with_capacity(2 * half.len());
    for instant in half.chunk_by(|a, b| a.time_s == b.time_s) {
        let mut next_cut = cuts.iter();
        // Each profile runs towards greater coordinates; two cuts may lie on the same line of the half.
        for rows in instant.chunk_by(|a, b| a.plane == b.plane && a.along_m < b.along_m) {
            if rows[0].plane == "line" {
                let direction = larger.freezing_direction();
                let runs = direction.is_some_and(|direction| direction.along_y == along_y);
                let end = larger.watch.profile_length.unwrap_or(length);
                mirror(rows, (along_y, length), runs, end, &mut found);
            } else if let Some(cut) = next_cut.next() {
                let own = rows.iter().map(|row| {
                    let (x_m, y_m) = if cut.across_y { (row.x_m, Some(cut.at)) } else { (Some(cut.at), row.y_m) };
                    ProfileRow { plane: cut.name(&larger.domain), x_m, y_m, ..row.clone() }
                });
                mirror(&own.collect::<Vec<_>>(), (along_y, length), cut.across_y != along_y, length, &mut found);
            }
        }
    }
    found
}

/// Adds a profile of half a body, and its image where it runs (m) in the direction that is halved, as far as `end`.
fn mirror(rows: &[ProfileRow], (along_y, length): (bool, f64), runs: bool, end: f64, found: &mut Vec<ProfileRow>) {
    found.extend_from_slice(rows);
    if !runs {
        return;
    }
    let image = |row: &ProfileRow| {
        let along_m = length - row.along_m;
        let (x_m, y_m) = if along_y { (row.x_m, Some(along_m)) } else { (Some(along_m), row.y_m) };
        ProfileRow { along_m, x_m, y_m, ..row.clone() }
    };
    found.extend(rows.iter().rev().map(image).filter(|row| row.along_m <= end));
}

/// Gaps of the larger sector, each closed when its image was.
fn gaps(larger: &Scene, from: Sector, to: Sector, found: &[GapRow]) -> Vec<GapRow> {
    let pairs = larger.rings.first().map_or(Vec::new(), pairs);
    let gaps = pairs.into_iter().filter(|pair| from.holds(pair.angle()));
    gaps.map(|pair| {
        let angle = pair.angle();
        let is_image =
            |row: &&GapRow| row.angle_deg.is_some_and(|own| same_direction(own.to_radians(), folded(angle, to)));
        let [first, second] = pair.names();
        GapRow {
            gap: pair.first(),
            from: first,
            to: second,
            angle_deg: Some(angle.to_degrees()),
            along_m: None,
            multiplicity: from.multiplicity(angle),
            closure_s: found.iter().find(is_image).and_then(|row| row.closure_s),
            closure_ref_s: None,
        }
    })
    .collect()
}

/// Gives pipes the names that they have in the larger sector: its first ring may count from another pipe.
fn rename(larger: &Scene, first_angle: f64, result: &mut RunResult) {
    let Some(ring) = larger.rings.first() else { return };
    let turned = ((first_angle - ring.first_angle) / (2.0 * PI / ring.count as f64)).round() as i64;
    let own = |name: &mut String| {
        if let Some(number) = name.strip_prefix("1.").and_then(|number| number.parse::<i64>().ok()) {
            *name = format!("1.{}", (number - 1 + turned).rem_euclid(ring.count as i64) + 1);
        }
    };
    for link in &mut result.links {
        own(&mut link.from);
        own(&mut link.to);
    }
    for plane in &mut result.planes {
        own(&mut plane.from);
        own(&mut plane.to);
    }
    if let Some(wall) = &mut result.record.wall {
        wall.weakest_gap.iter_mut().chain(&mut wall.last_gap).flatten().for_each(own);
    }
}

/// A field continued behind a plane of y, or of x, at `plane` (m): on its far side if the field lies before it, on its
/// near side if behind.
fn unfold(field: &Field, in_y: bool, plane: f64) -> Field {
    let (nx, ny) = if in_y { (field.nx, 2 * field.ny) } else { (2 * field.nx, field.ny) };
    let first = if in_y { field.y0_m } else { field.x0_m };
    let count = if in_y { field.ny } else { field.nx };
    let own_first = first < plane;
    let own = |k: usize| match (own_first, k < count) {
        (true, true) => k,
        (true, false) => 2 * count - 1 - k,
        (false, true) => count - 1 - k,
        (false, false) => k - count,
    };
    let cell = |column: usize, row: usize| {
        if in_y { own(row) * field.nx + column } else { row * field.nx + own(column) }
    };
    let spread = |values: &[f64]| -> Vec<f64> {
        (0..ny).flat_map(|row| (0..nx).map(move |column| (column, row))).map(|(c, r)| values[cell(c, r)]).collect()
    };
    let start = if own_first { first } else { first - count as f64 * field.spacing_m };
    Field {
        nx,
        ny,
        x0_m: if in_y { field.x0_m } else { start },
        y0_m: if in_y { start } else { field.y0_m },
        temperature_c: spread(&field.temperature_c),
        frozen_fraction: spread(&field.frozen_fraction),
        temperature_ref_c: Vec::new(),
        ..field.clone()
    }
}
