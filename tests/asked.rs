//! What is asked in the wrong place, or is hardly meant, is told so.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use frazil_scene::Scene;

fn frazil(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_frazil")).current_dir(folder).args(arguments).output().expect("a process")
}

fn said(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim_end().to_owned();
    (text(&output.stdout), text(&output.stderr))
}

/// A folder with a study, and what a command says of it.
fn study(text: &str, arguments: &[&str]) -> (Option<i32>, String, String) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("s.toml"), text).expect("written");
    let output = frazil(folder.path(), &[&["layout", "s.toml"], arguments].concat());
    let (out, err) = said(&output);
    (output.status.code(), out, err)
}

#[test]
fn a_scene_is_no_study_and_a_study_no_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = |name: &str| frazil_cases::scenes::find(name).expect("a scene").text;
    fs::write(folder.path().join("ring.toml"), text("frozen-wall-sand")).expect("written");
    fs::write(folder.path().join("two.toml"), "title = \"t\"\nscene = \"frozen-wall-sand\"\n").expect("written");
    for (arguments, expected) in [
        (["layout", "frozen-wall-sand"], "is a scene, not a layout study: frazil run frozen-wall-sand"),
        (["layout", "ring.toml"], "is a scene, not a layout study: frazil run ring.toml"),
        (["run", "shaft-sweep"], "is a layout study, not a scene: frazil layout shaft-sweep"),
        (["run", "two.toml"], "is a layout study, not a scene: frazil layout two.toml"),
        (["check", "two.toml"], "is a layout study, not a scene: frazil layout two.toml"),
        (["compare", "two.toml"], "is a layout study, not a scene: frazil layout two.toml"),
    ] {
        let output = frazil(folder.path(), &arguments);
        assert_eq!(said(&output).1, format!("\"{}\" {expected}", arguments[1]));
        assert_eq!(output.status.code(), Some(2));
    }
}

#[test]
fn a_path_in_a_study_is_relative_to_the_study() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir_all(folder.path().join("shaft/ground")).expect("a folder");
    let text = frazil_cases::scenes::find("frozen-wall-sand").expect("a scene").text;
    fs::write(folder.path().join("shaft/ground/sand.toml"), text).expect("written");
    fs::write(folder.path().join("shaft/s.toml"), "title = \"t\"\nscene = \"ground/sand.toml\"\n").expect("written");
    let output = frazil(folder.path(), &["layout", "shaft/s.toml", "--check"]);
    assert_eq!((output.status.code(), said(&output).1), (Some(0), String::new()));
}

/// Every key of a bundled scene is known for what it is in a place where it has no meaning.
#[test]
fn a_key_is_recognised_wherever_it_stands() {
    fn keys(value: &toml::Value, path: &mut Vec<String>, found: &mut Vec<String>) {
        if let toml::Value::Array(items) = value {
            items.iter().for_each(|item| keys(item, path, found));
        }
        let toml::Value::Table(table) = value else { return };
        for (key, value) in table {
            let named = path.len() == 1 && ["materials", "walls", "method"].contains(&path[0].as_str());
            if !named && !path.is_empty() {
                found.push(key.clone());
            }
            path.push(key.clone());
            keys(value, path, found);
            path.pop();
        }
    }
    let mut found = Vec::new();
    for scene in frazil_cases::scenes::all().iter().filter(|scene| !scene.text.contains("units = ")) {
        keys(&toml::Value::Table(scene.text.parse().expect("a table")), &mut Vec::new(), &mut found);
    }
    found.sort();
    found.dedup();
    assert!(found.len() > 70, "{}", found.len());
    let good = frazil_cases::scenes::find("stefan-water").expect("a scene").text;
    let refused = |key: &str| {
        let text = format!("{key} = 1\n{good}");
        let read = Scene::read(&text, "s", "s.toml", &[], frazil::registry::methods());
        read.map(|_| String::new()).unwrap_or_else(|problems| problems.to_string())
    };
    // Names of walls are free where walls are named, as under "flow".
    // One letter beside a key of the top is taken for that.
    let top = [
        "domain",
        "material",
        "materials",
        "walls",
        "flow",
        "time",
        "title",
        "source",
        "left",
        "right",
        "top",
        "bottom",
        "outer",
    ];
    for key in found.iter().filter(|key| !top.contains(&key.as_str())) {
        let said = refused(key);
        assert!(said.contains(&format!("{key}: unknown key here, it belongs to")), "{key}: {said}");
    }
    let expected =
        "s.toml:1: sped_m_per_s: unknown key, did you mean \"speed_m_per_s\" of \"cracks\"? Known here: \"units\"";
    assert!(refused("sped_m_per_s").starts_with(expected), "{}", refused("sped_m_per_s"));
}

