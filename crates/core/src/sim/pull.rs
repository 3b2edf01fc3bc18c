//! Interactive pull on a grain: a damped spring between the centre of the grain and a point that the user moves.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::solver::Model;
use crate::world::{Parameters, World};

/// Stiffness of the spring with which the user pulls a grain, divided by the mass of the grain, in units of g/d
/// (gravity g, mean diameter d): a spring stretched by one mean diameter pulls with 40 times the weight of the grain.
const STIFFNESS: f64 = 40.0;
/// Gravitational acceleration that scales springs and speeds of interactive edits in a scene without gravity, m/s².
const GRAVITY_IF_NONE: f64 = 9.8;

/// Returns the acceleration that scales the stiffness and speed of interactive pulls, m/s²: the gravity of the scene,
/// or [`GRAVITY_IF_NONE`] without gravity.
pub(super) fn gravity_that_scales(world: &World) -> f64 {
    or_if_none(world.gravity.magnitude())
}

/// Returns the acceleration that scales the stiffness of contact springs, m/s²: the gravity of the scene or, without
/// gravity, the parameter `bond_acceleration`, which then sets the cohesion force. If both are 0, returns
/// [`GRAVITY_IF_NONE`]. With a smaller acceleration, springs would be so soft that a bond could stretch by more than a
/// diameter.
pub(super) fn acceleration_of_springs(world: &World, parameters: &Parameters) -> f64 {
    or_if_none(parameters.accelerating(world.gravity.magnitude()))
}

fn or_if_none(acceleration: f64) -> f64 {
    match acceleration {
        0.0 => GRAVITY_IF_NONE,
        given => given,
    }
}

/// Spring with which the user pulls a grain to a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pull {
    /// Index of the pulled grain.
    pub grain: u32,
    /// Position of the free end of the spring, which the user moves, m.
    pub target: DVec2,
}

impl Pull {
    /// Returns the change of the grain's velocity by the spring in one step of `time_step_secs` (s), m/s. The spring is
    /// critically damped and integrated implicitly, so its oscillation does not grow at any time step.
    fn added_velocity(self, world: &World, time_step_secs: f64) -> DVec2 {
        let grains = &world.grains;
        let index = self.grain as usize;
        let g = gravity_that_scales(world);
        let frequency = (STIFFNESS * g / world.mean_diameter).sqrt();
        let (position, velocity) = (grains.positions[index], grains.velocities[index]);
        let stretch = world.shortest(self.target - position) - time_step_secs * velocity;
        let acceleration = frequency * frequency * stretch - 2.0 * frequency * velocity;
        let turn = frequency * time_step_secs;
        time_step_secs * acceleration / (1.0 + 2.0 * turn + turn * turn)
    }

    /// Returns the change of velocity that the spring gives the grain in the next `time_step_secs` (s); `None` if it is
    /// zero. In a scene with one axis (`axes` = 1) the change has no component along y.
    pub(super) fn push(self, world: &World, axes: usize, time_step_secs: f64) -> Option<Push> {
        let mut change = self.added_velocity(world, time_step_secs);
        if axes == 1 {
            change.y = 0.0;
        }
        Push::of(self.grain as usize, change)
    }
}

/// Change of a grain's velocity in a step by an external force: its direction (unit vector) and its size (m/s).
pub(crate) struct Push {
    grain: usize,
    direction: DVec2,
    speed: f64,
}

impl Push {
    /// Creates a push that changes the velocity of a grain by `change`, m/s; `None` if `change` is zero.
    pub(super) fn of(grain: usize, change: DVec2) -> Option<Self> {
        let speed = change.length();
        (speed > 0.0).then(|| Self { grain, direction: change / speed, speed })
    }

    pub(super) fn apply<M: Model>(&self, bodies: &mut [M::Body<f64>]) {
        // A normal impulse against a fixed body changes the velocity of the grain by exactly `speed`.
        let normal = M::normal(self.direction.to_array());
        M::push_single(&mut bodies[self.grain], normal, [self.speed, 0.0]);
    }
}
