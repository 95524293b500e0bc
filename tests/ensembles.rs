//! Ensembles of seeds from outside: members are single runs, and nothing but the request decides the tables.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

type Row = BTreeMap<String, String>;

/// Freezing in DPD units, shorter than the paper's.
const SHORT: [&str; 9] = [
    "stefan-dpd-1",
    "--method",
    "edpd",
    "--set",
    "time.duration=14",
    "--set",
    "time.profiles=[7, 14]",
    "--set",
    "watch.front_from=5",
];

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frazil"));
    command.arg("run").args(arguments).arg("--quiet").current_dir(folder);
    command
}

fn run(folder: &Path, arguments: &[&[&str]]) -> Output {
    command(folder, &arguments.concat()).output().expect("the program starts")
}

fn done(folder: &Path, arguments: &[&[&str]]) {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{output:?}");
}

/// Series of a folder by name.
fn tables(folder: &Path) -> BTreeMap<String, String> {
    let paths = fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").path());
    let tables = paths.filter(|path| path.extension().is_some_and(|ending| ending == "csv"));
    let name = |path: &Path| path.file_name().expect("a name").to_string_lossy().into_owned();
    tables.map(|path| (name(&path), fs::read_to_string(&path).expect("a table"))).collect()
}

fn rows(path: &Path) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(path).unwrap_or_else(|error| unreachable!("{}: {error}", path.display()));
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| unreachable!("{column} of {row:?}"))
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).expect("a record")).expect("JSON")
}

/// A record without what changes from day to day.
fn timeless(value: Value) -> Value {
    let daily = |key: &str| key.ends_with("wall_s") || key.ends_with("cpu_s") || key == "peak_memory_bytes";
    match value {
        Value::Object(map) => map
            .into_iter()
            .filter(|(key, _)| !daily(key) && key != "taken_over" && key != "threads" && key != "provenance")
            .map(|(key, value)| (key, timeless(value)))
            .collect(),
        Value::Array(values) => values.into_iter().map(timeless).collect(),
        other => other,
    }
}

#[test]
fn members_are_single_runs_and_their_mean_is_theirs() {
    let folder = tempfile::tempdir().expect("a folder");
    done(folder.path(), &[&SHORT, &["--seeds", "3", "--seed", "5", "--out", "all"]]);
    let all = folder.path().join("all");
    let mut errors = Vec::new();
    for seed in ["5", "6", "7"] {
        done(folder.path(), &[&SHORT, &["--seed", seed, "--threads", "1", "--out", seed]]);
        let (own, member) = (folder.path().join(seed), all.join(format!("seed-{seed}")));
        assert!(tables(&own) == tables(&member), "seed {seed}");
        let record = |folder: &Path| timeless(json(&folder.join("record.json")));
        assert_eq!(record(&own), record(&member));
        errors.push(record(&own)["errors"]["front_rms_rel"].as_f64().expect("an error"));
    }
    let single: Vec<Vec<Row>> = ["5", "6", "7"].map(|seed| rows(&folder.path().join(seed).join("front.csv"))).into();
    let means = rows(&all.join("front.csv"));
    assert_eq!(means.len(), single[0].len());
    for (k, row) in means.iter().enumerate() {
        let values: Vec<f64> = single.iter().map(|rows| number(&rows[k], "front_m")).collect();
        let mean = values.iter().sum::<f64>() / 3.0;
        let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 2.0).sqrt();
        assert_eq!(number(row, "front_m"), mean);
        assert!((number(row, "front_m_sd") - deviation).abs() <= 1e-14 * mean);
        // t of two degrees of freedom, as printed.
        let half = 4.303 * deviation / 3f64.sqrt();
        assert!((number(row, "front_m_interval") - half).abs() <= 2e-4 * half);
        assert_eq!((&row["time_s"], &row["front_ref_m"]), (&single[0][k]["time_s"], &single[0][k]["front_ref_m"]));
        assert_eq!(row["members"], "3");
    }
    let record = json(&all.join("ensemble.json"));
    assert_eq!(record["seeds"], serde_json::json!([5, 6, 7]));
    let front = &record["errors"]["front_rms_rel"];
    let mean = errors.iter().sum::<f64>() / 3.0;
    assert!((front["mean"].as_f64().expect("a mean") - mean).abs() < 1e-15);
    // The error of the mean, from its own table.
    let from = |row: &&Row| number(row, "time_s") >= 5.0;
    let squares: Vec<f64> = means
        .iter()
        .filter(from)
        .map(|row| (number(row, "front_m") / number(row, "front_ref_m") - 1.0).powi(2))
        .collect();
    let of_mean = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!((front["of_mean"].as_f64().expect("an error") - of_mean).abs() < 1e-12);
    // Bias and variance apart: the square of a member's error is the sum of both, over the points.
    let split = &record["curves"]["front"];
    let [run, bias, variance] =
        ["member_rms", "bias_squared", "variance"].map(|name| split[name].as_f64().expect("a number"));
    assert!((run * run - bias - variance).abs() < 1e-12, "{split}");
    for figure in ["front.svg", "profiles.svg", "budget.svg"] {
        assert!(all.join(figure).exists(), "{figure}");
    }
}

