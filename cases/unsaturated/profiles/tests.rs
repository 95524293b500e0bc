use super::*;
use crate::unsaturated::inclusions::inclusions;

const LINE: Cut = Cut::AlongX { y: 0.0 };

fn profiles(case: Case) -> Profiles {
    Profiles::of_case(case).expect("profiles")
}

#[test]
fn tables_are_in_range() {
    for case in Case::ALL {
        let table = profiles(case);
        let (times, cuts) = (table.times(), table.cuts());
        assert_eq!(table.profiles.len(), times.len() * cuts.len(), "{case:?}: {cuts:?}");
        for profile in &table.profiles {
            assert!(profile.along.windows(2).all(|pair| pair[0] < pair[1]), "{case:?}");
            for sample in &profile.samples {
                assert!((0.0..=1.0).contains(&sample.saturation) && (0.0..=1.0).contains(&sample.concentration));
                assert!((0.0..0.15).contains(&sample.saturation_error), "{case:?}: {sample:?}");
                assert!((0.0..0.02).contains(&sample.concentration_error), "{case:?}: {sample:?}");
            }
        }
    }
}

#[test]
fn times_and_cuts_are_those_of_the_problems() {
    let days = |case: Case| profiles(case).times().iter().map(|time| time / DAY).collect::<Vec<_>>();
    assert_eq!(days(Case::OneSided), [1.0, 5.0, 10.0, 15.0, 20.0, 40.0]);
    assert_eq!(days(Case::ZoneSource), [5.0, 10.0, 15.0]);
    assert_eq!(days(Case::Cracks), [5.0, 10.0, 15.0, 20.0]);
    assert_eq!(days(Case::PermeableInclusions), [5.0, 10.0, 20.0, 40.0]);
    let expect = |case: Case, expected: &[Cut]| {
        let found = profiles(case).cuts();
        assert!(found.len() == expected.len() && found.iter().zip(expected).all(|(own, other)| own.is_same(*other)));
    };
    expect(Case::TwoSided, &[LINE]);
    expect(Case::ZoneSource, &[Cut::AlongX { y: 0.05 }, Cut::AlongY { x: 0.02 }, Cut::AlongY { x: 0.05 }]);
    let centred = [0.02, -0.025, 0.0].map(|y| Cut::AlongX { y });
    expect(Case::GrowingCracks, &[centred[0], centred[1], centred[2], Cut::AlongY { x: 0.02 }]);
}

/// The place (m) on the line at which a falling quantity passes a value.
fn place_of(read: impl Fn(f64) -> Option<f64>, value: f64) -> f64 {
    let (mut low, mut high) = (0.0, 0.1);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if read(middle).expect("a value") > value { low = middle } else { high = middle }
    }
    low
}

#[test]
fn fronts_of_the_line_are_the_published_ones() {
    let table = profiles(Case::OneSided);
    for (days, half, tenth, solute, faint) in [
        (5.0, 3.6136, 3.704, 1.9197, 3.7869),
        (10.0, 5.1104, 5.238, 2.7148, 5.3555),
        (15.0, 6.2589, 6.415, 3.3250, 6.5624),
    ] {
        let t = days * DAY;
        let saturation = |value| place_of(|x| table.saturation(LINE, x, t), value) * 100.0;
        let concentration = |value| place_of(|x| table.concentration(LINE, x, t), value) * 100.0;
        // The front bends within the distance of rows.
        assert!((saturation(0.5) - half).abs() < 1e-2, "{days} d: {}", saturation(0.5));
        assert!((saturation(0.1) - tenth).abs() < 2e-2, "{days} d: {}", saturation(0.1));
        assert!((concentration(0.5) - solute).abs() < 5e-4, "{days} d: {}", concentration(0.5));
        assert!((concentration(0.1) - faint).abs() < 5e-4, "{days} d: {}", concentration(0.1));
    }
    let table = profiles(Case::TwoSided);
    let driest = (0..=1000).filter_map(|step| table.saturation(LINE, 1e-4 * f64::from(step), 10.0 * DAY));
    let driest = driest.fold(1.0, f64::min);
    assert!((driest - 0.8362).abs() < 1e-3, "{driest}");
    assert!((table.saturation(LINE, 0.05, 15.0 * DAY).expect("full") - 1.0).abs() < 1e-6);
    let half = place_of(|x| table.concentration(LINE, x, 15.0 * DAY), 0.5) * 100.0;
    assert!((half - 2.8897).abs() < 5e-4, "{half}");
}

#[test]
fn the_crack_throws_a_shadow() {
    let (table, cut) = (profiles(Case::Cracks), Cut::AlongX { y: 0.02 });
    let saturation = |x: f64| table.saturation(cut, x, 20.0 * DAY).expect("a saturation");
    assert!((saturation(0.0095) - 0.901).abs() < 2e-3 && (saturation(0.0105) - 0.616).abs() < 2e-2);
    // Up to the crack by its own side.
    assert!((saturation(0.0099) - 0.901).abs() < 2e-3 && (saturation(0.0101) - 0.616).abs() < 2e-2);
}

#[test]
fn between_rows_lies_a_straight_line_and_beyond_them_nothing() {
    let text = "time_d,x_cm,y_cm,saturation,concentration,saturation_error,concentration_error\n\
                1,0.5,2,1,0.8,0.1,0.2\n1,1.5,2,0.5,0.4,0.1,0\n1,3.5,2,0,0,0,0\n1,3,0.5,0.3,0,0,0\n1,3,1.5,0.1,0,0,0\n";
    let table = Profiles::read(text).expect("a table");
    let (along, across) = (Cut::AlongX { y: 0.02 }, Cut::AlongY { x: 0.03 });
    let near = |found: Option<f64>, expected: f64| found.is_some_and(|found| (found - expected).abs() < 1e-12);
    assert!(near(table.saturation(along, 0.01, DAY), 0.75) && near(table.concentration(along, 0.01, DAY), 0.6));
    assert!(near(table.at(along, 0.01, DAY).map(|sample| sample.concentration_error), 0.1));
    assert!(near(table.saturation(along, 0.005, DAY), 1.0) && near(table.saturation(along, 0.035, DAY), 0.0));
    assert!(near(table.saturation(across, 0.01, DAY), 0.2));
    // Beyond the rows, where rows are left out, and at other times and cuts.
    for place in [0.0049, 0.02, 0.0351] {
        assert_eq!(table.at(along, place, DAY), None, "{place}");
    }
    assert_eq!(table.at(along, 0.01, 2.0 * DAY), None);
    assert_eq!(table.at(Cut::AlongX { y: 0.03 }, 0.01, DAY), None);
    assert!(Profiles::read("time_d,x_cm\n1,2\n").is_err_and(|error| error.to_string().contains("y_cm")));
}

#[test]
fn impermeable_discs_are_left_out() {
    let table = profiles(Case::ImpermeableInclusions);
    let cut = Cut::AlongX { y: 0.05 };
    for disc in inclusions().expect("discs") {
        let reach = disc.radius.powi(2) - (disc.y - 0.05).powi(2);
        if reach > 0.0 {
            assert_eq!(table.at(cut, disc.x, 10.0 * DAY), None, "{disc:?}");
        }
    }
    assert!(table.at(cut, 0.005, 10.0 * DAY).is_some());
}
