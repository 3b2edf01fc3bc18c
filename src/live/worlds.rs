//! Worlds that run side by side, kept at the same simulated time.

use rayon::iter::{IntoParallelRefMutIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use super::track::Track;
use crate::sim::{Settings, Simulation, Tally};

/// One track a world. The world with the largest time step leads; the others follow to within half
/// a step of their own.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Worlds {
    pub tracks: Vec<Track>,
    /// What their user calls them; empty where nothing.
    pub name: String,
}

impl Worlds {
    /// Worlds at one start, with the sums of steps before it and `recording_bytes` for the keyframes of
    /// all of them.
    pub(super) fn new(
        start: (&Simulation, Tally),
        variants: &[Settings],
        recording_bytes: usize,
    ) -> Self {
        let budget_bytes = recording_bytes / variants.len().max(1);
        let track = |variant: &Settings| Track::new(start, variant, budget_bytes);
        Self { tracks: variants.iter().map(track).collect(), name: String::new() }
    }

    pub(super) fn variants(&self) -> Vec<Settings> {
        self.tracks.iter().map(Track::variant).collect()
    }

    /// Whether any step is recorded.
    pub(super) fn have_steps(&self) -> bool {
        self.tracks.iter().any(|track| track.recording.has_steps())
    }

    /// Whether the next tick leaves what is recorded behind.
    pub(super) fn branch(&self) -> bool {
        self.tracks.iter().any(Track::branches)
    }

    /// Whether the next tick shows what is recorded.
    pub(super) fn replay(&self) -> bool {
        let replays = |track: &Track| track.recording.replays(&track.simulation);
        !self.branch() && self.tracks.iter().any(replays)
    }

    /// Keeps about that much of keyframes from now on, of all worlds together.
    pub(super) fn keep_within(&mut self, budget_bytes: usize) {
        let each = budget_bytes / self.tracks.len().max(1);
        self.tracks.iter_mut().for_each(|track| track.recording.keep_within(each));
    }

    pub(super) fn has_failed(&self) -> bool {
        self.tracks.iter().any(|track| track.failure.is_some())
    }

    fn leader(&self) -> Option<&Track> {
        self.tracks.iter().reduce(|best, next| {
            if next.time_step_secs() > best.time_step_secs() { next } else { best }
        })
    }

    /// Simulated time of the leader, s.
    pub(super) fn time_secs(&self) -> f64 {
        self.leader().map_or(0.0, Track::time_secs)
    }

    /// Time step of the leader, s.
    pub(super) fn time_step_secs(&self) -> f64 {
        self.leader().map_or(0.0, Track::time_step_secs)
    }

    /// One step of the leader, and as many of the others as bring them to the same time. Returns
    /// the number of steps of all worlds, and whether all succeeded.
    pub(super) fn tick(&mut self) -> (u64, bool) {
        let steps_before = self.steps();
        let target_secs = self.time_secs() + self.time_step_secs();
        let all_well = match self.tracks.as_mut_slice() {
            [track] => track.step(),
            tracks => tracks
                .par_iter_mut()
                .map(|track| track.catch_up(target_secs))
                .reduce(|| true, |one, other| one && other),
        };
        (self.steps() - steps_before, all_well)
    }

    /// Simulated time of the last recorded step of the leader, s.
    pub(super) fn recorded_secs(&self) -> f64 {
        self.leader().map_or(0.0, |track| track.recording.end_secs())
    }

    fn steps(&self) -> u64 {
        self.tracks.iter().map(|track| track.simulation.observables().step).sum()
    }

    /// Starts on the way to a recorded moment.
    pub(super) fn seek(&mut self, time_secs: f64) {
        for track in &mut self.tracks {
            track.seek(time_secs);
        }
    }

    /// Takes one step of a seek. Whether all worlds have arrived.
    pub(super) fn advance_seek(&mut self) -> bool {
        match self.tracks.as_mut_slice() {
            [track] => track.advance_seek(),
            tracks => tracks
                .par_iter_mut()
                .map(Track::advance_seek)
                .reduce(|| true, |one, other| one && other),
        }
    }
}
