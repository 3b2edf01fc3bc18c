//! What was run and what came out, beside the pictures.

use std::path::Path;
use std::time::{Duration, Instant as Clock};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::output::PendingFile;
use crate::scene::Scene;
use crate::sim::{Alarm, FractureWork, Observables, Tally, hash_of_bits};
use crate::study::Recorded;

/// `manifest.json`.
#[derive(Debug, Serialize)]
pub(super) struct Manifest {
    pub program: &'static str,
    pub version: &'static str,
    pub command: Vec<String>,
    pub renderer: String,
    pub runs: Vec<RunEntry>,
    pub pictures: Vec<PictureEntry>,
    /// When it was last written while the run went on, and how long that took.
    #[serde(skip)]
    written: Clock,
    #[serde(skip)]
    writing_took: Duration,
}

/// Pictures that are drawn within this time may miss in the manifest of a run that is killed.
const WAIT: Duration = Duration::from_millis(500);
/// A list that has become long is written less often: it takes no more than this part of the time.
const PART: u32 = 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum RunStatus {
    /// Not yet; or it was killed.
    Running,
    /// At its full duration.
    Complete,
    /// By a signal.
    Interrupted,
    /// Its state was no longer finite.
    NotFinite,
    /// It could not be written down.
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
    /// Steps that it got to.
    pub step: u64,
    /// Simulated time that it got to, s.
    pub time_secs: f64,
    /// All that the scene says, except for its lists of discs.
    pub scene: serde_json::Value,
    pub grains: usize,
    pub fixed_discs: usize,
    /// Tells initial states apart: FNV-1a over all numbers of the grains, bit by bit.
    pub initial_state: String,
    /// Tells the states apart that runs come to ([`crate::sim::Snapshot::state_hash`]); empty until it has ended.
    pub last_state: String,
    pub tally: Tally,
    /// The moment of the saved run that this one goes on with (`--restart`).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub restarted_from: Option<Instant>,
    /// Where the same command went on with a checkpoint.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub went_on_at: Vec<Instant>,
    /// What went wrong, and what is most likely to help.
    pub alarms: Vec<AlarmEntry>,
    /// Dimensionless (paper §3.3).
    pub cohesive_time: f64,
    /// m/s (paper eq. 9).
    pub capture_speed: f64,
    /// Substeps of each step; 1 where its problem is solved as a whole.
    pub substeps: u32,
    /// The longest substep that is surely stable, s, where the method has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub critical_time_step_secs: Option<f64>,
    /// How long two grains of the mean mass that meet push each other, s, where contacts are springs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_time_secs: Option<f64>,
    /// What it takes to break the bond of two such grains, where the contact law says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fracture_work: Option<FractureWork>,
}

/// A moment of a run.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Instant {
    pub step: u64,
    /// s.
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

/// One picture.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct PictureEntry {
    pub file: String,
    /// A moment a panel.
    pub shows: Vec<ShownMoment>,
}

/// One moment of a run.
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
            // What is not UTF-8 cannot be told in JSON as it is.
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

    /// Adds a picture, and every now and then writes what there is: a program that is killed has no
    /// other time to do it.
    pub(super) fn add(&mut self, picture: PictureEntry, path: &Path) -> Result<()> {
        self.pictures.push(picture);
        if self.written.elapsed() < WAIT.max(PART * self.writing_took) {
            return Ok(());
        }
        let begun = Clock::now();
        // Not worth waiting for the disk.
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
    /// The entry of a run that begins.
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

    /// Tells what came of the run.
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

/// Tells initial states apart.
fn hash_of_start(scene: &Scene) -> String {
    hash_of_bits(scene.grains.iter().flat_map(|grain| {
        let (position, velocity) = (grain.position, grain.velocity);
        [position.x, position.y, grain.radius, velocity.x, velocity.y, grain.angular_velocity]
    }))
}
