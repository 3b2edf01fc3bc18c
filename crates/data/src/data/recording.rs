//! A recording: what a run tells of itself goes to files while it goes on.

use std::path::Path;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

use super::claim::Claim;
use super::format::About;
use super::manifest;
use super::schedule::{Schedule, Times};
use super::writer::{Message, Writer};
use crate::error::Result;
use crate::scene::FormatName;
use crate::sim::{Moment, Observables, Simulation};

/// Messages that wait for being written. Memory is bounded by the frames among them; fewer would have the
/// run wait for a disk that is busy for a moment.
const MOST_WAITING: usize = 4;
/// Rows of steps that wait for being sent.
const MOST_ROWS: usize = 1024;

/// A recording that grows with a run.
///
/// Frames are written by a thread of its own; what goes wrong there is told by the next call. Memory does
/// not grow with the run: where the disk is too slow, the run waits.
///
/// ```
/// use slump::data::{About, FormatName, Recording};
///
/// let folder = tempfile::tempdir().expect("a folder");
/// let mut simulation = slump::scene::built_in("cradle")?.simulation()?;
/// let formats = [FormatName::Csv];
/// let mut recording = Recording::start(folder.path(), &formats, &About::default(), false)?;
/// for _ in 0..10 {
///     recording.add_step(simulation.step()?)?;
///     recording.add(simulation.moment())?;
/// }
/// recording.finish()?;
/// assert!(folder.path().join("csv/contacts.csv").exists());
/// # Ok::<(), slump::error::Error>(())
/// ```
pub struct Recording {
    claim: Claim,
    /// Rows that wait for the next frame.
    rows: Vec<Observables>,
    frames: u64,
    /// Step of the last frame that was there when it was gone on with.
    last_step: Option<u64>,
    schedule: Option<Schedule>,
    /// None once the recording has ended, be it by an error.
    writer: Option<Handle>,
}

/// The thread that writes.
struct Handle {
    sender: SyncSender<Message>,
    thread: JoinHandle<Result<()>>,
}

impl Recording {
    /// Starts a recording in a folder, which is made where it is not there. An earlier one is removed with
    /// `overwrite` and refused without.
    ///
    /// # Errors
    /// Where the folder cannot be written to, or another recording is being written or lies there.
    pub fn start(
        folder: &Path,
        formats: &[FormatName],
        about: &About,
        overwrite: bool,
    ) -> Result<Self> {
        Self::start_in(Claim::of(folder, overwrite)?, formats, about)
    }

    /// Starts a recording in a folder that has been claimed.
    ///
    /// # Errors
    /// Where the folder cannot be written to.
    pub fn start_in(claim: Claim, formats: &[FormatName], about: &About) -> Result<Self> {
        formats.iter().try_for_each(|&format| super::formats::check_format(format))?;
        claim.clear()?;
        // First of all: it is by this that others know a recording.
        manifest::write(claim.path(), formats, about)?;
        let writer = Writer::start(claim.path(), formats, about)?;
        Ok(Self::with(claim, writer, 0, None))
    }

    /// Goes on with the recording in a folder, for a run that goes on from a step: what was recorded after
    /// it is dropped. Without a recording there one is started.
    ///
    /// # Errors
    /// As [`Recording::start`], and where a file there is not what this version writes.
    pub fn go_on(folder: &Path, formats: &[FormatName], about: &About, step: u64) -> Result<Self> {
        let claim = Claim::to_go_on(folder)?;
        manifest::check(folder, formats)?;
        let mut writer = Writer::start(folder, formats, about)?;
        let kept = writer.roll_back(step)?;
        manifest::write(folder, formats, about)?;
        Ok(Self::with(claim, writer, kept.rows, kept.step))
    }

    fn with(claim: Claim, writer: Writer, frames: u64, last_step: Option<u64>) -> Self {
        let (sender, messages) = sync_channel(MOST_WAITING);
        let thread = std::thread::spawn(move || writer.run(&messages));
        let writer = Some(Handle { sender, thread });
        Self { claim, rows: Vec::new(), frames, last_step, schedule: None, writer }
    }

    /// Where it is.
    pub fn folder(&self) -> &Path {
        self.claim.path()
    }

    /// Frames that it has been given.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Adds what a step measured.
    ///
    /// # Errors
    /// Where something before could not be written.
    pub fn add_step(&mut self, observables: &Observables) -> Result<()> {
        self.rows.push(*observables);
        let has_failed = self.writer.as_ref().is_some_and(|writer| writer.thread.is_finished());
        if self.rows.len() < MOST_ROWS && !has_failed { Ok(()) } else { self.send_rows() }
    }

    /// Adds a frame, the first after the last of those before.
    ///
    /// # Errors
    /// Where something before could not be written.
    pub fn add(&mut self, moment: Moment) -> Result<()> {
        self.send_rows()?;
        self.send(Message::Frame(self.frames, Box::new(moment)))?;
        self.frames += 1;
        Ok(())
    }

    /// Has frames made at the steps nearest to some times of a run that is at this state, by
    /// [`Recording::add_if_due`]. Where the recording is gone on with, it has those up to here.
    pub fn at(mut self, times: Times, simulation: &Simulation) -> Self {
        let mut schedule = Schedule::new(times);
        if self.last_step.is_some() {
            schedule.is_due(simulation);
        }
        self.schedule = Some(schedule);
        self
    }

    /// Adds a frame of the present state where one is due. To be called at the start and after each step.
    ///
    /// # Errors
    /// Where something before could not be written.
    pub fn add_if_due(&mut self, simulation: &Simulation) -> Result<()> {
        let is_due = self.schedule.as_mut().is_some_and(|schedule| schedule.is_due(simulation));
        if is_due { self.add(simulation.moment()) } else { Ok(()) }
    }

    /// Waits until everything is where readers find it.
    ///
    /// # Errors
    /// Where something could not be written.
    pub fn flush(&mut self) -> Result<()> {
        self.send_rows()?;
        let (done, answer) = sync_channel(1);
        self.send(Message::Flush(done))?;
        // No answer comes where the writer has failed, which is told here.
        if answer.recv().is_ok() { Ok(()) } else { self.end() }
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// Where something could not be written.
    pub fn finish(mut self) -> Result<()> {
        self.send_rows()?;
        self.end()
    }

    fn send_rows(&mut self) -> Result<()> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let rows = std::mem::take(&mut self.rows);
        self.send(Message::Steps(rows))
    }

    fn send(&mut self, message: Message) -> Result<()> {
        match &self.writer {
            Some(writer) if writer.sender.send(message).is_ok() => Ok(()),
            Some(_) => self.end(),
            None => Ok(()),
        }
    }

    /// Has the thread end, and tells what went wrong there, once.
    fn end(&mut self) -> Result<()> {
        let Some(Handle { sender, thread }) = self.writer.take() else { return Ok(()) };
        drop(sender);
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        // Before the folder is free for others. Whoever wants to know what went wrong calls `finish`.
        if let Some(Handle { sender, thread }) = self.writer.take() {
            drop(sender);
            let _ = thread.join();
        }
    }
}
