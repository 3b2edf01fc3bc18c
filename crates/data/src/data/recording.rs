//! Records a run: writes the measurements of its steps, and snapshots (frames), to files while it runs.

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

/// Default simulated time between two frames, s: 25 frames per simulated second, as for pictures.
const DEFAULT_EVERY_SECS: f64 = 0.04;
/// Largest number of messages that may wait for the writing thread. If it is larger, waiting frames take more memory.
/// If it is smaller, the run must wait whenever the disk is busy for a short time.
const MOST_WAITING: usize = 4;
/// Number of rows of the table of steps that are collected before they are sent to the writing thread. If it is larger,
/// fewer messages are sent, but more rows are lost when the program is killed.
const MOST_ROWS: usize = 1024;
/// Largest number of frames that are added before the files are flushed, if the run is faster than the disk. If it is
/// larger, more frames are lost when the program is killed.
const FRAMES_AT_ONCE: usize = 8;

/// A recording that grows during a run.
///
/// A separate thread writes the frames. If this thread fails to write, the next call returns the error. The used memory
/// does not grow with the run: if the disk is too slow, the run waits.
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
    /// Measurements of steps that have not yet been sent to the writing thread.
    rows: Vec<Observables>,
    frames: u64,
    /// Step of the last frame that existed when the recording was resumed; `None` for a new recording.
    last_step: Option<u64>,
    schedule: Option<FrameSchedule>,
    /// The writing thread; `None` once the recording has ended, also after an error.
    writer: Option<WriterThread>,
    /// Sums of the contact forces of each pair of bodies since the last frame.
    sums: ForceSums,
}

/// The thread that writes the files, and the channel for messages to it.
struct WriterThread {
    sender: SyncSender<RecordingMessage>,
    thread: JoinHandle<Result<()>>,
}

