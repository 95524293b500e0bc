//! The calibration of eDPD fluids, through the built program: what the paper prints, both formats of files, bad ones.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use frazil_edpd::calibration::Constants;
use frazil_edpd::fluid::{Exponent, Parameters};
use frazil_scene::{Range, Scene, Units, read_section};

/// Runs `frazil calibrate` in a folder, with results in `out`.
fn calibrate(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_frazil");
    let arguments = ["calibrate", "--out", "out"].iter().chain(arguments);
    Command::new(program).args(arguments).current_dir(folder).output().expect("the program starts")
}

/// What it prints, and the rows of its table.
fn table(arguments: &[&str]) -> (String, Columns) {
    let folder = tempfile::tempdir().expect("a folder");
    table_in(folder.path(), arguments)
}

fn table_in(folder: &Path, arguments: &[&str]) -> (String, Columns) {
    let output = calibrate(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = String::from_utf8(output.stdout).expect("text");
    (text, Columns::read(&fs::read_to_string(folder.join("out/calibration.csv")).expect("the table")))
}

/// Numbers by the names of their columns; absent ones are not numbers.
#[derive(Debug, Clone, PartialEq)]
struct Columns {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Columns {
    fn read(text: &str) -> Self {
        let mut lines =
            text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').map(str::to_owned));
        let names = lines.next().expect("names").collect();
        Columns { names, rows: lines.map(Iterator::collect).collect() }
    }

    fn of(&self, name: &str) -> Vec<f64> {
        let index = self.names.iter().position(|own| own == name).expect("the column");
        self.rows.iter().map(|row| row[index].parse().unwrap_or(f64::NAN)).collect()
    }
}

fn printed() -> Columns {
    Columns::read(include_str!("../cases/tables/ng-exponents.csv"))
}

/// Ng et al. 2017, table 1: the four printed places of all 34 rows to within one unit, as the last row is off by 0.74 of one.
#[test]
fn the_table_of_the_paper_is_reproduced() {
    let (_, own) = table(&[]);
    let printed = printed();
    assert_eq!(own.rows.len(), 34);
    assert_eq!(own.of("temperature_k"), printed.of("temperature_k"));
    assert_eq!(own.of("schmidt"), printed.of("schmidt"));
    for (k, (s, expected)) in own.of("exponent").iter().zip(printed.of("exponent")).enumerate() {
        assert!((s - expected).abs() < 1e-4, "row {k}: {s} {expected}");
    }
    // The quadratic, to the rounding of its printed coefficients (5e-5 T^2 + 5e-4 T + 5e-4) and values.
    for (k, (s, expected)) in own.of("exponent_quadratic").iter().zip(printed.of("fit")).enumerate() {
        assert!((s - expected).abs() < 1.3e-3, "row {k}: {s} {expected}");
    }
}

/// The printed quadratic makes a Schmidt number that is 6 % too high at the freezing point; the cubic for the shorter
/// cut-off is good there.
#[test]
fn fits_miss_schmidt_numbers() {
    let printed = printed();
    let fluid = Constants::paper();
    let off = |k: usize| {
        let temperature = printed.of("temperature_k")[k] / 300.0;
        let fit = (-6.3039 * temperature + 19.594) * temperature - 12.032;
        fluid.schmidt(fit, temperature) / printed.of("schmidt")[k] - 1.0
    };
    let worst = (0..34).max_by(|a, b| off(*a).abs().total_cmp(&off(*b).abs())).expect("rows");
    assert_eq!(printed.of("temperature_k")[worst], 273.15);
    assert!((off(worst) - 0.063).abs() < 5e-4, "{}", off(worst));

    let (text, own) = table(&["--gamma", "4.5", "--cutoff", "1.76", "--from-k", "273.15"]);
    for (s, temperature) in own.of("exponent").iter().zip(own.of("temperature")) {
        let cubic = ((2.5548 * temperature - 11.443) * temperature + 20.016) * temperature - 10.665;
        // Its coefficients as printed are good to 5e-5 T^3 + 5e-4 (T^2 + T + 1), 2e-3; found 1.4e-3.
        assert!((s - cubic).abs() < 1.45e-3, "{temperature}: {s} {cubic}");
    }
    let fits: Vec<_> = text.lines().filter(|line| line.contains("; R2 = ")).collect();
    assert_eq!(fits.len(), 2, "{text}");
}

#[test]
fn critical_cutoffs_are_printed() {
    for (arguments, expected) in [
        (&["--gamma", "4.5", "--cutoff", "2.37"][..], "2.3648"),
        (&[], "1.9521"),
        (&["--gamma", "4.5", "--cutoff", "1.76", "--from-k", "273.15"], "1.7579"),
    ] {
        let (text, _) = table(arguments);
        assert!(text.contains(&format!("critical      cut-off {expected} of friction")), "{text}");
    }
}

/// Just above its critical cut-off a fluid can be had, and just below not.
#[test]
fn the_critical_cutoff_is_the_least() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(calibrate(folder.path(), &["--cutoff", "1.9521"]).status.code(), Some(0));
    let refused = calibrate(folder.path(), &["--cutoff", "1.9520"]);
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2));
    assert!(message.starts_with("water.toml:13: rows.1.schmidt: found a Schmidt number of 10355.66, must be at most "));
    assert!(message.ends_with("a cut-off of 1.9521 would do\n") && message.lines().count() == 1, "{message}");
}

