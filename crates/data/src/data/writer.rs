//! What writes a recording, on a thread of its own.

use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender};

use super::columns::FrameRow;
use super::format::{About, Format, Frame};
use super::index::Index;
use super::text_table::Kept;
use crate::error::Result;
use crate::scene::FormatName;
use crate::sim::{Moment, Observables};

/// Frames that are taken before files are written anew, where the run is faster than the disk. More: more
/// is lost when the program is killed.
const FRAMES_AT_ONCE: usize = 8;

/// What a run tells its recording.
pub(super) enum Message {
    /// What some steps measured.
    Steps(Vec<Observables>),
    /// A frame, by the number of those before.
    Frame(u64, Box<Moment>),
    /// Everything is to be written before this is answered.
    Flush(SyncSender<()>),
}

/// Writes every format, and the list of what is written.
pub(super) struct Writer {
    formats: Vec<Box<dyn Format>>,
    index: Index,
    /// Frames that formats have taken and may not have written.
    waiting: Vec<FrameRow>,
}

impl Writer {
    /// Starts in a folder that has no recording, or goes on with the one that is there.
    ///
    /// # Errors
    /// Where a format cannot be written there.
    pub(super) fn start(folder: &Path, formats: &[FormatName], about: &About) -> Result<Self> {
        let formats = formats.iter().map(|format| super::formats::start(*format, folder, about));
        let formats = formats.collect::<Result<_>>()?;
        Ok(Self { formats, index: Index::new(folder), waiting: Vec::new() })
    }

    /// Drops what was recorded after a step, and frames that not every format has.
    ///
    /// # Errors
    /// Where a file is not what this wrote.
    pub(super) fn roll_back(&mut self, step: u64) -> Result<Kept> {
        let kept = self.index.roll_back(step)?;
        let mut formats = self.formats.iter_mut();
        formats.try_for_each(|format| format.roll_back(step, kept.step))?;
        Ok(kept)
    }

    /// Writes what comes until no more can come. What fails ends the recording; what was written before
    /// stays.
    ///
    /// # Errors
    /// The first that there is.
    pub(super) fn run(mut self, messages: &Receiver<Message>) -> Result<()> {
        let taken = self.take_all(messages);
        // Where a frame could not be taken, those before it are whole.
        let flushed = if self.waiting.is_empty() { Ok(()) } else { self.flush() };
        let written = taken.and(flushed);
        // Each is tried, whatever became of those before.
        let finished: Vec<_> = self.formats.iter_mut().map(|format| format.finish()).collect();
        written.and(finished.into_iter().collect())
    }

    fn take_all(&mut self, messages: &Receiver<Message>) -> Result<()> {
        while let Ok(message) = messages.recv() {
            self.take(message)?;
            while self.waiting.len() < FRAMES_AT_ONCE
                && let Ok(message) = messages.try_recv()
            {
                self.take(message)?;
            }
            if !self.waiting.is_empty() {
                self.flush()?;
            }
        }
        Ok(())
    }

    fn take(&mut self, message: Message) -> Result<()> {
        match message {
            Message::Steps(rows) => {
                self.formats.iter_mut().try_for_each(|format| format.add_steps(&rows))
            }
            Message::Frame(number, moment) => {
                let frame = Frame::new(number, *moment);
                let Observables { step, time_secs, .. } = frame.moment.observables;
                self.formats.iter_mut().try_for_each(|format| format.add(&frame))?;
                self.waiting.push(FrameRow { step, time_secs, number });
                Ok(())
            }
            Message::Flush(done) => {
                self.flush()?;
                // Whoever asked may have gone.
                let _ = done.send(());
                Ok(())
            }
        }
    }

    fn flush(&mut self) -> Result<()> {
        self.formats.iter_mut().try_for_each(|format| format.flush())?;
        self.index.add(&self.waiting)?;
        self.waiting.clear();
        Ok(())
    }
}
