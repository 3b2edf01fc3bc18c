//! Motion in the plane, with and without rotation.

use glam::DVec2;

use super::Kinematics;
use crate::contact::Lanes;
use crate::world::World;

/// A body in the plane, aligned so that it never straddles two cache lines.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub struct PlaneBody<T = f64> {
    /// m/s.
    pub velocity: [T; 2],
    /// s = r·ω, m/s.
    pub spin: T,
}

/// Two axes, no rotation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plane;

/// Two axes and rotation.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpinningPlane;

/// What both kinds of plane motion share.
macro_rules! plane_kinematics {
    ($name:ident, rotation: $rotation:literal) => {
        impl Kinematics for $name {
            type Body<T: Lanes> = PlaneBody<T>;
            type Normal<T: Lanes> = [T; 2];
            const AXES: usize = 2;
            const ROTATION: bool = $rotation;
            const TANGENTIAL_COMPLIANCE: f64 = if $rotation { 3.0 } else { 1.0 };
            const DEGREES: usize = if $rotation { 3 } else { 2 };
            const INERTIA_OVER_MASS: [f64; 3] = [1.0, 1.0, 0.5];

            #[inline(always)]
            fn coordinates<T: Lanes>(body: &PlaneBody<T>) -> [T; 3] {
                [body.velocity[0], body.velocity[1], body.spin]
            }

            #[inline(always)]
            fn from_coordinates<T: Lanes>([x, y, spin]: [T; 3]) -> PlaneBody<T> {
                PlaneBody { velocity: [x, y], spin }
            }

            #[inline(always)]
            fn set(body: &mut PlaneBody, [x, y, spin]: [f64; 3]) {
                body.velocity = [x, y];
                if Self::ROTATION {
                    body.spin = spin;
                }
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

            #[inline(always)]
            fn normal<T: Lanes>(normal: [T; 2]) -> [T; 2] {
                normal
            }

            fn components(normal: [f64; 2]) -> [f64; 2] {
                normal
            }

            #[inline(always)]
            fn relative_velocity<T: Lanes>(
                [nx, ny]: [T; 2],
                i: &PlaneBody<T>,
                j: &PlaneBody<T>,
            ) -> [T; 2] {
                let x = i.velocity[0] - j.velocity[0];
                let y = i.velocity[1] - j.velocity[1];
                let spin = if Self::ROTATION { i.spin + j.spin } else { nx.same(0.0) };
                [nx * x + ny * y, nx * y - ny * x - spin]
            }

            #[inline(always)]
            fn velocity<T: Lanes>([nx, ny]: [T; 2], i: &PlaneBody<T>) -> [T; 2] {
                let [x, y] = i.velocity;
                let spin = if Self::ROTATION { i.spin } else { nx.same(0.0) };
                [nx * x + ny * y, nx * y - ny * x - spin]
            }

            #[inline(always)]
            fn push_pair<T: Lanes>(
                i: &mut PlaneBody<T>,
                j: &mut PlaneBody<T>,
                [nx, ny]: [T; 2],
                [along_normal, along_tangent]: [T; 2],
                share: T,
            ) {
                let x = nx * along_normal - ny * along_tangent;
                let y = ny * along_normal + nx * along_tangent;
                let other_share = share.same(1.0) - share;
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
            fn push_single<T: Lanes>(
                i: &mut PlaneBody<T>,
                [nx, ny]: [T; 2],
                [along_normal, along_tangent]: [T; 2],
            ) {
                i.velocity[0] += nx * along_normal - ny * along_tangent;
                i.velocity[1] += ny * along_normal + nx * along_tangent;
                if Self::ROTATION {
                    i.spin -= along_tangent + along_tangent;
                }
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

plane_kinematics!(Plane, rotation: false);
plane_kinematics!(SpinningPlane, rotation: true);
