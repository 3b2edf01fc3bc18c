//! Work of fracture: the work needed to pull two bonded grains apart slowly.

use serde::{Deserialize, Serialize};

use crate::contact::law::cohesion_force;
use crate::world::{Parameters, Physics, World};

/// Work of fracture: the work needed to pull two bonded grains, each of the mean mass m, apart slowly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FractureWork {
    /// Work of fracture, J.
    pub joules: f64,
    /// Work of fracture divided by the work that lifts one of the grains (mass m) by the mean diameter d against
    /// gravity g, m·g·d. Without gravity, the parameter `bond_acceleration` (m/s²), which then sets the cohesion force,
    /// replaces g. 0 if both accelerations are 0.
    pub over_mgd: f64,
}

/// Returns the effective mass m_ij of two grains of the mean mass, kg.
pub(super) fn effective_mass_of_mean(world: &World) -> f64 {
    let masses = &world.grains.masses;
    0.5 * (masses.iter().sum::<f64>() / masses.len() as f64)
}

/// Computes the work of fracture. `work` returns, for the contact law, the work needed to break a bond, J, from the
/// cohesion force of the bond, N. Returns `None` without cohesion.
pub(super) fn fracture_work_of(
    world: &World,
    physics: Physics,
    parameters: &Parameters,
    work: impl FnOnce(f64) -> f64,
) -> Option<FractureWork> {
    if !physics.cohesion {
        return None;
    }
    let (effective_mass, g) = (effective_mass_of_mean(world), world.gravity.magnitude());
    let acceleration = parameters.cohesion_acceleration(g);
    let joules = work(cohesion_force(parameters.bond, effective_mass, acceleration));
    let lift = 2.0 * effective_mass * parameters.accelerating(g) * world.mean_diameter;
    Some(FractureWork { joules, over_mgd: if lift > 0.0 { joules / lift } else { 0.0 } })
}
