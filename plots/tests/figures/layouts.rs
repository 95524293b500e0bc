//! Layouts from made-up records.

use std::f64::consts::TAU;

use frazil_plots::canvas::text_width;
use frazil_plots::layouts::{LayoutView, PipeView, drawings, gaps_polar, sketches, summary};
use frazil_record::{Field, LinkRow, PlaneRow, ProfileRow, RunResult, WallRecord, WallRow};

const DAY: f64 = 86400.0;
const LAST: f64 = 60.0;

/// A ring as it was run.
struct Made {
    name: String,
    pipes: Vec<PipeView>,
    missing: Vec<(f64, f64)>,
    result: RunResult,
    load: Vec<(f64, f64)>,
    weakest_plane: Vec<(f64, f64)>,
    closure: Option<f64>,
    reopening: Option<f64>,
    design: Option<f64>,
}

impl Made {
    fn view(&self) -> LayoutView<'_> {
        LayoutView {
            dug_s: None,
            water: None,
            name: self.name.clone(),
            pipes: self.pipes.clone(),
            missing: self.missing.clone(),
            outer_radius_m: 12.0,
            shaft_radius_m: Some(4.0),
            result: &self.result,
            load: self.load.clone(),
            axis: Vec::new(),
            weakest_plane: self.weakest_plane.clone(),
            closure_s: self.closure.map(|day| day * DAY),
            standing: self.closure.map(|day| (day * DAY, self.reopening.map(|day| day * DAY))).into_iter().collect(),
            design: self.design.map(|day| day * DAY),
            design_left: self.reopening.and(self.design).map(|day| 1.2 * day * DAY),
            reference: Vec::new(),
        }
    }
}

/// The day on which a gap closes, by its width; beyond the last it stays open.
fn closure(distance: f64) -> Option<f64> {
    Some(7.0 * distance * distance).filter(|day| *day < LAST)
}

