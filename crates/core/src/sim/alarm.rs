//! What a run says when it goes wrong: in which way, since when, and the one change that is most
//! likely to help.

use serde::{Deserialize, Serialize};

use crate::contact::Feature;
use crate::error::legible;
use crate::number::rounded_down;
use crate::setting::words;
use crate::sim::losses::Losses;
use crate::sim::{Observables, Settings, Stepper};
use crate::solver::{FrictionModel, Method};
use crate::world::{Physics, World};

/// Steps in a row at the sweep limit that raise an alarm. Fewer: single hard steps, which do no
/// harm, would raise it.
const STEPS_AT_LIMIT: u32 = 100;
/// Overlap of a contact that raises an alarm, in d: the paper's own curves end at 0.06.
const LARGEST_OVERLAP: f64 = 0.05;

words! {
    /// A way to go wrong.
    pub enum AlarmKind {
        NotFinite = "not-finite", "the state is no longer finite";
        GrainLost = "grain-lost", "a grain has gone through a wall or left the world";
        SweepLimit = "sweep-limit", "100 steps in a row were not solved to their tolerance";
        Overlap = "overlap", "a contact overlaps by more than 5 % of a diameter";
        BreakUnseen = "break-unseen", "bonds break faster than the substeps of a step can follow";
    }
}

/// Something went wrong.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alarm {
    /// In which way.
    pub kind: AlarmKind,
    /// The first step that showed it.
    pub step: u64,
    /// Simulated time of that step, s.
    pub time_secs: f64,
    /// The longest time step that would do, s, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_time_step_secs: Option<f64>,
}

impl Alarm {
    /// What happened, since when, and what is most likely to help, in one sentence.
    pub fn message(&self, settings: &Settings) -> String {
        let Self { kind, step, time_secs, .. } = self;
        let advice = self.advice(settings);
        legible(&format!("{} (step {step}, t = {time_secs:.4} s): {advice}", kind.hint()))
    }

    /// What is wrong with a state that no step has led to yet.
    pub fn of_start(observables: &Observables) -> Option<Self> {
        let Observables { step, time_secs, max_overlap, .. } = *observables;
        let overlaps = step == 0 && max_overlap > LARGEST_OVERLAP;
        overlaps.then_some(Self {
            kind: AlarmKind::Overlap,
            step,
            time_secs,
            longest_time_step_secs: None,
        })
    }

    fn advice(&self, settings: &Settings) -> String {
        let Settings { stepper, parameters, solver, .. } = settings;
        let smaller = self.longest_time_step_secs.map_or_else(
            || format!("try a time step below {} s", parameters.time_step_secs),
            |secs| format!("try a time step of at most {:e} s", rounded_down(secs)),
        );
        match self.kind {
            AlarmKind::NotFinite if stepper.reads("substeps") && parameters.substeps > 0 => {
                let stable = match stepper {
                    Stepper::Dem => ", or 0 for as many as are stable",
                    _ => "",
                };
                format!("try more than {} substeps{stable}", parameters.substeps)
            }
            AlarmKind::Overlap if self.step == 0 => {
                "it begins so; the remedy push-out takes overlap away".into()
            }
            AlarmKind::NotFinite
            | AlarmKind::GrainLost
            | AlarmKind::Overlap
            | AlarmKind::BreakUnseen => smaller,
            AlarmKind::SweepLimit
                if parameters.restitution_threshold == 0.0 && parameters.restitution > 0.0 =>
            {
                "try a restitution threshold of 2: wedged contacts ask for bounces that contradict \
                 each other"
                    .into()
            }
            // Under other models newton would be another law.
            AlarmKind::SweepLimit
                if solver.method != Method::Newton && solver.model() == FrictionModel::Coulomb =>
            {
                "try method newton".into()
            }
            AlarmKind::SweepLimit => {
                format!("try a tolerance above {:e}", solver.tolerance)
            }
        }
    }
}

/// What watches over a simulation. Part of it, so that a moment that is computed anew tells the same.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Watch {
    unfinished_in_a_row: u32,
    /// One of a kind.
    pub alarms: Vec<Alarm>,
    pub losses: Losses,
}

impl Watch {
    /// Watches over a world, whose boundaries are `features`, from now on.
    pub(super) fn new(world: &World, features: &[Feature], physics: Physics) -> Self {
        Self { losses: Losses::new(world, features, physics), ..Self::default() }
    }

    /// Looks at the state after a step, and leaves grains that are lost out of its slump; `features`
    /// are those of the boundaries where they are now.
    pub(super) fn look(
        &mut self,
        world: &World,
        features: &[Feature],
        walls_move: bool,
        observables: &mut Observables,
        finite: bool,
    ) {
        self.unfinished_in_a_row =
            if observables.converged { 0 } else { self.unfinished_in_a_row + 1 };
        if finite {
            self.losses.look(world, features, walls_move);
        }
        observables.lost_grains = self.losses.count;
        if observables.lost_grains > 0 {
            observables.slump = self.losses.slump(world);
            self.raise(AlarmKind::GrainLost, observables, None);
        }
        if !finite {
            observables.converged = false;
            self.raise(AlarmKind::NotFinite, observables, None);
        } else if self.unfinished_in_a_row >= STEPS_AT_LIMIT {
            self.raise(AlarmKind::SweepLimit, observables, None);
        }
        if observables.max_overlap > LARGEST_OVERLAP {
            self.raise(AlarmKind::Overlap, observables, None);
        }
    }

    /// Raises an alarm, unless there is one of its kind: of a step that was too long for its bonds with the longest that
    /// is not, s.
    pub(super) fn raise(
        &mut self,
        kind: AlarmKind,
        &Observables { step, time_secs, .. }: &Observables,
        longest_time_step_secs: Option<f64>,
    ) {
        if self.alarms.iter().all(|alarm| alarm.kind != kind) {
            self.alarms.push(Alarm { kind, step, time_secs, longest_time_step_secs });
        }
    }
}
