//! `frazil schema`.

use frazil_studies::failure::{self, Failure, Verdict};

use crate::registry;

/// Prints the schema of scene files.
pub fn answer() -> Result<Verdict, Failure> {
    let schema = frazil_scene::schema(registry::methods());
    failure::answer(&format!("{schema:#}\n"))?;
    Ok(Verdict::Done)
}
