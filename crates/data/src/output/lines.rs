//! Lines on stdout and stderr. Either may be closed or full, which ends no work: `println!` would panic.

use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::sync::OnceLock;

use crate::error::escaped;

/// Why stdout did not take what was written to it.
static LOST: OnceLock<String> = OnceLock::new();

/// Writes a line to stdout.
pub fn print_line(line: impl Display) {
    print_text(format_args!("{line}\n"));
}

/// Writes to stdout as it is.
pub fn print_text(text: impl Display) {
    remember(write!(std::io::stdout(), "{text}"));
}

/// Takes note of what became of something that was written to stdout elsewhere.
pub fn note_printed(outcome: std::io::Result<()>) {
    remember(outcome);
}

/// Writes a line to stderr, where somebody may read it, whatever names files gave to things.
pub fn note_line(line: impl Display) {
    // There is no other place to tell it.
    let _ = writeln!(std::io::stderr(), "{}", escaped(&line.to_string()));
}

/// What stdout did not take, as a sentence. A reader that has seen enough and left is no loss.
pub fn lost_stdout() -> Option<String> {
    remember(std::io::stdout().flush());
    LOST.get().map(|reason| format!("stdout did not take all that was written to it ({reason})"))
}

fn remember(outcome: std::io::Result<()>) {
    if let Err(error) = outcome
        && error.kind() != ErrorKind::BrokenPipe
    {
        LOST.get_or_init(|| error.to_string());
    }
}