impl Recording {
    /// Starts a recording in a folder, which is created if it does not exist. A recording that is already in the folder
    /// is removed if `overwrite` is true; otherwise starting fails.
    ///
    /// # Errors
    /// If the folder cannot be written to, if another process is recording into the folder, or if it contains a
    /// recording and `overwrite` is false.
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
        // The manifest (`data.json`) is written first, because other programs identify a recording by this file.
        write_manifest(folder.path(), formats, facts)?;
        let writer = FormatsWriter::start(folder.path(), formats, facts)?;
        Self::with(folder, writer, 0, None)
    }

    /// Continues the recording in a folder, for a run that resumes from step number `step`. `mark` has the numbers of
    /// frames and rows that the recording had at that step. Later rows and frames are removed. If the folder contains
    /// no recording, a new recording is started.
    ///
    /// # Errors
    /// If the folder cannot be written to, if another process is recording into it, if a file differs from the format
    /// of this version, or if rows or frames counted in `mark` are missing. Then no recorded data are changed.
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
    /// The error that [`Recording::go_on`] would return.
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

    /// Returns the sums of the contact forces of each pair of bodies since the last frame. A run that resumes from a
    /// saved state passes these sums to [`Recording::with_sums`].
    pub fn sums(&self) -> &ForceSums {
        &self.sums
    }

    /// Sets the sums of forces since the last frame, so that the means of the next frame include the time before the
    /// run was saved.
    pub fn with_sums(mut self, sums: ForceSums) -> Self {
        self.sums = sums;
        self
    }

    /// Returns the folder of the recording.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Returns the number of frames added so far.
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

    /// Adds the contact forces of the last step to the sums for the means in the next frame. Call this function at the
    /// start and after each step; more than one call per step has no further effect.
    pub fn follow(&mut self, simulation: &Simulation) {
        self.sums.follow(simulation);
    }

    /// Adds a snapshot of the run as a frame. The number of its step must be larger than those of all earlier frames.
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

    /// Sets the simulated times of frames: [`Recording::add_if_due`] then adds a frame at the step nearest to each of
    /// these times. `simulation` is the run in its present state. A resumed recording already has all frames up to this
    /// state, so their times are skipped.
    pub fn at(mut self, times: Times, simulation: &Simulation) -> Self {
        let mut schedule = FrameSchedule::new(times);
        if self.last_step.is_some() {
            schedule.is_due(simulation);
        }
        self.schedule = Some(schedule);
        self
    }

    /// Adds a frame of the present state if the schedule asks for one. Without a call of [`Recording::at`], each call
    /// adds a frame. Also calls [`Recording::follow`]. Call this function at the start and after each step.
    ///
    /// # Errors
    /// If an earlier write failed.
    pub fn add_if_due(&mut self, simulation: &Simulation) -> Result<()> {
        self.follow(simulation);
        let is_due = self.schedule.as_mut().is_none_or(|schedule| schedule.is_due(simulation));
        if is_due { self.add(simulation.moment()) } else { Ok(()) }
    }

    /// Waits until all added data are in the files, and returns the numbers of frames and rows in the recording.
    ///
    /// # Errors
    /// If data could not be written.
    pub fn flush(&mut self) -> Result<RecordingMark> {
        self.send_rows()?;
        let (done, answer) = sync_channel(1);
        self.send(RecordingMessage::Flush(done))?;
        // If the writing thread has failed, no reply comes. Then `end` returns the error of that thread.
        answer.recv().or_else(|_| self.end().map(|()| RecordingMark::default()))
    }

    /// Ends the recording after all added data are in the files.
    ///
    /// # Errors
    /// If data could not be written.
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

    /// Ends the writing thread and returns its error. Later calls have no effect.
    fn end(&mut self) -> Result<()> {
        let Some(WriterThread { sender, thread }) = self.writer.take() else { return Ok(()) };
        drop(sender);
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Drop for Recording {
    fn drop(&mut self) {
        // The writing thread must end before the folder is unlocked for other processes. Its error is ignored here;
        // only `finish` reports it.
        if let Some(WriterThread { sender, thread }) = self.writer.take() {
            drop(sender);
            let _ = thread.join();
        }
    }
}

enum RecordingMessage {
    Steps(Vec<Observables>),
    /// A frame: the number of earlier frames, the snapshot, and the sums of contact forces since the previous frame.
    Frame(u64, Box<(Moment, ForceSums)>),
    /// Asks the thread to write the data of all earlier messages to the files and then to send the size of the
    /// recording.
    Flush(SyncSender<RecordingMark>),
}

/// Writer of the files of all formats, on a separate thread. Also writes the list of frames that all formats have
/// written.
struct FormatsWriter {
    formats: Vec<Box<dyn Format>>,
    index: TextTable,
    /// Frames that the formats have received but may not yet have written to their files.
    waiting: Vec<FrameRow>,
    /// Numbers of frames and rows that the formats have received so far.
    mark: RecordingMark,
}

impl FormatsWriter {
    /// Starts writing in a folder without a recording, or opens the recording that is already in it.
    fn start(folder: &Path, formats: &[FormatName], facts: &RunFacts) -> Result<Self> {
        let formats = formats.iter().map(|format| start_format(*format, folder, facts));
        let formats = formats.collect::<Result<_>>()?;
        let index = TextTable::new(folder.join(FRAMES), &RunFacts::default(), &frames(&[]));
        Ok(Self { formats, index, waiting: Vec::new(), mark: RecordingMark::default() })
    }

    /// Checks that the files have the frames and rows that `mark` counts up to step number `step`. Returns the number
    /// of frames up to that step, and the step of the last frame.
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

    /// Removes all data that were recorded after step number `step`. If data counted in `mark`, the size of the
    /// recording at that step, are missing, removes nothing and fails.
    fn roll_back(&mut self, step: u64, mark: &RecordingMark) -> Result<KeptRows> {
        let kept = self.check(step, mark)?;
        self.index.roll_back(kept.step)?;
        let mut formats = self.formats.iter_mut();
        formats.try_for_each(|format| format.roll_back(step, kept.step))?;
        self.mark = *mark;
        Ok(kept)
    }

    /// Writes the data of all messages until the channel closes. An error ends the recording, but the data written
    /// before the error remain.
    fn run(mut self, messages: &Receiver<RecordingMessage>) -> Result<()> {
        let taken = self.take_all(messages);
        // If a frame could not be added, the frames before it are complete and are still written.
        let flushed = if self.waiting.is_empty() { Ok(()) } else { self.flush() };
        let written = taken.and(flushed);
        // Every format is finished, even if another format has failed.
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
                // Sending fails if nobody waits for the reply any more, which does no harm.
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

/// Simulated times at which frames are recorded.
#[derive(Clone, Debug, PartialEq)]
pub enum Times {
    /// At time 0 and then at regular intervals of this length, s.
    Every(f64),
    /// At the listed simulated times, s, in ascending order.
    At(Vec<f64>),
}

impl Times {
    /// Returns the regular times of frames that the settings state. Without a stated interval, the default interval is
    /// used.
    pub fn of(settings: &DataSettings) -> Self {
        Self::Every(settings.every_secs.unwrap_or(DEFAULT_EVERY_SECS))
    }
}

/// Schedule of frames: decides after which steps of a run a frame is recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameSchedule {
    times: Times,
    next: usize,
}

impl FrameSchedule {
    /// Creates a schedule with a frame at the step nearest to each of the given times.
    pub fn new(times: Times) -> Self {
        Self { times, next: 0 }
    }

    /// True if a frame of the present state is to be recorded. Call this function once for each step, in order.
    pub fn is_due(&mut self, simulation: &Simulation) -> bool {
        let latest_secs = simulation.time_secs() + 0.5 * simulation.parameters().time_step_secs;
        let step = simulation.observables().step;
        self.is_due_at(step, latest_secs, |secs| simulation.step_at(secs))
    }

    /// True if a frame is to be recorded after step number `step`. `step_at` returns the number of the step that is
    /// nearest to a given simulated time (s). `latest_secs` is the end of the time interval (s) in which this step is
    /// the nearest one.
    fn is_due_at(&mut self, step: u64, latest_secs: f64, step_at: impl Fn(f64) -> u64) -> bool {
        let mut due = false;
        while self.next_secs().is_some_and(|secs| step_at(secs) <= step) {
            due = true;
            let before = self.next;
            self.next = match self.times {
                // Times that fall into the same step are skipped in one operation, because they may be many.
                Times::Every(secs) => {
                    before.saturating_add(1).max((latest_secs / secs).floor() as usize)
                }
                Times::At(_) => before + 1,
            };
            // The counter has reached its maximum, so a frame is due in every step.
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
