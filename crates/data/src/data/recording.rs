//! A recording: writes the measurements and moments of a run to files while it runs.

use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use super::columns::{FrameRow, frames};
use super::csv::{KeptRows, TextTable};
use super::folder_files::FRAMES;
use super::format::{Format, Frame, RecordingMark, RunFacts};
use super::formats::{check_format, start_format};
use super::recording_folder::{RecordingFolder, check_manifest, write_manifest};
use crate::error::{Error, Result};
use crate::scene::{DataSettings, FormatName};
use crate::sim::{ForceSums, Moment, Observables, Simulation};

/// Default simulated time between two frames, s; the same as between pictures.
const DEFAULT_EVERY_SECS: f64 = 0.04;
/// Number of messages that may wait to be written. Frames among them take memory. With fewer, the run would wait for a
/// disk that is busy for a moment.
const MOST_WAITING: usize = 4;
/// Number of step rows that may wait to be sent.
const MOST_ROWS: usize = 1024;
/// Frames between two writes of the files if the run is faster than the disk. If it is larger, more is lost when the
/// program is killed.
const FRAMES_AT_ONCE: usize = 8;

/// A recording that grows during a run.
///
/// A separate thread writes the frames. If writing fails there, the next call returns the error. Memory does not grow
/// with the run: if the disk is too slow, the run waits.
///
/// ```
/// use slump_data::data::{RunFacts, FormatName, Recording};
///
/// let folder = tempfile::tempdir().expect("a folder");
/// let mut simulation = slump_core::scene::built_in("cradle")?.simulation()?;
/// let formats = [FormatName::Csv];
/// let mut recording = Recording::start(folder.path(), &formats, &RunFacts::default(), false)?;
/// for _ in 0..10 {
///     recording.add_step(simulation.step()?)?;
///     recording.add_if_due(&simulation)?;
/// }
/// recording.finish()?;
/// assert!(folder.path().join("csv/contacts.csv").exists());
/// # Ok::<(), slump_core::error::Error>(())
/// ```
pub struct Recording {
    folder: RecordingFolder,
    /// Rows that are sent with the next frame.
    rows: Vec<Observables>,
    frames: u64,
    /// Step of the last frame that existed when the recording was resumed.
    last_step: Option<u64>,
    schedule: Option<FrameSchedule>,
    /// `None` once the recording has ended, also after an error.
    writer: Option<WriterThread>,
    /// Sums of the forces of pairs since the last frame.
    sums: ForceSums,
}

/// The thread that writes, and its message channel.
struct WriterThread {
    sender: SyncSender<RecordingMessage>,
    thread: JoinHandle<Result<()>>,
}

impl Recording {
    /// Starts a recording in a folder, which is created if missing. An existing recording is removed if `overwrite` is
    /// true, and refused otherwise.
    ///
    /// # Errors
    /// If the folder cannot be written to, another process is recording into it, or it contains a recording.
    pub fn start(
        folder: &Path,
        formats: &[FormatName],
        facts: &RunFacts,
        overwrite: bool,
    ) -> Result<Self> {
        Self::start_in(RecordingFolder::of(folder, overwrite)?, formats, facts)
    }

    /// Starts a recording in a folder that is already locked.
    ///
    /// # Errors
    /// If the folder cannot be written to.
    pub fn start_in(
        folder: RecordingFolder,
        formats: &[FormatName],
        facts: &RunFacts,
    ) -> Result<Self> {
        formats.iter().try_for_each(|&format| check_format(format))?;
        folder.clear()?;
        // The manifest comes first: other programs identify a recording by it.
        write_manifest(folder.path(), formats, facts)?;
        let writer = FormatsWriter::start(folder.path(), formats, facts)?;
        Self::with(folder, writer, 0, None)
    }

    /// Resumes the recording in a folder, for a run that resumes at a step at which the recording had the extent
    /// `mark`. Later rows are dropped. Without an existing recording a new one is started.
    ///
    /// # Errors
    /// As [`Recording::start`], and if a file differs from the format of this version or has lost a part of that
    /// extent. Then nothing is changed.
    pub fn go_on(
        folder: &Path,
        formats: &[FormatName],
        facts: &RunFacts,
        step: u64,
        mark: &RecordingMark,
    ) -> Result<Self> {
        let folder = RecordingFolder::to_go_on(folder)?;
        check_manifest(folder.path(), formats)?;
        let mut writer = FormatsWriter::start(folder.path(), formats, facts)?;
        let kept = writer.roll_back(step, mark)?;
        write_manifest(folder.path(), formats, facts)?;
        Self::with(folder, writer, kept.rows, kept.step)
    }

