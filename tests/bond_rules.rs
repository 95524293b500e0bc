//! What a bond conducts through which water soaks into nearly dry ground: by the potential, or by a mean of conductivities.

use frazil::registry::methods;
use frazil_core::physics::curve::Curve;
use frazil_core::physics::retention::scale::head;
use frazil_core::space::domain::Domain;
use frazil_record::{Outcome, Value};
use frazil_scene::Scene;

use crate::sketch::{Sketch, through};

/// The soil of Yan et al. 2020, table 1.
const SOIL: &str = "{ retention = { law = \"van-genuchten\", alpha_per_m = 1, n = 1.53 }, \
     residual_water_content = 0.186, saturated_water_content = 0.363, conductivity_m_per_s = 1e-9 }";

/// A column that is wetted from one end for 15 days, at bonds of three spacings of 0.05 cm.
fn column(rule: &str, head_m: f64) -> Sketch {
    let mut sketch = Sketch::new(Domain::Line { length: 0.1 }, 5e-4).wall("left", "saturation = 1");
    sketch = sketch.with(rule).with("tolerance = 1e-5");
    (sketch.of_water, sketch.initial_c, sketch.duration_s) = (true, head_m, 15.0 * 86_400.0);
    sketch.materials = vec![("soil", SOIL.into())];
    sketch
}

/// Head (m) at which the soil has a saturation.
fn head_at(saturation: f64) -> f64 {
    let kind = methods().iter().find(|kind| kind.name == "pd").expect("the method");
    let scene = column("", -1.0).scene(kind);
    let curve = Curve::new(&scene.materials[0]);
    head(curve.moisture().expect("a soil").soil().place_of(saturation))
}

/// Water taken up against exchange by the potential, with the same layers of one value at the wall. Independent finite
/// differences on the same bonds gave +1.2 to +1.4 % under arithmetic means, +4.7 to +5.0 % upstream and -99.6 % under harmonic
/// means. Under geometric means they gave -2.2 and -6.0 %, by steps that pass over the first wetting: here a tolerance ten times
/// as tight changes the figures by less than 0.2 %.
#[test]
fn bonds_by_means_take_up_what_independent_bonds_do() {
    let kind = methods().iter().find(|kind| kind.name == "pd").expect("the method");
    for (saturation, geometric) in [(0.01, -4.0), (0.001, -11.5)] {
        let start = head_at(saturation);
        let taken = |rule: &str| {
            let result = column(rule, start).run(kind);
            assert_eq!(result.record.outcome, Outcome::Ok, "{rule}: {:?}", result.record.cause);
            assert!(result.record.energy_balance_rel.abs() < 1e-9, "{rule}: {:e}", result.record.energy_balance_rel);
            through(&result, "left")[0]
        };
        let by_potential = taken("wall_model = \"naive\"");
        let expected = [
            ("arithmetic", 1.2..1.5),
            ("upstream", 4.7..5.2),
            ("harmonic", -100.1..-99.0),
            ("geometric", geometric - 0.3..geometric + 0.3),
        ];
        for (mean, range) in expected {
            let found = 100.0 * (taken(&format!("mean = \"{mean}\"")) / by_potential - 1.0);
            eprintln!("{mean} from a saturation of {saturation}: {found:+.2} %");
            assert!(range.contains(&found), "{mean} from {saturation}: {found:+.2} %, not in {range:?}");
        }
    }
}

/// The paper's setting is the arithmetic mean, and dry ground has no head for any mean.
#[test]
fn dry_ground_has_no_mean() {
    let pd = methods().iter().find(|kind| kind.name == "pd").expect("the method");
    let printed = column("setting = \"paper\"", -10.0).scene(pd);
    let values = printed.methods[0].values();
    for (key, word) in [("mean", "arithmetic"), ("wall_model", "naive")] {
        assert_eq!(values.get(key), Some(&Value::Text(word.into())), "{key}");
    }
    let dry = column("mean = \"upstream\"", -1.0).text(pd.name).replace("head_m = -1", "saturation = 0");
    let problems = Scene::read(&dry, "dry", "dry.toml", &[], &[pd]).expect_err("a problem").to_string();
    assert!(problems.contains("dry ground has no head"), "{problems}");
}
