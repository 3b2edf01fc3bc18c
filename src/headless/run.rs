//! Runs one scene without a window. The run starts from the scene at t = 0, from a saved run, or from the checkpoint
//! that the same command wrote into its folder.

use std::path::{Path, PathBuf};

use super::HeadlessOptions;
use super::folder::{Beginning, Checkpoints, EarlierFiles, Marks, RunFolder, check_apart, look};
use super::manifest::Instant;
use super::writer::{RunWriter, interrupted};
use crate::config::{Config, SavedState, scene_facts};
use crate::data::{DataSettings, Recording, RecordingFolder, RecordingMark, Times, formats_of};
use crate::error::{Error, Result};
use crate::film::check_ending;
use crate::output::{Progress, caught_signal, check_new_file, note_line, warn_of_steps};
use crate::render::{Renderer, RendererChoice};
use crate::scene::{Scene, Settling};
use crate::sim::{Observables, Simulation, Tally};
use crate::study::{OnItsWay, go_on as go_on_with};

/// Simulates the scene, or resumes a saved run, and writes all outputs that the options name.
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
    tell_of_unread_settings(config, asked.scene());
    options.check_places(data.as_ref().map(|(_, settings)| settings))?;
    let choice = if options.draws() { options.renderer } else { RendererChoice::Cpu };
    let renderer = Renderer::new(choice)?;
    renderer.check_size(size.width, size.height)?;
    let lock = |path: &Path| RunFolder::lock(path, earlier);
    let folder = options.frames.as_deref().map(lock).transpose()?;
    let every_secs = options.checkpoint_every;
    let fingerprint = every_secs.map(|_| asked.fingerprint(config, options)).transpose()?;
    let found = left_in(folder.as_ref(), fingerprint.as_deref())?;
    let mut places = options.files();
    // A resumed run replaces the files that it left when it was stopped.
    let replaces = options.overwrite || found.is_some();
    places.iter().try_for_each(|(option, path)| check_new_file(option, path, replaces))?;
    // The recording may be in the same folder as the pictures.
    places.extend(data.as_ref().map(|(folder, _)| ("data", &**folder)));
    check_apart(&places, options.frames.as_deref())?;
    if let Some(gif) = options.gif.as_deref().filter(|path| path.extension().is_some()) {
        check_ending("gif", gif, "gif", "--video makes MP4")?;
    }
    let picture_times_secs = match &data {
        Some((_, settings)) if settings.every_secs.is_none() => {
            options.picture_times(asked.scene().duration_secs)?
        }
        _ => Vec::new(),
    };
    let claim = |(folder, settings): (PathBuf, DataSettings)| -> Result<RecordingPlan> {
        // A resumed run continues its own recording, so it claims no folder.
        let of_new = found.is_none().then(|| RecordingFolder::of(&folder, options.overwrite));
        Ok(RecordingPlan { claim: of_new.transpose()?, folder, settings })
    };
    let recording = data.map(claim).transpose()?;
    let begun = match found {
        Some(found) => found,
        None => asked.begin(config, &times_secs).map_err(|error| match caught_signal() {
            Some(signal) => interrupted(signal, &Observables::default()),
            None => error,
        })?,
    };
    let goes_on = !begun.marks.went_on_at.is_empty();
    if let (true, Some(plan)) = (goes_on, &recording) {
        // This check comes before any output is cut off, so that a refused run keeps all its files.
        let step = begun.state.simulation.observables().step;
        let formats = formats_of(&plan.settings)?;
        Recording::check(&plan.folder, &formats, step, &begun.marks.recording)?;
    }
    if let Some(folder) = &folder {
        if goes_on {
            folder.keep(&begun.marks, options.animation())?;
        } else {
            folder.clear()?;
        }
    }
    if options.draws() {
        note_line(format_args!("drawing with {}", renderer.name()));
    }

    let Beginning { state: SavedState { scene, simulation, tally, .. }, marks } = begun;
    let steps = simulation.step_at(until_secs);
    // Scenes with small grains may need very many substeps per step.
    let substeps = u64::from(simulation.substeps());
    warn_of_steps(steps.saturating_sub(simulation.observables().step).saturating_mul(substeps));
    let next_picture = marks.next_picture;
    let asked_of = folder.as_ref().zip(every_secs.zip(fingerprint));
    let mut checkpoints = asked_of.map(|(folder, (every_secs, fingerprint))| {
        Checkpoints::start(folder.path(), every_secs, fingerprint, &simulation)
    });
    if let (Some(checkpoints), false) = (&mut checkpoints, goes_on) {
        // The first checkpoint is written before all other files. Without it the same command would be refused because
        // these files exist.
        checkpoints.write(&scene, &simulation, &tally, marks.clone())?;
    }
    let start = |plan: RecordingPlan| -> Result<Recording> {
        let recording = plan.start(&scene, &simulation, &picture_times_secs, &marks.recording)?;
        Ok(recording.with_sums(marks.sums.clone()))
    };
    let recording = recording.map(start).transpose()?;
    let provenance = options.provenance(config, &scene)?;
    let mut writer =
        RunWriter::open(options, renderer, &scene, steps, provenance, marks, checkpoints)?;
    writer.recording = recording;
    let run = OnItsWay { simulation, tally, next_picture };
    let recorded = go_on_with(run, &times_secs, until_secs, &mut writer);
    writer.end(recorded)
}

