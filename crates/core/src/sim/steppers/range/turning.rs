//! Bonded pairs that circle each other.
//!
//! **Why they ask for substeps.** A step takes a contact's normal from its beginning. Two grains that circle each
//! other at a distance L with v_t turn it by v_tΔt/L in a step, and at the beginning of the next one they part with
//!
//! > v = v_t²Δt/L
//!
//! along the new normal. That is the load v_t²/L of the circle, evenly spread over the step, but it looks like
//! a shock that has thrown them apart, and a bond stops a shock below its escape speed √(2C₀δ_c/m_ij) alone. So a pair
//! that its bond would hold parts where the step is long. In substeps v falls with Δt, and the escape speed does not.

use glam::DVec2;

use crate::contact::{Numbering, Other};
use crate::sim::state::State;

/// The part of the escape speed that turning may come to in a step. Larger: pairs that circle part too early;
/// smaller: steps are cut in vain.
const MOST_OF_ESCAPE_SPEED: f64 = 0.5;

/// Whether a bonded pair circles so fast that a step of that length would take the turn of its normal for a shock.
/// `pull` is C₀/m_ij, m/s², and `distance` δ_c, m.
pub(super) fn looks_like_a_shock(
    state: &State,
    time_step_secs: f64,
    pull: f64,
    distance: f64,
) -> bool {
    let most = MOST_OF_ESCAPE_SPEED * (2.0 * pull * distance).sqrt() / time_step_secs;
    let fixed_discs = &state.world.fixed_discs;
    let grains = &state.world.grains;
    let numbering = Numbering::of(&state.world);
    let bonds = state.contacts.contacts().iter().zip(state.contacts.bonds());
    bonds.filter(|(_, bond)| bond.alive).any(|(contact, _)| {
        let grain = contact.grain as usize;
        let (velocity, radius) = match numbering.other(contact.other) {
            Other::Grain(other) => {
                let slide = state.world.speed_of_image(grain, other) * DVec2::X;
                (grains.velocities[other] + slide, grains.radii[other])
            }
            Other::FixedDisc(disc) => {
                let surface = state.walls.surface(&state.world, contact);
                let velocity = surface.map_or(DVec2::ZERO, |surface| surface.velocity);
                (velocity, fixed_discs[disc].radius)
            }
            // A straight feature has the same normal everywhere.
            Other::Feature(_) => return false,
        };
        let tangential = (grains.velocities[grain] - velocity).perp_dot(contact.normal);
        tangential * tangential > most * (grains.radii[grain] + radius)
    })
}
