//! What a live run shows of itself: plain data, cheap to copy.

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
    /// Counts frames.
    pub number: u64,
    /// The last command that this frame knows of.
    pub acknowledged: u64,
    /// Counts loads.
    pub loads: u64,
    /// What the run started from; none before the first load.
    pub start: Option<Arc<LiveStart>>,
    /// The worlds, one unless they are compared.
    pub worlds: Vec<WorldFrame>,
    /// What the user calls the present run; empty where nothing.
    pub name: String,
    /// Runs that others have taken the place of, the newest last.
    pub past: Arc<[PastRun]>,
    /// The worlds of the newest of them at the simulated time that is shown, or at its end; empty if nothing is stored.
    pub ghosts: Vec<Arc<Snapshot>>,
    /// True if time passes.
    pub playing: bool,
    /// True if the next step is one that is recorded.
    pub replaying: bool,
    /// True if the next step leaves what is recorded behind.
    pub branching: bool,
    /// True if what shows is stored, and nothing is computed.
    pub stored: bool,
    /// True if a recorded moment is being computed.
    pub seeking: bool,
    /// A start that is being made.
    pub loading: Option<LoadingProgress>,
    /// Why the last start could not be made.
    pub refusal: Option<Arc<str>>,
    /// Simulated time per time on the wall, lately.
    pub real_time_factor: f64,
    /// Steps of all worlds together, lately, 1/s.
    pub steps_per_sec: f64,
}

/// One world at one moment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WorldFrame {
    /// The world. Before the first step, with the shapes that hold it.
    pub snapshot: Arc<Snapshot>,
    /// How its next step is taken.
    pub controls: Controls,
    /// Gravity where it is the same everywhere, m/s².
    pub gravity: Option<DVec2>,
    /// The observables of the whole recording.
    pub curve: Curve,
    /// True if all that is recorded was computed with the settings of the next step, and pulled by no hand.
    pub is_even: bool,
    /// Simulated time that the recording starts at, s.
    pub recorded_from_secs: f64,
    /// Simulated time of the last recorded step, s.
    pub recorded_secs: f64,
    /// Steps up to this moment that were not solved to the tolerance.
    pub unconverged_steps: u64,
    /// Mean time that a step takes lately, ms.
    pub step_ms: f64,
    /// The method that solves it, also where `auto` picks it.
    pub picked_method: Method,
    /// Substeps of its next step.
    pub substeps: u32,
    /// The longest substep that is surely stable, s, where the method has one.
    pub critical_time_step_secs: Option<f64>,
    /// How long two grains of the mean mass that meet push each other, s, where contacts are springs.
    pub contact_time_secs: Option<f64>,
    /// What it takes to break a bond slowly, where the law says so.
    pub fracture_work: Option<FractureWork>,
    /// What went wrong up to this moment, and what is most likely to help.
    pub alarms: Vec<WorldAlarm>,
    /// Why the run cannot go on from here.
    pub failure: Option<Arc<str>>,
}

/// Something that went wrong in a world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldAlarm {
    /// In which way.
    pub kind: AlarmKind,
    /// What happened, since when, and what would have helped under the settings of that step.
    pub text: Arc<str>,
    /// True if those are no longer the settings.
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

    /// True if the scene is held and has not been released.
    pub fn held(&self) -> bool {
        self.at_start() && self.start.as_ref().is_some_and(|start| !start.held_by.is_empty())
    }
}

impl WorldFrame {
    /// The present moment of a world, or one that is stored of it; before the first step in the `held` surroundings.
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

/// The alarms of a world, but for the one that ends it: that is a failure. Each advises on the settings that it was
/// raised under.
fn alarms(world: &WorldHistory) -> Vec<WorldAlarm> {
    let simulation = &world.simulation;
    let alarms = simulation.alarms().iter().copied().chain(simulation.alarm_on_placed());
    let told = alarms.filter(|alarm| alarm.kind != AlarmKind::NotFinite).map(|alarm| {
        let now = *simulation.settings();
        // Places are judged by the settings of the next step.
        let step = alarm.step + u64::from(alarm.kind == AlarmKind::PlacedInOverlap);
        let then = world.record.settings_of_step(step).unwrap_or(now);
        let text = alarm.message(&then);
        let is_earlier = then != now;
        let text = if is_earlier { format!("under earlier settings: {text}") } else { text };
        WorldAlarm { kind: alarm.kind, text: text.into(), is_earlier }
    });
    told.collect()
}
