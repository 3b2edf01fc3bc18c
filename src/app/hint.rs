//! The sentence under the button that releases a pile: what to try with the present law, Bond and Δt.

use crate::sim::{Settings, Stepper};
use crate::world::FrictionCone;

/// Up to this Bond a larger Δt makes a pile hold better in the shifted cone (`RESULTS.md`, Fig. 5a); beyond it need not.
const WEAK: f64 = 50.0;

/// What to try, and what to watch.
pub(super) fn what_to_try(settings: &Settings) -> &'static str {
    let parameters = &settings.parameters;
    if parameters.bond == 0.0 {
        return "At Bond 0 nothing sticks, and Δt is next to nothing to the pile: set a Bond, release, and see.";
    }
    match settings.stepper {
        Stepper::Moreau if parameters.bond <= WEAK => {
            "A larger Δt makes these grains stick better: set Δt and Bond, release, and see whether the pile holds."
        }
        Stepper::Moreau if parameters.cone == FrictionCone::Shifted => {
            "So strong a pile hardly gains from a larger Δt; where steps are left unsolved, as in the paper, it even loses."
        }
        Stepper::Moreau => {
            "In this cone a larger Δt makes strong piles stick better, too: set Δt, release, and see."
        }
        Stepper::Range => {
            "Under this law Bond means the same at every Δt: set both, release, and see whether it does."
        }
        Stepper::Avbd => {
            "Here a step gets as far as its iterations take it: set Δt, release, and see what it leaves undone."
        }
        Stepper::TgsSoft | Stepper::Dem => {
            "Here cohesion is a force like any other, whatever Δt: set Bond, release, and see whether the pile holds."
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hint_says_nothing_of_sticking_where_nothing_sticks_or_the_time_step_does_not_matter() {
        let mut settings = Settings::default();
        let mut said = Vec::new();
        for (stepper, bond) in [
            (Stepper::Moreau, 0.0),
            (Stepper::Moreau, 20.0),
            (Stepper::Moreau, 100.0),
            (Stepper::Range, 20.0),
            (Stepper::Dem, 20.0),
        ] {
            (settings.stepper, settings.parameters.bond) = (stepper, bond);
            said.push(what_to_try(&settings));
        }
        let larger = said.iter().filter(|text| text.contains("larger Δt makes these grains stick"));
        assert_eq!(larger.count(), 1, "{said:?}");
        said.dedup();
        assert_eq!(said.len(), 5);
    }
}
