//! The settings of the remedies, and what a remedy's own file says of it.

use crate::setting::{Group, Value, settings};
use crate::sim::steppers::stepper::Stepper;

/// What there is to know of a remedy.
#[derive(Clone, Copy, Debug)]
pub struct Remedy {
    /// The name of its setting.
    pub name: &'static str,
    /// The steppers that take it; others have their own ways, or none.
    pub taken_by: &'static [Stepper],
    /// Its setting in the preset `robust`, if it is part of that.
    pub robust: Option<Value>,
}

impl Remedy {
    /// Whether it is asked for.
    pub(crate) fn is_on(&self, remedies: &Remedies) -> bool {
        remedies.get(self.name) != Remedies::default().get(self.name)
    }

    /// Asks for it no more.
    pub(crate) fn leave_out(&self, remedies: &mut Remedies) {
        if let Some(value) = Remedies::default().get(self.name) {
            remedies.set(self.name, value);
        }
    }
}

settings! {
    /// Remedies for known failures.
    #[serde(default)]
    pub struct Remedies, changes RemedyChanges, heading "Solver" {
        /// Push overlap out by moving grains apart after the step, without giving them speed.
        push_out: bool = false, {
            name: "push-out",
            value_name: "BOOL",
            help: "Push overlap out by moving grains apart after each step, without giving them speed",
            control: Some(Control {
                label: "Push overlap out",
                hint: "Grains that overlap are moved apart after each step, without speed.",
                ..Control::PLAIN
            }),
        }
        /// Cut a step into pieces in which no grain moves further than this, in d; 0 never does.
        max_travel: f64 = 0.0, {
            name: "max-travel",
            value_name: "D",
            help: "Cut steps into pieces in which no grain moves further than this, in diameters; 0 \
                   never does",
            allowed: "a finite number of diameters ≥ 0; 0 never cuts a step",
            holds: |value| value >= 0.0 && value.is_finite(),
        }
        /// Solve a step that did not converge once more without bounces: restitution can ask wedged
        /// contacts for what contradicts itself, and then a step has no solution with them.
        calm_unsolved: bool = false, {
            name: "calm-unsolved",
            value_name: "BOOL",
            help: "Solve a step that did not converge once more without bounces, which may contradict \
                   each other",
            control: Some(Control {
                label: "Calm unsolved steps",
                hint: "A step that did not converge is solved once more without bounces, which may \
                       contradict each other.",
                ..Control::PLAIN
            }),
        }
        /// Have shocks run through touching grains one after the other, in scenes without cohesion.
        sequential_impacts: bool = false, {
            name: "sequential-impacts",
            value_name: "BOOL",
            help: "Have shocks run through touching grains one after the other, as in Newton's cradle; \
                   not with cohesion",
            control: Some(Control {
                label: "Shocks in sequence",
                hint: "Shocks run through touching grains one after the other, as in Newton's cradle; \
                       not where Bond is above 0.",
                ..Control::PLAIN
            }),
        }
        /// Let pairs with a gap that would close within the step close that gap and no more.
        speculative: bool = false, {
            name: "speculative",
            value_name: "BOOL",
            help: "Let pairs that would close their gap within a step close it and no more, so that \
                   nothing tunnels; it costs bounces",
            control: Some(Control {
                label: "Look ahead",
                hint: "Pairs that would meet within a step close their gap and no more: nothing \
                       tunnels, but they hardly bounce.",
                ..Control::PLAIN
            }),
        }
    }
}

impl Remedies {
    /// Whether there are none.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
