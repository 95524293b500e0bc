//! The front of a frozen wall as lines: where half is frozen, over the whole plan.

use std::collections::HashMap;

use frazil_core::memory::HeapSize;
use frazil_core::space::domain::{Domain, Sector};
use frazil_record::FrontLineRow;
use glam::DVec2;

use super::level_set::LevelSet;
use super::observer::{Instants, Made, Setup, View};
use super::series::series;
use crate::march::instants::outputs;

/// How far a line may be from the front that it stands for, in spacings: below what the lattice shows of the front itself.
const TOLERANCE: f64 = 0.1;

/// At how many outputs lines are kept at the most: all of them would be more than all other tables of a run together.
const MOST: usize = 40;

/// Coordinates are multiples of this (m): a tenth of a millimetre is less than boreholes are placed to.
const STEP: f64 = 1e-4;

/// Points of a line; the first is the last again where it is closed.
type Line = Vec<DVec2>;

pub(super) fn of(setup: &Setup<'_>) -> Made {
    let Domain::Ring { sector, .. } = setup.scene.domain else { return None };
    if !setup.maps || !setup.scene.watch.frozen_wall {
        return None;
    }
    let mut field = LevelSet::over(setup);
    let spacing = setup.particles.lattice.spacing;
    let outputs = outputs(setup.scene);
    let stride = outputs.len().div_ceil(MOST);
    // The last is among them.
    let kept: Vec<f64> = outputs.into_iter().rev().step_by(stride).collect();
    // Two fronts along each ring, a point in every other spacing at the most.
    let along: f64 = setup.scene.rings.iter().map(|ring| 2.0 * std::f64::consts::TAU * ring.ring_radius).sum();
    let rows = Vec::with_capacity((0.5 * along / spacing) as usize * kept.len());
    let held = field.heap_size() + kept.heap_size();
    let read = move |view: &View<'_>, rows: &mut Vec<FrontLineRow>| {
        if !kept.iter().any(|time| (time - view.time).abs() <= 1e-9 * view.scene.duration) {
            return;
        }
        let fractions = view.fractions();
        field.read(view.particles, |i| fractions[i]);
        let mut pieces = Vec::new();
        field.part(0.5, |a, b| pieces.push([a, b]));
        let lines = whole(chained(&pieces), sector, 1e-9 * spacing);
        for (number, line) in lines.iter().enumerate() {
            let point = |place: DVec2| {
                let [x_m, y_m] = [place.x, place.y].map(|along| (along / STEP).round() * STEP);
                FrontLineRow { time_s: view.time, line: number + 1, x_m, y_m }
            };
            rows.extend(simplified(line, TOLERANCE * spacing).into_iter().map(point));
        }
    };
    series(Instants::Outputs, rows, (0, held), read, |rows, result| result.front_lines = rows)
}

/// Pieces joined where they end at the same place, to the bit: the crossing of an edge is the same for both triangles beside it.
fn chained(pieces: &[[DVec2; 2]]) -> Vec<Line> {
    // Zero has two signs.
    let key = |place: DVec2| [(place.x + 0.0).to_bits(), (place.y + 0.0).to_bits()];
    let mut at: HashMap<[u64; 2], Vec<usize>> = HashMap::new();
    let mut is_free: Vec<bool> = pieces.iter().map(|[a, b]| a != b).collect();
    for (k, ends) in pieces.iter().enumerate().filter(|(k, _)| is_free[*k]) {
        ends.iter().for_each(|end| at.entry(key(*end)).or_default().push(k));
    }
    let mut lines = Vec::new();
    for first in 0..pieces.len() {
        if !std::mem::take(&mut is_free[first]) {
            continue;
        }
        let mut line = pieces[first].to_vec();
        // On from its end and, unless that has led round to its start, from its start.
        for _ in 0..2 {
            while let Some(next) = at[&key(line[line.len() - 1])].iter().copied().find(|k| is_free[*k]) {
                is_free[next] = false;
                let [a, b] = pieces[next];
                line.push(if a == line[line.len() - 1] { b } else { a });
            }
            line.reverse();
        }
        lines.push(line);
    }
    lines
}

/// Lines of the whole plan, from those of the part that is run.
fn whole(lines: Vec<Line>, sector: Sector, near: f64) -> Vec<Line> {
    let over_x = |lines| unfolded(lines, |place| DVec2::new(place.x, -place.y), |place| place.y.abs() <= near);
    let over_y = |lines| unfolded(lines, |place| DVec2::new(-place.x, place.y), |place| place.x.abs() <= near);
    match sector {
        Sector::Whole => lines,
        Sector::Half => over_x(lines),
        Sector::Quarter => over_y(over_x(lines)),
    }
}

