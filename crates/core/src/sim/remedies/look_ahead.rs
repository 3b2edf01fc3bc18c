//! The remedy `speculative`: pairs that would meet within a step are in its problem too.

use crate::contact::{InTouch, LookAhead};
use crate::sim::state::State;

/// Farther pairs are left alone, in d: where all grains are fast, the search would be of nearly all pairs.
const FARTHEST_IN_DIAMETERS: f64 = 8.0;

/// How far a step that has begun has to look: as far as two bodies of the fastest speed come.
///
/// A contact that is looked for at the beginning of a step is missed where the pair meets later in it,
/// and a fast disc is then inside a wall, or through it. So pairs with a gap that would close within
/// the step enter its problem too, and may close by that gap and no more (E. Catto, *Continuous
/// collision*, 2013):
///
/// > 0 ≤ P ⟂ v_n + gap/Δt ≥ 0.
///
/// They do not pull. At the end of the step they touch: the gap is taken larger by the rounding that
/// contacts have (`contact::range`). In the compressive cone they rub by what exceeds the cohesion that
/// they will have.
///
/// **What it costs.** The pair is slowed down to gap/Δt before it meets, and bounces in the step after
/// with ρ times that: with any share between 0 and 1 of the speed that it should have, half of it in
/// the mean. The normal is that of the beginning, so what would pass by at a slant may be held up by
/// nothing. And a fast grain looks for all that lies within its way. Cutting the step into pieces
/// (`remedies::pieces`) has none of these faults.
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