/// A ring of pipes with a second one inside it if so asked, of which some of the first are missing.
fn ring(name: &str, count: usize, missing: &[usize], inner: bool) -> Made {
    let mut made = Made {
        name: name.into(),
        pipes: Vec::new(),
        missing: Vec::new(),
        result: super::empty(name, "sph"),
        load: Vec::new(),
        weakest_plane: Vec::new(),
        closure: None,
        reopening: None,
        design: None,
    };
    let place = |radius: f64, k: f64| {
        let (sin, cos) = (TAU * k / count as f64).sin_cos();
        (radius * cos, radius * sin)
    };
    for (number, radius, shift) in [(1, 5.5, 0.0), (2, 4.6, 0.5)].into_iter().take(1 + usize::from(inner)) {
        for k in 0..count {
            let (x, y) = place(radius, k as f64 + shift);
            if number == 1 && missing.contains(&k) {
                made.missing.push((x, y));
            } else {
                let name = format!("{number}.{}", k + 1);
                made.pipes.push(PipeView { name, x_m: x, y_m: y, radius_m: 0.054 });
            }
        }
    }
    let mut link = |from: &PipeView, to: &PipeView| {
        let distance = (from.x_m - to.x_m).hypot(from.y_m - to.y_m);
        made.result.links.push(LinkRow {
            from: from.name.clone(),
            to: to.name.clone(),
            x_m: 0.5 * (from.x_m + to.x_m),
            y_m: 0.5 * (from.y_m + to.y_m),
            distance_m: distance,
            closure_s: closure(distance).map(|day| day * DAY),
            closure_on_circle_s: None,
            alike: 0,
            closure_alike_s: None,
        });
    };
    let first: Vec<&PipeView> = made.pipes.iter().filter(|pipe| pipe.name.starts_with("1.")).collect();
    for (k, pipe) in first.iter().enumerate() {
        link(pipe, first[(k + 1) % first.len()]);
    }
    let second: Vec<&PipeView> = made.pipes.iter().filter(|pipe| pipe.name.starts_with("2.")).collect();
    for (from, to) in second.iter().zip(&first) {
        link(from, to);
    }
    let last = made.result.links.iter().map(|link| link.closure_s).reduce(|a, b| a.zip(b).map(|(a, b)| a.max(b)));
    made.closure = last.flatten().map(|time| time / DAY);
    // Of equal ones the first.
    let day = |link: &LinkRow| link.closure_s.unwrap_or(link.distance_m * 1e12);
    let later =
        made.result.links.iter().reduce(|best, link| if day(link) > (1.0 + 1e-9) * day(best) { link } else { best });
    let weakest = later.map(|link| [link.from.clone(), link.to.clone()]);
    made.result.record.wall = Some(WallRecord {
        closed: made.closure.is_some(),
        closure_s: made.closure.map(|day| day * DAY),
        reopening_s: None,
        standing_s: Vec::new(),
        thickness_m: 0.0,
        mean_temperature_c: None,
        weakest_gap: weakest.clone(),
        last_gap: weakest,
        last_gap_alike: 1,
        last_gap_spread_s: None,
    });
    made.design = made.closure.map(|day| 1.7 * day).filter(|day| *day < LAST);
    for k in 1..=120 {
        let day = LAST * f64::from(k) / 120.0;
        made.load.push((day * DAY, count as f64 * (70.0 + 300.0 / day.sqrt())));
        let thick = made.closure.map_or(0.0, |closed| (day - closed).max(0.0).sqrt() * 0.3);
        let wall = |plane: &str, thick: f64, mean: f64| PlaneRow {
            time_s: day * DAY,
            plane: plane.into(),
            inner_m: (thick > 0.0).then_some(5.5 - 0.45 * thick),
            outer_m: (thick > 0.0).then_some(5.5 + 0.55 * thick),
            mean_temperature_c: (thick > 0.0).then_some(mean),
            from: String::new(),
            to: String::new(),
        };
        let mean = -14.0 * (1.0 - (-day * count as f64 / 400.0).exp());
        made.result.planes.push(wall("main", 0.3 * day.sqrt(), mean));
        made.result.planes.push(wall("weakest", thick, mean));
        made.result.walls.push(WallRow {
            time_s: day * DAY,
            thickness_main_mean_m: Some(0.3 * day.sqrt()),
            thickness_main_mean_ref_m: None,
            thickness_interface_mean_m: Some(thick),
            thickness_interface_mean_ref_m: None,
            frozen_area_m2: day,
            frozen_area_ref_m2: None,
            heat_per_pipe_w_per_m: 70.0,
            closed: Some(thick > 0.0),
            thickness_weakest_m: Some(thick),
        });
        made.result.planes.push(PlaneRow { inner_m: None, outer_m: None, ..wall("wall", 1.0, mean) });
    }
    for k in 0..120 {
        let x = 0.1 * f64::from(k);
        let temperature = |coldest: f64| 12.0 + (coldest - 12.0) * (-(x - 5.5).abs() / 1.5).exp();
        made.weakest_plane.push((x, temperature(-1.2 * count as f64 / 2.0)));
        made.result.profiles.push(ProfileRow {
            time_s: LAST * DAY,
            x_m: Some(x),
            temperature_c: temperature(-25.0),
            temperature_ref_c: None,
            frozen_fraction: 0.0,
            concentration: None,
            concentration_ref: None,
            plane: "main".into(),
            y_m: None,
            along_m: x,
            mean_over: None,
        });
    }
    made.result.fields.push(field(&made.pipes));
    made
}

fn field(pipes: &[PipeView]) -> Field {
    let (n, spacing) = (160, 0.1);
    let at = |k: usize| spacing * (k as f64 + 0.5) - 8.0;
    let value = |(x, y): (f64, f64)| {
        let cold: f64 = pipes
            .iter()
            .map(|pipe| {
                let distance = (x - pipe.x_m).hypot(y - pipe.y_m).max(0.054);
                3.1 * (-distance / 1.2).exp() * (1.2 / distance).min(6.0)
            })
            .sum();
        if x.hypot(y) > 8.0 { f64::NAN } else { (12.0 - cold).max(-28.0) }
    };
    let temperature_c: Vec<f64> = (0..n * n).map(|k| value((at(k % n), at(k / n)))).collect();
    Field {
        time_s: 40.0 * DAY,
        nx: n,
        ny: n,
        x0_m: at(0),
        y0_m: at(0),
        spacing_m: spacing,
        frozen_fraction: temperature_c.iter().map(|value| (-0.2 - value).clamp(0.0, 0.6) / 0.6).collect(),
        temperature_c,
        concentration: Vec::new(),
        temperature_ref_c: Vec::new(),
    }
}

