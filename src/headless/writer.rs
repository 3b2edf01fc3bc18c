//! The outputs of a run: table, pictures, animations, recording (files of grains and contacts) and manifest, and the
//! checkpoints with which an interrupted run and its outputs are resumed.

use std::ops::ControlFlow;
use std::path::Path;

use image::RgbaImage;

use super::HeadlessOptions;
use super::folder::{Checkpoints, Marks};
use super::manifest::{Manifest, PictureEntry, RunEntry, RunStatus, ShownMoment};
use super::options::PictureSize;
use super::table::ObservablesTable;
use super::waiting::WaitingStates;
use crate::config::{Provenance, SavedState, asked_time_secs};
use crate::data::Recording;
use crate::error::{Error, Result, legible};
use crate::film::{Animation, Video};
use crate::output::{Progress, Signal, caught_signal, counted, note_line, print_line};
use crate::render::{Camera, Renderer, Style, draw_scene};
use crate::scene::{Scene, View};
use crate::sim::{Alarm, AlarmKind, Observables, Simulation, Snapshot, Tally};
use crate::solver::{CONTACTS_THAT_FLOW, Method};
use crate::study::png::write_png;
use crate::study::{Recorded, Recorder};

const RUN: &str = "run";
/// Frame rate of a GIF, Hz, which common viewers can display.
const GIF_RATE_HZ: f64 = 25.0;

pub(super) struct RunWriter<'a> {
    options: &'a HeadlessOptions,
    scene: &'a Scene,
    progress: Progress,
    renderer: Renderer,
    style: Style,
    camera: Camera,
    table: Option<ObservablesTable>,
    gif: Option<Animation>,
    video: Option<Video>,
    /// Snapshots that are drawn at the end of the run, because their colours and line widths need one common scale;
    /// `None` if the scales are given, so that pictures are drawn during the run.
    waiting: Option<WaitingStates>,
    pub recording: Option<Recording>,
    manifest: Manifest,
    provenance: Provenance,
    checkpoints: Option<Checkpoints>,
    /// Lengths of the outputs at the beginning of the run. Only `next_picture` is updated during the run.
    marks: Marks,
}

impl<'a> RunWriter<'a> {
    /// Opens the outputs of a run that ends at the step number `end`. If the run is resumed, the outputs continue from
    /// the lengths in `marks`.
    pub(super) fn open(
        options: &'a HeadlessOptions,
        renderer: Renderer,
        scene: &'a Scene,
        end: u64,
        provenance: Provenance,
        marks: Marks,
        checkpoints: Option<Checkpoints>,
    ) -> Result<Self> {
        let size = options.size()?;
        let View { min, max } = scene.view();
        let style = options.style()?;
        let mut manifest = Manifest::new(renderer.name());
        manifest.pictures.clone_from(&marks.pictures);
        manifest.runs.push(RunEntry {
            restarted_from: marks.restarted_from,
            went_on_at: marks.went_on_at.clone(),
            ..RunEntry::start(RUN, scene)?
        });
        let folder = options.frames.as_deref();
        let table = |folder: &Path| match marks.went_on_at.is_empty() {
            true => ObservablesTable::start(folder),
            false => ObservablesTable::go_on(folder, marks.table),
        };
        let rate_hz = options.video_rate_hz()?;
        let film = |path: &Path| Video::start(path, rate_hz);
        let animate = |path: &Path| Animation::start(path, GIF_RATE_HZ);
        let mut writer = Self {
            options,
            scene,
            progress: Progress::new(&scene.name, end),
            camera: style.camera(min, max, size.width, size.height),
            table: folder.map(table).transpose()?,
            gif: options.gif.as_deref().map(animate).transpose()?,
            video: options.video.as_deref().map(film).transpose()?,
            waiting: WaitingStates::asked_for(options, &style, &marks, checkpoints.is_some())?,
            style,
            recording: None,
            manifest,
            provenance,
            renderer,
            checkpoints,
            marks,
        };
        writer.animate_earlier_pictures()?;
        writer.write_manifest()?;
        Ok(writer)
    }

