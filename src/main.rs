//! Exit code only: 0 done, 1 a check failed, 2 bad input or a broken run.

mod allocator;

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: allocator::OrEnd = allocator::OrEnd;

fn main() -> ExitCode {
    ExitCode::from(frazil::cli::main(std::env::args_os()))
}
