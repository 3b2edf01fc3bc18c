//! Remedy (optional correction of a step) `speculative`: adds pairs of bodies that would meet within a step to the
//! contact problem of this step.

use crate::contact::{InTouch, LookAhead};
use crate::sim::state::State;

/// Largest gap at which the remedy (optional correction of a step) `speculative` searches for pairs that may meet
/// within a step, in mean diameters. Without this limit the search would cover nearly all pairs if all grains are fast.
const FARTHEST_IN_DIAMETERS: f64 = 8.0;

/// Returns the distances (m) by which a step selects the pairs that may meet within it. Pairs with a gap above `reach`
/// are not examined: `reach` is the distance by which two bodies that both move at the highest speed of any body
/// approach each other in the step, including the effect of gravity and body forces, and at most
/// [`FARTHEST_IN_DIAMETERS`]. A pair is selected if its gap, after a step at the present velocities, would be below
/// `distance`: the part of this approach that is due to gravity and body forces, which the present velocities do not
/// include.
///
/// Contacts are found at the beginning of a step, so a pair that meets later in the step is missed. A fast disc may
/// then end up inside a wall or behind it. So this remedy (the optional correction `speculative`) adds the pairs whose
/// gap would close within the step to the contact problem. With the normal impulse P and the normal velocity v_n, such
/// a pair may close its gap, but may not overlap (E. Catto, *Continuous collision*, 2013):
///
/// > 0 ≤ P ⟂ v_n + gap/Δt ≥ 0.
///
/// These pairs do not pull. The stepper adds a length for rounding (`contact::range::TOUCH_IN_DIAMETERS` mean
/// diameters) to the gap in this condition, so that a pair that meets within the step touches at the end of the step,
/// and the next step finds it as a contact. Under the compressive friction cone, μ max(N, 0) bounds the friction force
/// of a touching pair (friction coefficient μ, normal force N). A pair that this remedy adds has the smaller bound μ
/// max(N − C₀, 0), with the cohesion force C₀ that the pair will have after it touches.
///
/// **Drawbacks.** The pair is slowed down to the speed gap/Δt before it meets, and in the next step it bounces with
/// this speed times the restitution ρ. So its speed after the bounce is between 0 and the correct speed, on average
/// half of the correct speed. The normal belongs to the beginning of the step, so a pair that would pass by at an angle
/// may be stopped without touching. The search takes longer if a grain is fast, because it covers the whole path of the
/// step. The remedy `max-travel`, which divides the step into pieces (`remedies::pieces`), has none of these drawbacks.
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