    /// Checks that [`Recording::go_on`] will succeed.
    ///
    /// # Errors
    /// As [`Recording::go_on`].
    pub fn check(
        folder: &Path,
        formats: &[FormatName],
        step: u64,
        mark: &RecordingMark,
    ) -> Result<()> {
        let folder = RecordingFolder::to_go_on(folder)?;
        check_manifest(folder.path(), formats)?;
        let writer = FormatsWriter::start(folder.path(), formats, &RunFacts::default())?;
        writer.check(step, mark).map(drop)
    }

    fn with(
        folder: RecordingFolder,
        writer: FormatsWriter,
        frames: u64,
        last_step: Option<u64>,
    ) -> Result<Self> {
        let (sender, messages) = sync_channel(MOST_WAITING);
        let thread =
            std::thread::Builder::new().spawn(move || writer.run(&messages)).map_err(|error| {
                Error::value(
                    "data",
                    "recorded",
                    format!("left out where no thread can be made for it ({error})"),
                )
            })?;
        let writer = Some(WriterThread { sender, thread });
        let (rows, sums) = (Vec::new(), ForceSums::default());
        Ok(Self { folder, rows, frames, last_step, schedule: None, writer, sums })
    }

    /// Sums of the forces of pairs since the last frame. A run that resumes from a saved state passes them to
    /// [`Recording::with_sums`].
    pub fn sums(&self) -> &ForceSums {
        &self.sums
    }

    /// Continues the means of the next frame from these sums.
    pub fn with_sums(mut self, sums: ForceSums) -> Self {
        self.sums = sums;
        self
    }

    /// The folder of the recording.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Number of frames added so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Adds the measurements of a step.
    ///
    /// # Errors
    /// If an earlier write failed.
    pub fn add_step(&mut self, observables: &Observables) -> Result<()> {
        self.rows.push(*observables);
        let has_failed = self.writer.as_ref().is_some_and(|writer| writer.thread.is_finished());
        if self.rows.len() < MOST_ROWS && !has_failed { Ok(()) } else { self.send_rows() }
    }

    /// Adds the forces of pairs in the last step to the means of the next frame. Call it at the start and after each
    /// step; more than one call per step has no further effect.
    pub fn follow(&mut self, simulation: &Simulation) {
        self.sums.follow(simulation);
    }

    /// Adds a frame. Its step must be later than those of the frames before.
    ///
    /// # Errors
    /// If an earlier write failed.
    pub fn add(&mut self, moment: Moment) -> Result<()> {
        self.send_rows()?;
        let taken = Box::new((moment, self.sums.take()));
        self.send(RecordingMessage::Frame(self.frames, taken))?;
        self.frames += 1;
        Ok(())
    }

    /// Makes [`Recording::add_if_due`] add frames at the steps nearest to some times of the run, which is now in this
    /// state. In a resumed recording the frames up to now exist already.
    pub fn at(mut self, times: Times, simulation: &Simulation) -> Self {
        let mut schedule = FrameSchedule::new(times);
        if self.last_step.is_some() {
            schedule.is_due(simulation);
        }
        self.schedule = Some(schedule);
        self
    }

    /// Adds a frame of the present state if one is due. Without [`Recording::at`], a frame is always due. Also calls
    /// [`Recording::follow`]. Call it at the start and after each step.
    ///
    /// # Errors
    /// If an earlier write failed.
    pub fn add_if_due(&mut self, simulation: &Simulation) -> Result<()> {
        self.follow(simulation);
        let is_due = self.schedule.as_mut().is_none_or(|schedule| schedule.is_due(simulation));
        if is_due { self.add(simulation.moment()) } else { Ok(()) }
    }

