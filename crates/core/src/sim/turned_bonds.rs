//! Counts the bonds of a step that end because their two grains circle each other, and not because of the pull on them.
//!
//! A step takes the contact normals from its beginning, and grains move along straight lines. Let two grains with the
//! normal velocity v_n = 0 circle each other with the angular velocity ω, with their centres at the distance L. At the
//! end of a step Δt this distance is L √(1 + ω²Δt²): the gap has grown by ½ω²Δt²·L. If a bond exists only while the gap
//! is negative, turning ends the bond after some steps, although it could bear a much larger pull.
//!
//! A bond counts as ended by turning if its contact meets all these conditions:
//!
//! * The contact pulled with less than the cohesion force C₀. So its law required that the formal velocity v̄_n (a mean
//!   of the normal velocities after and before the step, weighted by restitution) is 0.
//! * The normal velocity v_n alone would not have opened the contact: gap + Δt·v_n is below the tolerance up to which
//!   the contact law lets contacts pull. This is the touch tolerance or, if it is larger, the scene's `gap_tolerance`.
//! * After the step the gap is not below this tolerance.
//!
//! Without cohesion no contact pulls, so no bond is counted.

use crate::contact::Contact;
use crate::sim::settings::Settings;
use crate::sim::state::State;
use crate::sim::stepping::Stage;
use crate::sim::touch_tolerance::touch_tolerance;
use crate::solver::{Model, for_each_row};

/// Returns the number of bonds that ended in a solved step because their two grains circled each other, which opened
/// the gap. Call this after the grains have moved.
pub(super) fn count<M: Model>(stage: &Stage<'_, M>, settings: &Settings) -> u64 {
    let Stage { state, problem, .. } = stage;
    let tolerance = touch_tolerance(state, settings).max(state.candidates.gap_tolerance());
    if problem.law.capture_speed() == 0.0 {
        return 0;
    }
    let mut ended = 0;
    for_each_row(problem, |number, row, motion| {
        let [impulse, _] = problem.reduced_impulse(number, row);
        if is_within_bounds(impulse, problem.capture(number)) {
            let contact = state.contacts.contacts()[problem.rows.contacts[number] as usize];
            let opening = motion.now[0] - problem.wall_speed(number);
            let expected = contact.gap + settings.parameters.time_step_secs * opening;
            ended += u64::from(is_open_against(state, &contact, expected, tolerance, M::AXES));
        }
    });
    ended
}

/// True if a contact pulls, but with less than its cohesion force. `reduced_impulse` is its normal impulse, and
/// `capture_speed` the cohesion force times the time step; both are divided by the effective mass, m/s.
pub(super) fn is_within_bounds(reduced_impulse: f64, capture_speed: f64) -> bool {
    reduced_impulse < 0.0 && reduced_impulse > -capture_speed
}

/// True if a pair of bodies has opened although its normal velocity did not open it: the present gap is at least
/// `tolerance` (m), but the gap `expected` (m), predicted from the normal velocity, is below `tolerance`.
pub(super) fn is_open_against(
    state: &State,
    contact: &Contact,
    expected: f64,
    tolerance: f64,
    axes: usize,
) -> bool {
    let State { world, candidates, .. } = state;
    expected < tolerance
        && contact.gap_now(world, candidates, axes).is_some_and(|gap| gap >= tolerance)
}
