//! Frames of one scene, with observables and manifest beside them.

use std::ops::ControlFlow;
use std::path::Path;

use image::RgbaImage;

use super::HeadlessOptions;
use super::folder::{Earlier, RunFolder};
use super::gif::Animation;
use super::kept::KeptStates;
use super::manifest::{Ended, Manifest, Moment, PictureEntry, RunEntry};
use super::table::ObservablesTable;
use crate::error::{Error, Result};
use crate::output::{
    Progress, Signal, caught_signal, check_file, note_line, print_line, warn_of_steps, write_png,
};
use crate::render::{Camera, ColourBy, Renderer, Style, draw_scene};
use crate::scene::{Config, Scene, Settling, View};
use crate::sim::{Alarm, AlarmKind, Observables, Snapshot};
use crate::solver::{Method, picked};
use crate::study::{Recorder, record};

/// Name of the run in the manifest.
const RUN: &str = "run";

/// Simulates the scene and draws its frames.
pub(super) fn draw(config: &Config, options: &HeadlessOptions, earlier: Earlier) -> Result<()> {
    let size = options.size()?;
    let start = config.without_settling()?;
    options.picture_times(start.duration_secs)?;
    // Shapes that are none and discs in one place are told of before anything is written.
    start.simulation()?;
    let renderer = Renderer::new(options.renderer)?;
    renderer.check_size(size.width, size.height)?;
    let claim = |path: &Path| RunFolder::claim(path, earlier);
    let folder = options.frames.as_deref().map(claim).transpose()?;
    options.gif.as_deref().map(check_file).transpose()?;
    let scene = settled(config).map_err(|error| match caught_signal() {
        Some(signal) => interrupted(signal, &Observables::default()),
        None => error,
    })?;
    let times = options.picture_times(scene.duration_secs)?;
    // Times alone ask for no more than the last of them.
    let until_secs = match times.last() {
        Some(&last) if !options.times.is_empty() && config.origin.duration.is_none() => last,
        _ => scene.duration_secs,
    };
    folder.as_ref().map(RunFolder::clear).transpose()?;
    note_line(format_args!("drawing with {}", renderer.name()));

    warn_of_steps(scene.parameters.steps_in(until_secs));
    let mut studio = Studio::open(options, renderer, &scene, until_secs)?;
    let mut recorded = record(&scene, &times, until_secs, &mut studio)?;
    studio.progress.finish();
    let signal = caught_signal().filter(|_| recorded.interrupted);
    // Each is tried, whatever became of those before; the first failure is told.
    let table = studio.table.take().map_or(Ok(()), ObservablesTable::finish);
    recorded.failure = recorded.failure.or(table.err());
    studio.manifest.runs[0].end(Ended::of(&recorded), &recorded);
    let (developed, signal) = match studio.develop(signal) {
        Ok(signal) => (Ok(()), signal),
        Err(error) => (Err(error), signal),
    };
    let finished = studio.finish();
    recorded.failure = recorded.failure.or(developed.err()).or(finished.err());

    tell_of_unconverged_steps(&scene, &recorded.tally);
    if scene.solver.method == Method::Auto {
        let contacts = recorded.simulation.contacts().contacts().len();
        let name = picked(&scene.solver, contacts).name();
        note_line(format_args!("auto took {name} for {contacts} contacts"));
    }
    tell_of_alarms(&scene, recorded.simulation.alarms());
    match (recorded.failure, signal) {
        (Some(failure), _) => Err(failure),
        (None, Some(signal)) => Err(interrupted(signal, recorded.simulation.observables())),
        (None, None) => Ok(()),
    }
}

/// Whether a run goes on: until a signal comes.
pub(super) fn go_on() -> ControlFlow<()> {
    caught_signal().map_or(ControlFlow::Continue(()), |_| ControlFlow::Break(()))
}

/// That a signal ended the run after its last step.
pub(super) fn interrupted(signal: Signal, last: &Observables) -> Error {
    let (signal, exit_code) = (signal.name(), signal.exit_code());
    Error::Interrupted { signal, exit_code, step: last.step, time_secs: last.time_secs }
}

/// Says on stderr what went wrong, and what is most likely to help. A state that is no longer finite
/// ends the run with an error of its own.
pub(super) fn tell_of_alarms(scene: &Scene, alarms: &[Alarm]) {
    for alarm in alarms.iter().filter(|alarm| alarm.kind != AlarmKind::NotFinite) {
        note_line(format_args!("{}: {}", scene.name, alarm.message(&scene.settings())));
    }
}

/// Says on stderr how many steps were not solved as asked.
pub(super) fn tell_of_unconverged_steps(scene: &Scene, tally: &crate::sim::Tally) {
    if tally.unconverged_steps > 0 {
        note_line(format_args!(
            "{} (Bond {}, time step {} s): {} of {} steps did not reach tolerance {:e} within {} \
             sweeps, {} of them stalled (more sweeps would be of no use); largest residual {:.1e}",
            scene.name,
            scene.parameters.bond,
            scene.parameters.time_step_secs,
            tally.unconverged_steps,
            tally.steps,
            scene.solver.tolerance,
            scene.solver.max_sweeps,
            tally.stalled_steps,
            tally.largest_residual
        ));
    }
}

