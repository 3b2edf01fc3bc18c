//! A hand on a grain: a damped spring between its centre and a point that the user moves.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::Simulation;
use crate::solver::Kinematics;

/// Stiffness per mass of the grain, in units of g/d: one diameter of stretch pulls with this many
/// times the grain's weight.
const STIFFNESS: f64 = 40.0;
/// g that the stiffness refers to on a scene without gravity, m/s².
pub(super) const GRAVITY_IF_NONE: f64 = 9.8;

/// A spring from a grain to a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pull {
    /// Index of the grain.
    pub grain: u32,
    /// Where the other end of the spring is held, m.
    pub target: DVec2,
}

impl Simulation {
    /// The spring that acts on a grain in the next step, if there is one.
    pub fn pull(&self) -> Option<Pull> {
        self.pull
    }

    /// Ties a spring to a grain from the next step on, or takes it away. A spring to a grain that
    /// does not exist is none.
    pub fn set_pull(&mut self, pull: Option<Pull>) {
        let count = self.world.grains.len();
        self.pull = pull.filter(|pull| (pull.grain as usize) < count && pull.target.is_finite());
    }

    /// What the spring adds to the velocity of its grain in one step of `time_step_secs`, m/s. The
    /// spring is damped critically and integrated implicitly: no time step makes it swing up.
    fn pulled_velocity(&self, pull: Pull, time_step_secs: f64) -> DVec2 {
        let grains = &self.world.grains;
        let index = pull.grain as usize;
        let g = match self.world.gravity.magnitude() {
            0.0 => GRAVITY_IF_NONE,
            magnitude => magnitude,
        };
        let frequency = (STIFFNESS * g / self.world.mean_diameter).sqrt();
        let (position, velocity) = (grains.positions[index], grains.velocities[index]);
        let stretch = pull.target - position - time_step_secs * velocity;
        let acceleration = frequency * frequency * stretch - 2.0 * frequency * velocity;
        let turn = frequency * time_step_secs;
        time_step_secs * acceleration / (1.0 + 2.0 * turn + turn * turn)
    }

    /// The push of the spring in the next `time_step_secs`: which grain, along which unit vector,
    /// how fast (m/s). None without a spring.
    pub(super) fn push_of_pull(
        &self,
        axes: usize,
        time_step_secs: f64,
    ) -> Option<(usize, DVec2, f64)> {
        let pull = self.pull?;
        let mut change = self.pulled_velocity(pull, time_step_secs);
        if axes == 1 {
            change.y = 0.0;
        }
        let speed = change.length();
        (speed > 0.0).then(|| (pull.grain as usize, change / speed, speed))
    }
}

/// Adds the push of a spring to bodies.
pub(super) fn apply<K: Kinematics>(
    bodies: &mut [K::Body<f64>],
    (grain, direction, speed): (usize, DVec2, f64),
) {
    // A normal impulse against a fixed body changes the velocity by just itself.
    K::push_single(&mut bodies[grain], K::normal(direction.to_array()), [speed, 0.0]);
}
