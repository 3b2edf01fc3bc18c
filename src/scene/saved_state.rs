//! A run as a file: the whole of it, so that it goes on bit for bit.
//!
//! A file is a line and what it tells of:
//!
//! > slump-state ⟨format⟩ ⟨version of the program⟩ ⟨bytes that follow⟩ ⟨their BLAKE3 checksum⟩
//!
//! What follows is MessagePack with the names of all fields. Nothing of it is looked at before the
//! checksum is found to be its own, and nothing of another version ever: what a number means, and what the
//! next step makes of it, may differ.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::Scene;
use crate::error::{Error, Result};
use crate::output::write_file;
use crate::sim::{Simulation, Tally};
use crate::world::Gravity;

/// What files begin with.
const MAGIC: &[u8] = b"slump-state ";
/// Counts the changes of what is in a file, or of what it means, within a version of the program.
const FORMAT: u32 = 1;
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// No first line is longer.
const MOST_OF_LINE: u64 = 256;
/// What a file must be, for messages.
const FORM: &str = "a state that --save or --checkpoint-every wrote";

/// A run at one moment, to go on from.
///
/// ```
/// use slump::scene::{SavedState, built_in};
/// use slump::sim::Tally;
///
/// let scene = built_in("collision")?;
/// let mut simulation = scene.simulation()?;
/// simulation.take_steps(3)?;
/// let state = SavedState::new(scene, simulation, Tally::default());
/// let mut read = SavedState::from_bytes(&state.to_bytes()?, "collision.slump")?;
/// read.simulation.take_steps(1)?;
/// assert_eq!(read.simulation.observables().step, 4);
/// # Ok::<(), slump::error::Error>(())
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
    pub(crate) of_run: Vec<u8>,
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
        let file = File::open(path).map_err(|error| Error::unread(path, error, FORM))?;
        Self::read(BufReader::new(file), path)
    }

    /// What [`SavedState::save`] writes. The same state is the same bytes.
    ///
    /// # Errors
    /// Where it cannot be put into bytes.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        let refuse = |error| Error::value("state", &self.scene.name, format!("written ({error})"));
        let content = rmp_serde::to_vec_named(self).map_err(refuse)?;
        Ok([first_line(&content).as_bytes(), &content].concat())
    }

    /// What [`SavedState::open`] reads; `path` is for messages.
    ///
    /// # Errors
    /// As there.
    pub fn from_bytes(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self> {
        Self::read(bytes, path.as_ref())
    }

    /// Whether a file is one of these, of whatever version.
    pub fn is_in(path: &Path) -> bool {
        let mut start = [0; MAGIC.len()];
        let read = File::open(path).and_then(|mut file| file.read_exact(&mut start));
        read.is_ok() && start == MAGIC
    }

    fn read(mut file: impl BufRead, path: &Path) -> Result<Self> {
        let unread = |error| Error::unread(path, error, FORM);
        let mut line = Vec::new();
        file.by_ref().take(MOST_OF_LINE).read_until(b'\n', &mut line).map_err(unread)?;
        let length = length_of_content(&line).map_err(|reason| Error::file(path, reason))?;
        // No more than a byte too many is read, and no more room taken than there are bytes.
        let mut content = Vec::new();
        file.take(length.saturating_add(1)).read_to_end(&mut content).map_err(unread)?;
        if (content.len() as u64) < length {
            let found = content.len();
            let reason = format!("has been cut: {found} bytes are left, but must be all {length}");
            return Err(Error::file(path, reason));
        }
        if first_line(&content).as_bytes() != line {
            return Err(Error::file(path, DAMAGED));
        }
        rmp_serde::from_slice(&content).map_err(|error| {
            // Of what is not known, the list of all that is would be longer than all else.
            let said = error.to_string();
            let error = said.split(", expected one of").next().unwrap_or(&said);
            let reason = format!("holds no state of this layout ({error}), but must be {FORM}");
            Error::file(path, format!("{reason} with this very program"))
        })
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
            gravity_turn: turning.map(|turning| turning.turn.clone()),
            grains: (0..grains.len()).map(|index| grains.grain(index)).collect(),
            boundaries: world.boundaries.clone(),
            fixed_discs: world.fixed_discs.clone(),
            motions: world.motions.clone(),
            ..self.scene.clone()
        }
    }
}

/// Of a file that is not what was once written.
const DAMAGED: &str = "is damaged: its checksum is not that of its content, but must be, as it was when it was written";

/// The first line of a file with that content.
fn first_line(content: &[u8]) -> String {
    let magic = String::from_utf8_lossy(MAGIC);
    let (length, checksum) = (content.len(), blake3::hash(content));
    format!("{magic}{FORMAT} {VERSION} {length} {checksum}\n")
}

/// How many bytes follow a first line; or, as the rest of a sentence, why it is none of this version.
fn length_of_content(line: &[u8]) -> std::result::Result<u64, String> {
    let Some(said) = line.strip_prefix(MAGIC) else {
        return Err(format!("holds no state of a run, but must be {FORM}"));
    };
    let said = str::from_utf8(said).ok().and_then(|said| said.strip_suffix('\n'));
    let said: Vec<&str> = said.ok_or(DAMAGED)?.split(' ').collect();
    let [format, version, length, _] = said[..] else { return Err(DAMAGED.to_owned()) };
    if (format, version) != (&*FORMAT.to_string(), VERSION) {
        return Err(format!(
            "is of version {version} of the program, format {format}, but must be of the one that reads \
             it, version {VERSION}, format {FORMAT}: others may step otherwise"
        ));
    }
    length.parse().map_err(|_| DAMAGED.to_owned())
}
