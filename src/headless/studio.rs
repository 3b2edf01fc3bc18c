//! What takes a run down: its table, its frames, its books, and the checkpoints from which all of them go on.

use std::ops::ControlFlow;
use std::path::Path;

use image::RgbaImage;

use super::HeadlessOptions;
use super::animations::Animations;
use super::checkpoint::{Checkpoints, Marks};
use super::data::told;
use super::kept::KeptStates;
use super::manifest::{Ended, Manifest, Moment, PictureEntry, RunEntry};
use super::table::ObservablesTable;
use super::telling::{
    go_on, interrupted, tell_of_alarms, tell_of_picked_method, tell_of_unconverged_steps,
};
use crate::config::{Provenance, SavedState, asked_time_secs};
use crate::data::Recording;
use crate::error::{Error, Result};
use crate::output::{Progress, Signal, Texts, caught_signal, counted, print_line};
use crate::render::{Camera, Renderer, Style, draw_scene};
use crate::scene::{Scene, View};
use crate::sim::{Observables, Simulation, Snapshot, Tally};
use crate::study::png::write_png;
use crate::study::{Recorded, Recorder};

/// Name of the run in the manifest.
const RUN: &str = "run";

/// Draws snapshots and keeps the books.
pub(super) struct Studio<'a> {
    options: &'a HeadlessOptions,
    scene: &'a Scene,
    progress: Progress,
    renderer: Renderer,
    style: Style,
    camera: Camera,
    table: Option<ObservablesTable>,
    animations: Animations,
    /// Colours and widths that follow the state need one scale for all frames, so those frames wait
    /// for the end of the run, unless it is given. All others are drawn as the run comes by.
    kept: Option<KeptStates>,
    recording: Option<Recording>,
    manifest: Manifest,
    provenance: Provenance,
    checkpoints: Option<Checkpoints>,
    /// Where the run begins, and where it has come to.
    marks: Marks,
}

