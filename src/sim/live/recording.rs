//! What is kept of a run so that any of its moments can be computed again, bit for bit.
//!
//! A simulation is a function of its state and its settings, and a clone goes on as the original
//! would. So a recording is some clones, the keyframes, and every change of the settings; a moment
//! is the keyframe before it and the steps from there. Where memory runs out, every second keyframe
//! goes: the whole run stays within reach, at the price of more steps to get anywhere.

use crate::sim::{Pull, Settings, Simulation};

/// Steps between keyframes at first.
const FIRST_SPACING: u64 = 32;

/// All that can be changed between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls {
    /// How the next step is taken.
    pub settings: Settings,
    /// Spring on a grain.
    pub pull: Option<Pull>,
}

impl Controls {
    /// Those of a simulation's next step.
    pub(crate) fn of(simulation: &Simulation) -> Self {
        Self { settings: *simulation.settings(), pull: simulation.pull() }
    }
}

/// The recorded part of a run.
#[derive(Clone, Debug)]
pub(crate) struct Recording {
    keyframes: Vec<Keyframe>,
    /// Controls of all steps after the numbered one, up to the next change.
    changes: Vec<(u64, Controls)>,
    spacing: u64,
    budget_bytes: usize,
    end_step: u64,
    end_secs: f64,
}

#[derive(Clone, Debug)]
struct Keyframe {
    simulation: Box<Simulation>,
    unconverged: u64,
}

impl Keyframe {
    fn step(&self) -> u64 {
        self.simulation.observables().step
    }
}

impl Recording {
    /// A recording that starts with this state and keeps about `budget_bytes` of keyframes.
    pub(crate) fn new(start: &Simulation, budget_bytes: usize) -> Self {
        Self {
            keyframes: vec![Keyframe { simulation: Box::new(start.clone()), unconverged: 0 }],
            changes: Vec::new(),
            spacing: FIRST_SPACING,
            budget_bytes,
            end_step: start.observables().step,
            end_secs: start.time_secs(),
        }
    }

    /// The last recorded step.
    pub(crate) fn end_step(&self) -> u64 {
        self.end_step
    }

    /// Simulated time of the last recorded step, s.
    pub(crate) fn end_secs(&self) -> f64 {
        self.end_secs
    }

    /// Notes a state that is about to take a step. What was recorded after it is forgotten.
    pub(crate) fn before_step(&mut self, simulation: &Simulation, unconverged: u64) {
        let step = simulation.observables().step;
        if self.end_step > step {
            self.keyframes.retain(|keyframe| keyframe.step() <= step);
            self.changes.retain(|(after, _)| *after < step);
            self.end_step = step;
        }
        let controls = Controls::of(simulation);
        if self.changes.last().is_none_or(|(_, last)| *last != controls) {
            self.changes.push((step, controls));
        }
        let last = self.keyframes.last().map_or(0, Keyframe::step);
        if step >= last + self.spacing {
            self.keyframes.push(Keyframe { simulation: Box::new(simulation.clone()), unconverged });
            self.thin();
        }
    }

    /// Notes a state that has just taken a step.
    pub(crate) fn after_step(&mut self, simulation: &Simulation) {
        self.end_step = simulation.observables().step;
        self.end_secs = simulation.time_secs();
    }

    fn thin(&mut self) {
        let newest = &self.keyframes[self.keyframes.len() - 1].simulation;
        if self.keyframes.len() * memory_bytes(newest) <= self.budget_bytes
            || self.keyframes.len() < 3
        {
            return;
        }
        self.spacing *= 2;
        let mut index = 0;
        self.keyframes.retain(|_| {
            index += 1;
            index % 2 == 1
        });
    }

    /// The keyframe at or before a simulated time, and the number of unconverged steps up to it.
    pub(crate) fn keyframe_before(&self, time_secs: f64) -> (&Simulation, u64) {
        let after = |keyframe: &Keyframe| keyframe.simulation.time_secs() <= time_secs;
        let index = self.keyframes.partition_point(after).saturating_sub(1);
        let keyframe = &self.keyframes[index];
        (&keyframe.simulation, keyframe.unconverged)
    }

    /// The controls of the step that follows `step`; none before anything was recorded.
    pub(crate) fn controls_after(&self, step: u64) -> Option<&Controls> {
        let count = self.changes.partition_point(|(after, _)| *after <= step);
        count.checked_sub(1).map(|index| &self.changes[index].1)
    }
}

/// About how much memory a clone of a simulation takes.
fn memory_bytes(simulation: &Simulation) -> usize {
    // Measured on piles of 138 to 10,000 grains: the lists of grains, bodies and candidates come to
    // some 500 bytes a grain, rows and impulses to some 250 a contact, fixed shapes to some 100.
    let world = simulation.world();
    let fixed = world.fixed_discs.len() + world.boundaries.len();
    4096 + 500 * world.grains.len() + 250 * simulation.contacts().contacts().len() + 100 * fixed
}
