//! The command line: see [`slump::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    slump::cli::main()
}