impl<'a> Studio<'a> {
    /// Opens the books of a run that goes on from `marks` to step `end`.
    pub(super) fn open(
        options: &'a HeadlessOptions,
        renderer: Renderer,
        (scene, end, provenance): (&'a Scene, u64, Provenance),
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
        let studio = Self {
            options,
            scene,
            progress: Progress::new(&scene.name, end),
            camera: style.camera(min, max, size.width, size.height),
            table: folder.map(table).transpose()?,
            animations: Animations::start(options, &marks.pictures, |words| {
                options.texts_of_animation(&provenance, scene.duration_secs, &style, words)
            })?,
            kept: KeptStates::asked_for(options, &style, &marks, checkpoints.is_some())?,
            style,
            recording: None,
            manifest,
            provenance,
            renderer,
            checkpoints,
            marks,
        };
        studio.write_manifest()?;
        Ok(studio)
    }

    /// Has the run recorded as well.
    pub(super) fn record_in(&mut self, recording: Option<Recording>) {
        self.recording = recording;
    }

    fn end_recording(&mut self) -> Result<()> {
        let Some(recording) = self.recording.take() else { return Ok(()) };
        let told = told(recording.folder(), recording.frames());
        recording.finish()?;
        print_line(told);
        Ok(())
    }

    /// How far everything has come, once all of that is on the disk.
    fn marks(&mut self) -> Result<Marks> {
        // It knows itself what it has of which step.
        self.recording.as_mut().map_or(Ok(()), Recording::flush)?;
        Ok(Marks {
            table: self.table.as_mut().map_or(Ok(0), ObservablesTable::mark)?,
            waiting: self.kept.as_ref().map_or(Ok(0), KeptStates::mark)?,
            pictures: self.manifest.pictures.clone(),
            ..self.marks.clone()
        })
    }

    fn checkpoint(&mut self, simulation: &Simulation, tally: &Tally) -> Result<()> {
        if self.checkpoints.is_none() {
            return Ok(());
        }
        let marks = self.marks()?;
        let checkpoints = self.checkpoints.as_mut();
        checkpoints.map_or(Ok(()), |it| it.write(self.scene, (simulation, tally), marks))
    }

    /// Saves the run as it has ended, for the same command and for others.
    fn save(&mut self, recorded: &Recorded) -> Result<()> {
        let Recorded { simulation, tally, failure, .. } = recorded;
        let checkpoint = match failure {
            // There is a good one from before.
            Some(_) => Ok(()),
            None => self.checkpoint(simulation, tally),
        };
        let saved = match (&self.options.saving.save, failure) {
            (None, _) | (_, Some(Error::NonFinite { .. })) => Ok(()),
            (Some(path), _) => {
                let state = SavedState::new(self.scene.clone(), simulation.clone(), *tally);
                state.save(path).map(|()| print_line(path.display()))
            }
        };
        checkpoint.and(saved)
    }

    /// Ends the books of a run that has ended. Each part is tried, whatever became of those before; the first
    /// failure is told.
    pub(super) fn end(mut self, mut recorded: Recorded) -> Result<()> {
        self.progress.finish();
        let scene = self.scene;
        let signal = caught_signal().filter(|_| recorded.interrupted);
        let saved = self.save(&recorded);
        let table = self.table.take().map_or(Ok(()), ObservablesTable::finish);
        let recording = self.end_recording();
        recorded.failure = recorded.failure.or(saved.err()).or(table.err()).or(recording.err());
        self.manifest.runs[0].end(Ended::of(&recorded), &recorded);
        let (developed, signal) = match self.develop(signal) {
            Ok(signal) => (Ok(()), signal),
            Err(error) => (Err(error), signal),
        };
        let finished = self.finish();
        recorded.failure = recorded.failure.or(developed.err()).or(finished.err());

        tell_of_unconverged_steps(scene, &recorded.tally);
        tell_of_picked_method(scene, &recorded.simulation);
        tell_of_alarms(scene, recorded.simulation.alarms());
        match (recorded.failure, signal) {
            (Some(failure), _) => Err(failure),
            (None, Some(signal)) => Err(interrupted(signal, recorded.simulation.observables())),
            (None, None) => Ok(()),
        }
    }

    /// Draws the states that wait, those of a run that a signal ended too. A signal that comes now
    /// ends it; that or the run's is returned.
    fn develop(&mut self, ended_by: Option<Signal>) -> Result<Option<Signal>> {
        let Some(mut kept) = self.kept.take() else { return Ok(ended_by) };
        // This may take longer than whoever asked for the end is ready to wait.
        self.write_manifest()?;
        kept.set_scale(&mut self.style);
        let progress = Progress::new("drawing", kept.len() as u64);
        for index in 0..kept.len() {
            if let (None, Some(signal)) = (ended_by, caught_signal()) {
                self.manifest.runs[0].ended = Ended::Interrupted;
                return Ok(Some(signal));
            }
            let drawn = kept.get(index).and_then(|(number, state)| self.shoot(number, &state));
            drawn.inspect_err(|_| self.manifest.runs[0].ended = Ended::Failed)?;
            progress.advance(1);
        }
        progress.finish();
        Ok(ended_by)
    }

    fn shoot(&mut self, number: usize, snapshot: &Snapshot) -> Result<()> {
        let size = self.options.size()?;
        let image: RgbaImage = draw_scene(
            &mut self.renderer,
            snapshot,
            &self.style,
            &self.camera,
            size.width,
            size.height,
        )?;
        if let Some(folder) = &self.options.frames {
            let file = format!("frame_{number:05}.png");
            write_png(&folder.join(&file), &image, &self.texts(snapshot))?;
            let moment = Moment { run: RUN.to_owned(), observables: snapshot.observables };
            let entry = PictureEntry { file, shows: vec![moment] };
            self.manifest.add(entry, &folder.join("manifest.json"))?;
        }
        let (options, scene) = (self.options, self.scene);
        let (provenance, style) = (&self.provenance, &self.style);
        let told = |words: &[&str]| {
            options.texts_of_animation(provenance, scene.duration_secs, style, words)
        };
        self.animations.add(image, told)
    }

    fn texts(&self, snapshot: &Snapshot) -> Texts {
        let time_secs = asked_time_secs(snapshot.observables.time_secs);
        self.options.texts_of_frame(&self.provenance, time_secs, &self.style)
    }

    fn write_manifest(&self) -> Result<()> {
        let write = |folder: &Path| self.manifest.write(&folder.join("manifest.json"));
        self.options.frames.as_deref().map_or(Ok(()), write)
    }

    fn finish(mut self) -> Result<()> {
        let animations = std::mem::take(&mut self.animations).finish();
        self.write_manifest()?;
        // Where the run is complete, nothing is left to go on with.
        if self.manifest.runs[0].ended == Ended::Complete
            && let (Ok(_), Some(checkpoints)) = (&animations, self.checkpoints.take())
        {
            checkpoints.remove()?;
        }
        if let Some(folder) = &self.options.frames {
            let count = counted(self.manifest.pictures.len() as u64, "picture");
            print_line(format_args!("{count} in {}", folder.display()));
        }
        animations?.tell(self.options);
        Ok(())
    }
}

impl Recorder for Studio<'_> {
    fn step(&mut self, observables: &Observables) -> Result<ControlFlow<()>> {
        self.progress.set(observables.step);
        self.table.as_mut().map_or(Ok(()), |table| table.add(observables))?;
        let recording = self.recording.as_mut();
        recording.map_or(Ok(()), |recording| recording.add_step(observables))?;
        Ok(go_on())
    }

    fn state(&mut self, simulation: &Simulation, tally: &Tally) -> Result<()> {
        // Before the checkpoint, which is to have it.
        let recording = self.recording.as_mut();
        recording.map_or(Ok(()), |recording| recording.add_if_due(simulation))?;
        let is_due = self.checkpoints.as_ref().is_some_and(|it| it.is_due(simulation));
        if is_due { self.checkpoint(simulation, tally) } else { Ok(()) }
    }

    fn picture(&mut self, number: usize, snapshot: Snapshot) -> Result<()> {
        self.table.as_mut().map_or(Ok(()), ObservablesTable::flush)?;
        match &mut self.kept {
            Some(kept) => kept.add(&self.style, number, snapshot),
            None => self.shoot(number, &snapshot),
        }?;
        self.marks.next_picture = number + 1;
        Ok(())
    }
}
