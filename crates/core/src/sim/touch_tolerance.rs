//! The gap up to which bonds live under the stepper `moreau`.

use crate::sim::settings::Settings;
use crate::sim::state::State;

/// The gap up to which contacts pull, m; 0 if that is no more than where they touch, and in a step that another stepper takes.
///
/// Within it a contact has the law of one that touches, but its grains may come to each other as far as the gap lets
/// them:
///
/// > 0 ≤ P + C₀Δt ⟂ v_n + gap/Δt ≥ 0.
///
/// Gaps of half the tolerance, at most those of [`TOUCH_IN_DIAMETERS`], are rounding, within which grains touch: without
/// that room a pyramid of logs falls. So a contact pulls by C₀ until its gap is closed, and a bond takes the work
/// C₀ (τ + what the pair opens within a step) to break. A pair that turns opens by ½ω²Δt²·L a step (`sim::turned_bonds`):
/// below the tolerance the next step closes that.
pub(in crate::sim) fn touch_tolerance(state: &State, settings: &Settings) -> f64 {
    let tolerance = settings.parameters.touch_tolerance * state.world.mean_diameter;
    let is_read = settings.stepper.reads("touch-tolerance");
    if is_read && tolerance > state.candidates.gap_tolerance() { tolerance } else { 0.0 }
}
