//! Making a start on the solver's thread, with progress told and commands heard.

use std::sync::Arc;
use std::time::Duration;

use super::engine::Engine;
use super::frame::message;
use super::worlds::Worlds;
use super::{Command, Loader, Progress, Record, Start, StartInfo};
use crate::sim::{Settings, Surroundings};

/// Least time between two frames that tell of the progress of a loading.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(50);

impl Engine {
    /// Replaces everything by what `loader` makes, unless that fails or is given up.
    pub(super) fn load(&mut self, loader: Loader) {
        self.playing = false;
        self.leave_film();
        self.refusal = None;
        self.loading = Some(Progress::default());
        self.publish();
        let mut cancelled = false;
        let outcome = loader(&mut |progress| {
            self.tell_progress(progress);
            cancelled |= self.is_interrupted();
            !cancelled
        });
        self.loading = None;
        match outcome {
            Ok(start) => self.begin(start),
            Err(_) if cancelled => {}
            Err(error) => self.refusal = Some(message(error)),
        }
    }

    fn tell_progress(&mut self, progress: Progress) {
        self.loading = Some(progress);
        if self.published.elapsed() >= PROGRESS_INTERVAL {
            self.publish();
        }
    }

    /// Whether a command came that makes the present loading pointless. The others wait.
    fn is_interrupted(&mut self) -> bool {
        let mut interrupted = false;
        while let Ok((number, command)) = self.inbox.try_recv() {
            interrupted |=
                matches!(command, Command::CancelLoading | Command::Load(_) | Command::Quit);
            self.waiting.push_back((number, command));
        }
        interrupted
    }

    fn begin(&mut self, mut start: Start) {
        self.loads += 1;
        let settings = *start.simulation.settings();
        let alone = [settings];
        self.info = Some(Arc::new(StartInfo {
            number: self.loads,
            name: start.name.clone(),
            duration_secs: start.duration_secs,
            held: !start.held_by.is_empty(),
            view: start.view,
            slumps: start.slumps,
            physics: start.simulation.physics(),
            settings,
        }));
        let mut surroundings = Surroundings::clone(&start.simulation.snapshot().surroundings);
        surroundings.boundaries.extend_from_slice(&start.held_by);
        self.held = Some(Arc::new(surroundings));
        self.worlds = Worlds::default();
        self.past.forget();
        let worlds = std::mem::take(&mut start.worlds);
        let record = start.record.take();
        self.start = Some(start);
        match record {
            Some(record) => self.take_up(record),
            None => self.restart(if worlds.is_empty() { &alone } else { &worlds }),
        }
    }

    /// Puts worlds at the start, one a variant.
    pub(super) fn restart(&mut self, variants: &[Settings]) {
        let Some(start) = &self.start else { return };
        if variants.is_empty() {
            return;
        }
        let start = (&start.simulation, start.tally);
        let worlds = Worlds::new(start, variants, self.options.recording_bytes);
        self.put_in_place(worlds);
    }

    /// Goes on with what a run had come to.
    fn take_up(&mut self, record: Record) {
        let (mut worlds, past) = record.into_parts();
        for run in past {
            self.past.keep(run, self.options.recording_bytes);
        }
        worlds.keep_within(self.options.recording_bytes);
        self.put_in_place(worlds);
    }

    /// Keeps the present worlds for later, and goes on with others.
    pub(super) fn put_in_place(&mut self, worlds: Worlds) {
        let before = std::mem::replace(&mut self.worlds, worlds);
        self.past.keep(before, self.options.recording_bytes);
        self.playing = false;
        self.seeking = false;
        self.film = None;
    }
}
