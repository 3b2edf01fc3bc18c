//! The manifest of a run: `manifest.json` in the folder of the pictures, with settings and results.

use std::path::Path;
use std::time::{Duration, Instant as Clock};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::output::PendingFile;
use crate::scene::Scene;
use crate::sim::{Alarm, FractureWork, Observables, Tally, hash_of_bits};
use crate::study::Recorded;

/// Contents of `manifest.json`.
#[derive(Debug, Serialize)]
pub(super) struct Manifest {
    pub program: &'static str,
    pub version: &'static str,
    pub command: Vec<String>,
    pub renderer: String,
    pub runs: Vec<RunEntry>,
    pub pictures: Vec<PictureEntry>,
    /// Wall-clock time at which the manifest was last written during the run.
    #[serde(skip)]
    written: Clock,
    /// Wall-clock time that the last write of the manifest took.
    #[serde(skip)]
    writing_took: Duration,
}

/// Shortest time between two writes of the manifest during the run. If the process is killed, the manifest may lack the
/// pictures of this period.
const WAIT: Duration = Duration::from_millis(500);
/// Smallest ratio of the time between two writes of the manifest to the duration of a write. It limits the time spent
/// on a long manifest, which takes longer to write.
const PART: u32 = 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum RunStatus {
    /// The run has not ended yet, or its process was killed.
    Running,
    /// The run reached its full duration.
    Complete,
    /// A signal ended the run.
    Interrupted,
    /// The run ended because its state was no longer finite.
    NotFinite,
    /// The run ended with another error, for example because its results could not be written.
    Failed,
}

impl RunStatus {
    pub(super) fn of(recorded: &Recorded) -> Self {
        match &recorded.failure {
            Some(Error::NonFinite { .. }) => Self::NotFinite,
            Some(_) => Self::Failed,
            None if recorded.interrupted => Self::Interrupted,
            None => Self::Complete,
        }
    }
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct RunEntry {
    pub name: String,
    pub ended: RunStatus,
    /// Number of steps taken.
    pub step: u64,
    /// Simulated time at the end, s.
    pub time_secs: f64,
    /// The scene without its lists of grains and of discs that are not grains.
    pub scene: serde_json::Value,
    pub grains: usize,
    pub fixed_discs: usize,
    /// Hash of the initial state: FNV-1a over the bits of positions, radii and velocities of the grains.
    pub initial_state: String,
    /// Hash of the final state ([`crate::sim::Snapshot::state_hash`]); empty until the run has ended.
    pub last_state: String,
    pub tally: Tally,
    /// Step number and simulated time of the saved run from which this run starts (`--restart`).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub restarted_from: Option<Instant>,
    /// Step numbers and simulated times at which the same command resumed the run from a checkpoint.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub went_on_at: Vec<Instant>,
    /// Warnings about the run, each with the change of settings that is most likely to help.
    pub alarms: Vec<AlarmEntry>,
    /// Cohesive time Bond·Δt/√(d/g), dimensionless (§3.3 of Abramian & Staron 2020). Bond is the Bond number, Δt the
    /// time step, s, d the mean diameter, m, and g gravity, m/s².
    pub cohesive_time: f64,
    /// Capture speed Bond·g·Δt, m/s: the opening speed of a contact that cohesion cancels in one step (eq. 9 of
    /// Abramian & Staron 2020). Bond is the Bond number, g gravity, m/s², and Δt the time step, s.
    pub capture_speed: f64,
    /// Substeps per step; 1 if the stepper solves each step as a whole.
    pub substeps: u32,
    /// Longest substep that is known to be stable, s; missing if the stepper has no such limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub critical_time_step_secs: Option<f64>,
    /// Duration of the collision of two grains of mean mass, s; missing if the stepper does not represent contacts by
    /// springs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_time_secs: Option<f64>,
    /// Work that pulls two bonded grains of mean mass apart slowly: in J, and divided by the work that lifts one of
    /// them by the mean diameter. Missing if the contact law does not define this work.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fracture_work: Option<FractureWork>,
}

/// Step number and simulated time of a state of a run.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Instant {
    pub step: u64,
    /// Simulated time, s.
    pub time_secs: f64,
}

impl Instant {
    pub(super) fn of(observables: &Observables) -> Self {
        let Observables { step, time_secs, .. } = *observables;
        Self { step, time_secs }
    }
}

