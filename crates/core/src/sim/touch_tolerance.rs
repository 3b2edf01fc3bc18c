//! The gap up to which bonds exist under the stepper `moreau`.

use crate::sim::settings::Settings;
use crate::sim::state::State;

/// The gap up to which contacts pull, m. 0 if the tolerance does not exceed the gap of touching pairs, and for
/// steppers that do not read it.
///
/// Within it a contact has the law of a touching contact, but its grains may approach each other as far as the gap
/// allows:
///
/// > 0 ≤ P + C₀Δt ⟂ v_n + gap/Δt ≥ 0.
///
/// Gaps of half the tolerance, but at most [`TOUCH_IN_DIAMETERS`], count as rounding, and grains with such gaps
/// touch: without this allowance a pyramid of logs falls. So a contact pulls by C₀ until its gap is closed, and
/// breaking a bond takes the work C₀ (τ + the opening of the pair within a step). A pair that turns opens by ½ω²Δt²·L
/// per step (`sim::turned_bonds`); below the tolerance the next step closes this gap.
pub(in crate::sim) fn touch_tolerance(state: &State, settings: &Settings) -> f64 {
    let tolerance = settings.parameters.touch_tolerance * state.world.mean_diameter;
    let is_read = settings.stepper.reads("touch-tolerance");
    if is_read && tolerance > state.candidates.gap_tolerance() { tolerance } else { 0.0 }
}
