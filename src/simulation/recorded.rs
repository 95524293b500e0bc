//! Rows of tables among the fields that a run goes on from.

use frazil_core::saved::{Pass, Saved};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A value that records hold too, and that therefore knows how it is written.
pub(crate) struct Recorded<'a, T>(pub(crate) &'a mut T);

impl<T: Serialize + DeserializeOwned> Saved for Recorded<'_, T> {
    fn pass(&mut self, pass: &mut Pass<'_>) {
        if pass.loads() {
            let mut bytes: Vec<u8> = Vec::new();
            bytes.pass(pass);
            match rmp_serde::from_slice(&bytes) {
                Ok(value) => *self.0 = value,
                Err(_) => pass.refuse(),
            }
        } else {
            // Rows are numbers and names, all of which can be written; what could not would be refused when it is read.
            rmp_serde::to_vec_named(self.0).unwrap_or_default().pass(pass);
        }
    }
}