/// Three layouts that close, one with a gap that does not, and four more.
fn eight() -> Vec<Made> {
    vec![
        ring("26 pipes", 26, &[], false),
        ring("20 pipes", 20, &[], false),
        ring("26 pipes, 1.4 missing", 26, &[3], false),
        ring("26 pipes, 1.11 and 1.12 missing", 26, &[10, 11], false),
        ring("two rings, staggered", 26, &[], true),
        ring("32 pipes", 32, &[], false),
        ring(
            "Shaft three, horizon at 212 m in the lower clay: 24 pipes of 108 mm with brine at −28 °C and pipe 1.7 not \
             in service",
            24,
            &[6],
            false,
        ),
        ring("14 pipes", 14, &[], false),
    ]
}

/// A word of a drawing and the box that it fills.
#[derive(Debug)]
struct Word {
    text: String,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

/// The words of a drawing that run from left to right, off its SVG.
fn words(svg: &str) -> Vec<Word> {
    let number = |tag: &str, key: &str| -> Option<f64> {
        tag.split_once(&format!(" {key}=\""))?.1.split_once('"')?.0.parse().ok()
    };
    svg.split("<text ")
        .skip(1)
        .filter_map(|rest| {
            let (tag, rest) = rest.split_once('>')?;
            let tag = format!(" {tag}");
            let text = rest.split_once("</text>")?.0.trim().to_owned();
            if tag.contains("rotate") {
                return None;
            }
            // Ten units are a pixel.
            let (x, y) = (0.1 * number(&tag, "x")?, 0.1 * number(&tag, "y")?);
            let size = 0.1 * number(&tag, "font-size")?;
            let width = text_width(&text, size, tag.contains("bold"));
            let left = match tag.contains("\"middle\"") {
                true => x - 0.5 * width,
                false if tag.contains("\"end\"") => x - width,
                false => x,
            };
            // The point lies on the base line.
            Some(Word { text, left, right: left + width, top: y - 0.72 * size, bottom: y })
        })
        .collect()
}

/// What is cut off or written over something else.
fn faults(svg: &str, (width, height): (f64, f64)) -> Vec<String> {
    let words = words(svg);
    assert!(!words.is_empty(), "a drawing without words");
    let mut faults = Vec::new();
    for (k, a) in words.iter().enumerate() {
        if a.left < 0.0 || a.top < 0.0 || a.right > width || a.bottom > height {
            faults.push(format!("{a:?} is cut off"));
        }
        for b in &words[k + 1..] {
            if a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom {
                faults.push(format!("{a:?} over {b:?}"));
            }
        }
    }
    faults
}

fn check(layouts: &[LayoutView<'_>]) {
    for drawing in drawings(layouts, -0.5) {
        let canvas = &drawing.canvas;
        let faults = faults(&canvas.svg(), (canvas.width, canvas.height));
        assert!(faults.is_empty(), "{}: {faults:#?}", drawing.stem);
    }
}

#[test]
fn no_word_is_cut_off_or_written_over_another() {
    let made = eight();
    let views: Vec<LayoutView<'_>> = made.iter().map(Made::view).collect();
    check(&views);
    for view in &views {
        check(std::slice::from_ref(view));
    }
    let many: Vec<LayoutView<'_>> = (0..3).flat_map(|_| views.iter().cloned()).collect();
    check(&many);
}

/// Days of a reference are told by the legend and have their room, also beyond all gaps.
#[test]
fn days_of_a_reference_stand_beside_the_gaps() {
    let made = ring("one ring", 26, &[], false);
    let mut view = made.view();
    assert!(!gaps_polar(&view).svg().contains("reference"));
    let latest = made.result.links.iter().filter_map(|link| link.closure_s).fold(0.0, f64::max);
    view.reference = vec![Some(2.0 * latest); made.result.links.len()];
    assert!(gaps_polar(&view).svg().contains("reference"));
    check(&[view]);
}

#[test]
fn layouts_of_which_little_is_known_are_drawn() -> Result<(), Box<dyn std::error::Error>> {
    let bare = Made {
        name: String::new(),
        pipes: Vec::new(),
        missing: Vec::new(),
        result: super::empty("nothing", "pd"),
        load: Vec::new(),
        weakest_plane: Vec::new(),
        closure: None,
        reopening: None,
        design: None,
    };
    let mut view = bare.view();
    view.name = "nothing known".into();
    view.shaft_radius_m = None;
    check(&[view.clone()]);
    assert!(gaps_polar(&view).png()?.len() > 1000);
    assert!(drawings(&[], 0.0).is_empty());
    // A wall that stands although a gap beside it does not close.
    let mut spared = ring("one gap beside the wall", 26, &[], true);
    if let Some(link) = spared.result.links.last_mut() {
        link.closure_s = None;
    }
    check(&[spared.view()]);
    // The weakest gap is the one that closed the wall, not the one that it did not need.
    assert!(summary(&[spared.view()]).svg().contains("1.1–1.2 (+25)"));
    assert!(summary(&[spared.view()]).svg().contains("a gap beside the wall still open"));
    // Nothing frozen: all gaps open, no wall, one instant only.
    let mut unfrozen = ring("still warm", 26, &[], false);
    unfrozen.closure = None;
    unfrozen.design = None;
    unfrozen.load.truncate(1);
    for link in &mut unfrozen.result.links {
        link.closure_s = None;
    }
    for row in &mut unfrozen.result.planes {
        (row.inner_m, row.outer_m, row.mean_temperature_c) = (None, None, None);
    }
    check(&[unfrozen.view()]);
    let said = sketches(&[unfrozen.view()]).iter().map(|canvas| canvas.svg()).collect::<String>();
    assert!(said.contains("no gap closes"));
    check(&[unfrozen.view(), view]);
    for drawing in drawings(&[unfrozen.view()], 0.0) {
        assert!(!drawing.canvas.svg().contains("NaN") && drawing.canvas.png()?.len() > 1000, "{}", drawing.stem);
    }
    Ok(())
}

/// The figure to look at first says in words what the links say.
#[test]
fn closure_weakest_gap_and_load_stand_beside_the_bar() {
    let (whole, failed) = (ring("whole", 26, &[], false), ring("failed", 26, &[3], false));
    let open = ring("open", 26, &[10, 11], false);
    let staggered = ring("staggered", 26, &[], true);
    let svg = summary(&[whole.view(), failed.view(), open.view(), staggered.view()]).svg();
    let said: Vec<String> = words(&svg).into_iter().map(|word| word.text).collect();
    let says = |text: &str| said.iter().any(|other| other == text);
    // By the chords: 11 sin(π/26) = 1.3259 m, and twice the angle 11 sin(2π/26) = 2.6325 m, squared and times 7 d/m2.
    assert!(says("12.3 d") && says("48.5 d") && says("never"), "{said:?}");
    assert!(says("all alike") && says("1.3–1.5") && says("1.10–1.13"), "{said:?}");
    // The outer ring's gaps are wider than those between the rings, and none of them than another.
    assert!(says("1.1–1.2 (+25)"), "{said:?}");
    // 26 (70 + 300 / √12.306) W/m = 4043.5, to which the chord between instants half a day apart adds
    // 300 · 26 · (0.5)² / 8 · 3/4 · 12.3^-2.5 = 0.3.
    assert!(says("4044 W/m"), "{said:?}");
}

#[test]
fn sketches_stand_six_to_a_figure() {
    let made = eight();
    let views: Vec<LayoutView<'_>> = made.iter().map(Made::view).collect();
    let figures = sketches(&views);
    assert_eq!(figures.len(), 2);
    let named = |k: usize, name: &str| figures[k].svg().contains(name);
    assert!(named(0, "32 pipes") && !named(0, "14 pipes") && named(1, "14 pipes"));
    // All sketches have one scale.
    assert!(figures[0].width == figures[1].width && figures[0].height > 1.5 * figures[1].height);
}

#[test]
fn figures_come_in_the_order_in_which_they_are_read() -> Result<(), Box<dyn std::error::Error>> {
    let temporary = tempfile::tempdir()?;
    let folder = std::env::var_os("FRAZIL_FIGURES").map_or(temporary.path().to_path_buf(), Into::into);
    let made = eight();
    let views: Vec<LayoutView<'_>> = made.iter().map(Made::view).collect();
    let all = drawings(&views, -0.5);
    let wanted =
        ["summary", "sketches", "sketches_2", "thickness", "mean_temperature", "load", "gaps_1", "planes", "map_1_40d"];
    let places: Vec<Option<usize>> =
        wanted.iter().map(|stem| all.iter().position(|drawing| drawing.stem == *stem)).collect();
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
    for drawing in &all {
        for path in drawing.canvas.write(&folder, &drawing.stem, crate::ALL)? {
            let size = std::fs::metadata(&path)?.len();
            assert!(size > 2000, "{}: {size} bytes", path.display());
        }
    }
    Ok(())
}