/// Reports on stderr which of the user's settings have no effect with the chosen stepper.
fn tell_of_unread_settings(config: &Config, scene: &Scene) {
    let unread = config.unread_by(scene.stepper);
    if !unread.is_empty() {
        let (name, stepper, unread) = (&scene.name, scene.stepper, unread.join(", "));
        note_line(format_args!("{name}: the stepper {stepper} does not read {unread}"));
    }
}

/// Returns the state of the run that the same command left in its folder; `None` if there is none. If the folder
/// contains other files of an earlier run, returns an error, unless these files are to be removed.
fn left_in(folder: Option<&RunFolder>, fingerprint: Option<&str>) -> Result<Option<Beginning>> {
    let Some(folder) = folder else { return Ok(None) };
    let Some(fingerprint) = fingerprint.filter(|_| folder.may_go_on()) else {
        return folder.check("").map(|()| None);
    };
    match look(folder.path(), fingerprint) {
        Ok(None) => folder.check("").map(|()| None),
        Err(why) => folder.check(&format!(", and no run goes on with it: {why}")).map(|()| None),
        Ok(Some(begun)) => {
            let Observables { step, time_secs, .. } = begun.state.simulation.observables();
            let place = folder.path().display();
            note_line(format_args!("{place}: the run goes on at step {step}, t = {time_secs} s"));
            Ok(Some(begun))
        }
    }
}

/// The run that the options describe, read and checked, before its grains settle.
pub(super) enum RequestedRun {
    /// A scene that starts at t = 0, before its grains have settled.
    Scene(Box<Scene>),
    /// A saved run with the changes of settings on the command line.
    Run(Box<SavedState>),
}

/// The times of the pictures and the end of the run, simulated seconds.
pub(super) struct PictureSchedule {
    pub times_secs: Vec<f64>,
    pub until_secs: f64,
}

impl RequestedRun {
    /// Reads and checks the run that the options describe.
    ///
    /// # Errors
    /// Names an option with an invalid value.
    pub(super) fn of(config: &Config, options: &HeadlessOptions) -> Result<Self> {
        options.check_checkpoints()?;
        let Some(path) = &options.restart else {
            let start = config.without_settling()?;
            // The simulation is built to refuse degenerate shapes and coinciding discs before anything is written.
            start.simulation()?;
            return Ok(Self::Scene(Box::new(start)));
        };
        let mut state = SavedState::open(path)?;
        state.of_run.clear();
        config.change_state(&mut state)?;
        Ok(Self::Run(Box::new(state)))
    }

    /// The scene with the settings of the command line.
    pub(super) fn scene(&self) -> &Scene {
        match self {
            Self::Scene(scene) => scene,
            Self::Run(state) => &state.scene,
        }
    }

