//! Motion in the plane, with and without rotation.

use glam::DVec2;

use super::Kinematics;
use crate::solver::{Problems, StepProblem};
use crate::world::World;

/// A body in the plane, aligned so that it never straddles two cache lines.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub struct PlaneBody {
    /// m/s.
    pub velocity: [f64; 2],
    /// s = r·ω, m/s.
    pub spin: f64,
}

/// Two axes, no rotation.
#[derive(Clone, Copy, Debug)]
pub struct Plane;

/// Two axes and rotation.
#[derive(Clone, Copy, Debug)]
pub struct SpinningPlane;

/// What both kinds of plane motion share.
macro_rules! plane_kinematics {
    ($name:ident, $problem:ident, rotation: $rotation:literal) => {
        impl Kinematics for $name {
            type Body = PlaneBody;
            type Normal = [f64; 2];
            const AXES: usize = 2;
            const ROTATION: bool = $rotation;
            const TANGENTIAL_COMPLIANCE: f64 = if $rotation { 3.0 } else { 1.0 };
            const DEGREES: usize = if $rotation { 3 } else { 2 };
            const INERTIA_OVER_MASS: [f64; 3] = [1.0, 1.0, 0.5];

            fn coordinates(body: &PlaneBody) -> [f64; 3] {
                [body.velocity[0], body.velocity[1], body.spin]
            }

            fn from_coordinates([x, y, spin]: [f64; 3]) -> PlaneBody {
                PlaneBody { velocity: [x, y], spin }
            }

            #[inline(always)]
            fn gradients([nx, ny]: [f64; 2]) -> [[[f64; 3]; 2]; 2] {
                let normal = [nx, ny, 0.0];
                let tangent = [-ny, nx, -1.0];
                [[normal, tangent], [[-nx, -ny, 0.0], [ny, -nx, -1.0]]]
            }

            fn body(world: &World, index: usize) -> PlaneBody {
                let grains = &world.grains;
                PlaneBody {
                    velocity: grains.velocities[index].to_array(),
                    spin: grains.radii[index] * grains.angular_velocities[index],
                }
            }

            fn store(body: &PlaneBody, world: &mut World, index: usize) {
                let grains = &mut world.grains;
                grains.velocities[index] = DVec2::from_array(body.velocity);
                if Self::ROTATION {
                    grains.angular_velocities[index] = body.spin / grains.radii[index];
                }
            }

            fn accelerated(
                body: &PlaneBody,
                world: &World,
                index: usize,
                time_step_secs: f64,
            ) -> PlaneBody {
                let position = world.grains.positions[index];
                let change = time_step_secs * world.gravity.acceleration(position);
                let velocity = (DVec2::from_array(body.velocity) + change).to_array();
                PlaneBody { velocity, spin: body.spin }
            }

            fn normal(normal: DVec2) -> [f64; 2] {
                normal.to_array()
            }

            #[inline(always)]
            fn relative_velocity([nx, ny]: [f64; 2], i: &PlaneBody, j: &PlaneBody) -> [f64; 2] {
                let x = i.velocity[0] - j.velocity[0];
                let y = i.velocity[1] - j.velocity[1];
                let spin = if Self::ROTATION { i.spin + j.spin } else { 0.0 };
                [nx * x + ny * y, nx * y - ny * x - spin]
            }

            #[inline(always)]
            fn velocity([nx, ny]: [f64; 2], i: &PlaneBody) -> [f64; 2] {
                let [x, y] = i.velocity;
                let spin = if Self::ROTATION { i.spin } else { 0.0 };
                [nx * x + ny * y, nx * y - ny * x - spin]
            }

            #[inline(always)]
            fn push_pair(
                i: &mut PlaneBody,
                j: &mut PlaneBody,
                [nx, ny]: [f64; 2],
                [along_normal, along_tangent]: [f64; 2],
                share: f64,
            ) {
                let x = nx * along_normal - ny * along_tangent;
                let y = ny * along_normal + nx * along_tangent;
                let other_share = 1.0 - share;
                i.velocity[0] += share * x;
                i.velocity[1] += share * y;
                j.velocity[0] -= other_share * x;
                j.velocity[1] -= other_share * y;
                if Self::ROTATION {
                    let turn = along_tangent + along_tangent;
                    i.spin -= share * turn;
                    j.spin -= other_share * turn;
                }
            }

            #[inline(always)]
            fn push_single(
                i: &mut PlaneBody,
                [nx, ny]: [f64; 2],
                [along_normal, along_tangent]: [f64; 2],
            ) {
                i.velocity[0] += nx * along_normal - ny * along_tangent;
                i.velocity[1] += ny * along_normal + nx * along_tangent;
                if Self::ROTATION {
                    i.spin -= along_tangent + along_tangent;
                }
            }

            fn problem(problems: &mut Problems) -> &mut StepProblem<Self> {
                &mut problems.$problem
            }

            fn kinetic_energy(body: &PlaneBody, mass: f64) -> f64 {
                let [x, y] = body.velocity;
                // ½Iω² = ¼mr²ω² = ½m·(s²/2)
                0.5 * mass * (x * x + y * y + 0.5 * body.spin * body.spin)
            }

            fn work_of_gravity(
                before: &PlaneBody,
                after: &PlaneBody,
                free: &PlaneBody,
                mass: f64,
            ) -> f64 {
                let along = |axis: usize| {
                    let change = free.velocity[axis] - before.velocity[axis];
                    0.5 * (before.velocity[axis] + after.velocity[axis]) * change
                };
                mass * (along(0) + along(1))
            }
        }
    };
}

plane_kinematics!(Plane, plane, rotation: false);
plane_kinematics!(SpinningPlane, spinning_plane, rotation: true);