#[test]
fn an_ensemble_that_was_stopped_goes_on_and_leaves_the_same_tables() {
    let (whole, stopped) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let request: Vec<&str> = [&SHORT[..], &["--seeds", "8", "--out", "all", "--threads", "2"]].concat();
    done(whole.path(), &[&request]);
    let all = stopped.path().join("all");
    let finished = || (1..=8).filter(|seed| all.join(format!("seed-{seed}/record.json")).exists()).count();
    // Killed, and then interrupted, further on each time.
    for (enough, signal) in [(1, "-KILL"), (3, "-INT")] {
        let mut child = command(stopped.path(), &request).stderr(Stdio::piped()).spawn().expect("the program starts");
        let began = Instant::now();
        while finished() < enough && began.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(1));
        }
        let kill = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
        assert!(kill.success());
        assert!(!child.wait().expect("it ends").success());
        let output = child.wait_with_output().expect("it ended");
        let said = String::from_utf8(output.stderr).expect("text");
        let words =
            format!("interrupted: {} of 8 members are finished; the same command runs the others\n", finished());
        assert_eq!(said, if signal == "-INT" { words } else { String::new() });
        assert!((enough..8).contains(&finished()), "stopped too late");
        assert!(!all.join("ensemble.json").exists());
    }
    let kept = finished();
    // A record that was torn is none.
    let torn = (1..=8).map(|seed| all.join(format!("seed-{seed}/record.json"))).find(|path| path.exists());
    let torn = torn.expect("a record");
    let text = fs::read_to_string(&torn).expect("the record");
    fs::write(&torn, &text[..text.len() / 2]).expect("written");
    done(stopped.path(), &[&request]);
    let record = |folder: &Path| json(&folder.join("all/ensemble.json"));
    assert_eq!(record(stopped.path())["taken_over"], serde_json::json!(kept - 1));
    assert_eq!(record(whole.path())["taken_over"], serde_json::json!(0));
    assert_eq!(timeless(record(stopped.path())), timeless(record(whole.path())));
    assert!(tables(&all) == tables(&whole.path().join("all")), "the tables differ");
    // All is known now: nothing is run again, by any number of threads.
    let before: Vec<Value> = (1..=8).map(|seed| json(&all.join(format!("seed-{seed}/record.json")))).collect();
    done(stopped.path(), &[&SHORT, &["--seeds", "8", "--out", "all", "--threads", "1"]]);
    let after: Vec<Value> = (1..=8).map(|seed| json(&all.join(format!("seed-{seed}/record.json")))).collect();
    assert!(before == after, "a member was run again");
    assert!(tables(&all) == tables(&whole.path().join("all")), "the tables differ");
}

