//! The handle by which a window controls a live run (a simulation that the user watches while it is computed).

use std::sync::mpsc::{Receiver, Sender, channel};

use triple_buffer::{Output, triple_buffer};

use super::engine::Engine;
use super::remote::{Ask, RemoteRun};
use super::{Command, LiveFrame, LiveOptions};
use crate::error::{Error, Result};

/// Stack size of the solver's thread, bytes. Reading a saved session needs half a megabyte for each level of its
/// nested data, in total more than the default stack of two megabytes. Unused stack takes no memory.
const STACK_BYTES: usize = 32 << 20;

/// Handle of a live run (a simulation that the user watches while it is computed). When the handle is dropped, the run
/// ends after the present step.
pub struct Live {
    place: Place,
    sent: u64,
}

/// The solver that computes a run: in this process or in another one.
enum Place {
    /// A thread of this process, with the channels to it.
    Thread { commands: Sender<(u64, Command)>, frames: Output<LiveFrame> },
    /// A solver in another process, such as a browser's worker, which exchanges messages as bytes with this process.
    Remote(Box<RemoteRun>),
}

impl Live {
    /// Starts a solver's thread that has no initial state yet.
    ///
    /// # Errors
    /// If the operating system cannot start a thread.
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

    /// Returns a handle of a run that a [`RemoteEngine`](super::RemoteEngine) computes. The callback `ask` sends
    /// messages to that engine, and its replies arrive in `inbox`.
    pub fn remote(ask: Ask, inbox: Receiver<Vec<u8>>) -> Self {
        Self { place: Place::Remote(Box::new(RemoteRun::new(ask, inbox))), sent: 0 }
    }

    /// Sends a command and returns its number. [`LiveFrame::acknowledged`] reaches this number when the command has
    /// taken effect. The loading of an initial state and a seek (a jump to a recorded time) are acknowledged when they
    /// begin.
    pub fn send(&mut self, command: Command) -> u64 {
        self.sent += 1;
        match &mut self.place {
            // The thread ends only when this handle is dropped. If the thread panics, sending fails and the display
            // stops changing.
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

    /// The newest frame (the data to draw). This function never waits for the solver.
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
