//! Writes messages and progress of long work to streams that may be closed or full, and receives signals that ask the
//! work to end.

use std::fmt::Display;
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI32, Ordering};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

use crate::error::escaped;

/// Message of the first failed write to stdout; empty if no write has failed.
static LOST: OnceLock<String> = OnceLock::new();

/// Writes a line to stdout, with control characters escaped.
pub fn print_line(line: impl Display) {
    print_text(format_args!("{}\n", escaped(&line.to_string())));
}

/// Writes text to stdout unchanged.
pub fn print_text(text: impl Display) {
    remember(write!(std::io::stdout(), "{text}"));
}

/// Records the outcome of a write to stdout that was not made by this module. [`lost_stdout`] then reports a failure of
/// this write.
pub fn note_printed(outcome: std::io::Result<()>) {
    remember(outcome);
}

/// Writes a line to stderr, with control characters escaped.
pub fn note_line(line: impl Display) {
    // A failure to write to stderr cannot be reported anywhere.
    let _ = writeln!(std::io::stderr(), "{}", escaped(&line.to_string()));
}

/// Returns a sentence about the first failed write to stdout; `None` if no write has failed. It is not a failure if the
/// reader of the stream closed it early.
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

/// Returns a number with its noun in singular or plural, such as "1 frame" or "2 frames".
pub fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A progress bar on stderr.
#[derive(Clone, Debug)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Shows the progress of work that has `length` units, for example steps. `what` is written in front of the bar.
    pub fn new(what: &str, length: u64) -> Self {
        let bar = if std::io::stderr().is_terminal() {
            let template = "{prefix} {wide_bar} {percent:>3} %  {left}";
            let style = ProgressStyle::with_template(template)
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .with_key("left", |state: &ProgressState, out: &mut dyn std::fmt::Write| {
                    // A failure to write to a terminal is no reason to stop the work.
                    let _ = out.write_str(&left(state.pos(), state.eta()));
                });
            let bar = ProgressBar::new(length).with_style(style).with_prefix(escaped(what));
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        } else {
            ProgressBar::hidden()
        };
        Self { bar }
    }

    /// Adds completed units to the progress.
    pub fn advance(&self, units: u64) {
        self.bar.inc(units);
    }

    /// Sets the number of completed units.
    pub fn set(&self, units: u64) {
        self.bar.set_position(units);
    }

    /// True if a terminal shows the bar.
    pub fn is_drawn(&self) -> bool {
        !self.bar.is_hidden()
    }

    /// Writes a line above the bar.
    pub fn say(&self, line: &str) {
        self.bar.suspend(|| note_line(line));
    }

    /// Ends the display of progress and removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Returns the estimated remaining time in words; empty if no unit is completed yet.
fn left(done: u64, estimate: Duration) -> String {
    match done {
        0 => String::new(),
        _ if estimate < Duration::from_secs(1) => "less than a second left".into(),
        _ => format!("{} left", HumanDuration(estimate)),
    }
}

/// Number of steps above which a warning is written before a run begins. Even with the smallest scene, so many steps
/// take minutes.
const MANY_STEPS: u64 = 100_000_000;

/// Warns on stderr if a very large number of steps was requested.
pub fn warn_of_steps(steps: u64) {
    if steps > MANY_STEPS {
        note_line(format_args!("slump: this asks for {steps} steps, which take long"));
    }
}

/// Number of the first signal, such as INT, that asked the program to end; 0 if no such signal has arrived.
static CAUGHT: AtomicI32 = AtomicI32::new(0);

/// A signal that asks the program to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal(u8);

impl Signal {
    /// Returns the exit code that a shell would show if the signal had ended the program.
    pub fn exit_code(self) -> u8 {
        128 + self.0
    }

    /// Returns the name of the signal.
    pub fn name(self) -> &'static str {
        match self.0 {
            1 => "SIGHUP",
            2 => "SIGINT",
            _ => "SIGTERM",
        }
    }
}

/// Returns the first signal that arrived since [`heed_signals`] was called.
pub fn caught_signal() -> Option<Signal> {
    u8::try_from(CAUGHT.load(Ordering::Relaxed)).ok().filter(|&number| number > 0).map(Signal)
}

/// Makes the program record the first signal INT, TERM or HUP instead of ending. A second signal ends the program at
/// once. Signals that were ignored when the program started, as under `nohup`, remain ignored.
#[cfg(unix)]
pub fn heed_signals() {
    extern "C" fn note(signal: libc::c_int) {
        let _ = CAUGHT.compare_exchange(0, signal, Ordering::Relaxed, Ordering::Relaxed);
    }
    let note: extern "C" fn(libc::c_int) = note;
    for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP] {
        // SAFETY: all-zero is a valid value of this plain structure, both pointers are valid or null, and the handler
        // only performs one operation on an atomic.
        unsafe {
            let mut before: libc::sigaction = std::mem::zeroed();
            let known = libc::sigaction(signal, std::ptr::null(), &raw mut before) == 0;
            if !known || before.sa_sigaction == libc::SIG_IGN {
                continue;
            }
            let mut action: libc::sigaction = std::mem::zeroed();
            action.sa_sigaction = note as libc::sighandler_t;
            action.sa_flags = libc::SA_RESETHAND | libc::SA_RESTART;
            libc::sigaction(signal, &raw const action, std::ptr::null_mut());
        }
    }
}

/// Makes a write fail if the file exceeds the system's size limit. Otherwise a signal would end the program.
#[cfg(unix)]
pub fn ignore_file_size_signal() {
    // SAFETY: this call installs no signal handler, so no handler runs.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

/// Does nothing, because this system has no signal for files that are too large.
#[cfg(not(unix))]
pub fn ignore_file_size_signal() {}

/// Makes the program record the first Ctrl-C, Ctrl-Break or closing of the console instead of ending. A second event
/// ends the program at once.
#[cfg(windows)]
pub fn heed_signals() {
    use windows_sys::Win32::System::Console::{
        CTRL_BREAK_EVENT, CTRL_C_EVENT, CTRL_CLOSE_EVENT, SetConsoleCtrlHandler,
    };
    extern "system" fn note(event: u32) -> windows_sys::core::BOOL {
        let signal = match event {
            CTRL_C_EVENT => 2,
            CTRL_BREAK_EVENT => 15,
            CTRL_CLOSE_EVENT => 1,
            _ => return 0,
        };
        CAUGHT.compare_exchange(0, signal, Ordering::Relaxed, Ordering::Relaxed).is_ok().into()
    }
    // SAFETY: the handler only performs one operation on an atomic.
    unsafe { SetConsoleCtrlHandler(Some(note), 1) };
}

/// Does nothing, because the browser version receives no signals.
#[cfg(not(any(unix, windows)))]
pub fn heed_signals() {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_said_of_the_time_left_before_anything_is_done() {
        let said = |done, secs| left(done, Duration::from_secs_f64(secs));
        assert_eq!(said(0, 0.0), "");
        assert_eq!(said(1, 0.2), "less than a second left");
        assert_eq!(said(1, 30.0), "30 seconds left");
    }
}
