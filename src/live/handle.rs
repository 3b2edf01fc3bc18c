//! The side of a live run that a window holds.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use triple_buffer::{Output, triple_buffer};

use super::engine::Engine;
use super::remote::{Ask, RemoteRun};
use super::{Command, LiveFrame};
use crate::error::{Error, Result};

/// Stack of the solver's thread, bytes: reading a session takes frames of half a megabyte, one for each level of what it
/// holds, and came to more than the two megabytes that a thread has by itself. What is not used takes no memory.
const STACK_BYTES: usize = 32 << 20;

/// What the solver's thread is to do for its window.
pub struct LiveOptions {
    /// Called on the solver's thread after each new frame.
    pub wake: Box<dyn Fn() + Send>,
    /// Asked while a start is made: true where that is to be given up, though no command could come in meanwhile.
    pub gives_up: Box<dyn Fn() -> bool + Send>,
    /// Least time between two frames while the run goes on.
    pub frame_interval: Duration,
    /// Memory for keyframes, of all worlds together.
    pub recording_bytes: usize,
}

impl Default for LiveOptions {
    /// Nobody to wake, 60 frames a second, 96 MiB.
    fn default() -> Self {
        Self {
            wake: Box::new(|| {}),
            gives_up: Box::new(|| false),
            frame_interval: Duration::from_micros(16_600),
            recording_bytes: 96 << 20,
        }
    }
}

/// A run that goes on by itself. Dropped, it ends after the step that it is computing.
pub struct Live {
    place: Place,
    sent: u64,
}

/// Where it is computed.
enum Place {
    /// By a thread of this process.
    Thread { commands: Sender<(u64, Command)>, frames: Output<LiveFrame> },
    /// By someone who takes bytes and answers in bytes.
    Remote(Box<RemoteRun>),
}

impl Live {
    /// Starts the thread, with nothing loaded.
    ///
    /// # Errors
    /// Where the system refuses a thread.
    pub fn spawn(options: LiveOptions) -> Result<Self> {
        let (commands, inbox) = channel();
        let (output, frames) = triple_buffer(&LiveFrame::default());
        let engine = Engine::new(inbox, output, options);
        std::thread::Builder::new()
            .name("solver".into())
            .stack_size(STACK_BYTES)
            .spawn(move || engine.run())
            .map_err(|error| Error::value("solver thread", error, "startable"))?;
        Ok(Self { place: Place::Thread { commands, frames }, sent: 0 })
    }

    /// A run that a [`RemoteEngine`](super::RemoteEngine) computes: `ask` brings messages there, and what it posts comes
    /// in by `inbox`.
    pub fn remote(ask: Ask, inbox: Receiver<Vec<u8>>) -> Self {
        Self { place: Place::Remote(Box::new(RemoteRun::new(ask, inbox))), sent: 0 }
    }

    /// Sends a command and returns its number, which [`LiveFrame::acknowledged`] reaches once the
    /// command has been carried out (loading and seeking: once they have begun).
    pub fn send(&mut self, command: Command) -> u64 {
        self.sent += 1;
        match &mut self.place {
            // The thread ends only with this handle; a panic there shows as a run that stands still.
            Place::Thread { commands, .. } => {
                let _ = commands.send((self.sent, command));
            }
            Place::Remote(run) => run.send(self.sent, command),
        }
        self.sent
    }

    /// The number of the last command that was sent.
    pub fn sent(&self) -> u64 {
        self.sent
    }

    /// The newest frame. Never waits.
    pub fn latest(&mut self) -> &LiveFrame {
        match &mut self.place {
            Place::Thread { frames, .. } => frames.read(),
            Place::Remote(run) => run.latest(),
        }
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.send(Command::Quit);
    }
}
