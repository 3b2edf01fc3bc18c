//! The program `slump`: see [`slump::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    // SAFETY: no other thread has been started yet.
    unsafe { slump::render::quieten_drivers() };
    slump::cli::main()
}