/// What `check` says would make steps longer is something that the reader and the planner take.
#[test]
fn what_check_recommends_is_not_refused() {
    let mut recommended = 0;
    for bundled in frazil_cases::scenes::all().iter().chain(frazil_cases::scenes::extreme()) {
        let read = |overrides: &[(String, String)]| {
            Scene::read(bundled, bundled.name, "s.toml", overrides, frazil::registry::methods())
        };
        let scene = read(&[]).expect("a scene");
        for settings in &scene.methods {
            let particles = scene.domain.size() / settings.numerics.spacing.powi(scene.domain.dimension() as i32);
            if particles > 2e4 || scene.stream.is_some() {
                continue;
            }
            let reference = frazil::run::reference(&scene).expect("a reference");
            let Ok(plan) = frazil_simulation::plan::build(&scene, settings, reference.as_ref(), 1, 1) else { continue };
            for (words, key, value) in
                [("integrator = \"rkl2\"", "integrator", "rkl2"), ("step_fraction", "step_fraction", "1")]
            {
                if plan.summary.relaxed_by.iter().any(|line| line.starts_with(words)) {
                    let overrides = [(format!("method.{}.{key}", settings.method), value.to_owned())];
                    let changed =
                        read(&overrides).unwrap_or_else(|problems| unreachable!("{}: {problems}", bundled.name));
                    let changed_settings = changed.method(settings.method).expect("a method");
                    let planned = frazil_simulation::plan::build(&changed, changed_settings, reference.as_ref(), 1, 1);
                    assert!(planned.is_ok(), "{} under {}: {:?}", bundled.name, settings.method, planned.err());
                    recommended += 1;
                }
            }
        }
    }
    assert!(recommended > 50, "{recommended}");
}

#[test]
fn a_plan_names_no_number_that_is_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let still = ["--set", "flow.walls.left.pressure_Pa=0", "--set", "flow.walls.right.pressure_Pa=0"];
    let text = frazil_cases::scenes::find("thawing-inclusion").expect("a scene").text;
    let text = text.replace("kind = \"table\"", "kind = \"local\"").replace("table = \"thawing-inclusion\"\n", "");
    fs::write(folder.path().join("still.toml"), text).expect("written");
    let output = frazil(folder.path(), &[&["check", "still.toml", "--method", "pd"][..], &still].concat());
    let (out, err) = said(&output);
    assert_eq!((output.status.code(), err.as_str()), (Some(0), ""));
    assert!(out.contains("no advection, as no water flows"), "{out}");
    assert!(!out.contains("inf "), "{out}");
}

/// What does not fit into memory is refused before it is taken: with 2 GB, 7.7 million particles on a list.
#[cfg(target_os = "linux")]
#[test]
fn what_does_not_fit_into_memory_is_refused_in_words() {
    let command = "ulimit -v 2000000; exec \"$0\" check stefan-dpd-2 --method edpd --set method.edpd.spacing=0.0125";
    let bundled =
        frazil_cases::scenes::all().iter().find(|scene| scene.text.contains("section 4.1, diffusivity ratio 2."));
    let command = command.replace("stefan-dpd-2", bundled.expect("a scene").name);
    let output = Command::new("sh").args(["-c", &command, env!("CARGO_BIN_EXE_frazil")]).output().expect("a process");
    let err = said(&output).1;
    assert_eq!(output.status.code(), Some(2), "{err}");
    let expected = "a spacing of 0.0125 makes 7.7e6 particles, which with their list of neighbours need at least";
    assert!(err.contains(expected) && err.contains("set a spacing of at least 0.02"), "{err}");
}