    /// Adds the pictures that a resumed run drew before it was interrupted to the GIF and the video, which are written
    /// again from their beginning.
    fn animate_earlier_pictures(&mut self) -> Result<()> {
        if self.gif.is_none() && self.video.is_none() {
            return Ok(());
        }
        let folder = self.options.frames.as_deref().unwrap_or(Path::new(""));
        for PictureEntry { file, .. } in &self.marks.pictures.clone() {
            let path = folder.join(file);
            let image = image::open(&path).map_err(|error| Error::file(&path, error))?;
            self.animate(image.into_rgba8())?;
        }
        Ok(())
    }

    fn end_recording(&mut self) -> Result<()> {
        let Some(recording) = self.recording.take() else { return Ok(()) };
        let sentence = recording_sentence(recording.folder(), recording.frames());
        recording.finish()?;
        print_line(sentence);
        Ok(())
    }

    /// Flushes all outputs to the disk and returns their lengths, for a checkpoint.
    fn marks(&mut self) -> Result<Marks> {
        // The recording counts its own frames and rows; `flush` returns these numbers when the data are in the files.
        let recording = self.recording.as_mut().map(Recording::flush).transpose()?;
        Ok(Marks {
            table: self.table.as_mut().map_or(Ok(0), ObservablesTable::mark)?,
            waiting: self.waiting.as_ref().map_or(Ok(0), WaitingStates::mark)?,
            pictures: self.manifest.pictures.clone(),
            recording: recording.unwrap_or_default(),
            sums: self.recording.as_ref().map(|it| it.sums().clone()).unwrap_or_default(),
            ..self.marks.clone()
        })
    }

    fn checkpoint(&mut self, simulation: &Simulation, tally: &Tally) -> Result<()> {
        if self.checkpoints.is_none() {
            return Ok(());
        }
        let marks = self.marks()?;
        let checkpoints = self.checkpoints.as_mut();
        checkpoints.map_or(Ok(()), |it| it.write(self.scene, simulation, tally, marks))
    }

    /// Saves the final state of the run, as a checkpoint for the same command and in the file that the option `--save`
    /// names.
    fn save(&mut self, recorded: &Recorded) -> Result<()> {
        let Recorded { simulation, tally, failure, .. } = recorded;
        let checkpoint = match failure {
            // The previous checkpoint is still valid.
            Some(_) => Ok(()),
            None => self.checkpoint(simulation, tally),
        };
        let saved = match (&self.options.save, failure) {
            (None, _) | (_, Some(Error::NonFinite { .. })) => Ok(()),
            (Some(path), _) => {
                let state = SavedState::new(self.scene.clone(), simulation.clone(), *tally);
                state.save(path).map(|()| print_line(path.display()))
            }
        };
        checkpoint.and(saved)
    }

    /// Finishes all outputs of a run. If one output fails, the others are still finished; the first failure is
    /// returned.
    pub(super) fn end(mut self, mut recorded: Recorded) -> Result<()> {
        self.progress.finish();
        let scene = self.scene;
        let signal = caught_signal().filter(|_| recorded.interrupted);
        let saved = self.save(&recorded);
        let table = self.table.take().map_or(Ok(()), ObservablesTable::finish);
        let recording = self.end_recording();
        recorded.failure = recorded.failure.or(saved.err()).or(table.err()).or(recording.err());
        self.manifest.runs[0].end(RunStatus::of(&recorded), &recorded);
        let (drawn, signal) = match self.draw_waiting(signal) {
            Ok(signal) => (Ok(()), signal),
            Err(error) => (Err(error), signal),
        };
        let finished = self.finish();
        recorded.failure = recorded.failure.or(drawn.err()).or(finished.err());

        tell_of_unconverged_steps(scene, &recorded.tally);
        tell_of_picked_method(scene, &recorded.simulation);
        tell_of_alarms(scene, recorded.simulation.alarms());
        match (recorded.failure, signal) {
            (Some(failure), _) => Err(failure),
            (None, Some(signal)) => Err(interrupted(signal, recorded.simulation.observables())),
            (None, None) => Ok(()),
        }
    }

