//! How wrong a front is: over how far it has come since the start, which for a thaw is not what is still frozen.

use frazil_record::FrontRow;
use frazil_scene::Scene;

use crate::reference::Reference;

/// Particle spacings that a front must have come before it is judged, where the scene does not say from when on. Before,
/// it stands inside the first few particles, whatever the method.
pub const SPACINGS: f64 = 4.0;

/// Share of the run that is judged however slowly a front moves.
const JUDGED_SHARE: f64 = 0.5;

/// Relative change of front^2/t over the window below which the reference's front follows the root of time.
const ROOT_OF_TIME: f64 = 1e-6;

/// Share of the duration by which the last row may miss the end.
const AT_THE_END: f64 = 1e-9;

/// A front beside that of the reference at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// Time (s).
    pub time: f64,
    /// How far it has come since the start (m), in the direction of the reference's.
    pub own: f64,
    /// How far the reference's has come (m); less than `far` where it has turned back.
    pub expected: f64,
    /// How far the reference's has ever come (m): what errors are relative to.
    pub far: f64,
}

impl Judged {
    /// Signed relative error: positive where the front has come too far.
    pub fn error(&self) -> f64 {
        (self.own - self.expected) / self.far
    }
}

/// All rows of a front at which the reference's is known and has moved.
fn come(rows: &[FrontRow], reference: &dyn Reference) -> Vec<Judged> {
    let start = reference.front(0.0).unwrap_or(0.0);
    let mut far: f64 = 0.0;
    // The way of the front: growing or shrinking ice, whichever came first.
    let mut sign = 0.0;
    let mut judged = Vec::with_capacity(rows.len());
    for row in rows {
        let Some(expected) = reference.front(row.time_s).map(|front| front - start) else { continue };
        if sign == 0.0 && expected != 0.0 {
            sign = expected.signum();
        }
        far = far.max(sign * expected);
        if far > 0.0 {
            judged.push(Judged { time: row.time_s, own: sign * (row.front_m - start), expected: sign * expected, far });
        }
    }
    judged
}

/// Where the window of a front begins (s) by itself: where the reference's has come [`SPACINGS`] of these spacings (m), but
/// not after half of the run. `times` are those of outputs.
pub fn window_start(scene: &Scene, spacing: f64, times: impl Iterator<Item = f64>, reference: &dyn Reference) -> f64 {
    let rows: Vec<FrontRow> = times.map(|time_s| FrontRow { time_s, front_m: f64::NAN, front_ref_m: None }).collect();
    let far_enough = come(&rows, reference).into_iter().find(|row| row.far >= SPACINGS * spacing);
    let latest = (1.0 - JUDGED_SHARE) * scene.duration;
    far_enough.map_or(latest, |row| row.time).min(latest)
}

/// Rows of a front that count: from where the scene says, else from where it has come some spacings (m).
pub fn window(scene: &Scene, spacing: f64, rows: &[FrontRow], reference: &dyn Reference) -> Vec<Judged> {
    let times = rows.iter().map(|row| row.time_s);
    let from = scene.watch.front_from.unwrap_or_else(|| window_start(scene, spacing, times, reference));
    come(rows, reference).into_iter().filter(|row| row.time >= from).collect()
}

/// Signed relative error of the front at the end of the scene; absent for a run that did not get there.
pub(super) fn last(scene: &Scene, rows: &[FrontRow], reference: &dyn Reference) -> Option<f64> {
    let end = rows.last().filter(|row| row.time_s >= scene.duration * (1.0 - AT_THE_END))?;
    let judged = come(rows, reference).pop().filter(|row| row.time == end.time_s)?;
    super::finite(judged.error())
}

/// How near (of where it is at the end) a front that counts as steady has come, and in which part of the run it must have.
const STEADY: f64 = 0.02;
const STEADY_BEFORE: f64 = 0.9;

/// When a front came to stay near where it is at the end of the scene (s), between rows; absent where it still moves or the run did
/// not get there.
pub(super) fn steady(scene: &Scene, rows: &[FrontRow]) -> Option<f64> {
    let end = rows.last().filter(|row| row.time_s >= scene.duration * (1.0 - AT_THE_END))?;
    let off = |row: &FrontRow| (row.front_m - end.front_m).abs() - STEADY * end.front_m.abs();
    let last = rows.iter().rposition(|row| off(row) > 0.0)?;
    let [before, after] = rows.get(last..=last + 1)? else { return None };
    let share = off(before) / (off(before) - off(after));
    let time = before.time_s + share * (after.time_s - before.time_s);
    (time <= STEADY_BEFORE * scene.duration).then_some(time)
}

