//! What a hand does to a world of a live run.

use super::engine::Engine;
use super::frame::message;
use super::track::Track;
use crate::error::{Error, Result};
use crate::sim::Edit;

impl Engine {
    /// Has a hand change a world. Where that leaves what is recorded behind, it is kept.
    pub(super) fn edit(&mut self, world: usize, edit: Edit) {
        let Some(track) = self.worlds.tracks.get(world) else { return };
        let branches = track.recording.is_before_end(&track.simulation);
        let before = branches.then(|| self.worlds.clone());
        self.refusal = self.worlds.tracks[world].edit(edit).err().map(message);
        if let (Some(before), None) = (before, &self.refusal) {
            self.past.keep(before, self.options.recording_bytes);
            self.worlds.name.clear();
        }
    }
}

impl Track {
    /// Has a hand change the world. What was recorded after this moment is forgotten.
    fn edit(&mut self, edit: Edit) -> Result<()> {
        if let Some(failure) = &self.failure {
            return Err(Error::value("state", failure, "one that the run can go on from"));
        }
        self.simulation.edit(&edit)?;
        self.recording.edited(&self.simulation, edit);
        let step = self.simulation.observables().step;
        self.curve.truncate(step);
        self.film.forget_after(step);
        Ok(())
    }
}