/// The scene, with progress shown where a new pile has to settle first.
pub(crate) fn settled(config: &Config) -> Result<Scene> {
    let progress = Progress::new("settling", 100);
    let scene = config.scene(|Settling { time_secs, limit_secs, .. }| {
        progress.set((100.0 * time_secs / limit_secs) as u64);
        caught_signal().is_none()
    });
    progress.finish();
    scene
}

/// Draws snapshots and keeps the books.
struct Studio<'a> {
    options: &'a HeadlessOptions,
    progress: Progress,
    renderer: Renderer,
    style: Style,
    camera: Camera,
    table: Option<ObservablesTable>,
    animation: Option<Animation>,
    /// Colours and widths that follow the state need one scale for all frames, so those frames wait
    /// for the end of the run. All others are drawn as the run comes by.
    kept: Option<KeptStates>,
    manifest: Manifest,
}

impl<'a> Studio<'a> {
    fn open(
        options: &'a HeadlessOptions,
        renderer: Renderer,
        scene: &Scene,
        until_secs: f64,
    ) -> Result<Self> {
        let size = options.size()?;
        let View { min, max } = scene.view();
        let style = options.style();
        let mut manifest = Manifest::new(renderer.name());
        manifest.runs.push(RunEntry::start(RUN, scene)?);
        let by_state = !matches!(style.colour_by, ColourBy::PaperGreys | ColourBy::Coordination);
        let waits = style.show_forces || by_state;
        let beside_gif = options.gif.as_deref().and_then(Path::parent);
        let keep_in = options.frames.as_deref().or(beside_gif).filter(|_| waits);
        let studio = Self {
            options,
            progress: Progress::new(&scene.name, scene.parameters.steps_in(until_secs)),
            camera: style.camera(min, max, size.width, size.height),
            style,
            table: options.frames.as_deref().map(ObservablesTable::start).transpose()?,
            animation: options.gif.as_deref().map(Animation::start).transpose()?,
            kept: keep_in.map(KeptStates::start).transpose()?,
            manifest,
            renderer,
        };
        studio.write_manifest()?;
        Ok(studio)
    }

    /// Draws the states that wait, those of a run that a signal ended too. A signal that comes now
    /// ends it; that or the run's is returned.
    fn develop(&mut self, ended_by: Option<Signal>) -> Result<Option<Signal>> {
        let Some(mut kept) = self.kept.take() else { return Ok(ended_by) };
        // This may take longer than whoever asked for the end is ready to wait.
        self.write_manifest()?;
        kept.set_scale(&mut self.style);
        let progress = Progress::new("drawing", kept.len() as u64);
        for number in 0..kept.len() {
            if let (None, Some(signal)) = (ended_by, caught_signal()) {
                self.manifest.runs[0].ended = Ended::Interrupted;
                return Ok(Some(signal));
            }
            let drawn = kept.get(number).and_then(|snapshot| self.shoot(number, &snapshot));
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
            write_png(&folder.join(&file), &image)?;
            let moment = Moment { run: RUN.to_owned(), observables: snapshot.observables };
            self.manifest.pictures.push(PictureEntry { file, shows: vec![moment] });
        }
        match &mut self.animation {
            Some(animation) => animation.add(image),
            None => Ok(()),
        }
    }

    fn write_manifest(&self) -> Result<()> {
        let write = |folder: &Path| self.manifest.write(&folder.join("manifest.json"));
        self.options.frames.as_deref().map_or(Ok(()), write)
    }

    fn finish(mut self) -> Result<()> {
        let animation = self.animation.take().map_or(Ok(false), Animation::finish);
        self.write_manifest()?;
        if let Some(folder) = &self.options.frames {
            let count = self.manifest.pictures.len();
            print_line(format_args!("{count} pictures in {}", folder.display()));
        }
        if let (true, Some(path)) = (animation?, &self.options.gif) {
            print_line(path.display());
        }
        Ok(())
    }
}

impl Recorder for Studio<'_> {
    fn step(&mut self, observables: &Observables) -> Result<ControlFlow<()>> {
        self.progress.set(observables.step);
        self.table.as_mut().map_or(Ok(()), |table| table.add(observables))?;
        Ok(go_on())
    }

    fn picture(&mut self, number: usize, snapshot: Snapshot) -> Result<()> {
        self.table.as_mut().map_or(Ok(()), ObservablesTable::flush)?;
        match &mut self.kept {
            Some(kept) => kept.add(&self.style, snapshot),
            None => self.shoot(number, &snapshot),
        }
    }
}
