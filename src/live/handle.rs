//! The window's handle of a live run.

use std::sync::mpsc::{Receiver, Sender, channel};

use triple_buffer::{Output, triple_buffer};

use super::engine::Engine;
use super::remote::{Ask, RemoteRun};
use super::{Command, LiveFrame, LiveOptions};
use crate::error::{Error, Result};

/// Stack of the solver's thread, bytes. Reading a session needs half a megabyte per level of its contents, in all
/// more than the default of two megabytes. Unused stack takes no memory.
const STACK_BYTES: usize = 32 << 20;

/// A run on a thread of its own. When it is dropped, it ends after the present step.
pub struct Live {
    place: Place,
    sent: u64,
}

/// The place of the computation.
enum Place {
    /// A thread of this process.
    Thread { commands: Sender<(u64, Command)>, frames: Output<LiveFrame> },
    /// A partner that takes and returns bytes.
    Remote(Box<RemoteRun>),
}

impl Live {
    /// Starts the thread with nothing loaded.
    ///
    /// # Errors
    /// If the system refuses a thread.
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

    /// A run that a [`RemoteEngine`](super::RemoteEngine) computes. `ask` sends messages to it, and its replies
    /// arrive in `inbox`.
    pub fn remote(ask: Ask, inbox: Receiver<Vec<u8>>) -> Self {
        Self { place: Place::Remote(Box::new(RemoteRun::new(ask, inbox))), sent: 0 }
    }

    /// Sends a command and returns its number. [`LiveFrame::acknowledged`] reaches the number when the command has
    /// been carried out (loading and seeking: when they have begun).
    pub fn send(&mut self, command: Command) -> u64 {
        self.sent += 1;
        match &mut self.place {
            // The thread ends only with this handle. After a panic in it, the run stands still.
            Place::Thread { commands, .. } => {
                let _ = commands.send((self.sent, command));
            }
            Place::Remote(run) => run.send(self.sent, command),
        }
        self.sent
    }

    /// The number of the last command sent.
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
