//! A step cut into pieces, so that no grain jumps over what it should hit.

use super::Remedy;
use crate::setting::Value;
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::steppers::stepper::Stepper;

/// The row of the registry.
pub(super) const REMEDY: Remedy = Remedy {
    name: "max-travel",
    taken_by: &[Stepper::Moreau, Stepper::Range],
    robust: Some(Value::Number(ROBUST)),
};

/// Furthest way of a grain in a piece where the preset `robust` asks, in d: half of what could jump a wall.
const ROBUST: f64 = 0.25;

/// Most pieces of a step: a grain that is faster still is lost anyhow, and the step has to end.
const MOST_PIECES: f64 = 1000.0;

/// Pieces of the next step: 1 unless grains are too fast for it.
pub(in crate::sim) fn pieces(state: &State, settings: &Settings) -> u32 {
    let world = &state.world;
    let longest = settings.remedies.max_travel * world.mean_diameter;
    if longest == 0.0 {
        return 1;
    }
    let time_step_secs = settings.parameters.time_step_secs;
    let mut travel = state.fastest_in(time_step_secs) * time_step_secs
        + world.gravity.magnitude() * time_step_secs * time_step_secs;
    if let Some(pull) = state.pull {
        let position = world.grains.positions[pull.grain as usize];
        travel += world.shortest(pull.target - position).length();
    }
    (travel / longest).ceil().clamp(1.0, MOST_PIECES) as u32
}
