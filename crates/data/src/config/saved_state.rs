//! A complete run as a file, from which it resumes bit for bit.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::output::{Seal, write_file};
use crate::scene::Scene;
use crate::sim::{Simulation, Tally};
use crate::world::Gravity;

/// The header of the files.
const SEAL: Seal = Seal {
    magic: "slump-state ",
    format: 7,
    what: "state",
    of: " of a run",
    form: "a state that --save or --checkpoint-every wrote",
};

/// A run at one moment, from which it can resume.
///
/// ```
/// use slump_core::scene::built_in;
/// use slump_data::config::SavedState;
/// use slump_core::sim::Tally;
///
/// let scene = built_in("collision")?;
/// let mut simulation = scene.simulation()?;
/// simulation.take_steps(3)?;
/// let state = SavedState::new(scene, simulation, Tally::default());
/// let mut read = SavedState::from_bytes(&state.to_bytes()?, "collision.slump")?;
/// read.simulation.take_steps(1)?;
/// assert_eq!(read.simulation.observables().step, 4);
/// # Ok::<(), slump_core::error::Error>(())
/// ```
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedState {
    /// The scene with which the run began, with the settings now in force.
    pub scene: Scene,
    /// The simulation, including everything that affects later steps.
    pub simulation: Simulation,
    /// Sums over the steps so far.
    pub tally: Tally,
    /// Additional data of a run that resumes in its own folder. Only that run reads it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub of_run: Vec<u8>,
}

impl SavedState {
    /// The state of a run of `scene` at this moment. `tally` has the sums over its steps; it may be empty if the sums
    /// are not needed.
    pub fn new(mut scene: Scene, simulation: Simulation, tally: Tally) -> Self {
        scene.set_settings(*simulation.settings());
        Self { scene, simulation, tally, of_run: Vec::new() }
    }

    /// Writes a file. The file is written completely or not at all.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub fn save(&self, path: &Path) -> Result<()> {
        write_file(path, &self.to_bytes()?)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// If it cannot be read, is damaged, was written by another version, or is not a saved run.
    pub fn open(path: &Path) -> Result<Self> {
        SEAL.open(path)
    }

    /// The bytes that [`SavedState::save`] writes. Equal states give equal bytes.
    ///
    /// # Errors
    /// If the state cannot be serialised.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        SEAL.written(self)
    }

    /// Reads the bytes of a file; `path` is for messages.
    ///
    /// # Errors
    /// As [`SavedState::open`].
    pub fn from_bytes(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self> {
        SEAL.read(bytes, path.as_ref())
    }

    /// True if a file is a saved run, of any version.
    pub fn is_in(path: &Path) -> bool {
        SEAL.is_on(path)
    }

    /// A scene that starts at t = 0 with the present grains and their velocities, and everything else in the scene at
    /// its present position.
    pub fn as_start(&self) -> Scene {
        let world = self.simulation.world();
        let grains = &world.grains;
        let turning = world.gravity_turn.as_ref();
        let gravity = turning.map_or(self.scene.gravity, |turning| Gravity::Uniform {
            acceleration: turning.listed,
        });
        Scene {
            gravity,
            gravity_turn: turning
                .filter(|turning| !turning.turn.is_none())
                .map(|turning| turning.turn.clone()),
            grains: (0..grains.len()).map(|index| grains.grain(index)).collect(),
            boundaries: world.boundaries.clone(),
            fixed_discs: world.fixed_discs.clone(),
            motions: world.motions.clone(),
            periodic: world.periodic,
            ..self.scene.clone()
        }
    }
}
