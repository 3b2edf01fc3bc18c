//! Runs that are taken down: what the solver's thread hands out, with the scene that it is of.

use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};

use crate::config::Config;
use crate::live::{Command, Live, Taken};
use crate::scene::Scene;

/// What a run began with.
#[derive(Debug)]
pub(crate) struct Opened {
    /// Its scene.
    pub scene: Scene,
    /// What opens that scene again.
    pub config: Config,
}

/// What was opened last. It is noted where a start is made and looked up where a run is taken down, both on
/// the solver's thread, so that it is of the run that is there.
#[derive(Clone, Debug, Default)]
pub(crate) struct LastOpened(Arc<Mutex<Option<Arc<Opened>>>>);

impl LastOpened {
    /// Notes what is opened.
    pub(crate) fn note(&self, opened: Opened) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(opened));
    }

    /// What was opened last; nothing before the first.
    pub(crate) fn get(&self) -> Option<Arc<Opened>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// A run that is to be written down.
pub(crate) struct TakenRun {
    /// What it began with.
    pub opened: Arc<Opened>,
    /// What it has come to.
    pub taken: Taken,
}

impl TakenRun {
    /// Asks for a world's run. It comes between two steps; nothing comes where that world is gone.
    pub(crate) fn ask(live: &mut Live, world: usize, opened: &LastOpened) -> Receiver<Self> {
        let (sender, receiver) = channel();
        let opened = opened.clone();
        let hand_on = move |taken| {
            if let Some(opened) = opened.get() {
                // Whoever asked may have gone.
                let _ = sender.send(Self { opened, taken });
            }
        };
        live.send(Command::Take(world, Box::new(hand_on)));
        receiver
    }
}
