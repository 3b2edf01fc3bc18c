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
            name: self.worlds.name.clone(),
            past: self.past.told(),
            playing: self.playing,
            replaying: self.worlds.replay(),
            branching: self.worlds.branch(),
            seeking: self.seeking,
            stored: self.film.is_some(),
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

    /// The present moment of a world; before the first step, with the shapes that hold it.
    fn present(&self, track: &Track) -> Arc<Snapshot> {
        let mut snapshot: Snapshot = track.simulation.snapshot();
        if snapshot.observables.step == 0
            && let Some(held) = &self.held
        {
            snapshot.surroundings = Arc::clone(held);
        }
        Arc::new(snapshot)
    }

    fn world_frame(&self, track: &Track) -> WorldFrame {
        let stored = self.film.and_then(|secs| track.film.at(secs));
        let tally = stored.map_or(track.tally, |moment| moment.tally);
        let gravity = stored.map_or(track.simulation.world().gravity, |moment| moment.gravity);
        let now = Controls::of(&track.simulation);
        let controls = stored.and_then(|moment| {
            track.recording.controls_after(moment.snapshot.observables.step).copied()
        });
        let snapshot =
            stored.map_or_else(|| self.present(track), |moment| Arc::clone(&moment.snapshot));
        let sweeps = f64::from(snapshot.observables.sweeps);
        WorldFrame {
            snapshot,
            controls: controls.unwrap_or(now),
            gravity: match gravity {
                Gravity::Uniform { acceleration } => Some(acceleration),
                Gravity::Attraction { .. } => None,
            },
            curve: track.curve.clone(),
            is_even: track.recording.is_all_with(track.simulation.settings()),
            recorded_from_secs: track.recording.start().time_secs(),
            recorded_secs: track.recording.end_secs(),
            unconverged_steps: tally.unconverged_steps,
            fallback_steps: tally.fallback_steps,
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
