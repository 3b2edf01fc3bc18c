//! Frames: the data that a live run sends to the window for display, which are cheap to copy.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::stored_moments::StoredMoment;
use super::{Controls, Curve, LiveStart, LoadingProgress, PastRun, WorldHistory};
use crate::sim::{AlarmKind, FractureWork, Snapshot, Surroundings};
use crate::solver::Method;
use crate::world::Gravity;

/// The newest state of a live run, for display.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LiveFrame {
    /// Number of this frame, counted from 1.
    pub number: u64,
    /// Number of the last command whose effect this frame shows.
    pub acknowledged: u64,
    /// Number of initial states that have been loaded so far.
    pub loads: u64,
    /// Initial state of the run; `None` before the first load.
    pub start: Option<Arc<LiveStart>>,
    /// The worlds (simulations side by side). There is one, except if worlds are compared.
    pub worlds: Vec<WorldFrame>,
    /// The user's name for the present run; may be empty.
    pub name: String,
    /// Summaries of the earlier runs, the newest last, followed by the undone runs, starting with the next one to redo.
    pub past: Arc<[PastRun]>,
    /// States of the newest earlier run at the displayed simulated time, or at its last stored moment before that time.
    /// The window draws them as outlines for comparison. The list is empty if no moment is stored.
    pub ghosts: Vec<Arc<Snapshot>>,
    /// True if the run is playing, so that simulated time advances.
    pub playing: bool,
    /// True if the next step repeats a recorded step.
    pub replaying: bool,
    /// True if the next step branches off from the record, because the settings differ from the recorded ones.
    pub branching: bool,
    /// True if a stored moment is shown and nothing is computed.
    pub stored: bool,
    /// True if a recorded moment or a long single step is being computed.
    pub seeking: bool,
    /// Progress of the making of an initial state; `None` if none is being made.
    pub loading: Option<LoadingProgress>,
    /// The reason why the last load, edit or change of settings was refused, if it was.
    pub refusal: Option<Arc<str>>,
    /// Simulated time per wall-clock time, averaged over 300 ms.
    pub real_time_factor: f64,
    /// Steps of all simulations per second of wall-clock time, 1/s, averaged over 300 ms.
    pub steps_per_sec: f64,
}

/// One world (simulation) at one moment, for display.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WorldFrame {
    /// Positions, velocities, contacts and observables. Before the first step, the walls that hold the grains until
    /// time begins are included.
    pub snapshot: Arc<Snapshot>,
    /// The controls (settings and pull of a grain) of the next step.
    pub controls: Controls,
    /// Acceleration of gravity, m/s²; `None` if gravity is not uniform.
    pub gravity: Option<DVec2>,
    /// Observables of all recorded steps, for plots.
    pub curve: Curve,
    /// True if all recorded steps have the settings of the next step, and the user neither edited the simulation nor
    /// pulled a grain.
    pub is_even: bool,
    /// Simulated time at the beginning of the record, s.
    pub recorded_from_secs: f64,
    /// Simulated time of the last recorded step, s.
    pub recorded_secs: f64,
    /// Number of steps up to this moment that did not reach the tolerance.
    pub unconverged_steps: u64,
    /// Wall-clock time per step, ms, as a running mean.
    pub step_ms: f64,
    /// The solver's method for the next step. If the user chose `auto`, this is the method that `auto` picks.
    pub picked_method: Method,
    /// Number of substeps of the next step.
    pub substeps: u32,
    /// Longest substep that is certainly stable, s; `None` if the stepper has no such limit.
    pub critical_time_step_secs: Option<f64>,
    /// Duration of the collision of two grains of mean mass, s; `None` if contacts are not springs.
    pub contact_time_secs: Option<f64>,
    /// Work of breaking a bond slowly; `None` if the contact law does not define this work.
    pub fracture_work: Option<FractureWork>,
    /// Warnings about the run up to this moment, with advice.
    pub alarms: Vec<WorldAlarm>,
    /// The reason why the simulation cannot continue from this moment, if it cannot.
    pub failure: Option<Arc<str>>,
}

/// A warning about a world (simulation).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldAlarm {
    /// Kind of the warning.
    pub kind: AlarmKind,
    /// Message: the event, the simulated time of its first step, and advice for the settings of that step.
    pub text: Arc<str>,
    /// True if the present settings differ from the settings at the time of the event.
    pub is_earlier: bool,
}

impl LiveFrame {
    /// Simulated time of the first simulation, s.
    pub fn time_secs(&self) -> f64 {
        self.worlds.first().map_or(0.0, |world| world.snapshot.observables.time_secs)
    }

    /// Simulated time of the last recorded step of any simulation, s.
    pub fn recorded_secs(&self) -> f64 {
        self.worlds.iter().map(|world| world.recorded_secs).fold(0.0, f64::max)
    }

    /// True if no simulation has taken a step since the initial state.
    pub fn at_start(&self) -> bool {
        self.worlds.iter().all(|world| world.snapshot.observables.step == 0)
    }

    /// True if walls still hold the grains, because time has not begun.
    pub fn held(&self) -> bool {
        self.at_start() && self.start.as_ref().is_some_and(|start| !start.held_by.is_empty())
    }
}

impl WorldFrame {
    /// Returns the present moment of a simulation, or the stored moment if one is given. Before the first step, the
    /// frame has the surroundings `held`, which include the walls that are removed when time begins.
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

/// Returns the warnings about a simulation, except the warning that the state is no longer finite, which is reported as
/// the failure. Each advises on the settings of the step in which it was raised.
fn alarms(world: &WorldHistory) -> Vec<WorldAlarm> {
    let simulation = &world.simulation;
    let alarms = simulation.alarms().iter().copied().chain(simulation.alarm_on_placed());
    let told = alarms.filter(|alarm| alarm.kind != AlarmKind::NotFinite).map(|alarm| {
        let now = *simulation.settings();
        // An overlap of placed grains concerns the settings of the next step.
        let step = alarm.step + u64::from(alarm.kind == AlarmKind::PlacedInOverlap);
        let then = world.record.settings_of_step(step).unwrap_or(now);
        let text = alarm.message_in_millis(&then);
        let is_earlier = then != now;
        let text = if is_earlier { format!("under earlier settings: {text}") } else { text };
        WorldAlarm { kind: alarm.kind, text: text.into(), is_earlier }
    });
    told.collect()
}
