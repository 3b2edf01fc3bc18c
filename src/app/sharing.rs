//! The link of what is shown: asked of the solver's thread, and copied when it has come.

use std::sync::mpsc::TryRecvError;

use egui::Context;

use super::link::{Link, Linking, link_of};
use super::loader::loader_of_link;
use super::state::AppState;
use super::taken::TakenRun;
use crate::error::Result;
use crate::live::{Command, Taken};

/// What is said of a link that does not say all.
const PULLED: &str = "The link is copied; something was pulled by hand, added or removed, or a wall drawn, which it does not \
                      tell: it makes another run, and a session this one.";

impl AppState {
    /// Has the link of the present moment of all worlds copied.
    pub fn copy_link(&mut self) {
        let worlds = 0..self.frame.worlds.len();
        let waiting = worlds.map(|world| TakenRun::ask(&mut self.live, world, &self.last_opened));
        self.linking = Some(Linking { waiting: waiting.collect(), come: Vec::new() });
    }

    /// Copies the link once all worlds have come.
    pub(super) fn follow_link(&mut self, context: &Context) {
        let Some(linking) = &mut self.linking else { return };
        while let Some(next) = linking.waiting.get(linking.come.len()) {
            match next.try_recv() {
                Ok(run) => linking.come.push(run),
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => break,
            }
        }
        let runs = std::mem::take(&mut linking.come);
        self.linking = None;
        match linked(runs) {
            Ok((text, is_pulled)) => {
                context.copy_text(text);
                if is_pulled {
                    self.warn(PULLED);
                } else {
                    self.tell(
                        "The link is copied: paste it into a window, or give it to slump --open.",
                    );
                }
            }
            Err(error) => self.warn(error.to_string()),
        }
    }

    /// Opens what a link tells of.
    ///
    /// # Errors
    /// Where it is none.
    pub fn open_link(&mut self, text: &str) -> Result<()> {
        let link = Link::read(text)?;
        self.load_link(link);
        Ok(())
    }

    /// Opens what a link tells of.
    pub(super) fn load_link(&mut self, link: Link) {
        self.leave_tour();
        self.live.send(Command::Load(loader_of_link(link, self.last_opened.clone())));
    }
}

/// The link of worlds, and whether a hand has pulled in any of them.
fn linked(runs: Vec<TakenRun>) -> Result<(String, bool)> {
    let config = runs.first().map(|run| run.opened.config.clone()).unwrap_or_default();
    let worlds: Vec<Taken> = runs.into_iter().map(|run| run.taken).collect();
    let is_pulled = worlds.iter().any(|world| {
        let mut made = world.replay.changes(0, world.simulation.time_secs());
        made.any(|change| change.controls.pull.is_some()) || !world.replay.edits().is_empty()
    });
    Ok((link_of(&config, &worlds)?, is_pulled))
}