    /// Waits until readers can find everything, and returns the extent of the recording.
    ///
    /// # Errors
    /// If something could not be written.
    pub fn flush(&mut self) -> Result<RecordingMark> {
        self.send_rows()?;
        let (done, answer) = sync_channel(1);
        self.send(RecordingMessage::Flush(done))?;
        // No reply comes if the writer has failed; `end` then returns its error.
        answer.recv().or_else(|_| self.end().map(|()| RecordingMark::default()))
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// If something could not be written.
    pub fn finish(mut self) -> Result<()> {
        self.send_rows()?;
        self.end()
    }

    fn send_rows(&mut self) -> Result<()> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let rows = std::mem::take(&mut self.rows);
        self.send(RecordingMessage::Steps(rows))
    }

    fn send(&mut self, message: RecordingMessage) -> Result<()> {
        match &self.writer {
            Some(writer) if writer.sender.send(message).is_ok() => Ok(()),
            Some(_) => self.end(),
            None => Ok(()),
        }
    }

    /// Ends the thread and returns its error, once.
    fn end(&mut self) -> Result<()> {
        let Some(WriterThread { sender, thread }) = self.writer.take() else { return Ok(()) };
        drop(sender);
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        // The thread must end before the folder is unlocked for others. `finish` reports errors, this does not.
        if let Some(WriterThread { sender, thread }) = self.writer.take() {
            drop(sender);
            let _ = thread.join();
        }
    }
}

enum RecordingMessage {
    Steps(Vec<Observables>),
    /// A frame, with the number of earlier frames.
    Frame(u64, Box<(Moment, ForceSums)>),
    /// A request to write everything before replying.
    Flush(SyncSender<RecordingMark>),
}

/// Writes all formats, on a separate thread, and the list of frames that all formats have.
struct FormatsWriter {
    formats: Vec<Box<dyn Format>>,
    index: TextTable,
    /// Frames that the formats have received but may not have written.
    waiting: Vec<FrameRow>,
    /// Extent of the data that the formats have received.
    mark: RecordingMark,
}

impl FormatsWriter {
    /// Starts in a folder without a recording, or opens the existing recording.
    fn start(folder: &Path, formats: &[FormatName], facts: &RunFacts) -> Result<Self> {
        let formats = formats.iter().map(|format| start_format(*format, folder, facts));
        let formats = formats.collect::<Result<_>>()?;
        let index = TextTable::new(folder.join(FRAMES), &RunFacts::default(), &frames(&[]));
        Ok(Self { formats, index, waiting: Vec::new(), mark: RecordingMark::default() })
    }

    /// Checks that the recording has the extent `mark` at a step, and returns its frames.
    fn check(&self, step: u64, mark: &RecordingMark) -> Result<KeptRows> {
        let (kept, _) = self.index.rows_there(Some(step), mark.frames)?;
        if kept.rows < mark.frames {
            let allowed = format!(
                "all {} that it had when the run was saved; --overwrite starts the run again",
                mark.frames
            );
            return Err(Error::value("frames of the recording", kept.rows, allowed));
        }
        self.formats.iter().try_for_each(|format| format.check(step, kept.step, mark))?;
        Ok(kept)
    }

    /// Drops everything that was recorded after a step, at which the recording had the extent `mark`. If a part of that
    /// is missing, drops nothing.
    fn roll_back(&mut self, step: u64, mark: &RecordingMark) -> Result<KeptRows> {
        let kept = self.check(step, mark)?;
        self.index.roll_back(kept.step)?;
        let mut formats = self.formats.iter_mut();
        formats.try_for_each(|format| format.roll_back(step, kept.step))?;
        self.mark = *mark;
        Ok(kept)
    }

    /// Writes messages until the channel closes. An error ends the recording, but data written before it remains.
    fn run(mut self, messages: &Receiver<RecordingMessage>) -> Result<()> {
        let taken = self.take_all(messages);
        // If a frame could not be added, the frames before it are complete.
        let flushed = if self.waiting.is_empty() { Ok(()) } else { self.flush() };
        let written = taken.and(flushed);
        // Every format is finished, even if others failed.
        let finished: Vec<_> = self.formats.iter_mut().map(|format| format.finish()).collect();
        written.and(finished.into_iter().collect())
    }

