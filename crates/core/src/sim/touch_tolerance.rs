//! Touch tolerance: the gap up to which contacts pull under the stepper `moreau`.

use crate::sim::settings::Settings;
use crate::sim::state::State;

/// Returns the touch tolerance τ, m: the gap up to which contacts pull. Returns 0 in two cases: if τ is at most the
/// scene's `gap_tolerance` (the gap below which bodies count as touching, because of rounding), and for steppers that
/// do not read the setting `touch-tolerance`.
///
/// A contact with a gap up to τ obeys the law of a touching contact, but its grains may approach each other until the
/// gap is closed. With the normal impulse P, the cohesion force C₀, the time step Δt and the normal velocity v_n at the
/// end of the step, the law is
///
/// > 0 ≤ P + C₀Δt ⟂ v_n + gap/Δt ≥ 0.
///
/// Gaps up to τ/2, but at most [`TOUCH_IN_DIAMETERS`](crate::contact::range::TOUCH_IN_DIAMETERS) mean diameters, count
/// as rounding: grains with such gaps touch, and the law does not let them close the gap. Without this allowance
/// rounding separates logs that a scene file places in contact, and a pyramid of logs in equilibrium falls. A contact
/// pulls with C₀ until its gap is closed. Breaking a bond takes the work C₀ (τ + e), with the distance e by which the
/// pair opens within one step. A pair of grains with the distance L between their centres that turns with the angular
/// velocity ω opens by ½ω²Δt²·L per step (`sim::turned_bonds`). If this distance stays below τ, the next step closes
/// the gap.
pub(in crate::sim) fn touch_tolerance(state: &State, settings: &Settings) -> f64 {
    let tolerance = settings.parameters.touch_tolerance * state.world.mean_diameter;
    let is_read = settings.stepper.reads("touch-tolerance");
    if is_read && tolerance > state.candidates.gap_tolerance() { tolerance } else { 0.0 }
}
