//! Motion on the x axis.

use super::Kinematics;
use crate::contact::Lanes;
use crate::world::World;

/// A body on the x axis.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineBody<T = f64> {
    /// m/s.
    pub velocity: T,
}

/// One axis: no tangent, no rotation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Line;

impl Kinematics for Line {
    type Body<T: Lanes> = LineBody<T>;
    type Normal<T: Lanes> = T;
    const AXES: usize = 1;
    const ROTATION: bool = false;
    const TANGENTIAL_COMPLIANCE: f64 = 1.0;
    const DEGREES: usize = 1;
    const INERTIA_OVER_MASS: [f64; 3] = [1.0, 0.0, 0.0];

    #[inline(always)]
    fn coordinates<T: Lanes>(body: &LineBody<T>) -> [T; 3] {
        let none = body.velocity.same(0.0);
        [body.velocity, none, none]
    }

    #[inline(always)]
    fn from_coordinates<T: Lanes>([velocity, ..]: [T; 3]) -> LineBody<T> {
        LineBody { velocity }
    }

    #[inline(always)]
    fn set(body: &mut LineBody, [velocity, ..]: [f64; 3]) {
        body.velocity = velocity;
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

    #[inline(always)]
    fn normal<T: Lanes>([normal, _]: [T; 2]) -> T {
        normal
    }

    fn components(normal: f64) -> [f64; 2] {
        [normal, 0.0]
    }

    #[inline(always)]
    fn relative_velocity<T: Lanes>(normal: T, i: &LineBody<T>, j: &LineBody<T>) -> [T; 2] {
        [normal * (i.velocity - j.velocity), normal.same(0.0)]
    }

    #[inline(always)]
    fn velocity<T: Lanes>(normal: T, i: &LineBody<T>) -> [T; 2] {
        [normal * i.velocity, normal.same(0.0)]
    }

    #[inline(always)]
    fn push_pair<T: Lanes>(
        i: &mut LineBody<T>,
        j: &mut LineBody<T>,
        normal: T,
        [along_normal, _]: [T; 2],
        share: T,
    ) {
        let whole = normal * along_normal;
        let part = share * whole;
        i.velocity += part;
        j.velocity -= whole - part;
    }

    #[inline(always)]
    fn push_single<T: Lanes>(i: &mut LineBody<T>, normal: T, [along_normal, _]: [T; 2]) {
        i.velocity += normal * along_normal;
    }

    fn kinetic_energy(body: &LineBody, mass: f64) -> f64 {
        0.5 * mass * body.velocity * body.velocity
    }

    fn work_of_gravity(before: &LineBody, after: &LineBody, free: &LineBody, mass: f64) -> f64 {
        0.5 * mass * (before.velocity + after.velocity) * (free.velocity - before.velocity)
    }
}