#[test]
fn all_that_is_written_belongs_together() {
    for dimension in [2, 3] {
        let radii = ["--dissipative-cutoff", "2.1", "--thermal-cutoff", "1.4", "--conservative-cutoff", "1"];
        let (_, own) = table(&[&["--dimension", &dimension.to_string()][..], &radii].concat());
        let fluid = Constants {
            dimension,
            dissipative_cutoff: 2.1,
            thermal_cutoff: 1.4,
            conservative_cutoff: 1.0,
            ..Constants::paper()
        };
        let columns = ["temperature", "schmidt", "exponent", "diffusivity", "viscosity", "friction_rate"];
        let [temperature, schmidt, exponent, diffusivity, viscosity, rate] = columns.map(|name| own.of(name));
        for k in 0..own.rows.len() {
            // Rounding of the numbers and of the table.
            let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{dimension}D, row {k}: {a} {b}");
            close(fluid.schmidt(exponent[k], temperature[k]), schmidt[k]);
            close(viscosity[k] / diffusivity[k], schmidt[k]);
            close(temperature[k] / diffusivity[k], rate[k]);
        }
        let columns = ["prandtl", "thermal_diffusivity", "heat_friction"];
        let [prandtl, thermal, friction] = columns.map(|name| own.of(name));
        // The conductivity of water is known from the freezing point on.
        let known: Vec<usize> = (0..own.rows.len()).filter(|k| prandtl[*k].is_finite()).collect();
        assert_eq!(known, (20..34).collect::<Vec<_>>());
        for k in known {
            assert!((prandtl[k] * thermal[k] / viscosity[k] - 1.0).abs() < 1e-12);
            assert!((fluid.thermal_diffusivity(friction[k]) / thermal[k] - 1.0).abs() < 1e-12);
        }
    }
    let (_, own) = table(&["--prandtl", "7"]);
    assert!(own.of("prandtl").iter().all(|prandtl| (prandtl / 7.0 - 1.0).abs() < 1e-14));
    let (_, own) = table(&["--diffusivity", "1.1"]);
    assert!(own.of("thermal_diffusivity").iter().all(|diffusivity| *diffusivity == 1.1));
    // Five digits, as in section 4.1.
    assert!(own.of("heat_friction").iter().all(|friction| (friction - 7.1177e-6).abs() < 5e-11));
}

/// Particles that move have the friction and the diffusivity that they are calibrated to.
#[test]
fn fluids_that_move_agree() {
    for dimension in [2, 3] {
        let constants = Constants { dimension, dissipative_cutoff: 1.7, thermal_cutoff: 1.3, ..Constants::paper() };
        let parameters = Parameters {
            exponent: Exponent::Table(vec![(0.9, 0.5), (1.1, 1.5)]),
            dissipative_cutoff: 1.7,
            thermal_cutoff: 1.3,
            heat_friction: constants.heat_friction(1.1),
            ..Parameters::water()
        };
        // Rounding.
        let own = parameters.constants(dimension);
        assert!((own.thermal_diffusivity(parameters.heat_friction) / 1.1 - 1.0).abs() < 1e-14);
        let rate = constants.friction_rate(0.75);
        assert!((own.friction_rate(parameters.exponent.at(0.95)) / rate - 1.0).abs() < 1e-14);
    }
}

/// The same fluid as TOML, as CSV, and as diffusivities in place of their ratios.
#[test]
fn a_fluid_may_be_given_in_several_ways() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    write("a.csv", "# comment\ntemperature_k,schmidt,prandtl\n280,1000,\n300.5,500,4\n\n320,125,2\n");
    write(
        "b.csv",
        "\u{feff}\"temperature_c\" , kinematic_viscosity_m2_per_s,self_diffusivity_m2_per_s,thermal_diffusivity_m2_per_s\n\
         6.85,1e-6,1e-9,\n27.35,1e-6,2e-9,2.5e-7\n46.85,1e-6,8e-9,5e-7\n",
    );
    write(
        "c.toml",
        "title = \"Wine\"\nsource = \"none\"\n[[rows]]\ntemperature_k = 280\nschmidt = 1000\n[[rows]]\n\
         temperature_c = 27.35\nschmidt = 500\nprandtl = 4\n[[rows]]\ntemperature_k = 320\nschmidt = 125\nprandtl = 2\n",
    );
    let (text, first) = table_in(folder.path(), &["a.csv"]);
    assert!(text.contains("units         unknown, as density and heat capacity of the fluid are"), "{text}");
    assert!(text.contains("quadratic") && !text.contains("cubic"), "{text}");
    let columns = ["temperature_k", "schmidt", "exponent", "prandtl", "heat_friction"];
    for other in ["b.csv", "c.toml"] {
        let (_, own) = table_in(folder.path(), &[other]);
        for name in columns {
            for (a, b) in own.of(name).iter().zip(first.of(name)) {
                // Quotients of rounded numbers.
                assert!((a / b - 1.0).abs() < 1e-13 || a.is_nan() && b.is_nan(), "{other}, {name}: {a} {b}");
            }
        }
    }
    // A single row has no fits, and still a figure.
    write("d.csv", "temperature_k,schmidt\n300,400\n");
    let (text, own) = table_in(folder.path(), &["d.csv"]);
    assert!(!text.contains("R2") && own.rows.len() == 1);
    for name in ["calibration.svg", "calibration.png", "calibration.toml"] {
        assert!(folder.path().join("out").join(name).exists());
    }
}

