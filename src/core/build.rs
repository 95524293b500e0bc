#![allow(clippy::print_stdout)] // how a build script speaks to cargo

//! Takes down the compiler and the flags of the package whose speed counts.

use std::process::Command;

fn main() {
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let version =
        Command::new(compiler).arg("--version").output().ok().and_then(|out| String::from_utf8(out.stdout).ok());
    println!("cargo::rustc-env=FRAZIL_RUSTC={}", version.as_deref().unwrap_or("unknown").trim());
    let flags = std::env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default().replace('\u{1f}', " ");
    println!("cargo::rustc-env=FRAZIL_RUSTFLAGS={flags}");
    println!("cargo::rustc-env=FRAZIL_OPT_LEVEL={}", std::env::var("OPT_LEVEL").unwrap_or_default());
    println!("cargo::rerun-if-changed=build.rs");
}
