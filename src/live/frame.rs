//! Frames: what a live run shows, as plain data that is cheap to copy.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::stored_moments::StoredMoment;
use super::{Controls, Curve, LiveStart, LoadingProgress, PastRun, WorldHistory};
use crate::sim::{AlarmKind, FractureWork, Snapshot, Surroundings};
use crate::solver::Method;
use crate::world::Gravity;

/// The newest moment of a live run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LiveFrame {
    /// Number of the frame.
    pub number: u64,
    /// Number of the last command that this frame takes into account.
    pub acknowledged: u64,
    /// Number of loads.
    pub loads: u64,
    /// Start of the run; `None` before the first load.
    pub start: Option<Arc<LiveStart>>,
    /// The worlds; one unless worlds are compared.
    pub worlds: Vec<WorldFrame>,
    /// The user's name of the present run; may be empty.
    pub name: String,
    /// Earlier runs, the newest last, then those that were undone, the next one first.
    pub past: Arc<[PastRun]>,
    /// The worlds of the newest earlier run at the visible simulated time, or at its end. Empty if nothing is stored.
    pub ghosts: Vec<Arc<Snapshot>>,
    /// True if time passes.
    pub playing: bool,
    /// True if the next step is recorded already.
    pub replaying: bool,
    /// True if the next step branches off from the record.
    pub branching: bool,
    /// True if a stored moment is shown and nothing is computed.
    pub stored: bool,
    /// True if a recorded moment is being computed.
    pub seeking: bool,
    /// Progress of a start that is being made.
    pub loading: Option<LoadingProgress>,
    /// Why the last start failed.
    pub refusal: Option<Arc<str>>,
    /// Recent simulated time per wall-clock time.
    pub real_time_factor: f64,
    /// Recent steps of all worlds together, 1/s.
    pub steps_per_sec: f64,
}

/// One world at one moment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WorldFrame {
    /// The state. Before the first step, it includes the shapes that hold the grains.
    pub snapshot: Arc<Snapshot>,
    /// The controls of the next step.
    pub controls: Controls,
    /// Gravity, if it is uniform, m/s².
    pub gravity: Option<DVec2>,
    /// Observables of the whole record.
    pub curve: Curve,
    /// True if all recorded steps have the settings of the next step, and no hand pulled a grain.
    pub is_even: bool,
    /// Simulated time at the beginning of the record, s.
    pub recorded_from_secs: f64,
    /// Simulated time of the last recorded step, s.
    pub recorded_secs: f64,
    /// Steps up to this moment that did not reach the tolerance.
    pub unconverged_steps: u64,
    /// Recent mean time per step, ms.
    pub step_ms: f64,
    /// The method that solves the next step, also if `auto` picks it.
    pub picked_method: Method,
    /// Substeps of the next step.
    pub substeps: u32,
    /// Longest substep that is certainly stable, s, if the stepper has such a limit.
    pub critical_time_step_secs: Option<f64>,
    /// Contact time of two colliding grains of mean mass, s, if contacts are springs.
    pub contact_time_secs: Option<f64>,
    /// Work of breaking a bond slowly, if the law defines it.
    pub fracture_work: Option<FractureWork>,
    /// Alarms up to this moment, with advice.
    pub alarms: Vec<WorldAlarm>,
    /// Why the run cannot continue from here.
    pub failure: Option<Arc<str>>,
}

/// An alarm of a world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldAlarm {
    /// Kind of the alarm.
    pub kind: AlarmKind,
    /// Message: the event, the time of its first step, and advice for the settings of that step.
    pub text: Arc<str>,
    /// True if the settings have changed since then.
    pub is_earlier: bool,
}

impl LiveFrame {
    /// Simulated time of the first world, s.
    pub fn time_secs(&self) -> f64 {
        self.worlds.first().map_or(0.0, |world| world.snapshot.observables.time_secs)
    }

    /// Simulated time of the last recorded step of any world, s.
    pub fn recorded_secs(&self) -> f64 {
        self.worlds.iter().map(|world| world.recorded_secs).fold(0.0, f64::max)
    }

    /// True if the run is at its start.
    pub fn at_start(&self) -> bool {
        self.worlds.iter().all(|world| world.snapshot.observables.step == 0)
    }

    /// True if shapes hold the grains, which have not been released.
    pub fn held(&self) -> bool {
        self.at_start() && self.start.as_ref().is_some_and(|start| !start.held_by.is_empty())
    }
}

impl WorldFrame {
    /// The present moment of a world, or a stored one. Before the first step, it has the `held` surroundings.
    pub(super) fn of(
        world: &WorldHistory,
        stored: Option<&StoredMoment>,
        held: Option<&Arc<Surroundings>>,
    ) -> Self {
        let simulation = &world.simulation;
        let tally = stored.map_or(world.tally, |moment| moment.tally);
        let gravity = stored.map_or(simulation.world().gravity, |moment| moment.gravity);
        let controls = stored.and_then(|moment| {
            world.record.controls_after(moment.snapshot.observables.step).copied()
        });
        let present = || {
            let mut snapshot: Snapshot = simulation.snapshot();
            if let Some(held) = held.filter(|_| snapshot.observables.step == 0) {
                snapshot.surroundings = Arc::clone(held);
            }
            Arc::new(snapshot)
        };
        let snapshot = stored.map_or_else(present, |moment| Arc::clone(&moment.snapshot));
        Self {
            snapshot,
            controls: controls.unwrap_or_else(|| Controls::of(simulation)),
            gravity: match gravity {
                Gravity::Uniform { acceleration } => Some(acceleration),
                Gravity::Attraction { .. } => None,
            },
            curve: world.curve.clone(),
            is_even: world.record.is_all_with(simulation.settings()),
            recorded_from_secs: world.record.start().time_secs(),
            recorded_secs: world.record.end_secs(),
            unconverged_steps: tally.unconverged_steps,
            step_ms: 1e3 * world.step_secs,
            substeps: simulation.substeps(),
            picked_method: simulation.picked_method(),
            critical_time_step_secs: simulation.critical_time_step_secs(),
            contact_time_secs: simulation.contact_time_secs(),
            fracture_work: simulation.fracture_work(),
            alarms: alarms(world),
            failure: world.failure.clone(),
        }
    }
}

/// The alarms of a world except the alarm that ends it, which is its failure. Each advises on the settings under
/// which it was raised.
fn alarms(world: &WorldHistory) -> Vec<WorldAlarm> {
    let simulation = &world.simulation;
    let alarms = simulation.alarms().iter().copied().chain(simulation.alarm_on_placed());
    let told = alarms.filter(|alarm| alarm.kind != AlarmKind::NotFinite).map(|alarm| {
        let now = *simulation.settings();
        // An overlap of placed grains concerns the next step's settings.
        let step = alarm.step + u64::from(alarm.kind == AlarmKind::PlacedInOverlap);
        let then = world.record.settings_of_step(step).unwrap_or(now);
        let text = alarm.message_in_millis(&then);
        let is_earlier = then != now;
        let text = if is_earlier { format!("under earlier settings: {text}") } else { text };
        WorldAlarm { kind: alarm.kind, text: text.into(), is_earlier }
    });
    told.collect()
}
