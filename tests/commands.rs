//! Commands of `tests/baseline.csv`, and what tests and `benches/killer.rs` do with them.

use std::path::Path;
use std::sync::Arc;

use frazil_scene::Scene;
use frazil_simulation::reference::Reference;
use rand::RngExt;
use rand::rngs::StdRng;

/// All commands of the baseline.
pub fn all() -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/baseline.csv");
    let rows = csv::Reader::from_path(path).expect("the baseline").into_records();
    rows.map(|row| row.expect("a row")[0].to_owned()).collect()
}

/// One run of one scene.
pub struct Single {
    pub scene: Scene,
    pub method: String,
    /// What the scene is measured against, and what walls that follow an exact solution ask.
    pub reference: Option<Arc<dyn Reference>>,
}

/// What a command runs; none of what is no single run of a scene.
///
/// # Panics
/// On a scene that cannot be read.
pub fn single(command: &str) -> Option<Single> {
    let mut words = command.strip_prefix("run ")?.split_whitespace();
    let (name, mut method, mut overrides) = (words.next()?, None, Vec::new());
    while let Some(word) = words.next() {
        match word {
            "--method" => method = words.next(),
            "--set" => {
                let (key, value) = words.next()?.split_once('=')?;
                overrides.push((key.to_owned(), value.to_owned()));
            }
            _ => return None,
        }
    }
    let scene = frazil::load::scene(name, &overrides).expect("a scene");
    let reference = frazil_cases::truth(&scene).ok().and_then(|truth| truth.reference.map(Arc::from));
    Some(Single { scene, method: method?.to_owned(), reference })
}

/// Bytes of which one is flipped, the end is cut, two are swapped, some are there twice, or some are lost, by the number.
pub fn damaged(bytes: &[u8], number: usize, random: &mut StdRng) -> Vec<u8> {
    let mut other = bytes.to_vec();
    let (one, two) = (random.random_range(0..bytes.len()), random.random_range(0..bytes.len()));
    match number % 5 {
        0 => other[one] ^= 1 << random.random_range(0..8),
        1 => other.truncate(one),
        2 => other.swap(one, two),
        3 => other.extend_from_slice(&bytes[one..]),
        _ => other[one.min(two)..one.max(two)].fill(random.random()),
    }
    other
}
