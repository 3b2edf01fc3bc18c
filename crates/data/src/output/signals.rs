//! Signals that ask the program to end: a run that heeds them ends after the step that it is in.

use std::sync::atomic::{AtomicI32, Ordering};

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

/// Nothing is caught here.
#[cfg(not(unix))]
pub fn heed_signals() {}
