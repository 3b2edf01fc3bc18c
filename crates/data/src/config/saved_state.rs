//! Saves a complete run in a file, from which the run resumes with bitwise identical results.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::output::{Seal, write_file};
use crate::scene::Scene;
use crate::sim::{Simulation, Tally};
use crate::world::{Grain, Gravity};

/// Header of files with saved runs, and the words for such a file in error messages: "state of a run".
const SEAL: Seal = Seal {
    magic: "slump-state ",
    format: 8,
    what: "state",
    of: " of a run",
    form: "a state that --save or --checkpoint-every wrote",
};

/// Saved run: the complete state of a run after one of its steps, from which the run can resume.
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
    /// The scene with which the run began, but with the settings that the run had when it was saved.
    pub scene: Scene,
    /// The simulation, including everything that affects later steps.
    pub simulation: Simulation,
    /// Statistics over the steps of the run so far, such as the numbers of steps and sweeps.
    pub tally: Tally,
    /// Serialised data about the files in the output folder of a run. A checkpoint contains them, because the run needs
    /// them to resume in this folder. Empty in all other saved runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub of_run: Vec<u8>,
}

impl SavedState {
    /// Creates the saved state of a run of `scene`, which is now in the state `simulation`. `tally` has the statistics
    /// over the run's steps so far; it may be empty if they are not needed.
    pub fn new(mut scene: Scene, simulation: Simulation, tally: Tally) -> Self {
        scene.set_settings(*simulation.settings());
        Self { scene, simulation, tally, of_run: Vec::new() }
    }

    /// Writes the state to a file, completely or not at all.
    ///
    /// # Errors
    /// The error names the file and gives the system's message.
    pub fn save(&self, path: &Path) -> Result<()> {
        write_file(path, &self.to_bytes()?)
    }

    /// Reads a saved run from a file.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged, was written by another version, or is not a saved run.
    pub fn open(path: &Path) -> Result<Self> {
        SEAL.open(path)
    }

    /// Returns the bytes that [`SavedState::save`] writes. Equal states give equal bytes.
    ///
    /// # Errors
    /// If the state cannot be serialised.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        SEAL.written(self)
    }

    /// Reads a saved run from the bytes of a file; `path` is used only in error messages.
    ///
    /// # Errors
    /// If the bytes are damaged, were written by another version, or are not a saved run.
    pub fn from_bytes(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self> {
        SEAL.read(bytes, path.as_ref())
    }

    /// True if a file contains a saved run, written by any version of Slump.
    pub fn is_in(path: &Path) -> bool {
        SEAL.is_on(path)
    }

    /// Returns a scene that starts at time 0 from the saved state: grains have the positions and velocities that they
    /// have in the saved state, and walls, fixed discs and periodic borders the positions that they have in the saved
    /// state.
    pub fn as_start(&self) -> Scene {
        let world = self.simulation.world();
        let grains = &world.grains;
        let material = |index| match grains.material(index) {
            0 => None,
            number => Some(world.materials[usize::from(number)].name.clone()),
        };
        let grain = |index: usize| Grain {
            material: material(index),
            mass: Some(grains.masses[index]),
            ..grains.grain(index)
        };
        let turning = world.gravity_turn.as_ref();
        let gravity = turning.map_or(self.scene.gravity, |turning| Gravity::Uniform {
            acceleration: turning.listed,
        });
        Scene {
            gravity,
            gravity_turn: turning
                .filter(|turning| !turning.turn.is_none())
                .map(|turning| turning.turn.clone()),
            grains: (0..grains.len()).map(grain).collect(),
            boundaries: world.boundaries.clone(),
            fixed_discs: world.fixed_discs.clone(),
            motions: world.motions.clone(),
            periodic: world.periodic,
            ..self.scene.clone()
        }
        .without_implied_masses()
    }
}
