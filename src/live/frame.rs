//! What a live run shows of itself: plain data, cheap to copy.

use std::sync::Arc;

use glam::DVec2;

use super::{Controls, Curve, PastRun, Progress};
use crate::error::Error;
use crate::sim::{AlarmKind, FractureWork, Settings, Snapshot, SweepElasticity};
use crate::solver::Method;
use crate::world::Physics;

/// The newest moment of a live run.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Counts frames.
    pub number: u64,
    /// The last command that this frame knows of.
    pub acknowledged: u64,
    /// What the run started from; none before the first load.
    pub start: Option<Arc<StartInfo>>,
    /// The worlds, one unless they are compared.
    pub worlds: Vec<WorldFrame>,
    /// What the user calls the present run; empty where nothing.
    pub name: String,
    /// Runs that others have taken the place of, the newest last.
    pub past: Arc<[PastRun]>,
    /// Whether time passes.
    pub playing: bool,
    /// Whether the next step is one that is recorded.
    pub replaying: bool,
    /// Whether the next step leaves what is recorded behind.
    pub branching: bool,
    /// Whether what shows is stored, and nothing is computed.
    pub stored: bool,
    /// Whether a recorded moment is being computed.
    pub seeking: bool,
    /// A start that is being made.
    pub loading: Option<Progress>,
    /// Why the last start could not be made.
    pub refusal: Option<Arc<str>>,
    /// Simulated time per time on the wall, lately.
    pub real_time_factor: f64,
    /// Steps of all worlds together, lately, 1/s.
    pub steps_per_sec: f64,
}

/// What does not change after a load.
#[derive(Clone, Debug)]
pub struct StartInfo {
    /// Counts loads.
    pub number: u64,
    /// Name of the scene.
    pub name: String,
    /// Where the run pauses once, s.
    pub duration_secs: f64,
    /// Whether shapes hold the start until it is released.
    pub held: bool,
    /// Lower left and upper right corner of what pictures show, m.
    pub view: [DVec2; 2],
    /// Whether it is one of a heap on level ground, of which slump tells.
    pub slumps: bool,
    /// The physics that the scene computes.
    pub physics: Physics,
    /// The settings that the scene states.
    pub settings: Settings,
}

/// One world at one moment.
#[derive(Clone, Debug)]
pub struct WorldFrame {
    /// The world. Before the first step, with the shapes that hold it.
    pub snapshot: Arc<Snapshot>,
    /// How its next step is taken.
    pub controls: Controls,
    /// Gravity where it is the same everywhere, m/s².
    pub gravity: Option<DVec2>,
    /// The observables of the whole recording.
    pub curve: Curve,
    /// Whether all that is recorded was computed with the settings of the next step, and pulled by no hand.
    pub is_even: bool,
    /// Simulated time that the recording starts at, s.
    pub recorded_from_secs: f64,
    /// Simulated time of the last recorded step, s.
    pub recorded_secs: f64,
    /// Steps up to this moment that were not solved to the tolerance.
    pub unconverged_steps: u64,
    /// How many of these were solved under bounds of friction instead of Coulomb's law.
    pub fallback_steps: u64,
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
    /// What the sweeps of its last step make of the pile, where steps are swept.
    pub sweep_elasticity: Option<SweepElasticity>,
    /// What it takes to break a bond slowly, where the law says so.
    pub fracture_work: Option<FractureWork>,
    /// What went wrong up to this moment, and what is most likely to help.
    pub alarms: Vec<WorldAlarm>,
    /// Why the run cannot go on from here.
    pub failure: Option<Arc<str>>,
}

/// Something that went wrong in a world.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldAlarm {
    /// In which way.
    pub kind: AlarmKind,
    /// What happened, since when, and what would have helped under the settings of that step.
    pub text: Arc<str>,
    /// Whether those are no longer the settings.
    pub is_earlier: bool,
}

impl Frame {
    /// Simulated time of the first world, s.
    pub fn time_secs(&self) -> f64 {
        self.worlds.first().map_or(0.0, |world| world.snapshot.observables.time_secs)
    }

    /// Simulated time of the last recorded step of any world, s.
    pub fn recorded_secs(&self) -> f64 {
        self.worlds.iter().map(|world| world.recorded_secs).fold(0.0, f64::max)
    }

    /// Whether the run is at its start.
    pub fn at_start(&self) -> bool {
        self.worlds.iter().all(|world| world.snapshot.observables.step == 0)
    }

    /// Whether the scene is held and has not been released.
    pub fn held(&self) -> bool {
        self.at_start() && self.start.as_ref().is_some_and(|start| start.held)
    }
}

/// An error as frames carry it.
pub(super) fn message(error: Error) -> Arc<str> {
    error.to_string().into()
}
