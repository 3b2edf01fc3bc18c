//! Where a run begins: with a scene at t = 0, with a run that was saved, or with the checkpoint that the same
//! command left in its folder.

use super::HeadlessOptions;
use super::checkpoint::{Beginning, Marks};
use super::manifest::Instant;
use super::saving::SavingOptions;
use crate::config::{Config, SavedState};
use crate::error::{Error, Result};
use crate::output::{Progress, caught_signal};
use crate::scene::{Scene, Settling};
use crate::sim::Tally;

/// What is asked for, read and checked, but for grains that have to settle.
pub(super) enum Asked {
    /// A scene from t = 0 on, with its grains where they start from.
    Scene(Box<Scene>),
    /// A run that was saved, with the changes asked for.
    Run(Box<SavedState>),
}

/// When pictures are taken, and when the run ends, s.
pub(super) struct Schedule {
    pub times_secs: Vec<f64>,
    pub until_secs: f64,
}

impl Asked {
    /// What the options ask for.
    ///
    /// # Errors
    /// Names what is refused.
    pub(super) fn of(config: &Config, options: &HeadlessOptions) -> Result<Self> {
        options.saving.validate()?;
        let Some(path) = &options.saving.restart else {
            let start = config.without_settling()?;
            // Shapes that are none and discs in one place are told of before anything is written.
            start.simulation()?;
            return Ok(Self::Scene(Box::new(start)));
        };
        let mut state = SavedState::open(path)?;
        state.of_run.clear();
        config.change_state(&mut state)?;
        Ok(Self::Run(Box::new(state)))
    }

    /// The scene, with the settings asked for.
    pub(super) fn scene(&self) -> &Scene {
        match self {
            Self::Scene(scene) => scene,
            Self::Run(state) => &state.scene,
        }
    }

    /// When pictures are taken.
    ///
    /// # Errors
    /// Where a time is none of the run's.
    pub(super) fn schedule(&self, config: &Config, options: &HeadlessOptions) -> Result<Schedule> {
        let schedule = Schedule::of(self.scene(), config, options)?;
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

    /// Tells commands apart by what they compute and draw; where to, and what they save, is left out.
    ///
    /// # Errors
    /// Where what is asked for cannot be put into bytes.
    pub(super) fn fingerprint(&self, config: &Config, options: &HeadlessOptions) -> Result<String> {
        let refuse = |error: &dyn std::fmt::Display| {
            Error::value("scene", &self.scene().name, format!("written ({error})"))
        };
        let pictures = HeadlessOptions {
            frames: None,
            overwrite: false,
            saving: SavingOptions::default(),
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

    /// The run, once its grains have settled.
    ///
    /// # Errors
    /// Where they do not come to rest.
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

impl Schedule {
    fn of(scene: &Scene, config: &Config, options: &HeadlessOptions) -> Result<Self> {
        let times_secs = options.picture_times(scene.duration_secs)?;
        // Times alone ask for no more than the last of them.
        let until_secs = match times_secs.last() {
            Some(&last) if !options.times.is_empty() && config.source.duration.is_none() => last,
            _ => scene.duration_secs,
        };
        let times_secs = if options.draws() { times_secs } else { Vec::new() };
        Ok(Self { times_secs, until_secs })
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
