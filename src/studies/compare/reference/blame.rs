//! Which outputs keep a reference from converging, and what to set so that they do not.

use frazil_plots::style::{number, percent};
use frazil_record::RunResult;
use frazil_scene::{Scene, Units};
use frazil_simulation::measure;
use frazil_simulation::reference::Reference;

use super::WORST;
use crate::ensemble::runs::Headline;

/// Instant (s) and relative error there.
type Errors = Vec<(f64, f64)>;

/// What is to blame for the difference of a run from a finer one in a measure, in words.
pub fn outputs(headline: Headline, scene: &Scene, spacing: f64, run: &RunResult, truth: &dyn Reference) -> String {
    match headline {
        Headline::Front => {
            let window = measure::front::window(scene, spacing, &run.front, truth);
            front(scene, &window.iter().map(|row| (row.time, row.error())).collect())
        }
        Headline::Temperature | Headline::Saturation | Headline::Concentration => {
            profiles(scene, &by_instant(headline, scene, spacing, run, truth))
        }
        Headline::Volume | Headline::Closure => FINER.into(),
    }
}

/// What helps where no output is to blame.
const FINER: &str = "a finer spacing may be sufficient, with more time (--budget-s)";

fn rms(errors: &[(f64, f64)]) -> f64 {
    (errors.iter().map(|(_, error)| error * error).sum::<f64>() / errors.len().max(1) as f64).sqrt()
}

/// An instant of a scene in its unit, and the ending of keys in that unit.
fn instant(scene: &Scene, seconds: f64) -> (String, String) {
    let ending = match scene.units {
        Units::Si => format!("_{}", scene.time_unit.ending()),
        _ => String::new(),
    };
    (number(seconds / scene.time_unit.seconds(), 4), ending)
}

/// The first outputs of a front, if without them it would do.
fn front(scene: &Scene, errors: &Errors) -> String {
    // A window of less than half of the outputs says nothing of the front.
    let enough = (1..=errors.len() / 2).find(|first| rms(&errors[*first..]) <= WORST);
    match enough {
        Some(first) => {
            let (last, ending) = instant(scene, errors[first - 1].0);
            let (from, _) = instant(scene, errors[first].0);
            format!(
                "the outputs up to {last} cause it, without them it is {}: set watch.front_from{ending} = {from}",
                percent(rms(&errors[first..]), 2)
            )
        }
        None => {
            let worst = errors.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            worst.map_or(FINER.to_owned(), |(time, error)| {
                let at = instant(scene, *time).0;
                format!("the output at {at} differs most, by {}: {FINER}", percent(error.abs(), 2))
            })
        }
    }
}

/// The profiles that differ most.
fn profiles(scene: &Scene, errors: &Errors) -> String {
    let mut sorted = errors.clone();
    sorted.sort_by(|a, b| b.1.total_cmp(&a.1));
    let enough = (1..=sorted.len() / 2).find(|left_out| rms(&sorted[*left_out..]) <= WORST);
    match (enough, sorted.first()) {
        (Some(left_out), _) => {
            let mut times: Vec<f64> = sorted[..left_out].iter().map(|(time, _)| *time).collect();
            times.sort_by(f64::total_cmp);
            let ending = instant(scene, 0.0).1;
            let times: Vec<String> = times.into_iter().map(|time| instant(scene, time).0).collect();
            format!(
                "the profiles at {} cause it, without them it is {}: remove them from time.profiles{ending}",
                times.join(", "),
                percent(rms(&sorted[left_out..]), 2)
            )
        }
        (None, Some((time, error))) => {
            format!("the profile at {} differs most, by {}: {FINER}", instant(scene, *time).0, percent(*error, 2))
        }
        (None, None) => FINER.into(),
    }
}

/// Rms error of each profile.
fn by_instant(headline: Headline, scene: &Scene, spacing: f64, run: &RunResult, truth: &dyn Reference) -> Errors {
    let mut times: Vec<f64> = run.profiles.iter().map(|row| row.time_s).collect();
    times.dedup();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let error = |time: f64| {
        let mut one = RunResult::bare(run.record.clone());
        one.profiles = run.profiles.iter().filter(|row| row.time_s == time).cloned().collect();
        Some((time, headline.of(&measure::errors(scene, spacing, &one, truth))?))
    };
    times.into_iter().filter_map(error).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Scene {
        crate::bundled::scene("stefan-water", &[]).expect("good")
    }

    #[test]
    fn first_outputs_of_a_front_are_named_with_the_key_that_leaves_them_out() {
        let errors: Errors = (1..=60).map(|k| (60.0 * f64::from(k), if k < 4 { 0.4 } else { 0.002 })).collect();
        let said = front(&scene(), &errors);
        assert!(said.contains("up to 0.05 cause it") && said.contains("watch.front_from_h = 0.06667"), "{said}");
        let even: Errors = (1..=60).map(|k| (60.0 * f64::from(k), 0.05)).collect();
        assert!(front(&scene(), &even).contains("--budget-s"), "{}", front(&scene(), &even));
    }

    #[test]
    fn profiles_that_differ_are_named() {
        let said = profiles(&scene(), &vec![(360.0, 0.2), (3600.0, 0.001), (7200.0, 0.001)]);
        assert!(said.contains("profiles at 0.1 cause") && said.contains("time.profiles_h"), "{said}");
    }
}
