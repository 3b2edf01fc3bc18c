//! What is asked of runs that begin with a saved state, or go on from one.

use std::path::Path;

use super::{Config, Origin, SavedState};
use crate::error::{Error, Result};
use crate::scene::Scene;

impl Config {
    /// The scene of a saved state, which begins with the state's grains.
    pub(super) fn scene_of_state(&self, path: &Path) -> Result<Scene> {
        let scene = SavedState::open(path)?.as_start();
        match &self.origin.scene {
            Some(name) if *name != scene.name => {
                let allowed =
                    format!("left out, or {}, the scene of the initial state", scene.name);
                Err(Error::value("scene", name, allowed))
            }
            _ => Ok(scene),
        }
    }

    /// Makes the changes asked for to a run that goes on: from here on, while all that has been stays.
    ///
    /// # Errors
    /// Names the first setting that is outside its range or does not go with the others, or says that
    /// another start is asked for.
    pub fn change_state(&self, state: &mut SavedState) -> Result<()> {
        let kept = Origin { duration: self.origin.duration, ..Origin::default() };
        if self.origin != kept {
            let allowed = "left out where scene, initial, grains, box-width, seed, start or preset is \
                           given: a run that goes on has its own";
            return Err(Error::value("restart", "given", allowed));
        }
        let mut scene = state.scene.clone();
        self.change_scene(&mut scene)?;
        state.simulation.change(scene.settings())?;
        state.scene = scene;
        Ok(())
    }
}