    /// Returns the times of the pictures and the end of the run.
    ///
    /// # Errors
    /// If the time of a picture is not within the run, or if the run would end before the saved state from which it
    /// starts.
    pub(super) fn schedule(
        &self,
        config: &Config,
        options: &HeadlessOptions,
    ) -> Result<PictureSchedule> {
        // Without pictures the number of pictures is not limited.
        let has_times = options.draws() || !options.times.is_empty();
        let times_secs = match has_times {
            true => options.picture_times(self.scene().duration_secs)?,
            false => Vec::new(),
        };
        // If the options give times but no duration, the run ends at the last time.
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

    /// Returns a hash of the configuration, the options, and the scene or saved run of this command, by which a
    /// checkpoint of the same command is recognised. The options `--frames`, `--save`, `--restart`,
    /// `--checkpoint-every` and `--overwrite` do not affect the hash.
    ///
    /// # Errors
    /// If the inputs cannot be encoded as bytes.
    pub(super) fn fingerprint(&self, config: &Config, options: &HeadlessOptions) -> Result<String> {
        let refuse = |error: &dyn std::fmt::Display| {
            Error::value("scene", &self.scene().name, format!("written ({error})"))
        };
        let pictures = HeadlessOptions {
            frames: None,
            overwrite: false,
            restart: None,
            save: None,
            checkpoint_every: None,
            ..options.clone()
        };
        let start = match self {
            Self::Scene(scene) => rmp_serde::to_vec_named(scene).map_err(|error| refuse(&error))?,
            Self::Run(state) => state.to_bytes()?,
        };
        let config = serde_json::to_vec(config).map_err(|error| refuse(&error))?;
        let mut hasher = blake3::Hasher::new();
        for part in [&config[..], format!("{pictures:?}").as_bytes(), &start] {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part);
        }
        Ok(hasher.finalize().to_hex().to_string())
    }

    /// Returns the state with which the run starts, after its grains have settled.
    ///
    /// # Errors
    /// If the grains do not come to rest.
    pub(super) fn begin(self, config: &Config, times_secs: &[f64]) -> Result<Beginning> {
        let (state, restarted_from) = match self {
            Self::Scene(_) => {
                let scene = settled(config)?;
                let simulation = scene.simulation()?;
                (SavedState::new(scene, simulation, Tally::default()), None)
            }
            Self::Run(state) => {
                let now = Instant::of(state.simulation.observables());
                (*state, Some(now))
            }
        };
        let is_past =
            |&secs: &f64| state.simulation.step_at(secs) < state.simulation.observables().step;
        let next_picture = times_secs.partition_point(is_past);
        let marks = Marks { next_picture, restarted_from, ..Marks::default() };
        Ok(Beginning { state, marks })
    }
}

/// Builds the scene that `config` describes. If the scene is a new pile, its grains settle first, and the progress of
/// this simulation is shown.
pub(crate) fn settled(config: &Config) -> Result<Scene> {
    let progress = Progress::new("settling", 100);
    let scene = config.scene(|Settling { time_secs, limit_secs, .. }| {
        progress.set((100.0 * time_secs / limit_secs) as u64);
        caught_signal().is_none()
    });
    progress.finish();
    scene
}

/// A recording (table of grains and contacts for other programs) that has not started yet.
pub(super) struct RecordingPlan {
    /// The locked folder of the recording (files of grains and contacts); `None` if a resumed run continues its own
    /// recording.
    claim: Option<RecordingFolder>,
    folder: PathBuf,
    settings: DataSettings,
}

impl RecordingPlan {
    /// Starts the recording (files of grains and contacts) at the present state of a run, or continues an existing
    /// recording after the numbers of recorded states (frames) and table rows in `mark`.
    ///
    /// # Errors
    /// If the folder cannot be written to, or a file of the recording is missing.
    pub(super) fn start(
        self,
        scene: &Scene,
        simulation: &Simulation,
        picture_times: &[f64],
        mark: &RecordingMark,
    ) -> Result<Recording> {
        let mut about = scene_facts(scene)?;
        let words = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
        let command = words.collect::<Vec<_>>().join(" ").replace(char::is_control, " ");
        about.facts.insert(1, ("command".to_owned(), command));
        let times = match self.settings.every_secs {
            Some(secs) => Times::Every(secs),
            None => Times::At(picture_times.to_vec()),
        };
        let time_step_secs = scene.parameters.time_step_secs;
        if let Some(secs) = self.settings.every_secs.filter(|&secs| secs < time_step_secs) {
            note_line(format_args!(
                "data-every is {secs} s, below the time step of {time_step_secs} s: there is a frame a step"
            ));
        }
        let formats = formats_of(&self.settings)?;
        let step = simulation.observables().step;
        let recording = match self.claim {
            Some(claim) => Recording::start_in(claim, &formats, &about)?,
            None => Recording::go_on(&self.folder, &formats, &about, step, mark)?,
        };
        Ok(recording.at(times, simulation))
    }
}