    /// Draws the snapshots that were kept until the end of the run, even if a signal has ended the run. A signal that
    /// arrives during the drawing ends the drawing. Returns the signal that ended the run or the drawing, if there was
    /// one.
    fn draw_waiting(&mut self, ended_by: Option<Signal>) -> Result<Option<Signal>> {
        let Some(mut waiting) = self.waiting.take() else { return Ok(ended_by) };
        // The manifest is written first. Drawing may take longer than the sender of the signal waits before it kills
        // the process.
        self.write_manifest()?;
        waiting.set_scale(&mut self.style);
        let progress = Progress::new("drawing", waiting.len() as u64);
        for index in 0..waiting.len() {
            if let (None, Some(signal)) = (ended_by, caught_signal()) {
                self.manifest.runs[0].ended = RunStatus::Interrupted;
                return Ok(Some(signal));
            }
            let drawn = waiting.get(index).and_then(|(number, state)| self.draw(number, &state));
            drawn.inspect_err(|_| self.manifest.runs[0].ended = RunStatus::Failed)?;
            progress.advance(1);
        }
        progress.finish();
        Ok(ended_by)
    }

    fn draw(&mut self, number: usize, snapshot: &Snapshot) -> Result<()> {
        let PictureSize { width, height } = self.options.size()?;
        let (style, camera) = (&self.style, &self.camera);
        let image = draw_scene(&mut self.renderer, snapshot, style, camera, width, height)?;
        if let Some(folder) = &self.options.frames {
            let file = format!("frame_{number:05}.png");
            let time_secs = asked_time_secs(snapshot.observables.time_secs);
            let texts = self.options.texts_of_frame(&self.provenance, time_secs, &self.style);
            write_png(&folder.join(&file), &image, &texts)?;
            let moment = ShownMoment { run: RUN.to_owned(), observables: snapshot.observables };
            let entry = PictureEntry { file, shows: vec![moment] };
            self.manifest.add(entry, &folder.join("manifest.json"))?;
        }
        self.animate(image)
    }

    /// Adds a picture to the GIF and the video. Each file contains the command that reproduces it.
    fn animate(&mut self, image: RgbaImage) -> Result<()> {
        let Self { options, scene, provenance, style, .. } = self;
        let texts = |words: &[&str]| {
            options.texts_of_animation(provenance, scene.duration_secs, style, words)
        };
        let video_texts = texts(&["--video", "video.mp4"]);
        let gif_texts = texts(&["--gif", "animation.gif"]);
        let video = self.video.as_mut().map_or(Ok(()), |video| video.add(&image, &video_texts));
        let gif = self.gif.as_mut().map_or(Ok(()), |gif| gif.add(image, &gif_texts));
        video.and(gif)
    }

    fn write_manifest(&self) -> Result<()> {
        let write = |folder: &Path| self.manifest.write(&folder.join("manifest.json"));
        self.options.frames.as_deref().map_or(Ok(()), write)
    }

    fn finish(mut self) -> Result<()> {
        let video = self.video.take().map_or(Ok(false), Video::finish);
        let gif = self.gif.take().map_or(Ok(false), Animation::finish);
        self.write_manifest()?;
        // A complete run needs no checkpoint.
        if self.manifest.runs[0].ended == RunStatus::Complete
            && let (Ok(_), Ok(_), Some(checkpoints)) = (&video, &gif, self.checkpoints.take())
        {
            checkpoints.remove()?;
        }
        if let Some(folder) = &self.options.frames {
            let count = counted(self.manifest.pictures.len() as u64, "picture");
            print_line(format_args!("{count} in {}", folder.display()));
        }
        for (is_there, path) in [(gif?, &self.options.gif), (video?, &self.options.video)] {
            path.iter().filter(|_| is_there).for_each(|path| print_line(path.display()));
        }
        Ok(())
    }
}

