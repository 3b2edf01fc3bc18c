//! The run of one scene: where it begins, with a scene at t = 0 or with a run that was saved, and what it writes.

use std::path::PathBuf;

use super::HeadlessOptions;
use super::folder::{Checkpoints, EarlierFiles, check_run_folder, clear_run_folder};
use super::manifest::Instant;
use super::writer::{RunWriter, interrupted};
use crate::config::{Config, SavedState, scene_facts};
use crate::data::{DataSettings, Recording, RunFacts, Times, check_recording_folder, formats_of};
use crate::error::{Error, Result};
use crate::output::{Progress, caught_signal, check_file, warn_of_steps};
use crate::render::check_size;
use crate::scene::{Scene, Settling};
use crate::sim::{Observables, Tally};
use crate::study::{OnItsWay, go_on};

/// Simulates the scene, or lets a saved run go on, and draws the frames.
pub(super) fn draw(
    config: &Config,
    options: &HeadlessOptions,
    earlier: EarlierFiles,
) -> Result<()> {
    let size = options.size()?;
    options.style()?;
    options.video_rate_hz()?;
    let asked = RequestedRun::of(config, options)?;
    let PictureSchedule { times_secs, until_secs } = asked.schedule(config, options)?;
    let data = options.data_settings(asked.scene())?;
    check_size(size.width, size.height)?;
    let folder = options.frames.as_deref();
    folder.map(|folder| check_run_folder(folder, earlier)).transpose()?;
    let files = [("gif", &options.gif), ("video", &options.video), ("save", &options.save)];
    for (option, path) in files {
        path.as_deref().map(|path| check_file(option, path)).transpose()?;
    }
    let picture_times_secs = options.picture_times(asked.scene().duration_secs)?;
    if let Some((path, _)) = &data {
        check_recording_folder(path, options.overwrite)?;
    }
    let begun = asked.begin(config).map_err(|error| match caught_signal() {
        Some(signal) => interrupted(signal, &Observables::default()),
        None => error,
    });
    let (SavedState { scene, simulation, tally }, restarted_from) = begun?;
    let now = simulation.observables().step;
    let next_picture = times_secs.partition_point(|&secs| simulation.step_at(secs) < now);
    folder.map(|folder| clear_run_folder(folder, earlier)).transpose()?;

    let steps = simulation.step_at(until_secs);
    warn_of_steps(steps.saturating_sub(now));
    let checkpoints = folder.zip(options.checkpoint_every);
    let checkpoints =
        checkpoints.map(|(folder, every_secs)| Checkpoints::start(folder, every_secs, &simulation));
    let start = |(path, data): (PathBuf, DataSettings)| {
        let times = data.every_secs.map_or(Times::At(picture_times_secs), Times::Every);
        let formats = formats_of(&data)?;
        let recording =
            Recording::start(&path, &formats, &run_facts_of(&scene)?, options.overwrite)?;
        Ok(recording.at(times))
    };
    let recording = data.map(start).transpose()?;
    let provenance = options.provenance(config, &scene)?;
    let mut writer = RunWriter::open(options, &scene, steps, provenance, restarted_from)?;
    (writer.recording, writer.checkpoints) = (recording, checkpoints);
    let run = OnItsWay { simulation, tally, next_picture };
    let recorded = go_on(run, &times_secs, until_secs, &mut writer);
    writer.end(recorded)
}

/// What a recording says of a run: its scene, and the command line.
fn run_facts_of(scene: &Scene) -> Result<RunFacts> {
    let mut about = scene_facts(scene)?;
    let words = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
    let command = words.collect::<Vec<_>>().join(" ").replace(char::is_control, " ");
    about.facts.insert(1, ("command".to_owned(), command));
    Ok(about)
}

/// What is asked for, read and checked, but for grains that have to settle.
enum RequestedRun {
    /// A scene from t = 0 on, with its grains where they start from.
    Scene(Box<Scene>),
    /// A run that was saved, with the changes asked for.
    Run(Box<SavedState>),
}

/// When pictures are taken, and when the run ends, s.
struct PictureSchedule {
    times_secs: Vec<f64>,
    until_secs: f64,
}

impl RequestedRun {
    fn of(config: &Config, options: &HeadlessOptions) -> Result<Self> {
        options.check_checkpoints()?;
        let Some(path) = &options.restart else {
            let start = config.without_settling()?;
            // Shapes that are none and discs in one place are told of before anything is written.
            start.simulation()?;
            return Ok(Self::Scene(Box::new(start)));
        };
        let mut state = SavedState::open(path)?;
        config.change_state(&mut state)?;
        Ok(Self::Run(Box::new(state)))
    }

    fn scene(&self) -> &Scene {
        match self {
            Self::Scene(scene) => scene,
            Self::Run(state) => &state.scene,
        }
    }

    fn schedule(&self, config: &Config, options: &HeadlessOptions) -> Result<PictureSchedule> {
        let times_secs = options.picture_times(self.scene().duration_secs)?;
        // Times alone ask for no more than the last of them.
        let until_secs = match times_secs.last() {
            Some(&last) if !options.times.is_empty() && config.source.duration.is_none() => last,
            _ => self.scene().duration_secs,
        };
        let times_secs = if options.draws() { times_secs } else { Vec::new() };
        let schedule = PictureSchedule { times_secs, until_secs };
        let Self::Run(state) = self else { return Ok(schedule) };
        let now_secs = state.simulation.time_secs();
        let allowed = format!("after the {now_secs} s that the saved run has come to");
        let (first, last) = (options.times.iter().copied().reduce(f64::min), schedule.until_secs);
        let is_past =
            |secs: f64| state.simulation.step_at(secs) < state.simulation.observables().step;
        match first {
            Some(first) if is_past(first) => Err(Error::value("times", first, allowed)),
            _ if state.simulation.step_at(last) <= state.simulation.observables().step => {
                Err(Error::value("duration", last, allowed))
            }
            _ => Ok(schedule),
        }
    }

    /// The run, once its grains have settled, and the moment of the saved one that it goes on with.
    fn begin(self, config: &Config) -> Result<(SavedState, Option<Instant>)> {
        match self {
            Self::Scene(_) => {
                let scene = settled(config)?;
                let simulation = scene.simulation()?;
                Ok((SavedState::new(scene, simulation, Tally::default()), None))
            }
            Self::Run(state) => {
                let now = Instant::of(state.simulation.observables());
                Ok((*state, Some(now)))
            }
        }
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