/// Particles that move come to rest before a run by steps that do not follow the fastest phase of the scene, and a plan does not
/// wait for it.
#[test]
fn checking_a_moving_liquid_does_not_take_as_long_as_its_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    let fast = ["--set", "materials.water.frozen.conductivity=4e11"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_frazil"))
        .current_dir(folder.path())
        .args([&["check", "freezing-channel-088", "--method", "edpd"][..], &fast].concat())
        .stdout(Stdio::null())
        .spawn()
        .expect("a process");
    let began = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("a process") {
            break status;
        }
        if began.elapsed() > Duration::from_secs(120) {
            child.kill().and_then(|()| child.wait()).expect("ended");
            unreachable!("still at rest");
        }
        std::thread::sleep(Duration::from_millis(50));
    };
    assert_eq!(status.code(), Some(0));
}

const HEAD: &str = "title = \"t\"\nscene = \"frozen-wall-sand\"\nset = { \"method.local.spacing_m\" = 0.2 }\n";

#[test]
fn what_is_hardly_meant_is_told_before_anything_runs() {
    let warned = |text: &str| {
        let (code, _, err) = study(&format!("{HEAD}{text}"), &["--check"]);
        assert_eq!(code, Some(0), "{err}");
        err
    };
    assert_eq!(warned(""), "");
    let found = warned("design = { thickness_m = 2, mean_temperature_c = 8 }");
    let expected = "warning: design: mean_temperature_c: found 8, all frozen ground is colder: it freezes at 0";
    assert_eq!(found, expected);
    let found = warned("[[layouts]]\nname = \"a\"\nset = { \"materials.sand.freezing.latent_heat_J_per_kg\" = 52.9 }");
    let expected = "warning: materials.sand: its latent heat is 52.9000 J/kg, soils have 2e3 to 3.4e5: check its unit, J and not kJ?";
    assert_eq!(found, expected);
    let found = warned("[[layouts]]\nname = \"a\"\nset = { \"materials.sand.frozen.conductivity_W_per_m_K\" = 2560 }");
    assert!(found.starts_with("warning: materials.sand: its frozen conductivity is 2560.0000 W/mK"), "{found}");
    let strata = "[[strata]]\nname = \"a\"\nfrom_m = 0\nto_m = 80\n[[strata]]\nname = \"b\"\nfrom_m = 90\nto_m = 120";
    let expected = "warning: strata: \"a\" ends at 80 m and \"b\" begins at 90 m: the ground between them is not defined, and the load of the shaft excludes it";
    assert_eq!(warned(strata), expected);
    let found = warned("[[layouts]]\nname = \"a\"\nset = { \"domain.ring.outer_radius_m\" = 8 }");
    let expected =
        "warning: domain.ring.outer_radius_m: found 8, 3.0 m from the pipes, but the cooled zone extends about";
    assert!(found.starts_with(expected), "{found}");
}

#[test]
fn what_cannot_be_meant_is_an_error() {
    let refused = |text: &str| study(text, &["--check"]).2;
    let plain = "title = \"t\"\nscene = \"frozen-wall-sand\"\n";
    let borehole = "boreholes = [{ pipe = \"1.6\", inclination_deg = 0.05, azimuth_deg = 170, depth_m = 200 }]";
    let deviation = "[deviation]\ndepth_m = 200\npercent = 0.1\nmembers = 2\nseed = 1";
    let found = refused(&format!("{plain}[[layouts]]\nname = \"a\"\n{borehole}\n{deviation}"));
    let expected = "s.toml:6: deviation: beside known boreholes (pipes.1.moved_m): they do not deviate at random, use a study of their own (layout \"a\")";
    assert_eq!(found, expected);
    // A spacing at which there is no run at twice the spacing to tell the error from.
    let found = refused(&format!("{plain}[[layouts]]\nname = \"a\"\nset = {{ \"method.local.spacing_m\" = 0.6 }}"));
    let expected = "layout \"a\": method.local.spacing_m: found 0.6, must be at most 0.4018: pipes stand 1.2054 m apart, and with \
                    less than 3 spacings between them the error cannot be estimated";
    assert_eq!(found, expected);
}

#[test]
fn a_study_is_priced_as_a_whole() {
    let (code, out, err) = study(HEAD, &["--check", "--method", "all", "--threads", "1"]);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
    assert!(out.contains("  1 layout with local, pd, sph, edpd, each also at twice the spacing\n"), "{out}");
    for method in ["local", "pd", "sph", "edpd"] {
        assert!(out.contains(&format!(" on 1 thread with {method}\n")), "{method}: {out}");
    }
    assert!(out.contains("\ntotal         about ") && out.contains(" of 1 thread"), "{out}");
}
