//! The side of the other piles that the window holds.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use super::crew::Crew;
use super::lowest::idle_cores;
use super::piles::{others_of, user_folder};
use super::tasks::{Tasks, Told};
use crate::app::taken::Opened;
use crate::scene::NewPile;
use crate::sim::Settings;

/// A run that stands still for longer is not computed for.
const PATIENCE: Duration = Duration::from_secs(30);

/// The other piles of what is open.
#[derive(Default)]
pub struct OtherPiles {
    /// Where their initial states are kept; none where there is no such place.
    folder: Option<PathBuf>,
    /// What is open, and which its other piles are.
    opened: Option<Arc<Opened>>,
    piles: Vec<NewPile>,
    crew: Option<Crew>,
    worlds: Vec<Option<Settings>>,
    /// The number of the last frame: where there is a new one, someone is looking.
    frame: u64,
}

impl OtherPiles {
    /// None yet; their initial states are kept in the user's cache folder.
    pub(crate) fn new() -> Self {
        Self { folder: user_folder(), ..Self::default() }
    }

    /// Keeps initial states elsewhere.
    pub fn keep_in(&mut self, folder: PathBuf) {
        self.stop();
        self.folder = Some(folder);
    }

    /// Ends all threads and forgets what they came to.
    pub fn stop(&mut self) {
        self.crew = None;
        self.worlds.clear();
    }

    /// Whether what is open has others, and there are cores to compute them.
    pub(super) fn are_possible(&self) -> bool {
        self.folder.is_some() && idle_cores() > 0 && !self.piles.is_empty()
    }

    /// Number of threads that compute them.
    pub fn threads(&self) -> usize {
        self.crew.as_ref().map_or(0, Crew::threads)
    }

    /// Mean slump of those that have come to their end at a simulated time (s), half the width of its interval, and
    /// their number.
    pub fn mean_at(&self, world: usize, time_secs: f64) -> Option<(f64, f64, usize)> {
        let band = self.told(world)?.band;
        let (mean, half) = band.at(time_secs)?;
        Some((mean, half, band.count))
    }

    /// What is said of those of a world; nothing where it has none.
    pub(crate) fn told(&self, world: usize) -> Option<Told> {
        self.crew.as_ref()?.told(world)
    }

    /// Looks up the others of what is open.
    pub(super) fn look_up(&mut self, opened: Option<Arc<Opened>>) {
        let ends = |opened: &Option<Arc<Opened>>| opened.as_ref().map(Arc::as_ptr);
        if ends(&self.opened) != ends(&opened) {
            self.stop();
            self.piles = opened.as_ref().map_or_else(Vec::new, |opened| others_of(opened));
            self.opened = opened;
        }
    }

    /// Has them follow the worlds, those without settings left out, of the frame of that number.
    pub(super) fn follow(
        &mut self,
        context: &egui::Context,
        worlds: Vec<Option<Settings>>,
        frame: u64,
    ) {
        let (Some(opened), Some(folder), true) = (&self.opened, &self.folder, self.are_possible())
        else {
            return;
        };
        let crew = self.crew.get_or_insert_with(|| {
            let tasks = Tasks::new(Arc::clone(opened), self.piles.clone());
            Crew::start(idle_cores(), folder, context, tasks)
        });
        let changed = self.worlds != worlds;
        if changed {
            crew.follow(&worlds);
            self.worlds = worlds;
        }
        if changed || self.frame != frame {
            self.frame = frame;
            crew.keep_awake(PATIENCE);
        }
    }
}
