//! What the solver's thread hands out.

use std::sync::Arc;
use std::time::Instant;

use super::engine::Engine;
use super::track::Track;
use super::{Controls, Frame, WorldAlarm, WorldFrame};
use crate::sim::{Alarm, AlarmKind, Snapshot};
use crate::world::Gravity;

/// The alarms of a world, but for the one that ends it: that is a failure. Each advises on the settings that it was
/// raised under.
fn alarms(track: &Track) -> Vec<WorldAlarm> {
    let simulation = &track.simulation;
    let at_start = Alarm::of_start(simulation.observables());
    let alarms = simulation.alarms().iter().copied().chain(at_start);
    let told = alarms.filter(|alarm| alarm.kind != AlarmKind::NotFinite).map(|alarm| {
        let now = *simulation.settings();
        let then = track.recording.settings_of_step(alarm.step).unwrap_or(now);
        let text = alarm.message(&then);
        let is_earlier = then != now;
        let text = if is_earlier { format!("under earlier settings: {text}") } else { text };
        WorldAlarm { kind: alarm.kind, text: text.into(), is_earlier }
    });
    told.collect()
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
        let sweeps = f64::from(snapshot.observables.sweeps);
        WorldFrame {
            snapshot: Arc::new(snapshot),
            controls: Controls::of(&track.simulation),
            gravity: match track.simulation.world().gravity {
                Gravity::Uniform { acceleration } => Some(acceleration),
                Gravity::Attraction { .. } => None,
            },
            curve: track.curve.clone(),
            is_even: track.recording.is_all_with(track.simulation.settings()),
            recorded_from_secs: track.recording.start().time_secs(),
            recorded_secs: track.recording.end_secs(),
            unconverged_steps: track.tally.unconverged_steps,
            fallback_steps: track.tally.fallback_steps,
            step_ms: 1e3 * track.step_secs,
            substeps: track.simulation.substeps(),
            picked_method: track.simulation.picked_method(),
            critical_time_step_secs: track.simulation.critical_time_step_secs(),
            contact_time_secs: track.simulation.contact_time_secs(),
            sweep_elasticity: track.simulation.sweep_elasticity(sweeps),
            fracture_work: track.simulation.fracture_work(),
            alarms: alarms(track),
            failure: track.failure.clone(),
        }
    }
}
