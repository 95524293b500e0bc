//! Exit code only: 0 done, 1 a check failed, 2 bad input or a broken run.

use std::process::ExitCode;

fn main() -> ExitCode {
    frazil::cli::main(std::env::args_os())
}
