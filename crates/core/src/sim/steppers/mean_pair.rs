//! Two grains of the mean mass, by which the numbers of a contact law are told.

use serde::Serialize;

use crate::contact::law::cohesion_force;
use crate::world::{Parameters, Physics, World};

/// The work that slowly parts two bonded grains of the mean mass m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FractureWork {
    /// J.
    pub joules: f64,
    /// In m·g·d, which lifts one of the grains by a diameter; 0 without gravity, where no bond pulls.
    pub over_mgd: f64,
}

/// Two grains of the mean mass.
pub(super) struct MeanPair {
    /// m, kg.
    mass: f64,
    /// g, m/s².
    gravity_magnitude: f64,
    /// d, m.
    diameter: f64,
}

impl MeanPair {
    /// Of a world's grains.
    pub(super) fn of(world: &World) -> Self {
        let masses = &world.grains.masses;
        Self {
            mass: masses.iter().sum::<f64>() / masses.len() as f64,
            gravity_magnitude: world.gravity.magnitude(),
            diameter: world.mean_diameter,
        }
    }

    /// m_ij, kg.
    pub(super) fn effective_mass(&self) -> f64 {
        0.5 * self.mass
    }

    /// The work of a law under which a bond of some C₀ (N) takes `work` (J).
    pub(super) fn fracture_work(
        &self,
        physics: Physics,
        parameters: &Parameters,
        work: impl FnOnce(f64) -> f64,
    ) -> Option<FractureWork> {
        if !physics.cohesion {
            return None;
        }
        let Self { mass, gravity_magnitude, diameter } = *self;
        let joules =
            work(cohesion_force(parameters.bond, self.effective_mass(), gravity_magnitude));
        let lift = mass * gravity_magnitude * diameter;
        Some(FractureWork { joules, over_mgd: if lift > 0.0 { joules / lift } else { 0.0 } })
    }
}