    fn take_all(&mut self, messages: &Receiver<RecordingMessage>) -> Result<()> {
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

    fn take(&mut self, message: RecordingMessage) -> Result<()> {
        match message {
            RecordingMessage::Steps(rows) => {
                self.mark.steps += rows.len() as u64;
                self.formats.iter_mut().try_for_each(|format| format.add_steps(&rows))
            }
            RecordingMessage::Frame(number, taken) => {
                let (moment, sums) = *taken;
                let frame = Frame::new(number, moment, &sums);
                let Observables { step, time_secs, .. } = frame.moment.observables;
                self.mark.add(&frame);
                self.formats.iter_mut().try_for_each(|format| format.add(&frame))?;
                self.waiting.push(FrameRow { step, time_secs, number });
                Ok(())
            }
            RecordingMessage::Flush(done) => {
                self.flush()?;
                // The receiver of the reply may be gone.
                let _ = done.send(self.mark);
                Ok(())
            }
        }
    }

    fn flush(&mut self) -> Result<()> {
        self.formats.iter_mut().try_for_each(|format| format.flush())?;
        self.index.add(&frames(&self.waiting))?;
        self.waiting.clear();
        Ok(())
    }
}

/// The simulated times of frames.
#[derive(Clone, Debug, PartialEq)]
pub enum Times {
    /// From 0 on, with this interval, s.
    Every(f64),
    /// At these times, s, in ascending order.
    At(Vec<f64>),
}

impl Times {
    /// The times for these settings: frames at a constant rate.
    pub fn of(settings: &DataSettings) -> Self {
        Self::Every(settings.every_secs.unwrap_or(DEFAULT_EVERY_SECS))
    }
}

/// The steps of a run at which frames are made.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameSchedule {
    times: Times,
    next: usize,
}

impl FrameSchedule {
    /// Frames at the steps nearest to some times.
    pub fn new(times: Times) -> Self {
        Self { times, next: 0 }
    }

    /// True if a frame of the present state is due. Call it once for each step, in order.
    pub fn is_due(&mut self, simulation: &Simulation) -> bool {
        let latest_secs = simulation.time_secs() + 0.5 * simulation.parameters().time_step_secs;
        let step = simulation.observables().step;
        self.is_due_at(step, latest_secs, |secs| simulation.step_at(secs))
    }

    /// True if a frame is due after a step that represents all times up to `latest_secs`.
    fn is_due_at(&mut self, step: u64, latest_secs: f64, step_at: impl Fn(f64) -> u64) -> bool {
        let mut due = false;
        while self.next_secs().is_some_and(|secs| step_at(secs) <= step) {
            due = true;
            let before = self.next;
            self.next = match self.times {
                // In one operation, because many frames may fall into a single step.
                Times::Every(secs) => {
                    before.saturating_add(1).max((latest_secs / secs).floor() as usize)
                }
                Times::At(_) => before + 1,
            };
            // The count has reached its maximum: a frame is due in every step.
            if self.next == before {
                break;
            }
        }
        due
    }

    fn next_secs(&self) -> Option<f64> {
        match &self.times {
            Times::Every(secs) => Some(self.next as f64 * secs),
            Times::At(times) => times.get(self.next).copied(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due(times: Times, time_step_secs: f64, until: u64) -> Vec<u64> {
        let mut schedule = FrameSchedule::new(times);
        let step_at = |secs: f64| (secs / time_step_secs).round() as u64;
        let latest_secs = |step: u64| (step as f64 + 0.5) * time_step_secs;
        let is_due = |&step: &u64| schedule.is_due_at(step, latest_secs(step), step_at);
        (0..=until).filter(is_due).collect()
    }

    #[test]
    fn a_frame_is_made_at_the_step_nearest_to_its_time() {
        assert_eq!(due(Times::Every(0.01), 1e-3, 35), [0, 10, 20, 30]);
        assert_eq!(due(Times::Every(0.0025), 1e-3, 10), [0, 3, 5, 8, 10]);
        assert_eq!(due(Times::At(vec![0.0, 0.0, 0.0121, 0.5]), 1e-3, 35), [0, 12]);
        assert!(due(Times::At(vec![]), 1e-3, 35).is_empty());
    }

    #[test]
    fn where_several_times_fall_on_a_step_one_frame_is_made() {
        assert_eq!(due(Times::Every(1e-300), 1e-3, 5), [0, 1, 2, 3, 4, 5]);
        assert_eq!(due(Times::Every(1e-4), 1e-3, 5), [0, 1, 2, 3, 4, 5]);
        assert_eq!(due(Times::Every(7e-4), 1e-3, 7), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(due(Times::Every(1e300), 1e-3, 7), [0]);
    }
}
