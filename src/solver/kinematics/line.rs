//! Motion on the x axis.

use glam::DVec2;

use super::Kinematics;
use crate::solver::{Problems, StepProblem};
use crate::world::World;

/// A body on the x axis.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineBody {
    /// m/s.
    pub velocity: f64,
}

/// One axis: no tangent, no rotation.
#[derive(Clone, Copy, Debug)]
pub struct Line;

impl Kinematics for Line {
    type Body = LineBody;
    type Normal = f64;
    const AXES: usize = 1;
    const ROTATION: bool = false;
    const TANGENTIAL_COMPLIANCE: f64 = 1.0;
    const DEGREES: usize = 1;
    const INERTIA_OVER_MASS: [f64; 3] = [1.0, 0.0, 0.0];

    fn coordinates(body: &LineBody) -> [f64; 3] {
        [body.velocity, 0.0, 0.0]
    }

    fn from_coordinates([velocity, ..]: [f64; 3]) -> LineBody {
        LineBody { velocity }
    }

    fn gradients(normal: f64) -> [[[f64; 3]; 2]; 2] {
        [[[normal, 0.0, 0.0], [0.0; 3]], [[-normal, 0.0, 0.0], [0.0; 3]]]
    }

    fn body(world: &World, index: usize) -> LineBody {
        LineBody { velocity: world.grains.velocities[index].x }
    }

    fn store(body: &LineBody, world: &mut World, index: usize) {
        world.grains.velocities[index].x = body.velocity;
    }

    fn accelerated(body: &LineBody, world: &World, index: usize, time_step_secs: f64) -> LineBody {
        let x = world.grains.positions[index].x;
        let change = time_step_secs * world.gravity.acceleration_on_line(x);
        LineBody { velocity: body.velocity + change }
    }

    fn normal(normal: DVec2) -> f64 {
        normal.x
    }

    #[inline(always)]
    fn relative_velocity(normal: f64, i: &LineBody, j: &LineBody) -> [f64; 2] {
        [normal * (i.velocity - j.velocity), 0.0]
    }

    #[inline(always)]
    fn velocity(normal: f64, i: &LineBody) -> [f64; 2] {
        [normal * i.velocity, 0.0]
    }

    #[inline(always)]
    fn push_pair(
        i: &mut LineBody,
        j: &mut LineBody,
        normal: f64,
        [along_normal, _]: [f64; 2],
        share: f64,
    ) {
        let whole = normal * along_normal;
        let part = share * whole;
        i.velocity += part;
        j.velocity -= whole - part;
    }

    #[inline(always)]
    fn push_single(i: &mut LineBody, normal: f64, [along_normal, _]: [f64; 2]) {
        i.velocity += normal * along_normal;
    }

    fn problem(problems: &mut Problems) -> &mut StepProblem<Self> {
        &mut problems.line
    }

    fn kinetic_energy(body: &LineBody, mass: f64) -> f64 {
        0.5 * mass * body.velocity * body.velocity
    }

    fn work_of_gravity(before: &LineBody, after: &LineBody, free: &LineBody, mass: f64) -> f64 {
        0.5 * mass * (before.velocity + after.velocity) * (free.velocity - before.velocity)
    }
}
