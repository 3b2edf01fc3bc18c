//! Remedy (optional correction of a step) `max-travel`: divides a step into pieces in which no grain moves far.

use crate::sim::settings::Settings;
use crate::sim::state::State;

/// Largest number of pieces (shorter steps of equal length) into which a step is divided. With more pieces, a step
/// would no longer be comparable to a step with the requested time step.
const MOST_PIECES: f64 = 100.0;

/// Returns the number of pieces into which the next step is divided: 1 unless grains are so fast that they would move
/// farther in the step than the setting `max-travel` allows.
pub(in crate::sim) fn pieces(state: &State, settings: &Settings) -> u32 {
    let world = &state.world;
    let longest = settings.remedies.max_travel * world.mean_diameter;
    if longest == 0.0 {
        return 1;
    }
    let time_step_secs = settings.parameters.time_step_secs;
    let mut travel = state.fastest_in(time_step_secs) * time_step_secs
        + state.largest_acceleration() * time_step_secs * time_step_secs;
    if let Some(pull) = state.pull {
        let position = world.grains.positions[pull.grain as usize];
        travel += world.shortest(pull.target - position).length();
    }
    (travel / longest).ceil().clamp(1.0, MOST_PIECES) as u32
}
