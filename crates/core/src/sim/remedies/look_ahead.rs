//! The remedy `speculative`: pairs that would meet within a step also enter its problem.

use crate::contact::{InTouch, LookAhead};
use crate::sim::state::State;

/// Largest search distance, in d. Without it the search would cover nearly all pairs if all grains are fast.
const FARTHEST_IN_DIAMETERS: f64 = 8.0;

/// Search distance for a step that has begun: the largest approach of two bodies at the highest speed.
///
/// Contacts are found at the beginning of a step, so a pair that meets later in the step is missed. A fast disc may
/// then end up inside a wall, or behind it. So pairs whose gap would close within the step also enter its problem,
/// and may close by their gap and no more (E. Catto, *Continuous collision*, 2013):
///
/// > 0 ≤ P ⟂ v_n + gap/Δt ≥ 0.
///
/// They do not pull. At the end of the step they touch, because the gap is increased by the rounding tolerance of
/// contacts (`contact::range`). In the compressive cone their friction is bounded by the normal force above their
/// later cohesion.
///
/// **Drawbacks.** The pair is slowed down to gap/Δt before it meets, and in the next step it bounces with ρ times
/// that speed: with any fraction between 0 and 1 of the correct speed, on average half of it. The normal is that of
/// the beginning of the step, so a pair that would pass by at an angle may be stopped without contact. And a fast
/// grain searches its whole path. Dividing the step into pieces (`remedies::pieces`) has none of these drawbacks.
pub(in crate::sim) fn look_ahead(state: &State, time_step_secs: f64) -> LookAhead {
    let world = &state.world;
    let by_forces = 2.0 * state.largest_acceleration() * time_step_secs * time_step_secs;
    let way = 2.0 * state.fastest() * time_step_secs + by_forces;
    LookAhead {
        time_step_secs,
        distance: by_forces,
        reach: way.min(FARTHEST_IN_DIAMETERS * world.mean_diameter),
        in_touch: InTouch::Touching,
    }
}
