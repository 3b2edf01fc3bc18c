//! What the solver's thread hands out.

use std::sync::Arc;
use std::time::Instant;

use super::engine::Engine;
use super::track::Track;
use super::{Controls, Frame, WorldFrame};
use crate::sim::{AlarmKind, Simulation, Snapshot};

/// The sentences of a simulation's alarms, but for the one that ends it: that is a failure.
fn alarms(simulation: &Simulation) -> Vec<Arc<str>> {
    let alarms = simulation.alarms().iter().filter(|alarm| alarm.kind != AlarmKind::NotFinite);
    alarms.map(|alarm| alarm.message(simulation.settings()).into()).collect()
}

impl Engine {
    /// Hands out the newest state, and wakes whoever waits for it.
    pub(super) fn publish(&mut self) {
        self.frames += 1;
        let worlds = self.worlds.tracks.iter().map(|track| self.world_frame(track)).collect();
        let frame = Frame {
            number: self.frames,
            acknowledged: self.acknowledged,
            start: self.info.clone(),
            worlds,
            past: self.past.told(),
            playing: self.playing,
            replaying: self.worlds.replay(),
            branching: self.worlds.branch(),
            seeking: self.seeking,
            loading: self.loading.clone(),
            refusal: self.refusal.clone(),
            real_time_factor: self.clock.real_time_factor,
            steps_per_sec: self.clock.steps_per_sec,
        };
        self.output.write(frame);
        self.published = Instant::now();
        self.unpublished = false;
        (self.options.wake)();
    }

    fn world_frame(&self, track: &Track) -> WorldFrame {
        let mut snapshot: Snapshot = track.simulation.snapshot();
        if snapshot.observables.step == 0
            && let Some(held) = &self.held
        {
            snapshot.surroundings = Arc::clone(held);
        }
        WorldFrame {
            snapshot: Arc::new(snapshot),
            controls: Controls::of(&track.simulation),
            curve: track.curve.clone(),
            recorded_from_secs: track.recording.start().time_secs(),
            recorded_secs: track.recording.end_secs(),
            unconverged_steps: track.tally.unconverged_steps,
            fallback_steps: track.tally.fallback_steps,
            step_ms: 1e3 * track.step_secs,
            substeps: track.simulation.substeps(),
            critical_time_step_secs: track.simulation.critical_time_step_secs(),
            contact_time_secs: track.simulation.contact_time_secs(),
            fracture_work: track.simulation.fracture_work(),
            alarms: alarms(&track.simulation),
            failure: track.failure.clone(),
        }
    }
}
