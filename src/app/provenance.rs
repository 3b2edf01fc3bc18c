//! Provenance of a run: the command line that reproduces it, and the texts that its files contain.

use super::watched_run::WatchedRun;
use crate::config::{Config, Provenance, asked_time_secs, joined, words_up_to};
use crate::output::Texts;

/// Text in the files of a run that no command line reproduces.
pub(super) const CHANGED: &str = "the run had other settings before, or was changed by hand: the command line and \
                                  the settings of the visible moment make another run";

impl WatchedRun {
    /// Returns the command line that computes the selected simulation from its initial state with the present settings,
    /// with the same bits and without a window. The command does not include changes of settings during the run or
    /// edits by the user. `None` if the scene no longer exists.
    pub fn command_line(&self) -> Option<String> {
        let run = self.provenance(self.selected, self.config())?;
        let command = ["slump".to_owned(), "--headless".to_owned()];
        Some(joined(&[&command[..], &run.words].concat()))
    }

    /// Returns the provenance of a simulation: the name of its scene, its settings, and the options of the command line
    /// that reproduces it. `None` if its scene no longer exists.
    fn provenance(&self, world: usize, config: Config) -> Option<Provenance> {
        let settings = self.wanted.get(world)?.settings;
        let scene = self.frame.start.as_ref()?.scene.name.clone();
        Some(Provenance { scene, settings, words: config.words(&settings).ok()? })
    }

    /// Returns the texts, such as the command line, that a file contains about the simulations that it shows. The file
    /// shows all simulations: at one simulated time if `is_of_a_moment` is true, otherwise at all their steps.
    pub(crate) fn texts(&self, is_of_a_moment: bool) -> Texts {
        if !self.compares() {
            return self.texts_of_world(0, is_of_a_moment);
        }
        let mut texts = Texts::default();
        for world in 0..self.frame.worlds.len() {
            for (keyword, text) in self.texts_of_world(world, is_of_a_moment).iter().skip(1) {
                texts.add(format!("World {}: {keyword}", world + 1), text);
            }
        }
        texts
    }

    fn texts_of_world(&self, world: usize, is_of_a_moment: bool) -> Texts {
        // The run of the command ends at the visible or recorded time, and not at the duration that the configuration
        // states.
        let mut config = self.config();
        config.source.duration = None;
        let run = self.provenance(world, config);
        let (Some(run), Some(shown)) = (run, self.frame.worlds.get(world)) else {
            return Texts::default();
        };
        let time_secs = asked_time_secs(shown.snapshot.observables.time_secs);
        let mut texts = if is_of_a_moment {
            run.texts(Some(time_secs), &words_up_to(time_secs))
        } else {
            let duration_secs = asked_time_secs(shown.recorded_secs);
            run.texts(None, &["--duration".to_owned(), duration_secs.to_string()])
        };
        if !shown.is_even {
            texts.add("Changes", CHANGED);
        }
        let from_secs = shown.recorded_from_secs;
        if from_secs > 0.0 {
            let said = format!("from a saved run at t = {from_secs} s, not from the start");
            texts.add("Begun", said);
        }
        texts
    }
}
