//! What long work says to whoever started it, on streams that may be closed or full, how far it has come, and the
//! signals that ask it to end.

use std::fmt::Display;
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI32, Ordering};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

use crate::error::escaped;

/// Why stdout did not take what was written to it.
static LOST: OnceLock<String> = OnceLock::new();

/// Writes a line to stdout, whatever names files have.
pub fn print_line(line: impl Display) {
    print_text(format_args!("{}\n", escaped(&line.to_string())));
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

/// "1 frame", "2 frames".
pub fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Progress of one piece of work on stderr.
#[derive(Clone, Debug)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Starts work of `length` units of any kind. `what` stands in front of the bar.
    pub fn new(what: &str, length: u64) -> Self {
        let bar = if std::io::stderr().is_terminal() {
            let template = "{prefix} {wide_bar} {percent:>3} %  {left}";
            let style = ProgressStyle::with_template(template)
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .with_key("left", |state: &ProgressState, out: &mut dyn std::fmt::Write| {
                    // What cannot be written on a terminal is no reason to end.
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

    /// Counts units done.
    pub fn advance(&self, units: u64) {
        self.bar.inc(units);
    }

    /// Sets the units done.
    pub fn set(&self, units: u64) {
        self.bar.set_position(units);
    }

    /// True if there is a terminal that shows a bar.
    pub fn is_drawn(&self) -> bool {
        !self.bar.is_hidden()
    }

    /// Says something in a line of its own.
    pub fn say(&self, line: &str) {
        self.bar.suspend(|| note_line(line));
    }

    /// Ends the work.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// How long work will take yet, in words; nothing where no part is done, from which one could tell.
fn left(done: u64, estimate: Duration) -> String {
    match done {
        0 => String::new(),
        _ if estimate < Duration::from_secs(1) => "less than a second left".into(),
        _ => format!("{} left", HumanDuration(estimate)),
    }
}

/// More steps than this are told of before they begin: they take minutes of the smallest scene.
const MANY_STEPS: u64 = 100_000_000;

/// Says on stderr how many steps were asked for, where they are very many.
pub fn warn_of_steps(steps: u64) {
    if steps > MANY_STEPS {
        note_line(format_args!("slump: this asks for {steps} steps, which take long"));
    }
}

/// The first signal that came; 0 where none did.
static CAUGHT: AtomicI32 = AtomicI32::new(0);

/// A signal that asks the program to end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal(u8);

impl Signal {
    /// What a shell shows of a program that the signal ended.
    pub fn exit_code(self) -> u8 {
        128 + self.0
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self.0 {
            1 => "SIGHUP",
            2 => "SIGINT",
            _ => "SIGTERM",
        }
    }
}

/// The first signal that came since [`heed_signals`].
pub fn caught_signal() -> Option<Signal> {
    u8::try_from(CAUGHT.load(Ordering::Relaxed)).ok().filter(|&number| number > 0).map(Signal)
}

/// From now on the first INT, TERM or HUP is only noted; the same once more ends the program at once.
/// What was ignored when the program started, as under `nohup`, stays so.
#[cfg(unix)]
pub fn heed_signals() {
    extern "C" fn note(signal: libc::c_int) {
        let _ = CAUGHT.compare_exchange(0, signal, Ordering::Relaxed, Ordering::Relaxed);
    }
    let note: extern "C" fn(libc::c_int) = note;
    for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP] {
        // SAFETY: all-zero is a valid value of this plain structure, both pointers are to live ones or
        // null, and the handler does nothing but one operation on an atomic.
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

/// From now on a file that grows beyond what the system allows is an error of that write, and not the end.
#[cfg(unix)]
pub fn ignore_file_size_signal() {
    // SAFETY: no handler is installed, and none runs.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

/// No such signal is here.
#[cfg(not(unix))]
pub fn ignore_file_size_signal() {}

/// From now on the first Ctrl-C, Ctrl-Break or closed console is only noted; the same once more ends the program at once.
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
    // SAFETY: the handler does nothing but one operation on an atomic.
    unsafe { SetConsoleCtrlHandler(Some(note), 1) };
}

/// No signal reaches a page.
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
