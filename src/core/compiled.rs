//! How this package was compiled, which decides the speed of runs.

/// The compiler and its version.
pub const COMPILER: &str = env!("FRAZIL_RUSTC");

/// Flags beyond those of the profile; empty if there are none.
pub const FLAGS: &str = env!("FRAZIL_RUSTFLAGS");

/// Optimisation level, and whether debug assertions are on.
pub fn optimisation() -> String {
    let checks = if cfg!(debug_assertions) { ", with debug assertions" } else { "" };
    format!("optimisation level {}{checks}", env!("FRAZIL_OPT_LEVEL"))
}
