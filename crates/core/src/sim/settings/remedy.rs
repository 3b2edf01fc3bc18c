//! Registry of the remedies: optional corrections for known failures of a stepper, such as overlap. The scheme of
//! Abramian & Staron (2020) uses no remedy. Each remedy has an entry in [`REMEDIES`] and a setting in [`Remedies`]; its
//! code is in `sim::remedies`.

use crate::setting::{Group, Value, settings};
use crate::sim::settings::stepper::Stepper;

/// Value of the remedy `max-travel` in the preset (group of settings) `robust`, in mean diameters. The remedy divides a
/// step into pieces in which no grain moves farther than this distance. A grain that moves farther than its radius,
/// half a diameter, in a piece could pass through a wall that it does not yet touch at the beginning of the piece. The
/// value is half of this distance.
const ROBUST_TRAVEL: f64 = 0.25;

/// Registry entry of a remedy (an optional correction of a step): its name, the steppers that support it and its value
/// in the preset (group of settings) `robust`.
#[derive(Clone, Copy, Debug)]
pub struct Remedy {
    /// Name of the setting that turns the remedy (optional correction of a step) on.
    pub name: &'static str,
    /// Steppers that support the remedy (optional correction of a step).
    pub taken_by: &'static [Stepper],
    /// Value of the setting of the remedy (optional correction of a step) in the preset (group of settings) `robust`;
    /// `None` if the preset leaves the remedy off.
    pub robust: Option<Value>,
}

impl Remedy {
    /// True if the settings `remedies` turn this remedy (optional correction of a step) on.
    pub(crate) fn is_on(&self, remedies: &Remedies) -> bool {
        remedies.get(self.name) != Remedies::default().get(self.name)
    }

    /// Turns this remedy (optional correction of a step) off in the settings `remedies`.
    pub(crate) fn leave_out(&self, remedies: &mut Remedies) {
        if let Some(value) = Remedies::default().get(self.name) {
            remedies.set(self.name, value);
        }
    }
}

settings! {
    /// Settings of the remedies: optional corrections for known failures of a stepper, such as overlap.
    #[serde(default)]
    pub struct Remedies, changes RemedyChanges, heading "Solver" {
        push_out: bool = false, "push-out",
            "Remove overlap after each step by moving grains apart, without giving them speed", {
            control: shown(
                "Push overlap out",
                "Grains that overlap are moved apart after each step, without speed.",
            ),
        }
        max_travel: f64 = 0.0, "max-travel" ("D"),
            "Cut a step into at most 100 pieces so that no grain moves further than this in a piece, in mean \
                diameters; 0 never cuts", {
            allowed: "a finite number of diameters ≥ 0; 0 never cuts a step",
            holds: |value| value >= 0.0 && value.is_finite(),
        }
        sequential_impacts: bool = false, "sequential-impacts",
            "Let shocks travel through touching grains one after the other, as in Newton's cradle; without effect \
                under cohesion", {
            control: shown(
                "Shocks in sequence",
                "Shocks run through touching grains one after the other, as in Newton's cradle; \
                 not where Bond is above 0.",
            ),
        }
        speculative: bool = false, "speculative",
            "Stop pairs that would meet within a step at gap 0, so that no grain passes another one; under moreau, bounces get \
                weaker", {
            control: shown(
                "Look ahead",
                "Pairs that would meet within a step close their gap and no more: nothing \
                 tunnels, but they hardly bounce.",
            ),
        }
        turning_bonds: bool = false, "turning-bonds",
            "Let bonded grains circle each other, up to the angular velocity at which the pull is larger than the cohesion \
                force; the scheme of the paper ends a bond that turns", {
            control: shown(
                "Bonds turn",
                "Bonded grains circle each other without losing their bond. In the scheme of the paper each step opens \
                 the gap of a pair that turns, which ends the bond.",
            ),
        }
    }
}

impl Remedies {
    /// True if all remedies (optional corrections of a step) are off.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// All remedies (optional corrections of a step), in the order of the settings of [`Remedies`].
pub const REMEDIES: [Remedy; 5] = {
    const fn row(
        name: &'static str,
        taken_by: &'static [Stepper],
        robust: Option<Value>,
    ) -> Remedy {
        Remedy { name, taken_by, robust }
    }
    const ON: Option<Value> = Some(Value::Switch(true));
    const MOREAU: &[Stepper] = &[Stepper::Moreau];
    [
        row("push-out", MOREAU, ON),
        row("max-travel", &[Stepper::Moreau, Stepper::Range], Some(Value::Number(ROBUST_TRAVEL))),
        row("sequential-impacts", MOREAU, ON),
        // Off in the preset `robust`: `max-travel` handles fast grains, and this remedy would weaken their bounces.
        row("speculative", &[Stepper::Moreau, Stepper::TgsSoft], None),
        // Off in the preset `robust`: its touch tolerance already lets bonds turn.
        row("turning-bonds", MOREAU, None),
    ]
};

const _: () =
    assert!(REMEDIES.len() == Remedies::ABOUT.len(), "each remedy has a row and a setting");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_is_about_the_setting_at_its_place() {
        for (row, about) in REMEDIES.iter().zip(Remedies::ABOUT) {
            assert_eq!(row.name, about.name);
        }
    }
}
