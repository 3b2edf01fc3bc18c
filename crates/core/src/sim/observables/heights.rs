//! How high the grains are.

use crate::sim::state::State;

/// Sum of the grains' heights, m, and their potential energy, J.
pub(super) fn heights(state: &State) -> [f64; 2] {
    let (grains, gravity) = (&state.world.grains, &state.world.gravity);
    let mut heights = 0.0;
    let mut potential_energy = 0.0;
    for (index, &position) in grains.positions.iter().enumerate() {
        heights += position.y;
        if grains.feels_gravity[index] {
            potential_energy += grains.masses[index] * gravity.potential(position);
        }
    }
    [heights, potential_energy]
}
