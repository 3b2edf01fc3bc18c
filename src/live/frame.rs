//! Frames: the data that a live run (a simulation that the user watches while it is computed) sends to the window,
//! which draws them. Frames are cheap to copy.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::stored_moments::StoredMoment;
use super::{Controls, Curve, LiveStart, LoadingProgress, PastRun, WorldHistory};
use crate::sim::{AlarmKind, FractureWork, Snapshot, Surroundings};
use crate::solver::Method;
use crate::world::Gravity;

/// A frame: the newest state of a live run (a simulation that the user watches while it is computed), in the form that
/// the window draws.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LiveFrame {
    /// Number of this frame (one set of data for the window to draw), counted from 1.
    pub number: u64,
    /// Number of the last command whose effect this frame (the data that the window draws) shows.
    pub acknowledged: u64,
    /// Number of initial states that have been loaded so far.
    pub loads: u64,
    /// Initial state of the run; `None` before the first load.
    pub start: Option<Arc<LiveStart>>,
    /// The worlds (simulations side by side). There is one world, unless the user compares several settings.
    pub worlds: Vec<WorldFrame>,
    /// Summaries of the earlier runs, the newest last, followed by the undone runs (from which the user went back),
    /// starting with the next one to redo.
    pub past: Arc<[PastRun]>,
    /// Snapshots of the newest earlier run at the displayed simulated time, or the last snapshots before that time that
    /// were stored. The window draws them as outlines for comparison. The list is empty if no snapshot is stored.
    pub ghosts: Vec<Arc<Snapshot>>,
    /// True if the run is playing, so that simulated time advances.
    pub playing: bool,
    /// True if the next step repeats a step that is already recorded.
    pub replaying: bool,
    /// True if later steps are recorded, but the next step does not repeat them, because the present settings differ
    /// from the recorded settings. The next step then begins a new run.
    pub branching: bool,
    /// True if a stored snapshot (a past state kept for display) is shown and nothing is computed.
    pub stored: bool,
    /// True if a recorded state or a long single step is being computed.
    pub seeking: bool,
    /// Progress while an initial state is computed or read; `None` at other times.
    pub loading: Option<LoadingProgress>,
    /// The error message if the last load, edit or change of settings was refused; otherwise `None`.
    pub refusal: Option<Arc<str>>,
    /// Simulated time per wall-clock time (dimensionless), averaged over 300 ms.
    pub real_time_factor: f64,
    /// Steps of all simulations per second of wall-clock time, 1/s, averaged over 300 ms.
    pub steps_per_sec: f64,
}

/// One world (simulation) at one simulated time, in the form that the window draws.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WorldFrame {
    /// Positions, velocities, contacts and observables (measured quantities). Before the first step, the snapshot
    /// includes the walls that support the grains only until the first step.
    pub snapshot: Arc<Snapshot>,
    /// The controls (settings and pull of a grain) of the next step.
    pub controls: Controls,
    /// Acceleration of gravity, m/s²; `None` if gravity is not uniform.
    pub gravity: Option<DVec2>,
    /// Observables (measured quantities) after each recorded step, for plots.
    pub curve: Curve,
    /// True if all recorded steps have the settings of the next step, and the user neither edited the simulation nor
    /// pulled a grain.
    pub is_even: bool,
    /// Simulated time before the first recorded step, s.
    pub recorded_from_secs: f64,
    /// Simulated time of the last recorded step, s.
    pub recorded_secs: f64,
    /// Number of steps up to the displayed time that did not reach the solver's tolerance.
    pub unconverged_steps: u64,
    /// Wall-clock time that the solver's thread needs per step, ms, as a running mean.
    pub step_ms: f64,
    /// The solver's method for the next step. If the user chose `auto`, this is the method that `auto` picks.
    pub picked_method: Method,
    /// Number of substeps of the next step.
    pub substeps: u32,
    /// Longest substep that is known to be stable, s; `None` if the stepper has no such limit.
    pub critical_time_step_secs: Option<f64>,
    /// Duration of the collision of two grains of mean mass, s; `None` if the stepper does not represent contacts by
    /// springs.
    pub contact_time_secs: Option<f64>,
    /// Work that pulls two bonded grains of mean mass apart slowly: in J, and divided by the work that lifts one of
    /// them by the mean diameter. `None` if the contact law does not define this work.
    pub fracture_work: Option<FractureWork>,
    /// Warnings about the run up to the displayed time, with advice.
    pub alarms: Vec<WorldAlarm>,
    /// The reason why the simulation cannot continue from the displayed state; `None` if it can.
    pub failure: Option<Arc<str>>,
}

/// A warning about a world (simulation), for example that energy was created.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldAlarm {
    /// Kind of the warning.
    pub kind: AlarmKind,
    /// Message: the problem, the simulated time of the first step with this problem, and advice for the settings of
    /// that step.
    pub text: Arc<str>,
    /// True if the problem arose under other settings than the present settings.
    pub is_earlier: bool,
}

impl LiveFrame {
    /// Simulated time of the first simulation in the list, s.
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

    /// True before the first step if some walls support the grains only until that step.
    pub fn held(&self) -> bool {
        self.at_start() && self.start.as_ref().is_some_and(|start| !start.held_by.is_empty())
    }
}

impl WorldFrame {
    /// Returns the data to draw: the present state of a simulation, or the snapshot `stored` if one is given. Before
    /// the first step, the walls and discs that are not grains are replaced by `held`, which includes the walls that
    /// support the grains only until the first step.
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

/// Returns the warnings about a simulation, with advice for the settings of the step in which each warning was raised.
/// The warning that the state is no longer finite is left out, because it is reported as the failure.
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
