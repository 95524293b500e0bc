//! Measured points as a reference: what is known when something was measured, and nothing between.

use std::collections::BTreeMap;

use frazil_record::ReferenceInfo;
use frazil_scene::{Event, Measured, MeasuredPoint, Quantity, Scene};
use frazil_simulation::measure::measured::SAME_INSTANT;
use frazil_simulation::reference::Reference;

/// The measured points of a scene.
pub struct Points {
    measured: Measured,
    info: ReferenceInfo,
    /// By how much (s) two instants may differ and still be the same.
    near: f64,
}

impl Points {
    /// Those of a scene.
    pub fn of_scene(scene: &Scene, measured: &Measured) -> Self {
        let (measured, near) = (measured.clone(), SAME_INSTANT * scene.duration);
        let mut points = Points { measured, info: ReferenceInfo::new("measured", "", 0.0), near };
        let errors = points.errors(scene);
        let first = ["front", "closure", "thaw", "steady", "temperature", "saturation"]
            .iter()
            .find_map(|name| errors.get(*name));
        let error = first.copied().unwrap_or_default();
        let source = points.measured.source.clone();
        points.info = ReferenceInfo { errors, ..ReferenceInfo::new("measured", source, error) };
        points
    }

    /// What the instruments leave open of each measure, in its terms.
    fn errors(&self, scene: &Scene) -> BTreeMap<String, f64> {
        let start = self.front(0.0).unwrap_or(0.0);
        let mut far: f64 = 0.0;
        let front = self.of(|quantity| quantity == Quantity::Front).filter_map(|point| {
            far = far.max((point.value - start).abs());
            (far > 0.0).then(|| point.sd / far)
        });
        let front = rms(front);
        let (least, greatest) = scene.temperature_range();
        let range = if scene.of_water { 1.0 } else { greatest - least };
        let probes = rms(self.of(|quantity| matches!(quantity, Quantity::Probe { .. })).map(|point| point.sd / range));
        let of_event =
            |event: Event| rms(self.of(|quantity| quantity == Quantity::Event(event)).map(|at| at.sd / at.time));
        let probed = if scene.of_water { "saturation" } else { "temperature" };
        let all = [
            ("front", front),
            ("closure", of_event(Event::Closure)),
            ("thaw", of_event(Event::Thaw)),
            ("steady", of_event(Event::Steady)),
            (probed, probes),
        ];
        all.into_iter().filter_map(|(name, error)| Some((name.to_owned(), error?))).collect()
    }

    fn of(&self, wanted: impl Fn(Quantity) -> bool) -> impl Iterator<Item = &MeasuredPoint> {
        self.measured.points.iter().filter(move |point| wanted(point.quantity))
    }
}

/// Root of the mean square; absent for no values and where one is not finite.
fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value * value));
    Some((sum / count).sqrt()).filter(|rms: &f64| rms.is_finite())
}

/// Mean of values; absent for none.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    (count > 0.0).then(|| sum / count)
}

impl Reference for Points {
    fn describe(&self) -> ReferenceInfo {
        self.info.clone()
    }

    fn measured(&self) -> Option<&Measured> {
        Some(&self.measured)
    }

    fn front(&self, t: f64) -> Option<f64> {
        let then = self.of(|quantity| quantity == Quantity::Front).filter(|point| (point.time - t).abs() <= self.near);
        mean(then.map(|point| point.value))
    }

    fn event(&self, name: &str) -> Option<f64> {
        let is_it = |quantity| matches!(quantity, Quantity::Event(event) if event.name() == name);
        mean(self.of(is_it).map(|point| point.value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frazil_core::space::domain::Domain;
    use frazil_scene::Source;

    fn point(quantity: Quantity, time: f64, value: f64, sd: f64) -> MeasuredPoint {
        MeasuredPoint { quantity, time, value, sd }
    }

    #[test]
    fn measured_points_know_their_instants_and_nothing_between() {
        let scene = Scene::bare(Domain::Line { length: 1.0 }, 100.0, Vec::new());
        let closure = Quantity::Event(Event::Closure);
        let points = vec![
            point(Quantity::Front, 0.0, 0.1, 0.01),
            point(Quantity::Front, 10.0, 0.3, 0.01),
            point(Quantity::Front, 10.0, 0.5, 0.01),
            point(closure, 40.0, 40.0, 2.0),
        ];
        let points = Points::of_scene(&scene, &Measured { source: "made up".into(), points });
        assert_eq!([0.0, 5.0, 10.0, 10.0 + 1e-8].map(|t| points.front(t)), [Some(0.1), None, Some(0.4), Some(0.4)]);
        assert_eq!((points.event("closure_day"), points.event("thawed")), (Some(40.0), None));
        let info = points.describe();
        // Over how far the front has come since its start, where it has come anywhere.
        let front = ((0.01_f64 / 0.2).powi(2) / 2.0 + (0.01_f64 / 0.4).powi(2) / 2.0).sqrt();
        assert!((info.errors["front"] - front).abs() < 1e-12 && info.errors["closure"] == 0.05);
        assert_eq!((info.kind.as_str(), info.error_estimate_rel), ("measured", info.errors["front"]));
    }

    #[test]
    fn bundled_scenes_have_the_files_that_they_name() {
        for bundled in crate::scenes::all().iter().filter(|bundled| !bundled.files.is_empty()) {
            let Source { text, .. } = bundled.into();
            for (name, points) in bundled.files {
                assert!(text.contains(&format!("\"{name}\"")), "{}: {name}", bundled.name);
                assert!(points.starts_with("# "), "{name} opens with where it is from");
            }
        }
    }
}
