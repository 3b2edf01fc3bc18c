//! Runs that others have taken the place of. Nothing that was computed is lost by a reset, by other worlds, or by
//! going on differently from an earlier moment.

use std::sync::Arc;

use super::film::Film;
use super::worlds::Worlds;
use super::{Controls, Curve};
use crate::sim::Snapshot;

/// Most runs that are kept; the oldest go.
const MOST: usize = 4;
/// Of the memory for keyframes, what one of them gets.
const PART: usize = 8;

/// What a window is told of an earlier run.
#[derive(Clone, Debug)]
pub struct PastRun {
    /// What it is called up by ([`Command::Return`](super::Command::Return)).
    pub number: u64,
    /// What its user calls it; empty where nothing.
    pub name: String,
    /// Simulated time of its last recorded step, s.
    pub recorded_secs: f64,
    /// Its worlds.
    pub worlds: Vec<PastWorld>,
}

/// One world of an earlier run.
#[derive(Clone, Debug)]
pub struct PastWorld {
    /// How its last step was taken.
    pub controls: Controls,
    /// The observables of all that is recorded.
    pub curve: Curve,
    /// Where it was when it was left.
    pub snapshot: Arc<Snapshot>,
}

/// The runs that are kept, the newest last.
#[derive(Default)]
pub(super) struct Past {
    runs: Vec<(PastRun, Worlds)>,
    told: Arc<[PastRun]>,
    count: u64,
}

impl Past {
    /// Keeps worlds of which something is recorded, with a part of that much memory for keyframes.
    pub(super) fn keep(&mut self, mut worlds: Worlds, recording_bytes: usize) {
        if !worlds.have_steps() {
            return;
        }
        worlds.keep_within(recording_bytes / PART);
        worlds.tracks.iter_mut().for_each(|track| track.film = Film::default());
        self.count += 1;
        let of_world = worlds.tracks.iter().map(|track| PastWorld {
            controls: Controls::of(&track.simulation),
            curve: track.curve.clone(),
            snapshot: Arc::new(track.simulation.snapshot()),
        });
        let ends = worlds.tracks.iter().map(|track| track.recording.end_secs());
        let run = PastRun {
            number: self.count,
            name: worlds.name.clone(),
            recorded_secs: ends.fold(0.0, f64::max),
            worlds: of_world.collect(),
        };
        self.runs.push((run, worlds));
        if self.runs.len() > MOST {
            self.runs.remove(0);
        }
        self.tell();
    }

    /// Takes a run out.
    pub(super) fn take(&mut self, number: u64) -> Option<Worlds> {
        let index = self.runs.iter().position(|(run, _)| run.number == number)?;
        let (_, worlds) = self.runs.remove(index);
        self.tell();
        Some(worlds)
    }

    /// Calls a run by a name.
    pub(super) fn name(&mut self, number: u64, name: String) {
        if let Some((run, worlds)) = self.runs.iter_mut().find(|(run, _)| run.number == number) {
            run.name.clone_from(&name);
            worlds.name = name;
            self.tell();
        }
    }

    /// All of them, the oldest first.
    pub(super) fn runs(&self) -> impl Iterator<Item = &Worlds> {
        self.runs.iter().map(|(_, worlds)| worlds)
    }

    /// Forgets all of them.
    pub(super) fn forget(&mut self) {
        self.runs.clear();
        self.tell();
    }

    /// What a window is told of them, the newest last.
    pub(super) fn told(&self) -> Arc<[PastRun]> {
        Arc::clone(&self.told)
    }

    fn tell(&mut self) {
        self.told = self.runs.iter().map(|(run, _)| run.clone()).collect();
    }
}
