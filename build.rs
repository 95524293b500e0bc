#![allow(clippy::print_stdout)] // how a build script speaks to cargo

//! Takes down the commit that the program is built from, for records.

use std::path::Path;
use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

fn main() {
    // Whatever changes a source changes whether it is that of a commit.
    for watched in ["Cargo.toml", "Cargo.lock", "src", "methods", "cases", "plots"] {
        println!("cargo::rerun-if-changed={watched}");
    }
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]).filter(|log| Path::new(log).exists()) {
        println!("cargo::rerun-if-changed={log}");
    }
    // A copy of the sources within another repository is of no commit of that.
    let own = git(&["rev-parse", "--show-prefix"]).is_some_and(|prefix| prefix.is_empty());
    let commit = git(&["describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]).filter(|_| own);
    println!("cargo::rustc-env=FRAZIL_COMMIT={}", commit.unwrap_or_default());
}
