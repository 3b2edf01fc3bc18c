//! A run as a file: the whole of it, so that it goes on bit for bit.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::output::{Seal, write_file};
use crate::scene::Scene;
use crate::sim::{Simulation, Tally};
use crate::world::Gravity;

/// What files begin with.
const SEAL: Seal = Seal {
    magic: "slump-state ",
    format: 6,
    what: "state",
    of: " of a run",
    form: "a state that --save or --checkpoint-every wrote",
};

/// A run at one moment, to go on from.
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
    /// The scene that the run began with, with the settings that are in force now.
    pub scene: Scene,
    /// The run itself, with all that it remembers.
    pub simulation: Simulation,
    /// Sums over its steps so far.
    pub tally: Tally,
    /// What a run that goes on in the folder of its own keeps besides; it means something to that alone.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub of_run: Vec<u8>,
}

impl SavedState {
    /// The state of a run of `scene` at this moment; `tally` has the sums over its steps, or nothing
    /// where nobody wants them.
    pub fn new(mut scene: Scene, simulation: Simulation, tally: Tally) -> Self {
        scene.set_settings(*simulation.settings());
        Self { scene, simulation, tally, of_run: Vec::new() }
    }

    /// Writes it to a file, which is there as a whole or not at all.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub fn save(&self, path: &Path) -> Result<()> {
        write_file(path, &self.to_bytes()?)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// Where it cannot be read, is damaged or of another version, or is no such file.
    pub fn open(path: &Path) -> Result<Self> {
        SEAL.open(path)
    }

    /// What [`SavedState::save`] writes. The same state is the same bytes.
    ///
    /// # Errors
    /// Where it cannot be put into bytes.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        SEAL.written(self)
    }

    /// What [`SavedState::open`] reads; `path` is for messages.
    ///
    /// # Errors
    /// As there.
    pub fn from_bytes(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self> {
        SEAL.read(bytes, path.as_ref())
    }

    /// True if a file is one of these, of whatever version.
    pub fn is_in(path: &Path) -> bool {
        SEAL.is_on(path)
    }

    /// A new start, at t = 0, with the grains as they lie and move now and everything else that the
    /// scene has where it is now.
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