#[test]
fn threads_do_not_matter_and_other_requests_share_no_members() {
    let folders = ["1", "3"].map(|threads| {
        let folder = tempfile::tempdir().expect("a folder");
        done(folder.path(), &[&SHORT, &["--seeds", "3", "--out", "all", "--threads", threads]]);
        folder
    });
    let [one, three] = folders.each_ref().map(|folder| folder.path().join("all"));
    assert!(tables(&one) == tables(&three), "the tables differ");
    assert_eq!(timeless(json(&one.join("ensemble.json"))), timeless(json(&three.join("ensemble.json"))));
    // Later seeds find one of the members; another scene finds none.
    let taken_over = || json(&one.join("ensemble.json"))["taken_over"].clone();
    done(folders[0].path(), &[&SHORT, &["--seeds", "2", "--seed", "3", "--out", "all"]]);
    assert_eq!(taken_over(), serde_json::json!(1));
    done(folders[0].path(), &[&SHORT, &["--set", "time.outputs=20", "--seeds", "1", "--seed", "3", "--out", "all"]]);
    assert_eq!(taken_over(), serde_json::json!(0));
    let front = rows(&one.join("front.csv"));
    assert_eq!(front.len(), 20);
    // A mean of one has no interval.
    assert!(front.iter().all(|row| row["front_m_interval"].is_empty() && row["front_m_sd"].is_empty()));
    // A folder never speaks of two things: a single run takes back the ensemble's word, and the other way round.
    done(folders[0].path(), &[&SHORT, &["--out", "all", "--set", "watch.probes=[[6, 2]]"]]);
    assert!(one.join("record.json").exists() && !one.join("ensemble.json").exists());
    assert!(one.join("probes.csv").exists());
    done(folders[0].path(), &[&SHORT, &["--seeds", "2", "--seed", "3", "--out", "all"]]);
    assert!(!one.join("record.json").exists() && one.join("ensemble.json").exists());
    assert!(!one.join("probes.csv").exists(), "a series of the single run");
}

#[test]
fn moving_particles_and_uneven_ones_have_ensembles() {
    let folder = tempfile::tempdir().expect("a folder");
    let small = "stefan-dpd-1 --method edpd --set domain.rectangle.height=24 --set domain.rectangle.width=8 \
                 --set watch.profile_length=20 --set watch.front_from=0.5 --set time.duration=1 --set time.profiles=[1] \
                 --set time.outputs=5 --set method.edpd.motion=true --seeds 2 --out moving";
    done(folder.path(), &[&small.split_whitespace().collect::<Vec<_>>()]);
    let all = folder.path().join("moving");
    let [a, b] = [1, 2].map(|seed| rows(&all.join(format!("seed-{seed}/profiles.csv"))));
    let means = rows(&all.join("profiles.csv"));
    assert!(a.len() == b.len() && means.len() == a.len() && a.len() > 30);
    assert!(a.iter().zip(&b).any(|(a, b)| a["along_m"] != b["along_m"]), "nothing moves");
    for ((mean, a), b) in means.iter().zip(&a).zip(&b) {
        for place in ["y_m", "along_m"] {
            assert_eq!(number(mean, place), (number(a, place) + number(b, place)) / 2.0);
        }
        assert!(mean["x_m"].is_empty() && mean["mean_over"] == "x");
        assert_eq!(number(mean, "temperature_c"), (number(a, "temperature_c") + number(b, "temperature_c")) / 2.0);
        // The reference is taken at the mean place: between those of the members, for it rises with distance.
        let known = [a, b].map(|row| number(row, "temperature_ref_c"));
        let own = number(mean, "temperature_ref_c");
        assert!(known[0].min(known[1]) <= own && own <= known[0].max(known[1]), "{mean:?}");
    }
    let jittered = "stefan-water --method pd --set method.pd.layout=jittered --set method.pd.jitter_fraction=0.2 \
                    --set time.duration_h=1 --set time.profiles_h=[1] --seeds 3 --out jittered";
    done(folder.path(), &[&jittered.split_whitespace().collect::<Vec<_>>()]);
    let record = json(&folder.path().join("jittered/ensemble.json"));
    assert!(record["errors"]["front_rms_rel"]["sd"].as_f64().is_some_and(|sd| sd > 0.0));
}