#[derive(Clone, Debug, Serialize)]
pub(super) struct AlarmEntry {
    #[serde(flatten)]
    pub alarm: Alarm,
    pub message: String,
}

/// A picture file, with the states of runs that it shows.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct PictureEntry {
    pub file: String,
    /// The displayed state, one for each panel of the picture.
    pub shows: Vec<ShownMoment>,
}

/// A state of a run that a picture shows: the name of the run, and the observables (measured quantities) of the state.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ShownMoment {
    pub run: String,
    pub observables: Observables,
}

impl Manifest {
    pub(super) fn new(renderer: &str) -> Self {
        Self {
            program: "slump",
            version: crate::VERSION,
            // JSON text is UTF-8, so bytes of the command line that are not UTF-8 are replaced.
            command: std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect(),
            renderer: renderer.to_owned(),
            runs: Vec::new(),
            pictures: Vec::new(),
            written: Clock::now(),
            writing_took: Duration::ZERO,
        }
    }

    pub(super) fn write(&self, path: &Path) -> Result<()> {
        self.write_and(path, true)
    }

    /// Adds a picture to the list. Also writes the manifest if the last write was long enough ago, so that the manifest
    /// is nearly complete if the process is killed.
    pub(super) fn add(&mut self, picture: PictureEntry, path: &Path) -> Result<()> {
        self.pictures.push(picture);
        if self.written.elapsed() < WAIT.max(PART * self.writing_took) {
            return Ok(());
        }
        let begun = Clock::now();
        // The write does not wait for the disk, to save time.
        self.write_and(path, false)?;
        (self.written, self.writing_took) = (Clock::now(), begun.elapsed());
        Ok(())
    }

    fn write_and(&self, path: &Path, safe: bool) -> Result<()> {
        let mut text =
            serde_json::to_string_pretty(self).map_err(|error| Error::file(path, error))?;
        text.push('\n');
        let mut draft = PendingFile::start(path)?;
        draft.write(text.as_bytes())?;
        draft.finish(safe)
    }
}

impl RunEntry {
    /// Returns the manifest's entry of a run that starts.
    pub(super) fn start(name: &str, scene: &Scene) -> Result<Self> {
        let mut said = serde_json::to_value(scene)
            .map_err(|error| Error::value("scene", name, error.to_string()))?;
        if let Some(fields) = said.as_object_mut() {
            fields.remove("grains");
            fields.remove("fixed_discs");
        }
        let gravity = scene.gravity.magnitude();
        let start = scene.simulation()?;
        Ok(Self {
            name: name.to_owned(),
            ended: RunStatus::Running,
            step: 0,
            time_secs: 0.0,
            scene: said,
            grains: scene.grains.len(),
            fixed_discs: scene.fixed_discs.len(),
            initial_state: hash_of_start(scene),
            last_state: String::new(),
            tally: Tally::default(),
            restarted_from: None,
            went_on_at: Vec::new(),
            alarms: Vec::new(),
            cohesive_time: scene.parameters.cohesive_time(scene.mean_diameter, gravity),
            capture_speed: scene.parameters.capture_speed(gravity),
            substeps: start.substeps(),
            critical_time_step_secs: start.critical_time_step_secs(),
            contact_time_secs: start.contact_time_secs(),
            fracture_work: start.fracture_work(),
        })
    }

    /// Adds the results to the manifest's entry of a run that has ended.
    pub(super) fn end(&mut self, ended: RunStatus, recorded: &Recorded) {
        let Recorded { simulation, tally, .. } = recorded;
        let Observables { step, time_secs, .. } = *simulation.observables();
        let settings = simulation.settings();
        let entry = |alarm: &Alarm| AlarmEntry { alarm: *alarm, message: alarm.message(settings) };
        let alarms = simulation.alarms().iter().map(entry).collect();
        let (tally, last_state) = (*tally, simulation.snapshot().state_hash());
        let so_far = self.clone();
        *self = Self { ended, step, time_secs, last_state, tally, alarms, ..so_far };
    }
}

/// Hash of the initial state of a scene.
fn hash_of_start(scene: &Scene) -> String {
    hash_of_bits(scene.grains.iter().flat_map(|grain| {
        let (position, velocity) = (grain.position, grain.velocity);
        [position.x, position.y, grain.radius, velocity.x, velocity.y, grain.angular_velocity]
    }))
}
