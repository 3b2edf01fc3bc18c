//! What was run and what came out, beside the pictures.

use std::hash::Hasher;
use std::path::Path;

use serde::Serialize;

use crate::error::{Error, Result};
use crate::output::write_file;
use crate::scene::Scene;
use crate::sim::{Alarm, Observables, Tally};

/// `manifest.json`.
#[derive(Debug, Serialize)]
pub(super) struct Manifest {
    pub program: &'static str,
    pub version: &'static str,
    /// The command line.
    pub command: Vec<String>,
    pub renderer: String,
    pub runs: Vec<RunEntry>,
    pub pictures: Vec<PictureEntry>,
}

/// One run.
#[derive(Clone, Debug, Serialize)]
pub(super) struct RunEntry {
    pub name: String,
    /// All that the scene says, except for its lists of discs.
    pub scene: serde_json::Value,
    pub grains: usize,
    pub fixed_discs: usize,
    /// Tells initial states apart: FNV-1a over all numbers of the grains, bit by bit.
    pub initial_state: String,
    pub tally: Tally,
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
}

/// Something that went wrong.
#[derive(Clone, Debug, Serialize)]
pub(super) struct AlarmEntry {
    #[serde(flatten)]
    pub alarm: Alarm,
    pub message: String,
}

/// One picture.
#[derive(Clone, Debug, Serialize)]
pub(super) struct PictureEntry {
    pub file: String,
    /// A moment a panel.
    pub shows: Vec<Moment>,
}

/// One moment of a run.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Moment {
    /// Name of the run.
    pub run: String,
    pub observables: Observables,
}

impl Manifest {
    pub(super) fn new(renderer: &str) -> Self {
        Self {
            program: "slump",
            version: env!("CARGO_PKG_VERSION"),
            command: std::env::args().collect(),
            renderer: renderer.to_owned(),
            runs: Vec::new(),
            pictures: Vec::new(),
        }
    }

    pub(super) fn write(&self, path: &Path) -> Result<()> {
        let mut text =
            serde_json::to_string_pretty(self).map_err(|error| Error::file(path, error))?;
        text.push('\n');
        write_file(path, text.as_bytes())
    }
}

impl RunEntry {
    pub(super) fn new(name: &str, scene: &Scene, tally: Tally, alarms: &[Alarm]) -> Result<Self> {
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
            scene: said,
            grains: scene.grains.len(),
            fixed_discs: scene.fixed_discs.len(),
            initial_state: format!("{:016x}", fingerprint(scene)),
            tally,
            alarms: alarms
                .iter()
                .map(|alarm| AlarmEntry {
                    alarm: *alarm,
                    message: alarm.message(&scene.settings()),
                })
                .collect(),
            cohesive_time: scene.parameters.cohesive_time(scene.mean_diameter, gravity),
            capture_speed: scene.parameters.capture_speed(gravity),
            substeps: start.substeps(),
            critical_time_step_secs: start.critical_time_step_secs(),
        })
    }
}

fn fingerprint(scene: &Scene) -> u64 {
    let mut hasher = fnv::FnvHasher::default();
    for grain in &scene.grains {
        let (position, velocity) = (grain.position, grain.velocity);
        for number in
            [position.x, position.y, grain.radius, velocity.x, velocity.y, grain.angular_velocity]
        {
            hasher.write(&number.to_le_bytes());
        }
    }
    hasher.finish()
}