#[test]
fn what_has_no_chance_is_refused_and_writes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let same = |method: &str| {
        format!(
            "--seeds 3: the method \"{method}\" has no noise with these settings and its particles are on a lattice, so \
             all members would be equal; use layout = \"jittered\" or \"random\"\n"
        )
    };
    for (arguments, message) in [
        ("stefan-water --method pd --seeds 3", same("pd")),
        ("stefan-water --method edpd --set method.edpd.noise=false --seeds 3", same("edpd")),
        (
            "stefan-water --method edpd --seeds 3 --seed 18446744073709551614",
            "--seed 18446744073709551614: 3 seeds go beyond 18446744073709551615\n".into(),
        ),
    ] {
        let output = run(folder.path(), &[&arguments.split(' ').collect::<Vec<_>>()]);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert_eq!(String::from_utf8(output.stderr).expect("text"), message);
    }
    for flag in ["--reduce", "--fields", "--frames"] {
        let output = run(folder.path(), &[&SHORT, &["--seeds", "2", flag]]);
        assert_eq!(output.status.code(), Some(2), "{flag}");
    }
    assert_eq!(run(folder.path(), &[&SHORT, &["--seeds", "0"]]).status.code(), Some(2));
    // Refused by the plan of a member: the step is too long.
    let output = run(folder.path(), &[&SHORT, &["--seeds", "2", "--set", "method.edpd.step=1e9"]]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(!output.stderr.is_empty());
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 0);
}

/// A series that no line of an ensemble names has its mean and its figure by its columns.
#[test]
fn any_series_of_the_members_has_a_mean() {
    let folder = tempfile::tempdir().expect("a folder");
    let request: Vec<&str> =
        [&SHORT[..], &["--set", "time.duration=1", "--set", "time.profiles=[1]", "--set"]].concat();
    let request: Vec<&str> = [&request[..], &["watch.front_from=0.1", "--seeds", "2", "--out", "all"]].concat();
    done(folder.path(), &[&request]);
    let all = folder.path().join("all");
    for (seed, speed) in [(1, 1.0), (2, 2.0)] {
        let write = |name: &str, text: String| {
            fs::write(all.join(format!("seed-{seed}")).join(name), text).expect("written");
        };
        write("stream.csv", format!("y_m,speed_m_per_s,density_rel\n0.5,{speed:?},0.5\n1.5,{speed:?},1.5\n"));
        let rows =
            [(0.0, 0.5), (0.0, 1.5), (6.0, 0.5), (6.0, 1.5)].map(|(x, y)| format!("{x:?},{y:?},{speed:?},{x:?}\n"));
        write("sections.csv", format!("x_m,y_m,temperature_c,temperature_ref_c\n{}", rows.concat()));
        write("shares.csv", format!("time_s,liquid,solid\n0.5,{speed:?},0.25\n1.0,{speed:?},0.75\n"));
    }
    done(folder.path(), &[&request]);
    assert_eq!(json(&all.join("ensemble.json"))["taken_over"], serde_json::json!(2));
    let stream = rows(&all.join("stream.csv"));
    assert_eq!(stream.iter().map(|row| row["y_m"].as_str()).collect::<Vec<_>>(), ["0.5", "1.5"]);
    for row in &stream {
        assert_eq!((row["speed_m_per_s"].as_str(), row["density_rel_interval"].as_str()), ("1.5", "0.0"));
        // Half of one apart: t of one degree of freedom times half.
        assert!((number(row, "speed_m_per_s_interval") - 12.706 * 0.5).abs() < 1e-3);
    }
    let sections = rows(&all.join("sections.csv"));
    let places: Vec<(f64, f64)> = sections.iter().map(|row| (number(row, "x_m"), number(row, "y_m"))).collect();
    assert_eq!(places, [(0.0, 0.5), (0.0, 1.5), (6.0, 0.5), (6.0, 1.5)]);
    assert!(sections.iter().all(|row| row["temperature_c"] == "1.5" && row["temperature_ref_c"] == row["x_m"]));
    assert_eq!(rows(&all.join("shares.csv"))[1]["solid"], "0.75");
    for figure in ["stream", "sections", "shares"] {
        assert!(all.join(format!("{figure}.svg")).exists(), "{figure}");
    }
}