impl Recorder for RunWriter<'_> {
    fn step(&mut self, observables: &Observables) -> Result<ControlFlow<()>> {
        self.progress.set(observables.step);
        self.table.as_mut().map_or(Ok(()), |table| table.add(observables))?;
        let recording = self.recording.as_mut();
        recording.map_or(Ok(()), |recording| recording.add_step(observables))?;
        Ok(go_on())
    }

    fn state(&mut self, simulation: &Simulation, tally: &Tally) -> Result<()> {
        // The recording comes before the checkpoint, because the checkpoint contains the mark of the recording.
        let recording = self.recording.as_mut();
        recording.map_or(Ok(()), |recording| recording.add_if_due(simulation))?;
        let is_due = self.checkpoints.as_ref().is_some_and(|it| it.is_due(simulation));
        if is_due { self.checkpoint(simulation, tally) } else { Ok(()) }
    }

    fn picture(&mut self, number: usize, snapshot: Snapshot) -> Result<()> {
        self.table.as_mut().map_or(Ok(()), ObservablesTable::flush)?;
        match &mut self.waiting {
            Some(waiting) => waiting.add(&self.style, number, snapshot),
            None => self.draw(number, &snapshot),
        }?;
        self.marks.next_picture = number + 1;
        Ok(())
    }
}

/// Returns a sentence for the user with the folder of a finished recording (files of grains and contacts) and the
/// number of its frames (recorded states).
pub(crate) fn recording_sentence(folder: &Path, frames: u64) -> String {
    format!("{} of data in {}", counted(frames, "frame"), folder.display())
}

/// Returns `Continue` as long as no signal (such as Ctrl+C) has arrived, then `Break`.
pub(super) fn go_on() -> ControlFlow<()> {
    caught_signal().map_or(ControlFlow::Continue(()), |_| ControlFlow::Break(()))
}

/// Returns the error for a run that a signal ended. `last` contains the observables (measured quantities) of the run's
/// last step.
pub(super) fn interrupted(signal: Signal, last: &Observables) -> Error {
    let (signal, exit_code) = (signal.name(), signal.exit_code());
    Error::Interrupted { signal, exit_code, step: last.step, time_secs: last.time_secs }
}

/// Reports warnings about the run on stderr, each with the change of settings that is most likely to help. The warning
/// that the state is no longer finite is left out, because this ends the run with an error.
pub(super) fn tell_of_alarms(scene: &Scene, alarms: &[Alarm]) {
    for alarm in alarms.iter().filter(|alarm| alarm.kind != AlarmKind::NotFinite) {
        note_line(format_args!("{}: {}", scene.name, alarm.message(&scene.settings())));
    }
}

/// Reports on stderr how many steps were not solved to the tolerance.
pub(super) fn tell_of_unconverged_steps(scene: &Scene, tally: &Tally) {
    let Tally { steps, unconverged_steps, stalled_steps, largest_velocity_error, .. } = *tally;
    // A stepper without a solver method has neither a tolerance nor a limit of sweeps.
    if unconverged_steps == 0 || !scene.stepper.uses_method() {
        return;
    }
    // `auto` may stop before the limit of sweeps.
    let within = match scene.solver.method {
        Method::Auto => String::new(),
        _ => format!(" within {} sweeps", scene.solver.max_sweeps),
    };
    note_line(legible(&format!(
        "{} (Bond {}, time step {} s): {unconverged_steps} of {steps} steps did not reach tolerance \
         {:e}{within}, {stalled_steps} of them stalled (more sweeps would be of no use); velocities are \
         off by some {:.2} mm/s at most",
        scene.name,
        scene.parameters.bond,
        scene.parameters.time_step_secs,
        scene.solver.tolerance,
        1e3 * largest_velocity_error,
    )));
}

/// Reports on stderr which method the solver `auto` chose for the last step.
fn tell_of_picked_method(scene: &Scene, simulation: &Simulation) {
    if scene.stepper.uses_method() && scene.solver.method == Method::Auto {
        let contacts = simulation.contacts().contacts().len();
        let method = simulation.picked_method();
        let of_flowing = match method == Method::Newton && contacts >= CONTACTS_THAT_FLOW {
            true => ", and over-relaxed sweeps for steps in which the pile flows",
            false => "",
        };
        note_line(format_args!("auto took {method} for {contacts} contacts{of_flowing}"));
    }
}