/// Lines and their images in a mirror, which go on in each other where a line ends on it.
fn unfolded(lines: Vec<Line>, mirror: impl Fn(DVec2) -> DVec2, is_on: impl Fn(DVec2) -> bool) -> Vec<Line> {
    let mut found = Vec::with_capacity(2 * lines.len());
    for mut line in lines {
        if !is_on(line[line.len() - 1]) {
            line.reverse();
        }
        let is_open = line[0] != line[line.len() - 1];
        let image = line.iter().map(|place| mirror(*place));
        if is_open && is_on(line[line.len() - 1]) {
            let mut image: Line = image.rev().skip(1).collect();
            // Mirrored to itself but for rounding.
            if is_on(line[0])
                && let Some(last) = image.last_mut()
            {
                *last = line[0];
            }
            line.extend(image);
            found.push(line);
        } else {
            let image = image.collect();
            found.extend([line, image]);
        }
    }
    found
}

/// The fewest of its points that leave no other farther from the line than this (m), by halves (Ramer 1972, Douglas and Peucker
/// 1973).
fn simplified(line: &[DVec2], tolerance: f64) -> Line {
    let mut is_kept = vec![false; line.len()];
    let last = line.len() - 1;
    (is_kept[0], is_kept[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let distance = |k: &usize| off(line[*k], line[from], line[to]);
        let farthest = (from + 1..to).max_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(k) = farthest.filter(|k| distance(k) > tolerance) {
            is_kept[k] = true;
            open.extend([(from, k), (k, to)]);
        }
    }
    line.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(place, _)| *place).collect()
}

/// Distance (m) of a place from the line between two others.
fn off(place: DVec2, from: DVec2, to: DVec2) -> f64 {
    let way = to - from;
    let share = if way == DVec2::ZERO { 0.0 } else { ((place - from).dot(way) / way.length_squared()).clamp(0.0, 1.0) };
    place.distance(from + share * way)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    /// An arc around a place as pieces that stand in no order, each the one way or the other.
    fn arc(centre: DVec2, radius: f64, (from, to): (f64, f64), count: usize) -> Vec<[DVec2; 2]> {
        let at = |k: usize| {
            let k = if to - from == TAU && k == count { 0 } else { k };
            centre + radius * DVec2::from_angle(from + (to - from) * k as f64 / count as f64)
        };
        let piece = |k: usize| if k.is_multiple_of(3) { [at(k + 1), at(k)] } else { [at(k), at(k + 1)] };
        (0..count).map(|k| piece(k * 7 % count)).collect()
    }

    fn area(line: &[DVec2]) -> f64 {
        (0.5 * line.windows(2).map(|pair| pair[0].perp_dot(pair[1])).sum::<f64>()).abs()
    }

    #[test]
    fn pieces_of_two_circles_are_two_closed_lines() {
        let pieces = [arc(DVec2::ZERO, 2.0, (0.0, TAU), 50), arc(DVec2::ZERO, 1.0, (0.0, TAU), 50)].concat();
        let lines = chained(&pieces);
        assert_eq!(lines.iter().map(Vec::len).collect::<Vec<_>>(), [51, 51]);
        assert!(lines.iter().all(|line| line[0] == line[50]));
        // A polygon of 50 corners.
        let share = 25.0 / PI * (TAU / 50.0).sin();
        assert!((area(&lines[0]) / (4.0 * PI) - share).abs() < 1e-12);
    }

    #[test]
    fn a_quarter_unfolds_into_the_whole_plan() {
        // A quarter of a wall, a column of ice off all mirrors, and one half of which is beyond one.
        let column = DVec2::new(4.0, 0.0);
        let pieces = [
            arc(DVec2::ZERO, 2.0, (0.0, 0.5 * PI), 50),
            arc(DVec2::new(5.0, 5.0), 0.5, (0.0, TAU), 50),
            arc(column, 0.5, (0.0, PI), 50),
        ]
        .concat();
        let lines = whole(chained(&pieces), Sector::Quarter, 1e-9);
        assert_eq!(lines.len(), 1 + 4 + 2);
        for line in &lines {
            assert!(line[0] == line[line.len() - 1]);
            let expected = if line.len() == 201 { 4.0 * PI } else { 0.25 * PI };
            assert!((area(line) / expected - 1.0).abs() < 0.003, "{} {expected}", area(line));
        }
        assert_eq!(whole(chained(&pieces), Sector::Half, 1e-9).len(), 1 + 2 + 1);
    }

    #[test]
    fn what_is_left_out_of_a_line_is_near_it() {
        let line: Line = (0..=400).map(|k| 3.0 * DVec2::from_angle(TAU * f64::from(k % 400) / 400.0)).collect();
        let few = simplified(&line, 0.01);
        let distance =
            |place: DVec2| few.windows(2).map(|pair| off(place, pair[0], pair[1])).fold(f64::INFINITY, f64::min);
        assert!(line.iter().all(|place| distance(*place) <= 0.01));
        // Chords of this sagitta are 39 at least, and a circle is halved into a power of two of them.
        assert!(few.len() <= 65 && few[0] == few[few.len() - 1], "{}", few.len());
    }
}
