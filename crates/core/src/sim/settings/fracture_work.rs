//! The work that breaks a bond slowly.

use serde::{Deserialize, Serialize};

use crate::contact::law::cohesion_force;
use crate::world::{Parameters, Physics, World};

/// The work that slowly separates two bonded grains of the mean mass m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FractureWork {
    /// Work, J.
    pub joules: f64,
    /// Work in units of m·g·d, which lifts one of the grains by a diameter. Without gravity the acceleration of the
    /// cohesion force replaces g; 0 without both.
    pub over_mgd: f64,
}

/// m_ij of two grains of the mean mass, kg.
pub(super) fn effective_mass_of_mean(world: &World) -> f64 {
    let masses = &world.grains.masses;
    0.5 * (masses.iter().sum::<f64>() / masses.len() as f64)
}

/// The work of fracture of a law in which a bond of cohesion C₀ (N) takes `work(C₀)` (J).
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