/// Fits of numbers that no smooth curve follows are no failure, however bad they are.
#[test]
fn bad_fits_are_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = "temperature_k,schmidt\n250,0.5001\n300,6000\n310,6000\n320,6000\n350,6000\n400,6000\n";
    fs::write(folder.path().join("jumps.csv"), rows).expect("written");
    let (text, own) = table_in(folder.path(), &["jumps.csv"]);
    assert!(
        text.contains("infinite of Sc") && text.contains("; negative at") && !text.to_lowercase().contains("nan"),
        "{text}"
    );
    assert!(own.of("exponent").iter().all(|exponent| *exponent >= 0.0));
}

#[test]
fn a_scene_takes_the_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    calibrate(folder.path(), &[]);
    let keys = fs::read_to_string(folder.path().join("out/calibration.toml")).expect("the keys");
    let (material, fluid) = keys.split_once("\n# Particles that move").expect("two parts");
    let scene = frazil_cases::scenes::find("stefan-dpd-4").expect("bundled").text;
    let (before, rest) = scene.split_once("[materials.water]").expect("a material");
    let (_, after) = rest.split_once("\n[").expect("a section after it");
    let text = format!("{before}{material}\n[{after}");
    let scene = Scene::read(&text, "calibrated", "calibrated.toml", &[], frazil::registry::methods());
    let scene = scene.unwrap_or_else(|problems| unreachable!("{problems}"));
    let water = &scene.materials[0];
    // To the places that are written.
    assert_eq!((water.latent_heat, water.freezing_point), (26634.77, 0.9105));
    assert_eq!((water.density, water.unfrozen.heat_capacity), (4.0, 1e5));
    assert!((water.frozen.conductivity / water.unfrozen.conductivity - 4.08).abs() < 1e-6);

    let fluid = fluid.split_once('\n').expect("a comment").1;
    let read = read_section(fluid, "fluid.toml", Units::Dpd, |root| {
        let mut section = root.section("fluid")?;
        let numbers = [
            "density",
            "repulsion",
            "friction",
            "conservative_cutoff",
            "dissipative_cutoff",
            "thermal_cutoff",
            "heat_capacity",
        ];
        let numbers = numbers.map(|key| section.number(key, Range::POSITIVE));
        let heat = section.number("heat_friction", Range::POSITIVE);
        Ok((numbers, heat?, section.points("exponent", Some(2))?))
    });
    let (numbers, heat, exponents) = read.unwrap_or_else(|problems| unreachable!("{problems}"));
    assert_eq!(numbers, [4.0, 18.75, 8.0, 1.96, 1.96, 1.96, 1e5].map(Ok));
    assert_eq!(exponents.len(), 34);
    // Between the rows at 298.15 and 303.15 K.
    assert!(heat > 7.4676e-6 && heat < 7.5036e-6, "{heat}");
}

/// Every bad fluid of `cases/bad-fluids` is refused with the messages on its lines `#^ `, and nothing is written.
#[test]
fn bad_fluids_are_refused_with_their_messages() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/bad-fluids");
    let folder = tempfile::tempdir().expect("a folder");
    let mut paths: Vec<_> =
        fs::read_dir(&source).expect("the folder").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    assert!(paths.len() >= 10, "{paths:?}");
    for path in paths {
        let file = path.file_name().and_then(|name| name.to_str()).expect("a name");
        fs::copy(&path, folder.path().join(file)).expect("copied");
        let text = fs::read_to_string(&path).expect("the text");
        let expected: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("#^ ")).collect();
        let output = calibrate(folder.path(), &[file]);
        assert_eq!(output.status.code(), Some(2), "{file}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), format!("{}\n", expected.join("\n")), "{file}");
        assert!(output.stdout.is_empty() && !folder.path().join("out").exists(), "{file}");
    }
}

/// The message about an unknown column names them all, and so does the guide.
#[test]
fn every_column_is_in_the_guide() {
    let text = include_str!("../cases/bad-fluids/columns.csv");
    let guide = crate::documents::guide();
    let (_, known) = text.split_once("known are ").expect("the message");
    let known: Vec<&str> = known.lines().next().unwrap_or_default().split(", ").collect();
    assert_eq!(known.len(), 7, "{known:?}");
    let (_, own) = table(&[]);
    let written = own.names.iter().map(String::as_str);
    for column in known.into_iter().chain(written) {
        assert!(guide.contains(&format!("`{column}`")), "{column}");
    }
}
