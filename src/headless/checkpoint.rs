//! Checkpoints: the state of a run in its own folder, from which the same command goes on.
//!
//! A run is taken down by several things at once: rows of a table, pictures, states that wait for being drawn.
//! Each tells a checkpoint how far it has come, once all of that is on the disk, and comes back to it when the
//! run goes on: what was written later is cut off, and is written again just as it was. What is to be taken
//! down besides has a mark of its own in [`Marks`], which `Studio::marks` asks for and `Studio::open` hands
//! back.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::manifest::{Instant, PictureEntry};
use crate::config::SavedState;
use crate::error::{Error, Result};
use crate::output::remove_if_there;
use crate::scene::Scene;
use crate::sim::{Simulation, Tally};

/// Name of a checkpoint.
pub(super) const CHECKPOINT: &str = "checkpoint.slump";
/// Name of the file in which states wait for being drawn, where they are to outlive the process.
pub(super) const WAITING: &str = "checkpoint.states";

/// How far everything had come that takes a run down.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Marks {
    /// Tells whether a command is the same.
    pub fingerprint: String,
    /// The number of the first picture that is not taken yet.
    pub next_picture: usize,
    /// Length of `observables.csv`, bytes.
    pub table: u64,
    /// Length of the states that wait for being drawn, bytes.
    pub waiting: u64,
    /// Pictures in the folder.
    pub pictures: Vec<PictureEntry>,
    /// The moment of the saved run that the command went on with, where it did.
    pub restarted_from: Option<Instant>,
    /// Moments at which the same command went on; none in one that has just begun.
    pub went_on_at: Vec<Instant>,
}

/// A run that is about to go on, from its start or from later.
pub(super) struct Beginning {
    pub state: SavedState,
    /// How far it had come in the folder that it writes to.
    pub marks: Marks,
}

/// Saves a run now and then, for the same command to go on with.
pub(super) struct Checkpoints {
    path: PathBuf,
    every_secs: f64,
    fingerprint: String,
    /// The number of the next one, in intervals since t = 0.
    next: f64,
}

impl Checkpoints {
    /// Those of a run in `folder` that begins at this moment.
    pub(super) fn start(
        folder: &Path,
        every_secs: f64,
        fingerprint: String,
        simulation: &Simulation,
    ) -> Self {
        let mut checkpoints =
            Self { path: folder.join(CHECKPOINT), every_secs, fingerprint, next: 0.0 };
        checkpoints.skip_to(simulation);
        checkpoints
    }

    fn skip_to(&mut self, simulation: &Simulation) {
        self.next = (simulation.time_secs() / self.every_secs).floor() + 1.0;
        // Rounding of sums of Δt must not make two of one.
        if self.is_due(simulation) {
            self.next += 1.0;
        }
    }

    /// Whether one is due after this step.
    pub(super) fn is_due(&self, simulation: &Simulation) -> bool {
        simulation.step_at(self.next * self.every_secs) <= simulation.observables().step
    }

    /// Writes one in the place of the one before.
    ///
    /// # Errors
    /// Names the file and what the system says; the one before stays.
    pub(super) fn write(
        &mut self,
        scene: &Scene,
        (simulation, tally): (&Simulation, &Tally),
        marks: Marks,
    ) -> Result<()> {
        let marks = Marks { fingerprint: self.fingerprint.clone(), ..marks };
        let mut state = SavedState::new(scene.clone(), simulation.clone(), *tally);
        state.of_run = rmp_serde::to_vec_named(&marks)
            .map_err(|error| Error::file(&self.path, format!("cannot be written ({error})")))?;
        state.save(&self.path)?;
        self.skip_to(simulation);
        Ok(())
    }

    /// Removes it: the run is complete, and nothing goes on from there.
    ///
    /// # Errors
    /// Names the file that stays.
    pub(super) fn remove(self) -> Result<()> {
        remove_if_there(&self.path)?;
        remove_if_there(&self.path.with_file_name(WAITING))
    }
}

/// What a folder tells of a run that may go on in it.
pub(super) enum Found {
    /// No checkpoint.
    Nothing,
    /// One of the same command.
    Own(Box<Beginning>),
    /// One from which this command cannot go on, for that reason.
    Strange(String),
}

/// Looks for the checkpoint of a command in its folder.
pub(super) fn look(folder: &Path, fingerprint: &str) -> Found {
    let path = folder.join(CHECKPOINT);
    if !path.exists() {
        return Found::Nothing;
    }
    let mut state = match SavedState::open(&path) {
        Ok(state) => state,
        Err(error) => return Found::Strange(error.to_string()),
    };
    let marks: std::result::Result<Marks, _> = rmp_serde::from_slice(&state.of_run);
    match marks {
        Ok(mut marks) if marks.fingerprint == fingerprint => {
            state.of_run.clear();
            marks.went_on_at.push(Instant::of(state.simulation.observables()));
            Found::Own(Box::new(Beginning { state, marks }))
        }
        _ => Found::Strange("it is of another command".to_owned()),
    }
}