/// Signed relative error of the constant in `front = constant sqrt(t)`, fitted to the squares over a window; absent
/// unless the reference's own front follows the root of time.
pub(super) fn constant(window: &[Judged]) -> Option<f64> {
    let rate = |row: &Judged| row.expected * row.expected / row.time;
    let first = window.iter().find(|row| row.time > 0.0).map(rate)?;
    let is_root = |row: &Judged| row.time <= 0.0 || (rate(row) / first - 1.0).abs() < ROOT_OF_TIME;
    if !window.iter().all(is_root) {
        return None;
    }
    // Both fits go through the origin and share their denominator.
    let moment = |of: fn(&Judged) -> f64| window.iter().map(|row| row.time * of(row) * of(row)).sum::<f64>();
    let ratio = moment(|row| row.own) / super::positive(moment(|row| row.expected))?;
    super::finite(ratio.sqrt() - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use frazil_record::ReferenceInfo;

    /// A front at `start` that moves with the root of time, one way or the other.
    struct Moving {
        start: f64,
        speed: f64,
    }

    impl Reference for Moving {
        fn describe(&self) -> ReferenceInfo {
            ReferenceInfo::new("exact", "made up", 0.0)
        }
        fn front(&self, t: f64) -> Option<f64> {
            Some(self.start + self.speed * t.sqrt())
        }
    }

    fn row(time_s: f64, front_m: f64) -> FrontRow {
        FrontRow { time_s, front_m, front_ref_m: None }
    }

    #[test]
    fn a_thaw_is_judged_by_what_has_thawed_however_long_the_body() {
        for length in [1.0, 6.0, 24.0, 1e3] {
            let truth = Moving { start: length, speed: -0.1 };
            let rows: Vec<FrontRow> = [4.0, 9.0, 16.0].map(|t: f64| row(t, length - 1.02 * 0.1 * t.sqrt())).to_vec();
            for judged in come(&rows, &truth) {
                // What rounding of the length leaves of a tenth.
                assert!((judged.error() - 0.02).abs() < 1e-15 * length / 0.2 + 1e-12, "{length}: {judged:?}");
            }
            let constant = constant(&come(&rows, &truth)).expect("a root of time");
            assert!((constant - 0.02).abs() < 1e-10, "{length}: {constant}");
        }
    }

    #[test]
    fn a_front_is_steady_once_it_stays_near_its_end() {
        let line = frazil_core::space::domain::Domain::Line { length: 1.0 };
        let scene = Scene::bare(line, 10.0, Vec::new());
        let rows =
            |fronts: &[f64]| -> Vec<FrontRow> { (1..).zip(fronts).map(|(t, s)| row(f64::from(t), *s)).collect() };
        let grown = rows(&[0.5, 0.9, 0.96, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
        assert!((steady(&scene, &grown).expect("steady") - 3.5).abs() < 1e-9);
        // It passes its end and comes back.
        let back = rows(&[1.0, 1.1, 1.06, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
        assert!((steady(&scene, &back).expect("steady") - (3.0 + 2.0 / 3.0)).abs() < 1e-9);
        assert_eq!(steady(&scene, &rows(&[0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0])), None);
        assert_eq!(steady(&scene, &grown[..9]), None);
    }

    #[test]
    fn a_front_that_turns_back_stays_relative_to_how_far_it_came() {
        struct Back;
        impl Reference for Back {
            fn describe(&self) -> ReferenceInfo {
                ReferenceInfo::new("exact", "made up", 0.0)
            }
            fn front(&self, t: f64) -> Option<f64> {
                Some(if t < 2.0 { t } else { 4.0 - t })
            }
        }
        let judged = come(&[row(0.0, 0.0), row(1.0, 1.0), row(2.0, 2.0), row(3.0, 1.1), row(4.0, 0.1)], &Back);
        assert_eq!(judged.iter().map(|row| row.far).collect::<Vec<_>>(), [1.0, 2.0, 2.0, 2.0]);
        assert!((judged[3].error() - 0.05).abs() < 1e-12);
    }
}
